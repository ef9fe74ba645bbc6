//! The coordinate reference system in the GeoKeys of a TIFF (OGC GeoTIFF 1.1, annex B).

use crate::raster::register;
use crate::raster::system::Heights;
use crate::raster::{Crs, well_known_text};
use geotiff_reader::geokeys::GeoKeyDirectory;

pub(super) const CITATION: u16 = 1026;
const GEODETIC_SYSTEM: u16 = 2048;
const GEODETIC_DATUM: u16 = 2050;
const AXIS: u16 = 2057;
const INVERSE_FLATTENING: u16 = 2059;
const MERIDIAN: u16 = 2061;
pub(super) const PROJECTED_SYSTEM: u16 = 3072;
pub(super) const PROJECTED_CITATION: u16 = 3073;
const METHOD: u16 = 3075;
pub(super) const LINEAR_UNIT: u16 = 3076;
const LINEAR_UNIT_SIZE: u16 = 3077;
const VERTICAL_SYSTEM: u16 = 4096;
const VERTICAL_UNIT: u16 = 4099;
const MODEL: u16 = 1024;
const PROJECTED: u16 = 1;
const GEOGRAPHIC: u16 = 2;
/// A GeoKey value that stands for "defined by other keys".
pub(super) const USER_DEFINED: u16 = 32767;
/// How ESRI and GDAL store a definition in a citation.
pub(super) const EMBEDDED: &str = "ESRI PE String = ";

/// Methods by code, with the parameters that GDAL writes for them.
const METHODS: [(u16, &str); 15] = [
    (1, "Transverse_Mercator"),
    (3, "Hotine_Oblique_Mercator"),
    (7, "Mercator_1SP"),
    (8, "Lambert_Conformal_Conic_2SP"),
    (9, "Lambert_Conformal_Conic_1SP"),
    (10, "Lambert_Azimuthal_Equal_Area"),
    (11, "Albers_Conic_Equal_Area"),
    (12, "Azimuthal_Equidistant"),
    (15, "Polar_Stereographic"),
    (16, "Oblique_Stereographic"),
    (17, "Equirectangular"),
    (18, "Cassini_Soldner"),
    (22, "Polyconic"),
    (27, "Transverse_Mercator_South_Orientated"),
    (9815, "Hotine_Oblique_Mercator_Azimuth_Center"),
];

/// Parameters by key.
const PARAMETERS: [(u16, &str); 16] = [
    (3078, "standard_parallel_1"),
    (3079, "standard_parallel_2"),
    (3080, "central_meridian"),
    (3081, "latitude_of_origin"),
    (3082, "false_easting"),
    (3083, "false_northing"),
    (3084, "central_meridian"),
    (3085, "latitude_of_origin"),
    (3086, "false_easting"),
    (3087, "false_northing"),
    (3088, "longitude_of_center"),
    (3089, "latitude_of_center"),
    (3092, "scale_factor"),
    (3093, "scale_factor"),
    (3094, "azimuth"),
    (3096, "rectified_grid_angle"),
];

/// What the keys say of the horizontal system.
pub(super) enum Horizontal {
    /// Nothing.
    None,
    /// A system.
    Known(Crs),
    /// A projected system that these keys do not say enough of.
    Unknown,
}

/// The horizontal system: a definition in a citation, a registered code, or parameters.
pub(super) fn horizontal(keys: &GeoKeyDirectory) -> Horizontal {
    let citation = [PROJECTED_CITATION, CITATION].into_iter().filter_map(|key| keys.get_ascii(key));
    if let Some(embedded) =
        citation.filter_map(|text| text.split_once(EMBEDDED)).find_map(|(_, wkt)| Crs::parse(wkt).ok())
    {
        return Horizontal::Known(embedded);
    }
    let model = keys.get_short(MODEL);
    let coded = match model {
        Some(GEOGRAPHIC) => code(keys, GEODETIC_SYSTEM),
        _ => code(keys, PROJECTED_SYSTEM),
    };
    match coded.and_then(|code| Crs::coded(code, None)) {
        Some(crs) => Horizontal::Known(crs),
        None if model == Some(PROJECTED) => {
            by_parameters(keys).map_or(Horizontal::Unknown, Horizontal::Known)
        }
        None => Horizontal::None,
    }
}

/// What the keys say of the heights.
pub(super) fn heights(keys: &GeoKeyDirectory) -> Option<Heights> {
    let system = keys.get_short(VERTICAL_SYSTEM);
    let unit = keys.get_short(VERTICAL_UNIT).and_then(|code| register::length(u32::from(code)));
    match (system.map(|code| Heights::coded(u32::from(code))), unit) {
        (Some(Heights::Unit(own)), Some(unit)) => Some(Heights::Unit(unit.copysign(own))),
        (_, Some(unit)) => Some(Heights::Unit(unit)),
        (heights, None) => heights,
    }
}

/// Metres of the unit of the coordinates, where the keys say it.
pub(super) fn unit(keys: &GeoKeyDirectory) -> Option<f64> {
    match keys.get_short(LINEAR_UNIT)? {
        USER_DEFINED => number(keys, LINEAR_UNIT_SIZE),
        code => register::length(u32::from(code)),
    }
}

/// A system by method and parameters.
fn by_parameters(keys: &GeoKeyDirectory) -> Option<Crs> {
    let (_, method) = METHODS.iter().find(|(code, _)| Some(*code) == keys.get_short(METHOD))?;
    let parameter =
        |(key, name): &(u16, &str)| Some(format!("PARAMETER[\"{name}\",{}],", number(keys, *key)?));
    let parameters: String = PARAMETERS.iter().filter_map(parameter).collect();
    let name = keys.get_ascii(PROJECTED_CITATION).or(keys.get_ascii(CITATION)).unwrap_or("unnamed");
    let name = name.split('|').next().unwrap_or(name).replace('"', "'");
    let (base, unit) = (base(keys)?, unit(keys)?);
    let text =
        format!("PROJCS[\"{name}\",{base},PROJECTION[\"{method}\"],{parameters}UNIT[\"unit\",{unit}]]");
    Crs::parse(&text).ok()
}

/// The geographic system below a projected one: by its code, or by datum and ellipsoid.
fn base(keys: &GeoKeyDirectory) -> Option<String> {
    if let Some(text) = code(keys, GEODETIC_SYSTEM).and_then(well_known_text) {
        return Some(text).filter(|text| text.starts_with("GEOGCS"));
    }
    let datum =
        code(keys, GEODETIC_DATUM).map(|code| format!(",AUTHORITY[\"EPSG\",\"{code}\"]")).unwrap_or_default();
    let (axis, flattening) = (number(keys, AXIS)?, number(keys, INVERSE_FLATTENING)?);
    let meridian = number(keys, MERIDIAN).unwrap_or(0.0);
    Some(format!(
        "GEOGCS[\"unknown\",DATUM[\"unknown\",SPHEROID[\"unknown\",{axis},{flattening}]{datum}],\
         PRIMEM[\"unknown\",{meridian}],UNIT[\"degree\",0.0174532925199433]]"
    ))
}

/// A code of the register, where a key holds one.
fn code(keys: &GeoKeyDirectory, key: u16) -> Option<u32> {
    keys.get_short(key).filter(|code| !matches!(*code, 0 | USER_DEFINED)).map(u32::from)
}

fn number(keys: &GeoKeyDirectory, key: u16) -> Option<f64> {
    keys.get_double(key)?.first().copied()
}
