//! A part of an ensemble: which members it holds, and their numbers added up.
//!
//! Layout: the line `granflow part 1`, a u32 length, that many bytes of JSON, the numbers, the CRC-32 of all before; little endian.

use super::checkpoint::Origin;
use super::inputs::difference;
use super::{Error, Summed, whole_file};
use crate::stop_reason::StopReason;
use serde::{Deserialize, Serialize};
use std::io::Write;
use std::path::Path;

const MAGIC: &[u8] = b"granflow part 1\n";

/// What stands before the numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Header {
    /// Version of granflow.
    pub granflow: String,
    /// What the members were made of.
    pub origin: Origin,
    /// The members that failed, and why.
    pub failures: Vec<(u32, String)>,
    /// The members that came to their end, and which.
    pub ended: Vec<(u32, StopReason)>,
}

/// Writes a part as a whole.
pub(crate) fn write(path: &Path, header: &Header, numbers: &[u8]) -> Result<(), Error> {
    let header = serde_json::to_vec(header).expect("names and counts are JSON");
    whole_file(path, |out| {
        let mut out = Summed::new(out);
        out.write_all(MAGIC)?;
        out.write_all(&(header.len() as u32).to_le_bytes())?;
        out.write_all(&header)?;
        out.write_all(numbers)?;
        out.finish().map(drop)
    })
}

/// Reads a part of this origin: header and numbers.
pub(crate) fn read(path: &Path, origin: &Origin) -> Result<(Header, Vec<u8>), Error> {
    let mut bytes = std::fs::read(path).map_err(Error::io(path, "read"))?;
    let altered = || Error::damaged(path, "the part is truncated or altered; compute it again");
    if !bytes.starts_with(MAGIC) {
        return Err(Error::damaged(
            path,
            "this is no part of an ensemble; `granflow ensemble --part 1/16` writes one",
        ));
    }
    let front = MAGIC.len() + 4;
    if bytes.len() < front + 4 {
        return Err(altered());
    }
    let crc = bytes.split_off(bytes.len() - 4);
    if crc != crc32fast::hash(&bytes).to_le_bytes() {
        return Err(altered());
    }
    let length =
        bytes[MAGIC.len()..front].try_into().map_or(usize::MAX, |four| u32::from_le_bytes(four) as usize);
    let header = bytes.get(front..front.saturating_add(length)).ok_or_else(altered)?;
    let header: Header = serde_json::from_slice(header).map_err(|error| {
        Error::damaged(path, format!("its head cannot be read: {error}; compute it again"))
    })?;
    header.check(path, origin)?;
    Ok((header, bytes.split_off(front + length)))
}

impl Header {
    /// A part of another version, case or input is refused: its members are others.
    fn check(&self, path: &Path, origin: &Origin) -> Result<(), Error> {
        let version = env!("CARGO_PKG_VERSION");
        if self.granflow != version {
            let problem = format!(
                "it was computed by granflow {}, and this is {version}, whose last bits may differ; compute all parts with one version",
                self.granflow
            );
            return Err(Error::mismatch(path, problem));
        }
        if self.origin.case != origin.case {
            let problem = "it is of another case, or of this one with other overrides or before it was edited; give the case that it was computed from, with the same --set";
            return Err(Error::mismatch(path, problem));
        }
        match difference(&self.origin.inputs, &origin.inputs) {
            Some(difference) => {
                Err(Error::mismatch(path, format!("{difference}; compute all parts with the same files")))
            }
            None => Ok(()),
        }
    }
}
