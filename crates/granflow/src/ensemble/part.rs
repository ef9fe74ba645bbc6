//! What was added up as a file: a part of an ensemble, and what an interrupted one goes on from.

use super::classes::Classes;
use super::member::{Row, SCALARS};
use super::reduced::{Peaks, Reduced};
use super::{Ensemble, EnsembleError};
use crate::case::Case;
use crate::output::part::{self, Header, Written};
use crate::output::{Error, whole_file};
use crate::stop_reason::StopReason;
use std::io::{self, Write};
use std::path::Path;

/// The case that a part was computed from, as the part itself has it; `moved` says where its file is now, if elsewhere: what the
/// case names is looked for beside that.
///
/// # Errors
/// [`EnsembleError::Output`] for what is no part; [`EnsembleError::Case`].
pub fn case_of_part(part: &Path, moved: Option<&Path>) -> Result<Case, EnsembleError> {
    let bytes =
        std::fs::read(part).map_err(|source| Error::Io { path: part.into(), action: "read", source })?;
    let Written { path, text, overrides } = part::open(part, &bytes)?.0.written;
    let name = moved.unwrap_or(&path).display().to_string();
    Ok(Case::parse_with(&text, &name, &overrides)?)
}

impl Ensemble {
    /// Writes what was added up as a file.
    ///
    /// # Errors
    /// [`EnsembleError::Output`]; an older file then stays.
    pub fn write(&self, reduced: &Reduced, path: &Path) -> Result<(), EnsembleError> {
        Ok(whole_file(path, |out| self.encode(reduced, out))?)
    }

    /// What [`Ensemble::write`] writes.
    #[must_use]
    pub fn to_bytes(&self, reduced: &Reduced) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.encode(reduced, &mut bytes).expect("memory takes everything");
        bytes
    }

    /// Writes number by number: what was added up is a good share of the memory.
    fn encode(&self, reduced: &Reduced, out: &mut dyn Write) -> io::Result<()> {
        part::encode(&self.header(reduced), out, |out| numbers(reduced, out))
    }

    /// Reads what [`Ensemble::write`] wrote of this ensemble, with the same version of granflow, case and inputs.
    ///
    /// # Errors
    /// [`EnsembleError::Output`] saying what is wrong with the file or which other ensemble it is of.
    pub fn read(&self, path: &Path) -> Result<Reduced, EnsembleError> {
        let bytes =
            std::fs::read(path).map_err(|source| Error::Io { path: path.into(), action: "read", source })?;
        self.from_bytes(&bytes, path)
    }

    /// Takes what [`Ensemble::to_bytes`] gave, which messages call by this name.
    ///
    /// # Errors
    /// As [`Ensemble::read`].
    pub fn from_bytes(&self, bytes: &[u8], path: &Path) -> Result<Reduced, EnsembleError> {
        let (header, bytes) = part::decode(path, bytes, &self.origin)?;
        let mut reduced = self.empty();
        let read = decode(&mut Bytes(bytes), &header, self.plan.columns().len(), &mut reduced);
        let within = reduced.rows.keys().all(|number| *number < self.plan.members);
        if read.is_none() || !within || !reduced.is_possible() {
            let problem = "its numbers are not those that it announces, or none that members add up to; compute this part again".to_owned();
            return Err(Error::Damaged { path: path.to_owned(), problem }.into());
        }
        Ok(reduced)
    }

    fn header(&self, reduced: &Reduced) -> Header {
        Header {
            granflow: env!("CARGO_PKG_VERSION").to_owned(),
            origin: self.origin.clone(),
            written: self.written(),
            further: reduced.further.clone(),
            failures: reduced.failures().map(|(number, failure)| (number, failure.to_owned())).collect(),
            ended: reduced
                .rows
                .iter()
                .filter_map(|(number, row)| Some((*number, row.ended.as_ref().ok()?.0)))
                .collect(),
        }
    }
}

impl Ensemble {
    fn written(&self) -> Written {
        let (text, overrides) = self.case.parts();
        let name = Path::new(self.case.source_name());
        let path = std::path::absolute(name).unwrap_or_else(|_| name.to_owned());
        Written { path, text: text.to_owned(), overrides }
    }
}

/// The numbers of what was added up, little endian.
fn numbers(reduced: &Reduced, out: &mut dyn Write) -> io::Result<()> {
    for row in reduced.rows.values() {
        doubles(&row.values, out)?;
        if let Ok((_, scalars)) = &row.ended {
            doubles(scalars, out)?;
        }
    }
    counts(&reduced.reached, out)?;
    for Peaks { sums, largest, above, classes, .. } in &reduced.peaks {
        sums.iter().try_for_each(|sum| out.write_all(&sum.to_le_bytes()))?;
        doubles(largest, out)?;
        above.iter().try_for_each(|above| counts(above, out))?;
        for Classes { first, counts: own } in classes {
            counts(&[*first, own.len() as u32], out)?;
            counts(own, out)?;
        }
    }
    Ok(())
}

fn counts(list: &[u32], out: &mut dyn Write) -> io::Result<()> {
    list.iter().try_for_each(|count| out.write_all(&count.to_le_bytes()))
}

fn doubles(list: &[f64], out: &mut dyn Write) -> io::Result<()> {
    list.iter().try_for_each(|number| out.write_all(&number.to_le_bytes()))
}

/// What is still to be read.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (own, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*own)
    }
    fn count(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }
    fn number(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes)
    }
    fn numbers(&mut self, count: usize) -> Option<Vec<f64>> {
        (0..count).map(|_| self.number()).collect()
    }
    /// Each of a list, by what reads one.
    fn fill<T>(&mut self, list: &mut [T], one: impl Fn(&mut Self) -> Option<T>) -> Option<()> {
        list.iter_mut().try_for_each(|value| {
            *value = one(self)?;
            Some(())
        })
    }
    /// Counts by classes; there are never more of them than bytes.
    fn classes(&mut self) -> Option<Classes> {
        let (first, count) = (self.count()?, self.count()? as usize);
        if count * 4 > self.0.len() {
            return None;
        }
        let mut counts = vec![0; count];
        self.fill(&mut counts, Self::count)?;
        Some(Classes { first, counts })
    }
}

/// Fills `reduced`, which has no member yet; nothing where the bytes are not as many as the header says.
fn decode(bytes: &mut Bytes, header: &Header, columns: usize, reduced: &mut Reduced) -> Option<()> {
    let mut ends: Vec<(u32, Result<StopReason, String>)> =
        header.ended.iter().map(|(number, reason)| (*number, Ok(*reason))).collect();
    ends.extend(header.failures.iter().map(|(number, failure)| (*number, Err(failure.clone()))));
    ends.sort_by_key(|(number, _)| *number);
    for (number, end) in ends {
        let values = bytes.numbers(columns)?;
        let ended = match end {
            Ok(reason) => Ok((reason, bytes.numbers(SCALARS.len() + header.further.len())?)),
            Err(failure) => Err(failure),
        };
        reduced.rows.insert(number, Row { values, ended });
    }
    reduced.further.clone_from(&header.further);
    bytes.fill(&mut reduced.reached, Bytes::count)?;
    for Peaks { sums, largest, above, classes, .. } in &mut reduced.peaks {
        bytes.fill(sums, |bytes| bytes.take().map(i128::from_le_bytes))?;
        bytes.fill(largest, Bytes::number)?;
        above.iter_mut().try_for_each(|above| bytes.fill(above, Bytes::count))?;
        bytes.fill(classes, Bytes::classes)?;
    }
    bytes.0.is_empty().then_some(())
}
