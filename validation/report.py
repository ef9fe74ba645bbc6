"""The comparison as a table, as JSON and as figures."""

import dataclasses
import json
import sys

import matplotlib
import numpy
import runs
import scores
from environment import Refusal
from rasterio.features import rasterize

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.colors import LightSource, ListedColormap
from matplotlib.patches import Patch

COLOURS = {"both": "#4daf4a", "only com1DFA": "#377eb8", "only granflow": "#e41a1c"}


@dataclasses.dataclass
class Group:
    """The runs of one law on one grid, the first of them the reference, with their numbers."""

    law: str
    cell: float
    heights: numpy.ndarray
    transform: object
    runs: list
    rows: list


def numbers(run, reference, heights, released, transform, limits):
    """What the tables say of a run."""
    reach, angle = scores.runout(run.maps["pressure"], heights, released, transform)
    row = {"run": run.name, "volume_m3": run.volume, "ended_s": run.ended, "reason": run.reason, "steps": run.steps, "seconds": run.seconds,
           "cpu_seconds": run.cpu, "stepping_seconds": run.stepping, "peak_thickness_m": run.maps["thickness"].max(), "peak_speed_m_s": run.maps["speed"].max(),
           "peak_pressure_kpa": run.maps["pressure"].max(), "runout_m": reach, "reach_angle_deg": angle, "version": run.version}
    if "final" in run.maps:
        row["final_thickness_max_m"] = run.maps["final"].max()
        row["final_centroid_m"] = scores.centroid(run.maps["final"], transform)
    bounds = [("pressure", limit, "kPa") for limit in limits["pressure"]] + [("thickness", limit, "m") for limit in limits["thickness"]]
    row["areas"] = {f"{limit:g} {unit}": dataclasses.asdict(scores.areas(reference.maps[what], run.maps[what], limit, transform.a))
                    for what, limit, unit in bounds}
    return row


def group(law, cell, ground, polygons, found, limits):
    """The numbers of all runs on one grid; a refusal if a raster has other cells than the first run's."""
    heights, transform = runs.elevation(ground)
    for run in found:
        if run.maps["pressure"].shape != heights.shape or not run.transform.almost_equals(transform, 1e-3):
            raise Refusal(f"{run.folder}: cells differ from those of {ground}: {run.maps['pressure'].shape}, {heights.shape}",
                          "give --cell the cell size of the reference, and the DEM that it was computed on")
    released = rasterize(polygons, out_shape=heights.shape, transform=transform).astype(bool)
    rows = [numbers(run, found[0], heights, released, transform, limits) for run in found]
    return Group(law, cell, heights, transform, found, rows)


def cell_of(value, form):
    return "" if value is None else format(value, form)


def table(group):
    """Markdown: what each run says of itself, then the areas."""
    lines = [f"## {group.law}, {group.cell:g} m", "",
             "| run | volume | ended | peak thickness | peak speed | peak pressure | run-out (1 kPa) | final thickness | seconds: clock, CPU |",
             "| --- | --- | --- | --- | --- | --- | --- | --- | --- |"]
    for row in group.rows:
        ended = f"{cell_of(row['ended_s'], '.1f')} s, {row['reason']}" if row["reason"] else ""
        seconds = f"{row['seconds']:.1f}, {row['cpu_seconds']:.1f}" if row["seconds"] else ""
        final = f"{row['final_thickness_max_m']:.2f} m" if "final_thickness_max_m" in row else ""
        volume = f"{row['volume_m3']:.0f} m³" if row["volume_m3"] else ""
        lines.append(f"| {row['run']} | {volume} | {ended} | {row['peak_thickness_m']:.2f} m | {row['peak_speed_m_s']:.1f} m/s "
                     f"| {row['peak_pressure_kpa']:.0f} kPa | {cell_of(row['runout_m'], '.0f')} m "
                     f"| {final} | {seconds} |")
    first = group.rows[0]["run"]
    lines += ["", f"Areas of peak pressure or peak thickness, against {first}:", "", "| run | above | area | Jaccard index | covered | missed | false |",
              "| --- | --- | --- | --- | --- | --- | --- |"]
    for row in group.rows:
        for limit, areas in row["areas"].items():
            lines.append(f"| {row['run']} | {limit} | {areas['run']:.0f} m² | {areas['jaccard']:.3f} | {100 * areas['covered']:.1f} % "
                         f"| {areas['missed']:.0f} m² | {areas['false']:.0f} m² |")
    return "\n".join(lines) + "\n"


def write(out, groups, chosen):
    """comparison.md and comparison.json, again after each group, so that an interrupted comparison leaves what it has."""
    versions = sorted({row["version"] for group in groups for row in group.rows if row["version"]})
    head = [f"# granflow beside AvaFrame: {chosen.path.resolve().name if chosen.path else 'the mountain of granflow new avalanche'}", "",
            f"{', '.join(versions)}, Python {sys.version.split()[0]}. Threads of granflow: {chosen.threads}; com1DFA has one.",
            f"com1DFA with {', '.join(chosen.com1dfa) or 'its defaults'}; granflow with curvature over {f'{chosen.curvature:g} m' if chosen.curvature else 'two cells'}"
             f"{''.join(', ' + change for change in chosen.set)}, until "
            f"{'the kinetic energy is 1 % of its peak' if chosen.until == 'energy' else 'rest'}.", ""]
    (out / "comparison.md").write_text("\n".join(head + [table(group) for group in groups]), encoding="utf-8")
    content = {"versions": versions, "com1dfa": chosen.com1dfa, "granflow": chosen.set, "curvature_m": chosen.curvature, "until": chosen.until,
               "groups": [{"law": group.law, "cell_m": group.cell, "runs": group.rows} for group in groups]}
    (out / "comparison.json").write_text(json.dumps(content, indent=2), encoding="utf-8")


def window(group):
    """Rows and columns around all that was reached, with a margin."""
    reached = sum(run.maps["pressure"] > 0.5 for run in group.runs) > 0
    rows, columns = numpy.flatnonzero(reached.any(1)), numpy.flatnonzero(reached.any(0))
    margin = max(4, int(60 / group.transform.a))
    cut = lambda found, size: slice(max(found[0] - margin, 0), min(found[-1] + margin + 1, size))
    return cut(rows, reached.shape[0]), cut(columns, reached.shape[1])


def figure(group, path):
    """Peak pressure of com1DFA and of granflow's first scheme, and where both reach 1 kPa."""
    rows, columns = window(group)
    heights, cell = group.heights[rows, columns], group.transform.a
    left, top = group.transform.c + cell * columns.start, group.transform.f - cell * rows.start
    extent = (left, left + cell * heights.shape[1], top - cell * heights.shape[0], top)
    shade = LightSource(315, 45).hillshade(numpy.nan_to_num(heights, nan=numpy.nanmin(heights)), dx=cell, dy=cell)
    theirs, ours = group.runs[0], next(run for run in group.runs if run.name.startswith("granflow"))
    width = 4.2 * max(0.8, heights.shape[1] / heights.shape[0] * 1.6)
    plot, axes = plt.subplots(1, 3, figsize=(3 * width + 1, 7.5), sharex=True, sharey=True, layout="constrained")
    for axis in axes:
        axis.imshow(shade, cmap="gray", extent=extent, alpha=0.5)
        axis.contour(heights[::-1], levels=numpy.arange(0, 9000, 50), extent=extent, colors="k", linewidths=0.25, alpha=0.5)
        axis.set_xlabel("easting [m]")
        axis.ticklabel_format(style="plain", useOffset=False)
        axis.tick_params(axis="x", rotation=40)
    axes[0].set_ylabel("northing [m]")
    largest = max(theirs.maps["pressure"].max(), ours.maps["pressure"].max())
    for axis, run in zip(axes, (theirs, ours)):
        pressure = run.maps["pressure"][rows, columns]
        image = axis.imshow(numpy.where(pressure >= 1, pressure, numpy.nan), extent=extent, cmap="viridis", norm="log", clim=(1, largest))
        axis.set_title(run.name)
    plot.colorbar(image, ax=axes[:2], location="bottom", label="peak pressure [kPa], 1 kPa and more", shrink=0.6)
    a, b = (run.maps["pressure"][rows, columns] >= 1 for run in (theirs, ours))
    kinds = numpy.where(a & b, 0.0, numpy.where(a, 1.0, numpy.where(b, 2.0, numpy.nan)))
    axes[2].imshow(kinds, extent=extent, cmap=ListedColormap(list(COLOURS.values())), vmin=-0.5, vmax=2.5, interpolation="nearest")
    index = scores.areas(theirs.maps["pressure"], ours.maps["pressure"], 1.0, cell).jaccard
    axes[2].set_title(f"1 kPa: Jaccard index {index:.3f}")
    handles = [Patch(color=colour, label=label) for label, colour in COLOURS.items()]
    plot.legend(handles=handles, loc="outside lower right", ncols=3)
    plot.suptitle(f"{group.law}, cells of {group.cell:g} m")
    plot.savefig(path, dpi=120)
    plt.close(plot)
