//! All files that a case asks for, made of a finished run.

use super::format::{Format, Work};
use super::formats::FORMATS;
use super::{FilesError, Finished};
use crate::model::Plane;
use granflow_case::FileKind;
use rayon::prelude::*;
use std::path::PathBuf;

/// Can all these kinds of files be made of a run on this plane?
///
/// # Errors
/// [`FilesError::Kind`] naming the first that cannot, and what helps.
pub fn check_kinds(files: &[FileKind], plane: &Plane) -> Result<(), FilesError> {
    for &kind in files {
        let Some(format) = FORMATS.iter().find(|format| format.kind == kind) else {
            let problem = "this program was built without it; build it with all features".to_owned();
            return Err(FilesError::Kind { kind, problem });
        };
        #[cfg(feature = "figures")]
        if format.drawn && plane.model().pictures.is_none() {
            let problem = format!("nothing draws the model {}; give it pictures", plane.model().name);
            return Err(FilesError::Kind { kind, problem });
        }
        let _ = (format.drawn, plane);
    }
    Ok(())
}

impl Finished {
    /// Write `result.nc`, `summary.json` and every kind of file that the case asks for, beside each other; returns
    /// the paths of the last.
    ///
    /// # Errors
    /// [`FilesError`] naming the file; the others are written nevertheless.
    pub fn write(&self) -> Result<Vec<PathBuf>, FilesError> {
        // A thread of its own: it mostly waits for the disk, and the pool's draw meanwhile.
        let (result, files) = std::thread::scope(|scope| {
            let result = scope.spawn(|| {
                self.write_result()?;
                self.summary.write(&self.directory.join("summary.json"))
            });
            let files = self.write_files();
            (result.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)), files)
        });
        result?;
        files
    }

    /// Write every kind of file that the case asks for, beyond `result.nc`, `mass.csv` and `summary.json`; returns
    /// their paths.
    ///
    /// # Errors
    /// [`FilesError`] naming the file.
    pub fn write_files(&self) -> Result<Vec<PathBuf>, FilesError> {
        check_kinds(&self.files, &self.plane)?;
        let asked = |format: &&&Format| self.files.contains(&format.kind);
        let shows_figures = FORMATS.iter().filter(asked).any(|format| format.after_figures);
        let wanted = |format: &&&Format| asked(format) || (shows_figures && format.kind.name == "figures");
        let (last, first): (Vec<&Format>, Vec<&Format>) =
            FORMATS.iter().filter(wanted).copied().partition(|format| format.after_figures);
        let work = Work {
            run: self,
            #[cfg(feature = "figures")]
            story: first.iter().any(|format| format.drawn).then(|| super::Story::of(self)).transpose()?,
            #[cfg(feature = "figures")]
            figures: std::sync::OnceLock::new(),
        };
        // Beside each other; the first error in the order of the list is told.
        let done: Vec<_> = first.par_iter().map(|format| (format.write)(&work)).collect();
        let mut written = Vec::new();
        for files in done.into_iter().chain(last.iter().map(|format| (format.write)(&work))) {
            written.extend(files?);
        }
        Ok(written)
    }
}
