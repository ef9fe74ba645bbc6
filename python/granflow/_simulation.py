"""A run that one can hold."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping
from os import PathLike
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._case import Case, as_case
from ._errors import GranflowWarning, StaleViewError
from ._run import whole


class StateView(np.ndarray):
    """A field of a simulation: its own memory, read-only, without a copy.

    It may be used until the simulation goes on; then it raises :class:`StaleViewError`. ``.copy()`` keeps the numbers.
    """

    _field: str
    _simulation: Simulation | None = None
    _moves: int

    def __array_finalize__(self, other: Any) -> None:
        if isinstance(other, StateView) and other._simulation is not None and np.may_share_memory(self, other):
            self._field, self._simulation, self._moves = other._field, other._simulation, other._moves

    def _valid(self) -> NDArray[np.float64]:
        simulation = self._simulation
        if simulation is not None and simulation._moves != self._moves:
            raise StaleViewError(
                f"this view of {self._field!r} is of a state that the simulation has left (time {simulation.time} now): "
                f"take it again, or keep the numbers with sim[{self._field!r}].copy()"
            )
        return self.view(np.ndarray)

    def copy(self, order: Any = "C") -> NDArray[np.float64]:  # type: ignore[override]
        """The numbers, to be kept."""
        return self._valid().copy(order)

    def __getitem__(self, index: Any) -> Any:
        self._valid()
        return super().__getitem__(index)

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **keywords: Any) -> Any:
        return getattr(ufunc, method)(*(_plain(one) for one in inputs), **keywords)

    def __array_function__(self, function: Any, types: Any, arguments: Any, keywords: Any) -> Any:
        return function(*_plain(arguments), **_plain(keywords))

    def __repr__(self) -> str:
        return repr(self._valid())

    def __str__(self) -> str:
        return str(self._valid())

    def __reduce__(self) -> Any:
        return self._valid().copy().__reduce__()

    def tolist(self) -> Any:
        """The numbers as lists."""
        return self._valid().tolist()


def _plain(given: Any) -> Any:
    if isinstance(given, StateView):
        return given._valid()
    if isinstance(given, (list, tuple)):
        return type(given)(_plain(one) for one in given) if type(given) in (list, tuple) else given
    if isinstance(given, dict):
        return {name: _plain(one) for name, one in given.items()}
    return given


class Checkpoint:
    """A state of a simulation in memory: what goes on from it ends with the same bits."""

    def __init__(self, native: _native.Checkpoint) -> None:
        self._native = native


class Simulation:
    """A run that one can hold: stepped, looked into, saved.

    ::

        sim = granflow.Simulation("silo.toml")
        for sim in sim.frames(0.5):
            print(sim.time, sim["thickness"].max())

    Args:
        case: a :class:`Case`, or what one is made of.
        threads: so many threads; None takes all cores.
        checkpoint: go on from there: a :class:`Checkpoint`, or the path of a file, see :meth:`restore`.

    Raises:
        CaseError, FileNotFoundError, MemoryError: the case cannot be started.
        ValueError: the checkpoint is that of another case, or of other files that the case names.

    Every method that steps hears Ctrl-C (KeyboardInterrupt; the simulation then stands after its last step) and raises
    :class:`ComputationError` for a step that cannot be taken.
    """

    def __init__(
        self,
        case: Case | str | PathLike[str] | Mapping[str, Any],
        *,
        threads: int | None = None,
        checkpoint: Checkpoint | str | PathLike[str] | None = None,
    ) -> None:
        self._case, self._threads = as_case(case)._native, whole("threads", threads or 0)
        self._moves = 0
        self._computed: dict[str, NDArray[np.float64]] = {}
        self._native = self._begun(checkpoint)

    def _begun(self, checkpoint: Checkpoint | str | PathLike[str] | None) -> _native.Simulation:
        saved = checkpoint._native if isinstance(checkpoint, Checkpoint) else None
        path = None if isinstance(checkpoint, Checkpoint) else checkpoint
        native, changes = _native.Simulation.begin(self._case, self._threads, saved, path)
        for change in changes:
            text = f"the simulation goes on from a checkpoint with another case: {change}"
            warnings.warn(text, GranflowWarning, stacklevel=3)
        return native

    def _moved(self) -> None:
        self._moves += 1
        self._computed = {}

    def step(self, count: int = 1) -> None:
        """So many steps; fewer where nothing can move any more."""
        whole("count", count)
        self._moved()
        self._native.step(count)

    def until(self, time: float) -> None:
        """To a time; the last step is cut there.

        Raises:
            ValueError: the simulation is beyond it; a checkpoint goes back.
        """
        if time < self.time:
            raise ValueError(f"time {time} is over, the simulation is at {self.time}: restore goes back to a checkpoint")
        self._moved()
        self._native.until(time)

    def to_rest(self, limit: float | None = None) -> bool:
        """Until all rests, or to the time `limit` (None: the ``time.end`` of the case). Returns whether it rests."""
        self._moved()
        return self._native.rest(limit)

    def frames(self, every: float) -> Iterator[Simulation]:
        """The simulation at multiples of `every`, its present state first, to its rest or the end that the case says.

        No step is cut: within a step the state lies on the straight line between its begin and its end.
        """
        yield self
        while True:
            self._moved()
            if not self._native.next_frame(every):
                return
            yield self

    @overload
    def checkpoint(self, path: None = None) -> Checkpoint: ...
    @overload
    def checkpoint(self, path: str | PathLike[str]) -> None: ...
    def checkpoint(self, path: str | PathLike[str] | None = None) -> Checkpoint | None:
        """The state to go on from, copied, or written into a file, whole or not at all: see :meth:`restore`.

        Of a state that :meth:`frames` shows within a step it is the end of the step.

        Args:
            path: the file; an older one is replaced once the new one is complete on the disk. Its folder is made.

        Raises:
            OSError: the disk refuses.
        """
        self._moved()
        if path is None:
            return Checkpoint(self._native.checkpoint())
        self._native.checkpoint_to(path)
        return None

    def restore(self, checkpoint: Checkpoint | str | PathLike[str]) -> None:
        """Goes to a state that :meth:`checkpoint` gave or wrote, here or in another process; what follows has the same bits.

        The case must be that of then with the same inputs, but for what a run may go on with: ``time``, ``output``, friction (a
        :class:`GranflowWarning` says what differs). The ``checkpoint/state.bin`` of a run in a folder is taken too. The case is set up again,
        with the time that this takes.

        Raises:
            FileNotFoundError, ValueError: there is no such file; it is damaged, of another case, other inputs or another version of
                granflow. The simulation then stands where it stood.
        """
        native = self._begun(checkpoint)
        self._moved()
        self._native = native

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """A field of the state, read-only; shape (rows, columns) or (cells), row 0 at the smallest y, in the units of the case.

        What the engine keeps is its own memory (:class:`StateView`): ``thickness`` on a grid, the layers of a sandpile. What it does not
        keep is computed, once for each state, into an array that stays as it is: velocities, and on terrain the thickness normal to the
        bed, for there the engine keeps the volume per plan area (see :attr:`state`).

        Raises:
            KeyError: there is no such field; the message names those that there are.
        """
        if name in self._computed:
            return self._computed[name]
        array, borrowed = self._native.field(name)
        if borrowed:
            return self._view(array, name)
        self._computed[name] = array
        return array

    def _view(self, array: NDArray[np.float64], name: str) -> StateView:
        view: StateView = array.view(StateView)
        view._field, view._simulation, view._moves = name, self, self._moves
        return view

    @property
    def state(self) -> tuple[StateView, ...]:
        """The state as the engine keeps it, without a copy; shapes as those of the fields, of a sandpile one more for the nodes.

        On a grid thickness h and discharge (q_x, q_y); on terrain volume per plan area H and its discharge along x and y; of a
        sandpile the standing and the rolling layer.
        """
        return tuple(self._view(self._native.component(k), f"state[{k}]") for k in range(self._native.components))

    def __contains__(self, name: object) -> bool:
        return name in self._native.fields

    @property
    def fields(self) -> list[str]:
        """Names of the fields."""
        return self._native.fields

    @property
    def x(self) -> NDArray[np.float64]:
        """Centres of the cells along x, shape (columns)."""
        return self._native.x

    @property
    def y(self) -> NDArray[np.float64]:
        """Centres of the cells along y, shape (rows); empty in one dimension."""
        return self._native.y

    @property
    def time(self) -> float:
        """Time reached, or shown by :meth:`frames`."""
        return self._native.time

    @property
    def steps(self) -> int:
        """Steps done."""
        return self._native.steps

    @property
    def at_rest(self) -> bool:
        """Nothing will ever move: every cell rests, the last step changed no bit, and nothing is still to come."""
        return self._native.at_rest

    @property
    def max_speed(self) -> float:
        """Largest speed along the bed."""
        return self._native.speed

    @property
    def volume(self) -> float:
        """Volume on the grid."""
        return self._native.volume

    @property
    def inflow(self) -> float:
        """Volume that has come since the start, by sources and late releases."""
        return self._native.inflow

    @property
    def outflow(self) -> dict[str, float]:
        """Volume that has left since the start, by side."""
        return dict(self._native.outflow)

    @property
    def scheme(self) -> str:
        """Name of the scheme."""
        return self._native.scheme

    def peaks(self) -> dict[str, NDArray[np.float64]]:
        """The maps of peaks and times so far, shape (rows, columns) or (cells), copied."""
        return dict(self._native.peaks())

    def __repr__(self) -> str:
        rest = ", at rest" if self.at_rest else ""
        return f"<granflow.Simulation at time {self.time}, step {self.steps}{rest}>"
