//! The folder of a run's results: one run at a time, no file of an earlier one among its own.

use super::inputs::Input;
use super::{Error, remove_if_there, remove_leftovers, whole_file};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// What a run leaves; an earlier run was here if one of the first five is there.
const FILES: [&str; 22] = [
    "checkpoint/ensemble.bin",
    "checkpoint/state.bin",
    "checkpoint/frames.bin",
    "summary.json",
    "result.nc",
    "mass.csv",
    "checkpoint/before_end.bin",
    "gauges.csv",
    "sections.csv",
    "range_time.csv",
    "outlines.geojson",
    "report.html",
    "profiles.csv",
    "profiles_node.csv",
    "maps.csv",
    "maps_node.csv",
    "animation.png",
    "result.pvd",
    "members.csv",
    "members.nc",
    "ensemble.json",
    LEFT,
];
/// The list of the files that a finished run left ([`Folder::list`]).
const LEFT: &str = "checkpoint/files.json";
const SIGNS: usize = 5;
/// What an ensemble leaves, and a run does not.
const OF_ENSEMBLE: [&str; 2] = ["checkpoint/ensemble.bin", "ensemble.json"];
const FOLDERS: [&str; 4] = ["figures", "members", "rasters", "vtk"];
/// Where the files of an earlier run go.
const ASIDE: &str = "previous";

/// The list of files, with a checksum over all of it: one with entries cut out would call a folder whole that is not.
#[derive(Serialize, Deserialize)]
struct List {
    files: Vec<Input>,
    crc: u32,
}

impl List {
    fn of(files: Vec<Input>) -> List {
        let crc = Input::checksum(&files);
        List { files, crc }
    }

    fn is_whole(&self) -> bool {
        self.crc == Input::checksum(&self.files)
    }
}

/// What an earlier run or ensemble left, in its new place; says so in a sentence.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Moved {
    /// Where it is now.
    pub to: PathBuf,
    /// It is of an ensemble.
    pub ensemble: bool,
    /// What was moved there before is gone.
    pub replaced: bool,
}

impl fmt::Display for Moved {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = if self.ensemble { "ensemble" } else { "run" };
        write!(out, "the files of an earlier {what} are now in {}", self.to.display())?;
        if self.replaced { write!(out, ", in place of those that were there") } else { Ok(()) }
    }
}

/// The lock of a folder.
#[derive(Debug)]
struct Lock {
    file: File,
    /// Process that took it.
    owner: u32,
}

impl Drop for Lock {
    /// Unlocks: to close the file is not enough where another thread starts a program meanwhile, whose process holds a copy of
    /// every open file until that program begins. A forked copy of the owner leaves the owner's lock alone.
    fn drop(&mut self) {
        if self.owner == std::process::id() {
            let _ = self.file.unlock(); // there may have been none to take
        }
    }
}

/// The folder, locked for as long as this lives; the system drops the lock with the process, however that ends.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    /// Folders that were made for this, the outer ones first.
    made: Vec<PathBuf>,
    _lock: Lock,
}

impl Folder {
    /// Makes the folder if it is not there, and takes its lock, `checkpoint/lock`.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Busy`] if another run holds the lock.
    pub fn take(path: &Path) -> Result<Folder, Error> {
        if path.exists() && !path.is_dir() {
            return Err(Error::invalid(path, "it is a file; name a folder with --out"));
        }
        let inner = path.join("checkpoint");
        let mut made: Vec<PathBuf> = inner
            .ancestors()
            .take_while(|own| !own.as_os_str().is_empty() && !own.exists())
            .map(Path::to_owned)
            .collect();
        made.reverse();
        fs::create_dir_all(&inner).map_err(Error::io(path, "make the folder"))?;
        let name = inner.join("lock");
        let refused = || Error::io(&name, "lock");
        let open = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&name);
        let mut file = open.map_err(refused())?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let mut holder = String::new();
                let _ = file.read_to_string(&mut holder); // it only makes the message longer
                return Err(Error::Busy { path: path.to_owned(), holder: holder.trim().to_owned() });
            }
            // A file system without locks is used as before there were any.
            Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {}
            Err(TryLockError::Error(error)) => return Err(refused()(error)),
        }
        let mut lock = Lock { file, owner: std::process::id() };
        let note = |lock: &mut Lock| {
            lock.file.set_len(0)?;
            lock.file.rewind()?;
            writeln!(lock.file, "process {}", lock.owner)
        };
        note(&mut lock).map_err(refused())?;
        Ok(Folder { path: path.to_owned(), made, _lock: lock })
    }

    /// Its path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Removes the temporary files that killed runs left.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn sweep(&self) -> Result<(), Error> {
        for folder in ["", "checkpoint"].iter().chain(&FOLDERS) {
            remove_leftovers(&self.path.join(folder))?;
        }
        Ok(())
    }

    /// An earlier run or ensemble was here.
    #[must_use]
    pub fn is_taken(&self) -> bool {
        FILES[..SIGNS].iter().any(|name| self.path.join(name).exists())
    }

    /// Moves what an earlier run or ensemble left into the folder `previous`, in place of what was moved there before; says what
    /// if there was anything.
    ///
    /// # Errors
    /// [`Error::Io`] naming the file that cannot be moved.
    pub fn clear(&self) -> Result<Option<Moved>, Error> {
        if !self.is_taken() {
            return Ok(None);
        }
        let aside = self.path.join(ASIDE);
        let ensemble = OF_ENSEMBLE.iter().any(|name| self.path.join(name).exists());
        let replaced = FILES.iter().chain(&FOLDERS).any(|name| aside.join(name).exists());
        for name in FILES {
            remove_if_there(&aside.join(name))?;
        }
        for name in FOLDERS.map(|name| aside.join(name)) {
            match fs::remove_dir_all(&name) {
                Err(absent) if absent.kind() == io::ErrorKind::NotFound => {}
                done => done.map_err(Error::io(&name, "remove"))?,
            }
        }
        fs::create_dir_all(aside.join("checkpoint")).map_err(Error::io(&aside, "make the folder"))?;
        for name in FILES.iter().chain(&FOLDERS) {
            let here = self.path.join(name);
            if here.exists() {
                fs::rename(&here, aside.join(name)).map_err(Error::io(&here, "move"))?;
            }
        }
        Ok(Some(Moved { to: aside, ensemble, replaced }))
    }

    /// Lists the files of a finished run with lengths and checksums, so that a lost or changed one is noticed.
    ///
    /// # Errors
    /// [`Error::Io`] naming the file that cannot be read.
    pub fn list(&self) -> Result<(), Error> {
        let mut names: Vec<String> = FILES.map(str::to_owned).into();
        names.retain(|name| name != LEFT && !name.ends_with("frames.bin") && self.path.join(name).exists());
        for folder in FOLDERS.iter().filter(|name| self.path.join(name).is_dir()) {
            let within = self.path.join(folder);
            for entry in fs::read_dir(&within).map_err(Error::io(&within, "list"))? {
                let name = entry.map_err(Error::io(&within, "list"))?.file_name();
                names.push(format!("{folder}/{}", name.to_string_lossy()));
            }
        }
        let mut files = self.sums(names)?;
        files.sort_by(|one, other| one.name.cmp(&other.name));
        let list = List::of(files);
        whole_file(&self.path.join(LEFT), |out| serde_json::to_writer(out, &list).map_err(io::Error::from))
    }

    /// Lengths and checksums of files, by a thread for each core; not rayon's, for a process that is a fork of another has none of them.
    fn sums(&self, mut names: Vec<String>) -> Result<Vec<Input>, Error> {
        // The largest is the last in the list and the first to be read.
        names.sort_by_key(|name| fs::metadata(self.path.join(name)).map_or(0, |file| file.len()));
        let threads = std::thread::available_parallelism().map_or(1, usize::from).min(names.len());
        let names = Mutex::new(names);
        let next = || names.lock().expect("nobody panics with it").pop();
        let sum = |name: String| Input::left(&self.path.join(&name), Path::new(&name));
        let some = || std::iter::from_fn(next).map(sum).collect::<Result<Vec<Input>, Error>>();
        std::thread::scope(|scope| {
            let others: Vec<_> = (1..threads).map(|_| scope.spawn(some)).collect();
            let mut files = some()?;
            for other in others {
                files.extend(other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?);
            }
            Ok(files)
        })
    }

    /// How many files a finished run left, and what became of those that are not as it left them.
    ///
    /// # Errors
    /// [`Error::Io`] naming the file that cannot be read.
    pub fn lost(&self) -> Result<(usize, Vec<String>), Error> {
        let path = self.path.join(LEFT);
        let read = fs::read_to_string(&path).ok().and_then(|text| serde_json::from_str(&text).ok());
        let Some(List { files: listed, .. }) = read.filter(List::is_whole) else {
            return Ok((0, vec![format!("{LEFT}, the list of the files, is gone or damaged")]));
        };
        let mut lost = Vec::new();
        for file in &listed {
            let path = self.path.join(&file.name);
            if !path.is_file() {
                lost.push(format!("{} is gone", file.name));
                continue;
            }
            let now = Input::left(&path, Path::new(&file.name))?;
            if now.bytes != file.bytes {
                lost.push(format!(
                    "{} has {} bytes, {} when the run left it",
                    file.name, now.bytes, file.bytes
                ));
            } else if now != *file {
                lost.push(format!("{} is altered", file.name));
            }
        }
        Ok((listed.len(), lost))
    }

    /// Removes what [`Folder::take`] made, for a run that could not begin.
    pub fn abandon(self) {
        if !self.made.is_empty() {
            let _ = fs::remove_file(self.path.join("checkpoint/lock"));
            for folder in self.made.iter().rev() {
                let _ = fs::remove_dir(folder); // one that is no longer empty stays
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_run_is_refused_until_the_first_has_ended() {
        let outside = tempfile::tempdir().unwrap();
        let path = outside.path().join("deep/out");
        let first = Folder::take(&path).unwrap();
        let message = Folder::take(&path).unwrap_err().to_string();
        for part in ["out", &std::process::id().to_string(), "--out"] {
            assert!(message.contains(part), "{message}");
        }
        // what a process that is just being started holds of every open file
        let copy = first._lock.file.try_clone().unwrap();
        drop(first);
        Folder::take(&path).unwrap().abandon();
        drop(copy);
        assert!(path.exists(), "it was there before");
        let other = outside.path().join("new/out");
        Folder::take(&other).unwrap().abandon();
        assert!(!outside.path().join("new").exists());
        fs::write(outside.path().join("file"), "x").unwrap();
        assert!(Folder::take(&outside.path().join("file")).unwrap_err().to_string().contains("it is a file"));
    }

    #[test]
    fn an_earlier_run_is_moved_aside_and_other_files_stay() {
        let outside = tempfile::tempdir().unwrap();
        let folder = Folder::take(outside.path()).unwrap();
        let at = |name: &str| outside.path().join(name);
        let write = |name: &str, text: &str| {
            fs::create_dir_all(at(name).parent().unwrap()).unwrap();
            fs::write(at(name), text).unwrap();
        };
        write("figures/own.png", "x");
        write("maps.csv", "x");
        assert_eq!(folder.clear().unwrap(), None, "nothing says that a run was here");
        for run in ["first", "second"] {
            write("summary.json", run);
            write("notes.txt", run);
            write("checkpoint/state.bin", run);
            write(&format!("figures/{run}.png"), run);
            let moved = folder.clear().unwrap().unwrap();
            assert_eq!((moved.to, moved.ensemble, moved.replaced), (at("previous"), false, run == "second"));
            assert_eq!(fs::read_to_string(at("previous/summary.json")).unwrap(), run);
            assert_eq!(fs::read_to_string(at("previous/checkpoint/state.bin")).unwrap(), run);
            assert!(at(&format!("previous/figures/{run}.png")).exists() && !at("figures").exists());
            assert_eq!(fs::read_to_string(at("notes.txt")).unwrap(), run);
        }
        assert!(!at("previous/figures/first.png").exists());
        write("checkpoint/ensemble.bin", "x");
        let told = folder.clear().unwrap().unwrap().to_string();
        assert!(
            told.contains("earlier ensemble") && told.ends_with("in place of those that were there"),
            "{told}"
        );
        assert!(Folder::take(outside.path()).is_err(), "the lock stays where it is");
    }
}
