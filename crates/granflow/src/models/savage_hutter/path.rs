//! The path of a mass: the line along which most of it went, from the highest release to the farthest cell
//! reached.

use super::terrain::TerrainDomain;
use crate::model::View;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A cell without flow costs as much as one with this share of the greatest.
const FLOOR: f64 = 0.01;
/// The staircase of cells is straightened by the mean over so many neighbours on each side.
const SMOOTH: usize = 4;

/// The cells along the path, with the smoothed line through them.
#[derive(Debug, Clone)]
pub(super) struct PathLine {
    pub cells: Vec<usize>,
    pub points: Vec<[f64; 2]>,
    /// Distance along the line, horizontal \[m\].
    pub distance: Vec<f64>,
}

/// The path of a run on a mountain.
///
/// Among all lines from the highest released cell to the reached cell farthest from it, that of the smallest
/// integral of 1/(q + q_max/100) ds, with q the greatest thickness times the greatest speed of a cell (Dijkstra
/// over eight neighbours): it follows the core of the flow. Where nothing has moved it is the shortest.
pub(super) fn path(view: &View, terrain: &TerrainDomain) -> Option<PathLine> {
    let bed = &terrain.raster.values;
    let (thickness, speed) = (view.map("peak_thickness")?, view.map("peak_speed")?);
    let (x, y) = (&view.x, &view.y);
    let columns = x.len();
    let release = &terrain.release;
    let least = terrain.release_threshold();
    let released = release.iter().filter(|(_, thickness)| *thickness > least).map(|(cell, _)| cell);
    let top = released.max_by(|&a, &b| bed[a].total_cmp(&bed[b]))?;
    let apart = |a: usize, b: usize| (x[a % columns] - x[b % columns]).hypot(y[a / columns] - y[b / columns]);
    let far = (0..bed.len())
        .filter(|&k| thickness[k] > terrain.threshold && bed[k].is_finite())
        .max_by(|&a, &b| apart(a, top).total_cmp(&apart(b, top)))?;

    let flow: Vec<f64> = thickness.iter().zip(speed).map(|(h, u)| h * u).collect();
    let most = flow.iter().fold(0.0_f64, |most, v| most.max(*v));
    if far == top {
        return None;
    }
    let floor = if most > 0.0 { FLOOR * most } else { 1.0 };
    let price = |k: usize| 1.0 / (flow[k].max(0.0) + floor);
    let cost = |a: usize, b: usize| apart(a, b) * 0.5 * (price(a) + price(b));
    let cells = cheapest([top, far], [columns, y.len()], |cell| bed[cell].is_finite(), cost)?;
    Some(PathLine::through(cells, x, y))
}

/// The cells from the first to the second of `ends` at the least sum of `cost`, by steps between the eight
/// neighbours among the open cells of a raster of `columns` and `rows` (Dijkstra).
fn cheapest(
    [start, end]: [usize; 2],
    [columns, rows]: [usize; 2],
    is_open: impl Fn(usize) -> bool,
    cost: impl Fn(usize, usize) -> f64,
) -> Option<Vec<usize>> {
    let (mut least, mut from) = (vec![f64::INFINITY; columns * rows], vec![usize::MAX; columns * rows]);
    // The bits of numbers that are not negative rise as the numbers do.
    let mut queue = BinaryHeap::from([Reverse((0_u64, start))]);
    least[start] = 0.0;
    while let Some(Reverse((bits, k))) = queue.pop() {
        if k == end {
            break;
        }
        if f64::from_bits(bits) > least[k] {
            continue;
        }
        let (i, j) = (k % columns, k / columns);
        for row in j.saturating_sub(1)..(j + 2).min(rows) {
            for column in i.saturating_sub(1)..(i + 2).min(columns) {
                let next = row * columns + column;
                let total = least[k] + cost(k, next);
                if is_open(next) && total < least[next] {
                    least[next] = total;
                    from[next] = k;
                    queue.push(Reverse((total.to_bits(), next)));
                }
            }
        }
    }
    let mut cells = vec![end];
    while let Some(&k) = cells.last().filter(|&&k| k != start) {
        cells.push(*from.get(from[k]).map(|_| &from[k])?);
    }
    cells.reverse();
    Some(cells)
}

impl PathLine {
    /// The line through these cells, straightened.
    fn through(cells: Vec<usize>, x: &[f64], y: &[f64]) -> PathLine {
        let columns = x.len();
        let smooth = |place: usize| {
            let reach = SMOOTH.min(place).min(cells.len() - 1 - place);
            let near = &cells[place - reach..=place + reach];
            let mean =
                |at: &dyn Fn(usize) -> f64| near.iter().map(|&k| at(k)).sum::<f64>() / near.len() as f64;
            [mean(&|k| x[k % columns]), mean(&|k| y[k / columns])]
        };
        let points: Vec<[f64; 2]> = (0..cells.len()).map(smooth).collect();
        let mut distance = vec![0.0];
        for pair in points.windows(2) {
            let step = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
            distance.push(distance[distance.len() - 1] + step);
        }
        PathLine { cells, points, distance }
    }
}
