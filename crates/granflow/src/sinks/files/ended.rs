//! A finished run that is to go on: are its files whole, and if not, can they be made again?
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

/// Put the frames back where files of a finished run are lost, and say which; that all are whole is an error as well, for
/// there is nothing to do then.
pub(super) fn taken_up(
    folder: &Folder,
    plan: &RunPlan,
    run: &dyn Run,
    reason: StopReason,
    mark: Mark,
) -> Result<String, BeginError> {
    let directory = folder.path().to_owned();
    let (files, lost) = folder.lost()?;
    if lost.is_empty() {
        let summary = Box::new(Summary::read(&directory.join("summary.json"))?);
        return Err(BeginError::Ended { directory, files, summary });
    }
    let lost = lost.join(", ");
    match frames(&directory, run, plan.output.precision, mark) {
        Ok(()) => Ok(format!("{lost}: all files are made again, from result.nc and the checkpoint")),
        Err(Refused::Disk(error)) => Err(error.into()),
        Err(Refused::Result(problem)) => Err(BeginError::Lost { directory, reason, lost, problem }),
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
