"""The comparison with the similarity solution as a table, as JSON and as figures."""

import dataclasses
import json
import math
import sys

import matplotlib
import numpy

matplotlib.use("Agg")
import matplotlib.pyplot as plt

COLOURS = {"com1DFA": "#377eb8", "granflow, energy_stable_2": "#e41a1c", "granflow, energy_stable": "#ff7f00"}


@dataclasses.dataclass
class Group:
    """One friction angle on one grid: the solution and what each code found."""

    delta: float
    cell: float
    x: numpy.ndarray
    y: numpy.ndarray
    times: numpy.ndarray
    exact: list
    series: list
    errors: list


def write(out, groups, chosen):
    """similarity.md and similarity.json, again after each group."""
    versions = sorted({series.version for group in groups for series in group.series})
    lines = ["# The similarity solution", "", f"{', '.join(versions)}, Python {sys.version.split()[0]}. zeta {chosen.zeta:g} degrees. Threads of granflow: "
             f"{chosen.threads}. Relative L2 errors of the thickness, and of thickness times velocity, at the last instant.", "",
             "| delta | cell | run | thickness | momentum | seconds: clock, CPU |", "| --- | --- | --- | --- | --- | --- |"]
    content = []
    for group in groups:
        for series, rows in zip(group.series, group.errors):
            last = rows[-1]
            lines.append(f"| {group.delta:g}° | {group.cell:g} m | {series.name} | {100 * last['thickness']:.2f} % | {100 * last['momentum']:.2f} % "
                         f"| {series.seconds:.1f}, {series.cpu:.1f} |")
            content.append({"delta_deg": group.delta, "cell_m": group.cell, "run": series.name, "version": series.version,
                            "seconds": series.seconds, "cpu_seconds": series.cpu, "times_s": group.times.tolist(), "errors": rows})
    (out / "similarity.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (out / "similarity.json").write_text(json.dumps({"versions": versions, "zeta_deg": chosen.zeta, "runs": content}, indent=2), encoding="utf-8")


def figure(group, cap, path):
    """Thickness along and across the slope through the centre at the end, and the errors over time."""
    plot, axes = plt.subplots(2, 2, figsize=(12, 8), layout="constrained")
    h = group.exact[-1][0]
    row = len(group.y) // 2
    column = int(numpy.argmin(abs(group.x - (h.sum(0) * group.x).sum() / h.sum())))
    along = group.x / math.cos(cap.zeta)
    for name, colour, values in [("similarity solution", "k", h), *((s.name, COLOURS.get(s.name), s.frames[-1][0]) for s in group.series)]:
        style = {"color": colour, "label": name, "lw": 2.2 if name.startswith("similarity") else 1.3}
        axes[0, 0].plot(along, values[row], **style)
        axes[0, 1].plot(group.y, values[:, column], **style)
    shown = numpy.flatnonzero(h[row] > 0)
    axes[0, 0].set_xlim(along[shown[0]] - 30, along[shown[-1]] + 30)
    axes[0, 0].set_xlabel("along the slope [m]")
    axes[0, 1].set_xlabel("across the slope [m]")
    for axis in axes[0]:
        axis.set_ylabel(f"thickness at {group.times[-1]:g} s [m]")
        axis.legend()
    for axis, what in zip(axes[1], ("thickness", "momentum")):
        for series, rows in zip(group.series, group.errors):
            values = [numpy.nan if line[what] is None else 100 * line[what] for line in rows]
            axis.plot(group.times, values, "o-", color=COLOURS.get(series.name), label=series.name)
        axis.set_xlabel("time [s]")
        axis.set_ylabel(f"relative L2 error of the {'thickness' if what == 'thickness' else 'thickness times velocity'} [%]")
        axis.set_ylim(bottom=0)
        axis.legend()
    for axis in axes.flat:
        axis.grid(alpha=0.3)
    plot.suptitle(f"A cap slides down a plane of {math.degrees(cap.zeta):g}°, friction angle {group.delta:g}°, cells of {group.cell:g} m")
    plot.savefig(path, dpi=120)
    plt.close(plot)
