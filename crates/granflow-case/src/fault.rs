//! What is wrong with a case: the place, what was found, what is allowed, and the cure.

use crate::shown::short_numbers;
use std::fmt;
use std::ops::Range;

use super::formula::FormulaError;
use super::nearest::nearest;

/// What kind of trouble a [`CaseError`] is; it decides the exit status.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CaseErrorKind {
    /// The case is wrong (exit status 2).
    Invalid,
    /// A file that the case needs, or the case itself, cannot be read (exit status 4).
    File,
}

/// An error in a case file, with its place in the text.
///
/// Its `Display` is the whole message: `silo.toml:12:8: scheme.name: found ...` and lines of help.
#[derive(Debug, Clone)]
pub struct CaseError(Box<Fault>);

#[derive(Debug, Clone)]
struct Fault {
    kind: CaseErrorKind,
    name: String,
    text: String,
    span: Option<Range<usize>>,
    key: String,
    message: String,
    help: Vec<String>,
}

impl CaseError {
    /// An error at a place of a text; `name` is the file's name, or the command-line argument the text came from.
    pub(crate) fn new(
        name: &str,
        text: &str,
        span: Option<Range<usize>>,
        key: &str,
        message: String,
    ) -> Self {
        Self(Box::new(Fault {
            kind: CaseErrorKind::Invalid,
            name: name.to_owned(),
            text: text.to_owned(),
            span,
            key: key.to_owned(),
            message: short_numbers(&message).into_owned(),
            help: Vec::new(),
        }))
    }

    /// A file that cannot be read, with no place in a case.
    pub(crate) fn unreadable(name: &str, message: String) -> Self {
        Self::new(name, "", None, "", message).file()
    }

    /// Marks the error as one of reading a file.
    pub(crate) fn file(mut self) -> Self {
        self.0.kind = CaseErrorKind::File;
        self
    }

    /// Adds a line of help: what is allowed, or what to do.
    pub(crate) fn help(mut self, line: impl Into<String>) -> Self {
        self.0.help.push(line.into());
        self
    }

    /// Adds `did you mean ...?` and the list of what is allowed.
    pub(crate) fn allowed<'a>(self, found: &str, allowed: impl IntoIterator<Item = &'a str>) -> Self {
        let list: Vec<&str> = allowed.into_iter().collect();
        let error = match nearest(found, list.iter().copied()) {
            Some(near) => self.help(format!("did you mean `{near}`?")),
            None => self,
        };
        if list.is_empty() { error } else { error.help(format!("allowed: {}", list.join(", "))) }
    }

    /// Whether the case or a file is to blame.
    #[must_use]
    pub fn kind(&self) -> CaseErrorKind {
        self.0.kind
    }

    /// Name of the file, or the `--set` argument, that the error stands in.
    #[must_use]
    pub fn source_name(&self) -> &str {
        &self.0.name
    }

    /// The text that [`CaseError::span`] counts in.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.0.text
    }

    /// The offending bytes of [`CaseError::text`], if the error has a place.
    #[must_use]
    pub fn span(&self) -> Option<Range<usize>> {
        self.0.span.clone()
    }

    /// The key, written with dots (`material.friction.coulomb.mu`); empty if no key is to blame.
    #[must_use]
    pub fn key(&self) -> &str {
        &self.0.key
    }

    /// What was found, without place and help.
    #[must_use]
    pub fn message(&self) -> &str {
        &self.0.message
    }

    /// What is allowed and what to do, one thing a line.
    #[must_use]
    pub fn help_lines(&self) -> &[String] {
        &self.0.help
    }

    /// Line and column of the error, both from 1.
    #[must_use]
    pub fn line_column(&self) -> Option<(usize, usize)> {
        let start = self.0.span.as_ref()?.start.min(self.0.text.len());
        let before = &self.0.text.as_bytes()[..start];
        let line = 1 + before.iter().filter(|byte| **byte == b'\n').count();
        let begin = before.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
        Some((line, 1 + String::from_utf8_lossy(&before[begin..]).chars().count()))
    }

    /// Place, key and message in one line.
    #[must_use]
    pub fn headline(&self) -> String {
        let from_file = !self.0.name.starts_with("--set");
        let place = match self.line_column().filter(|_| from_file) {
            Some((line, column)) => format!("{}:{line}:{column}: ", self.0.name),
            None => format!("{}: ", self.0.name),
        };
        let key = if self.0.key.is_empty() { String::new() } else { format!("`{}`: ", self.0.key) };
        format!("{place}{key}{}", self.0.message)
    }
}

impl fmt::Display for CaseError {
    fn fmt(&self, to: &mut fmt::Formatter) -> fmt::Result {
        to.write_str(&self.headline())?;
        self.0.help.iter().try_for_each(|line| write!(to, "\n  help: {line}"))
    }
}

impl std::error::Error for CaseError {}

/// What is wrong with a part of a case that does not know where it stands: the key below it (with the bytes of a
/// formula), the message, and whether a file is to blame.
#[derive(Debug)]
pub(crate) struct PartFault {
    pub key: &'static str,
    pub part: Option<Range<usize>>,
    pub message: String,
    pub file: bool,
}

impl PartFault {
    pub(crate) fn new(key: &'static str, message: impl Into<String>) -> Self {
        Self { key, part: None, message: message.into(), file: false }
    }

    /// A formula that cannot be read.
    pub(crate) fn formula(key: &'static str, error: FormulaError) -> Self {
        let FormulaError { message, at, length } = error;
        Self { key, part: Some(at..at + length), message, file: false }
    }

    /// Blames a file.
    pub(crate) fn file(self) -> Self {
        Self { file: true, ..self }
    }
}
