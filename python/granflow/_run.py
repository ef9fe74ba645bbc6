"""A case from its start to its end."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Mapping
from os import PathLike
from typing import Any

import numpy as np
import xarray as xr

from . import _native
from ._case import Case, as_case
from ._errors import GranflowWarning


def run(
    case: Case | str | PathLike[str] | Mapping[str, Any],
    *,
    threads: int | None = None,
    progress: bool | None = None,
) -> xr.Dataset:
    """Computes a case and returns what its ``result.nc`` would hold, without a file.

    Args:
        case: a :class:`Case`, or what one is made of: a path, a text, a dictionary.
        threads: so many threads; None takes all cores. Results are the same bits for any number.
        progress: show a bar; None shows one in a notebook and where standard error is a terminal.

    Returns:
        The series over ``time`` (``thickness``, ``velocity_x``, ...; shape (time, y, x) or (time, x)), the maps (``peak_speed``,
        ``deposit``, ...; shape (y, x) or (x)), with names, units, precision and attributes of ``result.nc``; row 0 lies in the south.
        ``ds.attrs["summary"]`` is ``summary.json`` as text, ``ds.granflow.summary`` the same as a dictionary.

    Raises:
        CaseError: the case is wrong; a FileNotFoundError too where a file is missing.
        ComputationError: a step could not be taken, or a result breaks a law of its own.
        KeyboardInterrupt: Ctrl-C; the run ends at its next step.
    """
    case = as_case(case)
    with _Bar(_wants_bar() if progress is None else progress) as show:
        found = _native.run(case._native, threads or 0, show)
    _warn(found["remarks"])
    return _dataset(found)


def _dataset(found: dict[str, Any]) -> xr.Dataset:
    coords = {name: xr.Variable(axes, values, attrs) for name, axes, values, attrs in found["coords"]}
    variables: dict[str, xr.Variable] = {}
    if "crs" in found:
        variables["crs"] = xr.Variable((), np.int32(0), found["crs"])
    for name, axes, values, attrs in found["variables"]:
        variables[name] = xr.Variable(axes, values, attrs, encoding={"_FillValue": values.dtype.type("nan")})
    dataset = xr.Dataset(variables, coords, found["attrs"])
    if "summary" in found:
        dataset.attrs["summary"] = found["summary"]
    return dataset


def _warn(remarks: list[str]) -> None:
    for remark in remarks:
        if not remark.startswith("note: "):
            warnings.warn(remark.removeprefix("warning: "), GranflowWarning, stacklevel=3)


def _wants_bar() -> bool:
    return sys.stderr.isatty() or "ipykernel" in sys.modules


class _Bar:
    """A bar in simulated time, or with a count of steps where no end is known."""

    def __init__(self, shown: bool) -> None:
        self._shown = shown
        self._bar: Any = None

    def __enter__(self) -> Callable[[float, float | None, int, int, float], None] | None:
        return self._show if self._shown else None

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()

    def _show(self, time: float, end: float | None, steps: int, wet: int, speed: float) -> None:
        if self._bar is None:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # a notebook without widgets gets a bar of letters
                from tqdm.auto import tqdm
            form = "{desc} {percentage:3.0f}%|{bar}| {elapsed}<{remaining}" if end else "{desc} [{elapsed}]"
            self._bar = tqdm(total=end, bar_format=form, leave=False)
        self._bar.set_description_str(f"t = {time:.4g}, step {steps}, {wet} wet cells, speed {speed:.3g}", refresh=False)
        self._bar.n = time if end is None else min(time, end)
        self._bar.refresh()
