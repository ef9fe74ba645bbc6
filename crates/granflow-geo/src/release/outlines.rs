//! Polygons as one part of the plane: which places it holds and how far they are from its rim.

use super::{Layer, ReleaseError};
use geo::{BoundingRect, Distance, Euclidean, Intersects, Point, Polygon};
use std::path::Path;

/// The polygons of a file; a place belongs to them if it lies in one of them or on its rim, and not in its holes.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlines {
    polygons: Vec<Polygon>,
}

impl Outlines {
    /// All polygons of a shapefile or GeoJSON file; where they overlap, each stands for itself.
    ///
    /// # Errors
    /// [`ReleaseError`] for unreadable files, other shapes than polygons, rings that cross themselves, no polygon at all.
    pub fn read(path: &Path) -> Result<Self, ReleaseError> {
        Self::of(Layer::read(path)?)
    }

    /// All polygons of a layer.
    ///
    /// # Errors
    /// As [`Outlines::read`], but for reading.
    pub fn of(layer: Layer) -> Result<Self, ReleaseError> {
        let path = layer.name.clone();
        let polygons = layer.outlines()?;
        match polygons.is_empty() {
            true => Err(ReleaseError::Empty { path }),
            false => Ok(Self { polygons }),
        }
    }

    /// Whether a place lies in a polygon or on its rim.
    pub fn holds(&self, [x, y]: [f64; 2]) -> bool {
        self.polygons.iter().any(|polygon| polygon.intersects(&Point::new(x, y)))
    }

    /// Distance of a place from the nearest ring, positive within: the greatest over all polygons.
    pub fn depth(&self, [x, y]: [f64; 2]) -> f64 {
        let place = Point::new(x, y);
        let depth = |polygon: &Polygon| {
            let rings = std::iter::once(polygon.exterior()).chain(polygon.interiors());
            let away = rings.map(|ring| Euclidean.distance(&place, ring)).fold(f64::INFINITY, f64::min);
            if polygon.intersects(&place) { away } else { -away }
        };
        self.polygons.iter().map(depth).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The ends [low, high] along x and y.
    pub fn bounds(&self) -> [[f64; 2]; 2] {
        let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for rect in self.polygons.iter().filter_map(BoundingRect::bounding_rect) {
            let ends = [[rect.min().x, rect.max().x], [rect.min().y, rect.max().y]];
            for (all, one) in bounds.iter_mut().zip(ends) {
                *all = [all[0].min(one[0]), all[1].max(one[1])];
            }
        }
        bounds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Outlines, ReleaseError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ring.geojson");
        std::fs::write(&path, text).unwrap();
        Outlines::read(&path)
    }

    #[test]
    fn a_polygon_has_its_hole_not() {
        let ring = read(
            r#"{"type":"Polygon","coordinates":[[[0,0],[4,0],[4,4],[0,4],[0,0]],[[1,1],[1,3],[3,3],[3,1],[1,1]]]}"#,
        )
        .unwrap();
        assert!(ring.holds([0.5, 2.0]) && !ring.holds([2.0, 2.0]) && !ring.holds([5.0, 2.0]));
        assert!(ring.holds([0.0, 2.0]), "its rim belongs to it");
        assert_eq!(ring.bounds(), [[0.0, 4.0]; 2]);
        assert_eq!([[0.5, 2.0], [2.0, 2.0], [7.0, 8.0]].map(|place| ring.depth(place)), [0.5, -1.0, -5.0]);
    }

    #[test]
    fn a_file_without_polygons_is_refused() {
        let error = read(r#"{"type":"FeatureCollection","features":[]}"#).unwrap_err();
        assert!(error.to_string().ends_with("ring.geojson holds no polygon"), "{error}");
    }
}
