//! Cells through which mass enters: along a line, or under polygons.

use super::{LOST, Layer, ReleaseError, coverage, same_system, sound};
use crate::raster::Raster;
use geo::{Area, BoundingRect, unary_union};
use std::collections::BTreeMap;

/// The cells of `template` that a line of points [x, y] passes, each with its share of the length.
///
/// # Errors
/// [`ReleaseError::Line`] for a line without length, beyond the edge of `template` or over nodata.
pub fn along(line: &[[f64; 2]], template: &Raster) -> Result<Vec<(usize, f64)>, ReleaseError> {
    let mut lengths: BTreeMap<usize, f64> = BTreeMap::new();
    for ends in line.windows(2) {
        let length = (ends[1][0] - ends[0][0]).hypot(ends[1][1] - ends[0][1]);
        let at = |t: f64| [0, 1].map(|k| ends[0][k] + t * (ends[1][k] - ends[0][k]));
        let cuts = cuts(ends[0], ends[1], template);
        for piece in cuts.windows(2).filter(|piece| piece[0] < piece[1]) {
            let middle = at(0.5 * (piece[0] + piece[1]));
            let Some(cell) = template.cell_at(middle).filter(|cell| !template.values[*cell].is_nan()) else {
                let [x, y] = middle;
                let problem = format!("it has no elevation below it at ({x:.1}, {y:.1})");
                return Err(ReleaseError::Line { problem });
            };
            *lengths.entry(cell).or_default() += length * (piece[1] - piece[0]);
        }
    }
    shares(lengths).ok_or(ReleaseError::Line { problem: "it has no length".to_owned() })
}

impl Layer {
    /// The cells of `template` under these polygons, each with its share of the area.
    ///
    /// # Errors
    /// As for a release: rings that cross themselves, another system, polygons beyond the edge of `template` or on nodata.
    pub fn cells(self, template: &Raster) -> Result<Vec<(usize, f64)>, ReleaseError> {
        same_system(&self, template)?;
        let mut polygons = Vec::new();
        for feature in &self.features {
            polygons.extend(sound(&self.name, feature.number, feature.polygons.clone())?);
        }
        let whole = unary_union(&polygons);
        let mut areas = coverage::together(&whole, template);
        areas.retain(|cell, _| !template.values[*cell].is_nan());
        let covered = areas.values().sum::<f64>() * template.cell * template.cell;
        let Some(extent) = whole.bounding_rect() else {
            return Err(ReleaseError::Nothing { path: self.name.clone(), problem: "it holds no polygon" });
        };
        let lost = 1.0 - covered / whole.unsigned_area();
        let (low, high) = (extent.min(), extent.max());
        match shares(areas).filter(|_| lost <= LOST) {
            Some(shares) => Ok(shares),
            None => Err(ReleaseError::outside(&self.name, [low.x, low.y, high.x, high.y], template, lost)),
        }
    }
}

/// Each part as a share of the sum, if there is any.
fn shares(parts: BTreeMap<usize, f64>) -> Option<Vec<(usize, f64)>> {
    let sum: f64 = parts.values().sum();
    (sum > 0.0).then(|| parts.into_iter().map(|(cell, part)| (cell, part / sum)).collect())
}

/// Where a straight line passes from cell to cell, as shares of its length, with both ends.
fn cuts(from: [f64; 2], to: [f64; 2], template: &Raster) -> Vec<f64> {
    let mut cuts = vec![0.0, 1.0];
    for (k, origin) in [template.west, template.south].into_iter().enumerate() {
        let [low, high] = [from[k].min(to[k]), from[k].max(to[k])].map(|x| (x - origin) / template.cell);
        let count = if k == 0 { template.columns } else { template.rows } as f64;
        let (first, last) = (low.ceil().max(0.0), high.floor().min(count));
        let mut number = first;
        while number <= last {
            cuts.push((origin + number * template.cell - from[k]) / (to[k] - from[k]));
            number += 1.0;
        }
    }
    cuts.retain(|t| (0.0..=1.0).contains(t));
    cuts.sort_by(f64::total_cmp);
    cuts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn template() -> Raster {
        let mut values = vec![0.0; 12];
        values[7] = f64::NAN;
        Raster { columns: 4, rows: 3, west: 10.0, south: 20.0, cell: 2.0, values, crs: None }
    }

    #[test]
    fn a_line_is_shared_by_the_cells_that_it_passes() {
        let straight = along(&[[11.0, 21.0], [15.0, 21.0]], &template()).unwrap();
        assert_eq!(straight, [(0, 0.25), (1, 0.5), (2, 0.25)]);
        let bent = along(&[[11.0, 21.0], [11.0, 25.0], [13.0, 25.0]], &template()).unwrap();
        let sum: f64 = bent.iter().map(|(_, share)| share).sum();
        assert_eq!(bent.iter().map(|(cell, _)| *cell).collect::<Vec<_>>(), [0, 4, 8, 9]);
        assert!((sum - 1.0).abs() < 1e-15);
        let diagonal = along(&[[10.0, 20.0], [14.0, 24.0]], &template()).unwrap();
        assert_eq!(diagonal, [(0, 0.5), (5, 0.5)]);
    }

    #[test]
    fn a_line_beyond_the_data_is_refused_with_its_place() {
        for line in [[[9.0, 21.0], [12.0, 21.0]], [[15.0, 23.0], [17.5, 23.0]], [[11.0, 21.0], [11.0, 21.0]]]
        {
            let error = along(&line, &template()).unwrap_err().to_string();
            assert!(
                error.contains("line") && (error.contains("no elevation") || error.contains("no length")),
                "{error}"
            );
        }
    }
}
