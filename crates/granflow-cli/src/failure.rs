//! How the program fails: the message and the exit status, in one place.

use std::fmt;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use granflow::case::{CaseError, CaseErrorKind};
use granflow::results::FilesError;
use granflow::run::RunError;
use granflow::setup::SetupError;
use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};

/// Why a command did not do what it was asked.
#[derive(Debug)]
pub enum Failure {
    /// The command line makes no sense (exit status 2).
    Usage {
        /// What was found.
        message: String,
        /// What to do.
        cure: String,
    },
    /// The case is wrong (2), or a file it needs cannot be read (4).
    Case(Box<CaseReport>),
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
            Self::Usage { .. } => 2,
            Self::Case(report) => match report.error.kind() {
                CaseErrorKind::Invalid => 2,
                CaseErrorKind::File => 4,
            },
            Self::Computation(_) => 3,
            Self::File(_) => 4,
            Self::Interrupted(_) => 130,
        }
    }

    /// Prints the failure on standard error and gives the exit status.
    pub fn report(self) -> ExitCode {
        let status = ExitCode::from(self.status());
        let text = match self {
            Self::Usage { message, cure } => format!("error: {message}\n  help: {cure}\n"),
            Self::Case(report) => format!("{:?}\n", miette::Report::new(*report)),
            Self::Computation(message) | Self::File(message) => format!("error: {message}\n"),
            Self::Interrupted(message) => format!("interrupted: {message}\n"),
        };
        // nobody is left to be told if standard error is closed
        let _ = io::stderr().write_all(text.as_bytes());
        status
    }
}

impl From<CaseError> for Failure {
    fn from(error: CaseError) -> Self {
        let source = NamedSource::new(error.source_name(), error.text().to_owned());
        Self::Case(Box::new(CaseReport { source, error }))
    }
}

impl From<SetupError> for Failure {
    fn from(error: SetupError) -> Self {
        match error {
            SetupError::Case(error) => error.into(),
            SetupError::Raster(_) | SetupError::Release(_) => Self::File(error.to_string()),
        }
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        match error {
            RunError::Setup(error) => error.into(),
            RunError::Output(_) | RunError::Files(_) => Self::File(error.to_string()),
            RunError::Computation { .. } => Self::Computation(error.to_string()),
            RunError::Threads(_) => Self::usage(error.to_string(), "try a smaller --threads"),
            RunError::Resume { .. } => Self::File(error.to_string()),
        }
    }
}

impl From<FilesError> for Failure {
    fn from(error: FilesError) -> Self {
        Self::File(error.to_string())
    }
}

/// A case error with the lines it stands in, as miette shows it.
#[derive(Debug)]
pub struct CaseReport {
    error: CaseError,
    source: NamedSource<String>,
}

impl fmt::Display for CaseReport {
    fn fmt(&self, to: &mut fmt::Formatter) -> fmt::Result {
        to.write_str(&self.error.headline())
    }
}

impl std::error::Error for CaseReport {}

impl Diagnostic for CaseReport {
    fn help(&self) -> Option<Box<dyn fmt::Display + '_>> {
        let lines = self.error.help_lines();
        if lines.is_empty() { None } else { Some(Box::new(lines.join("\n"))) }
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.error.span().map(|_| &self.source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let span = self.error.span()?;
        // a place behind the last byte (a bracket that never closes) is shown at the last byte
        let start = span.start.min(self.error.text().len());
        let length = span.len().min(self.error.text().len() - start);
        Some(Box::new(std::iter::once(LabeledSpan::new(Some("here".to_owned()), start, length))))
    }
}

/// Prints on standard output; a reader that closed the pipe (`| head`) is no failure.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::File(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}
