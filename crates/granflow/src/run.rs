//! A run from its case to its end: steps, books, frames, checkpoints, and why it stopped.

mod model;

use crate::case::{self, Case};
use crate::field::Field;
use crate::hadeler_kuttler::scheme::HadelerKuttler;
use crate::observe::Maps;
use crate::output;
use crate::output::checkpoint::{Checkpoint, case_hash};
use crate::output::frames::Frames;
use crate::output::ledger::{Entry, Ledger};
use crate::output::summary::{StopReason, Summary};
use crate::results::{Finished, Plane};
use crate::savage_hutter::Flow;
use crate::savage_hutter::ground::Bed;
use crate::scheme::Scheme;
use crate::setup::{Sand, Scene, SetupError, Visit};
use crate::simulation::{CLOCK, Failure, Simulation};
use model::Model;
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

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

/// Compute a case and write `result.nc`, `summary.json`, `mass.csv`; `stop` ends it at the next step, `report` hears of
/// every step. Figures and further files are made of what is returned ([`Finished`]).
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
    pool.install(|| scene.simulate(case, Work { case, options, scene: &scene, stop, report, clock }))
}

struct Work<'a> {
    case: &'a Case,
    options: &'a Options,
    scene: &'a Scene,
    stop: &'a AtomicBool,
    report: &'a mut (dyn FnMut(&Status) + Send),
    clock: Instant,
}

impl Visit for Work<'_> {
    type Output = Result<Finished, RunError>;

    fn visit<const D: usize, S>(self, simulation: Simulation<D, S>) -> Self::Output
    where
        S: Scheme<D, f64, State = Flow<D, f64>>,
        S::Ground: Bed<D, f64>,
    {
        let (grid, scene) = (simulation.grid(), self.scene);
        let plane = Plane::of(scene, &grid.origin, &grid.size, grid.cells.as_slice());
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
struct Run<'a, 's, const D: usize, S: Scheme<D, f64>> {
    work: Work<'a>,
    simulation: Simulation<D, S>,
    plane: Plane,
    /// The table and its sources, and until when they flow as they do now.
    sand: Option<&'s Sand<D>>,
    pouring: f64,
    frames: Frames,
    ledger: Ledger,
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
    saved: Instant,
    joined: (Instant, f64),
}

impl<'s, const D: usize, S: Model<D>> Run<'_, 's, D, S> {
    fn start<'a>(
        work: Work<'a>,
        mut simulation: Simulation<D, S>,
        plane: Plane,
        sand: Option<&'s Sand<D>>,
    ) -> Result<Run<'a, 's, D, S>, RunError> {
        if S::PEAKS {
            simulation.keep_maps();
        }
        let directory = &work.options.directory;
        let (frame_file, ledger_file) = (frames_in(directory), directory.join("mass.csv"));
        let initial = simulation.totals().volume;
        if work.options.resume {
            let saved = checkpoint_in(directory);
            if !saved.exists() {
                let problem = format!("there is no checkpoint {}", saved.display());
                return Err(RunError::Resume { directory: directory.clone(), problem });
            }
            let checkpoint = Checkpoint::read(&saved, &case_hash(&work.case.text()))?;
            let (mut frames, _torn) = Frames::open(&frame_file)?;
            let mut ledger = Ledger::open(&ledger_file)?;
            let kept = |name: &str| checkpoint.scalar(name).unwrap_or(checkpoint.time);
            frames.truncate_to(kept("last_frame"))?;
            ledger.truncate_to(kept("last_line"))?;
            if let Some(problem) = restore(&mut simulation, &checkpoint) {
                return Err(RunError::Resume { directory: directory.clone(), problem });
            }
            let scalar = |name: &str| checkpoint.scalar(name).unwrap_or(0.0);
            let mut run = Run::new(work, simulation, plane, sand, frames, ledger, initial);
            run.peak_speed = scalar("peak_speed");
            run.peak_energy = scalar("peak_energy");
            run.initial = scalar("initial");
            run.next_frame = scalar("next_frame");
            run.next_line = scalar("next_line");
            return Ok(run);
        }
        output::remove_leftovers(directory)?;
        let frames = Frames::create(&frame_file, work.case.precision(), plane.series())?;
        let ledger = Ledger::create(&ledger_file, plane.exits())?;
        let mut run = Run::new(work, simulation, plane, sand, frames, ledger, initial);
        run.peak_speed = run.simulation.speed();
        run.peak_energy = run.energy;
        run.frame()?;
        run.schedule();
        Ok(run)
    }

    fn new<'a>(
        work: Work<'a>,
        simulation: Simulation<D, S>,
        plane: Plane,
        sand: Option<&'s Sand<D>>,
        frames: Frames,
        ledger: Ledger,
        initial: f64,
    ) -> Run<'a, 's, D, S> {
        let (now, energy) = (Instant::now(), simulation.totals().energy);
        Run {
            work,
            simulation,
            plane,
            sand,
            pouring: f64::NEG_INFINITY,
            frames,
            ledger,
            initial,
            peak_speed: 0.0,
            peak_energy: 0.0,
            energy,
            wet_cells: 0,
            next_frame: f64::INFINITY,
            next_line: f64::INFINITY,
            saved: now,
            joined: (now, 0.0),
        }
    }

    /// Time between frames, where it is set by time.
    fn interval(&self) -> Option<f64> {
        match self.work.case.frames() {
            case::Frames::Every(interval) => Some(interval),
            case::Frames::Steps(_) => None,
            // Nobody knows when a run that ends by itself will end.
            case::Frames::Ends if self.plane.is_terrain() => Some(10.0),
            case::Frames::Ends => Some(1.0),
        }
    }

    /// The frame and the ledger line after the present time.
    fn schedule(&mut self) {
        let half = if self.simulation.is_adaptive() { 0.0 } else { 0.5 * self.simulation.wanted_step() };
        let time = self.simulation.time() + half;
        if let Some(interval) = self.interval() {
            // Multiples of the interval, so that rounding does not add up.
            let after = |interval: f64| {
                let next = ((time / interval).floor() + 1.0) * interval;
                if next - time > 1e-9 * interval { next } else { next + interval }
            };
            self.next_frame = after(interval);
            self.next_line = after(interval / LINES);
        }
    }

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
            let before = (self.simulation.step(), self.simulation.time());
            if let Err(failure) = self.simulation.advance(until) {
                return Err(self.failed(failure, before.1)?);
            }
            self.after_step()?;
        };
        let due = self.written();
        if self.frames.times().last() != Some(&self.simulation.time()) {
            self.frame()?;
        }
        self.checkpoint(due)?;
        let finished = self.finish(reason)?;
        finished.write_result(&self.work.options.command)?;
        finished.summary.write(&finished.directory.join("summary.json"))?;
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
            self.energy = self.simulation.totals().energy;
            self.peak_energy = self.peak_energy.max(self.energy);
        }
        (self.work.report)(&Status { time, step, wet_cells: self.wet_cells, max_speed });
        let by_steps = match self.work.case.frames() {
            case::Frames::Steps(every) => step % every == 0,
            _ => false,
        };
        let half = if self.simulation.is_adaptive() { 0.0 } else { 0.5 * self.simulation.wanted_step() };
        if by_steps || time + half >= self.next_frame {
            self.frame()?;
            self.schedule();
            if self.joined.0.elapsed().as_secs_f64() > (JOIN * self.joined.1).max(CHECKPOINT) {
                let begin = Instant::now();
                self.finish(StopReason::Interrupted)?.write_result(&self.work.options.command)?;
                self.joined = (Instant::now(), begin.elapsed().as_secs_f64());
            }
        } else if time + half >= self.next_line {
            self.line()?;
            let interval = self.interval().unwrap_or(f64::INFINITY) / LINES;
            while self.next_line <= time + half {
                self.next_line += interval;
            }
        }
        if self.saved.elapsed().as_secs_f64() > CHECKPOINT {
            self.checkpoint(self.written())?;
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
        let [u, v, _] = self.simulation.drift();
        sand.equilibrium.is_some() || (!changes && u < rate && v < rate)
    }

    /// Save what there is before the failed step is reported.
    fn failed(&mut self, failure: Failure, time: f64) -> Result<RunError, RunError> {
        // The state after the failed step is worth nothing; the frames and the last checkpoint are.
        let finished = self.finish(StopReason::Interrupted)?;
        finished.write_result(&self.work.options.command)?;
        let time = self.frames.times().last().copied().unwrap_or(time);
        Ok(RunError::Computation { failure, time, saved: finished.directory.join("result.nc") })
    }

    fn line(&mut self) -> Result<(), RunError> {
        if self.written()[1] == self.simulation.time() {
            return Ok(());
        }
        let totals = self.simulation.totals();
        self.wet_cells = totals.wet;
        let out = self.simulation.out();
        let (gone, mass_in) = (output::ledger::sum(out), self.simulation.poured());
        self.ledger.append(Entry {
            time: self.simulation.time(),
            step: self.simulation.step(),
            mass: totals.volume,
            mass_in,
            out,
            mass_error: relative(totals.volume + gone - self.initial - mass_in, self.initial + mass_in),
            wet_cells: totals.wet as u64,
            moving_cells: totals.moving as u64,
            max_speed: if S::PEAKS { totals.speed } else { f64::NAN },
            kinetic_energy: if S::PEAKS { totals.energy } else { f64::NAN },
        })?;
        Ok(())
    }

    /// A frame of the series and its line in the ledger.
    fn frame(&mut self) -> Result<(), RunError> {
        let series = S::frame(&self.simulation, &self.plane);
        let slices: Vec<&[f64]> = series.iter().map(Vec::as_slice).collect();
        self.frames.append(self.simulation.time(), &slices)?;
        self.line()
    }

    /// Times of the last frame and of the last ledger line.
    fn written(&self) -> [f64; 2] {
        let line = self.ledger.entries().last().map(|entry| entry.time);
        [self.frames.times().last().copied(), line].map(|time| time.unwrap_or(f64::NEG_INFINITY))
    }

    /// Save what goes on from here. `due` are the times of the last frame and line that an unbroken run has too: the
    /// frame at which an interrupted run ends goes when it is resumed.
    fn checkpoint(&mut self, due: [f64; 2]) -> Result<(), RunError> {
        let simulation = &self.simulation;
        let mut scalars: Vec<(String, f64)> = vec![
            ("peak_speed".into(), self.peak_speed),
            ("peak_energy".into(), self.peak_energy),
            ("initial".into(), self.initial),
            ("next_frame".into(), self.next_frame),
            ("next_line".into(), self.next_line),
            ("last_frame".into(), due[0]),
            ("last_line".into(), due[1]),
        ];
        scalars.extend(simulation.clock().iter().enumerate().map(|(k, v)| (format!("clock_{k}"), *v)));
        let state = simulation.arrays().parts.iter().enumerate();
        let mut arrays: Vec<(String, Cow<[f64]>)> =
            state.map(|(k, part)| (format!("state_{k}"), Cow::from(part))).collect();
        if let Some(maps) = &simulation.maps {
            arrays.extend(maps.named().map(|(name, map)| (name.to_owned(), Cow::from(map))));
        }
        let checkpoint = Checkpoint {
            case: case_hash(&self.work.case.text()),
            step: simulation.step(),
            time: simulation.time(),
            scalars,
            arrays,
        };
        checkpoint.write(&checkpoint_in(&self.work.options.directory))?;
        self.saved = Instant::now();
        Ok(())
    }

    fn finish(&mut self, stop_reason: StopReason) -> Result<Finished, RunError> {
        let end = S::maps(&mut self.simulation, self.sand);
        let simulation = &self.simulation;
        let totals = simulation.totals();
        let out = simulation.out();
        let (gone, mass_in) = (output::ledger::sum(out), simulation.poured());
        let wall = self.work.clock.elapsed().as_secs_f64();
        let case = self.work.case;
        let maps = simulation.maps.as_ref();
        let stopped = matches!(stop_reason, StopReason::AtRest | StopReason::Steady);
        let direct = self.sand.is_some_and(|sand| sand.equilibrium.is_some());
        let stopping_time = (stopped && !direct).then(|| simulation.time());
        let mut summary = Summary {
            title: case.title.clone(),
            model: case.model.as_str().to_owned(),
            scheme: if direct { "direct" } else { case.scheme.name.as_str() }.to_owned(),
            cells: (self.plane.x.len() * self.plane.y.len().max(1)) as u64,
            steps: simulation.step(),
            time: simulation.time(),
            stop_reason,
            stopping_time,
            mass_initial: self.initial,
            mass_final: totals.volume,
            mass_in,
            mass_out: gone,
            mass_error: relative(totals.volume + gone - self.initial - mass_in, self.initial + mass_in),
            film_volume: totals.film,
            max_speed_final: totals.speed,
            max_speed: self.peak_speed,
            runout: None,
            reach_angle: None,
            wall_seconds: wall,
            cell_updates_per_second: simulation.updates() as f64 / wall,
            threads: rayon::current_num_threads() as u64,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            extra: serde_json::Map::new(),
        };
        for (name, value) in self.plane.exits().iter().zip(out) {
            summary.add(&format!("mass_out_{name}"), value);
        }
        S::sum_up(simulation, self.sand, &mut summary);
        if case.time.until == Some(case::Until::Steady) && !direct {
            summary.add("steady_rate", case.time.steady_rate());
        }
        let unpad = |map: &[f64]| -> Vec<f64> {
            let place = |number| simulation.place(simulation.grid().index(number));
            (0..simulation.grid().count()).map(|number| map[place(number)]).collect()
        };
        let named = maps.into_iter().flat_map(Maps::named).map(|(name, map)| (name, unpad(map)));
        let (frames, _) = Frames::open(self.frames.path())?;
        Ok(Finished::new(
            case,
            self.work.options.directory.clone(),
            self.plane.clone(),
            frames,
            self.ledger.entries().to_vec(),
            named.chain(end).collect(),
            summary,
        ))
    }
}

/// part/whole, and 0 of nothing.
fn relative(part: f64, whole: f64) -> f64 {
    if whole == 0.0 { 0.0 } else { part / whole }
}

fn frames_in(directory: &Path) -> PathBuf {
    directory.join("checkpoint").join("frames.bin")
}

fn checkpoint_in(directory: &Path) -> PathBuf {
    directory.join("checkpoint").join("state.bin")
}

/// Put a checkpoint back; what does not fit, if anything.
fn restore<const D: usize, S: Scheme<D, f64>>(
    simulation: &mut Simulation<D, S>,
    saved: &Checkpoint,
) -> Option<String> {
    let clock: Vec<f64> = (0..CLOCK).map_while(|k| saved.scalar(&format!("clock_{k}"))).collect();
    let part = |k: usize| saved.array(&format!("state_{k}")).map(<[f64]>::to_vec);
    let parts: Vec<Vec<f64>> = (0..simulation.arrays().parts.len()).map_while(part).collect();
    if !simulation.restore(&clock, Field { parts }) {
        return Some("its state has another shape".to_owned());
    }
    if let Some(maps) = &mut simulation.maps {
        for (name, map) in maps.named_mut() {
            match saved.array(name) {
                Some(values) if values.len() == map.len() => map.copy_from_slice(values),
                _ => return Some(format!("its map {name} is missing or has another shape")),
            }
        }
    }
    None
}
