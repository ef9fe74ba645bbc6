//! From a case to its files: what the program `granflow run` does, as a function.

use crate::inputs::Inputs;
use crate::output;
use crate::output::checkpoint::Origin;
use crate::output::folder::Folder;
use crate::output::inputs::{Input, inputs};
use crate::results::{FilesError, Finished, check_kinds};
use crate::run::{DriveError, Run, drive};
use crate::sinks::{BeginError, Callback, Files, Keep, Kept, Sink, Stop, checkpoints};
use crate::watch::Watch;
use crate::{Checked, StartError};
pub use granflow_case::Change;
use granflow_case::RunPlan;
use rayon::ThreadPool;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// More threads than this only wait for each other.
const MAX_THREADS: usize = 1024;

/// What is not in the case: where, with how many threads, whether to go on.
#[derive(Clone)]
pub struct Options<'a> {
    /// Folder of the results.
    pub directory: PathBuf,
    /// Threads; 0 takes all cores.
    pub threads: usize,
    /// Go on from the checkpoint in the folder.
    pub resume: bool,
    /// The command, for the history of the result.
    pub command: String,
    /// Hears, before the first step, what happened to an earlier run's files.
    pub notice: &'a (dyn Fn(&str) + Sync),
}

/// Why a run did not end as its case says.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The case or one of its files cannot be used.
    #[error(transparent)]
    Start(#[from] StartError),
    /// The files of the run could not be begun or taken up again.
    #[error(transparent)]
    Begin(#[from] BeginError),
    /// A file of the results could not be read or written.
    #[error(transparent)]
    Output(#[from] output::Error),
    /// A figure or another file could not be made of the run.
    #[error(transparent)]
    Files(#[from] FilesError),
    /// The computation failed, or its results break a law of their own; the state before is saved.
    #[error("{failure}; everything up to time {time} is saved in {}", saved.display())]
    Computation {
        /// What happened: a [`Failure`](crate::run::Failure) or a [`Broken`](crate::run::Broken).
        failure: Box<DriveError>,
        /// Time of the last saved state.
        time: f64,
        /// Where.
        saved: PathBuf,
    },
    /// The same of a run in memory: nothing is saved.
    #[error("{failure}")]
    Failed {
        /// What happened.
        failure: Box<DriveError>,
        /// Time that was reached.
        time: f64,
    },
    /// The threads could not be started.
    #[error("cannot start the threads: {0}")]
    Threads(String),
}

/// So many threads for a run; 0 takes all cores.
///
/// # Errors
/// [`RunError::Threads`].
pub fn threads(number: usize) -> Result<ThreadPool, RunError> {
    if number > MAX_THREADS {
        return Err(RunError::Threads(format!("{number} are more than {MAX_THREADS}")));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(number).build();
    pool.map_err(|error| RunError::Threads(error.to_string()))
}

impl Checked {
    /// Compute the case and write its results into a folder, with all files that it asks for; `stop` ends it at the next
    /// step, `report` hears of every step. More can be made of what is returned.
    ///
    /// # Errors
    /// [`RunError`]; what was complete before stays complete.
    pub fn compute(
        self,
        options: &Options,
        stop: &AtomicBool,
        report: &mut (dyn FnMut(&dyn Run) + Send),
    ) -> Result<Finished, RunError> {
        let begun = Instant::now();
        // The loop itself is one of the pool's threads: a step then needs no queue, and no allocation.
        threads(options.threads)?.install(|| self.into_files(options, begun, stop, report))
    }

    /// Compute the case and keep in memory what its `result.nc` would hold; no file is written. Threads, `stop` and `report` as
    /// for [`Checked::compute`].
    ///
    /// # Errors
    /// [`RunError`].
    pub fn compute_in_memory(
        self,
        number: usize,
        stop: &AtomicBool,
        report: &mut (dyn FnMut(&dyn Run) + Send),
    ) -> Result<Kept, RunError> {
        let begun = Instant::now();
        threads(number)?.install(|| {
            let (plan, inputs) = (self.plan().clone(), self.inputs().clone());
            let mut run = self.start()?;
            let watch = Watch::of(&plan, &inputs, &*run)?;
            let mut keep = Keep::begin(&plan, begun, watch, &mut *run);
            let mut report = Callback(report);
            let sinks: &mut [&mut dyn Sink] = &mut [&mut Stop(stop), &mut report, &mut keep];
            match drive(&mut *run, &plan.ends, sinks) {
                Ok(reason) => Ok(keep.finish(run, reason)?),
                Err(failure) => Err(RunError::Failed { failure: Box::new(failure), time: run.time() }),
            }
        })
    }

    fn into_files(
        self,
        Options { directory, resume, command, notice, .. }: &Options,
        begun: Instant,
        stop: &AtomicBool,
        report: &mut (dyn FnMut(&dyn Run) + Send),
    ) -> Result<Finished, RunError> {
        let (plan, inputs) = (self.plan().clone(), self.inputs().clone());
        let folder = Folder::take(directory)?;
        // Looked at before anything is read: what changes while it is being read is noticed by the next resume.
        let started = origin(&plan, &inputs).map_err(RunError::from).and_then(|origin| {
            let run = self.start()?;
            check_kinds(&plan.output.files, run.plane())?;
            let watch = Watch::of(&plan, &inputs, &*run)?;
            watch.notes.iter().for_each(|note| notice(note));
            Ok((origin, watch, run))
        });
        let (origin, watch, mut run) = match started {
            Ok(started) => started,
            Err(error) => {
                folder.abandon();
                return Err(error);
            }
        };
        let begin = if *resume { Files::resume } else { Files::begin };
        if !resume && let Some(moved) = folder.clear()? {
            notice(&moved.to_string());
        }
        let mut files = begin(folder, &plan, origin, command, watch, &mut *run)?.since(begun);
        files.notices().for_each(notice);
        let mut report = Callback(report);
        let sinks: &mut [&mut dyn Sink] = &mut [&mut Stop(stop), &mut report, &mut files];
        match drive(&mut *run, &plan.ends, sinks) {
            Ok(reason) => Ok(files.finish(run, reason)?),
            Err(DriveError::Sink(error)) => Err(match error.0.downcast::<output::Error>() {
                Ok(error) => RunError::Output(*error),
                Err(_) => unreachable!("the other sinks have no errors"),
            }),
            Err(failure) => {
                let time = run.time();
                let left = files.give_up(run, &failure.to_string())?;
                let time = left.frames.times().last().copied().unwrap_or(time);
                Err(RunError::Computation { failure: Box::new(failure), time, saved: left.result() })
            }
        }
    }
}

/// Write the state of a run to a file, whole or not at all: [`restore`] goes on from it with the same bits.
///
/// # Errors
/// [`output::Error`] if the disk refuses; an older file then remains.
pub fn save(run: &mut dyn Run, origin: &Origin, path: &Path) -> Result<(), output::Error> {
    run.stepper_mut().show_end();
    checkpoints::write(run, origin, path)
}

/// Go on from a state that [`save`] wrote, or from the `checkpoint/state.bin` of a run in a folder; returns what differs between the
/// case of then and the one of `origin`, such as the friction.
///
/// # Errors
/// [`BeginError`] naming the file: it cannot be read, it is damaged, or it is of another case, other inputs or another version.
pub fn restore(run: &mut dyn Run, origin: &Origin, path: &Path) -> Result<Vec<Change>, BeginError> {
    let (saved, changes) = checkpoints::take(path, origin, run)?;
    run.restore(saved).map_err(|problem| output::Error::mismatch(path, problem))?;
    Ok(changes)
}

/// What the run of a case is made of: the case, and what is in the files it names, on the disk or in memory.
///
/// # Errors
/// [`output::Error`] naming a file that cannot be read.
pub fn origin(plan: &RunPlan, memory: &Inputs) -> Result<Origin, output::Error> {
    let held = |path: &PathBuf| memory.fingerprint(path).is_some();
    let (held, files): (Vec<_>, Vec<_>) = plan.inputs.iter().cloned().partition(held);
    let mut inputs = inputs(&files, |path| plan.as_written(path))?;
    inputs.extend(held.iter().filter_map(|path| {
        let (bytes, crc) = memory.fingerprint(path)?;
        Some(Input { name: plan.as_written(path).display().to_string(), bytes, crc })
    }));
    Ok(Origin { case: plan.resolved(), inputs })
}
