//! How much of each raster cell a polygon covers, exactly.

use crate::raster::Raster;
use geo::{Area, BoundingRect, LineString, MultiPolygon, Polygon};
use std::collections::BTreeMap;

/// Shares below this are rounding of sums along a row, shares this close to one are one.
const ROUNDING: f64 = 1e-12;

/// The shares of the cells that the parts of `whole` cover; they do not overlap.
pub fn together(whole: &MultiPolygon, raster: &Raster) -> BTreeMap<usize, f64> {
    let mut all: BTreeMap<usize, f64> = BTreeMap::new();
    for (cell, share) in whole.iter().flat_map(|polygon| shares(polygon, raster)) {
        *all.entry(cell).or_default() += share;
    }
    all
}

/// Covered shares of the cells, as (cell index, share) with 0 < share <= 1.
///
/// Green's theorem cell by cell: every piece of an edge between two grid lines adds its height, weighted by the
/// distance to the cell's eastern side, to its cell, and its whole height to all cells further east. What lies
/// outside the raster is left out, holes are left out, and the sum of share * cell^2 is the covered area.
pub fn shares(polygon: &Polygon, raster: &Raster) -> Vec<(usize, f64)> {
    let Some(bounds) = polygon.bounding_rect() else { return Vec::new() };
    let span = |low: f64, high: f64, origin: f64, count: usize| {
        let clip = |at: f64| at.clamp(0.0, count as f64) as usize;
        (clip(((low - origin) / raster.cell).floor()), clip(((high - origin) / raster.cell).ceil()))
    };
    let (first, last) = span(bounds.min().x, bounds.max().x, raster.west, raster.columns);
    let (bottom, top) = span(bounds.min().y, bounds.max().y, raster.south, raster.rows);
    let mut window = Window {
        west: raster.west + first as f64 * raster.cell,
        south: raster.south + bottom as f64 * raster.cell,
        cell: raster.cell,
        columns: last - first,
        rows: top - bottom,
        steps: vec![0.0; (last - first + 1) * (top - bottom)],
    };
    window.add(polygon.exterior(), 1.0);
    polygon.interiors().iter().for_each(|hole| window.add(hole, -1.0));
    let mut shares = Vec::new();
    for (row, steps) in window.steps.chunks_exact(window.columns + 1).enumerate() {
        let mut share = 0.0;
        for (column, step) in steps[..window.columns].iter().enumerate() {
            share += step;
            let cell = (bottom + row) * raster.columns + first + column;
            match share {
                s if s < ROUNDING => {}
                s if (s - 1.0).abs() < ROUNDING => shares.push((cell, 1.0)),
                s => shares.push((cell, s)),
            }
        }
    }
    shares
}

/// The part of the raster around a polygon; `steps` holds the change of the share from cell to cell along each row,
/// with one entry more than there are columns.
struct Window {
    west: f64,
    south: f64,
    cell: f64,
    columns: usize,
    rows: usize,
    steps: Vec<f64>,
}

impl Window {
    /// Adds the inside of a ring, whichever way round it is given, times `sign`.
    fn add(&mut self, ring: &LineString, sign: f64) {
        let clockwise = Polygon::new(ring.clone(), Vec::new()).signed_area() < 0.0;
        let sign = if clockwise { -sign } else { sign };
        for edge in ring.lines() {
            let place = |x: f64, y: f64| [(x - self.west) / self.cell, (y - self.south) / self.cell];
            self.edge(place(edge.start.x, edge.start.y), place(edge.end.x, edge.end.y), sign);
        }
    }

    /// Adds one edge between points in units of cells.
    fn edge(&mut self, from: [f64; 2], to: [f64; 2], sign: f64) {
        let mut cuts = vec![0.0, 1.0];
        for (axis, count) in [(0, self.columns), (1, self.rows)] {
            let (low, high) = (from[axis].min(to[axis]), from[axis].max(to[axis]));
            let length = to[axis] - from[axis];
            let lines = (low.ceil().max(0.0) as usize)
                ..=(high.floor().clamp(-1.0, count as f64) as isize).max(0) as usize;
            cuts.extend(
                lines.map(|line| (line as f64 - from[axis]) / length).filter(|t| *t > 0.0 && *t < 1.0),
            );
        }
        cuts.sort_by(f64::total_cmp);
        let at =
            |t: f64, axis: usize| if t == 1.0 { to[axis] } else { from[axis] + t * (to[axis] - from[axis]) };
        for pair in cuts.windows(2) {
            let (middle, rise) = (0.5 * (pair[0] + pair[1]), at(pair[1], 1) - at(pair[0], 1));
            let row = at(middle, 1).floor();
            if rise == 0.0 || !(row >= 0.0 && row < self.rows as f64) {
                continue;
            }
            let x = at(middle, 0).clamp(0.0, self.columns as f64);
            let column = (x as usize).min(self.columns);
            let east = (column as f64 + 1.0 - x).min(1.0);
            let steps = &mut self.steps[row as usize * (self.columns + 1)..][..self.columns + 1];
            // The inside of a ring that turns left lies west of rising edges.
            steps[column] -= sign * rise * east;
            if column < self.columns {
                steps[column + 1] -= sign * rise * (1.0 - east);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::tests::sampled;
    use geo::{Coord, polygon};

    fn area(polygon: &Polygon, raster: &Raster) -> f64 {
        shares(polygon, raster).iter().map(|(_, share)| share * raster.cell * raster.cell).sum()
    }

    #[test]
    fn whole_and_partial_cells_have_their_exact_shares() {
        let grid = sampled(4, 3, |_, _| 0.0);
        let square = polygon![(x: 0.5, y: 0.25), (x: 2.0, y: 0.25), (x: 2.0, y: 2.0), (x: 0.5, y: 2.0)];
        assert_eq!(shares(&square, &grid), [(0, 0.375), (1, 0.75), (4, 0.5), (5, 1.0)]);
        let triangle = polygon![(x: 1.0, y: 1.0), (x: 3.0, y: 1.0), (x: 1.0, y: 3.0)];
        assert_eq!(shares(&triangle, &grid), [(5, 1.0), (6, 0.5), (9, 0.5)]);
        let inside = polygon![(x: 1.2, y: 1.2), (x: 1.4, y: 1.2), (x: 1.4, y: 1.4), (x: 1.2, y: 1.4)];
        assert!((area(&inside, &grid) - 0.04).abs() < 1e-15);
    }

    #[test]
    fn holes_and_either_direction_are_honoured() {
        let grid = sampled(6, 6, |_, _| 0.0);
        let ring = |r: f64| {
            LineString::from(vec![
                (3.0 - r, 3.0 - r),
                (3.0 + r, 3.0 - r),
                (3.0 + r, 3.0 + r),
                (3.0 - r, 3.0 + r),
            ])
        };
        let reversed = |ring: LineString| LineString(ring.0.into_iter().rev().collect());
        for (outer, hole) in
            [(ring(2.0), ring(0.75)), (reversed(ring(2.0)), ring(0.75)), (ring(2.0), reversed(ring(0.75)))]
        {
            let found = shares(&Polygon::new(outer, vec![hole]), &grid);
            let total: f64 = found.iter().map(|(_, share)| share).sum();
            assert!((total - (16.0 - 2.25)).abs() < 1e-12);
            assert!(found.iter().any(|&(cell, share)| cell == 2 * 6 + 2 && (share - 0.4375).abs() < 1e-15));
        }
    }

    #[test]
    fn rough_outlines_keep_their_area_and_the_outside_is_clipped() {
        let grid = Raster { west: 178_000.3, south: 377_000.7, cell: 4.9977, ..sampled(60, 50, |_, _| 0.0) };
        let blob = |turn: f64| {
            let point = |k: usize| {
                let (angle, radius) = (k as f64 * 0.0311, 80.0 + 13.0 * (k as f64 * 0.7 + turn).sin());
                Coord { x: 178_150.0 + radius * angle.cos(), y: 377_120.0 + radius * angle.sin() }
            };
            Polygon::new((0..200).map(point).collect::<Vec<_>>().into(), Vec::new())
        };
        for turn in 0..20 {
            let blob = blob(f64::from(turn));
            assert!((area(&blob, &grid) / blob.unsigned_area() - 1.0).abs() < 1e-11);
        }
        let small = sampled(4, 4, |_, _| 0.0);
        let wide = polygon![(x: -5.0, y: 1.0), (x: 9.0, y: 1.0), (x: 9.0, y: 2.5), (x: -5.0, y: 2.5)];
        assert!((area(&wide, &small) - 6.0).abs() < 1e-12);
        let diamond = polygon![(x: 2.0, y: -2.0), (x: 6.0, y: 2.0), (x: 2.0, y: 6.0), (x: -2.0, y: 2.0)];
        assert!((area(&diamond, &small) - 16.0).abs() < 1e-12);
        let far = polygon![(x: 20.0, y: 20.0), (x: 21.0, y: 20.0), (x: 21.0, y: 21.0)];
        assert_eq!(shares(&far, &small), []);
    }
}
