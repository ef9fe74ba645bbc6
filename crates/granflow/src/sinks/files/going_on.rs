//! A run taken up again: where it was interrupted, after its end, or with other parameters.

use super::checkpoints::{self, Taken};
use super::{BeginError, Files, Series, frames_in, ledger_in};
use crate::model::ResultFile;
use crate::output;
use crate::output::checkpoint::Origin;
use crate::output::folder::Folder;
use crate::output::frames::Frames;
use crate::output::ledger::Ledger;
use crate::output::summary::{StopReason, Summary};
use crate::run::{Run, reached};
use crate::watch::Watch;
use granflow_case::{Change, Concerns, RunPlan};
use std::path::Path;

impl Files {
    /// Takes up the files in `folder` at their checkpoint, and puts `run` where it was. With another case the run goes on as far as
    /// [`Change::concerns`] lets it: to a later end from before the step that the old end cut, so that the bits are those of a run
    /// to the later end; with other parameters from its last state.
    ///
    /// # Errors
    /// [`BeginError`]; frames and ledger are then as the checkpoint needs them.
    pub fn resume(
        folder: Folder,
        plan: &RunPlan,
        origin: Origin,
        command: &str,
        run: &mut dyn Run,
    ) -> Result<Files, BeginError> {
        folder.sweep()?;
        let directory = folder.path();
        let refused = |problem: String| BeginError::Resume { directory: directory.to_owned(), problem };
        let saved = checkpoints::file_in(directory);
        if !saved.exists() {
            let error = refused(format!("there is no checkpoint {}", saved.display()));
            folder.abandon();
            return Err(error);
        }
        let mut series = Series::new(Watch::of(plan, run).map_err(Box::new)?, plan.watched.every, run);
        run.stepper_mut().release_buffers();
        let Taken { due, marks, changes, past, ended, .. } = taken_up(directory, plan, &origin, run)?;
        let [frames, ledger] = [frames_in(directory), ledger_in(directory)];
        let result = directory.join("result.nc");
        if !frames.exists() && result.exists() {
            frames_of(&result, &frames, plan, run, marks.frames.count)?;
        }
        let tables = series.paths(directory);
        for path in [&frames, &ledger].into_iter().chain(tables.iter().flatten()) {
            if !path.exists() {
                let problem = format!("{} is gone, which the checkpoint counts on", path.display());
                return Err(refused(problem));
            }
        }
        let (mut frames, _torn) = Frames::open(&frames)?;
        let mut ledger = Ledger::open(&ledger)?;
        frames.truncate_to(marks.frames)?;
        ledger.truncate_to(marks.ledger)?;
        let tables = series.resume(directory, marks.series)?;
        let [frame, line, look] = due.next;
        series.resumed(look, run.time());
        let mut files = Self::over(folder, plan, origin, command, run, (frames, ledger, tables), series)?;
        files.past = past;
        files.schedule.resume([frame, line]);
        if !changes.is_empty() {
            files.go_on(run, &changes, due.every, ended)?;
        }
        Ok(files)
    }

    /// Go on with another case: the state is a frame if the parameters change here, and a checkpoint knows of it.
    fn go_on(
        &mut self,
        run: &mut dyn Run,
        changes: &[Change],
        every: [f64; 2],
        ended: Option<StopReason>,
    ) -> Result<(), BeginError> {
        self.past.events.push(event(run, changes, ended));
        self.past.mixed |= parameters(changes);
        if parameters(changes) && self.written[0] != run.time() {
            self.frame(run)?;
        }
        if every != [self.schedule.every(), self.series.every()] {
            // After the last frame that there is.
            self.schedule.resume([self.written[0], self.written[0]]);
            self.schedule.plan(run);
            self.series.plan(run);
        } else if parameters(changes) {
            self.schedule.plan(run);
        }
        self.checkpoint(run, None)?;
        self.went_on = true;
        Ok(())
    }

    /// Where and how this run went on with another case, in a sentence, if it did.
    #[must_use]
    pub fn went_on(&self) -> Option<&str> {
        self.past.events.last().map(String::as_str).filter(|_| self.went_on)
    }
}

/// What of the friction changes.
fn parameters(changes: &[Change]) -> bool {
    changes.iter().any(|change| change.concerns() == Concerns::Parameters)
}

/// Where a run goes on, and with what.
fn event(run: &dyn Run, changes: &[Change], ended: Option<StopReason>) -> String {
    let unit = run.plane().domain.units().label(" s");
    let (time, step) = (run.time(), run.steps());
    let ended = match ended {
        Some(_) if !parameters(changes) => ", before the step that its end had cut".to_owned(),
        Some(reason) => format!(", where it had ended ({reason})"),
        None => String::new(),
    };
    let changes: Vec<String> = changes.iter().map(ToString::to_string).collect();
    format!("went on at time {time}{unit} (step {step}){ended}: {}", changes.join("; "))
}

/// Puts the run where it goes on, at one of the checkpoints of a folder.
fn taken_up(
    directory: &Path,
    plan: &RunPlan,
    origin: &Origin,
    run: &mut dyn Run,
) -> Result<Taken, BeginError> {
    let refused = |problem: String| BeginError::Resume { directory: directory.to_owned(), problem };
    let (mut saved, last) = checkpoints::read(&checkpoints::file_in(directory), origin, run)?;
    if last.changes.is_empty()
        && last.ended.is_some()
        && let Some(summary) = ended(directory)?
    {
        return Err(BeginError::Ended { directory: directory.to_owned(), summary: Box::new(summary) });
    }
    let other = parameters(&last.changes);
    if other {
        // What rested may move now, and no look has found it still.
        saved.at_rest = false;
        saved.record.flowed = saved.clock[0];
    }
    run.restore(saved).map_err(refused)?;
    if last.ended.is_none() || other {
        return Ok(last);
    }
    if let (Some(reason), Some(summary)) = (reached(run, &plan.ends), ended(directory)?) {
        let summary = Box::new(Summary { stop_reason: reason, ..summary });
        return Err(BeginError::Ended { directory: directory.to_owned(), summary });
    }
    let before = checkpoints::before_end_in(directory);
    if last.ended != Some(StopReason::EndTime) || !before.exists() {
        return Ok(last);
    }
    let (saved, before) = checkpoints::read(&before, origin, run)?;
    run.restore(saved).map_err(refused)?;
    Ok(Taken { ended: last.ended, ..before })
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

/// How the run in a folder ended, where all its files are made and its frames are not kept any more.
fn ended(directory: &Path) -> Result<Option<Summary>, output::Error> {
    let (summary, result) = (directory.join("summary.json"), directory.join("result.nc"));
    if frames_in(directory).exists() || !summary.exists() || !result.exists() {
        return Ok(None);
    }
    Summary::read(&summary).map(Some)
}

/// Makes the store of frames again from the `result.nc` of a run that has ended. Where that has no value (off the terrain) nothing
/// ever changes: there the numbers are those of `run` as it stands.
fn frames_of(
    result: &Path,
    path: &Path,
    plan: &RunPlan,
    run: &dyn Run,
    count: u64,
) -> Result<(), output::Error> {
    let strange = |problem: String| output::Error::invalid(result, problem);
    let file = ResultFile::open(result).map_err(strange)?;
    let fields = run.plane().series();
    let mut frames = Frames::create(path, plan.output.precision, fields.clone())?;
    let times = file.whole("time").map_err(strange)?;
    for (instant, time) in times.into_iter().enumerate().take(count as usize) {
        let read = |number: usize| {
            let mut values = file.instant(&fields[number].name, instant, run.plane().dimensions())?;
            let mut now = vec![0.0; values.len()];
            run.fill(number, 0, &mut now);
            values
                .iter_mut()
                .zip(now)
                .filter(|(value, _)| value.is_nan())
                .for_each(|(value, now)| *value = now);
            Ok(values)
        };
        let values: Vec<Vec<f64>> =
            (0..fields.len()).map(read).collect::<Result<_, String>>().map_err(strange)?;
        let values: Vec<&[f64]> = values.iter().map(Vec::as_slice).collect();
        frames.append(time, &values)?;
    }
    Ok(())
}
