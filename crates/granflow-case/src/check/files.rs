//! What can be said about `[terrain]`, `[[release]]` and the files a case names, without reading them.

use std::io;
use std::path::Path;

use crate::fault::{CaseError, nearest};
use crate::{Case, Release, Thickness};

impl Case {
    pub(super) fn check_terrain(&self) -> Result<(), CaseError> {
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
    pub(super) fn check_file(&self, key: &str, path: &Path) -> Result<(), CaseError> {
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
pub(crate) fn missing(path: &Path, error: &io::Error, name: &str) -> CaseError {
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
