//! A part of an ensemble: which members it holds, and their numbers added up.
//!
//! Layout: the line `granflow part 2`, a u32 length, that many bytes of JSON, the numbers, the CRC-32 of all before; little endian.

use super::checkpoint::Origin;
use super::inputs::difference;
use super::{Error, Summed};
use crate::stop_reason::StopReason;
use serde::{Deserialize, Serialize};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

const MAGIC: &[u8] = b"granflow part 2\n";

/// What stands before the numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Header {
    /// Version of granflow.
    pub granflow: String,
    /// What the members were made of.
    pub origin: Origin,
    /// The case itself.
    pub written: Written,
    /// Names of the numbers that members have beyond those that all have.
    pub further: Vec<String>,
    /// The members that failed, and why.
    pub failures: Vec<(u32, String)>,
    /// The members that came to their end, and which.
    pub ended: Vec<(u32, StopReason)>,
}

/// A case as it was written, so that a part can be used without its file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Written {
    /// The path of the file, from the root: what the case names is looked for beside it.
    pub path: PathBuf,
    /// The text of the file.
    pub text: String,
    /// The overrides laid over it.
    pub overrides: Vec<String>,
}

/// Writes a part, its numbers by `numbers`.
pub(crate) fn encode(
    header: &Header,
    out: &mut dyn Write,
    numbers: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let header = serde_json::to_vec(header)?;
    let mut out = BufWriter::new(Summed::new(out));
    out.write_all(MAGIC)?;
    out.write_all(&(header.len() as u32).to_le_bytes())?;
    out.write_all(&header)?;
    numbers(&mut out)?;
    out.into_inner().map_err(io::IntoInnerError::into_error)?.finish().map(drop)
}

/// Header and numbers of a part of this origin; messages name `path`.
pub(crate) fn decode<'a>(path: &Path, bytes: &'a [u8], origin: &Origin) -> Result<(Header, &'a [u8]), Error> {
    let (header, numbers) = open(path, bytes)?;
    header.check(path, origin)?;
    Ok((header, numbers))
}

/// Header and numbers of a part of any origin, computed by this version; messages name `path`.
pub(crate) fn open<'a>(path: &Path, bytes: &'a [u8]) -> Result<(Header, &'a [u8]), Error> {
    let altered = || {
        let problem = "the part is truncated or altered; compute it again, an ensemble in a folder by the same command without --resume";
        Error::damaged(path, problem)
    };
    let Some(rest) = bytes.strip_prefix(MAGIC) else {
        let problem = "this is no part of an ensemble; `granflow ensemble --part 1/16` writes one";
        return Err(Error::damaged(path, problem));
    };
    let (_, crc) = bytes.split_last_chunk::<4>().ok_or_else(altered)?;
    if *crc != crc32fast::hash(&bytes[..bytes.len() - 4]).to_le_bytes() {
        return Err(altered());
    }
    let (rest, _) = rest.split_last_chunk::<4>().ok_or_else(altered)?;
    let (length, rest) = rest.split_first_chunk().ok_or_else(altered)?;
    let (header, numbers) =
        rest.split_at_checked(u32::from_le_bytes(*length) as usize).ok_or_else(altered)?;
    let header: Header = serde_json::from_slice(header).map_err(|error| {
        Error::damaged(path, format!("its head cannot be read: {error}; compute it again"))
    })?;
    let version = env!("CARGO_PKG_VERSION");
    if header.granflow != version {
        let problem = format!(
            "it was computed by granflow {}, and this is {version}, whose last bits may differ; compute all parts with one version",
            header.granflow
        );
        return Err(Error::mismatch(path, problem));
    }
    Ok((header, numbers))
}

impl Header {
    /// A part of another case or input is refused: its members are others.
    fn check(&self, path: &Path, origin: &Origin) -> Result<(), Error> {
        if self.origin.case != origin.case {
            let problem = "it is of another case, or of this one with other overrides or before it was edited; compute all parts from one case, with the same --set";
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
