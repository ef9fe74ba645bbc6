//! The tools of a check: what a case says is looked at with its text at hand, so that each fault has its place.

use super::checked::Stepping;
use super::fault::{CaseError, PartFault};
use super::files::{self, Files};
use super::grid::Points;
use super::quantity::Quantity;
use super::source::Source;
use granflow_model::scheme::Scheme;
use std::path::{Path, PathBuf};

/// The text of a case and the files it may name.
#[derive(Clone, Copy)]
pub(crate) struct Look<'a> {
    pub source: &'a Source,
    pub files: &'a dyn Files,
}

/// What a scheme says about its time step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StepLimits {
    /// Name of the scheme.
    pub scheme: &'static str,
    /// Largest Courant number.
    pub max_courant: f64,
    /// Courant number where the case does not say.
    pub suggested: f64,
}

impl StepLimits {
    /// The limits that the scheme of this name states itself.
    pub fn of<S: Scheme<1, f64>>(name: &'static str, scheme: &S) -> Self {
        Self { scheme: name, max_courant: scheme.max_courant(), suggested: scheme.suggested_courant() }
    }
}

impl Look<'_> {
    /// A fault at a key, and what cures it.
    pub fn fault(&self, key: &str, message: impl Into<String>, cure: &str) -> CaseError {
        self.source.fault(key, message).help(cure)
    }

    /// A fault in a part of what stands at `key`.
    pub fn part_fault(&self, key: &str, fault: PartFault) -> CaseError {
        let dot = if fault.key.is_empty() { "" } else { "." };
        let error = self.source.fault_in(&format!("{key}{dot}{}", fault.key), fault.part, fault.message);
        if fault.file { error.file() } else { error }
    }

    /// A path of the case, seen from its folder.
    pub fn locate(&self, path: &Path) -> PathBuf {
        self.source.folder().join(path)
    }

    /// `value` must be a finite number that `fits`.
    pub fn number(
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

    /// A number > 0, where there is one.
    pub fn positive(&self, key: &str, value: Option<f64>) -> Result<(), CaseError> {
        value.map_or(Ok(()), |value| self.number(key, value, |v| v > 0.0, "a number > 0"))
    }

    /// A number >= 0, where there is one.
    pub fn not_negative(&self, key: &str, value: Option<f64>) -> Result<(), CaseError> {
        value.map_or(Ok(()), |value| self.number(key, value, |v| v >= 0.0, "a number >= 0"))
    }

    /// A whole number > 0, where there is one.
    pub fn not_zero(&self, key: &str, value: Option<u64>) -> Result<(), CaseError> {
        match value {
            Some(0) => Err(self.source.fault(key, "found 0, expected a whole number > 0")),
            _ => Ok(()),
        }
    }

    /// The file under `key` must exist and be a file.
    pub fn file(&self, key: &str, path: &Path) -> Result<(), CaseError> {
        let found = self.locate(path);
        let Err(error) = self.files.find(&found) else { return Ok(()) };
        let fault = self.source.fault(key, format!("cannot read {}: {error}", found.display())).file();
        Err(files::with_neighbour(fault, &found, self.files))
    }

    /// The time step of `[scheme]`: a fixed one, or a Courant number within the limits of the scheme.
    pub fn stepping(
        &self,
        step: Option<f64>,
        courant: Option<f64>,
        limits: StepLimits,
    ) -> Result<Stepping, CaseError> {
        let StepLimits { scheme, max_courant, suggested } = limits;
        self.positive("scheme.step", step)?;
        match (step, courant) {
            (Some(_), Some(_)) => Err(self.fault(
                "scheme.courant",
                "both `step` and `courant` are given",
                "keep step for a fixed step, courant for an adaptive one",
            )),
            (Some(step), None) => Ok(Stepping::Fixed(step)),
            (None, Some(courant)) => {
                let allowed = format!("a number > 0 and <= {max_courant} for {scheme}");
                self.number("scheme.courant", courant, |v| v > 0.0 && v <= max_courant, &allowed)?;
                Ok(Stepping::Courant(courant))
            }
            (None, None) => Ok(Stepping::Courant(suggested)),
        }
    }

    /// A quantity at all points, 0 where the case does not say; every value is finite.
    pub fn evaluate(
        &self,
        points: &Points,
        key: &str,
        quantity: Option<&Quantity>,
    ) -> Result<Vec<f64>, CaseError> {
        let quantity = quantity.unwrap_or(&Quantity::Constant(0.0));
        let values = quantity.on(points, self).map_err(|fault| self.part_fault(key, fault))?;
        match values.iter().position(|value| !value.is_finite()) {
            None => Ok(values),
            Some(index) => Err(self
                .source
                .fault(key, format!("the value is {} at {}", values[index], points.place(index)))
                .help("every cell needs a finite number")),
        }
    }

    /// A quantity that is never negative.
    pub fn layer(
        &self,
        points: &Points,
        key: &str,
        quantity: Option<&Quantity>,
    ) -> Result<Vec<f64>, CaseError> {
        let values = self.evaluate(points, key, quantity)?;
        match values.iter().position(|value| *value < 0.0) {
            None => Ok(values),
            Some(index) => {
                let name = key.rsplit('.').next().unwrap_or(key).replace('_', " ");
                let message = format!("the {name} is {} at {}", values[index], points.place(index));
                let cure = format!("a {name} is never negative; max(..., 0) cuts a formula off");
                Err(self.fault(key, message, &cure))
            }
        }
    }
}
