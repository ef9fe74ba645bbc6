//! A run as it ends: maps, figures, and why.

use super::{Files, checkpoints};
use crate::model::Plane;
use crate::output;
use crate::output::folder::Folder;
use crate::output::frames::Frames;
use crate::output::summary::{StopReason, Summary};
use crate::results::numbers;
use crate::results::{FilesError, Finished};
use crate::run::{Entry, Maps, Run};
use granflow_case::FileKind;
use std::path::PathBuf;

/// A finished run but for its series and its ledger, which the writer has.
#[derive(Debug)]
pub(super) struct Ending {
    directory: PathBuf,
    files: Vec<FileKind>,
    case: String,
    case_text: String,
    plane: Plane,
    maps: Maps,
    series: [Option<PathBuf>; 2],
    path: Option<Vec<[f64; 2]>>,
    path_width: f64,
    history: Vec<String>,
    summary: Summary,
}

impl Ending {
    /// What there is now.
    pub fn of(files: &Files, run: &mut dyn Run, reason: StopReason) -> Ending {
        let end = run.maps();
        let mut maps = run.peaks();
        maps.extend(end);
        Ending::with(files, run.place(), maps, summary(files, run, reason))
    }

    /// What there is at the end.
    pub fn last(files: &Files, mut run: Box<dyn Run>, reason: StopReason) -> Ending {
        run.stepper_mut().release_buffers();
        let end = run.maps();
        let summary = summary(files, &*run, reason);
        let plane = run.place();
        let mut maps = run.into_peaks();
        maps.extend(end);
        Ending::with(files, plane, maps, summary)
    }

    fn with(files: &Files, plane: Plane, maps: Maps, summary: Summary) -> Ending {
        let past = files.past_and_now();
        Ending {
            directory: files.folder.path().to_owned(),
            files: files.plan.output.files.clone(),
            case: files.plan.resolved(),
            case_text: files.plan.text(),
            plane,
            maps,
            series: files.series.paths(files.folder.path()),
            path: files.series.path(),
            path_width: files.plan.output.path_width,
            history: past.commands.into_iter().chain(past.events).collect(),
            summary,
        }
    }

    /// Say in the summary why the run failed.
    pub fn explain(&mut self, failure: &str) {
        self.summary.extra.insert("failure".to_owned(), failure.into());
    }

    /// Put it together; `folder` keeps its lock for as long as files are made.
    pub fn finished(self, folder: Option<Folder>, frames: Frames, ledger: Vec<Entry>) -> Finished {
        let Ending {
            directory,
            files,
            case,
            case_text,
            plane,
            mut maps,
            series,
            path,
            path_width,
            history,
            mut summary,
        } = self;
        numbers::complete(&plane, &mut maps, &mut summary);
        Finished {
            directory,
            folder,
            files,
            case,
            case_text,
            plane,
            frames,
            ledger,
            maps,
            series,
            path,
            path_width,
            history,
            summary,
        }
    }
}

impl Files {
    /// Save the state at the end; of one that the end may have cut the checkpoint before it too.
    fn last_checkpoint(&mut self, run: &dyn Run, reason: StopReason) -> Result<(), output::Error> {
        let before_end = checkpoints::before_end_in(self.folder.path());
        if reason == StopReason::EndTime {
            self.writer.keep(before_end)?;
        } else {
            output::remove_if_there(&before_end)?;
        }
        // Before the last frame: where an interrupted run ends an unbroken one has none.
        self.checkpoint(run, Some(reason).filter(|reason| *reason != StopReason::Interrupted))
    }

    /// Write the last frame and everything that the case asks for. What is done with is given back on the way: to end takes
    /// no more memory than to compute. A run that was interrupted within a step, between two instants of it, goes on from the
    /// checkpoint before that step.
    ///
    /// # Errors
    /// [`FilesError`]; what was complete before stays complete.
    pub fn finish(mut self, mut run: Box<dyn Run>, reason: StopReason) -> Result<Finished, FilesError> {
        if self.shown == run.steps() {
            if !self.at_end {
                self.last_checkpoint(&*run, reason)?;
            }
            if self.written[0] != run.time() {
                self.frame(&mut *run)?;
            }
        }
        self.hand_over()?;
        let ending = Ending::last(&self, run, reason);
        let (frames, ledger) = self.writer.end()?;
        let finished = ending.finished(Some(self.folder), frames, ledger.into_entries());
        finished.write()?;
        Ok(finished)
    }

    /// Save the frames before a step that failed, and say in `summary.json` that and why it did; the state after it is worth
    /// nothing.
    ///
    /// # Errors
    /// [`output::Error`] naming the file.
    pub fn give_up(mut self, run: Box<dyn Run>, failure: &str) -> Result<Finished, output::Error> {
        self.hand_over()?;
        let mut ending = Ending::last(&self, run, StopReason::Failed);
        ending.explain(failure);
        let (frames, ledger) = self.writer.end()?;
        let finished = ending.finished(Some(self.folder), frames, ledger.into_entries());
        finished.write_result()?;
        finished.summary.write(&finished.directory.join("summary.json"))?;
        Ok(finished)
    }
}

fn summary(files: &Files, run: &dyn Run, reason: StopReason) -> Summary {
    let mut summary = numbers::summary(&files.plan, run, reason, files.start);
    numbers::went_on(&files.past, &mut summary);
    summary
}
