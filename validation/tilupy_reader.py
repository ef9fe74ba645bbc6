"""Reads granflow's result.nc into tilupy, which plots and scores runs of thin-layer codes (SHALTOP, lave2D, saval2D) alike.

As a library, in a Python that has tilupy and netCDF4:

    import tilupy_reader, tilupy.read
    tilupy_reader.register()
    run = tilupy.read.get_results("granflow", file="demo/result.nc")
    run.plot("h_max"); run.get_output("u_max").d; tilupy.calibration.CSI(run, observation=mapped, h_threshs=[0.1], state="h_max")

As a program it draws tilupy's plots of the results, and scores them against the first of them, or against a mapped deposit.
"""

import argparse
import functools
import math
import pathlib
import subprocess
import sys

from environment import Refusal, enter, fresh_folder, guarded
from locate import program

TILUPY = ["tilupy==2.1.1", "numpy==2.4.6", "matplotlib==3.11.2", "netCDF4==1.7.5.1.post1"]

EPILOG = """
Without RESULT two runs are made first: `granflow demo` and, on the same mountain, the case of
`granflow new avalanche` with mu 0.3 in place of 0.4.
The scores are tilupy's: the critical success index hits / (hits + misses + false alarms) of the area thicker than each --thickness.
--observed is a raster on the same cells, above 0 where the deposit was mapped (ESRI ASCII grid or GeoTIFF).

example: python3 validation/tilupy_reader.py demo/result.nc softer/result.nc --out scored
"""


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("result", nargs="*", type=pathlib.Path, metavar="RESULT", help="result.nc of a run on terrain")
    parser.add_argument("--out", required=True, type=pathlib.Path, help="a new folder for everything that is written")
    parser.add_argument("--thickness", action="append", type=float, help="threshold [m], may be repeated; default: 0.05, 0.1, 0.5, 1")
    parser.add_argument("--state", choices=["h_max", "h_final"], default="h_max", help="what is scored (default h_max)")
    parser.add_argument("--observed", type=pathlib.Path, help="raster of the mapped deposit")
    parser.add_argument("--granflow", help="the program, where runs are made; default: target/release/granflow of this clone")
    parser.add_argument("--venv", help="environment for tilupy; default: validation/venv-tilupy, made where it is missing")
    chosen = parser.parse_args()
    chosen.thickness = chosen.thickness or [0.05, 0.1, 0.5, 1.0]
    if min(chosen.thickness) <= 0:
        parser.error("--thickness is positive")
    for path in chosen.result + ([chosen.observed] if chosen.observed else []):
        if not path.is_file():
            parser.error(f"{path} is no file")
    return chosen


def opened(file):
    """The data set; a refusal where it is no result of an avalanche on terrain."""
    import netCDF4

    try:
        data = netCDF4.Dataset(file)
    except OSError as error:
        raise Refusal(f"{file} cannot be read as NetCDF: {error.strerror}", "give the result.nc of a run") from error
    lacking = [name for name in ("thickness", "velocity_x", "velocity_y", "speed", "bed", "peak_thickness", "peak_speed")
               if name not in data.variables]
    if lacking:
        raise Refusal(f"{file} (model {getattr(data, 'model', 'unknown')}) has no {', '.join(lacking)}",
                      "tilupy compares maps of avalanches on terrain: run a case with [terrain] and `files` with \"netcdf\"")
    return data


def parameters(text):
    """Numbers of the case by tilupy's habit, flat: nx, ny, density, the friction law's, and delta1 [degrees] where there is a mu."""
    import tomllib

    material = tomllib.loads(text).get("material", {})
    law, values = next(iter(material.get("friction", {}).items()), ("", {}))
    found = {"law": law, "density": material.get("density")}
    found.update({key: value for key, value in values.items() if isinstance(value, (int, float))})
    if isinstance(values.get("mu"), (int, float)):
        found["delta1"] = math.degrees(math.atan(values["mu"]))
    return found


@functools.cache
def results_class():
    """The class `Results` that tilupy asks of a reader; made on first use, so that --help needs no tilupy."""
    import netCDF4  # noqa: F401 - a clear error here, not on the first file
    import numpy
    import tilupy.read

    class Results(tilupy.read.Results):
        """A run of granflow on terrain. tilupy's arrays have rows from the north and time last; granflow's rows are from the south.

        `h` [m] is normal to the bed, `hvert` vertical, `ux` and `uy` [m/s] the horizontal velocity, `u` the speed along the bed,
        `hu` and `hu2` follow. `h_max` and `u_max` are granflow's peaks, which see every step, where no operator over space is asked.
        """

        def __init__(self, file=None, folder=None, **_):
            super().__init__()
            path = pathlib.Path(file) if file else pathlib.Path(folder or ".") / "result.nc"
            self._code, self._folder, self._folder_output = "granflow", str(path.parent), str(path.parent)
            self._data = opened(path)
            self._x, self._y = (numpy.asarray(self._data[name][:], float) for name in "xy")
            self._tim = numpy.asarray(self._data["time"][:], float)
            self._nx, self._ny = len(self._x), len(self._y)
            self._dx, self._dy = self._x[1] - self._x[0], self._y[1] - self._y[0]
            self._z = self._zinit = self._north(self._data["bed"], numpy.nan)
            self._params = {"nx": self._nx, "ny": self._ny, **parameters(self._data.case)}

        def _north(self, variable, fill=0.0):
            values = numpy.ma.filled(numpy.ma.masked_invalid(numpy.ma.asarray(variable[:], float)), fill)
            return numpy.moveaxis(values[:, ::-1], 0, -1) if values.ndim == 3 else values[::-1]

        def compute_costh(self):
            """Cosine of the slope; 1 where a neighbour has no height."""
            return numpy.nan_to_num(super().compute_costh(), nan=1.0)

        def _field(self, name):
            plain = {"h": "thickness", "ux": "velocity_x", "uy": "velocity_y", "u": "speed"}
            if name in plain:
                return self._north(self._data[plain[name]])
            if name == "hvert":
                return self._field("h") / self.costh[:, :, None]
            if name in ("hu", "hu2"):
                return self._field("h") * self._field("u") ** (2 if name == "hu2" else 1)
            raise ValueError(f"granflow's results have no {name}: h, hvert, u, ux, uy, hu, hu2, each also as NAME_max, NAME_final and so on")

        def _extract_output(self, name, h_thresh=None, **_):
            values = self._field(name)
            if h_thresh is not None:
                values = numpy.where(self._field("h") < h_thresh, 0.0, values)
            return tilupy.read.TemporalResults2D(name, values, self._tim, x=self._x, y=self._y, z=self._zinit)

        def _read_from_file(self, name, operator, axis=None, **options):
            peaks = {("h", "max"): "peak_thickness", ("u", "max"): "peak_speed"}
            if axis in (None, "t") and (name, operator) in peaks and options.get("h_thresh") is None:
                values = self._north(self._data[peaks[name, operator]])
                return tilupy.read.StaticResults2D(f"{name}_{operator}", values, x=self._x, y=self._y, z=self._zinit)
            found = self._extract_output(name, **options)
            return found.get_temporal_stat(operator) if axis in (None, "t") else found.get_spatial_stat(operator, axis=axis)

    return Results


def Results(file=None, folder=None, **options):
    """A run by its result.nc, or by the folder that holds it: what tilupy.read.get_results("granflow", ...) calls."""
    return results_class()(file=file, folder=folder, **options)


def register():
    """Makes `granflow` a code that tilupy knows, in this process: get_results, calibration.eval_simus."""
    import tilupy.read

    sys.modules["tilupy.models.granflow.read"] = sys.modules[__name__]
    if "granflow" not in tilupy.read.ALLOWED_MODELS:
        tilupy.read.ALLOWED_MODELS.append("granflow")


def two_runs(out, granflow):
    """The demo, and the case of `granflow new avalanche` with less friction; both on the built-in mountain."""
    print("making two runs: granflow demo, and the case of granflow new avalanche with mu 0.3", file=sys.stderr)
    folder = out / "runs"
    folder.mkdir()
    for words in (["demo"], ["new", "avalanche"], ["run", "avalanche.toml", "--set", "material.friction.coulomb.mu=0.3", "--out", "softer"]):
        done = subprocess.run([granflow, *words], cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode:
            raise Refusal(f"granflow {' '.join(words)} ended with status {done.returncode}: {done.stderr.strip()[-500:]}",
                          "cargo build --release -p granflow-cli; or --granflow PROGRAM")
    return [folder / "demo" / "result.nc", folder / "softer" / "result.nc"]


def draw(run, folder):
    """tilupy's maps of the peaks and of the end, its volume, and the way of its centre of mass from where it started."""
    import matplotlib.pyplot as plt
    import tilupy.read

    folder.mkdir()
    axes = {name: run.plot(name, minval_abs=0.01, cmap="viridis") for name in ("h_max", "u_max", "h_final")}
    axes["volume"] = run.plot("volume")
    axes["volume"].set_ylabel("volume, by tilupy's slopes [m³]")
    centre = run.get_output("centermass")
    way = tilupy.read.TemporalResults0D("way", centre.d - centre.d[:, :1], centre.t, scalar_names=["east", "north", "up"])
    axes["centermass"] = way.plot()
    axes["centermass"].set_ylabel("way of the centre of mass [m]")
    axes["centermass"].legend()
    for name, axis in axes.items():
        axis.figure.savefig(folder / f"{name}.png", dpi=120, bbox_inches="tight")
    plt.close("all")


def observed(path, run):
    """The mapped deposit with rows from the north; a refusal where its cells are not those of the run."""
    import rasterio

    with rasterio.open(path) as file:
        values = file.read(1, masked=True).filled(0)
        west, cell = file.bounds.left + file.transform.a / 2, file.transform.a
    if values.shape != run.zinit.shape or abs(cell - run.dx) > 1e-6 * cell or abs(west - run.x[0]) > 0.01 * cell:
        raise Refusal(f"{path}: {values.shape} cells of {cell:g} m from {west:g}; the run has {run.zinit.shape} of {run.dx:g} m from {run.x[0]:g}",
                      "resample it to the run's cells: gdalwarp -tr CELL CELL -te WEST SOUTH EAST NORTH -r near FILE mapped.tif")
    return values > 0


def score(runs, names, chosen):
    """A table of tilupy's index for each run and thickness."""
    import tilupy.calibration

    first = runs[0]
    lines = [f"| run | thicker than | critical success index, {chosen.state}, against {chosen.observed or names[0]} |", "| --- | --- | --- |"]
    for run, name in zip(runs, names):
        if run.zinit.shape != first.zinit.shape or abs(run.x[0] - first.x[0]) + abs(run.y[0] - first.y[0]) > 1e-6:
            raise Refusal(f"{name} has other cells than {names[0]}", "score runs on one grid: terrain.cell and terrain.dem alike")
        for limit in chosen.thickness:
            wanted = observed(chosen.observed, first) if chosen.observed else first.get_output(chosen.state).d > limit
            _, (index,) = tilupy.calibration.CSI(run, observation=wanted, h_threshs=[limit], state=chosen.state)
            lines.append(f"| {name} | {limit:g} m | {index:.4f} |")
    return "\n".join(lines) + "\n"


def main():
    chosen = arguments()
    granflow = None if chosen.result else program(chosen.granflow)
    out = fresh_folder(chosen.out)
    enter("tilupy", TILUPY, chosen.venv)
    import tilupy.read

    register()
    files = chosen.result or two_runs(out, granflow)
    found = [tilupy.read.get_results("granflow", file=file) for file in files]
    names = [f"{number} {path.resolve().parent.name}" for number, path in enumerate(files, 1)]
    for run, name in zip(found, names):
        draw(run, out / name.replace(" ", "_"))
    table = score(found, names, chosen)
    (out / "scores.md").write_text(table, encoding="utf-8")
    print(table)
    print(f"written: {out / 'scores.md'}, and a folder of tilupy's figures for each run in {out}")
    return 0


if __name__ == "__main__":
    guarded(main)
