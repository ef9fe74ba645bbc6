//! `granflow run`: a case from its start to its end.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use granflow::Checked;
use granflow::output::summary::StopReason;
use granflow::results::Finished;
use granflow::run::Run;
use granflow::session::Options;

use crate::failure::{Failure, print};
use crate::interrupt;
use crate::progress::{Progress, Waiting};

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

/// Computes a case, writes its results and says in one line how it ended.
pub fn run(case: Checked, options: &RunOptions) -> Result<(), Failure> {
    let finished = compute(case, options)?;
    if options.quiet { Ok(()) } else { print(&format!("{}\n", line(&finished))) }
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
    let stop = interrupt::listen()?;
    let mut progress = Progress::new(options.quiet, case.plan().ends.time);
    let quiet = options.quiet;
    let options = Options {
        directory: options.directory(case.plan().source_name()),
        threads: options.threads.map_or(0, NonZeroUsize::get),
        resume: options.resume,
        command: std::env::args().collect::<Vec<_>>().join(" "),
    };
    let mut waiting = Some(Waiting::begin(quiet));
    let finished = case.compute(&options, stop, &mut |run: &dyn Run| {
        if waiting.take().is_some() {
            run.plane().domain.remarks().iter().for_each(|remark| eprintln!("{remark}"));
        }
        progress.show(run);
    });
    drop(waiting);
    progress.finish();
    let finished = finished?;
    let summary = &finished.summary;
    for warning in &summary.warnings {
        eprintln!("warning: {warning}");
    }
    if summary.stop_reason == StopReason::Interrupted {
        return Err(Failure::Interrupted(format!("{}; --resume goes on", line(&finished))));
    }
    Ok(finished)
}
