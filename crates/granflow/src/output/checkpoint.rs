//! The checkpoint: everything a run needs to go on bit for bit.
//!
//! Layout, all little endian: the line `granflow checkpoint 1`, a u32 length, that many bytes of JSON (version, case, step,
//! names and lengths), then as raw f64 the time, the scalars and the arrays in that order, then the CRC-32 of all before.

use super::{Error, Precision, Summed, whole_file};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fs;
use std::io::{self, Write};
use std::path::Path;

const MAGIC: &[u8] = b"granflow checkpoint 1\n";
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The state of a run between two steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Checkpoint<'a> {
    /// What identifies the case, such as [`case_hash`] of its resolved text.
    pub case: String,
    /// Steps done.
    pub step: u64,
    /// Simulated time, in the case's units.
    pub time: f64,
    /// Numbers of the run: sums of the ledger with their compensation, peaks, the last step size.
    pub scalars: Vec<(String, f64)>,
    /// Fields of the run, any length each.
    pub arrays: Vec<(String, Cow<'a, [f64]>)>,
}

#[derive(Serialize, Deserialize)]
struct Header {
    granflow: String,
    case: String,
    step: u64,
    scalars: Vec<String>,
    arrays: Vec<(String, usize)>,
}

/// A short name for the text of a case: its length and CRC-32, to tell an edited case from the one that was run.
#[must_use]
pub fn case_hash(text: &str) -> String {
    format!("{}-{:08x}", text.len(), crc32fast::hash(text.as_bytes()))
}

impl Checkpoint<'_> {
    /// Writes the checkpoint durably: it replaces an older one only when it is complete on disk.
    ///
    /// # Errors
    /// [`Error::Io`]; the older checkpoint then remains.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        write_from(path, &self.head(), |out| {
            let mut bytes = Vec::new();
            for part in self.arrays.iter().flat_map(|(_, values)| values.chunks(1 << 15)) {
                bytes.clear();
                Precision::F64.encode(part, &mut bytes);
                out.write_all(&bytes)?;
            }
            Ok(())
        })
    }

    /// The bytes before the arrays.
    pub(crate) fn head(&self) -> Vec<u8> {
        let header = Header {
            granflow: VERSION.into(),
            case: self.case.clone(),
            step: self.step,
            scalars: self.scalars.iter().map(|(name, _)| name.clone()).collect(),
            arrays: self.arrays.iter().map(|(name, values)| (name.clone(), values.len())).collect(),
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
    pub fn array(&self, name: &str) -> Option<&[f64]> {
        self.arrays.iter().find(|(own, _)| own == name).map(|(_, values)| values.as_ref())
    }

    /// The scalar called `name`.
    #[must_use]
    pub fn scalar(&self, name: &str) -> Option<f64> {
        self.scalars.iter().find(|(own, _)| own == name).map(|&(_, value)| value)
    }
}

/// Writes a checkpoint as [`Checkpoint::write`] does, from its [`Checkpoint::head`] and what `arrays` gives: the raw f64 of
/// its arrays, one after the other.
pub(crate) fn write_from(
    path: &Path,
    head: &[u8],
    arrays: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Error> {
    whole_file(path, |out| {
        let mut out = Summed::new(out);
        out.write_all(head)?;
        arrays(&mut out)?;
        out.finish()
    })
}

impl Checkpoint<'static> {
    /// Reads the checkpoint of the case called `case`, every bit as it was written.
    ///
    /// # Errors
    /// [`Error::Io`] if there is none; [`Error::Damaged`] if it is truncated or altered; [`Error::Mismatch`] if it was
    /// written by another version of granflow (whose last bits may differ) or for another case.
    pub fn read(path: &Path, case: &str) -> Result<Self, Error> {
        let bytes = fs::read(path).map_err(Error::io(path, "read"))?;
        let Some(rest) = bytes.strip_prefix(MAGIC) else {
            let problem = if bytes.starts_with(b"granflow checkpoint ") {
                "this checkpoint has a layout that this version of granflow does not read; resume with the one that wrote it"
            } else {
                "this is not a checkpoint of granflow"
            };
            return Err(Error::damaged(path, problem));
        };
        let short = |wanted: usize| {
            let problem = format!(
                "the checkpoint is truncated: {} bytes where {wanted} are expected; start the run again without --resume",
                bytes.len()
            );
            Error::damaged(path, problem)
        };
        let altered = || {
            let problem = "the checkpoint does not match its checksum: it was altered or the disk failed; \
                           start the run again without --resume";
            Error::damaged(path, problem)
        };
        let (length, rest) = rest.split_first_chunk().ok_or_else(|| short(MAGIC.len() + 4))?;
        let length = u32::from_le_bytes(*length) as usize;
        let front = MAGIC.len() + 4 + length;
        let (header, rest) = rest.split_at_checked(length).ok_or_else(|| short(front))?;
        let header: Header = serde_json::from_slice(header).map_err(|_| altered())?;
        let lengths = header.arrays.iter().map(|(_, length)| *length);
        let numbers = lengths.fold(1 + header.scalars.len(), usize::saturating_add); // a damaged length may be huge
        let wanted = numbers.saturating_mul(8).saturating_add(4);
        if rest.len() != wanted {
            return Err(if rest.len() < wanted { short(front.saturating_add(wanted)) } else { altered() });
        }
        let (body, crc) = bytes.split_at(bytes.len() - 4);
        if crc != crc32fast::hash(body).to_le_bytes() {
            return Err(altered());
        }
        if header.granflow != VERSION {
            let problem = format!(
                "written by granflow {}, this is {VERSION}, so the run could not go on bit for bit; \
                 resume with that version or start again without --resume",
                header.granflow
            );
            return Err(Error::mismatch(path, problem));
        }
        if header.case != case {
            let problem = format!(
                "the checkpoint is of another case ({}) than the one given ({case}); \
                 give the case as it was, another --out, or start again without --resume",
                header.case
            );
            return Err(Error::mismatch(path, problem));
        }
        let mut numbers = rest[..rest.len() - 4].as_chunks().0.iter().map(|&bytes| f64::from_le_bytes(bytes));
        let time = numbers.next().ok_or_else(altered)?;
        let scalars = header.scalars.into_iter().zip(numbers.by_ref()).collect();
        let arrays = header
            .arrays
            .into_iter()
            .map(|(name, length)| (name, numbers.by_ref().take(length).collect()))
            .collect();
        Ok(Self { case: header.case, step: header.step, time, scalars, arrays })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Checkpoint<'static> {
        Checkpoint {
            case: case_hash("title = \"x\""),
            step: u64::MAX,
            time: 0.1 + 0.2,
            scalars: vec![("mass".into(), -0.0), ("peak".into(), f64::INFINITY)],
            arrays: vec![
                ("thickness".into(), vec![1.0, f64::from_bits(0x7ff8_0000_0000_beef), 5e-324].into()),
                ("nothing".into(), vec![].into()),
                ("momentum".into(), (0..70_000).map(|i| f64::from(i).sin()).collect()),
            ],
        }
    }

    #[test]
    fn every_bit_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("checkpoint/state");
        let written = sample();
        written.write(&path).unwrap();
        let read = Checkpoint::read(&path, &written.case).unwrap();
        let bits = |values: Option<&[f64]>| values.unwrap().iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!((read.step, read.time.to_bits()), (u64::MAX, written.time.to_bits()));
        assert_eq!(read.scalar("mass").unwrap().to_bits(), (-0.0_f64).to_bits());
        assert_eq!(read.scalars, written.scalars);
        for name in ["thickness", "nothing", "momentum"] {
            assert_eq!(bits(read.array(name)), bits(written.array(name)), "{name}");
        }
        assert!(read.array("absent").is_none());
    }

    #[test]
    fn damage_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("state");
        let sample = sample();
        sample.write(&path).unwrap();
        let sound = fs::read(&path).unwrap();
        let message = |bytes: &[u8]| {
            fs::write(&path, bytes).unwrap();
            Checkpoint::read(&path, &sample.case).unwrap_err().to_string()
        };
        for cut in [MAGIC.len() + 2, MAGIC.len() + 20, sound.len() / 2, sound.len() - 1] {
            assert!(message(&sound[..cut]).contains("truncated"), "{cut}");
        }
        for at in [MAGIC.len() + 40, sound.len() / 2, sound.len() - 1] {
            let mut bytes = sound.clone();
            bytes[at] ^= 0x10;
            assert!(message(&bytes).contains("checksum"), "{at}");
        }
        assert!(message(b"hello").contains("not a checkpoint"));
        assert!(message(b"granflow checkpoint 9\n").contains("layout"));
        assert!(message(&[&sound[..], b"x"].concat()).contains("checksum"));
    }

    #[test]
    fn another_case_or_version_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("state");
        sample().write(&path).unwrap();
        let other = Checkpoint::read(&path, &case_hash("title = \"y\"")).unwrap_err();
        assert!(matches!(other, Error::Mismatch { .. }) && other.to_string().contains("another case"));
        let mut bytes = fs::read(&path).unwrap();
        let at = bytes.windows(VERSION.len()).position(|window| window == VERSION.as_bytes()).unwrap();
        bytes[at] = b'9';
        let end = bytes.len() - 4;
        let crc = crc32fast::hash(&bytes[..end]);
        bytes[end..].copy_from_slice(&crc.to_le_bytes());
        fs::write(&path, bytes).unwrap();
        let other = Checkpoint::read(&path, &sample().case).unwrap_err().to_string();
        assert!(other.contains("written by granflow 9"), "{other}");
    }
}
