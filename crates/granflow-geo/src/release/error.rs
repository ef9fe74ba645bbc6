//! What can be wrong with a release, each with its cure.

use crate::raster::{Crs, Raster, RasterError};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a release was refused.
#[derive(Debug, Error)]
pub enum ReleaseError {
    /// The file could not be opened or read.
    #[error("{path}: {source}", path = path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The content is neither a shapefile nor GeoJSON.
    #[error(
        "{path} is neither a shapefile (.shp) nor GeoJSON, it begins with `{found}`; convert it with\n  \
         ogr2ogr release.geojson {path}", path = path.display()
    )]
    Format {
        /// The file.
        path: PathBuf,
        /// How it begins.
        found: String,
    },
    /// The file is damaged.
    #[error("{path} cannot be read: {problem}", path = path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the decoder said.
        problem: String,
    },
    /// A feature is no polygon or no sound one.
    #[error("{path}, feature {feature}: {problem}", path = path.display())]
    Shape {
        /// The file.
        path: PathBuf,
        /// Number of the feature, from 1.
        feature: usize,
        /// What is wrong and what helps.
        problem: String,
    },
    /// The attribute that should hold the thickness does not exist.
    #[error("{path} has no attribute `{name}`{nearest}; it has {available}", path = path.display())]
    Attribute {
        /// The file.
        path: PathBuf,
        /// The name asked for.
        name: String,
        /// The nearest spelling as a question, or nothing.
        nearest: String,
        /// All attributes and what else helps.
        available: String,
    },
    /// An attribute that should hold a number holds none.
    #[error(
        "{path}, feature {feature}: {name} {}; give it one, or remove the feature",
        if found.is_empty() { "is not given (NULL)".into() } else { format!("= `{found}` is not a number") },
        path = path.display()
    )]
    Value {
        /// The file.
        path: PathBuf,
        /// Number of the feature, from 1.
        feature: usize,
        /// The attribute.
        name: String,
        /// What it holds.
        found: String,
    },
    /// A thickness is negative or no number.
    #[error(
        "{path}, feature {feature}: {name} {}; allowed are numbers from 0 to 1e12, in metres: give it one, or thickness = 1.0 in \
         the case for all features", if found.is_empty() { "is not given (NULL)".into() } else { format!("= `{found}` is not a thickness") },
        path = path.display()
    )]
    Thickness {
        /// The file.
        path: PathBuf,
        /// Number of the feature, from 1.
        feature: usize,
        /// The attribute.
        name: String,
        /// Its content.
        found: String,
    },
    /// A thickness raster has a value that is negative or beyond all bounds.
    #[error(
        "{path}: the thickness at ({x}, {y}) is {found} m; allowed are values from 0 to 1e12, and nodata for none",
        path = path.display()
    )]
    Negative {
        /// The file.
        path: PathBuf,
        /// x of the cell's centre \[m\].
        x: f64,
        /// y of the cell's centre \[m\].
        y: f64,
        /// The value \[m\].
        found: f64,
    },
    /// The release and the terrain are in different coordinate reference systems.
    #[error(
        "{path} is in {own}, the terrain in {terrain} ({proof}); reproject the polygons with\n  \
         ogr2ogr -t_srs {} {stem}_reprojected.shp {path}{}", target[0], target[1], stem = stem(path), path = path.display()
    )]
    System {
        /// The file.
        path: PathBuf,
        /// Its system.
        own: String,
        /// The terrain's.
        terrain: String,
        /// What differs.
        proof: String,
        /// What `ogr2ogr -t_srs` takes, and what to know about that.
        target: Box<[String; 2]>,
    },
    /// The release is not in metres, and the terrain says no system.
    #[error(
        "{path} is in {own}, which is not in metres, and the terrain says no system; name it by crs = \"EPSG:xxxx\" in \
         [terrain], and reproject the polygons with\n  ogr2ogr -t_srs EPSG:xxxx {stem}_reprojected.shp {path}",
        stem = stem(path), path = path.display()
    )]
    NoSystem {
        /// The file.
        path: PathBuf,
        /// Its system.
        own: String,
    },
    /// Some or all of the release lies where the terrain has no values.
    #[error(
        "{path}: {share} of the release lies {place}\n  release x {} to {}, y {} to {}\n  terrain x {} to {}, \
         y {} to {}\n{cure}", release[0], release[2], release[1], release[3], terrain[0], terrain[2], terrain[1],
        terrain[3], path = path.display()
    )]
    Outside {
        /// The file.
        path: PathBuf,
        /// How much, as text.
        share: String,
        /// Beyond the edge or on nodata.
        place: &'static str,
        /// Bounding box of the release: west, south, east, north \[m\].
        release: Box<[f64; 4]>,
        /// Bounding box of the terrain: west, south, east, north \[m\].
        terrain: Box<[f64; 4]>,
        /// What probably helps.
        cure: String,
    },
    /// There is no polygon in a file of outlines.
    #[error("{path} holds no polygon", path = path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// Nothing is released.
    #[error("{path} releases nothing: {problem}", path = path.display())]
    Nothing {
        /// The file.
        path: PathBuf,
        /// Why.
        problem: &'static str,
    },
    /// A line along which nothing can enter.
    #[error("the line of an inflow: {problem}; give points within the terrain's data")]
    Line {
        /// What is wrong.
        problem: String,
    },
    /// A cap without height, without radius, or with a part over no cell with a value.
    #[error("the cap {problem}")]
    Cap {
        /// Why, with what is allowed.
        problem: String,
    },
    /// The thickness raster was refused.
    #[error(transparent)]
    Raster(#[from] RasterError),
}

impl ReleaseError {
    /// That polygons are in another system than the terrain; `proof` says what differs.
    pub fn system(path: &Path, own: &Crs, terrain: &Crs, proof: String) -> ReleaseError {
        let (own, target, terrain) =
            (own.describe(), Box::new(Crs::target(Some(terrain))), terrain.describe());
        ReleaseError::System { path: path.into(), own, terrain, proof, target }
    }

    pub(super) fn attribute(path: &Path, name: &str, attributes: &[(String, String)]) -> ReleaseError {
        let likeness = |other: &str| strsim::jaro_winkler(&other.to_lowercase(), &name.to_lowercase());
        let nearest =
            attributes.iter().map(|(other, _)| other).max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
        let nearest =
            nearest.filter(|other| likeness(other) > 0.7).map(|other| format!(", did you mean `{other}`?"));
        let names: Vec<&str> = attributes.iter().map(|(other, _)| other.as_str()).collect();
        let available =
            match (names.is_empty(), path.extension().is_some_and(|e| e.eq_ignore_ascii_case("shp"))) {
                (false, _) => names.join(", "),
                (true, true) => {
                    "none: is its .dbf file missing? thickness = 1.0 in the case works without".to_string()
                }
                (true, false) => {
                    "none; add properties to the features, or write thickness = 1.0 in the case".to_string()
                }
            };
        let nearest = nearest.unwrap_or_default();
        ReleaseError::Attribute { path: path.into(), name: name.to_string(), nearest, available }
    }

    pub(super) fn outside(path: &Path, release: [f64; 4], template: &Raster, lost: f64) -> ReleaseError {
        Self::outside_as(Form::Polygons, path, release, template, lost)
    }

    pub(super) fn outside_as(
        form: Form,
        path: &Path,
        release: [f64; 4],
        template: &Raster,
        lost: f64,
    ) -> ReleaseError {
        let terrain = [template.west, template.south, template.east(), template.north()];
        let apart = (0..2).any(|k| release[k] >= terrain[k + 2] || release[k + 2] <= terrain[k]);
        let within = (0..2).all(|k| release[k] >= terrain[k] && release[k + 2] <= terrain[k + 2]);
        let degrees =
            release[0] >= -360.0 && release[2] <= 360.0 && release[1] >= -90.0 && release[3] <= 90.0;
        let cure = match (form, apart, degrees) {
            (Form::Result, true, _) => "that run was on another terrain; take one that was on this terrain, \
                 or an elevation model that holds both"
                .to_owned(),
            (_, true, true) => format!("the release {}", form.degrees(path, template.crs.as_ref())),
            (_, true, false) => format!(
                "the two are probably in different systems; reproject the release with\n  {}\n\
                 (EPSG:xxxx: the system that the release is in)",
                form.reproject(path, "EPSG:xxxx", template.crs.as_ref())
            ),
            _ => WIDER.to_string(),
        };
        let place = place(within);
        let round = |bounds: [f64; 4]| Box::new(bounds.map(|at| (at * 100.0).round() / 100.0));
        let (release, terrain) = (round(release), round(terrain));
        let share = share(lost);
        ReleaseError::Outside { path: path.into(), share, place, release, terrain, cure }
    }

    /// That a part of a cap lies where the terrain has no values.
    pub(super) fn cut([x, y]: [f64; 2], radius: f64, template: &Raster, lost: f64) -> ReleaseError {
        let [west, south, east, north] = [x - radius, y - radius, x + radius, y + radius];
        let within = west >= template.west
            && south >= template.south
            && east <= template.east()
            && north <= template.north();
        let (share, place, terrain) = (share(lost), place(within), Self::extent(template));
        let problem = format!(
            "loses {share} of its volume {place}\n  cap x {west} to {east}, y {south} to {north}\n  terrain {terrain}\n{WIDER}"
        );
        ReleaseError::Cap { problem }
    }

    /// Where a terrain lies, in words.
    pub(super) fn extent(template: &Raster) -> String {
        let Raster { west, south, .. } = template;
        format!("x {west} to {}, y {south} to {}", template.east(), template.north())
    }
}

/// The path without its ending: what is made of a file is called after it, beside it.
fn stem(path: &Path) -> String {
    path.with_extension("").display().to_string()
}

/// What helps against a release that the terrain does not hold.
const WIDER: &str = "cut the terrain wider, fill its gaps (gdal_fillnodata.py), or shrink the release";

/// Where the lost part of a release lies whose box is `within` that of the terrain, or not.
fn place(within: bool) -> &'static str {
    if within { "on cells without a value" } else { "beyond the terrain's edge or on cells without a value" }
}

fn share(lost: f64) -> String {
    if lost > 1.0 - 1e-9 { "all".to_string() } else { format!("{:.2} %", 100.0 * lost) }
}

/// What a file holds, which decides the program that reprojects it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Polygons, by `ogr2ogr`.
    Polygons,
    /// A raster, by `gdalwarp`.
    Raster,
    /// A result of this program, which no such program reprojects.
    Result,
}

impl Form {
    /// That what a file holds looks like degrees, and the command that brings it into the system of a terrain.
    pub fn degrees(self, path: &Path, terrain: Option<&Crs>) -> String {
        format!("looks like degrees; reproject it with\n  {}", self.reproject(path, "EPSG:4326", terrain))
    }

    /// The command from one system into that of a terrain. It names both, since such a file rarely says its own.
    fn reproject(self, path: &Path, from: &str, terrain: Option<&Crs>) -> String {
        let ([target, about], stem, path) = (Crs::target(terrain), stem(path), path.display());
        match self {
            Form::Polygons => {
                format!("ogr2ogr -t_srs {target} -s_srs {from} {stem}_reprojected.shp {path}{about}")
            }
            Form::Raster | Form::Result => {
                format!("gdalwarp -t_srs {target} -s_srs {from} {path} {stem}_reprojected.tif{about}")
            }
        }
    }
}
