//! How the program fails: the message and the exit status, in one place.

use std::io::{self, Write};
use std::path::Path;

use granflow::StartError;
use granflow::case::{CaseError, CaseErrorKind, short_numbers};
use granflow::compare::CompareError;
use granflow::results::FilesError;
use granflow::session::RunError;
use granflow::sinks::BeginError;

use crate::plain::plain;
use crate::snippet::{self, Ink};

/// Why a command did not do what it was asked.
#[derive(Debug)]
pub enum Failure {
    /// What was computed is not what it should be (exit status 1).
    Verdict(String),
    /// The command line makes no sense (exit status 2).
    Usage {
        /// What was found.
        message: String,
        /// What to do.
        cure: String,
    },
    /// The case is wrong (2), or a file it needs cannot be read (4).
    Case(CaseError),
    /// The computation failed; the message names the state that was saved (3).
    Computation(String),
    /// A file could not be read or written (4).
    File(String),
    /// Ctrl-C; everything written so far is valid (130).
    Interrupted(String),
}

impl Failure {
    /// A command line that makes no sense.
    pub fn usage(message: impl Into<String>, cure: impl Into<String>) -> Self {
        Self::Usage { message: message.into(), cure: cure.into() }
    }

    /// A file that could not be read or written; `doing` is "read", "write" ...
    pub fn file(doing: &str, path: &Path, error: &io::Error) -> Self {
        Self::File(format!("cannot {doing} {}: {error}", path.display()))
    }

    /// The exit status of the program.
    fn status(&self) -> u8 {
        match self {
            Self::Verdict(_) => 1,
            Self::Usage { .. } => 2,
            Self::Case(error) => match error.kind() {
                CaseErrorKind::Invalid => 2,
                CaseErrorKind::File => 4,
            },
            Self::Computation(_) => 3,
            Self::File(_) => 4,
            Self::Interrupted(_) => 130,
        }
    }

    /// Prints the failure on standard error and gives the exit status.
    pub fn report(self) -> u8 {
        let status = self.status();
        match self {
            Self::Usage { message, cure } => tell(&format!("error: {message}\n  help: {cure}\n")),
            Self::Case(error) => send(&snippet::shown(&error, Ink::of_standard_error())),
            Self::Verdict(message) | Self::Computation(message) | Self::File(message) => {
                tell(&format!("error: {message}\n"));
            }
            Self::Interrupted(message) => tell(&format!("interrupted: {message}\n")),
        }
        status
    }
}

impl From<CaseError> for Failure {
    fn from(error: CaseError) -> Self {
        Self::Case(error)
    }
}

impl From<StartError> for Failure {
    fn from(error: StartError) -> Self {
        match error {
            StartError::Case(error) => error.into(),
            StartError::Raster(_) | StartError::Release(_) | StartError::Result { .. } => {
                Self::File(error.to_string())
            }
            StartError::Memory { .. } => {
                Self::usage(error.to_string(), "granflow check says what a case needs")
            }
            StartError::Build(_) => Self::Computation(error.to_string()),
            StartError::Feature { .. } => {
                Self::usage(error.to_string(), "cargo build with default features has all")
            }
        }
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        match error {
            RunError::Start(error) => error.into(),
            RunError::Begin(BeginError::Thread(_)) | RunError::Threads(_) => {
                Self::usage(error.to_string(), "try a smaller --threads")
            }
            RunError::Begin(_) | RunError::Output(_) | RunError::Files(_) => Self::File(error.to_string()),
            RunError::Computation { .. } | RunError::Failed { .. } => Self::Computation(error.to_string()),
        }
    }
}

impl From<FilesError> for Failure {
    fn from(error: FilesError) -> Self {
        Self::File(error.to_string())
    }
}

impl From<CompareError> for Failure {
    fn from(error: CompareError) -> Self {
        let message = error.to_string();
        match error {
            CompareError::Threshold { .. }
            | CompareError::TooThin { .. }
            | CompareError::Nothing { .. }
            | CompareError::Apart { .. }
            | CompareError::NoMap { .. }
            | CompareError::NoOutline { .. } => {
                Self::usage(message, "granflow compare --help says what can be compared")
            }
            _ => Self::File(message),
        }
    }
}

/// Prints on standard output, [`plain`]; a reader that closed the pipe (`| head`) is no failure.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(plain(&short_numbers(text)).as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::File(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Writes on standard error at once, [`plain`].
pub fn tell(text: &str) {
    send(&plain(&short_numbers(text)));
}

/// Writes on standard error at once, with the codes of a terminal that the text holds; nobody is left to be told if it is closed.
pub fn send(text: &str) {
    let mut out = io::stderr().lock();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}
