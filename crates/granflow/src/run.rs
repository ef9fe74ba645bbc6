//! A run from its case to its end: steps, books, frames, checkpoints, and why it stopped.

mod ending;
pub mod model;
mod saved;
mod series;
mod writer;

use crate::case::{self, Case};
use crate::hadeler_kuttler::scheme::HadelerKuttler;
use crate::kernels::Kernel;
use crate::output;
use crate::output::summary::StopReason;
use crate::results::{FilesError, Finished, Plane};
use crate::savage_hutter::Flow;
use crate::savage_hutter::ground::Bed;
use crate::setup::{Sand, Scene, SetupError, Visit};
use crate::simulation::{Failure, Simulation};
use model::Model;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use writer::Writer;

/// Ledger lines between two frames.
const LINES: f64 = 10.0;
/// More threads than this only wait for each other.
const MOST_THREADS: usize = 1024;
/// Seconds on the clock between two checkpoints.
const CHECKPOINT: f64 = 30.0;
/// The series are joined into `result.nc` again once this many times the last join's cost has passed.
const JOIN: f64 = 20.0;

/// What is not in the case: where, with how many threads, whether to go on.
#[derive(Debug, Clone)]
pub struct Options {
    /// Folder of the results.
    pub directory: PathBuf,
    /// Threads; 0 takes all cores.
    pub threads: usize,
    /// Go on from the checkpoint in the folder.
    pub resume: bool,
    /// The command, for the history of the result.
    pub command: String,
}

/// Where a run is.
#[derive(Debug, Clone, Copy)]
pub struct Status {
    /// Simulated time.
    pub time: f64,
    /// Steps done.
    pub step: u64,
    /// Cells with a depth, at the last line of `mass.csv`.
    pub wet_cells: usize,
    /// Largest speed along the bed.
    pub max_speed: f64,
}

/// Why a run did not end as its case says.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The case or one of its files cannot be used.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A file of the results could not be read or written.
    #[error(transparent)]
    Output(#[from] output::Error),
    /// A figure or another file could not be made of the run.
    #[error(transparent)]
    Files(#[from] FilesError),
    /// The computation failed; the state before is saved.
    #[error("{failure}; everything up to time {time} is saved in {}", saved.display())]
    Computation {
        /// What happened.
        failure: Failure,
        /// Time of the last saved state.
        time: f64,
        /// Where.
        saved: PathBuf,
    },
    /// The threads could not be started.
    #[error("cannot start the threads: {0}")]
    Threads(String),
    /// The folder holds no checkpoint of this case.
    #[error("cannot resume from {}: {problem}; run without --resume to start anew", directory.display())]
    Resume {
        /// The folder.
        directory: PathBuf,
        /// What does not fit.
        problem: String,
    },
}

/// Compute a case and write its results, with all files that it asks for; `stop` ends it at the next step, `report` hears of
/// every step. More can be made of what is returned.
///
/// # Errors
/// [`RunError`]; what was complete before stays complete.
pub fn run(
    case: &Case,
    options: &Options,
    stop: &AtomicBool,
    report: &mut (dyn FnMut(&Status) + Send),
) -> Result<Finished, RunError> {
    let clock = Instant::now();
    if options.threads > MOST_THREADS {
        return Err(RunError::Threads(format!("{} are more than {MOST_THREADS}", options.threads)));
    }
    let scene = Scene::load(case)?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads)
        .build()
        .map_err(|error| RunError::Threads(error.to_string()))?;
    // The loop itself is one of the pool's threads: a step then needs no queue, and no allocation.
    pool.install(|| scene.simulate(case, Work { case, options, stop, report, clock }))
}

struct Work<'a> {
    case: &'a Case,
    options: &'a Options,
    stop: &'a AtomicBool,
    report: &'a mut (dyn FnMut(&Status) + Send),
    clock: Instant,
}

impl Visit for Work<'_> {
    type Output = Result<Finished, RunError>;

    fn visit<const D: usize, S>(self, plane: Plane, simulation: Simulation<D, S>) -> Self::Output
    where
        S: Model<D> + Kernel<D, State = Flow<D, f64>>,
        S::Ground: Bed<D, f64>,
    {
        Run::start(self, simulation, plane, None)?.go()
    }

    fn visit_sand<const D: usize>(
        self,
        sand: &Sand<D>,
        simulation: Simulation<D, HadelerKuttler>,
    ) -> Self::Output {
        Run::start(self, simulation, sand.plane(), Some(sand))?.go()
    }
}

/// A run under way.
struct Run<'a, 's, const D: usize, S: Kernel<D>> {
    work: Work<'a>,
    simulation: Simulation<D, S>,
    plane: Plane,
    /// The table and its sources, and until when they flow as they do now.
    sand: Option<&'s Sand<D>>,
    pouring: f64,
    writer: Writer,
    /// Times of the last frame and of the last ledger line.
    written: [f64; 2],
    /// Volume at the start.
    initial: f64,
    /// Largest speed, and largest kinetic energy, of the run so far.
    peak_speed: f64,
    peak_energy: f64,
    /// The kinetic energy as it stands, known where the case asks for it.
    energy: f64,
    /// Cells with a depth at the last line of the ledger.
    wet_cells: usize,
    /// Frames and ledger lines due next.
    next_frame: f64,
    next_line: f64,
    /// Time on the clock spent in steps.
    stepping: Duration,
    /// Updates of a cell before this process.
    updates: u64,
    /// When the last checkpoint was saved, and when the series were last joined and what it cost \[s\]; `None` while they are
    /// being joined.
    saved: Instant,
    joined: Option<(Instant, f64)>,
}

impl<const D: usize, S: Model<D>> Run<'_, '_, D, S> {
    fn go(mut self) -> Result<Finished, RunError> {
        let time = self.work.case.time.clone();
        let end = time.end.unwrap_or(f64::INFINITY);
        let reason = loop {
            if let Some(reason) = self.over(&time, end) {
                break reason;
            }
            // A fixed step is never cut for a frame: the frame waits for the step.
            let next = self.pour(end);
            let until = if self.simulation.is_adaptive() { self.next_frame.min(end).min(next) } else { end };
            if !self.simulation.wanted_step().is_finite() && !until.is_finite() {
                break StopReason::AtRest;
            }
            let before = self.simulation.time();
            let begin = Instant::now();
            let advanced = self.simulation.advance(until);
            self.stepping += begin.elapsed();
            if let Err(failure) = advanced {
                return Err(self.failed(failure, before)?);
            }
            self.after_step()?;
        };
        let due = self.written;
        if due[0] != self.simulation.time() {
            self.frame()?;
        }
        self.checkpoint(due)?;
        let options = self.work.options;
        let (ending, writer) = self.into_ending(reason);
        let (frames, ledger) = writer.end()?;
        let finished = ending.finished(frames, ledger.into_entries());
        finished.write(&options.command)?;
        Ok(finished)
    }

    /// Let the sources flow as they will in the next step; the time at which they change.
    fn pour(&mut self, end: f64) -> f64 {
        let Some(sand) = self.sand else { return f64::INFINITY };
        let time = self.simulation.time();
        let adaptive = self.simulation.is_adaptive();
        let after = |time: f64| {
            sand.sources.changes().into_iter().find(|change| *change > time).unwrap_or(f64::INFINITY)
        };
        // The middle of the step: second order where a rate varies, and the better side of a change within a fixed step.
        let half = 0.5 * self.simulation.wanted_step().min(end.min(self.next_frame) - time);
        if sand.sources.is_moving(time) {
            let next = after(time);
            let middle = if adaptive { time + half.min(0.5 * (next - time)) } else { time + half };
            S::pour(&mut self.simulation, sand, middle);
            return next;
        }
        let now = if adaptive { time } else { time + half };
        if now >= self.pouring && sand.equilibrium.is_none() {
            S::pour(&mut self.simulation, sand, now);
            self.pouring = after(now);
        }
        self.pouring
    }

    fn after_step(&mut self) -> Result<(), RunError> {
        let (time, step) = (self.simulation.time(), self.simulation.step());
        let max_speed = self.simulation.speed();
        self.peak_speed = self.peak_speed.max(max_speed);
        if self.work.case.time.stop.is_some() {
            self.simulation.take_sums();
            self.energy = self.simulation.totals().energy;
            self.peak_energy = self.peak_energy.max(self.energy);
        }
        (self.work.report)(&Status { time, step, wet_cells: self.wet_cells, max_speed });
        let by_steps = match self.work.case.frames() {
            case::Frames::Steps(every) => step % every == 0,
            _ => false,
        };
        let half = if self.simulation.is_adaptive() { 0.0 } else { 0.5 * self.simulation.wanted_step() };
        self.writer.check()?;
        if by_steps || time + half >= self.next_frame {
            self.frame()?;
            self.schedule();
            self.join()?;
        } else if time + half >= self.next_line {
            self.line()?;
            let interval = self.interval().unwrap_or(f64::INFINITY) / LINES;
            while self.next_line <= time + half {
                self.next_line += interval;
            }
        }
        if self.saved.elapsed().as_secs_f64() > CHECKPOINT {
            self.checkpoint(self.written)?;
        }
        Ok(())
    }

    /// Why the run is over, if it is.
    fn over(&self, time: &case::Time, end: f64) -> Option<StopReason> {
        let simulation = &self.simulation;
        if self.work.stop.load(Ordering::Relaxed) {
            return Some(StopReason::Interrupted);
        }
        if time.until == Some(case::Until::Steady) && self.is_steady(time.steady_rate()) {
            return Some(StopReason::Steady);
        }
        if time.until == Some(case::Until::Rest) {
            // Where no cell could send a signal (nothing but films), nothing will ever move.
            if simulation.at_rest() || simulation.rate() == 0.0 {
                return Some(StopReason::AtRest);
            }
            if let Some(limit) = time.rest_speed
                && simulation.step() > 1
                && simulation.speed() < limit
            {
                return Some(StopReason::BelowSpeed);
            }
        }
        if let Some(stop) = &time.stop
            && simulation.step() > 0
            && self.peak_energy > 0.0
            && self.energy < stop.kinetic_energy * self.peak_energy
        {
            return Some(StopReason::KineticEnergy);
        }
        if simulation.time() >= end {
            return Some(StopReason::EndTime);
        }
        (time.steps.is_some_and(|steps| simulation.step() >= steps)).then_some(StopReason::Steps)
    }

    /// Nothing changes faster than `rate`, no source will change any more; or the equilibrium was found at once.
    fn is_steady(&self, rate: f64) -> bool {
        let Some(sand) = self.sand else { return false };
        let time = self.simulation.time();
        let changes =
            sand.sources.is_moving(time) || sand.sources.changes().iter().any(|change| *change > time);
        let drift = self.simulation.drift();
        sand.equilibrium.is_some() || (!changes && drift.iter().all(|change| *change < rate))
    }

    /// Save what there is before the failed step, which began at `time`, is reported.
    fn failed(self, failure: Failure, time: f64) -> Result<RunError, RunError> {
        // The state after the failed step is worth nothing; the frames and the last checkpoint are.
        let options = self.work.options;
        let (ending, writer) = self.into_ending(StopReason::Interrupted);
        let (frames, ledger) = writer.end()?;
        let finished = ending.finished(frames, ledger.into_entries());
        finished.write_result(&options.command)?;
        let time = finished.frames.times().last().copied().unwrap_or(time);
        Ok(RunError::Computation { failure, time, saved: finished.result() })
    }
}

/// part/whole, and 0 of nothing.
fn relative(part: f64, whole: f64) -> f64 {
    if whole == 0.0 { 0.0 } else { part / whole }
}
