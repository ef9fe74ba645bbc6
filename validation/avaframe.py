"""Runs granflow and AvaFrame's com1DFA on one terrain, with one release and one law, and compares what comes out."""

import argparse
import json
import pathlib
import subprocess
import sys

from environment import AVAFRAME, Refusal, enter, fresh_folder, guarded
from locate import program

SAMOSAT = {"samosat": ("samosAT", 0.155), "samosat_medium": ("samosATMedium", 0.17), "samosat_small": ("samosATSmall", 0.22)}
LAWS = [*SAMOSAT, "coulomb", "voellmy"]
DENSITY = 200.0

EPILOG = """
PATH is a folder with
  dem.asc or dem.tif     elevation in a projected system in metres
  release.shp            release polygons with a field `thickness` [m], normal to the bed
or a folder of AvaFrame's layout (Inputs/*.asc, Inputs/REL/*.shp), one DEM and one shapefile in it.
Without PATH the mountain of `granflow new avalanche` is taken, which needs no data.

The laws are AvaFrame's: samosat (mu 0.155, releases above 60,000 m3), samosat_medium (0.17), samosat_small (0.22, below
25,000 m3), coulomb (--mu), voellmy (mu 0.155, xi 4000 m/s2).

--reference FOLDER holds rasters of a com1DFA run that is finished, on the same cells: one *ppr*, one *pfv*, one *pft*, .asc or
.tif. They are scored beside the others; say with --law which law they were made with.

The curvature that loads the friction is taken by com1DFA from the way of a particle in one step, about one cell, and by granflow over
--curvature, twice the cell unless given: on a rough raster the result hangs on this length more than on the code.

--earlier FOLDER is the --out of an earlier comparison: its com1DFA runs are taken, not computed again, where all was the same.

Both codes compute on the raster that com1DFA resampled, so that maps are compared cell by cell. Both end when the kinetic energy
falls below 1 % of its peak, AvaFrame's rule, or at 400 s; with --until rest granflow goes on until it rests.

example: python3 validation/avaframe.py --law coulomb --cell 5 --out compared
"""


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("path", nargs="?", type=pathlib.Path, metavar="PATH", help="the terrain and its release")
    parser.add_argument("--out", required=True, type=pathlib.Path, help="a new folder for everything that is written")
    parser.add_argument("--law", action="append", choices=LAWS, help="may be repeated; default: samosat, coulomb, voellmy")
    parser.add_argument("--cell", action="append", type=float, help="cell size [m], may be repeated; default: 5")
    parser.add_argument("--scheme", action="append", help="of granflow, may be repeated; default: energy_stable_2, energy_stable")
    parser.add_argument("--mu", type=float, default=0.4, help="Coulomb friction (default 0.4)")
    parser.add_argument("--pressure", action="append", type=float, help="peak pressure [kPa] that bounds an area; default: 1, 3, 5")
    parser.add_argument("--thickness", action="append", type=float, help="peak thickness [m] that bounds an area; default: 0.1")
    parser.add_argument("--until", choices=["energy", "rest"], default="energy", help="how granflow ends (default energy)")
    parser.add_argument("--seed", action="append", type=int, help="of com1DFA's particles; the first is the reference; default: 12345, 1")
    parser.add_argument("--reference", type=pathlib.Path, help="folder with rasters of a finished com1DFA run")
    parser.add_argument("--curvature", type=float, help="of granflow: length [m] over which the bed's curvature is taken; default: two cells")
    parser.add_argument("--earlier", type=pathlib.Path, help="the --out of an earlier comparison")
    parser.add_argument("--com1dfa", action="append", default=[], metavar="KEY=VALUE", help="a setting of com1DFA, may be repeated")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="a key of granflow's case, may be repeated")
    parser.add_argument("--threads", type=int, default=1, help="of granflow (default 1: com1DFA uses one)")
    parser.add_argument("--granflow", help="the program; default: target/release/granflow of this clone")
    parser.add_argument("--venv", help="environment for AvaFrame; default: validation/venv-avaframe, made where it is missing")
    chosen = parser.parse_args()
    defaults = {"law": ["samosat", "coulomb", "voellmy"], "cell": [5.0], "scheme": ["energy_stable_2", "energy_stable"],
                "pressure": [1.0, 3.0, 5.0], "thickness": [0.1], "seed": [12345, 1]}
    for key, value in defaults.items():
        setattr(chosen, key, getattr(chosen, key) or value)
    for change in chosen.com1dfa + chosen.set:
        if "=" not in change:
            parser.error(f"{change}: a change is KEY=VALUE")
    if min(chosen.cell + chosen.pressure + chosen.thickness + [chosen.curvature or 1]) <= 0:
        parser.error("cell sizes, pressures, thicknesses and the length of the curvature are positive")
    return chosen


def one(folder, patterns, what):
    """The one file of the folder that fits; both refusals say what is expected."""
    found = sorted({path for pattern in patterns for path in folder.glob(pattern)})
    if len(found) != 1:
        names = ", ".join(path.name for path in found) or "none"
        raise Refusal(f"{folder}: one {what} is expected ({' or '.join(patterns)}), found: {names}",
                      "see --help for what PATH holds; without PATH a mountain made from a formula is used")
    return found[0]


def inputs(path):
    """Elevation and release of a folder, in granflow's or in AvaFrame's layout."""
    if not path.is_dir():
        raise Refusal(f"{path} is no folder", "give the folder that holds dem.asc and release.shp, or none")
    if (path / "Inputs").is_dir():
        return one(path / "Inputs", ["*.asc", "*.tif"], "DEM"), one(path / "Inputs" / "REL", ["*.shp"], "release")
    return one(path, ["dem.asc", "dem.tif"], "DEM"), one(path, ["release.shp"], "release")


def mountain(folder, granflow):
    """The mountain of `granflow new avalanche`, its release written as a shapefile for AvaFrame."""
    import fiona

    folder.mkdir()
    subprocess.run([granflow, "new", "avalanche"], cwd=folder, check=True, capture_output=True)
    schema = {"geometry": "Polygon", "properties": {"name": "str", "thickness": "float"}}
    with fiona.open(folder / "release.geojson") as source, fiona.open(folder / "release.shp", "w", "ESRI Shapefile", schema) as copy:
        for feature in source:
            copy.write({"geometry": feature.geometry, "properties": {"name": "release", "thickness": 1.0}})
    return folder / "mountain.asc", folder / "release.shp"


def shapes(release):
    """The polygons of a release; a refusal where the thickness is missing."""
    import fiona

    with fiona.open(release) as file:
        features = [(feature.geometry, feature.properties.get("thickness")) for feature in file]
    for number, (_, thickness) in enumerate(features, 1):
        try:
            if float(thickness) > 0:
                continue
        except (TypeError, ValueError):
            pass
        raise Refusal(f"{release}: feature {number} has thickness {thickness}", "add a field `thickness` with the release thickness [m]")
    if not features:
        raise Refusal(f"{release} holds no polygon", "draw the release area as a polygon")
    return [geometry for geometry, _ in features]


def law(name, mu):
    """A law in both codes' words: granflow's line, com1DFA's settings."""
    if name in SAMOSAT:
        model, friction = SAMOSAT[name]
        return f"friction.samosat = {{ mu = {friction} }}", {"frictModel": model}
    if name == "coulomb":
        return f"friction.coulomb = {{ mu = {mu} }}", {"frictModel": "Coulomb", "mucoulomb": mu}
    return "friction.voellmy = { mu = 0.155, xi = 4000.0 }", {"frictModel": "Voellmy", "muvoellmy": 0.155, "xsivoellmy": 4000.0}


def case(dem, release, friction, scheme, until, curvature):
    """The case of granflow that asks for what com1DFA was asked for."""
    stop = "stop.kinetic_energy = 0.01\nend = 400.0" if until == "energy" else 'until = "rest"\nend = 10000.0'
    return f"""[terrain]
dem = {json.dumps(str(dem))}
curvature = {{ length = {float(curvature)} }}
[material]
density = {DENSITY}
{friction}
[[release]]
polygons = {json.dumps(str(release))}
thickness = {{ attribute = "thickness" }}
[scheme]
name = {json.dumps(scheme)}
[time]
{stop}
[output]
files = ["netcdf", "geotiff"]
"""


def finished(folder):
    """A com1DFA run that somebody else made, from its rasters."""
    import runs

    maps, transform = {}, None
    for quantity, (file, _) in runs.MAPS.items():
        maps[quantity], transform = runs.raster(one(folder, [f"*{file}*.asc", f"*{file}*.tif"], f"raster of {quantity}"))
    return runs.Run("reference given", maps, transform, None, None, "", None, None, None, None, "", folder)


def compare(chosen, out, dem, release):
    """All runs of all laws and cell sizes, and their scores against the first of each."""
    import report
    import runs

    polygons = shapes(release)
    groups = []
    for name in chosen.law:
        friction, settings = law(name, chosen.mu)
        for cell in chosen.cell:
            folder = out / f"{name}_{cell:g}m"
            found = []
            for seed in chosen.seed:
                print(f"{name}, {cell:g} m: com1DFA, seed {seed}", file=sys.stderr, flush=True)
                asked = {"simTypeList": "null", "resType": "ppr|pft|pfv|FT", "rho": DENSITY, "meshCellSize": cell, "seed": seed, **settings,
                         **dict(change.split("=", 1) for change in chosen.com1dfa)}
                earlier = chosen.earlier / folder.name / f"com1dfa_{seed}" if chosen.earlier else None
                found.append(runs.com1dfa(folder / f"com1dfa_{seed}", dem, release, asked, f"com1DFA, seed {seed}", earlier))
            ground = runs.dem_of_com1dfa(found[0])
            if chosen.reference:
                found.append(finished(chosen.reference))
            for scheme in chosen.scheme:
                print(f"{name}, {cell:g} m: granflow, {scheme}", file=sys.stderr, flush=True)
                text = case(ground, release, friction, scheme, chosen.until, chosen.curvature or 2 * cell)
                found.append(runs.granflow(folder / scheme, text, f"granflow, {scheme}", threads=chosen.threads, sets=chosen.set,
                                           path=chosen.granflow))
            groups.append(report.group(name, cell, ground, polygons, found,
                                       {"pressure": chosen.pressure, "thickness": chosen.thickness}))
            report.figure(groups[-1], out / f"{name}_{cell:g}m.png")
            report.write(out, groups, chosen)
    return groups


def main():
    chosen = arguments()
    if chosen.path:
        inputs(chosen.path)
    if chosen.earlier and not (chosen.earlier / "comparison.json").is_file():
        raise Refusal(f"{chosen.earlier} holds no comparison.json", "give the --out of an earlier comparison")
    granflow = program(chosen.granflow)
    out = fresh_folder(chosen.out)
    enter("avaframe", AVAFRAME, chosen.venv)
    dem, release = inputs(chosen.path) if chosen.path else mountain(out / "mountain", granflow)
    compare(chosen, out, dem.resolve(), release.resolve())
    print((out / "comparison.md").read_text(encoding="utf-8"))
    print(f"written: {out / 'comparison.md'}, comparison.json, a figure for each law and cell size, and every run in a folder of its own")
    return 0


if __name__ == "__main__":
    guarded(main)
