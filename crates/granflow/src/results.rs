//! What a run leaves: the series, the maps, the ledger, and the files made of them.

mod contents;
mod dataset;
mod error;
mod files;
mod format;
pub(crate) mod formats;
pub(crate) mod numbers;
mod series;
#[cfg(feature = "figures")]
mod story;
mod watched;

pub use crate::model::{Maps, Plane};
pub(crate) use contents::Contents;
pub use dataset::{About, dataset};
pub use error::FilesError;
pub use files::check_kinds;
pub use series::Numbers;
#[cfg(feature = "figures")]
pub use story::Story;

use crate::output;
use crate::output::folder::Folder;
use crate::output::frames::Frames;
use crate::output::ledger::Entry;
use crate::output::lines::Table;
use crate::output::netcdf::{Dataset, Values};
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
        self.dataset()?.write(&self.result(), Some(&mut self.frames.again()?))
    }

    /// All that `result.nc` says. The numbers of its series are on the disk, where [`Values::Stored`] names them; [`Finished::series`]
    /// reads them.
    ///
    /// # Errors
    /// [`output::Error`] naming a file that cannot be read, or that does not fit the others.
    pub fn dataset(&self) -> Result<Dataset<'_>, output::Error> {
        let frames = &self.frames;
        let names = frames.fields().iter().map(|field| field.name.as_str());
        let series = names.map(|name| (name, Values::Stored(name.to_owned()))).collect();
        let table = |path: &Option<PathBuf>| path.as_deref().map(Table::read).transpose();
        let tables = [table(&self.series[0])?, table(&self.series[1])?];
        let contents = Contents {
            plane: &self.plane,
            precision: frames.precision(),
            times: frames.times().to_vec(),
            series,
            maps: &self.maps,
            tables,
            summary: &self.summary,
            case: [&self.case, &self.case_text],
        };
        contents
            .dataset(self.history.join("\n"))
            .map_err(|problem| output::Error::invalid(&self.result(), problem))
    }

    /// A series at all instants, the first one first; nothing where there is none of this name.
    ///
    /// # Errors
    /// [`output::Error`] if the frames cannot be read.
    pub fn series(&self, name: &str) -> Result<Option<Numbers>, output::Error> {
        let Some(field) = self.frames.position(name) else { return Ok(None) };
        let mut frames = self.frames.again()?;
        let mut numbers = Numbers::none(frames.precision());
        for frame in 0..frames.times().len() {
            let values = frames.read(frame, field)?;
            numbers.extend(values.len(), |from, part| part.copy_from_slice(&values[from..][..part.len()]));
        }
        Ok(Some(numbers))
    }

    /// List the files that the run left ([`Folder::list`]) and remove the frames, of which `result.nc` has a second copy:
    /// nothing more is made of the run. One that was interrupted or that failed keeps them, to go on from its checkpoint.
    ///
    /// # Errors
    /// [`output::Error`] if the disk refuses.
    pub fn close(self) -> Result<Summary, output::Error> {
        use crate::stop_reason::StopReason;
        if !matches!(self.summary.stop_reason, StopReason::Interrupted | StopReason::Failed) {
            if let Some(folder) = &self.folder {
                folder.list()?;
            }
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
