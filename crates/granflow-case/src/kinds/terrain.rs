//! An avalanche on a mountain: savage_hutter on `[terrain]`.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::avalanche::{self, EarthPressure, Friction, Material, Method, Parameter, SchemeName};
use super::{About, Foreign, Kind, Written, joined};
use crate::ensemble;
use crate::fault::CaseError;
use crate::look::Look;
use crate::output::{Defaults, Output};
use crate::plan::RunPlan;
use crate::precision::Precision;
use crate::source::Missing;
use crate::watched::{self, Gauge, SectionWords};

mod entrainment;
mod inflow;
mod release;
mod words;

use words::Elevation;

pub use entrainment::Entrainment;
pub use inflow::{Hydrograph, Inflow, Over};
pub use release::{Attribute, Cap, Extent, Features, Measured, Release, Starts, Thickness};

/// The film of a case that says none \[m\]: a layer of a tenth of a millimetre, thinner than a grain, does not flow.
pub const FILM: f64 = 1e-4;

/// The threshold on a mountain where nobody says another one \[m\].
pub const THRESHOLD: f64 = 0.01;

/// The length over which slope and curvature of a mountain are taken where nobody says another one \[m\].
pub const CURVATURE: f64 = 20.0;

/// The thickness of a trickle on a mountain where nobody says another one \[m\].
pub const TRICKLE: f64 = 0.01;

/// An avalanche on a mountain, in plain numbers: metres, seconds.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The elevation model: a GeoTIFF or ESRI ASCII grid.
    pub dem: PathBuf,
    /// Coordinate reference system where the file has none.
    pub crs: Option<String>,
    /// The part of the raster that is computed on, [x0, x1, y0, y1], if not all.
    pub region: Option<[f64; 4]>,
    /// Size of the cells, if the raster is to be resampled.
    pub cell: Option<f64>,
    /// Span of the window that gradient and curvature of the bed come from, `None` for no curvature in the friction.
    pub curvature: Option<f64>,
    /// What is released.
    pub releases: Vec<Release>,
    /// What enters in the course of the run.
    pub inflows: Vec<Inflow>,
    /// A layer on the bed that the flow picks up.
    pub entrainment: Option<Entrainment>,
    /// The pressure \[Pa\] at which the forest breaks, if it does.
    pub forest_breaks_at: Option<f64>,
    /// What flows, and what holds it back.
    pub material: Material,
    /// The scheme.
    pub scheme: Method<TerrainScheme>,
}

/// The schemes that work on terrain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TerrainScheme {
    /// energy_stable.
    EnergyStable,
    /// energy_stable_2.
    EnergyStable2,
    /// balanced.
    Balanced,
    /// balanced_2.
    Balanced2,
}

/// An avalanche on a mountain.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Mountain")]
pub(crate) struct Words {
    /// What the figures and the report are headed with.
    #[serde(default)]
    title: String,
    /// The model.
    #[serde(default)]
    model: avalanche::Model,
    /// The mountain.
    terrain: Elevation,
    /// The material.
    material: OnTerrain,
    /// What is released.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    release: Vec<release::Words>,
    /// What enters in the course of the run.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    inflow: Vec<inflow::Words>,
    /// A layer on the bed that the flow picks up.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    entrainment: Option<entrainment::Words>,
    /// The method.
    #[serde(default)]
    scheme: avalanche::Scheme,
    /// The end of the run.
    time: avalanche::Time,
    /// The files.
    #[serde(default)]
    output: Output,
    /// Places that are looked at.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    gauge: Vec<Gauge>,
    /// Lines through which the passing mass is counted.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    section: Vec<SectionWords>,
    /// Many runs of this case, for `granflow ensemble`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    ensemble: Option<ensemble::Words>,
}

/// The material.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "TerrainMaterial")]
struct OnTerrain {
    /// Bulk density rho in kg/m^3.
    density: f64,
    /// The friction law at the bed.
    friction: Friction,
    /// The earth-pressure coefficient k.
    #[serde(default)]
    earth_pressure: EarthPressure,
    /// Drag of a forest or of other things that stand on the bed and are not overflown, in 1/m: it takes drag |V|^2.
    #[serde(skip_serializing_if = "Option::is_none")]
    forest: Option<Parameter>,
    /// Dynamic pressure in kPa at which the forest of a cell breaks (default: it stands).
    #[serde(skip_serializing_if = "Option::is_none")]
    forest_breaks_at: Option<f64>,
    /// Gravity g (default 9.81 m/s^2).
    #[serde(skip_serializing_if = "Option::is_none")]
    gravity: Option<f64>,
}

impl Written for Words {
    const ABOUT: About = About {
        model: avalanche::MODEL,
        place: "terrain",
        keys: &KEYS,
        foreign: FOREIGN,
        schemes: avalanche::SCHEMES,
        until: avalanche::UNTIL,
        missing: MISSING,
    };

    fn check(&self, look: &Look) -> Result<(RunPlan, Kind), CaseError> {
        let Self { title, terrain, material, release, inflow, time, output, .. } = self;
        let scheme = &self.scheme.or(SchemeName::EnergyStable2);
        let forest_breaks_at = material.breaks_at(look)?;
        let material = material.check(look)?;
        let entrainment =
            self.entrainment.as_ref().map(|one| one.check(look, material.density)).transpose()?;
        let stepping = scheme.check(look)?;
        material.check_scheme(look, scheme.name)?;
        let named = on_terrain(look, scheme.name)?;
        let ends = time.check(look, scheme.name, TRICKLE)?;
        let written = output.check(look, &ends, &WRITTEN)?;
        let watched = watched::check(look, &self.gauge, &self.section, output.series_every, 2)?;
        let curvature = terrain.check(look)?;
        let releases = release.iter().enumerate();
        let releases = releases
            .map(|(index, one)| one.check(look, &format!("release[{index}]")))
            .collect::<Result<_, _>>()?;
        let inflows = inflow.iter().enumerate();
        let inflows = inflows
            .map(|(index, one)| one.check(look, &format!("inflow[{index}]")))
            .collect::<Result<_, _>>()?;
        let first = release.iter().any(|one| one.when.is_none());
        if !first && inflow.is_empty() {
            return Err(look.fault(
                "release",
                "a case with [terrain] needs a [[release]] that starts by itself, or an [[inflow]]",
                "add [[release]] with polygons, raster, cap or result",
            ));
        }
        look.file("terrain.dem", &terrain.dem)?;
        for (index, one) in release.iter().enumerate() {
            one.check_files(look, &format!("release[{index}]"))?;
        }
        let run = avalanche::plan(look, title, scheme, &material, stepping, ends, (written, watched));
        let kind = Kind::Terrain(Plan {
            dem: look.locate(&terrain.dem),
            crs: terrain.crs.clone(),
            region: terrain.region,
            cell: terrain.cell,
            curvature,
            releases,
            inflows,
            entrainment,
            forest_breaks_at,
            material,
            scheme: scheme.method(named, FILM),
        });
        Ok((run, kind))
    }

    fn ensemble(&self) -> Option<(&ensemble::Words, bool)> {
        self.ensemble.as_ref().map(|words| (words, true))
    }
}

impl OnTerrain {
    fn check(&self, look: &Look) -> Result<Material, CaseError> {
        look.usual("material.gravity", self.gravity)?;
        look.usual("material.density", Some(self.density))?;
        let gravity = self.gravity.unwrap_or(avalanche::GRAVITY);
        let material = self.friction.material(look, self.earth_pressure, gravity, self.density)?;
        material.in_forest(look, self.forest.as_ref())
    }

    /// The pressure \[Pa\] at which the forest breaks, if it does.
    fn breaks_at(&self, look: &Look) -> Result<Option<f64>, CaseError> {
        let key = "material.forest_breaks_at";
        look.usual(key, self.forest_breaks_at)?;
        if self.forest_breaks_at.is_some() && self.forest.is_none() {
            return Err(look.fault(
                key,
                "there is no forest that could break",
                "add forest = 0.02 (1/m), or remove it",
            ));
        }
        Ok(self.forest_breaks_at.map(|kilopascal| 1000.0 * kilopascal))
    }
}

/// The published schemes work on a constant slope.
fn on_terrain(look: &Look, scheme: SchemeName) -> Result<TerrainScheme, CaseError> {
    match scheme {
        SchemeName::EnergyStable => Ok(TerrainScheme::EnergyStable),
        SchemeName::EnergyStable2 => Ok(TerrainScheme::EnergyStable2),
        SchemeName::Balanced => Ok(TerrainScheme::Balanced),
        SchemeName::Balanced2 => Ok(TerrainScheme::Balanced2),
        SchemeName::Verfahren1
        | SchemeName::Verfahren2
        | SchemeName::Verfahren3
        | SchemeName::Verfahren4
        | SchemeName::Verfahren5 => Err(look.fault(
            "scheme.name",
            format!("{} works on a [grid] only, not on terrain", scheme.as_str()),
            "use the scheme energy_stable, which can",
        )),
    }
}

/// What is written where the case does not say.
const WRITTEN: Defaults = Defaults {
    files: &["netcdf", "figures", "geotiff", "vector", "report"],
    precision: Precision::F32,
    threshold: THRESHOLD,
};

/// Keys that not every model has.
const KEYS: [&str; 14] = joined(avalanche::KEYS, ["terrain", "release", "inflow", "entrainment"]);

/// A key that only a scaled case has.
const fn scaled(key: &'static str, message: &'static str) -> Foreign {
    Foreign { key, message: Some(message), cure: "remove it" }
}

/// Keys of other kinds.
const FOREIGN: &[Foreign] = &[
    Foreign {
        key: "initial",
        message: Some("[initial] needs [grid]"),
        cure: "on terrain write [[release]] instead",
    },
    scaled(
        "material.epsilon",
        "`epsilon` has no meaning on terrain, where everything is in metres and seconds",
    ),
    scaled("material.slope", "`slope` has no meaning on terrain, where everything is in metres and seconds"),
    scaled("material.eta", "`eta` has no meaning on terrain, where everything is in metres and seconds"),
];

/// Keys that a case must have.
const MISSING: &[Missing] = &[
    avalanche::NO_MATERIAL,
    Missing {
        key: "material.density",
        message: None,
        cure: "the pressure on terrain needs it: density = 200.0 (kg/m^3, dry snow), 1500.0 (debris)",
    },
    avalanche::NO_FRICTION,
    avalanche::NO_TIME,
];
