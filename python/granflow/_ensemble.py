"""Ensembles: many runs of one case, added up to maps of probability."""

from __future__ import annotations

import math
import os
import pickle
import warnings
from collections import OrderedDict
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from hashlib import blake2b
from os import PathLike
from threading import Lock
from typing import Any

import xarray as xr

from . import _native
from ._case import Case, as_case
from ._errors import CaseError, ComputationError, GranflowWarning
from ._run import _dataset, _wants_bar, _warn, run, whole
from ._tables import as_table

#: A chunk that a worker loses is computed again so many times.
TRIES = 4
#: Failed members that a warning names.
NAMED = 5
#: Members of a chunk at most: what a lost worker costs, and how often an executor reports.
LARGEST_CHUNK = 32


class Ensemble:
    """Many runs of one case with some of its values drawn (``docs/ensemble.md``).

    Args:
        case: a :class:`Case` with a table ``ensemble``, or what one is made of: a path, a text, a dictionary.

    Raises:
        CaseError: the case is wrong, has no such table, or does not take a value that would be drawn.

    The case is checked and set up once, here; what happens to it later changes nothing.
    """

    def __init__(self, case: Case | str | PathLike[str] | Mapping[str, Any]) -> None:
        self._case = as_case(case).copy()
        self._native = _native.Ensemble(self._case._native)
        self._sums = self._native.empty()
        _warn(self._native.remarks)

    def __len__(self) -> int:
        return self._native.count

    def __repr__(self) -> str:
        return f"<granflow.Ensemble: {self._native.text}>"

    def sample(self, number: int) -> dict[str, float | str]:
        """The values that member `number` has, by the keys of the case: a pure function of the case and the number."""
        values, _ = self._native.sample(number)
        return {key: text if value is None else value for key, value, text in values}

    def case(self, number: int) -> Case:
        """The case of member `number`, without the ensemble."""
        case = self._case.copy()
        changes = self._native.sample(number)[1]
        case._member, case._native = tuple(changes), case._native.of_member(changes)
        return case

    def member(self, number: int, *, threads: int | None = None, progress: bool | None = None) -> xr.Dataset:
        """Computes member `number` alone and returns all of it, as :func:`granflow.run` does."""
        return run(self.case(number), threads=threads, progress=progress)

    def run(
        self,
        executor: Executor | None = None,
        members: int | Iterable[int] | None = None,
        *,
        chunk: int | None = None,
        threads: int | None = None,
        progress: bool | None = None,
    ) -> xr.Dataset:
        """Computes members and returns the maps of all that this object has.

        Args:
            executor: who computes: any executor of PEP 3148, such as ``ProcessPoolExecutor()``, Dask's ``client.get_executor()``,
                ``MPIPoolExecutor()``; None takes the cores of this machine, which for one machine is the fastest. Workers send back
                what they have added up.
            members: which: so many from the first on, or their numbers, as ``range(200, 400)``; None computes all. Those that this object
                has already are not computed again.
            chunk: members that a worker is given at a time; None divides them evenly, at most 32.
            threads: members that are computed at a time without an executor; None takes all cores.
            progress: show a bar; None shows one in a notebook and where standard error is a terminal.

        Returns:
            Names, units and attributes of ``result.nc`` (``exceedance_peak_pressure_10``, ``p95_peak_speed``, ``count``, ...; shape (y, x)
            or (x), row 0 in the south). The bits are the same for any executor, number of workers, order and division into chunks.
            ``ds.attrs["members"]`` is ``members.csv`` as text, ``ds.granflow.members`` and :attr:`members` the same as a table.

        Raises:
            ComputationError: all members failed. Single ones are booked in the table, and a :class:`GranflowWarning` names them.
            KeyboardInterrupt: Ctrl-C; what came before is kept, and ``run`` goes on from it.

        A chunk whose worker is lost is computed again. If a whole pool breaks, as ``ProcessPoolExecutor`` does with the first worker
        that is killed, the rest is computed here, with a warning.
        """
        wanted = self._wanted(members)
        have = set(self._sums.numbers)
        left = [number for number in wanted if number not in have]
        with _Bar(len(wanted), _wants_bar() if progress is None else progress) as bar:
            bar.done(len(wanted) - len(left))
            if executor is None:
                self._run_here(_ranges(left, len(left)), whole("threads", threads or 0), bar)
            else:
                self._run_on(executor, list(_ranges(left, chunk or _chunk(len(left)))), bar)
        return self._results()

    @property
    def members(self) -> Any:
        """``members.csv`` of all members so far: a ``pandas.DataFrame`` where pandas is installed, else a dictionary of arrays."""
        return as_table(self._native.table(self._sums))

    def part(self) -> bytes:
        """All members so far as the bytes of a part file, which ``granflow merge`` and :meth:`add` take."""
        return self._native.part(self._sums)

    def add(self, part: bytes) -> Ensemble:
        """Adds the members of a part: what :meth:`part` gave, or the content of a file ``part-K-of-N.bin``.

        Raises:
            ValueError: it is of another case, inputs or version, or has a member that is here already.
        """
        self._native.add(self._sums, part)
        return self

    def _wanted(self, members: int | Iterable[int] | None) -> list[int]:
        if members is None:
            return list(range(len(self)))
        numbers = sorted({int(number) for number in (range(members) if isinstance(members, int) else members)})
        if not numbers or numbers[0] < 0 or numbers[-1] >= len(self):
            raise ValueError(f"members = {members!r}: the case has the members 0 to {len(self) - 1}")
        return numbers

    def _run_here(self, chunks: Iterable[range], workers: int, bar: _Bar) -> None:
        for numbers in chunks:
            before = bar.count
            ends = [numbers.start, numbers.stop]
            self._native.compute_here(self._sums, ends, workers, lambda done: bar.done(before + done))
            bar.done(before + len(numbers))

    def _run_on(self, executor: Executor, chunks: list[range], bar: _Bar) -> None:
        payload = pickle.dumps(self._case)
        token = blake2b(payload, digest_size=16).hexdigest()
        _READY.put(token, self._native)  # threads of this process take the one that is set up
        pending: dict[Future[bytes], tuple[range, int]] = {}
        try:
            for numbers in chunks:
                pending[executor.submit(compute, payload, token, numbers.start, numbers.stop)] = (numbers, 1)
            while pending:
                for future in wait(pending, return_when=FIRST_COMPLETED).done:
                    numbers, tries = pending.pop(future)
                    try:
                        part = future.result()
                    except (CaseError, ComputationError, ValueError, TypeError, MemoryError, pickle.PicklingError):
                        raise
                    except Exception as lost:  # every executor has errors of its own for a worker that is gone
                        if tries == TRIES or isinstance(lost, BrokenExecutor):
                            raise
                        again = executor.submit(compute, payload, token, numbers.start, numbers.stop)
                        pending[again] = (numbers, tries + 1)
                        continue
                    self._native.add(self._sums, part)
                    bar.done(bar.count + len(numbers))
        except BrokenExecutor as broken:
            have = set(self._sums.numbers)
            rest = [numbers for numbers in chunks if numbers.start not in have]
            count = sum(map(len, rest))
            text = f"the pool of workers broke ({broken}); {count} members are computed in this process"
            warnings.warn(text, GranflowWarning, stacklevel=3)
            self._run_here(rest, 0, bar)
        finally:
            for future in pending:
                future.cancel()

    def _results(self) -> xr.Dataset:
        failures = self._sums.failures
        if self._sums.computed == 0:
            number, failure = failures[0]
            raise ComputationError(f"all {len(failures)} members failed; member {number}: {failure}", math.nan)
        for number, failure in failures[:NAMED]:
            text = f"member {number} ({', '.join(self._native.sample(number)[1])}) failed: {failure}"
            warnings.warn(text, GranflowWarning, stacklevel=3)
        if len(failures) > NAMED:
            more = f"{len(failures) - NAMED} more members failed; the table names them"
            warnings.warn(more, GranflowWarning, stacklevel=3)
        found = self._native.results(self._sums)
        dataset = _dataset(found)
        dataset.attrs["members"] = self._native.table(self._sums)
        return dataset


def compute(payload: bytes, token: str, first: int, end: int) -> bytes:
    """What a worker does: some members, one after the other, added up. The ensemble is set up once in each process."""
    return _READY.get(payload, token).compute(first, end, 1)


class _Ready:
    """The ensembles that are set up in this process, the last ones used."""

    def __init__(self, most: int = 2) -> None:
        self._most = most
        self._lock = Lock()
        self._held: OrderedDict[str, _native.Ensemble] = OrderedDict()

    def put(self, token: str, ensemble: _native.Ensemble) -> None:
        with self._lock:
            self._hold(token, ensemble)

    def get(self, payload: bytes, token: str) -> _native.Ensemble:
        with self._lock:
            held = self._held.get(token)
            if held is None:
                held = _native.Ensemble(pickle.loads(payload)._native)
            self._hold(token, held)
            return held

    def _hold(self, token: str, ensemble: _native.Ensemble) -> None:
        self._held[token] = ensemble
        self._held.move_to_end(token)
        while len(self._held) > self._most:
            self._held.popitem(last=False)


_READY = _Ready()


def _chunk(count: int) -> int:
    return max(1, min(LARGEST_CHUNK, count // (8 * (os.cpu_count() or 1))))


def _ranges(numbers: list[int], most: int) -> Iterator[range]:
    """Numbers that grow as ranges without gaps, none longer than `most`."""
    begin = 0
    for k in range(1, len(numbers) + 1):
        if k == len(numbers) or numbers[k] != numbers[k - 1] + 1 or k - begin == most:
            yield range(numbers[begin], numbers[k - 1] + 1)
            begin = k


class _Bar:
    """A bar of members."""

    def __init__(self, wanted: int, shown: bool) -> None:
        self.count = 0
        self._wanted = wanted
        self._shown = shown
        self._bar: Any = None

    def __enter__(self) -> _Bar:
        if self._shown:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # a notebook without widgets gets a bar of letters
                from tqdm.auto import tqdm
            self._bar = tqdm(total=self._wanted, unit="member", leave=False)
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()

    def done(self, count: int) -> None:
        self.count = count
        if self._bar is not None:
            self._bar.n = count
            self._bar.refresh()
