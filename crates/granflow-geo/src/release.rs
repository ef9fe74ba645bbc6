//! Releases: where material lies at the start and how thick, per cell of the terrain.

mod coverage;
mod error;
mod outlines;
mod sparse;
mod vector;

pub use error::ReleaseError;
pub use outlines::Outlines;
pub use sparse::Sparse;
pub use vector::Layer;

use crate::raster::Raster;
use crate::terrain::Terrain;
use geo::{Area, BooleanOps, BoundingRect, Intersects, MultiPolygon, Polygon, Validation, unary_union};
use std::collections::BTreeMap;
use std::path::Path;
use vector::Feature;

/// Where the thickness of a polygon comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum Thickness {
    /// One thickness for all polygons \[m\].
    Value(f64),
    /// The attribute of this name, in metres.
    Attribute(String),
}

/// The direction in which a thickness is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Measured {
    /// Normal to the bed.
    #[default]
    Normal,
    /// Along the vertical.
    Vertical,
}

/// How much of a release may lie where the terrain has no values before it is refused.
const LOST: f64 = 1e-6;

/// Volume per plan area H \[m\] of a thickness h \[m\] per cell.
///
/// H = h / c with c = 1 / sqrt(1 + |grad b|^2) where h is normal to the bed; H = h where it is vertical, for then it
/// is the height of the column itself.
pub fn per_plan_area(thickness: Sparse, terrain: &Terrain, measured: Measured) -> Sparse {
    match measured {
        Measured::Vertical => thickness,
        Measured::Normal => thickness.map(|k, h| h / terrain.fit(terrain.bed.place(k)).cosine()),
    }
}

/// Thickness per cell \[m\] of the polygons of a shapefile or GeoJSON file on the grid of `template`.
///
/// A cell that is partly covered gets the thickness times its covered share, so that the sum of h * cell^2 is the
/// sum of polygon area times thickness; holes stay empty. Where polygons of the file overlap, the thickest counts
/// alone.
///
/// # Errors
/// Every [`ReleaseError`] but [`ReleaseError::Raster`]: unreadable files, other shapes than polygons, rings that
/// cross themselves, a missing attribute, a thickness that is negative or no number, a CRS that contradicts that
/// of `template`, and polygons beyond the edge of `template` or on its nodata cells.
pub fn polygons(path: &Path, thickness: &Thickness, template: &Raster) -> Result<Sparse, ReleaseError> {
    Layer::read(path)?.thickness(thickness, template)
}

impl Layer {
    /// Thickness per cell \[m\] of these polygons on the grid of `template`; see [`polygons`].
    ///
    /// # Errors
    /// As [`polygons`], but for reading.
    pub fn thickness(self, thickness: &Thickness, template: &Raster) -> Result<Sparse, ReleaseError> {
        laid(self, thickness, template)
    }

    /// All polygons; where they overlap, each stands for itself.
    ///
    /// # Errors
    /// [`ReleaseError::Shape`] for rings that cross themselves.
    pub fn outlines(self) -> Result<Vec<Polygon>, ReleaseError> {
        let mut outlines = Vec::new();
        for (feature, number) in self.features.into_iter().zip(1..) {
            outlines.extend(sound(&self.name, number, feature.polygons)?);
        }
        Ok(outlines)
    }
}

/// [`Layer::thickness`].
fn laid(layer: Layer, thickness: &Thickness, template: &Raster) -> Result<Sparse, ReleaseError> {
    let path = &*layer.name;
    if let (Some(own), Some(terrain)) = (&layer.crs, &template.crs)
        && let Some(proof) = own.contradiction(terrain)
    {
        return Err(ReleaseError::system(path, own, terrain, proof));
    }
    let mut areas: Vec<(Polygon, f64)> = Vec::new();
    for (feature, number) in layer.features.into_iter().zip(1..) {
        let thickness = thickness_of(path, number, &feature, thickness)?;
        let polygons = sound(path, number, feature.polygons)?;
        areas.extend(polygons.into_iter().map(|polygon| (polygon, thickness)));
    }
    let Some(extent) =
        MultiPolygon(areas.iter().map(|(polygon, _)| polygon.clone()).collect()).bounding_rect()
    else {
        return Err(ReleaseError::Nothing { path: path.into(), problem: "it holds no polygon" });
    };
    areas.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    let mut height: BTreeMap<usize, f64> = BTreeMap::new();
    let (mut area, mut covered) = (0.0, 0.0);
    for (k, (polygon, thickness)) in areas.iter().enumerate() {
        area += polygon.unsigned_area();
        for (cell, share) in coverage::shares(polygon, template) {
            if !template.values[cell].is_nan() {
                covered += share * template.cell * template.cell;
                *height.entry(cell).or_default() += thickness * share;
            }
        }
        for common in overlap(polygon, &areas[..k]) {
            for (cell, share) in coverage::shares(&common, template) {
                if let Some(height) = height.get_mut(&cell) {
                    *height = (*height - thickness * share).max(0.0);
                }
            }
        }
    }
    let bounds = [extent.min().x, extent.min().y, extent.max().x, extent.max().y];
    let height = kept(path, height.into_iter().collect(), template, bounds, 1.0 - covered / area)?;
    match height.most() > 0.0 {
        true => Ok(height),
        false => Err(ReleaseError::Nothing { path: path.into(), problem: "the thickness is 0 everywhere" }),
    }
}

/// Thickness per cell \[m\] of a raster, carried to the grid of `template` by area, so that the sum of h * cell^2 stays.
///
/// Nodata of the raster is no material.
///
/// # Errors
/// [`ReleaseError::Raster`] with what [`Raster::read`] says, a negative thickness with its place, a raster without
/// any material, and material beyond the edge of `template` or on its nodata cells.
pub fn raster(path: &Path, template: &Raster) -> Result<Sparse, ReleaseError> {
    carried(path, &Raster::read_in(path, template.crs.as_ref())?, template)
}

/// As [`raster`], for a raster that was read before; `path` stands in messages.
///
/// # Errors
/// As [`raster`], but for reading.
pub fn carried(path: &Path, given: &Raster, template: &Raster) -> Result<Sparse, ReleaseError> {
    given.same_system(path, template)?;
    if let Some(k) = given.values.iter().position(|h| *h < 0.0) {
        let (x, y) = (given.x(k % given.columns), given.y(k / given.columns));
        return Err(ReleaseError::Negative { path: path.into(), x, y, found: given.values[k] });
    }
    let total = given.values.iter().filter(|h| !h.is_nan()).sum::<f64>() * given.cell * given.cell;
    if total == 0.0 {
        return Err(ReleaseError::Nothing { path: path.into(), problem: "the thickness is 0 everywhere" });
    }
    let place = |r: &Raster| (r.columns, r.rows, r.west, r.south, r.cell);
    let on_values = |(h, b): (f64, &f64)| if h.is_nan() || b.is_nan() { 0.0 } else { h };
    let height = if place(given) == place(template) {
        Sparse::of(given.values.iter().copied().zip(&template.values).map(on_values))
    } else {
        let cell = template.cell * template.cell;
        let thickness = given.overlap(template).map(|(_, volume)| volume / cell);
        Sparse::of(thickness.zip(&template.values).map(on_values))
    };
    let arrived = height.iter().map(|(_, h)| h).sum::<f64>() * template.cell * template.cell;
    let bounds = [given.west, given.south, given.east(), given.north()];
    kept(path, height, template, bounds, 1.0 - arrived / total)
}

/// Thickness per cell \[m\] of the parabolic cap h = height max(0, 1 - r^2 / radius^2), r the horizontal distance of the
/// cell's centre from `centre` \[m\].
///
/// # Errors
/// [`ReleaseError::Cap`] where the height or radius is not above 0, or no cell with a value lies under the cap.
pub fn cap(height: f64, centre: [f64; 2], radius: f64, template: &Raster) -> Result<Sparse, ReleaseError> {
    let error = |problem: String| ReleaseError::Cap { problem };
    for (name, value) in [("height", height), ("radius", radius)] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(error(format!("its {name} must be above 0, found {value}")));
        }
    }
    let at = |k: usize| {
        let [x, y] =
            [template.x(k % template.columns) - centre[0], template.y(k / template.columns) - centre[1]];
        let inside = 1.0 - (x * x + y * y) / (radius * radius);
        if template.values[k].is_nan() { 0.0 } else { height * inside.max(0.0) }
    };
    let thickness = Sparse::of((0..template.values.len()).map(at));
    if thickness.most() == 0.0 {
        let (west, south) = (template.west, template.south);
        return Err(error(format!(
            "no cell with a value lies within {radius} m of its centre ({}, {}); the terrain extends over x {west} to \
             {}, y {south} to {}",
            centre[0],
            centre[1],
            template.east(),
            template.north()
        )));
    }
    Ok(thickness)
}

/// `height` where no more than [`LOST`] of a release is lost, else the error that says where it and the terrain lie.
fn kept(
    path: &Path,
    height: Sparse,
    template: &Raster,
    bounds: [f64; 4],
    lost: f64,
) -> Result<Sparse, ReleaseError> {
    if lost <= LOST { Ok(height) } else { Err(ReleaseError::outside(path, bounds, template, lost)) }
}

fn thickness_of(
    path: &Path,
    number: usize,
    feature: &Feature,
    thickness: &Thickness,
) -> Result<f64, ReleaseError> {
    let (value, found, name) = match thickness {
        Thickness::Value(value) => (Some(*value), value.to_string(), "thickness"),
        Thickness::Attribute(name) => {
            let same = |(other, _): &&(String, String)| other.eq_ignore_ascii_case(name);
            let attributes = &feature.attributes;
            let exact = attributes.iter().find(|(other, _)| other == name).or(attributes.iter().find(same));
            let Some((name, text)) = exact else {
                return Err(ReleaseError::attribute(path, name, attributes));
            };
            (text.trim().parse().ok(), text.clone(), name.as_str())
        }
    };
    match value.filter(|value: &f64| value.is_finite() && *value >= 0.0) {
        Some(value) => Ok(value),
        None => {
            let (path, name) = (path.into(), name.to_string());
            Err(ReleaseError::Thickness { path, feature: number, name, found })
        }
    }
}

/// The parts of a polygon that polygons before it cover, each point once.
fn overlap(polygon: &Polygon, before: &[(Polygon, f64)]) -> Vec<Polygon> {
    let near = |other: &&Polygon| match (polygon.bounding_rect(), other.bounding_rect()) {
        (Some(own), Some(other)) => own.intersects(&other),
        _ => false,
    };
    let near: Vec<&Polygon> = before.iter().map(|(other, _)| other).filter(near).collect();
    if near.is_empty() { Vec::new() } else { polygon.intersection(&unary_union(near)).0 }
}

/// Refuses rings that cross themselves or each other; rings that only touch enclose a clear area and pass.
fn sound(path: &Path, feature: usize, polygons: Vec<Polygon>) -> Result<Vec<Polygon>, ReleaseError> {
    match polygons.iter().find_map(crossing) {
        Some(problem) => Err(ReleaseError::Shape { path: path.into(), feature, problem }),
        None => Ok(polygons),
    }
}

/// What is wrong with the rings of a polygon, and the cure.
fn crossing(polygon: &Polygon) -> Option<String> {
    let problem = polygon.check_validation().err()?;
    let finite = polygon.exterior().coords().all(|c| c.x.is_finite() && c.y.is_finite());
    let (area, union) =
        (polygon.unsigned_area(), if finite { unary_union([polygon]).unsigned_area() } else { f64::NAN });
    if (area - union).abs() <= 1e-6 * area {
        return None;
    }
    Some(format!(
        "{problem}; mend it with QGIS (Fix geometries) or\n  ogr2ogr -makevalid mended.shp THIS_FILE"
    ))
}

#[cfg(test)]
mod tests;
