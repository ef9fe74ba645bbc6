//! From a case to its files: what the program `granflow run` does, as a function.

use crate::output;
use crate::results::{FilesError, Finished, check_kinds};
use crate::run::{DriveError, Failure, Run, drive};
use crate::sinks::{BeginError, Callback, Files, Sink, Stop};
use crate::{Checked, StartError};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// More threads than this only wait for each other.
const MAX_THREADS: usize = 1024;

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
        if options.threads > MAX_THREADS {
            return Err(RunError::Threads(format!("{} are more than {MAX_THREADS}", options.threads)));
        }
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(options.threads)
            .build()
            .map_err(|error| RunError::Threads(error.to_string()))?;
        // The loop itself is one of the pool's threads: a step then needs no queue, and no allocation.
        pool.install(|| self.into_files(options, begun, stop, report))
    }

    fn into_files(
        self,
        Options { directory, resume, command, .. }: &Options,
        begun: Instant,
        stop: &AtomicBool,
        report: &mut (dyn FnMut(&dyn Run) + Send),
    ) -> Result<Finished, RunError> {
        let plan = self.plan().clone();
        let mut run = self.start()?;
        check_kinds(&plan.output.files, run.plane())?;
        let begin = if *resume { Files::resume } else { Files::begin };
        let mut files = begin(directory, &plan, command, &mut *run)?.since(begun);
        let mut report = Callback(report);
        let sinks: &mut [&mut dyn Sink] = &mut [&mut Stop(stop), &mut report, &mut files];
        match drive(&mut *run, &plan.ends, sinks) {
            Ok(reason) => Ok(files.finish(run, reason)?),
            Err(DriveError::Sink(error)) => Err(match error.0.downcast::<output::Error>() {
                Ok(error) => RunError::Output(*error),
                Err(_) => unreachable!("the other sinks have no errors"),
            }),
            Err(DriveError::Step { failure, time }) => {
                let left = files.give_up(run)?;
                let time = left.frames.times().last().copied().unwrap_or(time);
                Err(RunError::Computation { failure, time, saved: left.result() })
            }
        }
    }
}
