//! A finished run that is taken up: are its files whole, and if not, can they be made again?
//!
//! Its frames are removed with its end, but `result.nc` holds them. With them and the checkpoint before its end the run ends
//! once more, which makes every file anew.

use super::{BeginError, frames_in};
use crate::model::ResultFile;
use crate::output::folder::Folder;
use crate::output::frames::{Field, Frames};
use crate::output::mark::Mark;
use crate::output::summary::Summary;
use crate::output::{self, Precision};
use crate::run::{Run, StopReason};
use granflow_case::RunPlan;
use std::path::Path;

/// What a run that has ended left.
pub(super) struct Left {
    reason: StopReason,
    /// How many files.
    files: usize,
    /// What became of those that are not as it left them, in words; empty where all are.
    lost: String,
}

impl Left {
    /// What the run in a folder left, which ended by `reason` and whose frames are not kept any more.
    pub fn of(folder: &Folder, reason: StopReason) -> Result<Left, output::Error> {
        let (files, lost) = folder.lost()?;
        Ok(Left { reason, files, lost: lost.join(", ") })
    }

    /// All files are as it left them.
    pub fn is_whole(&self) -> bool {
        self.lost.is_empty()
    }

    /// That nothing is left to do for a run that is over by `reason`: an error as well. Where files are lost it says how they are
    /// made again.
    pub fn over(&self, directory: &Path, reason: StopReason) -> BeginError {
        let directory = directory.to_owned();
        if !self.is_whole() {
            let problem = format!(
                "this run has ended ({reason}), {}; but {}, which --resume with the case as it was makes again",
                nothing_left(reason),
                self.lost
            );
            return BeginError::Resume { directory, problem };
        }
        match Summary::read(&directory.join("summary.json")) {
            Ok(summary) => {
                let summary = Box::new(Summary { stop_reason: reason, ..summary });
                BeginError::Ended { directory, files: self.files, summary }
            }
            Err(error) => error.into(),
        }
    }

    /// Put the frames back up to the mark of a checkpoint.
    pub fn put_back(
        &self,
        directory: &Path,
        plan: &RunPlan,
        run: &dyn Run,
        mark: Mark,
    ) -> Result<(), BeginError> {
        let directory = directory.to_owned();
        frames(&directory, run, plan.output.precision, mark).map_err(|refused| match refused {
            Refused::Disk(error) => error.into(),
            Refused::Result(problem) if self.is_whole() => BeginError::Resume { directory, problem },
            Refused::Result(problem) => {
                BeginError::Lost { directory, reason: self.reason, lost: self.lost.clone(), problem }
            }
        })
    }

    /// What is done about lost files, if there are some; where the run goes on it makes all files at its new end.
    /// The checkpoint before the last step is older than what the others are made of: it may be gone for good.
    pub fn notice(&self, goes_on: bool, no_step_back: bool) -> Option<String> {
        let done = match (goes_on, no_step_back) {
            (true, _) => "all files are made anew when this run ends",
            (false, false) => "all files are made again, from result.nc and the checkpoint",
            (false, true) => {
                "all files but the checkpoint before the last step are made again; to a later end this run will go on from its end, \
                 which had cut that step"
            }
        };
        (!self.is_whole()).then(|| format!("{}: {done}", self.lost))
    }
}

/// Why there is nothing left to do for a run that ended so.
pub(super) fn nothing_left(reason: StopReason) -> &'static str {
    match reason {
        StopReason::AtRest => {
            "whatever the end nothing will move again, unless --set changes friction or forest"
        }
        StopReason::EndTime => "there is nothing to go on with; --set time.end=... goes on to a later end",
        _ => "there is nothing to go on with",
    }
}

/// Why there are no frames.
enum Refused {
    /// They cannot be written.
    Disk(output::Error),
    /// `result.nc` does not hold them.
    Result(String),
}

/// Write the frames of `result.nc` up to the mark of the checkpoint, whose checksum says that they are those of then.
fn frames(directory: &Path, run: &dyn Run, precision: Precision, mark: Mark) -> Result<(), Refused> {
    let path = directory.join("result.nc");
    let said = |problem: String| Refused::Result(format!("result.nc: {problem}"));
    if !path.is_file() {
        return Err(said("it is gone, and the frames with it".to_owned()));
    }
    let result = ResultFile::open(&path).map_err(said)?;
    let times = result.whole("time").map_err(said)?;
    let series = run.plane().series();
    let mut frames =
        Frames::create(&frames_in(directory), precision, series.clone()).map_err(Refused::Disk)?;
    let count = usize::try_from(mark.count).unwrap_or(usize::MAX);
    let mut copy = || -> Result<(), Refused> {
        for (instant, time) in times.iter().enumerate().take(count) {
            let fields = series.iter().enumerate();
            let values: Result<Vec<Vec<f64>>, String> = fields
                .map(|(field, Field { name, .. })| stored(&result, run, (field, name), instant))
                .collect();
            let values = values.map_err(said)?;
            let values: Vec<&[f64]> = values.iter().map(Vec::as_slice).collect();
            frames.append(*time, &values).map_err(|error| match error {
                output::Error::Invalid { problem, .. } => said(problem),
                other => Refused::Disk(other),
            })?;
        }
        match frames.mark() == mark {
            true => Ok(()),
            false => Err(said("its series are not those of the run".to_owned())),
        }
    };
    copy().inspect_err(|_| {
        // Half of the frames are none.
        let _ = std::fs::remove_file(frames_in(directory));
    })
}

/// A series at an instant as the frames had it. Cells without terrain, NaN in `result.nc`, hold at all times what they hold in
/// a run that has not begun.
fn stored(
    result: &ResultFile,
    run: &dyn Run,
    (field, name): (usize, &str),
    instant: usize,
) -> Result<Vec<f64>, String> {
    let mut values = result.instant(name, instant, run.plane().dimensions())?;
    if values.iter().any(|value| value.is_nan()) {
        let mut before = vec![0.0; values.len()];
        run.fill(field, 0, &mut before);
        let cells = values.iter_mut().zip(before);
        cells.filter(|(value, _)| value.is_nan()).for_each(|(value, before)| *value = before);
    }
    Ok(values)
}
