"""What Python costs around a run: the program's steps and set-up beside the time of `granflow.run`, and what arrays cost.

    python python/benches/cost.py [CASE.toml]

Without a case: a mountain by a formula, 300 x 120 cells of 10 m.
"""

from __future__ import annotations

import sys
import time

import numpy as np

import granflow
from granflow import _native
from granflow._run import _dataset


def mountain() -> granflow.Case:
    x, y = np.meshgrid(np.arange(5.0, 3000.0, 10.0), np.arange(5.0, 1200.0, 10.0))
    bed = 900.0 * np.exp(-x / 700.0) + 5e-4 * (y - 600.0) ** 2
    return granflow.Case(
        terrain={"dem": granflow.Raster(bed, 10.0)},
        material={"density": 200.0, "friction": {"coulomb": {"mu": 0.3}}},
        release=[{"cap": {"height": 3.0, "centre": [300.0, 600.0], "radius": 120.0}}],
        time={"until": "rest", "end": 400.0},
    )


def main() -> None:
    case = granflow.Case(sys.argv[1]) if len(sys.argv) > 1 else mountain()
    around, inside = [], []
    for _ in range(9):
        begun = time.perf_counter()
        # As granflow.run does it; all that Rust does without Python says its own time.
        found = _native.run(case._native, 0, None)
        _dataset(found)
        around.append(time.perf_counter() - begun)
        inside.append(found["seconds"])
    # The least: what else the machine does only adds.
    cost, wall = min(a - b for a, b in zip(around, inside, strict=True)), min(inside)
    print(f"run in Rust {1e3 * wall:.0f} ms, Python around it {1e3 * cost:.1f} ms ({100 * cost / wall:.1f} %)")
    sim = granflow.Simulation(case)
    begun = time.perf_counter()
    for _ in range(1000):
        sim.state
    print(f"views of {sim.state[0].shape} cells: {1e3 * (time.perf_counter() - begun):.0f} us")
    begun = time.perf_counter()
    for _ in range(100):
        sim.step()
    many = time.perf_counter() - begun
    begun = time.perf_counter()
    sim.step(100)
    print(f"100 steps one by one {1e3 * many:.0f} ms, at once {1e3 * (time.perf_counter() - begun):.0f} ms")


if __name__ == "__main__":
    main()
