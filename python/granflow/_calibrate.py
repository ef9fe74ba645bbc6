"""Back-calculation: which values of a case give what was observed?"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Any, Literal

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from . import _memory
from ._case import Case, as_case
from ._errors import ComputationError
from ._memory import Raster
from ._run import _wants_bar, run

Range = Sequence[float] | Mapping[str, Any]
_Field = NDArray[np.float64]

#: Each cell is divided into so many parts along each axis where areas are compared.
FINE = 4


@dataclass(frozen=True)
class Calibration:
    """What :func:`calibrate` found.

    Attributes:
        best: the values that fit best, by their keys.
        score: their score: the critical success index, or the difference in metres or cubic metres.
        case: the case with these values.
        trials: all runs in their order: the values of each key under its name, and ``score`` (NaN where the run failed).
        study: the study of optuna, for its plots and importances.
    """

    best: dict[str, Any]
    score: float
    case: Case
    trials: dict[str, NDArray[Any]]
    study: Any


def calibrate(
    case: Case | str | PathLike[str] | Mapping[str, Any],
    observed: Any,
    over: Mapping[str, Range],
    *,
    score: Literal["csi", "runout", "volume"] = "csi",
    runs: int = 60,
    by: Literal["deposit", "footprint"] = "deposit",
    threshold: float = 0.1,
    seed: int = 0,
    threads: int | None = None,
    progress: bool | None = None,
) -> Calibration:
    """Searches the values of a case whose run fits best what was observed, by optuna (``pip install ".[calibrate]"``).

    Args:
        case: an avalanche, a :class:`Case` or what one is made of.
        observed: what was mapped: an outline (shapely geometry, GeoDataFrame, GeoJSON as a dictionary; these need shapely), a map of
            thicknesses (:class:`Raster`, ``xarray.DataArray``), a run (``xarray.Dataset``); for ``runout`` and ``volume`` also a number.
        over: the keys that are searched, each with its ends ``(low, high)``, ``{"uniform": [low, high]}``, or
            ``{"choice": [...]}`` of numbers and words: ``{"material.friction.coulomb.mu": (0.2, 0.6)}``.
        score: ``"csi"``, the area hit by the area hit, missed or false, 1 is a perfect fit; ``"runout"``, the difference in metres of
            the horizontal distances of the farthest place from the highest one that the run reached; ``"volume"``, the difference of the
            volumes of the deposits in cubic metres.
        runs: how many runs.
        by: the area of a run: where its deposit, or its peak thickness, exceeds `threshold`.
        threshold: thickness in metres.
        seed: another one searches another way; the same one finds the same values.
        threads: of each run; None takes all cores.
        progress: show a bar; None shows one in a notebook and where standard error is a terminal.

    Raises:
        CaseError: the case is wrong, or does not take a value.
        ComputationError: all runs failed.
    """
    optuna = _optuna()
    if score not in ("csi", "runout", "volume"):
        raise ValueError(f"score = {score!r}: allowed are 'csi', 'runout' and 'volume'")
    if not over:
        raise ValueError("over = {}: name the keys that are searched, each with its ends")
    base = as_case(case).copy()
    measure = _measure(observed, score, "deposit" if by == "deposit" else "peak_thickness", threshold)

    def objective(trial: Any) -> float:
        tried = base.copy()
        for key, given in over.items():
            tried.set(key, _suggest(trial, key, given))
        return measure(run(tried, threads=threads, progress=False))

    study = optuna.create_study(
        direction="maximize" if score == "csi" else "minimize",
        sampler=optuna.samplers.TPESampler(seed=seed, n_startup_trials=max(5, runs // 5)),
    )
    shown = _wants_bar() if progress is None else progress
    study.optimize(objective, n_trials=runs, catch=(ComputationError,), show_progress_bar=shown)
    if not any(trial.value is not None for trial in study.trials):
        raise ComputationError(f"all {runs} runs failed", float("nan"))
    best = dict(study.best_params)
    fitted = base.copy()
    for key, value in best.items():
        fitted.set(key, value)
    trials: dict[str, NDArray[Any]] = {
        key: np.array([trial.params.get(key) for trial in study.trials]) for key in over
    }
    trials["score"] = np.array([np.nan if trial.value is None else trial.value for trial in study.trials])
    return Calibration(best, float(study.best_value), fitted, trials, study)


def _optuna() -> Any:
    try:
        import optuna
    except ImportError as error:
        raise ImportError('granflow.calibrate needs optuna: pip install optuna, or pip install ".[calibrate]"') from error
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    return optuna


def _suggest(trial: Any, key: str, given: Range) -> Any:
    if isinstance(given, Mapping) and "choice" in given:
        return trial.suggest_categorical(key, list(given["choice"]))
    low, high = ends(key, given)
    return trial.suggest_float(key, low, high)


def ends(key: str, given: Range) -> tuple[float, float]:
    """The ends of the values of a key."""
    pair = given.get("uniform") if isinstance(given, Mapping) else given
    if pair is None or len(pair) != 2 or not float(pair[0]) < float(pair[1]):
        raise ValueError(f"{key}: {given!r} is no pair of a lower and a larger number")
    return float(pair[0]), float(pair[1])


def _measure(observed: Any, score: str, name: str, threshold: float) -> Callable[[xr.Dataset], float]:
    """How far a run is from what was observed."""
    if isinstance(observed, (int, float, np.number)):
        if score == "csi":
            raise ValueError("score = 'csi' compares areas: give an outline, a map or a run, not a number")
        number = float(observed)
        if score == "volume":
            return lambda ds: abs(ds.granflow.summary["mass_final"] - number)
        return lambda ds: abs(_reach(_area(ds, ds[name], threshold), ds, threshold) - number)
    if score == "volume":
        return lambda ds: abs(_volume(ds, ds[name]) - _volume(ds, _observed_thickness(observed, name, ds)))
    if score == "runout":
        return lambda ds: abs(
            _reach(_area(ds, ds[name], threshold), ds, threshold)
            - _reach(_observed_area(observed, name, ds, threshold), ds, threshold)
        )
    return lambda ds: _csi(_area(ds, ds[name], threshold), _observed_area(observed, name, ds, threshold))


def _csi(ours: NDArray[np.bool_], theirs: NDArray[np.bool_]) -> float:
    either = np.count_nonzero(ours | theirs)
    return np.count_nonzero(ours & theirs) / either if either else 1.0


def _parts(centres: xr.DataArray) -> _Field:
    """The middles of the parts into which cells are divided."""
    step = float(centres[1] - centres[0])
    offsets = (np.arange(FINE) + 0.5) / FINE - 0.5
    return np.asarray((centres.values[:, None] + step * offsets).ravel(), dtype=float)


def _area(ds: xr.Dataset, thickness: xr.DataArray | _Field, threshold: float) -> NDArray[np.bool_]:
    """Where a thickness on the cells of a run exceeds the threshold, in parts of cells: on straight lines between centres."""
    fine: _Field = np.nan_to_num(np.asarray(thickness, dtype=float))
    for axis, name in enumerate(_axes(ds)):
        centres, parts = ds[name].values, _parts(ds[name])
        fine = np.apply_along_axis(lambda line: np.interp(parts, centres, line), axis, fine)
    return np.asarray(fine > threshold)


def _axes(ds: xr.Dataset) -> list[str]:
    return ["y", "x"] if "y" in ds.sizes else ["x"]


def _reach(area: NDArray[np.bool_], ds: xr.Dataset, threshold: float) -> float:
    """The horizontal distance of the farthest place of an area from the highest one that the run reached."""
    if not area.any():
        return 0.0
    reached = np.nan_to_num(ds["peak_thickness"].values) > threshold
    height = ds["bed"].values if "bed" in ds else -np.broadcast_to(ds["x"].values, reached.shape)
    top = np.unravel_index(np.argmax(np.where(reached, height, -np.inf)), reached.shape)
    squares: Any = 0.0
    for axis, name in enumerate(_axes(ds)):
        shape = [-1 if axis == other else 1 for other in range(area.ndim)]
        squares = squares + (_parts(ds[name]).reshape(shape) - float(ds[name][top[axis]])) ** 2
    return float(np.sqrt(np.max(np.where(area, squares, 0.0))))


def _volume(ds: xr.Dataset, thickness: xr.DataArray | _Field) -> float:
    cell = np.prod([float(ds[name][1] - ds[name][0]) for name in _axes(ds)])
    return float(np.nansum(np.asarray(thickness, dtype=float)) * cell)


def _observed_thickness(observed: Any, name: str, ds: xr.Dataset) -> _Field:
    """A map of thicknesses in the centres of the cells of a run; 0 outside it."""
    if isinstance(observed, xr.Dataset):
        observed = observed[name]
    if isinstance(observed, xr.DataArray) and observed.ndim == 1:
        return np.asarray(np.interp(ds["x"].values, observed["x"].values, observed.values, left=0.0, right=0.0))
    if isinstance(observed, xr.DataArray):
        observed = Raster.from_dataarray(observed)
    if not isinstance(observed, Raster):
        raise ValueError(f"no map of thicknesses: {type(observed).__name__}; give a Raster, a DataArray or a run")
    values = observed.south_first()
    column = np.floor((ds["x"].values - observed.west) / observed.cell).astype(int)
    row = np.floor((ds["y"].values - observed.south) / observed.cell).astype(int)
    inside = ((row >= 0) & (row < values.shape[0]))[:, None] & ((column >= 0) & (column < values.shape[1]))
    taken = values[np.clip(row, 0, values.shape[0] - 1)[:, None], np.clip(column, 0, values.shape[1] - 1)]
    return np.where(inside, np.nan_to_num(taken), 0.0)


def _observed_area(observed: Any, name: str, ds: xr.Dataset, threshold: float) -> NDArray[np.bool_]:
    if not _memory.is_geometry(observed):
        return _area(ds, _observed_thickness(observed, name, ds), threshold)
    if "y" not in ds.sizes:
        raise ValueError("an outline needs a run in two dimensions; give a map, a run or a number")
    try:
        import shapely
    except ImportError as error:
        raise ImportError("an outline is compared by shapely: pip install shapely") from error
    found = json.loads(_memory.geojson(observed))
    features = found.get("features", [found])
    outline = shapely.union_all([shapely.geometry.shape(one.get("geometry", one)) for one in features])
    shapely.prepare(outline)
    x, y = np.meshgrid(_parts(ds["x"]), _parts(ds["y"]))
    return np.asarray(shapely.contains_xy(outline, x, y), dtype=bool)
