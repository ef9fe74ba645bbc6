//! Polygons with attributes from shapefiles and GeoJSON.

use super::table::{Row, rows};
use super::{ReleaseError, boxes, corners};
use crate::raster::{Crs, beside};
use geo::{Area, Contains, Geometry, InteriorPoint, LineString, Polygon};
use geojson::GeoJson;
use shapefile::{Shape, ShapeReader};
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// The polygons of one file, with their attributes.
#[derive(Debug, Clone)]
pub struct Layer {
    /// The file, for messages.
    pub(super) name: PathBuf,
    pub(super) features: Vec<Feature>,
    pub(super) crs: Option<Crs>,
    /// Features of the file that have no shape or are marked deleted.
    pub(super) left_out: usize,
}

/// One feature: its polygons and its attributes as name and text, the text empty where there is no value.
#[derive(Debug, Clone, Default)]
pub(super) struct Feature {
    /// Its place in the file, from 1.
    pub number: usize,
    pub polygons: Vec<Polygon>,
    pub attributes: Vec<(String, String)>,
}

impl Feature {
    /// The value of an attribute; empty where there is none.
    pub fn value(&self, name: &str) -> &str {
        self.attributes.iter().find(|(own, _)| own == name).map_or("", |(_, value)| value)
    }
}

impl Layer {
    /// Reads a shapefile (`.shp`; the attributes from `.dbf`, the CRS from `.prj`) or else GeoJSON.
    ///
    /// # Errors
    /// [`ReleaseError::Io`], [`ReleaseError::Format`], [`ReleaseError::Unreadable`], and [`ReleaseError::Shape`] for other
    /// shapes than polygons.
    pub fn read(path: &Path) -> Result<Layer, ReleaseError> {
        let bytes = std::fs::read(path).map_err(|source| ReleaseError::Io { path: path.into(), source })?;
        if !is_shapefile(&bytes) {
            return geojson(path, &bytes);
        }
        let optional = |file: &Path| match std::fs::read(file) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(source) => Err(ReleaseError::Io { path: file.into(), source }),
        };
        let (table, prj) = (beside(path, "dbf"), beside(path, "prj"));
        let crs = match optional(&prj)?.map(|bytes| String::from_utf8_lossy(&bytes).trim().to_string()) {
            Some(text) if !text.is_empty() => Some(Crs::parse(&text).map_err(|error| {
                unreadable(
                    &prj,
                    format!(
                        "{error}; write its definition into it with\n  gdalsrsinfo -o wkt1_esri \"{}\" > {}",
                        text.replace(['"', '\n', '\r'], " "),
                        prj.display()
                    ),
                )
            })?),
            _ => None,
        };
        let records = optional(&table)?;
        shapefile(path, &bytes, (&table, records.as_deref()), crs)
    }

    /// As [`Layer::read`], from the bytes of a file that is called `name` in messages.
    ///
    /// What stands beside a shapefile is passed too: the bytes of the `.dbf` as `table`, the content of the `.prj` as
    /// `crs`. GeoJSON needs neither; its own CRS comes first.
    ///
    /// # Errors
    /// As [`Layer::read`].
    pub fn from_bytes(
        name: &Path,
        bytes: &[u8],
        table: Option<&[u8]>,
        crs: Option<Crs>,
    ) -> Result<Layer, ReleaseError> {
        if !is_shapefile(bytes) {
            let layer = geojson(name, bytes)?;
            return Ok(Layer { crs: layer.crs.or(crs), ..layer });
        }
        shapefile(name, bytes, (&name.with_extension("dbf"), table), crs)
    }
}

fn is_shapefile(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0, 0, 0x27, 0x0a])
}

fn unreadable(path: &Path, problem: impl std::fmt::Display) -> ReleaseError {
    ReleaseError::Unreadable { path: path.into(), problem: problem.to_string() }
}

fn no_polygon(path: &Path, feature: usize, found: &str) -> ReleaseError {
    let problem = format!("it is a {found}, a release is a polygon or multipolygon");
    ReleaseError::Shape { path: path.into(), feature, problem }
}

/// The layer of the shapes of a file and the table beside it.
fn shapefile(
    path: &Path,
    shapes: &[u8],
    (table, bytes): (&Path, Option<&[u8]>),
    crs: Option<Crs>,
) -> Result<Layer, ReleaseError> {
    corners::of_shapes(shapes).map_err(|problem| unreadable(path, problem))?;
    let shapes = ShapeReader::new(Cursor::new(shapes)).and_then(ShapeReader::read);
    let shapes = shapes.map_err(|e| unreadable(path, e))?;
    let records: Vec<Row> = match bytes {
        Some(bytes) => rows(bytes).map_err(|e| unreadable(table, e))?,
        None => vec![Some(Vec::new()); shapes.len()],
    };
    if records.len() != shapes.len() {
        return Err(unreadable(table, format!("{} records for {} shapes", records.len(), shapes.len())));
    }
    let all = shapes.len();
    let mut features = Vec::with_capacity(all);
    for ((shape, attributes), number) in shapes.into_iter().zip(records).zip(1..) {
        let Some(attributes) = attributes else { continue };
        let kind = shape.shapetype().to_string();
        let rings: Vec<LineString> = match shape {
            Shape::Polygon(polygon) => {
                polygon.rings().iter().map(|ring| line(ring.points(), |p| (p.x, p.y))).collect()
            }
            Shape::PolygonM(polygon) => {
                polygon.rings().iter().map(|ring| line(ring.points(), |p| (p.x, p.y))).collect()
            }
            Shape::PolygonZ(polygon) => {
                polygon.rings().iter().map(|ring| line(ring.points(), |p| (p.x, p.y))).collect()
            }
            Shape::NullShape => continue,
            _ => return Err(no_polygon(path, number, &kind)),
        };
        let discs: Vec<Polygon> = rings.into_iter().map(|ring| Polygon::new(ring, Vec::new())).collect();
        placed(path, number, &discs)?;
        features.push(Feature { number, polygons: nested(discs), attributes });
    }
    let left_out = all - features.len();
    Ok(Layer { name: path.into(), features, crs, left_out })
}

/// Refuses polygons with a corner that is no place.
fn placed(path: &Path, feature: usize, polygons: &[Polygon]) -> Result<(), ReleaseError> {
    let wrong = |problem| ReleaseError::Shape { path: path.into(), feature, problem };
    corners::of_polygons(polygons).map_err(wrong)
}

fn line<P>(points: &[P], place: impl Fn(&P) -> (f64, f64)) -> LineString {
    points.iter().map(place).collect::<Vec<_>>().into()
}

/// Polygons with holes from loose rings by how deep they lie in one another, whatever their order and direction.
fn nested(mut discs: Vec<Polygon>) -> Vec<Polygon> {
    // A ring without area may be one that crosses itself: that is for the caller to refuse.
    discs.retain(|disc| !disc.exterior().0.is_empty());
    discs.sort_by(|a, b| b.unsigned_area().total_cmp(&a.unsigned_area()));
    let mut polygons: Vec<Polygon> = Vec::new();
    let mut depths = Vec::new();
    let mut owners: Vec<usize> = Vec::new();
    let boxes = boxes(&discs);
    for (k, disc) in discs.iter().enumerate() {
        let around: Vec<usize> = match disc.interior_point() {
            Some(point) => boxes
                .locate_all_at_point(&[point.x(), point.y()])
                .map(|found| found.data)
                .filter(|&j| j < k && discs[j].contains(&point))
                .collect(),
            None => Vec::new(),
        };
        depths.push(around.len());
        let parent = around.into_iter().max_by_key(|&j| depths[j]);
        match parent.filter(|_| depths[k] % 2 == 1) {
            Some(parent) => {
                polygons[owners[parent]].interiors_push(disc.exterior().clone());
                owners.push(owners[parent]);
            }
            None => {
                owners.push(polygons.len());
                polygons.push(disc.clone());
            }
        }
    }
    polygons
}

fn geojson(path: &Path, bytes: &[u8]) -> Result<Layer, ReleaseError> {
    let text = String::from_utf8_lossy(bytes);
    if !text.trim_start_matches('\u{feff}').trim_start().starts_with('{') {
        let found = text.chars().take(20).collect::<String>().escape_debug().to_string();
        return Err(ReleaseError::Format { path: path.into(), found });
    }
    let json: GeoJson = text.trim_start_matches('\u{feff}').parse().map_err(|e| unreadable(path, e))?;
    let (features, members) = match json {
        GeoJson::Geometry(geometry) => {
            (vec![geojson::Feature { geometry: Some(geometry), ..Default::default() }], None)
        }
        GeoJson::Feature(feature) => (vec![feature.clone()], feature.foreign_members),
        GeoJson::FeatureCollection(collection) => (collection.features, collection.foreign_members),
    };
    let all = features.len();
    let shaped = features.into_iter().zip(1..).filter_map(|(mut feature, number)| {
        let geometry = feature.geometry.take()?;
        Some((feature, geometry, number))
    });
    let features = shaped.map(|(feature, geometry, number)| {
        let mut polygons = Vec::new();
        let wrong = |problem| ReleaseError::Shape { path: path.into(), feature: number, problem };
        corners::of_json(&geometry).map_err(wrong)?;
        let geometry = Geometry::<f64>::try_from(geometry).map_err(|e| unreadable(path, e))?;
        collect(geometry, &mut polygons).map_err(|kind| no_polygon(path, number, kind))?;
        placed(path, number, &polygons)?;
        let text = |value: geojson::JsonValue| match value {
            geojson::JsonValue::String(text) => text,
            geojson::JsonValue::Null => String::new(),
            other => other.to_string(),
        };
        let properties = feature.properties.unwrap_or_default();
        let attributes = properties.into_iter().map(|(name, value)| (name, text(value))).collect();
        Ok(Feature { number, polygons, attributes })
    });
    let features = features.collect::<Result<Vec<_>, ReleaseError>>()?;
    let crs = match members.as_ref().and_then(|members| members.get("crs")).filter(|crs| !crs.is_null()) {
        Some(crs) => Some(named(crs).ok_or_else(|| {
            let cure = format!("ogr2ogr -a_srs EPSG:xxxx named.geojson {}", path.display());
            unreadable(path, format!("its `crs` {crs} is not understood; name it with\n  {cure}"))
        })?),
        None => None,
    };
    let left_out = all - features.len();
    Ok(Layer { name: path.into(), features, crs, left_out })
}

/// The system that the member `crs` names (GeoJSON of 2008; RFC 7946 dropped it, GDAL and QGIS still write it).
pub(crate) fn named(crs: &geojson::JsonValue) -> Option<Crs> {
    let properties = crs.get("properties")?;
    if let Some(code) = properties.get("code") {
        return Crs::parse(&format!("EPSG:{code}")).ok();
    }
    let name = properties.get("name")?.as_str()?;
    let name = if name.ends_with("CRS84") { "EPSG:4326" } else { name };
    Crs::parse(name).ok()
}

fn collect(geometry: Geometry, polygons: &mut Vec<Polygon>) -> Result<(), &'static str> {
    match geometry {
        Geometry::Polygon(polygon) => polygons.push(polygon),
        Geometry::MultiPolygon(parts) => polygons.extend(parts),
        Geometry::GeometryCollection(parts) => {
            parts.into_iter().try_for_each(|part| collect(part, polygons))?
        }
        Geometry::Point(_) | Geometry::MultiPoint(_) => return Err("point"),
        _ => return Err("line"),
    }
    Ok(())
}
