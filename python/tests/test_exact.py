"""Exact solutions as functions of arrays."""

from __future__ import annotations

import numpy as np
import pytest

import granflow
from granflow import exact


def test_shapes_follow_numpy():
    x, t = np.linspace(-1, 1, 5), np.array([[0.1], [0.2]])
    h, u = exact.ritter(x, t, beta=1.0, h_left=1.0)
    assert h.shape == u.shape == (2, 5)
    assert exact.ritter(0.0, 1.0, beta=1.0, h_left=1.0).h.shape == ()
    assert float(exact.ritter(0.0, 1.0, beta=1.0, h_left=1.0).h) == pytest.approx(4 / 9)
    assert exact.ritter(np.empty(0), 1.0, beta=1.0, h_left=1.0).h.shape == (0,)


def test_a_wrong_parameter_is_named():
    with pytest.raises(ValueError, match="beta = -1, but it must be positive"):
        exact.stoker(0.0, 1.0, beta=-1.0, h_left=1.0, h_right=0.5)
    with pytest.raises(ValueError, match="friction angle > slope angle"):
        exact.sliding_slab(1.0, slope=0.5, friction=0.1, u0=1.0)


def test_a_run_meets_them():
    case = granflow.Case(
        model="savage_hutter",
        grid={"x": {"from": -2.0, "to": 2.0, "cells": 800}},
        material={"epsilon": 1.0, "friction": {"coulomb": {"mu": 0.0}}},
        initial={"thickness": {"steps": {"at": [0.0], "values": [1.0, 0.2]}}},
        scheme={"name": "energy_stable_2"},
        time={"end": 0.8},
    )
    ds = granflow.run(case, progress=False)
    h, u = exact.stoker(ds.x, 0.8, beta=1.0, h_left=1.0, h_right=0.2)
    assert np.abs(ds.thickness[-1] - h).mean() < 2e-3
    assert np.abs(ds.velocity_x[-1] - u).mean() < 5e-3


def test_each_has_its_known_values():
    assert exact.flat_dam_break_front(10.0, mu=0.5) == pytest.approx(4.0)
    x, u = exact.flat_dam_break([0.5, 2.0], 1.0, mu=0.1)
    assert np.isfinite(x[0]) and np.isnan(x[1])
    way, speed = exact.sliding_slab([0.0, 100.0], slope=0.1, friction=0.5, u0=3.0)
    assert speed.tolist() == [3.0, 0.0] and way[1] > 0.0
    assert exact.parabolic_cap(0.0, 0.0, height=1.0, length=20.0, slope=0.6, friction=0.4).h == 1.0
    cap = exact.similarity_cap(0.0, 0.0, 0.0, height=1.0, length=20.0, length_y=30.0, slope=0.6, friction=0.4)
    assert cap.h == pytest.approx(1.0)
    assert exact.thacker(0.5, 0.0, 0.0, a=1.0, sigma=0.5, h0=0.1).h == pytest.approx(0.1)
    jump = exact.granular_jump([-9.0, 9.0], 0.0, beta=1.0, minus=(0.5, 3.0), h_plus=1.0)
    assert jump.h.tolist() == [0.5, 1.0]
    dam = exact.slope_dam_break([-1e3, 1e3], 1.0, h0=1.0, slope=0.6, friction=0.4)
    assert dam.h.tolist() == [1.0, 0.0]
    pile = exact.pile_on_rectangle(0.5, 0.25, sides=(1.0, 1.0))
    assert (float(pile.standing), float(pile.rolling)) == (0.25, 0.25)
    walled = exact.pile_on_rectangle(0.5, 0.5, sides=(1.0, 1.0), open_x=(False, False), open_y=(False, False))
    assert np.isnan(walled.standing)
    assert float(exact.pile_on_disc(0.25, radius=1.0).standing) == 0.75
    assert float(exact.pile_on_disc(0.25, radius=1.0, hole=0.2).standing) == pytest.approx(0.05)
