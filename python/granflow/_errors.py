"""Exceptions and warnings."""

from __future__ import annotations


class CaseError(ValueError):
    """A case is wrong. The text says place, key, what was found, what is allowed and what to do.

    Attributes:
        file: the file, or what stands for it (``<text>``, ``<keywords>``, ``--set key=value``).
        line, column: the place, from 1; None where there is none.
        key: the key, with dots; empty if no key is to blame.
        message: what was found.
        help: what is allowed and what to do.
    """

    def __init__(
        self,
        *,
        text: str,
        file: str,
        line: int | None,
        column: int | None,
        key: str,
        message: str,
        help: str,
    ) -> None:
        super().__init__(text)
        self.text = text
        self.file = file
        self.line = line
        self.column = column
        self.key = key
        self.message = message
        self.help = help

    def __str__(self) -> str:
        return self.text

    def __reduce__(self) -> tuple[object, ...]:
        return _again, (type(self), {name: getattr(self, name) for name in _PARTS})


_PARTS = ("text", "file", "line", "column", "key", "message", "help")


def _again(kind: type[CaseError], parts: dict[str, object]) -> CaseError:
    return kind(**parts)  # type: ignore[arg-type]


class MissingFileError(CaseError, FileNotFoundError):
    """A file that a case names, or the case itself, is not there."""


class ComputationError(RuntimeError):
    """The computation failed: a step could not be taken, or a result breaks a law of its own.

    Attributes:
        time: the time that was reached.
    """

    def __init__(self, text: str, time: float) -> None:
        super().__init__(text)
        self.time = time

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (str(self), self.time)


class StaleViewError(ValueError):
    """A view of a simulation's memory was used after the simulation had gone on."""


class GranflowWarning(UserWarning):
    """What to know before the numbers of a run are trusted."""
