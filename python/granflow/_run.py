"""A case from its start to its end."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Mapping
from os import PathLike, fspath
from pathlib import Path
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
    out: str | PathLike[str] | None = None,
    resume: bool = False,
) -> xr.Dataset:
    """Computes a case and returns what its ``result.nc`` would hold; without `out` no file is written.

    Args:
        case: a :class:`Case`, or what one is made of: a path, a text, a dictionary.
        threads: so many threads; None takes all cores. Results are the same bits for any number.
        progress: show a bar; None shows one in a notebook and where standard error is a terminal.
        out: a folder for all that ``granflow run`` writes (``result.nc``, ``summary.json``, ``mass.csv``, what ``output.files`` asks for),
            the same bits; what an earlier run left there goes into ``previous/``, with a warning.
        resume: go on from the checkpoint in `out`: of a run that was stopped or killed, or with another ``time.end`` or friction. A run
            that has ended is not computed again; its ``result.nc`` is then opened by xarray, which needs netCDF4 or h5netcdf.

    Returns:
        The series over ``time`` (``thickness``, ``velocity_x``, ...; shape (time, y, x) or (time, x)), the maps (``peak_speed``,
        ``deposit``, ...; shape (y, x) or (x)), with names, units, precision and attributes of ``result.nc``; row 0 lies in the south.
        ``ds.attrs["summary"]`` is ``summary.json`` as text, ``ds.granflow.summary`` the same as a dictionary.

    Raises:
        CaseError: the case is wrong; a FileNotFoundError too where a file is missing.
        ComputationError: a step could not be taken, or a result breaks a law of its own.
        ValueError: with `resume`, there is nothing in `out` that this case can go on from; the reason is said.
        KeyboardInterrupt: Ctrl-C; the run ends at its next step, and with `out` all files are whole and ``resume=True`` goes on.
    """
    if resume and out is None:
        raise ValueError("resume=True goes on from a folder: name it by out=...")
    case = as_case(case)
    with _Bar(_wants_bar() if progress is None else progress) as show:
        found = _native.run(case._native, whole("threads", threads or 0), show, out, resume)
    if "ended" in found:
        warnings.warn(found["ended"], GranflowWarning, stacklevel=2)
        return _opened(Path(fspath(out or "")))
    _warn(found["remarks"])
    return _dataset(found)


def whole(name: str, given: int) -> int:
    """A number of things, from 0 on."""
    if given < 0:
        raise ValueError(f"{name} = {given}: it is a number from 0 on")
    return given


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


def _opened(folder: Path) -> xr.Dataset:
    """What a run that has ended left in a folder."""
    with xr.open_dataset(folder / "result.nc", decode_times=False) as stored:
        dataset = stored.load()
    dataset.attrs["summary"] = (folder / "summary.json").read_text(encoding="utf-8")
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
