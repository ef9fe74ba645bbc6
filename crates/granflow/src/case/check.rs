//! Everything that can be said about a case before work starts.

use std::io;
use std::path::Path;

use super::fault::{CaseError, nearest};
use super::grid::{Axis, Grid, Side};
use super::material::Friction;
use super::slope::Slope;
use super::{Case, Quantity, Release, Thickness};

const RADIANS: &str = "a plain number is in radians: write \"18 deg\" for degrees";

impl Case {
    /// Checks ranges, combinations, formulas and that every file the case names exists.
    ///
    /// # Errors
    /// [`CaseError`] for the first thing that is wrong; its kind is `File` where a file cannot be read.
    pub fn check(&self) -> Result<(), CaseError> {
        self.check_place()?;
        self.check_material()?;
        self.check_scheme()?;
        self.check_time()?;
        self.check_output()?;
        self.check_initial()?;
        self.check_terrain()
    }

    /// `value` must be a finite number that `fits`.
    fn number(
        &self,
        key: &str,
        value: f64,
        fits: impl Fn(f64) -> bool,
        allowed: &str,
    ) -> Result<(), CaseError> {
        if value.is_finite() && fits(value) {
            return Ok(());
        }
        Err(self.source.fault(key, format!("found {value}, expected {allowed}")))
    }

    fn positive(&self, key: &str, value: Option<f64>) -> Result<(), CaseError> {
        value.map_or(Ok(()), |value| self.number(key, value, |v| v > 0.0, "a number > 0"))
    }

    fn not_negative(&self, key: &str, value: Option<f64>) -> Result<(), CaseError> {
        value.map_or(Ok(()), |value| self.number(key, value, |v| v >= 0.0, "a number >= 0"))
    }

    /// Exactly one of [grid] and [terrain], with what belongs to it.
    fn check_place(&self) -> Result<(), CaseError> {
        let fault = |key: &str, message: &str, cure: &str| Err(self.fault(key, message, cure));
        match (&self.grid, &self.terrain) {
            (None, None) => fault(
                "",
                "the case has neither [grid] nor [terrain]",
                "add [grid] for a scaled case, [terrain] for a mountain; `granflow new --list` shows cases to start from",
            ),
            (Some(_), Some(_)) => {
                fault("terrain", "the case has both [grid] and [terrain]", "keep one of them")
            }
            (Some(grid), None) => {
                if self.initial.is_none() {
                    return fault(
                        "initial",
                        "a case with [grid] needs an [initial] thickness",
                        "add for instance initial.thickness = 1.0",
                    );
                }
                if !self.release.is_empty() {
                    return fault(
                        "release",
                        "[[release]] needs [terrain]",
                        "on a grid write [initial] thickness instead",
                    );
                }
                self.check_grid(grid)
            }
            (None, Some(_)) => {
                if self.initial.is_some() {
                    return fault(
                        "initial",
                        "[initial] needs [grid]",
                        "on terrain write [[release]] instead",
                    );
                }
                if self.release.is_empty() {
                    return fault(
                        "release",
                        "a case with [terrain] needs a [[release]]",
                        "add [[release]] with polygons, raster or cap",
                    );
                }
                for (key, given) in [
                    ("epsilon", self.material.epsilon.is_some()),
                    ("slope", self.material.slope.is_some()),
                    ("eta", self.material.eta.is_some()),
                ] {
                    if given {
                        let message = format!(
                            "`{key}` has no meaning on terrain, where everything is in metres and seconds"
                        );
                        return fault(&format!("material.{key}"), &message, "remove it");
                    }
                }
                Ok(())
            }
        }
    }

    fn check_grid(&self, grid: &Grid) -> Result<(), CaseError> {
        let axis = |key: &str, axis: &Axis| {
            for (end, value) in [("from", axis.from), ("to", axis.to)] {
                self.number(&format!("{key}.{end}"), value, |_| true, "a finite number")?;
            }
            if axis.from >= axis.to {
                let message = format!("from = {} is not below to = {}", axis.from, axis.to);
                return Err(self.fault(
                    &format!("{key}.from"),
                    message,
                    "from is the low end of the grid, to the high end",
                ));
            }
            if axis.cells < 3 {
                let message = format!("found {} cells, expected at least 3", axis.cells);
                return Err(self.source.fault(&format!("{key}.cells"), message));
            }
            if !(axis.width() > 0.0
                && axis.from + axis.width() > axis.from
                && axis.to - axis.width() < axis.to)
            {
                return Err(self
                    .source
                    .fault(&format!("{key}.cells"), "the cells are too small to be told apart"));
            }
            Ok(())
        };
        axis("grid.x", &grid.x)?;
        if let Some(y) = &grid.y {
            axis("grid.y", y)?;
        } else if self.source.has("grid.boundary.y") {
            return Err(self.fault("grid.boundary.y", "the grid has no y", "remove it, or add grid.y"));
        }
        let cells = grid.cells();
        if cells[0].checked_mul(cells[1]).is_none_or(|count| count > 1 << 36) {
            let message = format!("{} x {} cells are more than any machine holds", cells[0], cells[1]);
            return Err(self.source.fault("grid.x.cells", message));
        }
        for (name, pair) in ["x", "y"].into_iter().zip(grid.sides()) {
            if (pair[0] == Side::Periodic) != (pair[1] == Side::Periodic) {
                let key = format!("grid.boundary.{name}");
                let message = "one end is periodic, the other is not";
                return Err(self.fault(&key, message, &format!("write {name} = \"periodic\" for both ends")));
            }
        }
        Ok(())
    }

    fn check_material(&self) -> Result<(), CaseError> {
        let material = &self.material;
        self.positive("material.epsilon", material.epsilon)?;
        self.positive("material.gravity", material.gravity)?;
        self.positive("material.density", material.density)?;
        self.not_negative("material.eta", material.eta)?;
        if self.terrain.is_some() && material.density.is_none() {
            return Err(self.fault(
                "material.density",
                "the key `density` is missing",
                "the pressure on terrain needs it: density = 200.0 (kg/m^3, dry snow), 1500.0 (debris)",
            ));
        }
        self.check_friction(&material.friction)?;
        self.check_slope()
    }

    fn check_friction(&self, law: &Friction) -> Result<(), CaseError> {
        let at = format!("material.friction.{}", law.name());
        let key = |name: &str| format!("{at}.{name}");
        match law.written() {
            (Some(_), Some(_)) => {
                let cure = format!(
                    "keep one of angle and mu = tan(angle); with --set replace the table: --set 'material.friction={{{}={{mu=0.3}}}}'",
                    law.name()
                );
                return Err(self.fault(&key("mu"), "both `angle` and `mu` are given", &cure));
            }
            (None, None) => {
                return Err(self.fault(
                    &at,
                    "neither `angle` nor `mu` is given",
                    "add angle = \"25 deg\" or mu = 0.4",
                ));
            }
            (Some(angle), None) => {
                let fits = |v: f64| (0.0..std::f64::consts::FRAC_PI_2).contains(&v);
                self.number(
                    &key("angle"),
                    angle.radians(),
                    fits,
                    "an angle from 0 to below 90 deg (1.5708 rad)",
                )
                .map_err(|error| error.help(RADIANS))?;
            }
            (None, mu) => self.not_negative(&key("mu"), mu)?,
        }
        match law {
            Friction::Coulomb(_) => Ok(()),
            Friction::Voellmy(law) => self.positive(&key("xi"), Some(law.xi)),
            Friction::Cohesion(law) => self.not_negative(&key("tau0"), Some(law.tau0)),
            Friction::Samosat(law) => {
                self.not_negative(&key("tau0"), Some(law.tau0))?;
                self.not_negative(&key("rs0"), Some(law.rs0))?;
                self.positive(&key("kappa"), Some(law.kappa))?;
                self.positive(&key("r"), Some(law.r))?;
                self.positive(&key("b"), Some(law.b))
            }
        }
    }

    fn check_slope(&self) -> Result<(), CaseError> {
        let fits = |v: f64| v.abs() < std::f64::consts::FRAC_PI_2;
        let steep = |key: &str, value: f64| {
            self.number(key, value, fits, "an angle between -90 deg and 90 deg (1.5708 rad)")
                .map_err(|error| error.help(RADIANS))
        };
        match &self.material.slope {
            None => return Ok(()),
            Some(Slope::Constant(angle)) => return steep("material.slope", angle.radians()),
            Some(Slope::Profile(profile)) => {
                for (index, angle) in profile.angle.iter().flatten().enumerate() {
                    steep(&format!("material.slope.angle[{index}]"), angle.radians())?;
                }
                for (index, x) in profile.x.iter().flatten().enumerate() {
                    self.number(&format!("material.slope.x[{index}]"), *x, |_| true, "a finite number")?;
                }
            }
        }
        let chute = self.chute()?;
        let Some(grid) = &self.grid else { return Ok(()) };
        for cell in 0..grid.x.cells {
            let (x, low, high) = (grid.x.centre(cell), grid.x.face(cell), grid.x.face(cell + 1));
            let (zeta, kappa) = (chute.zeta(x), chute.kappa(low, high));
            if !fits(zeta) || !kappa.is_finite() {
                let message = format!("at x = {x} the slope is {zeta} rad and its curvature {kappa}");
                return Err(self.fault(
                    "material.slope",
                    message,
                    "expected an angle between -90 deg and 90 deg and a finite curvature",
                ));
            }
        }
        Ok(())
    }

    fn check_scheme(&self) -> Result<(), CaseError> {
        let scheme = &self.scheme;
        if scheme.step.is_some() && scheme.courant.is_some() {
            return Err(self.fault(
                "scheme.courant",
                "both `step` and `courant` are given",
                "keep step for a fixed step, courant for an adaptive one",
            ));
        }
        self.positive("scheme.step", scheme.step)?;
        self.not_negative("scheme.film", scheme.film)?;
        if let Some(courant) = scheme.courant {
            let limit = scheme.name.courant_limit();
            let allowed = format!("a number > 0 and <= {limit} for {}", scheme.name.as_str());
            self.number("scheme.courant", courant, |v| v > 0.0 && v <= limit, &allowed)?;
        }
        if scheme.name.verfahren().is_none() {
            return Ok(());
        }
        let name = scheme.name.as_str();
        let refuse = |key: &str, what: &str| {
            Err(self.fault(key, format!("{name} {what}"), "use the scheme balanced or balanced_2, which can"))
        };
        if self.terrain.is_some() {
            return refuse("scheme.name", "works on a [grid] only, not on terrain");
        }
        if !matches!(self.material.friction, Friction::Coulomb(_)) {
            return refuse(
                &format!("material.friction.{}", self.material.friction.name()),
                "knows Coulomb friction only",
            );
        }
        if matches!(self.material.slope, Some(Slope::Profile(_))) {
            return refuse("material.slope", "works on a constant slope only");
        }
        if scheme.film.is_some() {
            return Err(self.fault(
                "scheme.film",
                format!("{name} knows no films"),
                "remove film; the published schemes are kept as published",
            ));
        }
        Ok(())
    }

    fn check_time(&self) -> Result<(), CaseError> {
        let time = &self.time;
        if time.steps.is_none() && time.end.is_none() && time.until.is_none() && time.stop.is_none() {
            return Err(self.fault(
                "time",
                "nothing ends the run",
                "add steps = 1000, end = 10.0, until = \"rest\" or stop.kinetic_energy = 0.01",
            ));
        }
        if time.steps == Some(0) {
            return Err(self.source.fault("time.steps", "found 0, expected a whole number > 0"));
        }
        self.positive("time.end", time.end)?;
        self.positive("time.rest_speed", time.rest_speed)?;
        if let Some(stop) = &time.stop {
            self.number(
                "time.stop.kinetic_energy",
                stop.kinetic_energy,
                |v| v > 0.0 && v < 1.0,
                "a share of the peak, between 0 and 1",
            )?;
        }
        if time.rest_speed.is_some() && time.until.is_none() {
            return Err(self.fault(
                "time.rest_speed",
                "`rest_speed` has no meaning without until = \"rest\"",
                "add until = \"rest\" or remove rest_speed",
            ));
        }
        if time.until.is_some() && self.scheme.name.verfahren().is_some() && time.rest_speed.is_none() {
            let message = format!(
                "{} never reaches speed 0, so until = \"rest\" would never end",
                self.scheme.name.as_str()
            );
            return Err(self.fault(
                "time.until",
                message,
                "add rest_speed = 1e-12, or use the scheme balanced, which stops exactly",
            ));
        }
        Ok(())
    }

    fn check_output(&self) -> Result<(), CaseError> {
        let output = &self.output;
        if output.every.is_some() && output.steps.is_some() {
            return Err(self.fault("output.steps", "both `every` and `steps` are given", "keep one of them"));
        }
        self.positive("output.every", output.every)?;
        if output.steps == Some(0) {
            return Err(self.source.fault("output.steps", "found 0, expected a whole number > 0"));
        }
        for (index, kind) in output.files.iter().flatten().enumerate() {
            let key = format!("output.files[{index}]");
            if kind.needs_terrain() && self.terrain.is_none() {
                return Err(self.fault(
                    &key,
                    format!("`{}` needs [terrain]", kind.as_str()),
                    "on a grid: netcdf, csv, vtk, figures, animation",
                ));
            }
        }
        Ok(())
    }

    fn check_initial(&self) -> Result<(), CaseError> {
        let (Some(grid), Some(initial)) = (&self.grid, &self.initial) else { return Ok(()) };
        if initial.velocity_y.is_some() && grid.y.is_none() {
            return Err(self.fault(
                "initial.velocity_y",
                "the grid has no y",
                "remove velocity_y, or add grid.y",
            ));
        }
        let all = [Some(&initial.thickness), initial.velocity_x.as_ref(), initial.velocity_y.as_ref()];
        for (name, quantity) in ["thickness", "velocity_x", "velocity_y"].into_iter().zip(all) {
            let Some(path) = quantity.and_then(Quantity::needs_file) else { continue };
            self.check_file(&format!("initial.{name}.file"), path)?;
        }
        self.initial_state().map(|_| ())
    }

    fn check_terrain(&self) -> Result<(), CaseError> {
        let Some(terrain) = &self.terrain else { return Ok(()) };
        self.positive("terrain.cell", terrain.cell)?;
        self.positive("terrain.curvature.length", terrain.curvature.length())?;
        for (index, release) in self.release.iter().enumerate() {
            self.check_release(&format!("release[{index}]"), release)?;
        }
        self.check_file("terrain.dem", &terrain.dem)?;
        for (index, release) in self.release.iter().enumerate() {
            for (name, path) in [("polygons", &release.polygons), ("raster", &release.raster)] {
                if let Some(path) = path {
                    self.check_file(&format!("release[{index}].{name}"), path)?;
                }
            }
        }
        Ok(())
    }

    fn check_release(&self, key: &str, release: &Release) -> Result<(), CaseError> {
        let given = [release.polygons.is_some(), release.raster.is_some(), release.cap.is_some()];
        if given.iter().filter(|given| **given).count() != 1 {
            return Err(self.fault(
                key,
                "a release has exactly one of polygons, raster, cap",
                "split it into several [[release]] tables, or remove what is too much",
            ));
        }
        let thickness = format!("{key}.thickness");
        match (&release.thickness, release.polygons.is_some()) {
            (None, true) => {
                return Err(self.fault(
                    &thickness,
                    "the key `thickness` is missing",
                    "add thickness = 1.0 (metres) or thickness = { attribute = \"thickness\" }",
                ));
            }
            (Some(_), false) => {
                return Err(self.fault(
                    &thickness,
                    "`thickness` belongs to polygons",
                    "remove it: a raster or a cap has its own thickness",
                ));
            }
            (Some(Thickness::Constant(value)), true) => self.positive(&thickness, Some(*value))?,
            _ => {}
        }
        if let Some(cap) = &release.cap {
            self.positive(&format!("{key}.cap.height"), Some(cap.height))?;
            self.positive(&format!("{key}.cap.radius"), Some(cap.radius))?;
            for (index, value) in cap.centre.iter().enumerate() {
                self.number(&format!("{key}.cap.centre[{index}]"), *value, |_| true, "a finite number")?;
            }
        }
        Ok(())
    }

    /// The file under `key` must exist and be a file.
    fn check_file(&self, key: &str, path: &Path) -> Result<(), CaseError> {
        let found = self.resolve(path);
        let error = match std::fs::metadata(&found) {
            Ok(about) if about.is_file() => return Ok(()),
            Ok(_) => io::Error::new(io::ErrorKind::InvalidInput, "it is not a file"),
            Err(error) => error,
        };
        let fault = self.source.fault(key, format!("cannot read {}: {error}", found.display())).file();
        Err(with_neighbour(fault, &found))
    }
}

/// The error for a file that cannot be read, with the nearest name beside it.
pub(super) fn missing(path: &Path, error: &io::Error, name: &str) -> CaseError {
    with_neighbour(CaseError::unreadable(name, format!("cannot read the case file: {error}")), path)
}

fn with_neighbour(error: CaseError, path: &Path) -> CaseError {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let wanted = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let names: Vec<String> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .filter(|entry| entry.path().is_file())
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .filter(|name| *name != wanted)
        .collect();
    match nearest(&wanted, names.iter().map(String::as_str)) {
        Some(near) => error.help(format!("did you mean `{}`?", path.with_file_name(near).display())),
        None if !folder.is_dir() => error.help(format!("the folder {} does not exist", folder.display())),
        None => error,
    }
}
