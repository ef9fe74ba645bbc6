"""Sensitivity: which of the values of a case does a result depend on?"""

from __future__ import annotations

import os
from collections.abc import Mapping
from concurrent.futures import Executor, ThreadPoolExecutor
from os import PathLike
from typing import Any, Literal

import numpy as np
import xarray as xr

from ._calibrate import Range, ends
from ._case import Case, as_case
from ._run import run


def sensitivity(
    case: Case | str | PathLike[str] | Mapping[str, Any],
    over: Mapping[str, Range],
    *,
    output: str = "runout",
    method: Literal["sobol", "morris"] = "sobol",
    samples: int = 64,
    seed: int = 0,
    executor: Executor | None = None,
) -> xr.Dataset:
    """How a number of the summary depends on values of the case, by the samplers and estimators of SALib (``pip install SALib``).

    Args:
        case: a :class:`Case`, or what one is made of.
        over: the keys that vary, each with its ends ``(low, high)`` or ``{"uniform": [low, high]}``, independent of each other.
        output: a number of ``summary.json``: ``"runout"``, ``"max_speed"``, ``"peak_pressure_max"``, ...
        method: ``"sobol"``, shares of the variance (Saltelli 2010), of ``samples * (keys + 2)`` runs, `samples` a power of two;
            ``"morris"``, elementary effects, of ``samples * (keys + 1)`` runs, which tells with few runs what does not matter.
        samples: of the formulas above.
        seed: of the sample and of the confidence intervals.
        executor: who computes the runs, any executor of PEP 3148; None takes the cores of this machine.

    Returns:
        Along ``key``: of Sobol the index of the first order ``S1`` (share of the variance by this key alone) and the total one ``ST`` (with all
        its interactions), of Morris ``mu``, ``mu_star`` and ``sigma``, each with ``_conf``, half the 95 % interval, where SALib has one. The runs
        are beside them: ``values`` (run, key) and ``output`` (run).

    Raises:
        CaseError: the case does not take a value. ComputationError: a run failed.
    """
    if method not in ("sobol", "morris"):
        raise ValueError(f"method = {method!r}: allowed are 'sobol' and 'morris'")
    try:
        from SALib.analyze import morris as of_morris, sobol as of_sobol
        from SALib.sample import morris, sobol
    except ImportError as error:
        raise ImportError("granflow.sensitivity needs SALib: pip install SALib") from error
    base, keys = as_case(case).copy(), list(over)
    problem = {"num_vars": len(keys), "names": keys, "bounds": [list(ends(key, over[key])) for key in keys]}
    if method == "sobol":
        values = sobol.sample(problem, samples, calc_second_order=False, seed=seed)
    else:
        values = morris.sample(problem, samples, seed=seed)
    pool = ThreadPoolExecutor(os.cpu_count()) if executor is None else None
    try:
        work = [(base, dict(zip(keys, map(float, row), strict=True)), output) for row in values]
        found = np.array(list((executor or pool).map(number, work)))  # type: ignore[union-attr]
    finally:
        if pool is not None:
            pool.shutdown(cancel_futures=True)
    if method == "sobol":
        indices = of_sobol.analyze(problem, found, calc_second_order=False, seed=seed)
    else:
        indices = of_morris.analyze(problem, values, found, seed=seed)
    shown = {name: ("key", np.asarray(one, dtype=float)) for name, one in indices.items() if name != "names"}
    shown["values"] = (("run", "key"), values)  # type: ignore[assignment]
    shown["output"] = ("run", found)
    return xr.Dataset(shown, {"key": keys}, {"output": output, "method": method})


def number(work: tuple[Case, dict[str, float], str]) -> float:
    """What a worker does: one run on one thread, and a number of its summary."""
    case, values, output = work
    case = case.copy()
    for key, value in values.items():
        case.set(key, value)
    summary = run(case, threads=1, progress=False).granflow.summary
    if not isinstance(summary.get(output), (int, float)):
        known = ", ".join(sorted(name for name, one in summary.items() if isinstance(one, (int, float))))
        raise ValueError(f"output = {output!r} is no number of the summary; there are {known}")
    return float(summary[output])
