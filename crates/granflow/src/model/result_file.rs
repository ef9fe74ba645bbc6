//! An open `result.nc`, to read a run back; every refusal says what is wrong with the file.

use netcdf_reader::{NcFile, NcSliceInfo, NcSliceInfoElem};
use std::fmt;
use std::path::Path;

/// An open `result.nc`.
pub struct ResultFile {
    file: NcFile,
}

impl fmt::Debug for ResultFile {
    fn fmt(&self, to: &mut fmt::Formatter) -> fmt::Result {
        to.debug_struct("ResultFile").finish_non_exhaustive()
    }
}

impl ResultFile {
    /// Open it.
    ///
    /// # Errors
    /// That it is no NetCDF-4 file.
    pub fn open(path: &Path) -> Result<ResultFile, String> {
        let file = NcFile::open(path).map_err(|error| format!("it is no NetCDF-4 file ({error})"))?;
        Ok(ResultFile { file })
    }

    /// A global attribute; empty if there is none.
    #[must_use]
    pub fn text(&self, name: &str) -> String {
        let attribute = self.file.global_attribute(name).ok();
        attribute.and_then(|attribute| attribute.value.as_string()).unwrap_or_default()
    }

    /// An attribute of a variable; empty if there is none.
    #[must_use]
    pub fn attribute(&self, variable: &str, name: &str) -> String {
        let found = self.file.variable(variable).ok();
        let found = found.and_then(|variable| variable.attributes.iter().find(|one| one.name == name));
        found.and_then(|attribute| attribute.value.as_string()).unwrap_or_default()
    }

    /// Is there a variable of this name?
    #[must_use]
    pub fn has(&self, name: &str) -> bool {
        self.file.variable(name).is_ok()
    }

    /// All values of a variable.
    ///
    /// # Errors
    /// The name, and why it cannot be read.
    pub fn whole(&self, name: &str) -> Result<Vec<f64>, String> {
        let read = self.file.read_variable_as_f64(name);
        Ok(read.map_err(|error| format!("`{name}`: {error}"))?.iter().copied().collect())
    }

    /// All values of a variable; none if it is not there.
    ///
    /// # Errors
    /// As [`ResultFile::whole`].
    pub fn optional(&self, name: &str) -> Result<Vec<f64>, String> {
        if self.has(name) { self.whole(name) } else { Ok(Vec::new()) }
    }

    /// A series at an instant, in so many dimensions.
    ///
    /// # Errors
    /// The name, and why it cannot be read.
    pub fn instant(&self, name: &str, instant: usize, dimensions: usize) -> Result<Vec<f64>, String> {
        let all = NcSliceInfoElem::Slice { start: 0, end: u64::MAX, step: 1 };
        let mut selections = vec![NcSliceInfoElem::Index(instant as u64)];
        selections.resize(1 + dimensions, all);
        let read = self.file.read_variable_slice_as_f64(name, &NcSliceInfo { selections });
        Ok(read.map_err(|error| format!("`{name}`: {error}"))?.iter().copied().collect())
    }

    /// A series at its first instant; none if it has no instant.
    ///
    /// # Errors
    /// As [`ResultFile::instant`].
    pub fn first(&self, name: &str, dimensions: usize) -> Result<Vec<f64>, String> {
        if self.whole("time")?.is_empty() { Ok(Vec::new()) } else { self.instant(name, 0, dimensions) }
    }
}
