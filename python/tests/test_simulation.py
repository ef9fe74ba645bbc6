"""A run that is held: steps, views, checkpoints, Ctrl-C."""

from __future__ import annotations

import _thread
import signal
import threading
import time

import numpy as np
import pytest

import granflow


def test_a_simulation_ends_as_the_run(silo):
    ds = granflow.run(silo, progress=False)
    sim = granflow.Simulation(silo)
    assert sim.to_rest() and sim.at_rest and sim.max_speed == 0.0
    assert np.array_equal(sim["thickness"], ds.thickness[-1])
    assert sim.time == float(ds.time[-1]) and sim.steps == ds.granflow.summary["steps"]
    assert sum(sim.outflow.values()) + sim.volume == pytest.approx(ds.granflow.summary["mass_initial"], rel=1e-14)
    assert set(sim.peaks()) >= {"peak_thickness", "peak_speed"}
    assert np.array_equal(sim.peaks()["peak_thickness"].astype(float), ds.peak_thickness)


def test_frames_are_those_of_the_run(silo):
    ds = granflow.run(silo.set("output.every", 0.25), progress=False)
    times, fields = [], []
    for sim in granflow.Simulation(silo).frames(0.25):
        times.append(sim.time)
        fields.append(sim["thickness"].copy())
    assert times == ds.time.values.tolist()
    assert np.array_equal(fields, ds.thickness)


def test_frames_end_where_the_case_ends(silo):
    sim = granflow.Simulation(silo.set("time", {"end": 1.0}))
    assert [frame.time for frame in sim.frames(0.3)] == pytest.approx([0.0, 0.3, 0.6, 0.9, 1.0])


def test_a_view_is_the_memory_of_the_engine(silo):
    sim = granflow.Simulation(silo)
    view = sim["thickness"]
    assert np.shares_memory(view, sim["thickness"]) and not view.flags.owndata
    assert view.shape == sim.x.shape and not view.flags.writeable
    with pytest.raises(ValueError, match="read-only"):
        view[0] = 1.0
    with pytest.raises(ValueError):
        view.flags.writeable = True
    kept = view.copy()
    assert type(view.max()) is np.float64 and type(view + 1.0) is np.ndarray and type(kept) is np.ndarray
    sim.until(0.5)
    for use in (lambda: view + 1, lambda: view.max(), lambda: view[3], lambda: np.sum(view), lambda: str(view)):
        with pytest.raises(granflow.StaleViewError, match="has left"):
            use()
    assert not np.array_equal(sim["thickness"], kept)
    last = sim["thickness"]
    part = last[10:20]
    del sim
    assert part.shape == (10,) and float(last.sum()) > 0.0


def test_a_view_on_a_mountain_takes_no_time(mountain):
    sim = granflow.Simulation(mountain.case())
    assert sim["thickness"].shape == mountain.bed.shape == (len(sim.y), len(sim.x))
    sim.until(10.0)
    speed = sim["speed"]
    assert speed.flags.owndata or speed.base is not None
    assert not speed.flags.writeable and float(speed.max()) == pytest.approx(sim.max_speed)
    with pytest.raises(KeyError, match="thickness, velocity_x"):
        sim["depth"]
    assert "thickness" in sim and "depth" not in sim
    height, discharge_x, _ = sim.state
    assert np.shares_memory(height, sim.state[0]) and height.shape == mountain.bed.shape
    wet = sim["thickness"] > 1e-3
    assert np.allclose((discharge_x / np.where(wet, height, 1.0))[wet], sim["velocity_x"][wet])
    sim.step()
    with pytest.raises(granflow.StaleViewError, match="state\\[0\\]"):
        height.sum()


def test_a_checkpoint_goes_on_with_the_same_bits(mountain):
    case = mountain.case()
    sim = granflow.Simulation(case)
    sim.until(8.0)
    saved = sim.checkpoint()
    sim.to_rest()
    again = granflow.Simulation(case, checkpoint=saved)
    assert again.time == 8.0
    again.to_rest()
    assert again.steps == sim.steps and np.array_equal(again["thickness"], sim["thickness"])
    for name, peak in sim.peaks().items():
        assert np.array_equal(peak, again.peaks()[name], equal_nan=True), name
    with pytest.raises(ValueError, match="another case.*give the case as it was$"):
        granflow.Simulation(_smaller(mountain), checkpoint=saved)


def _smaller(mountain):
    return granflow.Case(
        terrain={"dem": granflow.Raster(mountain.bed[:20, :30], 10.0)},
        material={"density": 200.0, "friction": {"coulomb": {"mu": 0.35}}},
        release=[{"cap": {"height": 1.0, "centre": [100.0, 100.0], "radius": 30.0}}],
        time={"end": 1.0},
    )


def test_steps_are_counted(silo):
    sim = granflow.Simulation(silo)
    sim.step()
    sim.step(4)
    assert sim.steps == 5 and repr(sim).startswith("<granflow.Simulation at time ")
    for wrong in (lambda: sim.until(float("nan")), lambda: next(_second(sim.frames(0.0)))):
        with pytest.raises(ValueError):
            wrong()


def _second(frames):
    next(frames)
    yield next(frames)


def _slow() -> granflow.Case:
    return granflow.Case(
        model="savage_hutter",
        grid={"x": {"from": 0.0, "to": 100.0, "cells": 1200}, "y": {"from": 0.0, "to": 100.0, "cells": 1200}},
        material={"friction": {"coulomb": {"mu": 0.1}}},
        initial={"thickness": {"cone": {"height": 40.0, "centre": [50.0, 50.0], "slope": 0.8}}},
        time={"end": 1e6},
    )


@pytest.mark.parametrize("work", ["run", "simulation"])
def test_ctrl_c_ends_a_run_soon(work):
    # Started in the background of a script, Python ignores Ctrl-C.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    case = _slow()
    sim = granflow.Simulation(case) if work == "simulation" else None
    begun = time.monotonic()
    threading.Timer(1.0, _thread.interrupt_main).start()
    with pytest.raises(KeyboardInterrupt):
        granflow.run(case, progress=False) if sim is None else sim.to_rest()
    assert time.monotonic() - begun < 20.0
    if sim is not None:
        steps = sim.steps
        sim.step()
        assert sim.steps == steps + 1


def test_python_runs_beside_a_run(mountain):
    """The lock of the interpreter is free while the engine steps."""
    ticks = 0
    done = threading.Event()

    def count():
        nonlocal ticks
        while not done.wait(0.001):
            ticks += 1

    thread = threading.Thread(target=count)
    thread.start()
    granflow.Simulation(_slow()).step(3)
    done.set()
    thread.join()
    assert ticks > 20


def test_a_failed_computation_says_when(silo):
    case = silo.set("scheme", {"name": "verfahren_5", "step": 0.5}).set("time", {"end": 10.0})
    with pytest.raises(granflow.ComputationError) as caught:
        granflow.run(case, progress=False)
    assert caught.value.time < 10.0


def test_progress_is_shown_where_it_is_asked_for(mountain, capfd):
    granflow.run(mountain.case(), progress=True)
    shown = capfd.readouterr().err
    granflow.run(mountain.case(), progress=False)
    assert capfd.readouterr().err == ""
    assert shown == "" or "step" in shown  # a run shorter than a look shows nothing
