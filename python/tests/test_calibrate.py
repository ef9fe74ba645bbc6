"""Back-calculation and sensitivity: known answers."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import granflow

MU = "material.friction.coulomb.mu"

#: So flat that pressure moves nothing: with the speed u it slides u^2 / (2 mu) and stops.
SLAB = """
title = "A slab slides to its stop"
grid.x = { from = -1.0, to = 5.0, cells = 300 }
material = { epsilon = 1e-4, friction.coulomb.mu = 0.3 }
initial = { thickness.steps = { at = [-0.5, 0.0], values = [0.0, 1.0, 0.0] }, velocity_x = 1.0 }
time = { until = "rest", end = 12.0 }
output = { every = 12.0, threshold = 0.01 }
"""


def outline(case: granflow.Case, cell: float, noise: float):
    """The outline of the deposit of a run, its corners moved at random."""
    shapely = pytest.importorskip("shapely")
    ds = granflow.run(case, progress=False)
    x, y = np.meshgrid(ds.x, ds.y)
    inside = ds.deposit.values > 0.1
    x, y, half = x[inside], y[inside], 0.5 * cell
    union = shapely.union_all(shapely.box(x - half, y - half, x + half, y + half))
    ring = max(getattr(union, "geoms", [union]), key=lambda part: part.area).exterior
    corners = shapely.get_coordinates(ring)[:-1]
    moved = corners + np.random.default_rng(7).normal(0.0, noise, corners.shape)
    return shapely.Polygon(moved).buffer(0.0)


def test_the_friction_of_a_mapped_deposit_is_found_again(mountain):
    pytest.importorskip("optuna")
    case = mountain.case().set("output.every", 60.0).set(MU, 0.40)
    mapped = outline(case, mountain.cell, noise=10.0)
    found = granflow.calibrate(case.set(MU, 0.3), mapped, {MU: (0.25, 0.55)}, runs=60, progress=False)
    print(f"mu = {found.best[MU]:.4f}, csi = {found.score:.3f}")
    assert abs(found.best[MU] - 0.40) <= 0.005
    assert len(found.trials["score"]) == 60 and found.trials["score"].max() == found.score
    assert 0.5 < found.score < 1.0 and f"{found.best[MU]}" in found.case.text


@pytest.mark.parametrize("observed", ["run", "map", "number"])
def test_a_run_out_gives_the_friction_of_a_slab(observed):
    pytest.importorskip("optuna")
    event = granflow.run(granflow.Case(SLAB).set(MU, 0.25), progress=False)
    reached = event.x[event.deposit > 0.1]
    given = {"run": event, "map": event.deposit, "number": float(reached.max()) + 0.49}[observed]
    assert 2.4 < float(reached.max()) + 0.49 < 2.65, "exact: from -0.5 to 1/(2 mu) = 2; the front is smeared"
    found = granflow.calibrate(SLAB, given, {MU: (0.15, 0.5)}, score="runout", progress=False)
    assert abs(found.best[MU] - 0.25) < 0.005, found.best


def test_a_volume_gives_the_thickness_of_the_release(mountain):
    pytest.importorskip("optuna")
    case = mountain.case().set("time.end", 2.0)
    case.set("release", [{"cap": {"height": 1.5, "centre": [200.0, 300.0], "radius": 70.0}}])
    volume = granflow.run(case, progress=False).granflow.summary["mass_final"]
    key = "release.0.cap.height"
    found = granflow.calibrate(case.copy().set(key, 1.0), volume, {key: (0.5, 3.0)}, score="volume", runs=25, progress=False)
    assert abs(found.best[key] - 1.5) < 0.05, found.best


def test_what_cannot_be_compared_is_refused():
    pytest.importorskip("optuna")
    over = {MU: (0.2, 0.4)}
    with pytest.raises(ValueError, match="score = 'iou'"):
        granflow.calibrate(SLAB, 2.0, over, score="iou")
    with pytest.raises(ValueError, match="not a number"):
        granflow.calibrate(SLAB, 2.0, over)
    with pytest.raises(ValueError, match="no pair"):
        granflow.calibrate(SLAB, 2.0, {MU: (0.4, 0.2)}, score="runout")
    with pytest.raises(ValueError, match="name the keys"):
        granflow.calibrate(SLAB, 2.0, {}, score="runout")
    with pytest.raises(granflow.CaseError, match="friction"):
        granflow.calibrate(SLAB, 2.0, {"material.friction.coulomb.my": (0.2, 0.4)}, score="runout", runs=1)


@pytest.mark.parametrize("method", ["sobol", "morris"])
def test_what_a_slab_does_depends_on_its_friction_and_not_on_its_epsilon(method):
    pytest.importorskip("SALib")
    over = {MU: (0.25, 0.4), "material.epsilon": {"uniform": [1e-5, 1e-4]}}
    found = granflow.sensitivity(SLAB, over, output="time", method=method, samples=8)
    assert isinstance(found, xr.Dataset) and list(found.key) == list(over)
    index = found.ST if method == "sobol" else found.mu_star
    assert float(index[0]) > 20.0 * abs(float(index[1]))
    # The slab stops at u / mu, and its smeared front a little later.
    assert np.allclose(found.output, 1.0 / found["values"][:, 0], rtol=0.05)
