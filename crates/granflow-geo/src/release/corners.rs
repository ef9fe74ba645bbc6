//! Whether the corners of a file are what its reader counts on, before the reader sees them.
//!
//! A shapefile says how many corners a record has, and the reader reserves room for as many: what a record cannot hold is
//! refused. GeoJSON may have a corner of one number, which its reader does not expect.

use geo::{CoordsIter, Polygon};
use geojson::{Geometry, GeometryValue, Position};

/// No place on the earth is further from the origin of a coordinate system \[m\].
const FURTHEST: f64 = 1e12;

/// Length of the head of a shapefile, of the head of a record, and of what stands before a polygon's counts.
const HEAD: usize = 100;
const RECORD: usize = 8;
const BOUNDS: usize = 36;

/// Walks over the records of a shapefile (ESRI 1998): counts of parts and corners must fit the bytes that are there.
pub(super) fn of_shapes(bytes: &[u8]) -> Result<(), String> {
    let mut rest = bytes.get(HEAD..).ok_or("it ends within its head; fetch it again")?;
    let mut number = 0;
    while let Some((head, after)) = rest.split_at_checked(RECORD) {
        number += 1;
        let words = i32::from_be_bytes([head[4], head[5], head[6], head[7]]);
        let length = usize::try_from(words).ok().and_then(|words| words.checked_mul(2));
        let Some((record, next)) = length.and_then(|length| after.split_at_checked(length)) else {
            return Err(format!(
                "feature {number} says it has 2 x {words} bytes, {} follow; fetch it again",
                after.len()
            ));
        };
        if !fits(record) {
            return Err(format!(
                "feature {number} has more corners than its {} bytes hold; fetch it again",
                record.len()
            ));
        }
        rest = next;
    }
    Ok(())
}

/// Whether the counts of a record fit its length.
fn fits(record: &[u8]) -> bool {
    let count = |at: usize| {
        let four = record.get(at..at + 4)?.first_chunk().copied()?;
        usize::try_from(i32::from_le_bytes(four)).ok()
    };
    let corners = |start: usize, corners: usize| corners <= record.len().saturating_sub(start) / 16;
    match count(0) {
        Some(0 | 1 | 11 | 21) => true,
        Some(8 | 18 | 28) => count(BOUNDS).is_some_and(|n| corners(BOUNDS + 4, n)),
        Some(kind) => {
            let per_part = if kind == 31 { 8 } else { 4 };
            let (Some(parts), Some(n)) = (count(BOUNDS), count(BOUNDS + 4)) else { return false };
            let start = BOUNDS + 8;
            if parts > record.len() / per_part || !corners(start + per_part * parts, n) {
                return false;
            }
            let begins: Option<Vec<usize>> = (0..parts).map(|part| count(start + 4 * part)).collect();
            begins.is_some_and(|begins| begins.is_sorted() && begins.last().is_none_or(|last| *last <= n))
        }
        None => false,
    }
}

/// Refuses a geometry with a corner of fewer than two numbers.
pub(super) fn of_json(geometry: &Geometry) -> Result<(), String> {
    let all = |line: &[Position]| match line.iter().find(|corner| corner.len() < 2) {
        Some(corner) => Err(format!("a corner is [x, y], found {:?}; correct it", corner.as_slice())),
        None => Ok(()),
    };
    match &geometry.value {
        GeometryValue::Point { coordinates } => all(std::slice::from_ref(coordinates)),
        GeometryValue::MultiPoint { coordinates } | GeometryValue::LineString { coordinates } => {
            all(coordinates)
        }
        GeometryValue::MultiLineString { coordinates } | GeometryValue::Polygon { coordinates } => {
            coordinates.iter().try_for_each(|line| all(line))
        }
        GeometryValue::MultiPolygon { coordinates } => {
            coordinates.iter().flatten().try_for_each(|line| all(line))
        }
        GeometryValue::GeometryCollection { geometries } => geometries.iter().try_for_each(of_json),
    }
}

/// Refuses corners that are no place.
pub(super) fn of_polygons(polygons: &[Polygon]) -> Result<(), String> {
    let corners = || polygons.iter().flat_map(|polygon| polygon.coords_iter());
    let cure = "draw it again, or delete it";
    if corners().any(|corner| !corner.x.is_finite() || !corner.y.is_finite()) {
        return Err(format!("a corner of it is not a number; {cure}"));
    }
    match corners().find(|corner| corner.x.abs() > FURTHEST || corner.y.abs() > FURTHEST) {
        Some(corner) => {
            Err(format!("a corner of it lies at ({}, {}), which is no place; {cure}", corner.x, corner.y))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A shapefile with one record: a triangle that says it has so many parts and corners.
    fn triangle(parts: i32, corners: i32, begin: i32) -> Vec<u8> {
        let mut record = 5i32.to_le_bytes().to_vec();
        record.resize(BOUNDS, 0);
        [parts, corners, begin].iter().for_each(|count| record.extend(count.to_le_bytes()));
        [1.0, 1.0, 2.0, 7.0, 8.0, 1.0, 1.0, 1.0f64].iter().for_each(|v| record.extend(v.to_le_bytes()));
        let head = [1, record.len() as i32 / 2].map(i32::to_be_bytes).concat();
        [vec![0; HEAD], head, record].concat()
    }

    #[test]
    fn counts_that_a_record_cannot_hold_are_refused_before_room_is_made() {
        assert_eq!(of_shapes(&triangle(1, 4, 0)), Ok(()));
        for (parts, corners, begin) in
            [(1, 5, 0), (1, i32::MAX, 0), (1, -1, 0), (i32::MAX, 4, 0), (-1, 4, 0), (1, 4, 5), (1, 4, -1)]
        {
            let error = of_shapes(&triangle(parts, corners, begin)).unwrap_err();
            assert!(error.contains("feature 1 has more corners than"), "{error}");
        }
        let whole = triangle(1, 4, 0);
        assert!(of_shapes(&whole[..whole.len() - 1]).unwrap_err().contains("follow; fetch it again"));
        assert!(of_shapes(&whole[..50]).unwrap_err().contains("within its head"));
        let mut long = whole;
        long[104..108].copy_from_slice(&i32::MIN.to_be_bytes());
        assert!(of_shapes(&long).is_err());
    }
}
