//! Releases: where material lies at the start and how thick, per cell of the terrain.

mod cap;
mod corners;
mod coverage;
mod error;
mod inlets;
mod outlines;
mod sparse;
mod table;
mod thickness;
mod vector;
mod zones;

pub use cap::cap;
pub use coverage::shares as covered_shares;
pub use error::{Form, ReleaseError};
pub use inlets::along;
pub use outlines::Outlines;
pub use sparse::Sparse;
pub use thickness::Thickness;
pub use vector::Layer;
pub(crate) use vector::named as named_system;

use crate::Remark;
use crate::raster::{Comparison, Crs, Raster, Reading, uncertain};
use crate::terrain::Terrain;
use geo::{Area, BooleanOps, BoundingRect, Contains, Line, Point, Polygon, Rect, Validation, unary_union};
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use std::collections::BTreeMap;
use std::path::Path;

/// The direction in which a thickness is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Measured {
    /// Normal to the bed.
    #[default]
    Normal,
    /// Along the vertical.
    Vertical,
}

/// No thickness is larger \[m\]: the bound of every number of a case.
const THICKEST: f64 = 1e12;

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

    /// The numbers that an attribute holds, in the order of the features.
    ///
    /// # Errors
    /// [`ReleaseError::Attribute`] for a missing attribute, [`ReleaseError::Thickness`] for what is no number or negative.
    pub fn numbers(&self, attribute: &str) -> Result<Vec<f64>, ReleaseError> {
        let from = Thickness::Attribute(attribute.to_owned());
        let number = |(place, feature)| from.of(&self.name, (place, feature));
        self.features.iter().enumerate().map(number).collect()
    }

    /// All polygons; where they overlap, each stands for itself.
    ///
    /// # Errors
    /// [`ReleaseError::Shape`] for rings that cross themselves.
    pub fn outlines(self) -> Result<Vec<Polygon>, ReleaseError> {
        let mut outlines = Vec::new();
        for feature in self.features {
            outlines.extend(sound(&self.name, feature.number, feature.polygons)?);
        }
        Ok(outlines)
    }

    /// What the features have under the name of an attribute, each once, in the order of the file.
    pub fn values(&self, attribute: &str) -> Vec<&str> {
        let mut values = Vec::new();
        for value in self.features.iter().map(|feature| feature.value(attribute)) {
            if !values.contains(&value) {
                values.push(value);
            }
        }
        values
    }

    /// The features alone that have this value of an attribute.
    pub fn only(mut self, attribute: &str, value: &str) -> Layer {
        self.features.retain(|feature| feature.value(attribute) == value);
        self
    }

    /// The coordinate reference system, where the file or the `.prj` beside it says one.
    pub fn crs(&self) -> Option<&Crs> {
        self.crs.as_ref()
    }

    /// What a reader must know who lays this layer on `template`: features left out, systems that could not be compared.
    pub fn notes(&self, template: &Raster) -> Vec<Remark> {
        let mut notes = Vec::new();
        let name = self.name.display();
        if self.left_out > 0 {
            let count = self.left_out;
            notes.push(Remark::Note(format!(
                "{name}: left out {count} of its features, without a shape or marked deleted"
            )));
        }
        match (&self.crs, &template.crs) {
            (Some(own), Some(terrain)) => {
                if let Comparison::Unknown(what) = own.compare(terrain) {
                    notes.push(uncertain(&self.name, own, terrain, &what));
                }
            }
            (None, Some(terrain)) => notes.push(Remark::Note(format!(
                "{name}: it says no coordinate reference system; that of the terrain was taken, {}",
                terrain.describe()
            ))),
            (Some(own), None) => notes.push(Remark::Warning(format!(
                "{name}: it is in {}, and the terrain says no system; the two were taken to be one",
                own.describe()
            ))),
            (None, None) => {}
        }
        notes
    }
}

/// [`Layer::thickness`].
fn laid(layer: Layer, thickness: &Thickness, template: &Raster) -> Result<Sparse, ReleaseError> {
    let path = &*layer.name;
    same_system(&layer, template)?;
    let mut areas: Vec<(Polygon, f64)> = Vec::new();
    thickness.fits(path, layer.features.len())?;
    for (place, feature) in layer.features.into_iter().enumerate() {
        let thickness = thickness.of(path, (place, &feature))?;
        let polygons = sound(path, feature.number, feature.polygons)?;
        areas.extend(polygons.into_iter().map(|polygon| (polygon, thickness)));
    }
    // The thickest first.
    areas.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    let (polygons, thicknesses): (Vec<Polygon>, Vec<f64>) = areas.into_iter().unzip();
    let boxes = boxes(&polygons);
    if boxes.size() == 0 {
        return Err(ReleaseError::Nothing { path: path.into(), problem: "it holds no polygon" });
    }
    let extent = boxes.root().envelope();
    let mut height: BTreeMap<usize, f64> = BTreeMap::new();
    let (mut area, mut covered) = (0.0, 0.0);
    for (k, (polygon, thickness)) in polygons.iter().zip(&thicknesses).enumerate() {
        area += polygon.unsigned_area();
        for (cell, share) in coverage::shares(polygon, template) {
            if !template.values[cell].is_nan() {
                covered += share * template.cell * template.cell;
                *height.entry(cell).or_default() += thickness * share;
            }
        }
        for common in overlap(k, &polygons, &boxes) {
            for (cell, share) in coverage::shares(&common, template) {
                if let Some(height) = height.get_mut(&cell) {
                    *height = (*height - thickness * share).max(0.0);
                }
            }
        }
    }
    let ([west, south], [east, north]) = (extent.lower(), extent.upper());
    let bounds = [west, south, east, north];
    let lost = 1.0 - covered / area;
    if lost > LOST {
        return Err(ReleaseError::outside(path, bounds, template, lost));
    }
    let height: Sparse = height.into_iter().collect();
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
    carried(Form::Raster, path, &Reading::on_terrain(path, template.crs.as_ref())?.raster, template)
}

/// As [`raster`], for one that was read before from a file of this form; `path` stands in messages.
///
/// # Errors
/// As [`raster`], but for reading.
pub fn carried(form: Form, path: &Path, given: &Raster, template: &Raster) -> Result<Sparse, ReleaseError> {
    given.same_system(path, template)?;
    if let Some(k) = given.values.iter().position(|h| *h < 0.0 || *h > THICKEST) {
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
    let lost = 1.0 - arrived / total;
    if lost <= LOST {
        return Ok(height);
    }
    Err(ReleaseError::outside_as(form, path, bounds, template, lost))
}

/// The parts of polygon `k` that polygons before it cover, each point once.
fn overlap(k: usize, polygons: &[Polygon], boxes: &Boxes) -> Vec<Polygon> {
    let Some(own) = polygons[k].bounding_rect() else { return Vec::new() };
    let envelope = AABB::from_corners(own.min().into(), own.max().into());
    let mut cutting = Vec::new();
    for other in
        boxes.locate_in_envelope_intersecting(&envelope).map(|found| found.data).filter(|other| *other < k)
    {
        match holds(&polygons[other], own) {
            Some(true) => return vec![polygons[k].clone()],
            Some(false) => {}
            None => cutting.push(&polygons[other]),
        }
    }
    if cutting.is_empty() { Vec::new() } else { polygons[k].intersection(&unary_union(cutting)).0 }
}

/// Whether a polygon holds all of a rectangle or nothing of it, `None` where an edge comes near: far cheaper to find than a cut
/// where a large polygon holds many small ones.
fn holds(polygon: &Polygon, rect: Rect) -> Option<bool> {
    let rings = std::iter::once(polygon.exterior()).chain(polygon.interiors());
    let near = |edge: Line| {
        let apart = |a: f64, b: f64, low: f64, high: f64| a.max(b) < low || a.min(b) > high;
        let (from, to) = (edge.start, edge.end);
        !apart(from.x, to.x, rect.min().x, rect.max().x) && !apart(from.y, to.y, rect.min().y, rect.max().y)
    };
    let clear = !rings.flat_map(|ring| ring.lines()).any(near);
    clear.then(|| polygon.contains(&Point::from(rect.center())))
}

/// The bounding boxes of polygons with their numbers, for finding those near a place.
type Boxes = RTree<GeomWithData<Rectangle<[f64; 2]>, usize>>;

fn boxes(polygons: &[Polygon]) -> Boxes {
    let boxed = |(number, polygon): (usize, &Polygon)| {
        let rect = polygon.bounding_rect()?;
        Some(GeomWithData::new(Rectangle::from_corners(rect.min().into(), rect.max().into()), number))
    };
    RTree::bulk_load(polygons.iter().enumerate().filter_map(boxed).collect())
}

/// Refuses a layer in another system than that of `template`, or in another unit than the metre where that has none.
fn same_system(layer: &Layer, template: &Raster) -> Result<(), ReleaseError> {
    match (&layer.crs, &template.crs) {
        (Some(own), Some(terrain)) => match own.compare(terrain) {
            Comparison::Different(proof) => Err(ReleaseError::system(&layer.name, own, terrain, proof)),
            Comparison::Same | Comparison::Unknown(_) => Ok(()),
        },
        (Some(own), None)
            if own.is_geographic() || own.metres_per_unit().is_some_and(|m| (m - 1.0).abs() > 1e-9) =>
        {
            Err(ReleaseError::NoSystem { path: layer.name.clone(), own: own.describe() })
        }
        _ => Ok(()),
    }
}

/// Refuses rings that cross themselves or each other; rings that only touch enclose a clear area and pass.
fn sound(path: &Path, feature: usize, polygons: Vec<Polygon>) -> Result<Vec<Polygon>, ReleaseError> {
    match polygons.iter().find_map(crossing) {
        Some(problem) => Err(ReleaseError::Shape { path: path.into(), feature, problem }),
        None => Ok(polygons),
    }
}

/// A smaller polygon is none \[m\].
const SMALLEST: f64 = 1e-9;

/// What is wrong with the rings of a polygon, and the cure.
fn crossing(polygon: &Polygon) -> Option<String> {
    // The overlay scales a ring to its extent, and never ends on one of 1e-311 m.
    let extent = polygon.bounding_rect().map_or(0.0, |rect| rect.width().max(rect.height()));
    if extent < SMALLEST {
        return Some(format!(
            "its corners lie within {extent:e} m of each other: it encloses nothing; remove it"
        ));
    }
    let mut rings = std::iter::once(polygon.exterior()).chain(polygon.interiors());
    let finite = rings.all(|ring| ring.coords().all(|c| c.x.is_finite() && c.y.is_finite()));
    let (area, union) =
        (polygon.unsigned_area(), if finite { unary_union([polygon]).unsigned_area() } else { f64::NAN });
    if (area - union).abs() <= 1e-6 * area {
        return None;
    }
    // Last, since it looks at every pair of edges.
    let problem = polygon.check_validation().err()?;
    Some(format!(
        "{problem}; mend it with QGIS (Fix geometries) or\n  ogr2ogr -makevalid mended.shp THIS_FILE"
    ))
}

#[cfg(test)]
mod tests;
