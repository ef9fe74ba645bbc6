//! Everything that can be said about a case before work starts.

use super::fault::CaseError;
use super::grid::{Axis, Grid, Side};
use super::material::EarthPressure;
use super::{Case, Initial, Model, Quantity};

mod files;
mod material;
mod method;
mod model;
mod sandpile;

pub(super) use files::missing;

impl Case {
    /// Checks ranges, combinations, formulas and that every file the case names exists.
    ///
    /// # Errors
    /// [`CaseError`] for the first thing that is wrong; its kind is `File` where a file cannot be read.
    pub fn check(&self) -> Result<(), CaseError> {
        self.check_model()?;
        self.check_place()?;
        self.check_material()?;
        self.check_scheme()?;
        self.check_time()?;
        self.check_output()?;
        self.check_initial_files()?;
        match self.model {
            Model::SavageHutter => {
                self.check_initial()?;
                self.check_terrain()
            }
            Model::HadelerKuttler => self.check_sandpile(),
        }
    }

    /// What is allowed but may surprise, one sentence each.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        let name = self.scheme.name;
        if name.verfahren().is_some() && self.scheme.film.is_some_and(|film| film > 0.0) {
            notes.push(format!(
                "{} is computed as published, without films: scheme.film has no effect",
                name.as_str()
            ));
        }
        if self.time.end.is_none() && self.time.steps.is_none() && self.time.method.is_none() {
            notes.push("the run has no time limit; time.end sets one".to_owned());
        }
        if self.model == Model::HadelerKuttler {
            notes.extend(self.sandpile_notes());
        }
        notes
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
                let thickness = self.initial.as_ref().is_some_and(|initial| initial.thickness.is_some());
                if self.model == Model::SavageHutter && self.initial.is_none() {
                    return fault(
                        "initial",
                        "a case with [grid] needs an [initial] thickness",
                        "add for instance initial.thickness = 1.0",
                    );
                }
                if self.model == Model::SavageHutter && !thickness {
                    return fault(
                        "initial.thickness",
                        "the key `thickness` is missing",
                        "add thickness = ... to initial",
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
                let material = self.material();
                for (key, given) in [
                    ("epsilon", material.epsilon.is_some()),
                    ("slope", material.slope.is_some()),
                    ("eta", material.eta.is_some()),
                ] {
                    if given {
                        let message = format!(
                            "`{key}` has no meaning on terrain, where everything is in metres and seconds"
                        );
                        return fault(&format!("material.{key}"), &message, "remove it");
                    }
                }
                if material.earth_pressure != EarthPressure::Isotropic {
                    return fault(
                        "material.earth_pressure",
                        "on terrain the earth pressure is isotropic in this version",
                        "remove it, or write earth_pressure = \"isotropic\"",
                    );
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

    /// The files that [initial] names.
    fn check_initial_files(&self) -> Result<(), CaseError> {
        for (name, quantity) in self.initial.iter().flat_map(Initial::quantities) {
            let Some(path) = quantity.and_then(Quantity::needs_file) else { continue };
            self.check_file(&format!("initial.{name}.file"), path)?;
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
        self.initial_state().map(|_| ())
    }
}
