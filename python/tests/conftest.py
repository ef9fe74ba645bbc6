"""What the tests share: the cases of the repository, the program, a mountain made by formula."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import matplotlib
import numpy as np
import pytest

import granflow

matplotlib.use("agg")

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def program() -> Callable[..., str]:
    """Runs the program that the package installs; returns what it printed."""

    def call(*words: object, cwd: Path | None = None) -> str:
        command = [sys.executable, "-m", "granflow", *map(str, words)]
        done = subprocess.run(command, capture_output=True, text=True, cwd=cwd)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return call


@pytest.fixture(scope="session")
def cases() -> Path:
    return ROOT / "cases"


class Mountain:
    """A slope that runs out, with a channel, and what is released on it."""

    cell = 10.0
    x = np.arange(5.0, 1500.0, 10.0)
    y = np.arange(5.0, 600.0, 10.0)
    columns, rows = np.meshgrid(x, y)
    bed = 700.0 * np.exp(-columns / 450.0) + 1e-3 * (rows - 300.0) ** 2
    thickness = np.where((columns - 200.0) ** 2 + (rows - 300.0) ** 2 < 70.0**2, 1.2, 0.0)

    @classmethod
    def raster(cls) -> granflow.Raster:
        return granflow.Raster(cls.bed, cls.cell, crs=31287)

    @classmethod
    def case(cls, **terrain: object) -> granflow.Case:
        return granflow.Case(
            title="A mountain",
            terrain={"dem": cls.raster(), **terrain},
            material={"density": 200.0, "friction": {"coulomb": {"mu": 0.35}}},
            release=[{"raster": cls.thickness}],
            time={"until": "rest", "end": 60.0},
        )


@pytest.fixture(scope="session")
def mountain() -> type[Mountain]:
    return Mountain


SILO = """
title = "A silo breaks"
model = "savage_hutter"
grid.x = { from = -6.0, to = 6.0, cells = 240 }
material.friction.coulomb = { angle = "18 deg" }
initial.thickness.steps = { at = [-1.0, 1.0], values = [0.3, 2.3, 0.3] }
time.until = "rest"
"""


@pytest.fixture
def silo() -> granflow.Case:
    return granflow.Case(SILO)
