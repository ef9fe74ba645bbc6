"""Exact solutions of the Savage-Hutter and Hadeler-Kuttler equations, as functions of arrays.

Places and times are numbers or arrays that broadcast against each other; results have their common shape. Angles are in radians.
In SI units ``beta = g k cos(slope)``; in the papers' scaling ``beta = epsilon k cos(slope)`` and gravity is 1.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native

Numbers = NDArray[np.float64]

__all__ = [
    "Contour",
    "Flow",
    "Flow2",
    "Lake",
    "Motion",
    "Pile",
    "flat_dam_break",
    "flat_dam_break_front",
    "granular_jump",
    "parabolic_cap",
    "pile_on_disc",
    "pile_on_rectangle",
    "riemann",
    "ritter",
    "similarity_cap",
    "sliding_slab",
    "slope_dam_break",
    "stoker",
    "thacker",
]


class Flow(NamedTuple):
    """Depth normal to the bed and velocity along it."""

    h: Numbers
    u: Numbers


class Flow2(NamedTuple):
    """Depth and the velocities along x and y."""

    h: Numbers
    u: Numbers
    v: Numbers


class Lake(NamedTuple):
    """Depth, velocities, and the height of the bed."""

    h: Numbers
    u: Numbers
    v: Numbers
    bed: Numbers


class Contour(NamedTuple):
    """Where the flow has a given depth, and its velocity there; NaN where the solution is not known."""

    x: Numbers
    u: Numbers


class Motion(NamedTuple):
    """Way down the slope and speed."""

    x: Numbers
    u: Numbers


class Pile(NamedTuple):
    """Standing and rolling layer of a pile that grows no more."""

    standing: Numbers
    rolling: Numbers


def _each(function: Callable[..., Any], places: Sequence[ArrayLike], *parameters: Any) -> list[Numbers]:
    arrays = np.broadcast_arrays(*(np.asarray(place, dtype=np.float64) for place in places))
    shape = arrays[0].shape
    found = function(*(np.ascontiguousarray(array).ravel() for array in arrays), *parameters)
    return [one.reshape(shape) for one in found]


def riemann(
    x: ArrayLike, t: ArrayLike, *, beta: float, left: tuple[float, float], right: tuple[float, float]
) -> Flow:
    """The Riemann problem h_t + (h u)_x = 0, (h u)_t + (h u^2 + beta h^2/2)_x = 0 with a jump at x = 0.

    Args:
        x, t: places and times.
        beta: pressure constant, > 0.
        left, right: (h, u) on both sides; h may be 0.
    """
    return Flow(*_each(_native.riemann, (x, t), beta, list(left), list(right)))


def stoker(x: ArrayLike, t: ArrayLike, *, beta: float, h_left: float, h_right: float) -> Flow:
    """A dam between two depths breaks (Stoker): :func:`riemann` from rest."""
    return riemann(x, t, beta=beta, left=(h_left, 0.0), right=(h_right, 0.0))


def ritter(x: ArrayLike, t: ArrayLike, *, beta: float, h_left: float) -> Flow:
    """A dam breaks over a dry bed (Ritter)."""
    return riemann(x, t, beta=beta, left=(h_left, 0.0), right=(0.0, 0.0))


def slope_dam_break(
    x: ArrayLike,
    t: ArrayLike,
    *,
    h0: float,
    slope: float,
    friction: float,
    gravity: float = 9.81,
    earth_pressure: float = 1.0,
) -> Flow:
    """Dam break on a slope that friction does not hold (Mangeney, Heinrich & Roche 2000); friction <= slope."""
    return Flow(*_each(_native.slope_dam_break, (x, t), gravity, h0, slope, friction, earth_pressure))


def flat_dam_break(h: ArrayLike, t: ArrayLike, *, mu: float) -> Contour:
    """Dam break on a flat bed with Coulomb friction, depth 1 in x < 0, gravity 1: where the depth is `h` at time `t`.

    Known for h from 1e-3 to below 1 and 0 < t < 2/mu.
    """
    return Contour(*_each(_native.flat_dam_break, (h, t), mu))


def flat_dam_break_front(t: ArrayLike, *, mu: float) -> Numbers:
    """The front of :func:`flat_dam_break`: 2 t - mu t^2/2 until it stops at t = 2/mu."""
    return _each(_native.flat_dam_break_front, (t,), mu)[0]


def granular_jump(
    x: ArrayLike, t: ArrayLike, *, beta: float, minus: tuple[float, float], h_plus: float
) -> Flow:
    """A jump from (h, u) = `minus` on the side of smaller x to the depth `h_plus`, at x = 0 at t = 0."""
    return Flow(*_each(_native.granular_jump, (x, t), beta, list(minus), h_plus))


def sliding_slab(t: ArrayLike, *, slope: float, friction: float, u0: float, gravity: float = 9.81) -> Motion:
    """A uniform slab slides down a plane from the speed `u0` and stops: friction > slope."""
    return Motion(*_each(_native.sliding_slab, (t,), gravity, slope, friction, u0))


def parabolic_cap(
    x: ArrayLike,
    t: ArrayLike,
    *,
    height: float,
    length: float,
    slope: float,
    friction: float,
    gravity: float = 9.81,
    earth_pressure: float = 1.0,
) -> Flow:
    """A parabolic cap slides down a plane and spreads (Savage & Hutter 1989); x is measured from its first centre."""
    cap = [height, length, slope, friction, earth_pressure, gravity]
    return Flow(*_each(_native.parabolic_cap, (x, t), cap))


def similarity_cap(
    x: ArrayLike,
    y: ArrayLike,
    t: float,
    *,
    height: float,
    length: float,
    length_y: float,
    slope: float,
    friction: float,
    gravity: float = 9.81,
    earth_pressure: float = 1.0,
    earth_pressure_y: float = 1.0,
) -> Flow2:
    """The same in two dimensions, at one time: half lengths `length` down and `length_y` across the slope."""
    cap = [height, length, slope, friction, earth_pressure, gravity]
    return Flow2(*_each(_native.similarity_cap, (x, y), t, cap, length_y, earth_pressure_y))


def thacker(
    x: ArrayLike, y: ArrayLike, t: ArrayLike, *, a: float, sigma: float, h0: float, gravity: float = 9.81
) -> Lake:
    """A lake that circles in a paraboloid (Thacker 1981): radius `a` and depth `h0` at rest, its centre on a circle `sigma`."""
    return Lake(*_each(_native.thacker, (x, y, t), gravity, a, sigma, h0))


def pile_on_rectangle(
    x: ArrayLike,
    y: ArrayLike,
    *,
    sides: tuple[float, float],
    source: float = 1.0,
    open_x: tuple[bool, bool] = (True, True),
    open_y: tuple[bool, bool] = (True, True),
) -> Pile:
    """The equilibrium on the table [0, sides[0]] x [0, sides[1]] under a constant source; closed sides are walls."""
    open_sides = [list(open_x), list(open_y)]
    return Pile(*_each(_native.pile_on_rectangle, (x, y), list(sides), open_sides, source))


def pile_on_disc(r: ArrayLike, *, radius: float, source: float = 1.0, hole: float | None = None) -> Pile:
    """The equilibrium on a round table at distance `r` of its centre: open all round, or walled with a `hole` in the middle."""
    return Pile(*_each(_native.pile_on_disc, (r,), radius, source, hole))
