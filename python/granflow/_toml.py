"""Plain values as TOML, for cases that are given as keywords."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping
from os import PathLike, fspath
from typing import Any

import numpy as np

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def value(given: Any, place: str = "a case") -> str:
    """A value as TOML on one line; `place` is its key, for messages.

    Raises:
        TypeError: for what TOML has no word for.
    """
    if isinstance(given, np.generic) or (isinstance(given, np.ndarray) and given.ndim == 0):
        given = given.item()
    if isinstance(given, bool):
        return "true" if given else "false"
    if isinstance(given, int):
        return str(given)
    if isinstance(given, float):
        return "nan" if math.isnan(given) else repr(given)
    if isinstance(given, PathLike):
        given = fspath(given)
    if isinstance(given, str):
        return json.dumps(given, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(given, Mapping):
        return "{" + ", ".join(f"{key(name)} = {value(inner, place)}" for name, inner in given.items()) + "}"
    if isinstance(given, (list, tuple, np.ndarray)):
        return "[" + ", ".join(value(item, place) for item in given) + "]"
    raise TypeError(f"{place}: a case has no value of type {type(given).__name__}: {given!r}")


def key(name: str) -> str:
    """A key as TOML writes it."""
    return name if _BARE.fullmatch(name) else json.dumps(name, ensure_ascii=False)


def document(tables: Mapping[str, Any]) -> str:
    """A whole case, one line for each value, so that a message can name it."""
    return "".join(f"{path} = {text}\n" for path, text in _lines("", tables))


def _lines(path: str, tables: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    for name, inner in tables.items():
        full = f"{path}.{key(name)}" if path else key(name)
        if isinstance(inner, Mapping) and inner:
            yield from _lines(full, inner)
        else:
            yield full, value(inner, full)
