//! A run taken up again: where it was interrupted, after its end, or with other parameters.

use super::checkpoints::{self, Taken};
use super::ended::Left;
use super::{BeginError, Files, Series, frames_in, ledger_in};
use crate::output;
use crate::output::checkpoint::{Checkpoint, Origin};
use crate::output::folder::Folder;
use crate::output::frames::Frames;
use crate::output::ledger::Ledger;
use crate::output::lines::Lines;
use crate::output::summary::StopReason;
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
        watch: Watch,
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
        let mut series = Series::new(watch, plan.watched.every, run);
        run.stepper_mut().release_buffers();
        let (Taken { due, marks, changes, past, ended, .. }, place, left) =
            taken_up(&folder, plan, &origin, run)?;
        let [frames, ledger] = [frames_in(directory), ledger_in(directory)];
        let tables = series.paths(directory);
        let needed = [&frames].into_iter().filter(|_| left.is_none()).chain([&ledger]);
        if let Some(gone) = needed.chain(tables.iter().flatten()).find(|path| !path.exists()) {
            return Err(refused(format!("{} is gone, which the checkpoint counts on", gone.display())));
        }
        // All are looked at before one is changed.
        let mut ledger = Ledger::open(&ledger)?;
        ledger.fits(marks.ledger)?;
        let tables = series.resume(directory, marks.series)?;
        if let Some(left) = &left {
            left.put_back(directory, plan, run, marks.frames)?;
        }
        let (mut frames, _torn) = Frames::open(&frames)?;
        frames.truncate_to(marks.frames)?;
        ledger.truncate_to(marks.ledger)?;
        tables.iter().flatten().try_for_each(Lines::cut)?;
        let [frame, line, look] = due.next;
        series.resumed(look, run.time());
        let no_step_back = left.is_some() && changes.is_empty() && forgotten(directory, &origin, ended)?;
        let mut files = Self::over(folder, plan, origin, command, run, (frames, ledger, tables), series)?;
        (files.past, files.at_end) = (past, place == Place::End && changes.is_empty());
        files.schedule.resume([frame, line]);
        files.notices.extend(left.and_then(|left| left.notice(!changes.is_empty(), no_step_back)));
        if !changes.is_empty() {
            let ended = ended.map(|reason| (reason, place));
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
        ended: Option<(StopReason, Place)>,
    ) -> Result<(), BeginError> {
        let event = event(run, changes, ended);
        self.notices.push(event.clone());
        self.past.events.push(event);
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
        Ok(self.checkpoint(run, None)?)
    }
}

/// Where a run is taken up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    /// In its course.
    Within,
    /// Where it had ended.
    End,
    /// At the checkpoint before the step that its end had cut.
    BeforeEnd,
}

/// Removes the checkpoint before the last step where it cannot be read: it would be refused later, and nothing makes it again.
fn forgotten(directory: &Path, origin: &Origin, ended: Option<StopReason>) -> Result<bool, BeginError> {
    let path = checkpoints::before_end_in(directory);
    if ended != Some(StopReason::EndTime) || (path.exists() && Checkpoint::read(&path, origin).is_ok()) {
        return Ok(false);
    }
    output::remove_if_there(&path)?;
    Ok(true)
}

/// What of the friction changes.
fn parameters(changes: &[Change]) -> bool {
    changes.iter().any(|change| change.concerns() == Concerns::Parameters)
}

/// Where a run goes on, and with what.
fn event(run: &dyn Run, changes: &[Change], ended: Option<(StopReason, Place)>) -> String {
    let unit = run.plane().domain.units().label(" s");
    let (time, step) = (run.time(), run.steps());
    let ended = match ended {
        Some((_, Place::BeforeEnd)) => ", before the step that its end had cut".to_owned(),
        Some((reason, _)) => format!(", where it had ended ({reason})"),
        None => String::new(),
    };
    let changes: Vec<String> = changes.iter().map(ToString::to_string).collect();
    format!("went on at time {time}{unit} (step {step}){ended}: {}", changes.join("; "))
}

/// Puts the run where it goes on, at one of the checkpoints of a folder; says which, and what it left where it has ended.
fn taken_up(
    folder: &Folder,
    plan: &RunPlan,
    origin: &Origin,
    run: &mut dyn Run,
) -> Result<(Taken, Place, Option<Left>), BeginError> {
    let directory = folder.path();
    let refused = |problem: String| BeginError::Resume { directory: directory.to_owned(), problem };
    let (mut saved, last) = checkpoints::read(&checkpoints::file_in(directory), origin, run)?;
    let closed = last.ended.filter(|_| !frames_in(directory).exists());
    let left = closed.map(|reason| Left::of(folder, reason)).transpose()?;
    if last.changes.is_empty()
        && let (Some(reason), Some(left)) = (closed, left.as_ref())
        && left.is_whole()
    {
        return Err(left.over(directory, reason));
    }
    let other = parameters(&last.changes);
    if other {
        // What rested may move now, and no look has found it still.
        saved.at_rest = false;
        saved.record.flowed = saved.clock[0];
    }
    let goes_back = last.ended == Some(StopReason::EndTime) && !other && !last.changes.is_empty();
    let before = checkpoints::before_end_in(directory);
    // Read while the run is as its case makes it: of one saved as it began that is the state.
    let before =
        if goes_back && before.exists() { Some(checkpoints::read(&before, origin, run)?) } else { None };
    run.restore(saved).map_err(refused)?;
    if last.ended.is_none() {
        return Ok((last, Place::Within, left));
    }
    if other || last.changes.is_empty() {
        return Ok((last, Place::End, left));
    }
    if let (Some(reason), Some(left)) = (reached(run, &plan.ends), &left) {
        return Err(left.over(directory, reason));
    }
    let Some((saved, before)) = before else { return Ok((last, Place::End, left)) };
    run.restore(saved).map_err(refused)?;
    Ok((Taken { ended: last.ended, ..before }, Place::BeforeEnd, left))
}
