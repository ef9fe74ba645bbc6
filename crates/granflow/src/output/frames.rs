//! The growing store of a run: one frame per output instant, appended to disk, joined into the result files later.
//!
//! Layout, all little endian: the line `granflow frames 1`, a u32 length, that many bytes of JSON (precision,
//! names and lengths of the fields), their CRC-32; then frames of equal size: the time (f64), the fields one after
//! the other, the CRC-32 of time and fields. A frame is synced before [`Frames::append`] returns, so a crash can
//! tear only the last one: whoever finds an earlier one torn knows that the disk has failed. The sync is waited
//! for beside the steps.

use super::mark::{CURE, Mark};
use super::{Error, Precision, Summed, whole_file};
pub use crate::field::Field;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

const MAGIC: &[u8] = b"granflow frames 1\n";

/// Bytes of a frame that are checked in one go.
const AT_ONCE: usize = 1 << 18;

#[derive(Serialize, Deserialize)]
struct Header {
    precision: Precision,
    fields: Vec<Field>,
}

/// The end of a store that a crash had torn; the run computes it again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Torn {
    /// The file.
    pub path: PathBuf,
    /// Bytes that were dropped.
    pub bytes: u64,
    /// Complete frames before them.
    pub kept: usize,
}

impl fmt::Display for Torn {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { path, bytes, kept } = self;
        write!(
            out,
            "{}: the last frame was torn ({bytes} bytes) and is dropped; {kept} complete frames remain",
            path.display()
        )
    }
}

/// An open store: named fields over time on disk, one frame in memory at most.
#[derive(Debug)]
pub struct Frames {
    path: PathBuf,
    file: File,
    precision: Precision,
    fields: Vec<Field>,
    times: Vec<f64>,
    /// Bytes before the first frame.
    start: u64,
    /// Checksums of the header and of the frames.
    crcs: Vec<u32>,
    /// Behind the frames stands one that a crash had torn.
    torn: bool,
}

impl Frames {
    /// Starts an empty store at `path`, over an older one if there is one.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be written.
    pub fn create(path: &Path, precision: Precision, fields: Vec<Field>) -> Result<Self, Error> {
        let header = serde_json::to_vec(&Header { precision, fields })
            .map_err(|error| Error::invalid(path, error.to_string()))?;
        whole_file(path, |out| {
            out.write_all(MAGIC)?;
            out.write_all(&(header.len() as u32).to_le_bytes())?;
            out.write_all(&header)?;
            out.write_all(&crc32fast::hash(&header).to_le_bytes())
        })?;
        Ok(Self::open(path)?.0)
    }

    /// Opens a store to go on with it; every frame is checked, a torn end is reported, and cut off before the file changes.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Damaged`] if this is no store, or a frame before the last does not match its
    /// checksum.
    pub fn open(path: &Path) -> Result<(Self, Option<Torn>), Error> {
        let mut file =
            OpenOptions::new().read(true).write(true).open(path).map_err(Error::io(path, "open"))?;
        let (header, start, crc) = read_header(path, &mut file)?;
        let mut frames = Self {
            path: path.to_owned(),
            file,
            precision: header.precision,
            fields: header.fields,
            times: Vec::new(),
            start,
            crcs: vec![crc],
            torn: false,
        };
        let length = frames.file.metadata().map_err(Error::io(path, "read"))?.len();
        let whole = (length - start) / frames.frame_size();
        let size = frames.frame_size() as usize;
        let mut bytes = vec![0; size.min(AT_ONCE)];
        for frame in 0..whole {
            let (mut sum, mut time, mut rest, mut crc) = (crc32fast::Hasher::new(), None, size - 4, [0; 4]);
            while rest > 0 {
                let part = &mut bytes[..rest.min(AT_ONCE)];
                frames.file.read_exact(part).map_err(Error::io(path, "read"))?;
                time = time.or_else(|| Precision::F64.decode(&part[..8]).pop());
                sum.update(part);
                rest -= part.len();
            }
            frames.file.read_exact(&mut crc).map_err(Error::io(path, "read"))?;
            let sum = sum.finalize();
            if crc == sum.to_le_bytes() {
                frames.times.extend(time);
                frames.crcs.push(sum);
            } else if frame + 1 < whole {
                let problem = format!(
                    "frame {frame} of {whole} does not match its checksum: the file was altered or the disk failed; {CURE}"
                );
                return Err(Error::damaged(path, problem));
            }
        }
        let dropped = length - frames.end();
        if dropped == 0 {
            return Ok((frames, None));
        }
        frames.torn = true;
        let torn = Torn { path: path.to_owned(), bytes: dropped, kept: frames.times.len() };
        Ok((frames, Some(torn)))
    }

    /// Appends the frame at `time`, one slice per field in the order of [`Frames::fields`], and syncs it to disk.
    ///
    /// # Errors
    /// [`Error::Invalid`] if number or lengths of the slices differ from the fields, or `time` is not later than
    /// the last; [`Error::Io`] if the disk refuses: the store then ends with the frame before, as if this one had
    /// not been tried.
    pub fn append(&mut self, time: f64, values: &[&[f64]]) -> Result<(), Error> {
        if values.len() != self.fields.len()
            || self.fields.iter().zip(values).any(|(f, v)| f.length != v.len())
        {
            let found: Vec<_> = values.iter().map(|v| v.len()).collect();
            let problem = format!("a frame has lengths {found:?}, the fields are {:?}", self.fields);
            return Err(Error::invalid(&self.path, problem));
        }
        let precision = self.precision;
        self.append_from(time, |out| {
            let mut bytes = Vec::new();
            for values in values {
                bytes.clear();
                precision.encode(values, &mut bytes);
                out.write_all(&bytes)?;
            }
            Ok(())
        })
    }

    /// Appends the frame at `time` and syncs it to disk; `body` gives its fields one after the other, in the
    /// precision of the store, so that no frame needs to be in memory as a whole.
    ///
    /// # Errors
    /// As [`Frames::append`], and those of `body`.
    pub fn append_from(
        &mut self,
        time: f64,
        body: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), Error> {
        if time.is_nan() || self.times.last().is_some_and(|&last| last >= time) {
            let problem = format!("a frame at time {time} cannot follow the one at {:?}", self.times.last());
            return Err(Error::invalid(&self.path, problem));
        }
        let (end, size) = (self.end(), self.frame_size());
        if std::mem::take(&mut self.torn) {
            self.file.set_len(end).map_err(Error::io(&self.path, "shorten"))?;
        }
        let mut file = &self.file;
        let write = || -> io::Result<u32> {
            file.seek(SeekFrom::Start(end))?;
            let mut out = Summed::new(&mut file);
            out.write_all(&time.to_le_bytes())?;
            body(&mut out)?;
            if out.bytes + 4 != size {
                let problem = format!("a frame has {} bytes instead of {size}", out.bytes + 4);
                return Err(io::Error::other(Error::invalid(&self.path, problem)));
            }
            let crc = out.finish()?;
            self.file.sync_data()?;
            Ok(crc)
        };
        match write() {
            Ok(crc) => self.crcs.push(crc),
            Err(refused) => {
                let _ = self.file.set_len(end); // if this fails too, `open` drops the torn end
                return Err(Error::io(&self.path, "write")(refused));
            }
        }
        self.times.push(time);
        Ok(())
    }

    /// The same store opened once more, to be read beside this one; what this one wrote is not checked again.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be opened.
    pub fn again(&self) -> Result<Self, Error> {
        Ok(Self {
            path: self.path.clone(),
            file: File::open(&self.path).map_err(Error::io(&self.path, "open"))?,
            precision: self.precision,
            fields: self.fields.clone(),
            times: self.times.clone(),
            start: self.start,
            crcs: self.crcs.clone(),
            torn: self.torn,
        })
    }

    /// How far the store has come: the frames, and a checksum of the header and of all of them.
    #[must_use]
    pub fn mark(&self) -> Mark {
        self.mark_at(self.times.len())
    }

    fn mark_at(&self, count: usize) -> Mark {
        let mut crc = crc32fast::Hasher::new();
        self.crcs[..=count].iter().for_each(|frame| crc.update(&frame.to_le_bytes()));
        Mark { count: count as u64, crc: crc.finalize() }
    }

    /// Are the frames up to `mark` those of then?
    ///
    /// # Errors
    /// [`Error::Mismatch`] if they are not.
    pub fn fits(&self, mark: Mark) -> Result<(), Error> {
        let (before, count) = (self.times.len(), mark.count as usize);
        if count > before || self.mark_at(count) != mark {
            let what = if count > before {
                format!("it holds {before} sound frames, the checkpoint goes on from {count}")
            } else {
                format!("its first {count} frames are not those that the checkpoint goes on from")
            };
            return Err(Error::mismatch(&self.path, format!("{what}; {CURE}")));
        }
        Ok(())
    }

    /// Drops the frames after `mark`, where the checkpoint was written that a run goes on from; returns how many.
    ///
    /// # Errors
    /// As [`Frames::fits`]; [`Error::Io`] if the file cannot be shortened.
    pub fn truncate_to(&mut self, mark: Mark) -> Result<usize, Error> {
        self.fits(mark)?;
        let (before, count) = (self.times.len(), mark.count as usize);
        self.times.truncate(count);
        self.crcs.truncate(count + 1);
        self.torn = false;
        self.file
            .set_len(self.end())
            .and_then(|()| self.file.sync_all())
            .map_err(Error::io(&self.path, "shorten"))?;
        Ok(before - count)
    }

    /// Field number `field` of frame number `frame`, as 64-bit numbers.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be read, also for a frame that is not there.
    ///
    /// # Panics
    /// If `field` is not a number of [`Frames::fields`].
    pub fn read(&mut self, frame: usize, field: usize) -> Result<Vec<f64>, Error> {
        let mut bytes = Vec::new();
        self.read_bytes(frame, field, 0..self.fields[field].length, &mut bytes)?;
        Ok(self.precision.decode(&bytes))
    }

    /// As [`Frames::read`], some of the numbers, as the bytes that are stored, in place of what `bytes` held.
    pub(super) fn read_bytes(
        &mut self,
        frame: usize,
        field: usize,
        numbers: Range<usize>,
        bytes: &mut Vec<u8>,
    ) -> Result<(), Error> {
        let width = self.precision.width();
        let before = self.fields[..field].iter().map(|f| f.length).sum::<usize>() + numbers.start;
        bytes.resize(numbers.len() * width, 0);
        let offset = self.start + frame as u64 * self.frame_size() + 8 + (before * width) as u64;
        self.file
            .seek(SeekFrom::Start(offset))
            .and_then(|_| self.file.read_exact(bytes))
            .map_err(Error::io(&self.path, "read"))
    }

    /// The number of the field called `name`.
    #[must_use]
    pub fn position(&self, name: &str) -> Option<usize> {
        self.fields.iter().position(|field| field.name == name)
    }

    /// Names and lengths of the fields, in the order of the file.
    #[must_use]
    pub fn fields(&self) -> &[Field] {
        &self.fields
    }

    /// The times of the complete frames, rising.
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The precision of the fields on disk (times are always f64).
    #[must_use]
    pub fn precision(&self) -> Precision {
        self.precision
    }

    /// Where the store lies.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn frame_size(&self) -> u64 {
        let numbers: usize = self.fields.iter().map(|field| field.length).sum();
        (8 + numbers * self.precision.width() + 4) as u64
    }

    fn end(&self) -> u64 {
        self.start + self.times.len() as u64 * self.frame_size()
    }
}

/// The header, where it ends, and its checksum.
fn read_header(path: &Path, file: &mut File) -> Result<(Header, u64, u32), Error> {
    let alien = || {
        let problem = format!("this is not a store of frames that this version of granflow writes; {CURE}");
        Error::damaged(path, problem)
    };
    let mut lead = [0; MAGIC.len() + 4];
    file.read_exact(&mut lead).map_err(|_| alien())?;
    let (magic, length) = lead.split_at(MAGIC.len());
    let length = length.iter().rev().fold(0, |sum, &byte| sum << 8 | u64::from(byte));
    if magic != MAGIC || length > 1 << 20 {
        return Err(alien());
    }
    let mut bytes = vec![0; length as usize + 4];
    file.read_exact(&mut bytes).map_err(|_| alien())?;
    let (header, crc) = bytes.split_at(length as usize);
    let sum = crc32fast::hash(header);
    if crc != sum.to_le_bytes() {
        return Err(Error::damaged(path, format!("its header does not match its checksum; {CURE}")));
    }
    let header = serde_json::from_slice(header).map_err(|_| alien())?;
    Ok((header, (lead.len() + bytes.len()) as u64, sum))
}

#[cfg(test)]
mod tests;
