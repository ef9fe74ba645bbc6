//! The checkpoint: everything a run needs to go on bit for bit.
//!
//! Layout, all little endian: the line `granflow checkpoint 7`, a u32 length, that many bytes of JSON (version,
//! case, inputs, past, step, end, names and lengths), then as raw f64 the time and the scalars, then the arrays as raw
//! f64 or f32, then how far frames, ledger, gauges.csv and sections.csv had come (u64 records, u32
//! CRC-32 of them, four times), then the CRC-32 of all before.

use super::mark::{CURE, Mark};
pub use super::origin::{Origin, Past};
use super::{Error, Precision, Summed, whole_file};
use crate::stop_reason::StopReason;
use granflow_case::Change;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::path::Path;

const MAGIC: &[u8] = b"granflow checkpoint 7\n";
const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Numbers that are turned from or into bytes in one go.
const AT_ONCE: usize = 1 << 15;

/// The state of a run between two steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Checkpoint<'a> {
    /// What the run was made of.
    pub origin: Origin,
    /// How it came to where it stands.
    pub past: Past,
    /// Why the run has ended, where it has.
    pub ended: Option<StopReason>,
    /// Steps done.
    pub step: u64,
    /// Simulated time, in the case's units.
    pub time: f64,
    /// Numbers of the run: sums of the ledger with their compensation, peaks, the last step size.
    pub scalars: Vec<(String, f64)>,
    /// Fields of the run, any length each.
    pub arrays: Vec<(String, Numbers<'a>)>,
}

/// What a checkpoint counts on: how far the files beside it had come.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Marks {
    /// The store of frames.
    pub frames: Mark,
    /// The ledger.
    pub ledger: Mark,
    /// The lines of gauges.csv and of sections.csv; 0 where there is no such file.
    pub series: [Mark; 2],
}

/// The numbers of an array, which the file has in the same precision.
#[derive(Debug, Clone, PartialEq)]
pub enum Numbers<'a> {
    /// In double precision.
    Double(Cow<'a, [f64]>),
    /// In single precision.
    Single(Cow<'a, [f32]>),
}

impl Numbers<'_> {
    pub(crate) fn len(&self) -> usize {
        match self {
            Numbers::Double(values) => values.len(),
            Numbers::Single(values) => values.len(),
        }
    }
    /// How many bytes they have in the file.
    pub(crate) fn bytes(&self) -> usize {
        self.len() * self.precision().width()
    }
    fn precision(&self) -> Precision {
        match self {
            Numbers::Double(_) => Precision::F64,
            Numbers::Single(_) => Precision::F32,
        }
    }
    /// The same, not more than so many at once.
    pub(crate) fn chunks(&self, most: usize) -> Vec<Numbers<'_>> {
        match self {
            Numbers::Double(values) => values.chunks(most).map(|part| Numbers::Double(part.into())).collect(),
            Numbers::Single(values) => values.chunks(most).map(|part| Numbers::Single(part.into())).collect(),
        }
    }
    /// Append them to `bytes` as the file has them.
    pub(crate) fn encode(&self, bytes: &mut Vec<u8>) {
        match self {
            Numbers::Double(values) => Precision::F64.encode(values, bytes),
            Numbers::Single(values) => values.iter().for_each(|value| bytes.extend(value.to_le_bytes())),
        }
    }
}

#[derive(Serialize, Deserialize)]
struct Header {
    granflow: String,
    #[serde(flatten)]
    origin: Origin,
    past: Past,
    ended: Option<StopReason>,
    step: u64,
    scalars: Vec<String>,
    arrays: Vec<(String, usize, Precision)>,
}

impl Checkpoint<'_> {
    /// Writes the checkpoint durably: it replaces an older one only when it is complete on disk.
    ///
    /// # Errors
    /// [`Error::Io`]; the older checkpoint then remains.
    pub fn write(&self, path: &Path, marks: Marks) -> Result<(), Error> {
        write_from(path, &self.head(), marks, |out| {
            let mut bytes = Vec::new();
            for part in self.arrays.iter().flat_map(|(_, values)| values.chunks(AT_ONCE)) {
                bytes.clear();
                part.encode(&mut bytes);
                out.write_all(&bytes)?;
            }
            Ok(())
        })
    }

    /// The bytes before the arrays.
    pub(crate) fn head(&self) -> Vec<u8> {
        let header = Header {
            granflow: VERSION.into(),
            origin: self.origin.clone(),
            past: self.past.clone(),
            ended: self.ended,
            step: self.step,
            scalars: self.scalars.iter().map(|(name, _)| name.clone()).collect(),
            arrays: self
                .arrays
                .iter()
                .map(|(name, values)| (name.clone(), values.len(), values.precision()))
                .collect(),
        };
        let header = serde_json::to_vec(&header).expect("names and counts are JSON");
        let mut bytes = MAGIC.to_vec();
        bytes.extend((header.len() as u32).to_le_bytes());
        bytes.extend(header);
        Precision::F64.encode(&[self.time], &mut bytes);
        self.scalars.iter().for_each(|(_, value)| Precision::F64.encode(&[*value], &mut bytes));
        bytes
    }

    /// The array called `name`.
    #[must_use]
    pub fn array(&self, name: &str) -> Option<&Numbers<'_>> {
        self.arrays.iter().find(|(own, _)| own == name).map(|(_, values)| values)
    }

    /// The scalar called `name`.
    #[must_use]
    pub fn scalar(&self, name: &str) -> Option<f64> {
        self.scalars.iter().find(|(own, _)| own == name).map(|&(_, value)| value)
    }
}

/// Writes a checkpoint as [`Checkpoint::write`] does, from its [`Checkpoint::head`] and what `arrays` gives: the
/// raw f64 of its arrays, one after the other.
pub(crate) fn write_from(
    path: &Path,
    head: &[u8],
    marks: Marks,
    arrays: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Error> {
    whole_file(path, |out| {
        let mut out = Summed::new(out);
        out.write_all(head)?;
        arrays(&mut out)?;
        out.write_all(&marks.frames.to_bytes())?;
        out.write_all(&marks.ledger.to_bytes())?;
        marks.series.iter().try_for_each(|mark| out.write_all(&mark.to_bytes()))?;
        out.finish().map(drop)
    })
}

impl Checkpoint<'static> {
    /// Reads the checkpoint of a run that goes on with this origin, every bit as it was written; says what changes.
    ///
    /// # Errors
    /// [`Error::Io`] if there is none; [`Error::Damaged`] if it is truncated or altered; [`Error::Mismatch`] if it
    /// was written by another version of granflow (whose last bits may differ), or the state stands on what
    /// differs in the case or in its inputs.
    pub fn read(path: &Path, origin: &Origin) -> Result<(Self, Marks, Vec<Change>), Error> {
        let unread = || Error::io(path, "read");
        let file = File::open(path).map_err(unread())?;
        let size = file.metadata().map_err(unread())?.len();
        let mut file =
            Hashed { from: BufReader::with_capacity(1 << 18, file), crc: crc32fast::Hasher::new() };
        let header = Header::read(path, &mut file, size)?;
        let mut front = file.numbers(1 + header.scalars.len()).map_err(unread())?;
        let time = front.remove(0);
        let mut arrays = Vec::new();
        for (name, length, precision) in &header.arrays {
            let numbers = match precision {
                Precision::F64 => file.numbers(*length).map(|values| Numbers::Double(values.into())),
                Precision::F32 => file.singles(*length).map(|values| Numbers::Single(values.into())),
            };
            arrays.push((name.clone(), numbers.map_err(unread())?));
        }
        let mut mark = || -> io::Result<Mark> {
            let mut bytes = [0; Mark::BYTES];
            file.read_exact(&mut bytes)?;
            Ok(Mark::from_bytes(bytes))
        };
        let [frames, ledger, gauges, sections] =
            [mark(), mark(), mark(), mark()].map(|mark| mark.map_err(unread()));
        let marks = Marks { frames: frames?, ledger: ledger?, series: [gauges?, sections?] };
        let (computed, mut crc) = (file.crc.clone().finalize(), [0; 4]);
        file.read_exact(&mut crc).map_err(unread())?;
        if crc != computed.to_le_bytes() {
            return Err(altered(path));
        }
        let changes = header.check(path, origin)?;
        let Header { origin, past, ended, step, scalars, .. } = header;
        let scalars = scalars.into_iter().zip(front).collect();
        Ok((Self { origin, past, ended, step, time, scalars, arrays }, marks, changes))
    }

    /// The array called `name`, which is then no longer in the checkpoint.
    pub fn take(&mut self, name: &str) -> Option<Vec<f64>> {
        let place = self.arrays.iter().position(|(own, _)| own == name)?;
        Some(match self.arrays.swap_remove(place).1 {
            Numbers::Double(values) => values.into_owned(),
            Numbers::Single(values) => values.iter().map(|&value| value.into()).collect(),
        })
    }
}

impl Header {
    /// Reads what stands before the numbers of a checkpoint of `size` bytes, and checks that it is as long as that
    /// says.
    fn read(path: &Path, file: &mut impl Read, size: u64) -> Result<Header, Error> {
        let unread = || Error::io(path, "read");
        let mut magic = Vec::new();
        file.by_ref().take(MAGIC.len() as u64).read_to_end(&mut magic).map_err(unread())?;
        if magic != MAGIC {
            let problem = if magic.starts_with(b"granflow checkpoint ") {
                "this checkpoint has a layout that this version of granflow does not read; resume with the one that wrote it".into()
            } else {
                format!("this is not a checkpoint of granflow; {CURE}")
            };
            return Err(Error::damaged(path, problem));
        }
        let short = |wanted: u64| {
            let problem =
                format!("the checkpoint is truncated: {size} bytes where {wanted} are expected; {CURE}");
            Error::damaged(path, problem)
        };
        let before = MAGIC.len() as u64 + 4;
        if size < before {
            return Err(short(before));
        }
        let mut length = [0; 4];
        file.read_exact(&mut length).map_err(unread())?;
        let front = before + u64::from(u32::from_le_bytes(length));
        if size < front {
            return Err(short(front));
        }
        let mut header = vec![0; (front - before) as usize];
        file.read_exact(&mut header).map_err(unread())?;
        let header: Header = serde_json::from_slice(&header).map_err(|_| altered(path))?;
        // A damaged length may be huge.
        let sizes = header
            .arrays
            .iter()
            .map(|(_, length, precision)| (*length as u64).saturating_mul(precision.width() as u64));
        let numbers = sizes.fold(8 * (1 + header.scalars.len() as u64), u64::saturating_add);
        let wanted = numbers.saturating_add(4 * Mark::BYTES as u64 + 4).saturating_add(front);
        if size != wanted {
            return Err(if size < wanted { short(wanted) } else { altered(path) });
        }
        Ok(header)
    }

    /// Checks that it is of this version of granflow and can go on with this origin; says what changes.
    fn check(&self, path: &Path, origin: &Origin) -> Result<Vec<Change>, Error> {
        if self.granflow != VERSION {
            let problem = format!(
                "written by granflow {}, this is {VERSION}, so the run could not go on bit for bit; \
                 resume with that version or start again without --resume",
                self.granflow
            );
            return Err(Error::mismatch(path, problem));
        }
        self.origin.changes(origin).map_err(|problem| Error::mismatch(path, problem))
    }
}

fn altered(path: &Path) -> Error {
    let problem =
        format!("the checkpoint does not match its checksum: it was altered or the disk failed; {CURE}");
    Error::damaged(path, problem)
}

/// A source that keeps the checksum of what passes.
struct Hashed<R> {
    from: R,
    crc: crc32fast::Hasher,
}

impl<R: Read> Read for Hashed<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let read = self.from.read(bytes)?;
        self.crc.update(&bytes[..read]);
        Ok(read)
    }
}

impl<R: Read> Hashed<R> {
    /// The next numbers, of which no second copy is made.
    fn numbers(&mut self, count: usize) -> io::Result<Vec<f64>> {
        self.next(count, f64::from_le_bytes)
    }

    /// As [`Hashed::numbers`], in single precision.
    fn singles(&mut self, count: usize) -> io::Result<Vec<f32>> {
        self.next(count, f32::from_le_bytes)
    }

    fn next<T, const WIDTH: usize>(
        &mut self,
        count: usize,
        number: fn([u8; WIDTH]) -> T,
    ) -> io::Result<Vec<T>> {
        let mut numbers = Vec::with_capacity(count);
        let mut bytes = vec![0; WIDTH * AT_ONCE.min(count)];
        while numbers.len() < count {
            let part = &mut bytes[..WIDTH * AT_ONCE.min(count - numbers.len())];
            self.read_exact(part)?;
            numbers.extend(part.as_chunks().0.iter().map(|&bytes| number(bytes)));
        }
        Ok(numbers)
    }
}

#[cfg(test)]
mod tests;
