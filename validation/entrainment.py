"""Runs granflow and AvaFrame's com1DFA with one erodible layer and one law of entrainment, and compares what is picked up and where it stops."""

import argparse
import json
import pathlib
import sys

from avaframe import DENSITY, LAWS, case, inputs, law, mountain, shapes
from environment import AVAFRAME, enter, fresh_folder, guarded
from locate import program

LAYER_DENSITY = 100.0

EPILOG = """
PATH is a terrain with its release as avaframe.py takes it; without PATH the mountain of `granflow new avalanche`.

The layer lies on every cell that no release polygon touches, with one thickness normal to the bed and a density of 100 kg/m3. Both codes
get it as the same raster. The law is com1DFA's, in granflow `law.energy`: mass by area and time is shear stress times speed by --specific
[J/kg]. com1DFA's default is 5000, which empties this layer on most of the path; with a larger one the law decides, not the layer.

example: python3 validation/entrainment.py avaKot --law samosat_small --out entrained
"""


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("path", nargs="?", type=pathlib.Path, metavar="PATH", help="the terrain and its release")
    parser.add_argument("--out", required=True, type=pathlib.Path, help="a new folder for everything that is written")
    parser.add_argument("--law", choices=LAWS, default="coulomb", help="of friction (default coulomb)")
    parser.add_argument("--mu", type=float, default=0.4, help="Coulomb friction (default 0.4)")
    parser.add_argument("--cell", type=float, default=5.0, help="cell size [m] (default 5)")
    parser.add_argument("--thickness", type=float, default=0.3, help="of the layer [m] (default 0.3, AvaFrame's where none is said)")
    parser.add_argument("--specific", action="append", type=float, help="erosion energy [J/kg], may be repeated; default: 5000, 50000")
    parser.add_argument("--seed", action="append", type=int, help="of com1DFA's particles; the first is the reference; default: 12345, 1")
    parser.add_argument("--scheme", action="append", help="of granflow, may be repeated; default: energy_stable_2, energy_stable")
    parser.add_argument("--granflow", help="the program; default: target/release/granflow of this clone")
    parser.add_argument("--venv", help="environment for AvaFrame; default: validation/venv-avaframe, made where it is missing")
    chosen = parser.parse_args()
    chosen.specific = chosen.specific or [5000.0, 50000.0]
    chosen.seed = chosen.seed or [12345, 1]
    chosen.scheme = chosen.scheme or ["energy_stable_2", "energy_stable"]
    if min([chosen.cell, chosen.thickness, *chosen.specific]) <= 0:
        parser.error("cell size, thickness and erosion energy are positive")
    return chosen


def layer(path, ground, polygons, thickness):
    """Writes the layer on the cells of the ground that no release touches: com1DFA takes the others away too."""
    import numpy
    import rasterio
    import runs
    from rasterio.features import rasterize

    heights, transform = runs.elevation(ground)
    free = ~rasterize(polygons, out_shape=heights.shape, transform=transform, all_touched=True).astype(bool)
    values = numpy.where(free & numpy.isfinite(heights), thickness, 0.0).astype("float32")
    with rasterio.open(ground) as source, rasterio.open(path, "w", driver="GTiff", width=values.shape[1], height=values.shape[0], count=1,
                                                        dtype="float32", transform=transform, crs=source.crs) as file:
        file.write(values, 1)
    return path


def entrained(run):
    """The mass [kg] that a run picked up."""
    import numpy

    if run.version.startswith("granflow"):
        return json.loads((run.folder / "summary.json").read_text(encoding="utf-8")).get("eroded_mass", 0.0)
    mass = numpy.loadtxt(next(run.folder.glob("Outputs/com1DFA/mass_*.txt")), delimiter=",", skiprows=1, usecols=1)
    return float(mass[-1] - mass[0])


def both(chosen, folder, dem, release, specific=None, ground=None, thickness=None):
    """The runs of both codes, with a layer of this raster of thickness or without one; the first run is the reference."""
    import runs

    friction, settings = law(chosen.law, chosen.mu)
    asked = {"simTypeList": "ent" if thickness else "null", "resType": "ppr|pft|pfv|FT", "rho": DENSITY, "meshCellSize": chosen.cell, **settings}
    if thickness:
        asked |= {"rhoEnt": LAYER_DENSITY, "entEroEnergy": specific}
    found = []
    for seed in chosen.seed:
        print(f"{folder.name}: com1DFA, seed {seed}", file=sys.stderr, flush=True)
        found.append(runs.com1dfa(folder / f"com1dfa_{seed}", ground or dem, release, {**asked, "seed": seed}, f"com1DFA, seed {seed}", layer=thickness))
    ground = ground or runs.dem_of_com1dfa(found[0])
    for scheme in chosen.scheme:
        print(f"{folder.name}: granflow, {scheme}", file=sys.stderr, flush=True)
        text = case(ground, release, friction, scheme, "energy", 2 * chosen.cell)
        if thickness:
            text += (f"[entrainment]\nlayer = {{ raster = {json.dumps(str(thickness))} }}\ndensity = {LAYER_DENSITY}\n"
                     f"law.energy = {{ specific = {specific} }}\n")
        found.append(runs.granflow(folder / scheme, text, f"granflow, {scheme}", threads=1, path=chosen.granflow))
    return found, ground


def rows(found, ground, polygons, cell):
    """What the table says of each run: masses, run-out, peaks, and the areas of 1 kPa and of 0.1 m at the end against the reference's."""
    import runs
    import scores
    from rasterio.features import rasterize

    heights, transform = runs.elevation(ground)
    released = rasterize(polygons, out_shape=heights.shape, transform=transform).astype(bool)
    first = found[0]
    for run in found:
        pressed = scores.areas(first.maps["pressure"], run.maps["pressure"], 1.0, cell)
        left = scores.areas(first.maps["final"], run.maps["final"], 0.1, cell)
        yield {"run": run.name, "released_t": run.volume * DENSITY / 1e3, "entrained_t": entrained(run) / 1e3, "ended_s": run.ended,
               "peak_thickness_m": run.maps["thickness"].max(), "peak_speed_m_s": run.maps["speed"].max(),
               "peak_pressure_kpa": run.maps["pressure"].max(), "runout_m": scores.runout(run.maps["pressure"], heights, released, transform)[0],
               "deposit_m": run.maps["final"].max(), "pressure_area_m2": pressed.run, "pressure_jaccard": pressed.jaccard,
               "deposit_area_m2": left.run, "deposit_jaccard": left.jaccard}


def table(title, found):
    """Markdown of one group of runs."""
    lines = [f"## {title}", "", "| run | released | entrained | ended | peak thickness, speed, pressure | run-out | area of 1 kPa, index | deposit, area above 0.1 m, index |",
             "| --- | --- | --- | --- | --- | --- | --- | --- |"]
    for row in found:
        lines.append("| {run} | {released_t:.1f} t | {entrained_t:.1f} t | {ended_s:.1f} s | {peak_thickness_m:.2f} m, {peak_speed_m_s:.1f} m/s, {peak_pressure_kpa:.0f} kPa "
                     "| {runout_m:.0f} m | {pressure_area_m2:.0f} m², {pressure_jaccard:.3f} | {deposit_m:.2f} m, {deposit_area_m2:.0f} m², {deposit_jaccard:.3f} |".format(**row))
    return "\n".join(lines) + "\n"


def compare(chosen, out, dem, release):
    """Both codes without a layer, then with it, once for each erosion energy."""
    polygons = shapes(release)
    groups, text = {}, [f"# Entrainment beside AvaFrame: {chosen.law}, cells of {chosen.cell:g} m, a layer of {chosen.thickness:g} m\n"]

    def add(title, found, ground):
        groups[title] = list(rows(found, ground, polygons, chosen.cell))
        text.append(table(title, groups[title]))
        (out / "entrainment.md").write_text("\n".join(text), encoding="utf-8")
        (out / "entrainment.json").write_text(json.dumps(groups, indent=2), encoding="utf-8")

    found, ground = both(chosen, out / "without", dem, release)
    add("without a layer", found, ground)
    thickness = layer(out / "layer.tif", ground, polygons, chosen.thickness)
    for specific in chosen.specific:
        found, _ = both(chosen, out / f"specific_{specific:g}", dem, release, specific, ground, thickness)
        add(f"{specific:g} J/kg", found, ground)


def main():
    chosen = arguments()
    if chosen.path:
        inputs(chosen.path)
    granflow = program(chosen.granflow)
    out = fresh_folder(chosen.out)
    enter("avaframe", AVAFRAME, chosen.venv)
    dem, release = inputs(chosen.path) if chosen.path else mountain(out / "mountain", granflow)
    compare(chosen, out, dem.resolve(), release.resolve())
    print((out / "entrainment.md").read_text(encoding="utf-8"))
    return 0


if __name__ == "__main__":
    guarded(main)
