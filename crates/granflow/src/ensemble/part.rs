//! What was added up as a file: a part of an ensemble, and what an interrupted one goes on from.

use super::classes::Classes;
use super::member::{Row, SCALARS};
use super::reduced::{Peaks, Reduced};
use super::{Ensemble, EnsembleError};
use crate::output::part::{self, Header, encode};
use crate::output::{Error, whole_file};
use crate::stop_reason::StopReason;
use std::path::Path;

impl Ensemble {
    /// Writes what was added up as a file.
    ///
    /// # Errors
    /// [`EnsembleError::Output`]; an older file then stays.
    pub fn write(&self, reduced: &Reduced, path: &Path) -> Result<(), EnsembleError> {
        Ok(whole_file(path, |out| out.write_all(&self.to_bytes(reduced)))?)
    }

    /// What [`Ensemble::write`] writes.
    #[must_use]
    pub fn to_bytes(&self, reduced: &Reduced) -> Vec<u8> {
        encode(&self.header(reduced), &numbers(reduced))
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
        decode(&mut Bytes(bytes), &header, self.plan.columns().len(), &mut reduced).ok_or_else(|| {
            Error::Damaged {
                path: path.to_owned(),
                problem: "its numbers are not those that it announces; compute this part again".to_owned(),
            }
        })?;
        Ok(reduced)
    }

    fn header(&self, reduced: &Reduced) -> Header {
        Header {
            granflow: env!("CARGO_PKG_VERSION").to_owned(),
            origin: self.origin.clone(),
            failures: reduced.failures().map(|(number, failure)| (number, failure.to_owned())).collect(),
            ended: reduced
                .rows
                .iter()
                .filter_map(|(number, row)| Some((*number, row.ended.as_ref().ok()?.0)))
                .collect(),
        }
    }
}

/// The numbers of what was added up, little endian.
fn numbers(reduced: &Reduced) -> Vec<u8> {
    let mut bytes = Vec::new();
    let counts = |list: &[u32], bytes: &mut Vec<u8>| list.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
    let doubles = |list: &[f64], bytes: &mut Vec<u8>| list.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
    for row in reduced.rows.values() {
        doubles(&row.values, &mut bytes);
        if let Ok((_, scalars)) = &row.ended {
            doubles(scalars, &mut bytes);
        }
    }
    counts(&reduced.reached, &mut bytes);
    for Peaks { sums, largest, above, classes, .. } in &reduced.peaks {
        sums.iter().for_each(|sum| bytes.extend(sum.to_le_bytes()));
        doubles(largest, &mut bytes);
        above.iter().for_each(|above| counts(above, &mut bytes));
        for Classes { first, counts: own } in classes {
            counts(&[*first, own.len() as u32], &mut bytes);
            counts(own, &mut bytes);
        }
    }
    bytes
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
        Some(Classes { first, counts: (0..count).map(|_| self.count()).collect::<Option<_>>()? })
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
            Ok(reason) => Ok((reason, bytes.numbers(SCALARS.len())?)),
            Err(failure) => Err(failure),
        };
        reduced.rows.insert(number, Row { values, ended });
    }
    bytes.fill(&mut reduced.reached, Bytes::count)?;
    for Peaks { sums, largest, above, classes, .. } in &mut reduced.peaks {
        bytes.fill(sums, |bytes| bytes.take().map(i128::from_le_bytes))?;
        bytes.fill(largest, Bytes::number)?;
        above.iter_mut().try_for_each(|above| bytes.fill(above, Bytes::count))?;
        bytes.fill(classes, Bytes::classes)?;
    }
    bytes.0.is_empty().then_some(())
}
