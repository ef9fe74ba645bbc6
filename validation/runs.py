"""One run of each code, side by side: what is asked, where its files lie, what it says of itself."""

import dataclasses
import json
import os
import pathlib
import shutil
import subprocess
import sys
import time

import numpy
import rasterio
from environment import HERE, Refusal
from locate import program

MAPS = {"pressure": ("ppr", "peak_pressure"), "speed": ("pfv", "peak_speed"), "thickness": ("pft", "peak_thickness")}


@dataclasses.dataclass
class Run:
    """A finished run: maps with rows from the north, zero where nothing was; seconds of the whole process
    on the clock and of the processor, and those that its steps took on the clock."""

    name: str
    maps: dict
    transform: object
    volume: float
    ended: float
    reason: str
    seconds: float
    cpu: float
    stepping: float
    steps: int
    version: str
    folder: pathlib.Path


def raster(path):
    """Values of the first band with 0 for nodata, and their place."""
    try:
        with rasterio.open(path) as file:
            values = file.read(1, masked=True).astype("float64").filled(numpy.nan)
            return numpy.nan_to_num(values), file.transform
    except rasterio.errors.RasterioIOError as error:
        raise Refusal(f"{path} cannot be read as a raster: {error}", "give a GeoTIFF or an ESRI ASCII grid") from error


def elevation(path):
    """Heights with NaN for nodata, and their place."""
    with rasterio.open(path) as file:
        return file.read(1, masked=True).astype("float64").filled(numpy.nan), file.transform


def command(words, what, log):
    """Runs a program; its seconds on the clock and of the processor; a refusal quotes the end of what it said."""
    start, before = time.perf_counter(), os.times()
    done = subprocess.run([str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    log.write_text(done.stdout, encoding="utf-8")
    if done.returncode:
        end = "\n    ".join(done.stdout.strip().splitlines()[-12:])
        raise Refusal(f"{what} ended with status {done.returncode}:\n    {end}", f"read {log}; its command was {' '.join(map(str, words))}")
    after = os.times()
    return time.perf_counter() - start, sum(after[2:4]) - sum(before[2:4])


def granflow(folder, case, name, *, threads=1, sets=(), path=None):
    """Writes the case into `folder`, runs it, and reads summary and maps."""
    folder.mkdir(parents=True)
    (folder / "case.toml").write_text(case, encoding="utf-8")
    words = [program(path), "run", folder / "case.toml", "--out", folder / "run", "--threads", threads]
    for change in sets:
        words += ["--set", change]
    seconds, cpu = command(words, "granflow", folder / "granflow.log")
    summary = json.loads((folder / "run" / "summary.json").read_text(encoding="utf-8"))
    maps, transform = {}, None
    for quantity, (_, file) in MAPS.items():
        maps[quantity], transform = raster(folder / "run" / "rasters" / f"{file}.tif")
    maps["final"], _ = raster(folder / "run" / "rasters" / "deposit.tif")
    return Run(name, maps, transform, summary["mass_initial"], summary["time"], summary["stop_reason"], seconds, cpu,
               summary["stepping_seconds"], summary["steps"], f"granflow {summary['version']}", folder / "run")


def same(earlier, folder):
    """Whether an earlier run of com1DFA is finished and had these inputs and settings, to the byte."""
    files = [path.relative_to(folder) for path in folder.rglob("*") if path.is_file()]
    return (earlier / "answer.json").is_file() and all((earlier / path).is_file() and (earlier / path).read_bytes() == (folder / path).read_bytes()
                                                       for path in files)


def com1dfa(folder, dem, release, settings, name, earlier=None, layer=None):
    """Lays out AvaFrame's folders, runs com1DFA in a process of its own, and reads its maps; `release` is a shapefile or a raster.

    `earlier` is the folder of such a run: its results are taken if it was asked for the same. `layer` is a raster of the thickness that
    can be entrained.
    """
    (folder / "Inputs" / "REL").mkdir(parents=True)
    shutil.copy(dem, folder / "Inputs" / f"dem{dem.suffix}")
    if dem.with_suffix(".prj").is_file():
        shutil.copy(dem.with_suffix(".prj"), folder / "Inputs" / "dem.prj")
    for part in release.parent.glob(f"{release.stem}.*"):
        shutil.copy(part, folder / "Inputs" / "REL" / f"release{part.suffix}")
    if layer:
        (folder / "Inputs" / "ENT").mkdir()
        shutil.copy(layer, folder / "Inputs" / "ENT" / f"layer{layer.suffix}")
    lines = "".join(f"{key} = {value}\n" for key, value in settings.items())
    (folder / "settings.ini").write_text(f"[GENERAL]\n{lines}", encoding="utf-8")
    if earlier and same(earlier, folder):
        shutil.copytree(earlier, folder, dirs_exist_ok=True)
    else:
        words = [sys.executable, "-I", HERE / "com1dfa.py", folder, folder / "settings.ini", folder / "answer.json"]
        seconds, cpu = command(words, "AvaFrame", folder / "output.log")
        said = json.loads((folder / "answer.json").read_text(encoding="utf-8"))
        (folder / "answer.json").write_text(json.dumps({**said, "seconds": seconds, "cpu_seconds": cpu}), encoding="utf-8")
    said = json.loads((folder / "answer.json").read_text(encoding="utf-8"))
    peaks = folder / "Outputs" / "com1DFA" / "peakFiles"
    maps, transform = {}, None
    for quantity, (file, _) in MAPS.items():
        maps[quantity], transform = raster(next(peaks.glob(f"*_{file}.asc"), peaks / f"{said['name']}_{file}.tif"))
    frames = sorted(peaks.glob("timeSteps/*_FT_t*"), key=lambda path: float(path.stem.rsplit("_t", 1)[1]))
    maps["final"], _ = raster(frames[-1])
    times = numpy.loadtxt(next(folder.glob("Outputs/com1DFA/mass_*.txt")), delimiter=",", skiprows=1, usecols=(0, 1))
    ended = float(times[-1, 0])
    limit = float(settings.get("tEnd", 400))
    reason = "end_time" if ended >= limit - 0.5 else "kinetic_energy"
    volume = float(times[0, 1]) / float(settings["rho"])
    return Run(name, maps, transform, volume, ended, reason, said["seconds"], said["cpu_seconds"], said["loop_seconds"], said["steps"],
               f"AvaFrame {said['version']}", folder)


def dem_of_com1dfa(run):
    """The heights that com1DFA computed on: its remeshed copy, or the file itself where no remeshing was needed."""
    copies = sorted((run.folder / "Inputs" / "remeshedRasters").glob("*"))
    rasters = [path for path in copies if path.suffix in (".asc", ".tif")] or sorted(run.folder.glob("Inputs/dem.[at]*"))
    return rasters[0]
