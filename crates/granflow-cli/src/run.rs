//! `granflow run`: a case from its start to its end.

use std::ffi::OsString;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;

use granflow::Checked;
use granflow::output::summary::StopReason;
use granflow::results::Finished;
use granflow::run::{Run, reached};
use granflow::session::{Options, RunError};
use granflow::sinks::BeginError;

use crate::failure::{Failure, print, tell};
use crate::interrupt;
use crate::progress::{LongWork, Progress};

/// What the command line says about a run.
#[derive(Debug, Clone, Default)]
pub struct RunOptions {
    /// Where the results go.
    pub out: Option<PathBuf>,
    /// Number of threads.
    pub threads: Option<NonZeroUsize>,
    /// Whether to go on from a checkpoint.
    pub resume: bool,
    /// Whether to keep silent.
    pub quiet: bool,
}

impl RunOptions {
    /// The folder of the results: `--out`, else the case's name in the current folder.
    pub fn directory(&self, case: &str) -> PathBuf {
        let name = || Path::new(case).file_stem().map_or_else(|| "result".into(), PathBuf::from);
        self.out.clone().unwrap_or_else(name)
    }
}

/// Computes a case, writes its results and says in one line how it ended. A run that had ended before is left as it is.
pub fn run(case: Checked, options: &RunOptions) -> Result<(), Failure> {
    let text = match attempt(case, options, interrupt::listen()?) {
        Err(RunError::Begin(ended @ BeginError::Ended { .. })) => format!("{ended}\n"),
        done => {
            let finished = judged(done?)?;
            let line = line(&finished);
            finished.close().map_err(RunError::from)?;
            format!("{line}\n")
        }
    };
    if options.quiet { Ok(()) } else { print(&text) }
}

/// How a run ended, in one line.
fn line(finished: &Finished) -> String {
    let summary = &finished.summary;
    format!(
        "{} at time {:.6}, step {}: {} (mass error {:.1e}, {:.2} s)",
        summary.stop_reason,
        summary.time,
        summary.steps,
        finished.directory.display(),
        summary.mass_error,
        summary.wall_seconds
    )
}

/// Computes a case and writes its results, also those of a run that was interrupted.
pub fn compute(case: Checked, options: &RunOptions) -> Result<Finished, Failure> {
    judged(attempt(case, options, interrupt::listen()?)?)
}

/// What takes long before the first step.
pub const SET_UP: &str = "reading the files of the case and setting it up";

fn attempt(case: Checked, options: &RunOptions, stop: &AtomicBool) -> Result<Finished, RunError> {
    let (quiet, ends) = (options.quiet, case.plan().ends);
    let mut progress = Progress::new(quiet, case.plan().ends.time);
    let notice = |text: &str| {
        if !quiet {
            tell(&format!("note: {text}\n"));
        }
    };
    let options = Options {
        directory: options.directory(case.plan().source_name()),
        threads: options.threads.map_or(0, NonZeroUsize::get),
        resume: options.resume,
        command: command(),
        notice: &notice,
    };
    let mut setup = Some(LongWork::new(quiet, SET_UP));
    let mut writing = None;
    let finished = case.compute(&options, stop, &mut |run: &dyn Run| {
        if setup.take().is_some() {
            run.plane().domain.remarks().iter().for_each(|remark| tell(&format!("{remark}\n")));
        }
        progress.show(run);
        if writing.is_none() && reached(run, &ends).is_some() {
            progress.finish();
            writing = Some(LongWork::new(quiet, "writing the files of the run"));
        }
    });
    drop(writing);
    progress.finish();
    finished
}

/// The command, for the history of results.
static COMMAND: OnceLock<String> = OnceLock::new();

/// Notes the command, in which what is no text is marked as such.
pub fn note_command(words: &[OsString]) {
    let words: Vec<_> = words.iter().map(|word| word.to_string_lossy()).collect();
    COMMAND.get_or_init(|| words.join(" "));
}

pub fn command() -> String {
    COMMAND.get().cloned().unwrap_or_default()
}

/// How an interrupted run goes on.
pub const RESUME: &str = "the same command with --resume goes on";

/// A run that was interrupted is a failure, and much in films a warning.
fn judged(finished: Finished) -> Result<Finished, Failure> {
    let summary = &finished.summary;
    for warning in &summary.warnings {
        tell(&format!("warning: {warning}\n"));
    }
    if summary.stop_reason == StopReason::Interrupted {
        return Err(Failure::Interrupted(format!("{}; {RESUME}", line(&finished))));
    }
    Ok(finished)
}
