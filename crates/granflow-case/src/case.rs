//! A case file that was read: the words of its kind, and where each of them stands.

use std::path::Path;
use std::sync::Arc;

use super::checked::Checked;
use super::fault::CaseError;
use super::files::{Asked, FileAccess, read_case};
use super::kinds::{self, Words};
use super::look::Look;
use super::source::Source;

/// A case as it is written: every key is known and has a value of its type.
#[derive(Debug, Clone)]
pub struct Case {
    source: Source,
    words: Arc<dyn Words>,
    /// Of its ensemble nothing is asked.
    alone: bool,
}

impl Case {
    /// Reads a case from a text; `name` is what errors call it, and files are looked for beside it.
    ///
    /// # Errors
    /// [`CaseError`] at the first place that is not TOML, an unknown key, a wrong type or a missing key.
    pub fn parse(text: &str, name: &str) -> Result<Self, CaseError> {
        Self::parse_with(text, name, &[])
    }

    /// Reads a case from a text with overrides `key.path=value` laid over it.
    ///
    /// # Errors
    /// As [`Case::parse`]; an error in an override names it.
    pub fn parse_with(text: &str, name: &str, overrides: &[String]) -> Result<Self, CaseError> {
        let source = Source::read(name, text, overrides)?;
        let words = kinds::read(&source)?;
        Ok(Self { source, words, alone: false })
    }

    /// Reads a case file.
    ///
    /// # Errors
    /// As [`Case::parse`]; a file that cannot be read is answered with the nearest name that exists.
    pub fn read(path: &Path) -> Result<Self, CaseError> {
        Self::read_with(path, &[])
    }

    /// Reads a case file with overrides `key.path=value` laid over it.
    ///
    /// # Errors
    /// As [`Case::read`]; an error in an override names it.
    pub fn read_with(path: &Path, overrides: &[String]) -> Result<Self, CaseError> {
        Self::parse_with(&read_case(path, &kinds::tables())?, &path.display().to_string(), overrides)
    }

    /// Checks ranges, combinations, formulas and files, and evaluates the case: all that can be said before work starts.
    ///
    /// # Errors
    /// [`CaseError`] for the first thing that is wrong; its kind is `File` where a file cannot be read.
    pub fn check(&self, files: &dyn FileAccess) -> Result<Checked, CaseError> {
        let files = Asked::new(files);
        let look = Look { source: &self.source, files: &files };
        let (mut run, kind) = self.words.check(&look)?;
        if let Some((words, pressure)) = self.words.ensemble().filter(|_| !self.alone) {
            let ensemble = words.check(&look, pressure)?;
            for (place, change) in ensemble.trials() {
                self.attempt(&look, &place, change)?;
            }
            let note = "the case has an [ensemble]: `granflow ensemble` computes its members, `granflow run` this one case";
            run.notes.push(note.to_owned());
            run.ensemble = Some(Arc::new(ensemble));
        }
        run.inputs = files.into_names();
        Ok(Checked { run, kind })
    }

    /// The case with overrides laid over it, as a member of an ensemble has them, checked; of the ensemble itself nothing is asked.
    ///
    /// # Errors
    /// As [`Case::parse_with`] and [`Case::check`].
    pub fn check_with(&self, overrides: &[String], files: &dyn FileAccess) -> Result<Checked, CaseError> {
        self.member(overrides)?.check(files)
    }

    /// A value of an ensemble must be one that the case takes.
    fn attempt(&self, look: &Look, place: &str, change: String) -> Result<(), CaseError> {
        let Err(error) = self.check_with(std::slice::from_ref(&change), look.files) else { return Ok(()) };
        let fault = look.source.fault(place, format!("the case does not take {change}: {}", error.message()));
        let cure = "give ends (uniform, or min and max) within what the case takes";
        let fault = error.help_lines().iter().fold(fault, |fault, line| fault.help(line.as_str())).help(cure);
        Err(if error.kind() == super::fault::CaseErrorKind::File { fault.file() } else { fault })
    }

    /// The text of the case file, with the overrides as comment lines at the end.
    #[must_use]
    pub fn text(&self) -> String {
        self.source.text()
    }

    /// One member of the ensemble of the case: overrides laid over it, and of the ensemble itself nothing is asked.
    ///
    /// # Errors
    /// As [`Case::parse_with`].
    pub fn member(&self, overrides: &[String]) -> Result<Self, CaseError> {
        let source = self.source.with(overrides)?;
        let words = kinds::read(&source)?;
        Ok(Self { source, words, alone: true })
    }

    /// What [`Case::parse_with`] makes the same case of: the text of the file, and the overrides.
    #[must_use]
    pub fn parts(&self) -> (&str, Vec<String>) {
        self.source.parts()
    }

    /// The case as one TOML document that computes the same: the file's own text where there are no overrides, else its
    /// tables with the overrides laid in.
    #[must_use]
    pub fn resolved(&self) -> String {
        self.source.resolved()
    }

    /// The case with its defaults, as TOML; angles are in radians.
    #[must_use]
    pub fn to_toml(&self) -> String {
        self.words.to_toml()
    }

    /// The name of the file the case was read from.
    #[must_use]
    pub fn source_name(&self) -> &str {
        self.source.name()
    }
}
