//! Zones: what an attribute of polygons says of each cell.

use super::thickness::attribute;
use super::{Layer, ReleaseError, coverage, same_system, sound};
use crate::raster::Raster;
use geo::{BoundingRect, MultiPolygon, unary_union};

impl Layer {
    /// The number that `name` gives in each cell of `template`: that of the feature which covers most of the cell, of several the
    /// first; not a number where more of the cell is bare than that feature covers.
    ///
    /// # Errors
    /// [`ReleaseError::Shape`] for rings that cross themselves, [`ReleaseError::Attribute`] for a missing attribute,
    /// [`ReleaseError::Value`] for one that is no number, and the system as for a release.
    pub fn zones(self, name: &str, template: &Raster) -> Result<Vec<f64>, ReleaseError> {
        let path = &*self.name;
        same_system(&self, template)?;
        let count = template.values.len();
        let (mut values, mut largest, mut bare) = (vec![f64::NAN; count], vec![0.0; count], vec![1.0; count]);
        let mut all = Vec::new();
        for feature in &self.features {
            let (name, text, value) = attribute(path, feature, name)?;
            let Some(value) = value.filter(|value| value.is_finite()) else {
                let (name, found) = (name.to_owned(), text.to_owned());
                return Err(ReleaseError::Value { path: path.into(), feature: feature.number, name, found });
            };
            let polygons = sound(path, feature.number, feature.polygons.clone())?;
            for (cell, share) in coverage::together(&unary_union(&polygons), template) {
                if share > largest[cell] {
                    (largest[cell], values[cell]) = (share, value);
                }
            }
            all.extend(polygons);
        }
        for (cell, share) in coverage::together(&unary_union(&all), template) {
            bare[cell] -= share;
        }
        if largest.iter().all(|share| *share == 0.0) {
            let Some(extent) = MultiPolygon::new(all).bounding_rect() else {
                return Err(ReleaseError::Nothing { path: path.into(), problem: "it holds no polygon" });
            };
            let (low, high) = (extent.min(), extent.max());
            return Err(ReleaseError::outside(path, [low.x, low.y, high.x, high.y], template, 1.0));
        }
        for (value, _) in
            values.iter_mut().zip(largest.iter().zip(&bare)).filter(|(_, (share, bare))| share < bare)
        {
            *value = f64::NAN;
        }
        Ok(values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn template() -> Raster {
        Raster { columns: 4, rows: 3, west: 0.0, south: 0.0, cell: 1.0, values: vec![0.0; 12], crs: None }
    }

    fn layer(rings: &[(&str, [[f64; 2]; 2])]) -> Layer {
        let features: Vec<String> = rings
            .iter()
            .map(|(mu, [[west, south], [east, north]])| {
                format!(
                    r#"{{"type":"Feature","properties":{{"mu":{mu}}},"geometry":{{"type":"Polygon","coordinates":
                    [[[{west},{south}],[{east},{south}],[{east},{north}],[{west},{north}],[{west},{south}]]]}}}}"#
                )
            })
            .collect();
        let text = format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(","));
        Layer::from_bytes(Path::new("zones.geojson"), text.as_bytes(), None, None).unwrap()
    }

    #[test]
    fn a_cell_takes_the_number_of_the_polygon_that_covers_most_of_it() {
        let west = ("0.3", [[0.0, 0.0], [1.6, 3.0]]);
        let east = ("0.5", [[1.6, 0.0], [3.4, 3.0]]);
        let values = layer(&[west, east]).zones("mu", &template()).unwrap();
        for row in values.chunks(4) {
            assert_eq!(row[..3], [0.3, 0.3, 0.5]);
            assert!(row[3].is_nan(), "four tenths of it are covered: {row:?}");
        }
    }

    #[test]
    fn what_polygons_cover_together_is_not_counted_twice() {
        let part = [[0.0, 0.0], [0.4, 3.0]];
        let twice = layer(&[("0.9", part), ("0.9", part)]).zones("mu", &template()).unwrap();
        assert!(twice[0].is_nan(), "six tenths of it are bare: {}", twice[0]);
    }

    #[test]
    fn a_polygon_over_all_gives_its_number_everywhere_bit_for_bit() {
        let all = ("0.1", [[-7.0, -9.0], [11.0, 8.0]]);
        let values = layer(&[all]).zones("MU", &template()).unwrap();
        assert!(values.iter().all(|value| value.to_bits() == 0.1_f64.to_bits()), "{values:?}");
    }

    #[test]
    fn what_is_no_number_is_named_with_its_feature() {
        let layer = layer(&[("0.3", [[0.0, 0.0], [1.0, 1.0]]), ("null", [[1.0, 0.0], [2.0, 1.0]])]);
        let error = layer.zones("mu", &template()).unwrap_err().to_string();
        assert!(
            error.contains("feature 2") && error.contains("mu") && error.contains("not given"),
            "{error}"
        );
    }
}
