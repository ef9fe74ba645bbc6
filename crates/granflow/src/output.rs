//! The files of a run: one module per format, plain data in, files out.
//!
//! Nothing here knows the numerics. Every file under its final name is complete at every instant: [`whole_file`]
//! writes beside the target, syncs and renames; the two files that grow ([`frames`], [`ledger`]) take back a torn
//! end.

mod base64;
pub mod checkpoint;
pub mod csv;
#[cfg(feature = "figures")]
pub mod figures;
pub mod folder;
pub mod frames;
mod hdf5;
pub mod inputs;
pub mod ledger;
pub mod lines;
pub mod mark;
pub mod netcdf;
mod origin;
#[cfg(feature = "geo")]
pub mod outlines;
#[cfg(all(feature = "figures", feature = "geo"))]
pub(crate) mod part;
#[cfg(feature = "geo")]
pub(crate) mod rasters;
pub mod report;
#[cfg(feature = "figures")]
pub mod style;
pub mod summary;
pub mod tables;
pub mod vtk;

pub use granflow_case::Precision;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// How the temporary neighbours of final files begin and end; see [`remove_leftovers`].
const TEMPORARY: (&str, &str) = (".granflow-", ".part");
/// How those of GeoTIFFs begin, before six letters.
const RASTER: &str = ".tmp";

/// Why a file of a run could not be written or read; every message begins with the file.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The system refused: full disk, no permission, no such file.
    #[error("{}: cannot {action}: {source}{}", path.display(), cure(source))]
    Io {
        /// The file.
        path: PathBuf,
        /// What was tried, as in "cannot write".
        action: &'static str,
        /// What the system said.
        source: io::Error,
    },
    /// The file is there but is not what it should be: truncated, altered, another format.
    #[error("{}: {problem}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong, where, and what helps.
        problem: String,
    },
    /// The file is sound but belongs to another case, version or shape than the one at hand.
    #[error("{}: {problem}", path.display())]
    Mismatch {
        /// The file.
        path: PathBuf,
        /// What was found, what was expected, and what helps.
        problem: String,
    },
    /// Another run writes into the folder.
    #[error(
        "{}: another run ({holder}) is writing into this folder; wait for it, or name another folder with --out",
        path.display()
    )]
    Busy {
        /// The folder.
        path: PathBuf,
        /// Who it is, as in "process 4711".
        holder: String,
    },
    /// The data handed over cannot be written as this file.
    #[error("{}: cannot be written: {problem}", path.display())]
    Invalid {
        /// The file that was to be written.
        path: PathBuf,
        /// What does not fit together.
        problem: String,
    },
}

impl Error {
    pub(crate) fn io(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> Self + use<> {
        let path = path.to_owned();
        // An error of ours that travelled through an io::Write comes out as itself.
        move |source| source.downcast().unwrap_or_else(|source| Self::Io { path, action, source })
    }

    pub(crate) fn damaged(path: &Path, problem: impl Into<String>) -> Self {
        Self::Damaged { path: path.to_owned(), problem: problem.into() }
    }

    pub(crate) fn mismatch(path: &Path, problem: impl Into<String>) -> Self {
        Self::Mismatch { path: path.to_owned(), problem: problem.into() }
    }

    pub(crate) fn invalid(path: &Path, problem: impl Into<String>) -> Self {
        Self::Invalid { path: path.to_owned(), problem: problem.into() }
    }
}

/// The remedy for the common refusals of the system.
fn cure(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge => {
            "; what was complete before is still there: make room, then give the same command again (granflow run with --resume, from the last checkpoint; before the first without)"
        }
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            "; choose a folder you may write to with --out"
        }
        _ => "",
    }
}

/// Writes `path` as a whole: a temporary file in the same folder, filled by `fill`, synced, then renamed over
/// `path`.
///
/// Whoever opens `path` sees the old file or the new one, never a part. Missing folders are made. When anything
/// fails the old file stays and the temporary one is removed.
///
/// # Errors
/// [`Error::Io`] naming `path`, or the error of ours that `fill` wrapped by [`io::Error::other`].
pub fn whole_file(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Error> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let write = || -> io::Result<()> {
        fs::create_dir_all(folder)?;
        let mut builder = tempfile::Builder::new();
        builder.prefix(TEMPORARY.0).suffix(TEMPORARY.1);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(fs::Permissions::from_mode(0o666)); // the umask takes away from this, as for any file
        }
        let mut file = builder.tempfile_in(folder)?;
        let mut buffer = BufWriter::with_capacity(1 << 18, file.as_file_mut());
        fill(&mut buffer)?;
        buffer.flush()?;
        drop(buffer);
        file.as_file().sync_all()?;
        file.persist(path).map_err(|refused| refused.error)?;
        sync_folder(folder)
    };
    write().map_err(Error::io(path, "write"))
}

/// Gives a file that is only replaced, never changed, a second name, over an older file of that name.
pub(crate) fn keep(file: &Path, name: &Path) -> Result<(), Error> {
    remove_if_there(name)?;
    // A file system may have no second names.
    fs::hard_link(file, name).or_else(|_| fs::copy(file, name).map(drop)).map_err(Error::io(name, "write"))
}

/// Where a file of this name is written before [`settle`] gives it that name.
#[cfg(feature = "geo")]
pub(crate) fn temporary(folder: &Path, name: &str) -> PathBuf {
    folder.join(format!("{}{name}{}", TEMPORARY.0, TEMPORARY.1))
}

/// Gives a complete file its name in the same folder, durably.
#[cfg(feature = "geo")]
pub(crate) fn settle(part: &Path, path: &Path) -> io::Result<()> {
    File::options().write(true).open(part)?.sync_all()?;
    fs::rename(part, path)?;
    path.parent().map_or(Ok(()), sync_folder)
}

/// Makes a rename in `folder` last through a power cut (only Unix lets a folder be synced).
fn sync_folder(folder: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}

/// A sink that keeps length and checksum of what passes.
struct Summed<'a> {
    out: &'a mut dyn Write,
    crc: crc32fast::Hasher,
    bytes: u64,
}

impl<'a> Summed<'a> {
    fn new(out: &'a mut dyn Write) -> Self {
        Self { out, crc: crc32fast::Hasher::new(), bytes: 0 }
    }

    /// Ends with the CRC-32 of all that passed, and says it.
    fn finish(self) -> io::Result<u32> {
        let crc = self.crc.finalize();
        self.out.write_all(&crc.to_le_bytes())?;
        Ok(crc)
    }
}

impl Write for Summed<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.out.write(bytes)?;
        self.crc.update(&bytes[..written]);
        self.bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Removes the temporary files that a killed run left in `folder` and returns how many there were.
///
/// # Errors
/// [`Error::Io`] if the folder cannot be listed or a file not removed; a missing folder counts as empty.
pub fn remove_leftovers(folder: &Path) -> Result<usize, Error> {
    let entries = match fs::read_dir(folder) {
        Err(absent) if absent.kind() == io::ErrorKind::NotFound => return Ok(0),
        entries => entries.map_err(Error::io(folder, "list"))?,
    };
    let mut removed = 0;
    for entry in entries {
        let entry = entry.map_err(Error::io(folder, "list"))?;
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let letters = |rest: &str| rest.len() == 6 && rest.bytes().all(|byte| byte.is_ascii_alphanumeric());
        let raster = name.strip_prefix(RASTER).is_some_and(letters);
        if raster || (name.starts_with(TEMPORARY.0) && name.ends_with(TEMPORARY.1)) {
            fs::remove_file(entry.path()).map_err(Error::io(&entry.path(), "remove"))?;
            removed += 1;
        }
    }
    Ok(removed)
}

/// Removes a file; that there is none is no error.
///
/// # Errors
/// [`Error::Io`] naming it.
pub(crate) fn remove_if_there(path: &Path) -> Result<(), Error> {
    match fs::remove_file(path) {
        Err(absent) if absent.kind() == io::ErrorKind::NotFound => Ok(()),
        done => done.map_err(Error::io(path, "remove")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_failed_write_keeps_the_old_file_and_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/result.txt");
        whole_file(&path, |out| out.write_all(b"old")).unwrap();
        let failed = whole_file(&path, |out| {
            out.write_all(b"half of the new")?;
            Err(io::ErrorKind::StorageFull.into())
        });
        let message = failed.unwrap_err().to_string();
        assert!(message.contains("result.txt") && message.contains("--resume"), "{message}");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(path.parent().unwrap()), ["result.txt"]);
        whole_file(&path, |out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
    }

    #[test]
    fn only_our_leftovers_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        for name in [".granflow-x1.part", "granflow.part", ".granflow-notes", ".tmpAb12Cd", ".tmp-notes"] {
            fs::write(folder.path().join(name), "").unwrap();
        }
        assert_eq!(remove_leftovers(folder.path()).unwrap(), 2);
        assert_eq!(names(folder.path()), [".granflow-notes", ".tmp-notes", "granflow.part"]);
        assert_eq!(remove_leftovers(&folder.path().join("absent")).unwrap(), 0);
    }

    #[cfg(unix)]
    #[test]
    fn a_result_is_as_readable_as_any_other_file() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (ours, plain) = (folder.path().join("ours"), folder.path().join("plain"));
        whole_file(&ours, |out| out.write_all(b"x")).unwrap();
        fs::write(&plain, "x").unwrap();
        let mode = |path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }
}
