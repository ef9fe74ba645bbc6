"""How alike two maps are: areas above a threshold, run-out, peaks. Rows from the north, square cells."""

import dataclasses

import numpy


@dataclasses.dataclass
class Areas:
    """Areas [m²] of the cells at or above a threshold, in the reference and in the run, and their overlap as shares."""

    reference: float
    run: float
    jaccard: float
    covered: float
    missed: float
    false: float


def areas(reference, run, threshold, cell):
    """The index of Jaccard |A∩B|/|A∪B| (the critical success index), covered |A∩B|/|A|, missed |A−B|, false |B−A|."""
    a, b = reference >= threshold, run >= threshold
    both, either = numpy.count_nonzero(a & b), numpy.count_nonzero(a | b)
    size = cell * cell
    share = lambda part, whole: part / whole if whole else float("nan")
    return Areas(a.sum() * size, b.sum() * size, share(both, either), share(both, numpy.count_nonzero(a)),
                 numpy.count_nonzero(a & ~b) * size, numpy.count_nonzero(b & ~a) * size)


def centres(transform, shape):
    """Coordinates of the cell centres: x of the columns, y of the rows."""
    columns = transform.c + transform.a * (numpy.arange(shape[1]) + 0.5)
    rows = transform.f + transform.e * (numpy.arange(shape[0]) + 0.5)
    return columns, rows


def runout(pressure, heights, released, transform, threshold=1.0):
    """Horizontal length [m] from the highest released cell to the farthest with a peak pressure [kPa] of the threshold, and the
    angle [degrees] of that line below the horizontal; None where no cell has it. As granflow's summary.json defines it."""
    reached = pressure >= threshold
    if not reached.any() or not released.any():
        return None, None
    x, y = centres(transform, pressure.shape)
    top = numpy.unravel_index(numpy.argmax(numpy.where(released, heights, -numpy.inf)), heights.shape)
    length = numpy.where(reached, numpy.hypot(x[None, :] - x[top[1]], y[:, None] - y[top[0]]), -1.0)
    end = numpy.unravel_index(numpy.argmax(length), length.shape)
    return float(length[end]), float(numpy.degrees(numpy.arctan2(heights[top] - heights[end], length[end])))


def centroid(thickness, transform):
    """Centre of the volume [m, m]."""
    x, y = centres(transform, thickness.shape)
    total = thickness.sum()
    return float((thickness * x[None, :]).sum() / total), float((thickness * y[:, None]).sum() / total)
