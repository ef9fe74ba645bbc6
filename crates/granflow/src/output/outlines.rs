//! Outlines: where a map exceeds a threshold, as polygons, and `outlines.geojson` for QGIS.

use super::{Error, whole_file};
use crate::raster::Raster;
use geo::{Area, BoundingRect, Contains, Coord, LineString, MultiPolygon, Polygon};
use geojson::{Feature, FeatureCollection, Geometry, GeometryValue};
use serde_json::json;
use std::collections::HashMap;
use std::io;
use std::path::Path;

/// Where the values of a map lie: row-major, `columns` values a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lattice {
    /// Values in a row.
    pub columns: usize,
    /// x of the first column's centres.
    pub x: f64,
    /// y of the first row's centres.
    pub y: f64,
    /// Distance of the columns, positive.
    pub dx: f64,
    /// Distance of the rows, negative where the first row is the northernmost.
    pub dy: f64,
}

/// The centres of a raster's cells.
impl From<&Raster> for Lattice {
    fn from(raster: &Raster) -> Lattice {
        Lattice { columns: raster.columns, x: raster.x(0), y: raster.y(0), dx: raster.cell, dy: raster.cell }
    }
}

/// The area where a quantity reaches a threshold.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// What it outlines, such as `deposit` or `peak_thickness`.
    pub name: String,
    /// The threshold.
    pub threshold: f64,
    /// Unit of the threshold.
    pub unit: String,
    /// The area; outer rings counterclockwise, holes clockwise, as RFC 7946 wants.
    pub area: MultiPolygon<f64>,
}

/// The area where `map` >= `threshold`, by marching squares on the centres with linear interpolation.
///
/// NaN counts as below, and so does everything beyond the map's edge; towards both the outline runs along the
/// cells' faces. At a saddle the mean of the four corners decides. Every vertex keeps a thousandth of the distance
/// from a centre, so that no two rings touch. A trailing incomplete row is not looked at.
#[must_use]
pub fn contour(map: &[f64], lattice: Lattice, threshold: f64) -> MultiPolygon<f64> {
    if lattice.columns == 0 {
        return MultiPolygon::new(Vec::new());
    }
    let squares = Squares {
        map,
        columns: lattice.columns as isize,
        rows: (map.len() / lattice.columns) as isize,
        threshold,
    };
    let place = |(column, row): (f64, f64)| Coord {
        x: lattice.x + column * lattice.dx,
        y: lattice.y + row * lattice.dy,
    };
    let mut rings = squares.rings();
    let mirrored = lattice.dx * lattice.dy < 0.0;
    let (mut outer, mut holes) = (Vec::new(), Vec::new());
    for ring in &mut rings {
        if mirrored {
            ring.reverse();
        }
        let polygon = Polygon::new(LineString(ring.iter().copied().map(place).collect()), Vec::new());
        if polygon.signed_area() > 0.0 { outer.push(polygon) } else { holes.push(polygon.into_inner().0) }
    }
    // The smallest outer ring around a hole is its own: look at them by rising area.
    outer.sort_by(|a, b| a.unsigned_area().total_cmp(&b.unsigned_area()));
    let bounds: Vec<_> = outer.iter().map(BoundingRect::bounding_rect).collect();
    let bare = outer.clone();
    for hole in holes {
        let inside = |&at: &usize| {
            bounds[at].is_some_and(|bound| bound.contains(&hole.0[0])) && bare[at].contains(&hole.0[0])
        };
        if let Some(own) = (0..bare.len()).find(inside) {
            outer[own].interiors_push(hole);
        }
    }
    outer.reverse();
    MultiPolygon::new(outer)
}

/// The outer rings that enclose more than `least` square units of the map.
#[must_use]
pub fn rings(area: &MultiPolygon<f64>, least: f64) -> Vec<Vec<[f64; 2]>> {
    let large = area.iter().filter(|polygon| polygon.unsigned_area() > least);
    large.map(|polygon| polygon.exterior().coords().map(|c| [c.x, c.y]).collect()).collect()
}

/// The edges between neighbouring centres, by their lower centre and whether they run along a row.
type Edge = (isize, isize, bool);

struct Squares<'a> {
    map: &'a [f64],
    columns: isize,
    rows: isize,
    threshold: f64,
}

impl Squares<'_> {
    /// The value at a centre; nothing beyond the edge and where it is NaN.
    fn value(&self, column: isize, row: isize) -> Option<f64> {
        let within = (0..self.columns).contains(&column) && (0..self.rows).contains(&row);
        within.then(|| self.map[(row * self.columns + column) as usize]).filter(|value| !value.is_nan())
    }

    fn inside(&self, column: isize, row: isize) -> bool {
        self.value(column, row).is_some_and(|value| value >= self.threshold)
    }

    /// All closed rings in units of columns and rows, with the inside on their left where rows count upwards.
    fn rings(&self) -> Vec<Vec<(f64, f64)>> {
        let (mut next, mut starts) = (HashMap::new(), Vec::new());
        for row in -1..self.rows {
            for column in -1..self.columns {
                for (from, to) in self.segments(column, row) {
                    next.insert(from, to);
                    starts.push(from);
                }
            }
        }
        let mut rings = Vec::new();
        for start in starts {
            let mut ring = Vec::new();
            let mut at = start;
            while let Some(to) = next.remove(&at) {
                ring.push(self.crossing(at));
                at = to;
            }
            if let Some(&first) = ring.first() {
                ring.push(first);
                rings.push(ring);
            }
        }
        rings
    }

    /// The pieces of outline in the square whose lower left centre is given, each from edge to edge, inside on the
    /// left.
    fn segments(&self, column: isize, row: isize) -> impl Iterator<Item = (Edge, Edge)> {
        let corners = [(column, row), (column + 1, row), (column + 1, row + 1), (column, row + 1)];
        let inside = corners.map(|(column, row)| self.inside(column, row));
        // Edge number n runs from corner n to corner n + 1, counterclockwise. The outline comes in where the walk
        // around the square goes from inside to outside, and leaves where it goes from outside to inside.
        let edges: [Edge; 4] =
            [(column, row, true), (column + 1, row, false), (column, row + 1, true), (column, row, false)];
        let enters = |edge: &usize| inside[*edge] && !inside[(*edge + 1) % 4];
        let saddle = inside[0] == inside[2] && inside[1] == inside[3] && inside[0] != inside[1];
        // At a saddle the insides are joined if the middle is inside: the outline then turns to the leaving edge
        // ahead.
        let joined = saddle && {
            let values = corners.map(|(column, row)| self.value(column, row));
            values.into_iter().sum::<Option<f64>>().is_some_and(|sum| sum / 4.0 >= self.threshold)
        };
        let pieces: Vec<_> = (0..4)
            .filter(enters)
            .map(|from| {
                let leaves = |edge: &usize| !inside[*edge] && inside[(*edge + 1) % 4];
                let around = (1..4).map(|step| (from + step) % 4);
                let to = if joined { around.clone().find(leaves) } else { around.rev().find(leaves) };
                (edges[from], edges[to.unwrap_or(from)])
            })
            .collect();
        pieces.into_iter()
    }

    /// Where the outline crosses an edge.
    fn crossing(&self, (column, row, along): Edge) -> (f64, f64) {
        let (right, up) = if along { (column + 1, row) } else { (column, row + 1) };
        let share = match (self.value(column, row), self.value(right, up)) {
            (Some(a), Some(b)) => ((self.threshold - a) / (b - a)).clamp(1e-3, 1.0 - 1e-3),
            _ => 0.5,
        };
        let share = if share.is_nan() { 0.5 } else { share };
        let (column, row) = (column as f64, row as f64);
        if along { (column + share, row) } else { (column, row + share) }
    }
}

/// Writes the outlines as GeoJSON, one feature each with name, threshold, unit and area in square units of the
/// map.
///
/// RFC 7946 knows degrees only; the older member `crs`, which QGIS and GDAL read, names the map's system instead.
///
/// # Errors
/// [`Error::Io`] if the file cannot be written.
pub fn write(path: &Path, outlines: &[Outline], epsg: Option<u32>) -> Result<(), Error> {
    let feature = |outline: &Outline| {
        let properties = json!({
            "name": outline.name,
            "threshold": outline.threshold,
            "unit": outline.unit,
            "area": outline.area.unsigned_area(),
        });
        Feature {
            bbox: None,
            geometry: Some(Geometry::new(GeometryValue::from(&outline.area))),
            id: None,
            properties: properties.as_object().cloned(),
            foreign_members: None,
        }
    };
    let crs = epsg.map(|code| {
        let name = format!("urn:ogc:def:crs:EPSG::{code}");
        json!({"crs": {"type": "name", "properties": {"name": name}}})
    });
    let collection = FeatureCollection {
        bbox: None,
        features: outlines.iter().map(feature).collect(),
        foreign_members: crs.and_then(|crs| crs.as_object().cloned()),
    };
    whole_file(path, |out| serde_json::to_writer(out, &collection).map_err(io::Error::from))
}

#[cfg(test)]
mod tests {
    use super::*;
    use geo::Winding;
    use std::f64::consts::PI;

    const UNIT: Lattice = Lattice { columns: 100, x: 0.5, y: 0.5, dx: 1.0, dy: 1.0 };

    fn map(lattice: Lattice, rows: usize, value: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let place = |i: usize| {
            (
                lattice.x + (i % lattice.columns) as f64 * lattice.dx,
                lattice.y + (i / lattice.columns) as f64 * lattice.dy,
            )
        };
        (0..rows * lattice.columns)
            .map(|i| {
                let (x, y) = place(i);
                value(x, y)
            })
            .collect()
    }

    fn assert_rings_sound(area: &MultiPolygon<f64>) {
        for polygon in area {
            assert!(polygon.exterior().is_closed() && polygon.exterior().is_ccw());
            assert!(polygon.interiors().iter().all(|hole| hole.is_closed() && hole.is_cw()));
        }
    }

    #[test]
    fn a_disc_has_its_area_whichever_way_the_rows_run() {
        for dy in [1.0, -1.0] {
            let lattice = Lattice { y: 50.0 - 49.5 * dy, dy, ..UNIT };
            let disc = map(lattice, 100, |x, y| if (x - 47.3).hypot(y - 51.1) <= 30.0 { 2.0 } else { 0.0 });
            let cone = map(lattice, 100, |x, y| 31.0 - (x - 47.3).hypot(y - 51.1));
            for (area, accuracy) in
                [(contour(&disc, lattice, 1.0), 1e-2), (contour(&cone, lattice, 1.0), 1e-3)]
            {
                assert_eq!(area.0.len(), 1);
                assert_rings_sound(&area);
                assert!(
                    (area.unsigned_area() / (PI * 900.0) - 1.0).abs() < accuracy,
                    "{}",
                    area.unsigned_area()
                );
                assert!(
                    area.contains(&Coord { x: 47.3, y: 80.0 }) && !area.contains(&Coord { x: 47.3, y: 82.0 })
                );
            }
        }
    }

    #[test]
    fn holes_and_islands_find_their_places() {
        for dy in [1.0, -1.0] {
            let lattice = Lattice { y: 50.0 - 49.5 * dy, dy, ..UNIT };
            let rings = map(lattice, 100, |x, y| {
                let r = (x - 50.0).hypot(y - 50.0);
                if r < 10.0 || (20.0..40.0).contains(&r) || x.hypot(y) < 8.0 { 1.0 } else { f64::NAN }
            });
            let area = contour(&rings, lattice, 0.5);
            assert_rings_sound(&area);
            let holes: Vec<_> = area.iter().map(|polygon| polygon.interiors().len()).collect();
            assert_eq!(holes, [1, 0, 0], "largest first");
            assert!((area.unsigned_area() / (PI * (1600.0 - 400.0 + 100.0 + 16.0)) - 1.0).abs() < 1e-2);
        }
    }

    #[test]
    fn the_edge_of_the_map_and_single_cells_run_along_faces() {
        let lattice = Lattice { columns: 3, x: 10.0, y: 20.0, dx: 2.0, dy: -2.0 };
        let full = contour(&[1.0; 9], lattice, 1.0);
        // Half a cell beyond the outer centres, the four corners cut.
        assert_eq!(full.unsigned_area(), 36.0 - 4.0 * 0.5);
        assert_rings_sound(&full);
        let mut one = [f64::NAN; 9];
        one[4] = 1.0;
        assert_eq!(contour(&one, lattice, 1.0).unsigned_area(), 2.0);
        assert!(contour(&[f64::NAN; 9], lattice, 1.0).0.is_empty());
        assert!(contour(&[], lattice, 1.0).0.is_empty());
    }

    #[test]
    fn a_saddle_is_joined_by_its_mean_and_parted_without_one() {
        let lattice = Lattice { columns: 2, ..UNIT };
        assert_eq!(contour(&[3.0, 0.0, 0.0, 3.0], lattice, 1.0).0.len(), 1);
        assert_eq!(contour(&[3.0, 0.0, 0.0, 3.0], lattice, 2.0).0.len(), 2);
        assert_eq!(contour(&[3.0, f64::NAN, 0.0, 3.0], lattice, 1.0).0.len(), 2);
    }

    #[test]
    fn on_a_rough_map_every_centre_is_on_its_side_and_no_vertex_is_used_twice() {
        // Rounded values: many lie exactly on the threshold.
        let rough = map(UNIT, 40, |x, y| ((x * 12.9898 + y * 78.233).sin() * 3.0).round());
        let area = contour(&rough, UNIT, 1.0);
        assert_rings_sound(&area);
        let wrong = (0..rough.len()).filter(|&i| {
            let centre = Coord { x: 0.5 + (i % 100) as f64, y: 0.5 + (i / 100) as f64 };
            area.contains(&centre) != (rough[i] >= 1.0)
        });
        assert_eq!(wrong.count(), 0);
        let rings = area.iter().flat_map(|polygon| polygon.interiors().iter().chain([polygon.exterior()]));
        let mut vertices: Vec<_> =
            rings.flat_map(|ring| &ring.0[1..]).map(|at| (at.x.to_bits(), at.y.to_bits())).collect();
        let all = vertices.len();
        vertices.sort_unstable();
        vertices.dedup();
        assert_eq!(vertices.len(), all);
    }

    #[test]
    fn the_file_names_crs_and_area() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("outlines.geojson");
        let disc = map(UNIT, 100, |x, y| 31.0 - (x - 50.0).hypot(y - 50.0));
        let outline = Outline {
            name: "deposit".into(),
            threshold: 1.0,
            unit: "m".into(),
            area: contour(&disc, UNIT, 1.0),
        };
        write(&path, &[outline], Some(31287)).unwrap();
        let read: serde_json::Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        assert_eq!(read["crs"]["properties"]["name"], "urn:ogc:def:crs:EPSG::31287");
        assert_eq!(
            (&read["type"], &read["features"][0]["geometry"]["type"]),
            (&json!("FeatureCollection"), &json!("MultiPolygon"))
        );
        let properties = &read["features"][0]["properties"];
        assert_eq!((&properties["name"], &properties["unit"]), (&json!("deposit"), &json!("m")));
        assert!((properties["area"].as_f64().unwrap() / (PI * 900.0) - 1.0).abs() < 1e-3);
    }
}
