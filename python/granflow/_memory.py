"""Arrays and geometries in the place of files."""

from __future__ import annotations

import io
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Raster:
    """Values on square cells of a map.

    Args:
        values: shape (rows, columns); NaN is nodata, and so is what a masked array masks.
        cell: edge length of a cell in metres.
        west, south: outer edges in metres, x of the western and y of the southern one.
        crs: coordinate reference system, as ``"EPSG:31287"``, 31287 or well-known text.
        first_row: where row 0 lies: ``"south"``, as in the results and in ``numpy.meshgrid``, or ``"north"``, as in
            images and rasterio.
    """

    values: ArrayLike
    cell: float
    west: float = 0.0
    south: float = 0.0
    crs: str | int | None = None
    first_row: Literal["south", "north"] = "south"

    def __post_init__(self) -> None:
        values = np.asarray(self.values)
        if values.ndim != 2 or 0 in values.shape:
            raise ValueError(f"a raster has the shape (rows, columns), found {values.shape}")
        if not np.issubdtype(values.dtype, np.number) or np.iscomplexobj(values):
            raise ValueError(f"a raster holds numbers, found {values.dtype}")
        numbers = {"cell": self.cell, "west": self.west, "south": self.south}
        for name, number in numbers.items():
            if not isinstance(number, (int, float, np.integer, np.floating)) or not np.isfinite(number):
                raise ValueError(f"{name} = {number!r}: it is a number, in metres")
        if not self.cell > 0.0:
            raise ValueError(f"cell = {self.cell}: the edge length of a cell is a number > 0, in metres")
        if self.first_row not in ("south", "north"):
            raise ValueError(f"first_row = {self.first_row!r}: allowed are 'south' and 'north'")

    @classmethod
    def from_transform(
        cls, values: ArrayLike, transform: Sequence[float], crs: str | int | None = None
    ) -> Raster:
        """From an affine transform (a, b, c, d, e, f) as rasterio gives it: x = a column + c, y = e row + f."""
        a, b, c, d, e, f = list(transform)[:6]
        if b != 0.0 or d != 0.0 or a <= 0.0 or not np.isclose(abs(e), a, rtol=1e-6):
            raise ValueError(f"the cells must be square and not turned, found the transform {(a, b, c, d, e, f)}")
        rows = np.asarray(values).shape[0]
        return cls(values, a, c, f + rows * e if e < 0.0 else f, crs, "north" if e < 0.0 else "south")

    @classmethod
    def from_dataarray(cls, array: xr.DataArray) -> Raster:
        """From an array with coordinates, after the conventions of rioxarray.

        The dimensions are y and x, in this order where they have other names; their coordinates are the centres of the cells. The reference system comes from
        ``array.rio.crs``, else from the coordinate ``spatial_ref`` or the attribute ``crs``. A ``_FillValue`` or ``nodata`` in the
        attributes becomes NaN.
        """
        array = array.squeeze(drop=True)
        if set(array.dims) == {"x", "y"}:
            array = array.transpose("y", "x")
        if array.ndim != 2:
            raise ValueError(f"a raster has the dimensions (y, x), found {array.dims}")
        y, x = (_centres(array, dimension) for dimension in array.dims)
        dx = _spacing(x, array.dims[1])
        dy = _spacing(y, array.dims[0])
        if dx <= 0.0 or not np.isclose(abs(dy), dx, rtol=1e-6):
            cure = f"; array.sortby({array.dims[1]!r}) turns it" if dx < 0.0 else ""
            raise ValueError(f"the cells must be square with x growing, found spacings of {dx} and {dy}{cure}")
        values = np.asarray(array.values, dtype=np.float64)
        for name in ("_FillValue", "nodata"):
            nodata = array.attrs.get(name)
            if nodata is not None:
                values = np.where(values == nodata, np.nan, values)
        west, south = float(x[0] - dx / 2), float(min(y[0], y[-1]) - dx / 2)
        return cls(values, dx, west, south, _system(array), "north" if dy < 0.0 else "south")

    def with_values(self, values: ArrayLike) -> Raster:
        """The same cells with other values, in the same order of rows."""
        return replace(self, values=values)

    def south_first(self) -> NDArray[np.float64]:
        """The values as the engine takes them, row 0 in the south."""
        values = numbers(self.values)
        return values[::-1] if self.first_row == "north" else values

    def as_given(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values with row 0 in the south in the order of this raster."""
        return values[::-1] if self.first_row == "north" else values

    def without_values(self) -> Raster:
        """The same cells, of which no value is known: takes no memory."""
        return self.with_values(np.broadcast_to(np.float64(np.nan), np.shape(self.values)))

    def system(self) -> str | None:
        """The reference system as text."""
        return f"EPSG:{self.crs}" if isinstance(self.crs, (int, np.integer)) else self.crs


def _centres(array: xr.DataArray, dimension: Any) -> NDArray[np.float64]:
    if dimension not in array.coords:
        raise ValueError(
            f"the dimension {dimension!r} has no coordinates: give the centres of the cells, "
            "or granflow.Raster(values, cell=..., west=..., south=...)"
        )
    return np.asarray(array.coords[dimension].values, dtype=np.float64)


def _spacing(centres: NDArray[np.float64], name: Any) -> float:
    if len(centres) < 2:
        raise ValueError(f"the coordinate {name!r} needs at least two values")
    spacing = float(centres[-1] - centres[0]) / (len(centres) - 1)
    if not np.allclose(np.diff(centres), spacing, rtol=1e-4):
        raise ValueError(f"the coordinate {name!r} is not evenly spaced")
    return spacing


def _system(array: xr.DataArray) -> str | None:
    rio = getattr(array, "rio", None)
    if rio is not None and rio.crs is not None:
        code = rio.crs.to_epsg()
        return f"EPSG:{code}" if code is not None else str(rio.crs.to_wkt())
    for name in (array.attrs.get("grid_mapping", array.encoding.get("grid_mapping")), "spatial_ref", "crs"):
        if name in array.coords:
            own = array.coords[name].attrs
            found = own.get("epsg_code") or own.get("crs_wkt") or own.get("spatial_ref")
            if found:
                return str(found)
    found = array.attrs.get("crs")
    return None if found is None else str(found)


def numbers(values: ArrayLike) -> NDArray[np.float64]:
    """The numbers of an array, NaN where it is masked."""
    if isinstance(values, np.ma.MaskedArray):
        return np.asarray(np.ma.filled(values.astype(np.float64), np.nan))
    return np.asarray(values, dtype=np.float64)


def npy(values: ArrayLike) -> bytes:
    """The numbers as a file of NumPy's format."""
    out = io.BytesIO()
    np.save(out, np.ascontiguousarray(numbers(values)), allow_pickle=False)
    return out.getvalue()


_GEOMETRIES = {
    "Polygon",
    "MultiPolygon",
    "LineString",
    "MultiLineString",
    "Point",
    "MultiPoint",
    "GeometryCollection",
    "Feature",
    "FeatureCollection",
}


def is_geometry(given: Any) -> bool:
    """A shapely geometry, a GeoSeries or GeoDataFrame, GeoJSON as a dictionary, or several geometries."""
    if hasattr(given, "__geo_interface__"):
        return True
    if isinstance(given, Mapping):
        return given.get("type") in _GEOMETRIES
    return isinstance(given, (list, tuple)) and bool(given) and all(is_geometry(one) for one in given)


def geojson(given: Any) -> bytes:
    """A geometry with its attributes and its reference system."""
    if isinstance(given, (list, tuple)):
        features = [{"type": "Feature", "properties": {}, "geometry": _interface(one)} for one in given]
        return _dumped({"type": "FeatureCollection", "features": features})
    found = dict(_interface(given))
    crs = getattr(given, "crs", None)
    if crs is not None and hasattr(crs, "to_epsg"):
        code = crs.to_epsg()
        name = f"urn:ogc:def:crs:EPSG::{code}" if code is not None else crs.to_wkt()
        found["crs"] = {"type": "name", "properties": {"name": name}}
    return _dumped(found)


def line(given: Any) -> list[list[float]]:
    """The points of a line."""
    found = _interface(given)
    if found.get("type") != "LineString":
        raise ValueError(f"this is a line of a case: a LineString, found a {found.get('type')}")
    return [[float(x), float(y)] for x, y, *_ in found["coordinates"]]


def _interface(given: Any) -> Mapping[str, Any]:
    found: Mapping[str, Any] = getattr(given, "__geo_interface__", given)
    return found


def _dumped(found: Mapping[str, Any]) -> bytes:
    return json.dumps(_plain(found)).encode()


def _numbers_in(coordinates: Any) -> Iterator[float]:
    if isinstance(coordinates, (list, tuple)):
        for one in coordinates:
            yield from _numbers_in(one)
    else:
        yield float(coordinates)


def _plain(given: Any) -> Any:
    """What JSON can say of a value; an attribute without a value is null."""
    if isinstance(given, Mapping):
        if "coordinates" in given and not all(map(math.isfinite, _numbers_in(given["coordinates"]))):
            raise ValueError("a geometry has a corner that is not a number")
        return {str(name): _plain(one) for name, one in given.items()}
    if isinstance(given, (list, tuple)):
        return [_plain(one) for one in given]
    if isinstance(given, np.generic):
        given = given.item()
    if isinstance(given, float) and given != given:
        return None
    return given if given is None or isinstance(given, (bool, int, float, str)) else str(given)
