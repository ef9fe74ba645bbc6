"""The same bits, names, units and attributes as the program's result.nc."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import granflow

COARSE = {"grid.x.cells": 20, "grid.y.cells": 20}
#: What is changed in cases that take long.
CHANGES: dict[str, dict[str, object]] = {
    "sandpile": COARSE,
    "sandpile_disc": COARSE,
    "sandpile_l": COARSE,
    "sandpile_moving": COARSE,
    "sandpile_source": COARSE,
    "sandpile_walls": COARSE,
}
# `granflow new` writes their mountains beside them.
WITH_A_MOUNTAIN = {"avalanche", "snow_avalanche", "debris_flow", "rock_avalanche"}
NAMES = sorted(path.stem for path in (Path(__file__).resolve().parents[2] / "cases").glob("*.toml"))


def assert_same(ours: xr.Dataset, path: Path) -> None:
    with xr.open_dataset(path, engine="netcdf4") as theirs:
        assert set(ours.variables) == set(theirs.variables)
        for name, variable in theirs.variables.items():
            own = ours.variables[name]
            assert own.dims == variable.dims and own.dtype == variable.dtype, name
            assert own.values.tobytes() == variable.values.tobytes() or same_bits(own.values, variable.values), name
            assert own.attrs == {key: value for key, value in variable.attrs.items()}, name
        skipped = {"history", "summary"}
        assert {k: v for k, v in ours.attrs.items() if k not in skipped} == {
            k: v for k, v in theirs.attrs.items() if k not in skipped
        }


def same_bits(a: np.ndarray, b: np.ndarray) -> bool:
    """Equal bit for bit; not a number is as good as another."""
    nothing = np.isnan(a)
    return bool(np.array_equal(nothing, np.isnan(b)) and a[~nothing].tobytes() == b[~nothing].tobytes())


@pytest.mark.parametrize("name", NAMES)
def test_every_case_has_the_bits_of_the_program(name, cases, program, tmp_path):
    path = cases / f"{name}.toml"
    if name in WITH_A_MOUNTAIN:
        program("new", name, cwd=tmp_path)
        path = tmp_path / f"{name}.toml"
    case = granflow.Case(path).set("output.files", ["netcdf"])
    words = ["--set", 'output.files=["netcdf"]']
    for key, value in CHANGES.get(name, {}).items():
        case.set(key, value)
        words += ["--set", f"{key}={value}"]
    program("run", path, "--out", tmp_path / "out", "--quiet", *words)
    ours = granflow.run(case, progress=False)
    with xr.open_dataset(tmp_path / "out/result.nc", engine="netcdf4") as theirs:
        ours.attrs["case_text"] = theirs.attrs["case_text"]  # the overrides are quoted otherwise
    assert_same(ours, tmp_path / "out/result.nc")
    summary = json.loads((tmp_path / "out/summary.json").read_text())
    timed = {"wall_seconds", "stepping_seconds", "cell_updates_per_second"}
    assert set(summary) == set(ours.granflow.summary)
    for key in set(summary) - timed:
        assert ours.granflow.summary[key] == summary[key], key


def test_a_mountain_from_arrays_has_the_bits_of_one_from_files(mountain, program, tmp_path):
    rows, columns = mountain.bed.shape
    head = f"ncols {columns}\nnrows {rows}\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n"
    for name, values in (("dem", mountain.bed), ("release", mountain.thickness)):
        text = "\n".join(" ".join(map(repr, row.tolist())) for row in values[::-1])
        (tmp_path / f"{name}.asc").write_text(head + text + "\n")
    (tmp_path / "case.toml").write_text("""
        title = "A mountain"
        terrain = { dem = "dem.asc", crs = "EPSG:31287" }
        material = { density = 200.0, friction.coulomb.mu = 0.35 }
        release = [{ raster = "release.asc" }]
        time = { until = "rest", end = 60.0 }
        output.files = ["netcdf"]
    """)
    program("run", tmp_path / "case.toml", "--out", tmp_path / "out", "--quiet")
    ours = granflow.run(mountain.case(), progress=False)
    with xr.open_dataset(tmp_path / "out/result.nc", engine="netcdf4") as theirs:
        for name in theirs.data_vars:
            assert same_bits(ours[name].values, theirs[name].values), name
        assert ours.crs.attrs == theirs.crs.attrs


def test_threads_change_no_bit(mountain):
    one, two = (granflow.run(mountain.case(), threads=threads, progress=False) for threads in (1, 2))
    assert all(same_bits(one[name].values, two[name].values) for name in one.data_vars)


def test_gauges_and_sections_are_there(mountain, program, tmp_path):
    case = mountain.case()
    case.set("gauge", [{"name": "road", "at": [600.0, 300.0]}])
    case.set("section", [{"name": "bridge", "line": [[800.0, 100.0], [800.0, 500.0]]}])
    ds = granflow.run(case, progress=False)
    assert ds.attrs["gauge_names"] == "road" and ds.attrs["section_names"] == "bridge"
    passed = ds.section_volume.isel(section=0)
    assert abs(float(passed[-1])) > 0.0 and float(passed[0]) == 0.0
    assert ds.gauge_thickness.dims == ("series_time", "gauge") and float(ds.gauge_thickness.max()) > 0.0


def test_series_are_not_copied_and_can_be_written(silo, tmp_path):
    ds = granflow.run(silo, progress=False)
    assert ds.thickness.shape == (ds.sizes["time"], 240)
    ds.to_netcdf(tmp_path / "again.nc", engine="netcdf4")
    with xr.open_dataset(tmp_path / "again.nc", engine="netcdf4") as again:
        xr.testing.assert_identical(again.load(), ds)
