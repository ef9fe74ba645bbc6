//! A mountain: where an avalanche flows in SI units, and what follows there from its maps.

use super::MODEL;
#[cfg(feature = "files")]
use super::stopped;
#[cfg(feature = "files")]
use crate::model::Maps;
use crate::model::{Domain, Model, Quantity, Units};
#[cfg(feature = "files")]
use crate::output::netcdf::Crs;
#[cfg(feature = "files")]
use crate::output::outlines::{Lattice, Outline, contour};
#[cfg(feature = "files")]
use crate::output::summary::Summary;
use crate::raster::Raster;
use crate::release::Sparse;
use crate::terrain::{Curvature, Terrain};
use granflow_geo::Remark;
use std::borrow::Cow;
use std::sync::Arc;

/// The least thickness that figures draw \[m\]. Between cells they interpolate, with 0 where nothing is, so
/// that a threshold of 0 would paint the whole mountain; and no map shows a layer of less than a millimetre.
#[cfg(feature = "files")]
const LEAST_DRAWN: f64 = 1e-3;
/// The peak pressure that counts as reached, for the runout \[kPa\].
#[cfg(feature = "files")]
const REACHED_PRESSURE: f64 = 1.0;

/// A mountain; lengths are metres, times seconds.
#[derive(Debug, Clone)]
pub struct TerrainDomain {
    /// The elevation. While a run computes, its grounds hold it and the raster has no values: see
    /// [`Domain::with_bed`].
    pub raster: Arc<Raster>,
    /// Released thickness normal to the bed, at the start or later \[m\].
    pub release: Arc<Sparse>,
    /// The cells through which mass enters.
    pub inlets: Arc<[usize]>,
    /// Density of the mass \[kg/m^3\]; NaN where a file does not tell it.
    pub density: f64,
    /// Thickness normal to the bed that a layer must exceed to count: outside that its maps have no value \[m\].
    pub threshold: f64,
    /// The length over which the slope of the bed is taken.
    pub curvature: Curvature,
    /// What was decided while the files of the case were read, and what looks wrong in them.
    pub remarks: Vec<Remark>,
}

impl Domain for TerrainDomain {
    fn model(&self) -> &'static Model {
        &MODEL
    }

    fn units(&self) -> Units {
        Units::Si
    }

    fn projected(&self) -> bool {
        true
    }

    fn keeps(&self, series: &Quantity, dimensions: usize) -> bool {
        series.name != "velocity_y" || dimensions > 1
    }

    fn remarks(&self) -> Vec<String> {
        self.remarks.iter().map(ToString::to_string).collect()
    }

    fn attributes(&self) -> Vec<(&'static str, String)> {
        let curvature = match self.curvature {
            Curvature::Length(length) => format!("{length} m"),
            Curvature::Off => "off".to_owned(),
        };
        vec![("curvature", curvature)]
    }

    fn elevation(&self) -> Option<&[f64]> {
        Some(&self.raster.values)
    }

    #[cfg(feature = "files")]
    fn crs(&self) -> Option<Crs> {
        self.raster.crs.as_ref().map(|crs| Crs { epsg: crs.epsg, wkt: crs.wkt.clone() })
    }

    fn per_plan_area(&self, cells: &[Option<usize>]) -> Vec<f64> {
        let terrain = Terrain::new(self.raster.clone(), self.curvature);
        let of = |cell: &Option<usize>| {
            cell.map_or(1.0, |cell| 1.0 / terrain.fit(self.raster.place(cell)).cosine())
        };
        cells.iter().map(of).collect()
    }

    /// rho v^2.
    fn pressure(&self, speed: f64) -> f64 {
        self.density * speed * speed / 1000.0
    }

    fn raster(&self) -> Option<&Raster> {
        Some(&self.raster)
    }

    fn fixed(&self) -> Vec<(&'static str, Cow<'_, [f64]>)> {
        vec![("bed", self.raster.values.as_slice().into())]
    }

    fn with_bed(&self, elevation: &dyn Fn() -> Vec<f64>) -> Option<Arc<dyn Domain>> {
        let raster = Arc::new(self.raster.with_values(elevation()));
        Some(Arc::new(TerrainDomain { raster, ..self.clone() }))
    }

    /// The peak pressure, runout and reach angle, and when almost all had stopped.
    #[cfg(feature = "files")]
    fn derive(&self, centres: [&[f64]; 2], maps: &mut Maps, summary: &mut Summary) {
        stopped::note(maps, |cells| self.per_plan_area(cells), summary);
        let Some((_, speed)) = maps.iter().find(|(name, _)| *name == "peak_speed") else { return };
        let pressure: Vec<f64> = speed.iter().map(|v| self.pressure(*v)).collect();
        let covered = maps.iter().find(|(name, _)| *name == "peak_thickness").map(|(_, map)| map.as_slice());
        if let Some((length, drop)) = self.runout(centres, covered.unwrap_or(&[]), &pressure) {
            summary.runout = Some(length);
            summary.reach_angle = Some((drop / length).atan().to_degrees());
        }
        maps.push(("peak_pressure", pressure));
    }

    /// Release, deposit, and all that was reached.
    #[cfg(feature = "files")]
    fn outlines(&self, maps: &Maps) -> Vec<Outline> {
        let lattice = Lattice::from(&*self.raster);
        let outline = |name: &str, map: &[f64], threshold: f64| Outline {
            name: name.to_owned(),
            threshold,
            unit: "m".to_owned(),
            area: contour(map, lattice, threshold),
        };
        let mut all = vec![outline("release", &self.released(), self.release_threshold())];
        for name in ["deposit", "peak_thickness"] {
            let map = maps.iter().find(|(known, _)| *known == name);
            all.extend(map.map(|(_, map)| outline(name, map, self.threshold)));
        }
        all
    }
}

impl TerrainDomain {
    /// The thickness from which a layer is drawn \[m\]: the threshold, but not less than [`LEAST_DRAWN`].
    #[cfg(feature = "files")]
    pub(super) fn drawn(&self) -> f64 {
        self.threshold.max(LEAST_DRAWN)
    }

    /// The released thickness \[m\] in every cell, without a value where there is none: as in the other maps,
    /// an outline then runs along the faces of the outermost cells, not halfway into their neighbours.
    #[cfg(feature = "files")]
    pub(super) fn released(&self) -> Vec<f64> {
        let mut release = self.release.dense(self.raster.values.len());
        release.iter_mut().filter(|h| **h <= 0.0).for_each(|h| *h = f64::NAN);
        release
    }

    /// The thickness that outlines the release \[m\]: that from which a layer is drawn, less where all is thinner.
    #[cfg(feature = "files")]
    pub(super) fn release_threshold(&self) -> f64 {
        let largest = self.release.most();
        if largest > 0.0 { self.drawn().min(0.5 * largest) } else { self.drawn() }
    }

    /// Horizontal length, and drop, from the highest cell in which mass was released or entered to the farthest that it reached with a
    /// peak pressure of [`REACHED_PRESSURE`]. A release that never started was never `covered` (by its peak thickness).
    #[cfg(feature = "files")]
    fn runout(&self, [x, y]: [&[f64]; 2], covered: &[f64], pressure: &[f64]) -> Option<(f64, f64)> {
        let bed = &self.raster.values;
        let columns = x.len();
        let released = self.release.iter().filter(|(_, thickness)| *thickness > 0.0).map(|(cell, _)| cell);
        let released = released.chain(self.inlets.iter().copied());
        let released = released.filter(|cell| covered.get(*cell).is_none_or(|peak| *peak > 0.0));
        let top = released.max_by(|&a, &b| bed[a].total_cmp(&bed[b]))?;
        let from = |k: usize| {
            let (dx, dy) = (x[k % columns] - x[top % columns], y[k / columns] - y[top / columns]);
            dx.hypot(dy)
        };
        let reached = (0..bed.len()).filter(|&k| pressure[k] >= REACHED_PRESSURE);
        let far = reached.max_by(|&a, &b| from(a).total_cmp(&from(b)))?;
        (from(far) > 0.0).then(|| (from(far), bed[top] - bed[far]))
    }
}
