//! Polygons with attributes from shapefiles and GeoJSON.

use super::ReleaseError;
use crate::raster::{Crs, beside};
use geo::{Area, Contains, Geometry, InteriorPoint, LineString, Polygon};
use geojson::{GeoJson, JsonObject};
use shapefile::dbase::{self, FieldValue};
use shapefile::{Shape, ShapeReader};
use std::io::{Cursor, Read, Seek};
use std::path::{Path, PathBuf};

/// The polygons of one file, with their attributes.
#[derive(Debug, Clone)]
pub struct Layer {
    /// The file, for messages.
    pub(super) name: PathBuf,
    pub(super) features: Vec<Feature>,
    pub(super) crs: Option<Crs>,
}

/// One feature: its polygons and its attributes as name and text, the text empty where there is no value.
#[derive(Debug, Clone, Default)]
pub(super) struct Feature {
    pub polygons: Vec<Polygon>,
    pub attributes: Vec<(String, String)>,
}

/// The attributes of one shape: name and text.
type Attributes = Vec<(String, String)>;

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
        let shapes = ShapeReader::from_path(path).and_then(ShapeReader::read);
        let table = beside(path, "dbf");
        let records = table.exists().then(|| tables().open(&table).and_then(attributes));
        let crs = std::fs::read(beside(path, "prj")).ok();
        let crs = crs.and_then(|bytes| Crs::parse(&String::from_utf8_lossy(&bytes)).ok());
        shapefile(path, shapes, &table, records, crs)
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
        let shapes = ShapeReader::new(Cursor::new(bytes)).and_then(ShapeReader::read);
        let records = table.map(|table| tables().build(Cursor::new(table)).and_then(attributes));
        shapefile(name, shapes, &name.with_extension("dbf"), records, crs)
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

/// The layer of the shapes of a file and the records of the table beside it.
fn shapefile(
    path: &Path,
    shapes: Result<Vec<Shape>, shapefile::Error>,
    table: &Path,
    records: Option<Result<Vec<Attributes>, dbase::Error>>,
    crs: Option<Crs>,
) -> Result<Layer, ReleaseError> {
    let shapes = shapes.map_err(|e| unreadable(path, e))?;
    let records = match records {
        Some(records) => records.map_err(|e| unreadable(table, e))?,
        None => vec![Vec::new(); shapes.len()],
    };
    if records.len() != shapes.len() {
        return Err(unreadable(table, format!("{} records for {} shapes", records.len(), shapes.len())));
    }
    let mut features = Vec::with_capacity(shapes.len());
    for ((shape, attributes), number) in shapes.into_iter().zip(records).zip(1..) {
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
            Shape::NullShape => Vec::new(),
            _ => return Err(no_polygon(path, number, &kind)),
        };
        features.push(Feature { polygons: nested(rings), attributes });
    }
    Ok(Layer { name: path.into(), features, crs })
}

fn line<P>(points: &[P], place: impl Fn(&P) -> (f64, f64)) -> LineString {
    points.iter().map(place).collect::<Vec<_>>().into()
}

/// Letters outside ASCII in an old code page do not matter to numbers.
fn tables() -> dbase::ReaderBuilder {
    dbase::ReaderBuilder::new().with_encoding(dbase::UnicodeLossy)
}

/// Records in the order of the file.
fn attributes(mut reader: dbase::Reader<impl Read + Seek>) -> Result<Vec<Attributes>, dbase::Error> {
    let names: Vec<String> = reader.fields().iter().map(|field| field.name().to_string()).collect();
    let texts = |record: dbase::Record| {
        let text = |name: &String| (name.clone(), record.get(name).map(text).unwrap_or_default());
        names.iter().map(text).collect()
    };
    Ok(reader.read()?.into_iter().map(texts).collect())
}

fn text(value: &FieldValue) -> String {
    let text = match value {
        FieldValue::Numeric(value) => value.map(|v| v.to_string()),
        FieldValue::Float(value) => value.map(|v| v.to_string()),
        FieldValue::Double(value) | FieldValue::Currency(value) => Some(value.to_string()),
        FieldValue::Integer(value) => Some(value.to_string()),
        FieldValue::Character(text) => text.clone(),
        FieldValue::Memo(text) => Some(text.clone()),
        other => Some(format!("{other:?}")),
    };
    text.unwrap_or_default()
}

/// Polygons with holes from loose rings by how deep they lie in one another, whatever their order and direction.
fn nested(rings: Vec<LineString>) -> Vec<Polygon> {
    let mut discs: Vec<Polygon> = rings.into_iter().map(|ring| Polygon::new(ring, Vec::new())).collect();
    discs.retain(|disc| disc.unsigned_area() > 0.0);
    discs.sort_by(|a, b| b.unsigned_area().total_cmp(&a.unsigned_area()));
    let mut polygons: Vec<Polygon> = Vec::new();
    let mut depths = Vec::new();
    let mut owners: Vec<usize> = Vec::new();
    for (k, disc) in discs.iter().enumerate() {
        let point = disc.interior_point();
        let around: Vec<usize> =
            (0..k).filter(|&j| point.is_some_and(|point| discs[j].contains(&point))).collect();
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
    let features = features.into_iter().zip(1..).map(|(feature, number)| {
        let mut polygons = Vec::new();
        if let Some(geometry) = feature.geometry {
            let geometry = Geometry::<f64>::try_from(geometry).map_err(|e| unreadable(path, e))?;
            collect(geometry, &mut polygons).map_err(|kind| no_polygon(path, number, kind))?;
        }
        let text = |value: geojson::JsonValue| match value {
            geojson::JsonValue::String(text) => text,
            geojson::JsonValue::Null => String::new(),
            other => other.to_string(),
        };
        let properties = feature.properties.unwrap_or_default();
        let attributes = properties.into_iter().map(|(name, value)| (name, text(value))).collect();
        Ok(Feature { polygons, attributes })
    });
    Ok(Layer {
        name: path.into(),
        features: features.collect::<Result<_, ReleaseError>>()?,
        crs: members.as_ref().and_then(named),
    })
}

/// The system that the member `crs` names (GeoJSON of 2008; RFC 7946 dropped it, GDAL and QGIS still write it).
fn named(members: &JsonObject) -> Option<Crs> {
    let name = members.get("crs")?.get("properties")?.get("name")?.as_str()?;
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
