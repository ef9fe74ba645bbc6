"""Tables as text, as users have them."""

from __future__ import annotations

import csv
import io
import math
from typing import Any

import numpy as np


def as_table(text: str) -> Any:
    """A table as text, as a DataFrame where pandas is installed, else as a dictionary of arrays."""
    rows = list(csv.DictReader(io.StringIO(text)))
    columns = {name: _column([row[name] for row in rows]) for name in rows[0]} if rows else {}
    try:
        import pandas
    except ImportError:
        return columns
    return pandas.DataFrame(columns)


def _column(words: list[str]) -> np.ndarray[Any, Any]:
    for kind in (int, float):
        try:
            return np.array([math.nan if word == "" and kind is float else kind(word) for word in words])
        except ValueError:
            continue
    return np.array(words)
