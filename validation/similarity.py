"""Runs granflow and AvaFrame's com1DFA on a cap that spreads while it slides down a plane, and compares both with the similarity solution."""

import argparse
import dataclasses
import json
import math
import pathlib
import sys

from environment import AVAFRAME, enter, fresh_folder, guarded
from locate import program

EPILOG = """
A cap of the height h0 (1 - (x² + y²)/L²), measured in the plane and normal to it, is released on a plane of the angle zeta with
Coulomb friction. The solution after Hutter, Siegel, Savage and Nohguchi, Acta Mechanica 100 (1993), with earth pressure 1, keeps
the cap a cap: two ordinary differential equations for its half axes. It takes friction along the slope for the friction of the whole
mass and linearises the part across. Coulomb's law does neither, so that an error of a few per cent remains on any grid. With
--delta 0 there is no friction, nothing is linearised, and the solution is one of the equations: the error that is left is the code's.

Without options the case is the one of AvaFrame's own test (L 80 m, h0 4 m, zeta 35, delta 25 degrees, 5 s), and the same without
friction.

example: python3 validation/similarity.py --cell 5 --cell 2.5 --out similar
"""


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", required=True, type=pathlib.Path, help="a new folder for everything that is written")
    parser.add_argument("--cell", action="append", type=float, help="cell size [m], may be repeated; default: 5, 2.5")
    parser.add_argument("--zeta", type=float, default=35.0, help="inclination of the plane [degrees] (default 35)")
    parser.add_argument("--delta", action="append", type=float, help="friction angle [degrees], may be repeated; default: 25, 0")
    parser.add_argument("--end", type=int, default=5, help="seconds, a whole number; compared at each (default 5)")
    parser.add_argument("--scheme", action="append", help="of granflow, may be repeated; default: energy_stable_2, energy_stable")
    parser.add_argument("--com1dfa", action="append", default=[], metavar="KEY=VALUE", help="a setting of com1DFA, may be repeated")
    parser.add_argument("--no-avaframe", action="store_true", help="granflow alone")
    parser.add_argument("--threads", type=int, default=1, help="of granflow (default 1: com1DFA uses one)")
    parser.add_argument("--granflow", help="the program; default: target/release/granflow of this clone")
    parser.add_argument("--venv", help="environment for AvaFrame; default: validation/venv-avaframe, made where it is missing")
    chosen = parser.parse_args()
    chosen.cell = chosen.cell or [5.0, 2.5]
    chosen.delta = [25.0, 0.0] if chosen.delta is None else chosen.delta
    chosen.scheme = chosen.scheme or ["energy_stable_2", "energy_stable"]
    if not 0 < chosen.zeta < 60 or any(not 0 <= delta < chosen.zeta for delta in chosen.delta):
        parser.error("0 <= delta < zeta < 60: on a plane that holds the mass nothing slides")
    if chosen.end < 1 or min(chosen.cell) <= 0 or max(chosen.cell) > 20:
        parser.error("--end is at least 1, --cell above 0 and at most 20: the cap has a half axis of 80 m")
    for change in chosen.com1dfa:
        if "=" not in change:
            parser.error(f"{change}: a change is KEY=VALUE")
    return chosen


@dataclasses.dataclass(frozen=True)
class Cap:
    """The case: half axis and height [m] of the cap, gravity [m/s²], angles [radians]."""

    zeta: float
    delta: float
    length: float = 80.0
    height: float = 4.0
    gravity: float = 9.81


def solution(cap, times):
    """Half axes over L along and across the slope, their rates [1/s], place and speed of the centre along the plane, at `times` [s].

    With a = g sin zeta, c = g cos zeta tan delta, k = 2 g cos zeta h0 / L²: the centre falls with a - c; half axes L p and L q obey
    p'' = k / (p² q) and q'' = k / (p q²) - c q' / ((a - c) t): friction across is that of the whole mass, turned by the small angle
    of the velocity. At t -> 0 its last term is c k / a, so that q starts as 1 + (1 - c/a) k t² / 2.
    """
    import numpy
    from scipy.integrate import solve_ivp

    pull = cap.gravity * math.sin(cap.zeta)
    friction = cap.gravity * math.cos(cap.zeta) * math.tan(cap.delta)
    k = 2 * cap.gravity * math.cos(cap.zeta) * cap.height / cap.length**2
    start = 1e-3
    first = [1 + k * start**2 / 2, k * start, 1 + (1 - friction / pull) * k * start**2 / 2, (1 - friction / pull) * k * start]

    def rates(t, state):
        p, dp, q, dq = state
        return [dp, k / (p * p * q), dq, k / (p * q * q) - friction * dq / ((pull - friction) * t)]

    later = numpy.maximum(times, start)
    found = solve_ivp(rates, (start, later[-1] + 1e-9), first, t_eval=later, rtol=1e-10, atol=1e-12)
    place, speed = (pull - friction) * times**2 / 2, (pull - friction) * times
    found.y[1::2, times == 0] = 0
    return found.y, place, speed


def fields(cap, times, x, y):
    """Thickness and horizontal velocity of the solution at cell centres, for each time; x downhill, horizontal, from the centre."""
    import numpy

    (p, dp, q, dq), place, speed = solution(cap, times)
    along, across = x[None, :] / math.cos(cap.zeta), y[:, None]
    answer = []
    for n in range(len(times)):
        offset = along - place[n]
        h = cap.height / (p[n] * q[n]) * (1 - (offset / (cap.length * p[n])) ** 2 - (across / (cap.length * q[n])) ** 2)
        u = (speed[n] + offset * dp[n] / p[n]) * math.cos(cap.zeta) + 0 * across
        v = across * dq[n] / q[n] + 0 * along
        wet = h > 0
        answer.append((numpy.where(wet, h, 0), numpy.where(wet, u, 0), numpy.where(wet, v, 0)))
    return answer


def grids(cap, cell, end):
    """Cell centres of a plane that the cap does not leave: x downhill from -1.6 L, y to both sides, whole cells."""
    import numpy

    (p, _, q, _), place, _ = solution(cap, numpy.array([float(end)]))
    far = math.cos(cap.zeta) * (place[0] + 1.3 * cap.length * p[0]) + 5 * cell
    side = 1.35 * cap.length * max(q[0], 1.0) + 5 * cell
    columns, half = math.ceil((far + 1.6 * cap.length) / cell), math.ceil(side / cell)
    x = -1.6 * cap.length + cell * (numpy.arange(columns) + 0.5)
    y = cell * (numpy.arange(-half, half) + 0.5)
    return x, y


def write_grid(path, x, y, values):
    """An ESRI ASCII grid; `values` with rows from the south."""
    import numpy

    cell = x[1] - x[0]
    head = f"ncols {len(x)}\nnrows {len(y)}\nxllcorner {x[0] - cell / 2:.9f}\nyllcorner {y[0] - cell / 2:.9f}\ncellsize {cell:.9f}\nNODATA_value -9999\n"
    with path.open("w", encoding="utf-8") as file:
        file.write(head)
        numpy.savetxt(file, values[::-1], fmt="%.9g")


def inputs(folder, cap, cell, end):
    """Plane and release as rasters: a mean over each cell, so that both codes start with the same volume."""
    import numpy

    folder.mkdir(parents=True)
    x, y = grids(cap, cell, end)
    write_grid(folder / "plane.asc", x, y, 2000 - math.tan(cap.zeta) * x[None, :] + 0 * y[:, None])
    parts = (numpy.arange(8) + 0.5) / 8 - 0.5
    fine_x, fine_y = (x[:, None] + cell * parts).ravel(), (y[:, None] + cell * parts).ravel()
    radius = (fine_x[None, :] / math.cos(cap.zeta)) ** 2 + fine_y[:, None] ** 2
    h = numpy.maximum(cap.height * (1 - radius / cap.length**2), 0).reshape(len(y), 8, len(x), 8).mean((1, 3))
    write_grid(folder / "release.asc", x, y, h)
    return x, y


@dataclasses.dataclass
class Series:
    """Thickness [m] and horizontal velocity [m/s] at each time, rows from the south; seconds on the clock and of the processor."""

    name: str
    frames: list
    seconds: float
    cpu: float
    version: str


def granflow(folder, ground, cap, scheme, chosen):
    """granflow's frames, one a second."""
    import netCDF4
    import numpy
    import runs

    friction = f"mu = {math.tan(cap.delta)!r}"
    case = f"""[terrain]
dem = {json.dumps(str(ground / "plane.asc"))}
[material]
density = 200.0
friction.coulomb = {{ {friction} }}
[[release]]
raster = {json.dumps(str(ground / "release.asc"))}
[scheme]
name = {json.dumps(scheme)}
[time]
end = {float(chosen.end)}
[output]
every = 1.0
precision = "f64"
files = ["netcdf", "geotiff"]
"""
    run = runs.granflow(folder, case, f"granflow, {scheme}", threads=chosen.threads, path=chosen.granflow)
    with netCDF4.Dataset(run.folder / "result.nc") as data:
        values = [numpy.nan_to_num(numpy.ma.filled(data[name][:].astype(float), 0.0)) for name in ("thickness", "velocity_x", "velocity_y")]
    return Series(run.name, list(zip(*values)), run.seconds, run.cpu, run.version)


def com1dfa(folder, ground, cap, cell, chosen):
    """com1DFA's frames, one a second, with the settings of AvaFrame's own test where they differ from its defaults.

    Friction is explicit, as there. Implicit friction, com1DFA's default, is divided by the speed before the step, and holds a mass that
    starts from rest back for seconds: --com1dfa explicitFriction=0 shows it.
    """
    import runs

    asked = {"simTypeList": "null", "resType": "ppr|pft|pfv|FT|Vx|Vy", "tSteps": "0:1", "rho": 200, "tEnd": chosen.end, "stopCrit": 0,
             "meshCellSize": cell, "sphKernelRadius": cell, "frictModel": "Coulomb", "mucoulomb": math.tan(cap.delta), "sphOption": 2,
             "viscOption": 2, "subgridMixingFactor": 5, "massPerParticleDeterminationMethod": "MPPKR", "nPPK0": 20, "splitOption": 1,
             "explicitFriction": 1, "sphKernelRadiusTimeStepping": True, "cMax": 0.02, **dict(change.split("=", 1) for change in chosen.com1dfa)}
    run = runs.com1dfa(folder, ground / "plane.asc", ground / "release.asc", asked, "com1DFA")
    steps = run.folder / "Outputs" / "com1DFA" / "peakFiles" / "timeSteps"
    frames = []
    for second in range(chosen.end + 1):
        near = lambda path: abs(float(path.stem.rsplit("_t", 1)[1]) - second)
        frames.append([runs.raster(min(steps.glob(f"*_{name}_t*"), key=near))[0][::-1] for name in ("FT", "Vx", "Vy")])
    return Series(run.name, frames, run.seconds, run.cpu, run.version)


def errors(exact, found):
    """L2 errors of thickness and of thickness times velocity at each time, over the norm of the solution."""
    import numpy

    rows = []
    for (h, u, v), (k, w, z) in zip(exact, found):
        norm = lambda *parts: math.sqrt(sum(float(numpy.sum(part * part)) for part in parts))
        flow = norm(h * u, h * v)
        rows.append({"thickness": norm(k - h) / norm(h), "momentum": norm(k * w - h * u, k * z - h * v) / flow if flow else None})
    return rows


def main():
    chosen = arguments()
    program(chosen.granflow)
    out = fresh_folder(chosen.out)
    enter("avaframe", AVAFRAME, chosen.venv)
    import numpy
    import profiles

    times = numpy.arange(chosen.end + 1.0)
    groups = []
    for delta in chosen.delta:
        cap = Cap(math.radians(chosen.zeta), math.radians(delta))
        for cell in chosen.cell:
            folder = out / f"delta{delta:g}_{cell:g}m"
            x, y = inputs(folder, cap, cell, chosen.end)
            exact = fields(cap, times, x, y)
            found = []
            if not chosen.no_avaframe:
                print(f"delta {delta:g}, {cell:g} m: com1DFA", file=sys.stderr, flush=True)
                found.append(com1dfa(folder / "com1dfa", folder, cap, cell, chosen))
            for scheme in chosen.scheme:
                print(f"delta {delta:g}, {cell:g} m: granflow, {scheme}", file=sys.stderr, flush=True)
                found.append(granflow(folder / scheme, folder, cap, scheme, chosen))
            groups.append(profiles.Group(delta, cell, x, y, times, exact, found, [errors(exact, series.frames) for series in found]))
            profiles.figure(groups[-1], cap, out / f"delta{delta:g}_{cell:g}m.png")
            profiles.write(out, groups, chosen)
    print((out / "similarity.md").read_text(encoding="utf-8"))
    print(f"written: {out / 'similarity.md'}, similarity.json, a figure for each friction angle and cell size, and every run in a folder of its own")
    return 0


if __name__ == "__main__":
    guarded(main)
