//! `granflow run`: a case from its start to its end.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use granflow::case::Case;

use crate::failure::Failure;
use crate::interrupt;
use crate::progress::Progress;

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
    pub fn directory(&self, case: &Case) -> PathBuf {
        let name =
            || Path::new(case.source_name()).file_stem().map_or_else(|| "result".into(), PathBuf::from);
        self.out.clone().unwrap_or_else(name)
    }
}

/// Computes a case and writes its results.
pub fn run(case: &Case, options: &RunOptions) -> Result<(), Failure> {
    let directory = options.directory(case);
    let (_stop, _progress) = (interrupt::listen()?, Progress::new(options.quiet));
    let (threads, resume) = (options.threads.map_or(0, NonZeroUsize::get), options.resume);
    Err(Failure::usage(
        format!(
            "this build reads and checks cases but cannot compute them (asked for {}, threads {threads}, resume {resume})",
            directory.display()
        ),
        "take a build with the solver",
    ))
}
