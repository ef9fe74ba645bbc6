"""Pictures of a run: what ``ds.granflow`` draws with matplotlib."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from ._tables import as_table

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation
    from matplotlib.axes import Axes

#: What a map shows where nobody names another variable, the first that there is.
_SHOWN = ("peak_thickness", "deposit", "standing_layer", "thickness")
#: What is measured by the threshold of a run.
_THICKNESSES = ("peak_thickness", "deposit", "thickness")


@xr.register_dataset_accessor("granflow")  # type: ignore[no-untyped-call]
class Results:
    """``ds.granflow``: numbers and pictures of a run that :func:`granflow.run` returned or that its ``result.nc`` holds.

    The pictures need matplotlib (``pip install "granflow[plot]"``). Each draws on `ax`, or on a figure of its own, and returns the axes.
    """

    def __init__(self, dataset: xr.Dataset) -> None:
        self._ds = dataset

    @property
    def summary(self) -> dict[str, Any]:
        """The run in numbers: the keys of ``summary.json``; empty for a ``result.nc`` from the disk, beside which that stands."""
        summary: dict[str, Any] = json.loads(self._ds.attrs.get("summary", "{}"))
        return summary

    @property
    def members(self) -> Any:
        """The table of the members of an ensemble: a ``pandas.DataFrame`` where pandas is installed, else a dictionary of arrays."""
        return as_table(self._ds.attrs["members"])

    @property
    def is_plane(self) -> bool:
        """It has two dimensions."""
        return "y" in self._ds.sizes

    def plot(self, name: str | None = None, **options: Any) -> Axes:
        """The picture that fits: :meth:`profiles` of a line, :meth:`surface` of a sandpile, else :meth:`map`."""
        if not self.is_plane:
            return self.profiles(name, **options)
        if name in (None, "standing_layer") and "standing_layer" in self._ds:
            return self.surface(**options)
        return self.map(name, **options)

    def map(
        self,
        name: str | None = None,
        *,
        time: float | None = None,
        ax: Axes | None = None,
        least: float | None = None,
        **options: Any,
    ) -> Axes:
        """A variable as a map, on the shaded mountain where there is one, in the colours of the program's figures.

        Args:
            name: the variable; by default the peak of the thickness, the layer of a pile, or of an ensemble how probable the first
                threshold is.
            time: of a series the nearest instant; None is the last.
            least: what is not larger is not shown; None leaves out what is thinner than the threshold of the run, and 0 of a pile or an
                ensemble.
            options: for ``Axes.pcolormesh``: ``cmap``, ``vmin``, ``vmax``, ...
        """
        ax = _axes(ax)
        field = self._instant(self._named(name, _SHOWN), time)
        y, x = (field[dimension].values for dimension in field.dims)
        if "bed" in self._ds:
            self._shade(ax)
        values = np.where(self._seen(field, least), field.values, np.nan)
        drawn = ax.pcolormesh(x, y, values, shading="nearest", **{**_colours(str(field.name), values), **options})
        _colour_bar(ax, drawn, _label(field))
        ax.set(aspect="equal", xlabel=self._along("x"), ylabel=self._along("y"), title=self._title(field))
        return ax

    def section(
        self,
        line: ArrayLike | None = None,
        *,
        time: float | None = None,
        exaggeration: float | None = None,
        ax: Axes | None = None,
    ) -> Axes:
        """Bed and thickness along a line, by default the path of the centre of mass.

        Args:
            line: its points, shape (points, 2); the default is carried on straight to all that was reached.
            time: the nearest instant; None is the last.
            exaggeration: the thickness is drawn so many times as large; None takes what can be seen, and the title says it.
        """
        if "bed" not in self._ds or not self.is_plane:
            raise ValueError("a section needs a run on terrain")
        ax = _axes(ax)
        points = self._reach(self.path()) if line is None else np.asarray(line, dtype=np.float64)
        along, places = _walk(points, float(abs(self._ds.x[1] - self._ds.x[0])))
        field = self._instant("thickness", time)
        bed, thickness = _sampled(self._ds.bed, places), _sampled(field, places)
        if exaggeration is None:
            exaggeration = _exaggeration(float(np.nanmax(bed) - np.nanmin(bed)), float(np.nanmax(thickness)))
        surface = bed + exaggeration * thickness
        ax.fill_between(along, bed, np.nanmin(bed), color="0.85", linewidth=0)
        ax.plot(along, bed, color="0.3", linewidth=1.0)
        ax.fill_between(along, bed, surface, where=surface > bed, color="tab:blue", linewidth=0)
        times = "" if exaggeration == 1.0 else f", thickness x {exaggeration:g}"
        ax.set(xlabel="along the line (m)", ylabel="elevation (m)", title=self._title(field) + times)
        return ax

    def path(self) -> NDArray[np.float64]:
        """The way of the centre of mass, shape (points, 2): one for each instant at which there is some mass."""
        thickness = self._ds["thickness"].fillna(0.0)
        mass = thickness.sum(("y", "x"))
        weighted = [(thickness * self._ds[axis]).sum(("y", "x")) / mass.where(mass > 0.0) for axis in ("x", "y")]
        points = np.column_stack([one.values for one in weighted])
        return np.asarray(points[np.isfinite(points).all(axis=1)])

    def _reach(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """A line carried on straight at both ends, as far as any mass came."""
        rows, columns = np.nonzero(self._ds["peak_thickness"].fillna(0.0).values > 0.0)
        reached = np.column_stack([self._ds.x.values[columns], self._ds.y.values[rows]])
        if len(points) < 2 or not len(reached):
            return points
        for _ in range(2):
            way = points[-1] - points[max(0, len(points) - 4)]
            if np.hypot(*way) > 0.0:
                way = way / np.hypot(*way)
                points = np.vstack([points, points[-1] + max(0.0, ((reached - points[-1]) @ way).max()) * way])
            points = points[::-1]
        return points

    def profiles(
        self, name: str | None = None, *, times: ArrayLike | None = None, ax: Axes | None = None, **options: Any
    ) -> Axes:
        """A series of a line at some instants.

        Args:
            name: the variable; by default the thickness, or the standing layer.
            times: the nearest instants; None shows six.
            options: for ``Axes.plot``.
        """
        if self.is_plane:
            raise ValueError("profiles are of one dimension; a plane has map and section")
        import matplotlib

        ax = _axes(ax)
        series = self._ds[self._named(name, ("thickness", "standing_layer"))]
        x = series[series.dims[-1]].values
        if times is None:
            shown = np.unique(np.linspace(0, series.sizes["time"] - 1, 6).round().astype(int))
        else:
            shown = np.unique([self._nearest(time) for time in np.atleast_1d(np.asarray(times, dtype=np.float64))])
        for place, instant in zip(np.linspace(0.0, 0.9, len(shown)), shown, strict=True):
            one = series.isel(time=instant)
            style = {"color": matplotlib.colormaps["viridis"](place), "label": f"t = {float(one.time):.4g}"}
            ax.plot(x, one.values, **{**style, **options})
        ax.set(xlabel=self._along("x"), ylabel=_label(series), title=self._ds.attrs.get("title", ""))
        ax.legend()
        return ax

    def surface(self, *, time: float | None = None, ax: Axes | None = None, **options: Any) -> Axes:
        """The standing layer of a sandpile, or the thickness, in 3-D; options are for ``plot_surface``.

        On terrain it is the mountain with what lies on it, in the colours of :meth:`map`.
        """
        if not self.is_plane:
            raise ValueError("a surface has two dimensions")
        if ax is None:
            import matplotlib.pyplot as plt

            ax = plt.figure().add_subplot(projection="3d")
        field = self._instant(self._named(None, ("standing_layer", "thickness")), time)
        y, x = (field[dimension].values for dimension in field.dims)
        drawn: Any = ax
        if "bed" in self._ds:
            height, label = self._ds.bed.values + field.fillna(0.0).values, "elevation (m)"
            style = {"facecolors": self._painted(field), "rstride": 1, "cstride": 1, "shade": False}
            drawn.set_box_aspect((np.ptp(x), np.ptp(y), max(np.nanmax(height) - np.nanmin(height), np.ptp(x) / 5.0)))
        else:
            height, label, style = field.values, _label(field), {"cmap": "copper"}
        drawn.plot_surface(*np.meshgrid(x, y), height, **{**style, "linewidth": 0, **options})
        ax.set(xlabel=self._along("x"), ylabel=self._along("y"), title=self._title(field))
        drawn.set_zlabel(label)
        return ax

    def _painted(self, field: xr.DataArray) -> NDArray[np.float64]:
        """The colours of the cells of a mountain with what lies on it."""
        values = np.where(self._seen(field, None), field.values, np.nan)
        colours = _colours(str(field.name), values)["cmap"]
        largest = np.nanmax(values) if np.isfinite(values).any() else 1.0
        shade = 0.3 + 0.6 * self._hillshade()
        grey = np.dstack([shade, shade, shade, np.ones_like(shade)])
        return np.where(np.isnan(values)[..., None], grey, colours(np.nan_to_num(values) / largest))

    def animate(self, name: str | None = None, *, interval: int = 100, **options: Any) -> FuncAnimation:
        """A series over time as an animation, which a notebook plays: ``HTML(ds.granflow.animate().to_jshtml())``.

        Args:
            name: the series; by default the thickness, or the standing layer.
            interval: milliseconds between two pictures.
            options: for ``Axes.pcolormesh``, of a line for ``Axes.plot``.
        """
        import matplotlib.pyplot as plt
        from matplotlib.animation import FuncAnimation

        series = self._ds[self._named(name, ("thickness", "standing_layer"))]
        largest = float(np.abs(series).max())
        figure, ax = plt.subplots()
        mesh: Any
        if self.is_plane:
            least = min(0.0, float(series.min()))
            self.map(str(series.name), time=0.0, ax=ax, **{"vmin": -largest if least < 0.0 else 0.0, "vmax": largest, **options})
            mesh = ax.collections[-1]
        else:
            (mesh,) = ax.plot(series[series.dims[-1]], series[0], **options)
            ax.set(xlabel=self._along("x"), ylabel=_label(series), ylim=(min(0.0, float(series.min())), 1.05 * largest))

        def draw(instant: int) -> tuple[Any]:
            values = series.isel(time=instant).values
            if self.is_plane:
                mesh.set_array(np.where(self._seen(series.isel(time=instant), None), values, np.nan))
            else:
                mesh.set_ydata(values)
            ax.set_title(self._title(series.isel(time=instant)))
            return (mesh,)

        animation = FuncAnimation(figure, draw, frames=series.sizes["time"], interval=interval)
        plt.close(figure)
        return animation

    def _named(self, name: str | None, usual: tuple[str, ...]) -> str:
        if name is not None:
            if name not in self._ds:
                raise KeyError(f"{name!r}; there are {', '.join(map(str, self._ds.data_vars))}")
            return name
        probable = [str(one) for one in self._ds.data_vars if str(one).startswith("exceedance_")]
        found = next((one for one in (*usual, *probable, "count") if one in self._ds), None)
        if found is None:
            raise KeyError(f"this dataset has none of {', '.join(usual)}: name a variable")
        return found

    def _nearest(self, time: float) -> int:
        return int(np.abs(self._ds.time.values - time).argmin())

    def _instant(self, name: str, time: float | None) -> xr.DataArray:
        field = self._ds[name]
        if "time" not in field.dims:
            return field
        return field.isel(time=-1 if time is None else self._nearest(time))

    def _seen(self, field: xr.DataArray, least: float | None) -> NDArray[np.bool_]:
        """The cells of which a map shows the value."""
        name, known = str(field.name), ~np.isnan(field.values)
        if least is not None:
            return np.asarray(known & (field.values > least))
        if name in ("bed", "surface"):
            return np.asarray(known)
        threshold = float(str(self._ds.attrs.get("threshold", "0")).split()[0])
        by: Any = field
        if "thickness" in self._ds and name not in _THICKNESSES:
            by = self._ds["thickness"].sel(time=field.time) if "time" in field.coords else self._ds.get("peak_thickness", field)
        return np.asarray(known & (by.values > threshold))

    def _hillshade(self) -> NDArray[np.float64]:
        """The light on the mountain, 0 to 1, row 0 in the south."""
        from matplotlib.colors import LightSource

        bed, x = self._ds.bed.values.astype(float), self._ds.x.values
        cell = float(x[1] - x[0])
        # LightSource takes row 0 for the north.
        return np.flipud(LightSource(azdeg=315, altdeg=45).hillshade(np.flipud(bed), dx=cell, dy=cell))

    def _shade(self, ax: Axes) -> None:
        x, y = self._ds.x.values, self._ds.y.values
        half = float(x[1] - x[0]) / 2
        extent = (x[0] - half, x[-1] + half, y[0] - half, y[-1] + half)
        ax.imshow(self._hillshade(), cmap="gray", extent=extent, origin="lower", alpha=0.7, vmin=0.0, vmax=1.0)

    def _along(self, axis: str) -> str:
        return _with_units(axis, self._ds[axis].attrs)

    def _title(self, field: xr.DataArray) -> str:
        title = str(self._ds.attrs.get("title", ""))
        if str(field.name).startswith("exceedance_"):
            title = f"{title}\n{field.attrs.get('long_name', '')}".strip()
        if "time" not in field.coords or field.coords["time"].ndim:
            return title
        units = self._ds.time.attrs.get("units", "1")
        time = f"t = {float(field.time):.4g}" + ("" if units == "1" else f" {units}")
        return f"{title}, {time}" if title else time


def _axes(ax: Axes | None) -> Axes:
    if ax is not None:
        return ax
    import matplotlib.pyplot as plt

    return plt.subplots()[1]


def _colours(name: str, values: NDArray[np.float64]) -> dict[str, Any]:
    """The scale of colours of a quantity: that of the program's figures (`colours.rs` of granflow-figures)."""
    import matplotlib
    from matplotlib.colors import ListedColormap

    def part(colours: str, first: float, last: float) -> ListedColormap:
        return ListedColormap(matplotlib.colormaps[colours](np.linspace(first, last, 256)))

    if name.startswith("exceedance_"):
        return {"cmap": matplotlib.colormaps["viridis"], "vmin": 0.0, "vmax": 1.0}
    if np.nanmin(values, initial=0.0) < 0.0 and name not in ("bed", "surface"):
        largest = np.nanmax(np.abs(values))
        return {"cmap": matplotlib.colormaps["RdBu_r"], "vmin": -largest, "vmax": largest}
    if name.endswith(_THICKNESSES):
        return {"cmap": part("inferno", 0.96, 0.16)}
    if name.endswith(("speed", "pressure")) or name.startswith("velocity"):
        return {"cmap": part("YlGnBu", 0.12, 1.0)}
    return {"cmap": matplotlib.colormaps["viridis"]}


def _exaggeration(relief: float, thickness: float) -> float:
    """1, 2, 5, 10, ...: a layer is drawn at most a tenth as high as the relief, as far as that can be."""
    steps = [factor * 10.0**power for power in range(4) for factor in (1.0, 2.0, 5.0)]
    fitting = [step for step in steps if step * thickness <= 0.1 * relief]
    return fitting[-1] if fitting and thickness > 0.0 else 1.0


def _colour_bar(ax: Axes, drawn: Any, label: str) -> None:
    """A bar as high as the map beside it, whatever shape that has."""
    from mpl_toolkits.axes_grid1 import make_axes_locatable

    beside = make_axes_locatable(ax).append_axes("right", size="4%", pad=0.1)
    ax.figure.colorbar(drawn, cax=beside, label=label)


def _label(field: xr.DataArray) -> str:
    name = "share of the members" if str(field.name).startswith("exceedance_") else str(field.name).replace("_", " ")
    return _with_units(name, field.attrs)


def _with_units(name: str, attrs: dict[Any, Any]) -> str:
    """A name with its unit, as people write it."""
    units = str(attrs.get("units", "1")).replace("m s-1", "m/s")
    return name if units == "1" else f"{name} ({units})"


def _walk(points: NDArray[np.float64], step: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Places every `step` along a line, and how far along it they are."""
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 2:
        raise ValueError(f"a line has the shape (points, 2) with two points at least, found {points.shape}")
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    along = np.linspace(0.0, length[-1], max(2, int(length[-1] / step) + 1))
    return along, np.column_stack([np.interp(along, length, points[:, axis]) for axis in (0, 1)])


def _sampled(field: xr.DataArray, places: NDArray[np.float64]) -> NDArray[np.float64]:
    """The values of the cells that hold the places; NaN outside."""
    found = []
    for axis, at in (("y", places[:, 1]), ("x", places[:, 0])):
        centres = field[axis].values
        cell = centres[1] - centres[0]
        found.append(np.floor((at - centres[0]) / cell + 0.5).astype(int))
    rows, columns = found
    inside = (rows >= 0) & (rows < field.sizes["y"]) & (columns >= 0) & (columns < field.sizes["x"])
    values = np.full(len(places), np.nan)
    values[inside] = field.values[rows[inside], columns[inside]]
    return values
