//! What a dataset says of itself in attributes, for every writer of it.

use super::{Axis, Crs, Dataset, Variable};
#[cfg(feature = "geo")]
use crate::raster::well_known_text;

impl Dataset<'_> {
    /// The global attributes as names and texts.
    pub fn described(&self) -> impl Iterator<Item = (&str, &str)> {
        let globals = [
            ("Conventions", "CF-1.11"),
            ("title", &self.title),
            ("history", &self.history),
            ("source", concat!("granflow ", env!("CARGO_PKG_VERSION"))),
            ("case", &self.case),
        ];
        globals.into_iter().chain(self.attributes.iter().map(|(name, value)| (name.as_str(), value.as_str())))
    }

    /// The attributes of one of its variables.
    #[must_use]
    pub fn described_variable<'v>(&self, variable: &'v Variable) -> Vec<(&'static str, &'v str)> {
        let placed = variable.axes.last().is_some_and(|axis| axis.starts_with('x'));
        let mut attributes = vec![("long_name", variable.long_name.as_str())];
        if !variable.units.is_empty() {
            attributes.insert(0, ("units", variable.units.as_str()));
        }
        attributes.extend(self.crs.as_ref().filter(|_| placed).map(|_| ("grid_mapping", "crs")));
        attributes
    }

    /// The elevation by which a variable with maps of this length has no value where there is no terrain.
    #[must_use]
    pub fn mask(&self, variable: &Variable, length: usize) -> Option<&[f64]> {
        let in_cells = variable.axes.last().is_some_and(|axis| axis == "x");
        self.terrain.filter(|terrain| terrain.len() == length && in_cells)
    }
}

impl Axis {
    /// Its attributes.
    #[must_use]
    pub fn described(&self) -> Vec<(&'static str, &str)> {
        let standard = self.standard_name.as_deref().map(|name| ("standard_name", name));
        let names = [("units", self.units.as_str()), ("long_name", &self.long_name), ("axis", self.axis)];
        names.into_iter().filter(|(_, value)| !value.is_empty()).chain(standard).collect()
    }
}

impl Crs {
    /// The attributes that CF (`crs_wkt`), GDAL and rioxarray (`spatial_ref`) look for; GDAL wants well-known text
    /// there, so a bare EPSG code is looked up.
    #[must_use]
    pub fn described(&self) -> Vec<(&'static str, String)> {
        let code = self.epsg.map(|code| format!("EPSG:{code}"));
        let wkt = self.wkt.clone().or_else(|| self.epsg.and_then(well_known_text));
        let names = [
            ("long_name", Some("coordinate reference system".to_owned())),
            ("crs_wkt", wkt.clone()),
            ("spatial_ref", wkt.or_else(|| code.clone())),
            ("epsg_code", code),
        ];
        names.into_iter().filter_map(|(name, value)| Some((name, value?))).collect()
    }

    /// Its EPSG code as the number that the attribute `epsg` holds.
    #[must_use]
    pub fn number(&self) -> Option<i32> {
        self.epsg.and_then(|code| i32::try_from(code).ok())
    }
}

/// Nothing is looked up without the table of codes.
#[cfg(not(feature = "geo"))]
fn well_known_text(_epsg: u32) -> Option<String> {
    None
}
