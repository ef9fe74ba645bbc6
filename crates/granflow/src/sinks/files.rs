//! The disk as a sink: frames, ledger and checkpoints while a run goes, all files that its case asks for at the end.

pub(crate) mod checkpoints;
mod ended;
mod ending;
mod going_on;
mod writer;

use super::schedule::{Due, Schedule};
use super::series::Series;
use super::{Sink, SinkError};
use crate::output;
use crate::output::checkpoint::{Checkpoint, Origin, Past};
use crate::output::folder::Folder;
use crate::output::frames::Frames;
use crate::output::ledger::{Entry, Ledger};
use crate::output::lines::Lines;
use crate::output::netcdf::history;
use crate::output::summary::{StopReason, Summary};
use crate::results::numbers::Start;
use crate::run::{Run, check_state};
use crate::watch::Watch;
use checkpoints::Due as DueBeside;
use ending::Ending;
use granflow_case::RunPlan;
use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime};
use writer::Writer;

/// Seconds on the clock from the first step to the checkpoint after it, and between two at most; the pause doubles from one
/// to the next.
const PAUSES: [f64; 2] = [0.8, 30.0];
/// A checkpoint is saved again once this many times the last one's cost has passed.
const CHECKPOINT: f64 = 50.0;
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
    /// The run in the folder has ended, and nothing of it is left to do.
    #[error(
        "{}: this run has ended ({}), and all {files} files that it left are whole; {}",
        directory.display(), summary.stop_reason, ended::nothing_left(summary.stop_reason)
    )]
    Ended {
        /// The folder.
        directory: PathBuf,
        /// How many files it left.
        files: usize,
        /// How it ended.
        summary: Box<Summary>,
    },
    /// The run in the folder has ended, files of it are lost or changed, and they cannot be made again.
    #[error(
        "{}: this run has ended ({reason}), but {lost}, and they cannot be made again: {problem}; put them back as they were, or compute the run anew by the same command without --resume, which moves what is here into previous/",
        directory.display()
    )]
    Lost {
        /// The folder.
        directory: PathBuf,
        /// How it ended.
        reason: StopReason,
        /// What became of which files.
        lost: String,
        /// Why they cannot be made again.
        problem: String,
    },
}

/// Writes a run into a folder.
pub struct Files {
    plan: RunPlan,
    origin: Origin,
    /// The commands before this one, and where the run went on with another case.
    past: Past,
    /// It was taken up at its end, and stands there: its checkpoints are what they must be.
    at_end: bool,
    command: String,
    writer: Writer,
    /// Behind the writer: its lock goes when all is written.
    folder: Folder,
    schedule: Schedule,
    series: Series,
    /// Times of the last frame and of the last ledger line.
    written: [f64; 2],
    start: Start,
    /// Frames so far.
    count: u64,
    /// The step after which everything was shown; while instants within a step are being shown it is the one before.
    shown: u64,
    /// When the last checkpoint was ordered, what it cost the steps \[s\], whether it is still being written, and the pause
    /// until the next.
    saved: Instant,
    cost: f64,
    saving: bool,
    pause: f64,
    /// When the series were last joined and what it cost \[s\]; `None` while they are being joined.
    joined: Option<(Instant, f64)>,
    /// What happened to the run and its files before the first step.
    notices: Vec<String>,
}

impl Files {
    /// Begins the files of `run` in `folder` with its state as the first frame; what an earlier run left there is to be moved
    /// before ([`Folder::clear`]).
    ///
    /// # Errors
    /// [`BeginError`] naming the file.
    pub fn begin(
        folder: Folder,
        plan: &RunPlan,
        origin: Origin,
        command: &str,
        watch: Watch,
        run: &mut dyn Run,
    ) -> Result<Files, BeginError> {
        folder.sweep()?;
        let directory = folder.path();
        let frames = Frames::create(&frames_in(directory), plan.output.precision, run.plane().series())?;
        let ledger = Ledger::create(&ledger_in(directory), run.plane().outlets())?;
        let series = Series::new(watch, plan.watched.every, run);
        let tables = series.create(directory)?;
        let mut files = Self::over(folder, plan, origin, command, run, (frames, ledger, tables), series)?;
        files.frame(run)?;
        files.schedule.plan(run);
        files.series.plan(run);
        // From the first instant on a run that is killed goes on; what it begins with its case makes again.
        let begin = Checkpoint { arrays: Vec::new(), ..files.state(run, None)? };
        files.save(&begin)?;
        Ok(files)
    }

    fn over(
        folder: Folder,
        plan: &RunPlan,
        origin: Origin,
        command: &str,
        run: &dyn Run,
        (frames, ledger, tables): (Frames, Ledger, [Option<Lines>; 2]),
        series: Series,
    ) -> Result<Files, BeginError> {
        let now = Instant::now();
        let line = ledger.entries().last().map(|entry| entry.time);
        let written = [frames.times().last().copied(), line].map(|time| time.unwrap_or(f64::NEG_INFINITY));
        let checkpoint = checkpoints::file_in(folder.path());
        let count = frames.times().len() as u64;
        let writer = Writer::start(frames, ledger, tables, checkpoint)
            .map_err(|error| BeginError::Thread(error.to_string()))?;
        Ok(Files {
            folder,
            plan: plan.clone(),
            origin,
            past: Past::default(),
            at_end: false,
            command: history(SystemTime::now(), command),
            writer,
            schedule: Schedule::new(plan.output.frames, run.plane()),
            series,
            written,
            start: Start { at: now, updates: run.stepper().updates() },
            count,
            shown: run.steps(),
            saved: now,
            cost: 0.0,
            saving: false,
            pause: PAUSES[0],
            joined: Some((now, 0.0)),
            notices: Vec::new(),
        })
    }

    /// What happened to an earlier run and its files when this one took them up, in sentences.
    pub fn notices(&self) -> impl Iterator<Item = &str> {
        self.notices.iter().map(String::as_str)
    }

    /// How the run came to where it stands, this command among it.
    fn past_and_now(&self) -> Past {
        let mut past = self.past.clone();
        past.commands.push(self.command.clone());
        past
    }

    /// Count wall time from then on: reading and setting up take their time too.
    #[must_use]
    pub fn since(mut self, begun: Instant) -> Self {
        self.start.at = begun;
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
        if self.count >= granflow_case::Frames::MOST {
            let problem = format!(
                "the run has written {} frames and would go on; start again with a larger output.every or output.steps",
                self.count
            );
            return Err(output::Error::invalid(&frames_in(self.folder.path()), problem));
        }
        self.count += 1;
        let shown = &*run;
        self.writer.frame(run.time(), |field, from, values| shown.fill(field, from, values))?;
        self.written[0] = run.time();
        self.series.look(run);
        self.hand_over()?;
        self.line(run)
    }

    /// Give the writer the lines of gauges and sections that are held.
    fn hand_over(&mut self) -> Result<(), output::Error> {
        self.series.take().map_or(Ok(()), |lines| self.writer.series(lines))
    }

    /// Look at gauges and sections.
    fn look(&mut self, run: &dyn Run) -> Result<(), output::Error> {
        self.series.look(run);
        if self.series.is_full() { self.hand_over() } else { Ok(()) }
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
            && last.elapsed().as_secs_f64() > (JOIN * cost).max(PAUSES[1])
        {
            self.hand_over()?;
            let ending = Ending::of(self, run, StopReason::Interrupted);
            self.writer.join(ending)?;
            self.joined = None;
        }
        Ok(())
    }

    fn step_taken(&mut self, run: &mut dyn Run, due: Due) -> Result<(), output::Error> {
        self.writer.check()?;
        if self.series.is_every_step() {
            self.look(run)?;
        }
        match due {
            Due::Frame => self.frame_due(run)?,
            Due::Line => self.line(run)?,
            Due::Nothing => {}
        }
        (self.shown, self.at_end) = (run.steps(), false);
        if let Some(beside) = self.writer.saved() {
            self.cost += beside;
            self.saving = false;
        }
        if !self.saving && self.saved.elapsed().as_secs_f64() > self.pause.max(CHECKPOINT * self.cost) {
            self.pause = (2.0 * self.pause).min(PAUSES[1]);
            self.checkpoint(run, None)?;
        }
        Ok(())
    }

    /// Save what goes on from here, with every frame and line so far.
    fn checkpoint(&mut self, run: &dyn Run, ended: Option<StopReason>) -> Result<(), output::Error> {
        let state = self.state(run, ended)?;
        self.save(&state)
    }

    /// What goes on from here; every frame and line so far is handed over.
    fn state<'a>(
        &mut self,
        run: &'a dyn Run,
        ended: Option<StopReason>,
    ) -> Result<Checkpoint<'a>, output::Error> {
        self.saved = Instant::now();
        self.hand_over()?;
        let [frame, line] = self.schedule.next();
        let due = DueBeside {
            next: [frame, line, self.series.next()],
            every: [self.schedule.every(), self.series.every()],
        };
        let past = self.past_and_now();
        Ok(checkpoints::of(run, (&self.origin, &past), due, ended))
    }

    fn save(&mut self, checkpoint: &Checkpoint) -> Result<(), output::Error> {
        self.writer.checkpoint(checkpoint)?;
        (self.cost, self.saving) = (self.saved.elapsed().as_secs_f64(), true);
        Ok(())
    }
}

impl Sink for Files {
    fn next_instant(&self) -> f64 {
        self.schedule.next()[0].min(self.series.next())
    }
    fn at_instant(&mut self, run: &mut dyn Run) -> Result<(), SinkError> {
        let instant = self.next_instant();
        if self.series.next() == instant {
            self.look(run).map_err(SinkError::of)?;
            self.series.plan(run);
        }
        if self.schedule.next()[0] > instant {
            return Ok(());
        }
        check_state(run).map_err(SinkError::of)?;
        self.frame_due(run).map_err(SinkError::of)
    }
    fn after_step(&mut self, run: &mut dyn Run) -> Result<(), SinkError> {
        let due = self.schedule.due(run);
        if due == Due::Frame {
            check_state(run).map_err(SinkError::of)?;
        }
        self.step_taken(run, due).map_err(SinkError::of)
    }
}

fn frames_in(directory: &Path) -> PathBuf {
    directory.join("checkpoint").join("frames.bin")
}

fn ledger_in(directory: &Path) -> PathBuf {
    directory.join("mass.csv")
}
