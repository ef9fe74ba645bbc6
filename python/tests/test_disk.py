"""Runs and states on the disk: the files of the program, gone on from with the same bits."""

from __future__ import annotations

import _thread
import subprocess
import sys
import threading
import warnings
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from test_bits import assert_same, same_bits

import granflow


def files(folder: Path) -> set[str]:
    """The files of a folder."""
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}


def test_a_run_into_a_folder_writes_what_the_program_writes(cases, program, tmp_path):
    theirs, ours = tmp_path / "program", tmp_path / "python"
    program("run", cases / "silo.toml", "--out", theirs, "--quiet")
    ds = granflow.run(cases / "silo.toml", out=ours, progress=False)
    assert files(ours) == files(theirs)
    for name in files(theirs) - {"summary.json", "result.nc"}:
        if name.startswith(("figures/", "mass.csv")):
            assert (ours / name).read_bytes() == (theirs / name).read_bytes(), name
    assert_same(ds, theirs / "result.nc")
    assert_same(ds, ours / "result.nc")
    assert ds.attrs["summary"].strip() == (ours / "summary.json").read_text().strip()
    assert "granflow.run" in ds.attrs["history"]


def test_a_run_in_memory_and_one_into_a_folder_are_the_same(mountain, tmp_path):
    case = mountain.case().set("output.files", ["netcdf", "geotiff"])
    memory, disk = granflow.run(case, progress=False), granflow.run(case, progress=False, out=tmp_path / "out")
    assert set(memory.variables) == set(disk.variables)
    for name in memory.variables:
        assert memory[name].attrs == disk[name].attrs and memory[name].dtype == disk[name].dtype, name
        assert same_bits(memory[name].values, disk[name].values), name
    assert (tmp_path / "out/rasters/peak_thickness.qml").is_file()


def test_a_run_that_ctrl_c_stopped_goes_on_with_the_same_bits(tmp_path):
    case = granflow.Case(
        model="savage_hutter",
        grid={"x": {"from": 0.0, "to": 10.0, "cells": 300}, "y": {"from": 0.0, "to": 10.0, "cells": 300}},
        material={"friction": {"coulomb": {"mu": 0.4}}},
        initial={"thickness": {"cone": {"height": 4.0, "centre": [5.0, 5.0], "slope": 1.2}}},
        time={"until": "rest", "end": 200.0},
        output={"every": 1.0, "files": ["netcdf"]},
    )
    out = tmp_path / "out"
    threading.Timer(0.7, _thread.interrupt_main).start()
    try:
        granflow.run(case, progress=False, out=out)
    except KeyboardInterrupt as stopped:
        assert "resume=True" in str(stopped) and (out / "checkpoint/state.bin").is_file()
    else:
        pytest.skip("this machine is done before it can be stopped")
    on = granflow.run(case, progress=False, out=out, resume=True)
    whole = granflow.run(case, progress=False)
    assert all(same_bits(on[name].values, whole[name].values) for name in whole.data_vars)


def test_a_run_that_has_ended_is_opened(silo, tmp_path):
    silo.set("output.files", ["netcdf"])
    first = granflow.run(silo, progress=False, out=tmp_path)
    with pytest.warns(granflow.GranflowWarning, match="has ended"):
        again = granflow.run(silo, progress=False, out=tmp_path, resume=True)
    for name in first.variables:
        assert same_bits(again[name].values, first[name].values), name
    assert again.granflow.summary == first.granflow.summary


def test_earlier_files_are_moved_with_a_warning(silo, tmp_path):
    silo.set("output.files", ["netcdf"]).set("time.end", 0.5)
    granflow.run(silo, progress=False, out=tmp_path)
    with pytest.warns(granflow.GranflowWarning, match="earlier run are now in .*previous"):
        granflow.run(silo, progress=False, out=tmp_path)
    assert (tmp_path / "previous/result.nc").is_file()


def test_what_cannot_be_gone_on_from_is_refused(silo, tmp_path):
    with pytest.raises(ValueError, match="out="):
        granflow.run(silo, resume=True)
    with pytest.raises(ValueError, match="no checkpoint .* without resume=True"):
        granflow.run(silo, progress=False, out=tmp_path / "new", resume=True)
    (tmp_path / "file").write_text("x")
    with pytest.raises(ValueError, match="it is a file"):
        granflow.run(silo, progress=False, out=tmp_path / "file")


def test_a_state_goes_to_the_disk_and_back_with_the_same_bits(mountain, tmp_path):
    case, path = mountain.case(), tmp_path / "deep/state.bin"
    sim = granflow.Simulation(case)
    sim.until(8.0)
    sim.checkpoint(path)
    steps, view = sim.steps, sim.state[0]
    sim.to_rest()
    there = granflow.Simulation(case, checkpoint=path)
    back = granflow.Simulation(case)
    back.to_rest()
    back.restore(path)
    with pytest.raises(granflow.StaleViewError):
        view.sum()
    for other in (there, back):
        assert other.time == 8.0 and other.steps == steps
        other.to_rest()
        assert other.steps == sim.steps and np.array_equal(other["thickness"], sim["thickness"])
        for name, peak in sim.peaks().items():
            assert np.array_equal(peak, other.peaks()[name], equal_nan=True), name
    kept = there.checkpoint()
    there.restore(kept)
    assert there.at_rest and there.time == sim.time


def test_a_state_is_restored_in_another_process(silo, tmp_path):
    sim = granflow.Simulation(silo)
    sim.until(0.5)
    sim.checkpoint(tmp_path / "state.bin")
    sim.to_rest()
    script = f"""
import granflow, numpy as np
sim = granflow.Simulation({silo.text!r}, checkpoint={str(tmp_path / "state.bin")!r})
sim.to_rest()
np.save({str(tmp_path / "h.npy")!r}, sim["thickness"].copy())
"""
    subprocess.run([sys.executable, "-c", script], check=True, cwd=tmp_path)
    assert np.array_equal(np.load(tmp_path / "h.npy"), sim["thickness"])


def test_the_checkpoint_of_a_folder_is_restored(silo, tmp_path):
    granflow.run(silo.set("output.files", ["netcdf"]), progress=False, out=tmp_path)
    sim = granflow.Simulation(silo, checkpoint=tmp_path / "checkpoint/state.bin")
    with xr.open_dataset(tmp_path / "result.nc", decode_times=False) as end:
        assert sim.at_rest and np.array_equal(sim["thickness"], end.thickness[-1])


def test_a_state_of_something_else_is_refused(silo, tmp_path):
    path, sim = tmp_path / "state.bin", granflow.Simulation(silo)
    sim.checkpoint(path)
    saved = sim.checkpoint()
    other = silo.copy().set("grid.x.cells", 120)
    for state in (path, saved):
        with pytest.raises(ValueError, match="of another case"):
            granflow.Simulation(other, checkpoint=state)
        with pytest.warns(granflow.GranflowWarning, match="mu|angle"):
            granflow.Simulation(silo.copy().set("material.friction", {"coulomb": {"mu": 0.4}}), checkpoint=state)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            granflow.Simulation(silo, checkpoint=state)
    with pytest.raises(FileNotFoundError, match="absent"):
        sim.restore(tmp_path / "absent.bin")
    path.write_bytes(path.read_bytes()[:-9])
    with pytest.raises(ValueError, match="truncated"):
        sim.restore(path)
    assert sim.time == 0.0 and sim["thickness"].max() > 0.0
