"""Cases: what is to be computed."""

from __future__ import annotations

import os
from collections.abc import Mapping
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from . import _memory, _native, _toml
from ._memory import Raster

_NAMED = ("dem", "raster", "file", "polygons")


class Case:
    """What is to be computed: a case file, its text, or the same as keywords.

    Every key of the case file has its place here (``docs/case-file.md``). Where a case names a file, an array or a geometry may
    stand in its place:

    ========================================  =====================================================================
    key                                       may be
    ========================================  =====================================================================
    ``terrain.dem``, ``release.0.raster``     :class:`Raster`, ``xarray.DataArray`` (y, x); an array of the terrain's shape
    ``release.0.polygons``                    shapely geometry, several of them, GeoDataFrame, GeoJSON as a dictionary
    ``material.friction.coulomb.mu``, ...     the same as a raster: a parameter in space
    ``initial.thickness``, ...                array of shape (cells) or (cells along y, cells along x), the lowest y first
    ``section.0.line``, ``inflow.0.line``     shapely LineString, or points
    ========================================  =====================================================================

    Args:
        source: path of a case file, or its text (what has a line break, or a ``=`` and is no file, is a text), or a dictionary.
        tables: the tables of a case as keywords: ``grid={"x": {"from": -6, "to": 6, "cells": 240}}``.

    Raises:
        CaseError: at the first place that is not TOML, an unknown key, a wrong type or a missing key.
        FileNotFoundError: there is no such file.

    A case is looked at in full by :meth:`check`, and before it is run.
    """

    def __init__(self, source: str | PathLike[str] | Mapping[str, Any] | None = None, /, **tables: Any) -> None:
        self._grounds: Raster | None = None
        self._overrides: tuple[str, ...] = ()
        self._member: tuple[str, ...] | None = None
        self._held: dict[str, Any] = {}
        if isinstance(source, Mapping):
            tables = {**source, **tables}
        elif source is not None:
            if tables:
                raise TypeError("give a file, a text or keywords, not two of them; Case.set changes a key")
            if not isinstance(source, (str, PathLike)) or not fspath(source):
                raise TypeError(f"a case is a path, its text, a dictionary or keywords, found {source!r}")
            self._source, self._native = _read(fspath(source), isinstance(source, str))
            self._on_terrain = "[terrain]" in self._native.to_toml()
            return
        self._on_terrain = "terrain" in tables
        held: dict[str, Any] = {}
        plain = self._plain("", tables, held)
        self._source = (_toml.document(plain), "<keywords>")
        native = _native.Case.from_text(*self._source)
        for name, given in held.items():
            native, held[name] = _hold(native, name, given)
        native.to_toml()
        self._native, self._held = native, held

    def set(self, key: str, value: Any) -> Case:
        """Changes a key, and returns the case.

        Args:
            key: as in ``"material.friction.coulomb.mu"``; entries of lists by their number: ``"release.0.thickness"``.
            value: a number, a text, a list, a table as a dictionary; an array or a geometry in the place of a file.

        Raises:
            CaseError: there is no such key, or it does not take this value; the case is as before.
        """
        grounds = self._grounds
        held: dict[str, Any] = {}
        try:
            plain = self._plain(key, value, held)
            native = self._native
            for name, given in held.items():
                native, held[name] = _hold(native, name, given)
            override = f"{key}={_toml.value(plain, key)}"
            native = native.with_override(override)
            native.to_toml()
        except BaseException:
            self._grounds = grounds
            raise
        self._native = native
        if self._member is None:
            self._overrides += (override,)
        else:
            self._member += (override,)
        self._held = {**self._held, **held}
        return self

    def copy(self) -> Case:
        """A case of its own; arrays are shared, for a case never changes them."""
        other = Case.__new__(Case)
        other.__dict__.update(self.__dict__)
        return other

    def check(self) -> Case:
        """Says everything that can be said before work starts, and returns the case.

        Raises:
            CaseError: the first thing that is wrong.
        """
        self._native.check()
        return self

    def describe(self) -> str:
        """What would be computed, as ``granflow check`` prints it: cells, memory, steps."""
        lines = self._native.describe()
        width = max(len(name) for name, _ in lines)
        return "\n".join(f"{name:<{width}}  {text}" for name, text in lines)

    @property
    def text(self) -> str:
        """The case as one TOML document; what is in memory stands in it as a name in angle brackets."""
        return self._native.resolved()

    def to_toml(self) -> str:
        """The case with its defaults, as TOML; angles are in radians."""
        return self._native.to_toml()

    def __reduce__(self) -> tuple[Any, ...]:
        # A worker may be in another folder: a file goes along as its text, and what it names is looked for where it is.
        text, name = self._source
        if text is None:
            text, name = Path(name).read_text(encoding="utf-8"), str(Path(name).absolute())
        layers = (self._overrides, self._member)
        return _again, (text, name, layers, self._held, self._grounds, self._on_terrain)

    def __repr__(self) -> str:
        return f"<granflow.Case\n{self.text}>"

    def _plain(self, path: str, given: Any, held: dict[str, Any]) -> Any:
        """What TOML can say of a value; arrays and geometries in it go to `held` under the name that stands for them."""
        last = path.rsplit(".", 1)[-1]
        if isinstance(given, xr.Dataset):
            raise TypeError(f"{path}: a Dataset has several variables: give one, as in ds['elevation']")
        if path == "release" and _memory.is_geometry(given) and not isinstance(given, (list, tuple)):
            given = [given]
        if last == "line" and is_line(given):
            return _memory.line(given)
        if _memory.is_geometry(given) and not (path == "release" and isinstance(given, (list, tuple))):
            held[f"<{path}>"] = _memory.geojson(given)
            return f"<{path}>" if last in _NAMED else {"polygons": f"<{path}>"}
        if isinstance(given, Mapping):
            inner = {}
            for name, one in given.items():
                inner[name] = self._plain(f"{path}.{name}" if path else name, one, held)
            return inner
        if isinstance(given, (list, tuple)):
            return [self._plain(f"{path}.{index}", one, held) for index, one in enumerate(given)]
        if isinstance(given, (Raster, xr.DataArray)) or (isinstance(given, np.ndarray) and given.ndim > 0):
            return self._array(path, last, given, held)
        return given

    def _array(self, path: str, last: str, given: Any, held: dict[str, Any]) -> Any:
        whole = last == "file" or (path.startswith("initial.") and path.count(".") == 1)
        if not self._on_terrain and (whole or np.ndim(_values(given)) > 1):
            name = f"<{path}>.npy"
            held[name] = _memory.npy(_values(given))
            return name if last in _NAMED else {"file": name}
        if np.ndim(_values(given)) == 1:
            return _values(given).tolist()
        raster = self._raster(path, given)
        if path == "terrain.dem":
            self._grounds = raster.without_values()
        held[f"<{path}>"] = raster
        return f"<{path}>" if last in _NAMED else {"raster": f"<{path}>"}

    def _raster(self, path: str, given: Any) -> Raster:
        if isinstance(given, Raster):
            return given
        if isinstance(given, xr.DataArray):
            return Raster.from_dataarray(given)
        grounds = self._grounds
        if path == "terrain.dem" or grounds is None or np.shape(grounds.values) != given.shape:
            other = "" if grounds is None else f" (the terrain has the shape {np.shape(grounds.values)})"
            raise ValueError(
                f"{path}: an array of shape {given.shape} does not say where its cells are{other}; "
                "give granflow.Raster(values, cell=5.0, west=..., south=..., crs=...), or an xarray.DataArray with x and y"
            )
        return grounds.with_values(given)


def is_line(given: Any) -> bool:
    """A geometry in the place of the points of a line."""
    return hasattr(given, "__geo_interface__")


def as_case(given: Any) -> Case:
    """A case, or what one can be made of."""
    return given if isinstance(given, Case) else Case(given)


def _values(given: Any) -> Any:
    return given.values if isinstance(given, (Raster, xr.DataArray)) else given


def _read(source: str, may_be_text: bool) -> tuple[tuple[str | None, str], _native.Case]:
    """The text, if it is none of a file, and the name; and the case."""
    if may_be_text and ("\n" in source or ("=" in source and not os.path.exists(source))):
        return (source, "<text>"), _native.Case.from_text(source, "<text>")
    return (None, source), _native.Case.from_file(source)


def _again(
    text: str,
    name: str,
    layers: tuple[tuple[str, ...], tuple[str, ...] | None],
    held: dict[str, Any],
    grounds: Raster | None,
    on_terrain: bool,
) -> Case:
    """A case out of its parts, in another process."""
    native, (overrides, member) = _native.Case.from_text(text, name), layers
    for key, given in held.items():
        native, held[key] = _hold(native, key, given)
    for override in overrides:
        native = native.with_override(override)
    if member is not None:
        native = native.of_member(member)
    case = Case.__new__(Case)
    case._source, case._overrides, case._member, case._held = (text, name), overrides, member, held
    case._grounds, case._on_terrain, case._native = grounds, on_terrain, native
    return case


def _hold(native: _native.Case, name: str, given: Any) -> tuple[_native.Case, Any]:
    """A case that has what is given in memory, and the same as it holds it: what happens to an array later is not seen."""
    if isinstance(given, Raster):
        values = given.south_first()
        native = native.with_raster(name, values, given.west, given.south, given.cell, given.system())
        return native, given.with_values(given.as_given(native.raster(name)))
    return native.with_file(name, given), given
