//! What an engineer looks at before trusting an elevation model: range, gaps, steps between neighbours, pits.

use crate::Remark;
use crate::raster::Raster;
use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// A step between neighbours that no natural cliff has \[m\].
const CLIFF: f64 = 500.0;
/// Beside cells as high as this \[m\] a height of exactly 0 is a value that is missing.
const HIGH: f64 = 100.0;
/// Heights on land \[m\].
const LAND: [f64; 2] = [-450.0, 8900.0];

/// Heights of a terrain at a glance.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    /// Cells without elevation.
    pub missing: usize,
    /// Lowest and highest elevation \[m\].
    pub range: [f64; 2],
    /// The largest step between neighbours along an axis \[m\], and the place between them.
    pub step: f64,
    /// Where it is: x, y \[m\].
    pub step_at: [f64; 2],
    /// The highest neighbour of a cell of exactly 0 m \[m\], and the place between them.
    pub beside_zero: Option<(f64, [f64; 2])>,
}

impl Survey {
    /// Of a terrain that has values.
    pub fn of(bed: &Raster) -> Survey {
        let (low, high) = bed.range().unwrap_or((f64::NAN, f64::NAN));
        let missing = bed.values.iter().filter(|z| z.is_nan()).count();
        let mut survey =
            Survey { missing, range: [low, high], step: 0.0, step_at: [0.0; 2], beside_zero: None };
        for (k, &own) in bed.values.iter().enumerate() {
            let [column, row] = bed.place(k);
            let east = (column + 1 < bed.columns).then_some((k + 1, [0.5, 0.0]));
            let north = (row + 1 < bed.rows).then_some((k + bed.columns, [0.0, 0.5]));
            for (neighbour, shift) in east.into_iter().chain(north) {
                let other = bed.values[neighbour];
                let at = [bed.x(column) + shift[0] * bed.cell, bed.y(row) + shift[1] * bed.cell];
                if (own - other).abs() > survey.step {
                    (survey.step, survey.step_at) = ((own - other).abs(), at);
                }
                let above = own.max(other);
                let zero = own == 0.0 || other == 0.0;
                if zero && above > survey.beside_zero.map_or(HIGH, |(highest, _)| highest) {
                    survey.beside_zero = Some((above, at));
                }
            }
        }
        survey
    }

    /// What looks wrong; `name` is the file.
    pub fn warnings(&self, name: &str) -> Vec<Remark> {
        let mut found = Vec::new();
        let mut warn = |text: String| found.push(Remark::Warning(format!("{name}: {text}")));
        let [low, high] = self.range;
        if low < LAND[0] || high > LAND[1] {
            warn(format!(
                "heights from {low:.1} to {high:.1} m are not those of land; is their unit the metre?"
            ));
        }
        let [x, y] = self.step_at;
        if self.step > CLIFF {
            let step = self.step;
            warn(format!(
                "a cliff of {step:.1} m between two cells at ({x:.1}, {y:.1}); is a value there that stands for none?"
            ));
        }
        if let Some((height, [x, y])) = self.beside_zero {
            warn(format!(
                "0 m beside {height:.1} m at ({x:.1}, {y:.1}); if 0 stands for no value, declare it: \
                 gdal_edit.py -a_nodata 0 for a GeoTIFF, NODATA_value 0 in an ASCII grid"
            ));
        }
        found
    }
}

/// Cells from which no path leads down to the edge or to a gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pits {
    /// Number of cells below the level at which their pit would run over.
    pub cells: usize,
    /// Volume up to that level \[m^3\].
    pub volume: f64,
    /// The greatest depth below it \[m\].
    pub depth: f64,
    /// Where that is: x, y \[m\].
    pub place: [f64; 2],
}

/// A height that is ordered; heights of a terrain are numbers.
#[derive(PartialEq)]
struct Level(f64);

impl Eq for Level {}

impl Ord for Level {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0)
    }
}

impl PartialOrd for Level {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Pits {
    /// Floods the terrain from its edges and gaps inwards, the lowest place first (priority flood; Barnes, Lehman and Mulla,
    /// Computers & Geosciences 62 (2014)), over the eight neighbours.
    pub fn of(bed: &Raster) -> Pits {
        let mut pits = Pits { cells: 0, volume: 0.0, depth: 0.0, place: [0.0; 2] };
        let mut reached: Vec<bool> = bed.values.iter().map(|z| z.is_nan()).collect();
        let mut front = BinaryHeap::new();
        for k in (0..reached.len()).filter(|&k| !bed.values[k].is_nan()) {
            let [column, row] = bed.place(k);
            let edge = column == 0 || row == 0 || column + 1 == bed.columns || row + 1 == bed.rows;
            if edge || around(bed, k).any(|other| bed.values[other].is_nan()) {
                front.push(Reverse((Level(bed.values[k]), k)));
            }
        }
        front.iter().for_each(|Reverse((_, k))| reached[*k] = true);
        while let Some(Reverse((Level(level), k))) = front.pop() {
            let depth = level - bed.values[k];
            if depth > 0.0 {
                pits.cells += 1;
                pits.volume += depth * bed.cell * bed.cell;
                if depth > pits.depth {
                    let [column, row] = bed.place(k);
                    (pits.depth, pits.place) = (depth, [bed.x(column), bed.y(row)]);
                }
            }
            for other in around(bed, k) {
                if !std::mem::replace(&mut reached[other], true) {
                    front.push(Reverse((Level(bed.values[other].max(level)), other)));
                }
            }
        }
        pits
    }
}

/// The up to eight neighbours of a cell.
fn around(bed: &Raster, k: usize) -> impl Iterator<Item = usize> {
    let (columns, rows) = (bed.columns, bed.rows);
    let [column, row] = bed.place(k);
    let span = |at: usize, count: usize| at.saturating_sub(1)..(at + 2).min(count);
    let all =
        span(row, rows).flat_map(move |row| span(column, columns).map(move |column| row * columns + column));
    all.filter(move |&other| other != k)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::tests::sampled;

    #[test]
    fn a_good_mountain_has_no_warnings() {
        let survey = Survey::of(&sampled(9, 7, |x, y| if x < 1.0 { f64::NAN } else { 1000.0 + 2.0 * x - y }));
        assert_eq!((survey.missing, survey.step, survey.beside_zero), (7, 2.0, None));
        assert!(survey.warnings("dem.tif").is_empty());
        let beach = Survey::of(&sampled(9, 7, |x, _| (x - 4.5).max(0.0)));
        assert!(beach.warnings("dem.tif").is_empty(), "the sea is at 0");
    }

    #[test]
    fn cliffs_zeros_and_heights_of_no_land_are_told_with_their_place() {
        let bed = |odd: f64| sampled(9, 7, move |x, y| if x == 4.5 && y == 2.5 { odd } else { 1500.0 });
        let told = |odd: f64| {
            let all = Survey::of(&bed(odd)).warnings("dem.tif");
            all.iter().map(|remark| remark.text().to_string()).collect::<Vec<_>>().join("\n")
        };
        assert!(told(900.0).contains("dem.tif: a cliff of 600.0 m between two cells at (4.5, 2.0)"));
        let zero = told(0.0);
        assert!(
            zero.contains("0 m beside 1500.0 m at (4.5, 2.0)") && zero.contains("cliff of 1500.0 m"),
            "{zero}"
        );
        assert!(told(9100.0).contains("not those of land"));
        assert_eq!(told(1100.0), "");
    }

    #[test]
    fn pits_hold_what_cannot_run_out() {
        let depth =
            |x: f64, y: f64| if (2.0..5.0).contains(&x) && (2.0..4.0).contains(&y) { 3.0 } else { 0.0 };
        let walled = Pits::of(&sampled(9, 7, |x, y| 100.0 + x - depth(x, y)));
        // The rim is lowest at x = 1.5, where cells are at 101.5; the pit's floor is at 99.5, 100.5, 101.5.
        assert_eq!((walled.cells, walled.volume, walled.depth), (4, 2.0 * (2.0 + 1.0), 2.0));
        assert_eq!(walled.place[0], 2.5);
        let open =
            Pits::of(&sampled(
                9,
                7,
                |x, y| if x == 1.5 && y == 2.5 { f64::NAN } else { 100.0 + x - depth(x, y) },
            ));
        assert_eq!((open.cells, open.volume), (0, 0.0));
        assert_eq!(Pits::of(&sampled(9, 7, |x, _| x)).cells, 0);
    }
}
