//! A line from a GeoJSON file.

use crate::Remark;
use crate::raster::{Comparison, Crs, Raster, uncertain};
use crate::release::{ReleaseError, named_system};
use geojson::{GeoJson, GeometryValue};
use std::path::Path;

/// The points of the only line of a GeoJSON file, in the system of `terrain` where that is given.
///
/// # Errors
/// [`ReleaseError`] for a file that cannot be read, another shape, more than one line, and another system than that of
/// `terrain`.
pub fn line(path: &Path, terrain: Option<&Raster>) -> Result<(Vec<[f64; 2]>, Vec<Remark>), ReleaseError> {
    let bytes = std::fs::read(path).map_err(|source| ReleaseError::Io { path: path.into(), source })?;
    line_from(path, &bytes, terrain)
}

/// The same of a file with this content; messages name `path`.
///
/// # Errors
/// As [`line()`].
pub fn line_from(
    path: &Path,
    bytes: &[u8],
    terrain: Option<&Raster>,
) -> Result<(Vec<[f64; 2]>, Vec<Remark>), ReleaseError> {
    let unreadable = |problem: String| ReleaseError::Unreadable { path: path.into(), problem };
    let text = String::from_utf8_lossy(bytes);
    let text = text.trim_start_matches('\u{feff}');
    if !text.trim_start().starts_with('{') {
        let cure = format!("it is no GeoJSON; convert it with\n  ogr2ogr line.geojson {}", path.display());
        return Err(unreadable(cure));
    }
    let json: GeoJson = text.parse().map_err(|error: geojson::Error| unreadable(error.to_string()))?;
    let (geometries, members) = match json {
        GeoJson::Geometry(geometry) => (vec![geometry], None),
        GeoJson::Feature(feature) => (feature.geometry.into_iter().collect(), feature.foreign_members),
        GeoJson::FeatureCollection(all) => {
            (all.features.into_iter().filter_map(|feature| feature.geometry).collect(), all.foreign_members)
        }
    };
    let places = match geometries.as_slice() {
        [geometry] => match &geometry.value {
            GeometryValue::LineString { coordinates } => coordinates,
            _ => return Err(unreadable("its shape is no LineString, which a section is".to_owned())),
        },
        several => {
            let message = format!("it holds {} shapes; a section is one LineString", several.len());
            return Err(unreadable(message));
        }
    };
    let point = |place: &geojson::Position| match place.as_slice() {
        [x, y, ..] if x.is_finite() && y.is_finite() => Ok([*x, *y]),
        _ => Err(unreadable(format!("{:?} is no place: a point has two finite numbers", place.as_slice()))),
    };
    let points = places.iter().map(point).collect::<Result<Vec<_>, _>>()?;
    if points.len() < 2 {
        return Err(unreadable("its line has fewer than two points".to_owned()));
    }
    let crs = match members.as_ref().and_then(|members| members.get("crs")).filter(|crs| !crs.is_null()) {
        Some(crs) => named_system(crs),
        None => None,
    };
    let notes = same_system(path, crs.as_ref(), terrain.and_then(|terrain| terrain.crs.as_ref()))?;
    Ok((points, notes))
}

/// Refuses a line in another system than the terrain; notes what cannot be known.
fn same_system(path: &Path, own: Option<&Crs>, terrain: Option<&Crs>) -> Result<Vec<Remark>, ReleaseError> {
    let (Some(own), Some(terrain)) = (own, terrain) else { return Ok(Vec::new()) };
    match own.compare(terrain) {
        Comparison::Same => Ok(Vec::new()),
        Comparison::Unknown(what) => Ok(vec![uncertain(path, own, terrain, &what)]),
        Comparison::Different(proof) => Err(ReleaseError::system(path, own, terrain, proof)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<[f64; 2]>, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bridge.geojson");
        std::fs::write(&path, text).unwrap();
        line(&path, None).map(|(points, _)| points).map_err(|error| error.to_string())
    }

    #[test]
    fn a_line_is_read_whatever_holds_it() {
        let bare = r#"{"type":"LineString","coordinates":[[0,1],[2.5,3],[4,5,99]]}"#;
        let feature = format!(r#"{{"type":"Feature","properties":null,"geometry":{bare}}}"#);
        let all = format!(r#"{{"type":"FeatureCollection","features":[{feature}]}}"#);
        for text in [bare, &feature, &all] {
            assert_eq!(read(text).unwrap(), [[0.0, 1.0], [2.5, 3.0], [4.0, 5.0]]);
        }
    }

    #[test]
    fn what_is_no_line_is_refused_by_name() {
        for (text, part) in [
            ("SHAPE", "no GeoJSON"),
            (r#"{"type":"Point","coordinates":[0,1]}"#, "no LineString"),
            (r#"{"type":"FeatureCollection","features":[]}"#, "holds 0 shapes"),
            (r#"{"type":"LineString","coordinates":[[0,1]]}"#, "two"),
        ] {
            let message = read(text).unwrap_err();
            assert!(message.contains(part) && message.contains("bridge.geojson"), "{message}");
        }
    }

    #[test]
    fn another_system_than_the_terrains_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bridge.geojson");
        let text = r#"{"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::32632"}},
            "features":[{"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":[[0,0],[1,1]]}}]}"#;
        std::fs::write(&path, text).unwrap();
        let terrain = |code| Raster {
            crs: Some(Crs { epsg: Some(code), wkt: None }),
            ..crate::raster::tests::sampled(2, 2, |_, _| 0.0)
        };
        assert!(line(&path, Some(&terrain(32632))).is_ok());
        let message = line(&path, Some(&terrain(31287))).unwrap_err().to_string();
        assert!(message.contains("EPSG:32632") && message.contains("ogr2ogr -t_srs EPSG:31287"), "{message}");
    }
}
