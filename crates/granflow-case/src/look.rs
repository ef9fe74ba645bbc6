//! The tools of a check: what a case says is looked at with its text at hand, so that each fault has its place.

use super::fault::{CaseError, PartFault};
use super::files::{self, FileAccess};
use super::source::Source;
use std::path::{Path, PathBuf};

/// The largest number that a length, a thickness, a speed or a property of the material may be, and one by the smallest size of a
/// cell: areas, pressures and energies made of them are then numbers in single precision too, in which maps are kept.
pub(crate) const LARGEST: f64 = 1e12;

/// The `result.nc` of another run, given by its folder or itself.
pub(crate) fn result_of(path: &Path) -> PathBuf {
    if path.extension().is_some_and(|ending| ending == "nc") {
        path.to_owned()
    } else {
        path.join("result.nc")
    }
}

/// The text of a case and the files it may name.
#[derive(Clone, Copy)]
pub(crate) struct Look<'a> {
    pub source: &'a Source,
    pub files: &'a dyn FileAccess,
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

    /// A number > 0 of a usual size, where there is one.
    pub fn usual(&self, key: &str, value: Option<f64>) -> Result<(), CaseError> {
        let fits = |v: f64| v > 0.0 && v <= LARGEST;
        value.map_or(Ok(()), |value| self.number(key, value, fits, "a number > 0, at most 1e12"))
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
}
