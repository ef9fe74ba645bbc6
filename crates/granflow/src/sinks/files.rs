//! The disk as a sink: frames, ledger and checkpoints while a run goes, all files that its case asks for at the end.

mod checkpoints;
mod ending;
mod writer;

use super::schedule::{Due, Schedule};
use super::{Sink, SinkError};
use crate::output;
use crate::output::frames::Frames;
use crate::output::ledger::{Entry, Ledger};
use crate::output::summary::StopReason;
use crate::results::{FilesError, Finished};
use crate::run::Run;
use ending::Ending;
use granflow_case::RunPlan;
use std::path::{Path, PathBuf};
use std::time::Instant;
use writer::Writer;

/// Seconds on the clock between two checkpoints.
const CHECKPOINT: f64 = 30.0;
/// The series are joined into `result.nc` again once this many times the last join's cost has passed.
const JOIN: f64 = 20.0;

/// Why the files of a run could not be begun or taken up again.
#[derive(Debug, thiserror::Error)]
pub enum BeginError {
    /// A file could not be read or written.
    #[error(transparent)]
    Output(#[from] output::Error),
    /// The writing thread could not be started.
    #[error("cannot start the threads: {0}")]
    Thread(String),
    /// The folder holds no checkpoint of this case.
    #[error("cannot resume from {}: {problem}; run without --resume to start again", directory.display())]
    Resume {
        /// The folder.
        directory: PathBuf,
        /// What does not fit.
        problem: String,
    },
}

/// Writes a run into a folder.
pub struct Files {
    directory: PathBuf,
    plan: RunPlan,
    command: String,
    writer: Writer,
    schedule: Schedule,
    /// Times of the last frame and of the last ledger line.
    written: [f64; 2],
    /// When this began on the clock, and the updates of a cell before it.
    begun: Instant,
    updates: u64,
    /// When the last checkpoint was saved, and when the series were last joined and what it cost \[s\]; `None` while they are
    /// being joined.
    saved: Instant,
    joined: Option<(Instant, f64)>,
}

impl Files {
    /// Begins the files of `run` in `directory` with its state as the first frame; what an older run left there goes.
    ///
    /// # Errors
    /// [`BeginError`] naming the file.
    pub fn begin(
        directory: &Path,
        plan: &RunPlan,
        command: &str,
        run: &mut dyn Run,
    ) -> Result<Files, BeginError> {
        remove_leftovers(directory)?;
        // An older checkpoint would belong to other frames.
        output::remove_if_there(&checkpoints::file_in(directory))?;
        let frames = Frames::create(&frames_in(directory), plan.output.precision, run.plane().series())?;
        let ledger = Ledger::create(&ledger_in(directory), run.plane().outlets())?;
        let mut files = Self::over(directory, plan, command, run, frames, ledger)?;
        files.frame(run)?;
        files.schedule.plan(run);
        Ok(files)
    }

    /// Takes up the files in `directory` at their checkpoint, and puts `run` where it was.
    ///
    /// # Errors
    /// [`BeginError`]; frames and ledger are then as the checkpoint needs them.
    pub fn resume(
        directory: &Path,
        plan: &RunPlan,
        command: &str,
        run: &mut dyn Run,
    ) -> Result<Files, BeginError> {
        remove_leftovers(directory)?;
        let refused = |problem: String| BeginError::Resume { directory: directory.to_owned(), problem };
        let saved = checkpoints::file_in(directory);
        if !saved.exists() {
            return Err(refused(format!("there is no checkpoint {}", saved.display())));
        }
        run.stepper_mut().release_buffers();
        let taken = checkpoints::read(&saved, plan, run)?;
        let (mut frames, _torn) = Frames::open(&frames_in(directory))?;
        let mut ledger = Ledger::open(&ledger_in(directory))?;
        frames.truncate_to(taken.written[0])?;
        ledger.truncate_to(taken.written[1])?;
        run.restore(taken.saved).map_err(refused)?;
        let mut files = Self::over(directory, plan, command, run, frames, ledger)?;
        files.schedule.resume(taken.due);
        Ok(files)
    }

    fn over(
        directory: &Path,
        plan: &RunPlan,
        command: &str,
        run: &dyn Run,
        frames: Frames,
        ledger: Ledger,
    ) -> Result<Files, BeginError> {
        let now = Instant::now();
        let line = ledger.entries().last().map(|entry| entry.time);
        let written = [frames.times().last().copied(), line].map(|time| time.unwrap_or(f64::NEG_INFINITY));
        let checkpoint = checkpoints::file_in(directory);
        let writer = Writer::start(frames, ledger, checkpoint, command.to_owned())
            .map_err(|error| BeginError::Thread(error.to_string()))?;
        Ok(Files {
            directory: directory.to_owned(),
            plan: plan.clone(),
            command: command.to_owned(),
            writer,
            schedule: Schedule::new(plan.output.frames, run.plane()),
            written,
            begun: now,
            updates: run.stepper().updates(),
            saved: now,
            joined: Some((now, 0.0)),
        })
    }

    /// Count wall time from then on: reading and setting up take their time too.
    #[must_use]
    pub fn since(mut self, begun: Instant) -> Self {
        self.begun = begun;
        self
    }

    /// A line of the ledger.
    fn line(&mut self, run: &mut dyn Run) -> Result<(), output::Error> {
        if self.written[1] == run.time() {
            return Ok(());
        }
        let entry = Entry::of(run);
        self.written[1] = run.time();
        self.writer.line(entry)
    }

    /// A frame of the series and its line in the ledger.
    fn frame(&mut self, run: &mut dyn Run) -> Result<(), output::Error> {
        let shown = &*run;
        self.writer.frame(run.time(), |field, from, values| shown.fill(field, from, values))?;
        self.written[0] = run.time();
        self.line(run)
    }

    /// A frame that was due, when the next one is, and the series joined if that is worth it.
    fn frame_due(&mut self, run: &mut dyn Run) -> Result<(), output::Error> {
        self.frame(run)?;
        self.schedule.plan(run);
        self.join(run)
    }

    /// Have the series so far joined into `result.nc`, if that is worth its cost again.
    fn join(&mut self, run: &mut dyn Run) -> Result<(), output::Error> {
        if let Some(cost) = self.writer.joined() {
            self.joined = Some((Instant::now(), cost));
        }
        if let Some((last, cost)) = self.joined
            && last.elapsed().as_secs_f64() > (JOIN * cost).max(CHECKPOINT)
        {
            let ending = Ending::of(self, run, StopReason::Interrupted);
            self.writer.join(ending)?;
            self.joined = None;
        }
        Ok(())
    }

    fn step_taken(&mut self, run: &mut dyn Run) -> Result<(), output::Error> {
        self.writer.check()?;
        match self.schedule.due(run) {
            Due::Frame => self.frame_due(run)?,
            Due::Line => self.line(run)?,
            Due::Nothing => {}
        }
        if self.saved.elapsed().as_secs_f64() > CHECKPOINT {
            self.checkpoint(run, self.written)?;
        }
        Ok(())
    }

    /// Save what goes on from here. `written` are the times of the last frame and line that an unbroken run has too: the
    /// frame at which an interrupted run ends goes when it is resumed.
    fn checkpoint(&mut self, run: &dyn Run, written: [f64; 2]) -> Result<(), output::Error> {
        self.writer.checkpoint(&checkpoints::of(run, &self.plan, self.schedule.next(), written))?;
        self.saved = Instant::now();
        Ok(())
    }

    /// Write the last frame and everything that the case asks for. What is done with is given back on the way: to end takes
    /// no more memory than to compute.
    ///
    /// # Errors
    /// [`FilesError`]; what was complete before stays complete.
    pub fn finish(mut self, mut run: Box<dyn Run>, reason: StopReason) -> Result<Finished, FilesError> {
        let written = self.written;
        if written[0] != run.time() {
            self.frame(&mut *run)?;
        }
        self.checkpoint(&*run, written)?;
        let command = self.command.clone();
        let ending = Ending::last(&self, run, reason);
        let (frames, ledger) = self.writer.end()?;
        let finished = ending.finished(frames, ledger.into_entries());
        finished.write(&command)?;
        Ok(finished)
    }

    /// Save the frames before a step that failed; the state after it is worth nothing.
    ///
    /// # Errors
    /// [`output::Error`] naming the file.
    pub fn give_up(self, run: Box<dyn Run>) -> Result<Finished, output::Error> {
        let command = self.command.clone();
        let ending = Ending::last(&self, run, StopReason::Interrupted);
        let (frames, ledger) = self.writer.end()?;
        let finished = ending.finished(frames, ledger.into_entries());
        finished.write_result(&command)?;
        Ok(finished)
    }
}

impl Sink for Files {
    fn next_instant(&self) -> f64 {
        self.schedule.next()[0]
    }
    fn at_instant(&mut self, run: &mut dyn Run) -> Result<(), SinkError> {
        self.frame_due(run).map_err(SinkError::of)
    }
    fn after_step(&mut self, run: &mut dyn Run) -> Result<(), SinkError> {
        self.step_taken(run).map_err(SinkError::of)
    }
}

fn remove_leftovers(directory: &Path) -> Result<(), output::Error> {
    for folder in [directory.to_owned(), directory.join("checkpoint")] {
        output::remove_leftovers(&folder)?;
    }
    Ok(())
}

fn frames_in(directory: &Path) -> PathBuf {
    directory.join("checkpoint").join("frames.bin")
}

fn ledger_in(directory: &Path) -> PathBuf {
    directory.join("mass.csv")
}
