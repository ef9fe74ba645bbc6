//! What a reader decided that its user should know.

use std::fmt;

/// One sentence that names the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Remark {
    /// It is so, and may surprise: units that were converted, features left out.
    Note(String),
    /// It may be wrong: systems that could not be compared, heights that no ground has.
    Warning(String),
}

impl Remark {
    /// `note` or `warning`.
    pub fn kind(&self) -> &'static str {
        match self {
            Remark::Note(_) => "note",
            Remark::Warning(_) => "warning",
        }
    }

    /// The sentence.
    pub fn text(&self) -> &str {
        match self {
            Remark::Note(text) | Remark::Warning(text) => text,
        }
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.kind(), self.text())
    }
}
