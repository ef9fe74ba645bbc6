//! The box of the world that a map shows, and the paper for it.

use super::axes::extent;
use super::map::Map;

/// Where a raster lies: row 0 is the southernmost, values belong to whole cells.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Extent {
    /// Cells from west to east, at least two.
    pub nx: usize,
    /// Cells from south to north, at least two.
    pub ny: usize,
    /// The western edge (not centre) of the first column.
    pub west: f64,
    /// The southern edge of the first row.
    pub south: f64,
    /// Side of a cell.
    pub cell: f64,
}

impl Extent {
    pub(super) fn east(&self) -> f64 {
        self.west + self.nx as f64 * self.cell
    }
    pub(super) fn north(&self) -> f64 {
        self.south + self.ny as f64 * self.cell
    }
}

/// The part of the world that a map shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct View {
    pub x: [f64; 2],
    pub y: [f64; 2],
}

/// Width and height of what shows this box, in points.
pub(super) fn paper(view: View) -> (f64, f64) {
    let ratio = (view.y[1] - view.y[0]) / (view.x[1] - view.x[0]);
    if ratio < 0.95 { (640.0, 640.0 * ratio) } else { (610.0 / ratio, 610.0) }
}

impl Map<'_> {
    /// The whole raster, or the box around what is of interest, not narrower than 1 to 2.2.
    pub(super) fn view(&self) -> View {
        let e = self.extent;
        let whole = View { x: [e.west, e.east()], y: [e.south, e.north()] };
        let Some(margin) = self.crop else { return whole };
        let (mut xs, mut ys): (Vec<f64>, Vec<f64>) =
            self.outlines.iter().flat_map(|o| o.points).map(|p| (p[0], p[1])).unzip();
        if let Some(overlay) = self.overlay {
            for (k, _) in overlay.values.iter().enumerate().filter(|&(_, &v)| v > overlay.threshold) {
                let (i, j) = ((k % e.nx) as f64, (k / e.nx) as f64);
                xs.extend([e.west + i * e.cell, e.west + (i + 1.0) * e.cell]);
                ys.extend([e.south + j * e.cell, e.south + (j + 1.0) * e.cell]);
            }
        }
        let (Some([x0, x1]), Some([y0, y1])) = (extent(xs), extent(ys)) else { return whole };
        let greater = (x1 - x0).max(y1 - y0).max(12.0 * e.cell);
        // Each side: the box and its margin, the other side over 2.2 at least, the raster at most.
        let side = |[low, high]: [f64; 2], [least, most]: [f64; 2]| {
            let half = (0.5 * (high - low) + margin.max(0.0) * greater).max(greater / 4.4);
            let middle = 0.5 * (low + high);
            let (low, high) = ((middle - half).max(least), (middle + half).min(most));
            if low < high { [low, high] } else { [least, most] }
        };
        View { x: side([x0, x1], whole.x), y: side([y0, y1], whole.y) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::map::Overlay;
    use super::*;

    #[test]
    fn the_view_holds_the_field_and_stays_inside() {
        let extent = Extent { nx: 100, ny: 80, west: 1000.0, south: 2000.0, cell: 10.0 };
        let bed = vec![0.0; 8000];
        let mut values = vec![0.0; 8000];
        for j in 20..60 {
            values[j * 100 + 3] = 1.0;
        }
        let overlay = Overlay { values: &values, threshold: 0.5, ..Default::default() };
        let map = Map { extent, bed: &bed, overlay: Some(overlay), crop: Some(0.1), ..Default::default() };
        let view = map.view();
        assert_eq!(view.y, [2200.0 - 40.0, 2600.0 + 40.0]);
        assert_eq!(view.x[0], 1000.0);
        assert!(view.x[1] >= 1040.0 + 40.0 && view.x[1] - view.x[0] < 400.0);
        let nothing = Map { overlay: None, ..map };
        assert_eq!(nothing.view().x, [1000.0, 2000.0]);
    }
}
