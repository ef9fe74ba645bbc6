"""Ensembles: the bits of the program for any executor, and after a worker was lost."""

from __future__ import annotations

import os
import pickle
import signal
import threading
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest
import xarray as xr

import granflow
from granflow import _ensemble

SLAB = """
title = "A slab"
grid.x = { from = -1.0, to = 3.0, cells = 200 }
material = { epsilon = 1e-4, friction.coulomb = { mu = 0.3 } }
initial = { thickness.steps = { at = [-0.5, 0.0], values = [0.0, 1.0, 0.0] }, velocity_x = 1.0 }
time = { until = "rest", end = 12.0 }
[ensemble]
members = 24
vary."material.friction.coulomb.mu" = { uniform = [0.25, 0.4] }
exceed = { peak_thickness = [0.5], peak_speed = [0.25] }
"""


@pytest.fixture(scope="module")
def whole() -> xr.Dataset:
    return granflow.Ensemble(SLAB).run(progress=False)


def same(one: xr.Dataset, other: xr.Dataset) -> None:
    """Equal bit for bit, the table too."""
    assert set(one.variables) == set(other.variables)
    for name, variable in one.variables.items():
        assert variable.values.tobytes() == other[name].values.tobytes(), name
    assert one.attrs["members"] == other.attrs["members"]


def test_the_maps_are_those_of_the_program(whole, program, tmp_path):
    (tmp_path / "slab.toml").write_text(SLAB)
    program("ensemble", tmp_path / "slab.toml", "--out", tmp_path / "out", "--quiet")
    with xr.open_dataset(tmp_path / "out/result.nc", engine="netcdf4") as theirs:
        assert set(theirs.variables) == set(whole.variables)
        for name, variable in theirs.variables.items():
            ours = whole[name].values
            assert np.array_equal(ours, variable.values, equal_nan=True), name
            assert whole[name].attrs == variable.attrs, name
    assert whole.attrs["members"] == (tmp_path / "out/members.csv").read_text()
    assert {"count", "exceedance_peak_thickness_0_5", "p05_peak_speed", "mean_peak_speed", "max_peak_thickness"} <= set(whole)


@pytest.mark.parametrize("workers", [1, 2, 3])
def test_threads_change_no_bit(whole, workers):
    with ThreadPoolExecutor(workers) as pool:
        same(granflow.Ensemble(SLAB).run(pool, chunk=5, progress=False), whole)
    same(granflow.Ensemble(SLAB).run(threads=workers, progress=False), whole)


def test_processes_change_no_bit(whole):
    case = granflow.Case(SLAB.replace("mu = 0.3", "mu = 0.9")).set("material.friction.coulomb.mu", 0.3)
    expected = granflow.Ensemble(case).run(progress=False)
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        same(granflow.Ensemble(case).run(pool, chunk=7, progress=False), expected)
    assert np.array_equal(expected.max_peak_speed, whole.max_peak_speed, equal_nan=True)


def test_a_mountain_in_memory_goes_to_other_processes(mountain):
    case = mountain.case().set("time.end", 5.0)
    case.set("ensemble", {"members": 6, "vary": {"material.friction.coulomb.mu": {"uniform": [0.3, 0.4]}}})
    here = granflow.Ensemble(case).run(progress=False)
    assert here["count"].attrs["grid_mapping"] == "crs" and here.p50_peak_pressure.shape == mountain.bed.shape
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        same(granflow.Ensemble(case).run(pool, progress=False), here)


def test_members_come_in_any_order_and_once(whole):
    ensemble = granflow.Ensemble(SLAB)
    first = ensemble.run(members=[20, 3, 4, 5], progress=False)
    assert list(ensemble.members["member"]) == [3, 4, 5, 20] and float(first["count"].max()) == 4.0
    other = granflow.Ensemble(SLAB)
    other.run(members=range(6, 12), progress=False)
    with pytest.raises(ValueError, match="added twice"):
        ensemble.add(first_part(range(5, 7)))
    ensemble.add(other.part())
    same(ensemble.run(progress=False), whole)
    with pytest.raises(ValueError, match="members 0 to 23"):
        ensemble.run(members=[24])


def first_part(numbers: range) -> bytes:
    ensemble = granflow.Ensemble(SLAB)
    ensemble.run(members=numbers, progress=False)
    return ensemble.part()


def test_parts_are_those_of_the_program(whole, program, tmp_path):
    (tmp_path / "slab.toml").write_text(SLAB)
    program("ensemble", tmp_path / "slab.toml", "--part", "2/2", "--out", tmp_path, "--quiet")
    ensemble = granflow.Ensemble(tmp_path / "slab.toml")
    ensemble.add((tmp_path / "part-2-of-2.bin").read_bytes())
    same(ensemble.run(progress=False), whole)
    with pytest.raises(ValueError, match="another case"):
        granflow.Ensemble(SLAB.replace("24", "23")).add(ensemble.part())


def test_a_member_is_what_its_sample_says():
    ensemble = granflow.Ensemble(SLAB)
    assert len(ensemble) == 24 and "24 members" in repr(ensemble)
    values = ensemble.sample(7)
    ds = ensemble.member(7, progress=False)
    by_hand = granflow.Case(SLAB.split("[ensemble]")[0]).set("material.friction.coulomb.mu", values["material.friction.coulomb.mu"])
    assert ds.peak_speed.values.tobytes() == granflow.run(by_hand, progress=False).peak_speed.values.tobytes()
    again = pickle.loads(pickle.dumps(ensemble.case(7)))
    assert granflow.run(again, progress=False).peak_speed.values.tobytes() == ds.peak_speed.values.tobytes()
    other = granflow.run(ensemble.case(7).set("material.friction.coulomb.mu", 0.3), progress=False)
    assert not np.array_equal(other.peak_speed, ds.peak_speed, equal_nan=True)
    ensemble.run(members=[7], progress=False)
    row = ensemble.members
    assert row["material.friction.coulomb.mu"][0] == values["material.friction.coulomb.mu"]
    assert row["mass_initial"][0] == ds.granflow.summary["mass_initial"] and row["status"][0] == "computed"
    with pytest.raises(IndexError, match="has 24 members"):
        ensemble.sample(24)


def test_the_table_without_pandas(whole, monkeypatch):
    frame = whole.granflow.members
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    plain = whole.granflow.members
    assert list(plain) == list(frame.columns) and len(plain["member"]) == 24
    assert np.array_equal(plain["max_speed"], frame["max_speed"]) and plain["stop_reason"][0] == "at_rest"


FRAGILE = SLAB.replace("[ensemble]", 'scheme = { name = "verfahren_1", step = 0.001 }\n[ensemble]').replace(
    'until = "rest", end = 12.0', "end = 0.5"
)


def test_a_member_that_fails_is_named_and_all_that_fail_are_an_error():
    some = FRAGILE.replace('vary."material.friction.coulomb.mu" = { uniform = [0.25, 0.4] }', 'vary."scheme.step" = { choice = [0.001, 0.5] }')
    with pytest.warns(granflow.GranflowWarning) as warned:
        ds = granflow.Ensemble(some).run(progress=False)
    told = [str(one.message) for one in warned]
    assert len(told) == 6 and "scheme.step=0.5) failed" in told[0] and "more members failed" in told[-1]
    table = ds.granflow.members
    failed = table[table.status == "failed"]
    assert 0 < len(failed) < 24 and float(ds["count"].max()) == 24 - len(failed) and failed.failure.notna().all()
    with pytest.raises(granflow.ComputationError, match="all 24 members failed"):
        granflow.Ensemble(some.replace("[0.001, 0.5]", "[0.4, 0.5]")).run(progress=False)


def test_a_case_without_an_ensemble_is_refused(silo):
    with pytest.raises(granflow.CaseError, match=r"no table \[ensemble\]"):
        granflow.Ensemble(silo)


def test_a_case_can_be_pickled(mountain, tmp_path):
    for case in (mountain.case(), granflow.Case(SLAB).set("time.end", 3.0)):
        again = pickle.loads(pickle.dumps(case))
        assert again.text == case.text and again.check() is again
    (tmp_path / "slab.toml").write_text(SLAB)
    again = pickle.loads(pickle.dumps(granflow.Case(tmp_path / "slab.toml")))
    (tmp_path / "slab.toml").unlink()
    assert again.text == SLAB and again.copy().set("title", "B").text != SLAB


class Lossy(ThreadPoolExecutor):
    """Loses the first try of every third chunk."""

    count = 0

    def submit(self, *words, **named):
        self.count += 1
        if self.count % 3 == 0 and self.count < 12:
            future: Future = Future()
            future.set_exception(ConnectionError("the worker is gone"))
            return future
        return super().submit(*words, **named)


def test_what_a_lost_worker_had_is_computed_again(whole):
    with Lossy(2) as pool:
        same(granflow.Ensemble(SLAB).run(pool, chunk=3, progress=False), whole)


def killed(payload: bytes, token: str, first: int, end: int) -> bytes:
    if first == 12:
        os.kill(os.getpid(), signal.SIGKILL)
    return _ensemble.compute(payload, token, first, end)


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL")
def test_a_pool_that_breaks_leaves_the_rest_to_this_process(whole):
    class Deadly(ProcessPoolExecutor):
        def submit(self, _compute, *words):
            return super().submit(killed, *words)

    with Deadly(2, mp_context=get_context("spawn")) as pool, pytest.warns(granflow.GranflowWarning, match="pool of workers broke"):
        same(granflow.Ensemble(SLAB).run(pool, chunk=4, progress=False), whole)


def test_dask_with_a_worker_killed_half_way(whole):
    try:
        from distributed import Client, LocalCluster
    except ImportError as error:
        print(f"skipped: {error}; pip install distributed")
        pytest.skip(str(error))
    with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster, Client(cluster) as client:
        pids = list(client.run(os.getpid).values())
        # many times as long as the slab of the other tests, so that there is a half-way
        long = SLAB.replace("cells = 200", "cells = 1200")
        ensemble = granflow.Ensemble(long)
        seen = threading.Event()

        class Bar(_ensemble._Bar):
            def done(self, count: int) -> None:
                super().done(count)
                if count >= 6 and not seen.is_set():
                    seen.set()
                    os.kill(pids[0], signal.SIGKILL)

        patched, _ensemble._Bar = _ensemble._Bar, Bar
        try:
            ds = ensemble.run(client.get_executor(), chunk=2, progress=False)
        finally:
            _ensemble._Bar = patched
        assert seen.is_set()
    same(ds, granflow.Ensemble(long).run(progress=False))
