//! What a run leaves: the series, the maps, the ledger, and the files made of them.

mod dataset;
mod error;
mod files;
mod format;
pub(crate) mod formats;
#[cfg(feature = "figures")]
mod story;
mod watched;

pub use crate::model::{Maps, Plane};
pub use dataset::{About, dataset};
pub use error::FilesError;
pub use files::check_kinds;
#[cfg(feature = "figures")]
pub use story::Story;

use crate::output;
use crate::output::folder::Folder;
use crate::output::frames::Frames;
use crate::output::ledger::Entry;
use crate::output::lines::Table;
use crate::output::netcdf::Values;
use crate::output::summary::Summary;
use granflow_case::FileKind;
use std::path::{Path, PathBuf};

/// A run that has ended, with all it leaves.
#[derive(Debug)]
pub struct Finished {
    /// Folder of the results.
    pub directory: PathBuf,
    /// The lock of that folder, for as long as files are made of the run.
    pub folder: Option<Folder>,
    /// Kinds of files that the case asks for.
    pub files: Vec<FileKind>,
    /// The case as it was computed, so that it can be run again.
    pub case: String,
    /// The text of the case as it was written.
    pub case_text: String,
    /// The cells, and what lies under them.
    pub plane: Plane,
    /// The series, on disk.
    pub frames: Frames,
    /// The ledger.
    pub ledger: Vec<Entry>,
    /// Maps of the whole run and of its end, by the names of the model's quantities; x fastest, the first row in
    /// the south.
    pub maps: Maps,
    /// The tables of gauges and of sections, where there are some.
    pub series: [Option<PathBuf>; 2],
    /// The path that the case names.
    pub path: Option<Vec<[f64; 2]>>,
    /// How wide what passes along the path is looked at.
    pub path_width: f64,
    /// The commands that computed it, with their dates, and where it went on with another case.
    pub history: Vec<String>,
    /// The run in numbers.
    pub summary: Summary,
}

impl Finished {
    /// A map by its name.
    #[must_use]
    pub fn map(&self, name: &str) -> Option<&[f64]> {
        self.maps.iter().find(|(known, _)| *known == name).map(|(_, values)| values.as_slice())
    }

    /// Write `result.nc`.
    ///
    /// # Errors
    /// [`output::Error`] naming the file.
    pub fn write_result(&self) -> Result<(), output::Error> {
        let mut frames = self.frames.again()?;
        let stored = frames.fields().iter().map(|field| &field.name);
        let series = stored.map(|name| (name.as_str(), Values::Stored(name.clone()))).collect();
        let about = About {
            title: self.summary.title.clone(),
            history: self.history.join("\n"),
            case: self.case.clone(),
            case_text: self.case_text.clone(),
            scheme: self.summary.scheme.clone(),
            stop_reason: self.summary.stop_reason.to_string(),
            threshold: self.summary.threshold,
        };
        let times = frames.times().to_vec();
        let result = dataset(&self.plane, frames.precision(), times, series, &self.maps, about);
        let path = self.result();
        let mut result = result.map_err(|problem| output::Error::invalid(&path, problem))?;
        for name in ["thickness", "speed", "pressure"].map(|what| format!("duration_{what}_threshold")) {
            let threshold = self.summary.extra(&name);
            result.attributes.extend(threshold.map(|threshold| (name, threshold.to_string())));
        }
        for (table, kind) in self.series.iter().zip([watched::GAUGE, watched::SECTION]) {
            if let Some(table) = table {
                watched::add(&mut result, &kind, Table::read(table)?, self.plane.domain.units());
            }
        }
        result.write(&path, Some(&mut frames))
    }

    /// Remove the frames, of which `result.nc` has a second copy: nothing more is made of the run. One that was interrupted or
    /// that failed keeps them, to go on from its checkpoint.
    ///
    /// # Errors
    /// [`output::Error`] if the disk refuses.
    pub fn close(self) -> Result<Summary, output::Error> {
        use crate::stop_reason::StopReason;
        if !matches!(self.summary.stop_reason, StopReason::Interrupted | StopReason::Failed) {
            let path = self.frames.path().to_owned();
            drop(self.frames);
            output::remove_if_there(&path)?;
        }
        Ok(self.summary)
    }

    /// Path of `result.nc`.
    #[must_use]
    pub fn result(&self) -> PathBuf {
        self.directory.join("result.nc")
    }
    /// Folder of the figures.
    #[must_use]
    pub fn figures(&self) -> PathBuf {
        self.directory.join(Path::new("figures"))
    }
}
