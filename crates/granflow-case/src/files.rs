//! The files that a case names, and what reads them.

use std::cell::RefCell;
use std::fmt::Debug;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::fault::CaseError;
use super::file_kind::FileKind;
use super::nearest::nearest;

/// What reads the files that a case names: the disk, unless a method says otherwise.
pub trait FileAccess {
    /// The polygons of a file, as one part of the plane.
    ///
    /// # Errors
    /// What is wrong with the file, naming it.
    fn outlines(&self, path: &Path) -> Result<Box<dyn Outline>, String>;

    /// The numbers that an attribute of the features of a file holds, in their order, none negative.
    ///
    /// # Errors
    /// What is wrong with the file, naming it.
    fn numbers(&self, path: &Path, attribute: &str) -> Result<Vec<f64>, String> {
        Err(format!("{}: the attribute `{attribute}` cannot be read here", path.display()))
    }

    /// The kinds of files that a case may ask for.
    fn kinds(&self) -> &'static [FileKind] {
        &[]
    }

    /// Whether there is a file of this name.
    ///
    /// # Errors
    /// Why it cannot be read.
    fn find(&self, path: &Path) -> io::Result<()> {
        on_disk(path)
    }

    /// The content of a file.
    ///
    /// # Errors
    /// Why it cannot be read.
    fn bytes(&self, path: &Path) -> io::Result<Vec<u8>> {
        std::fs::read(path)
    }

    /// Names of the files in a folder, `None` if there is no such folder.
    fn names(&self, folder: &Path) -> Option<Vec<String>> {
        let entries = std::fs::read_dir(folder).ok()?.flatten();
        let files = entries.filter(|entry| entry.path().is_file());
        Some(files.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect())
    }
}

/// Whether there is a file of this name on the disk.
///
/// # Errors
/// Why it cannot be read.
pub fn on_disk(path: &Path) -> io::Result<()> {
    match std::fs::metadata(path)?.is_file() {
        true => Ok(()),
        false => Err(io::Error::new(io::ErrorKind::InvalidInput, "it is not a file")),
    }
}

/// A part of the plane that polygons bound, with its rim and without their holes.
pub trait Outline: Debug + Send + Sync {
    /// Whether a place belongs to it.
    fn holds(&self, place: [f64; 2]) -> bool;
    /// Distance of a place from the rim, positive within.
    fn depth(&self, place: [f64; 2]) -> f64;
    /// The ends [low, high] along x and y.
    fn bounds(&self) -> [[f64; 2]; 2];
}

/// There are no files: every case that names one is refused.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoFiles;

impl NoFiles {
    const REFUSED: &str = "files are not read here";
}

impl FileAccess for NoFiles {
    fn outlines(&self, _path: &Path) -> Result<Box<dyn Outline>, String> {
        Err(Self::REFUSED.to_owned())
    }

    fn find(&self, _path: &Path) -> io::Result<()> {
        Err(io::Error::new(io::ErrorKind::Unsupported, Self::REFUSED))
    }

    fn bytes(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.find(path).map(|()| Vec::new())
    }

    fn names(&self, _folder: &Path) -> Option<Vec<String>> {
        Some(Vec::new())
    }
}

/// Files that keep the names of those that were asked for.
pub(crate) struct Asked<'a> {
    files: &'a dyn FileAccess,
    names: RefCell<Vec<PathBuf>>,
}

impl<'a> Asked<'a> {
    pub fn new(files: &'a dyn FileAccess) -> Self {
        Self { files, names: RefCell::default() }
    }

    fn note(&self, path: &Path) {
        self.names.borrow_mut().push(path.to_owned());
    }

    /// The names, each once.
    pub fn into_names(self) -> Vec<PathBuf> {
        let mut names = self.names.into_inner();
        names.sort();
        names.dedup();
        names
    }
}

impl FileAccess for Asked<'_> {
    fn outlines(&self, path: &Path) -> Result<Box<dyn Outline>, String> {
        self.note(path);
        self.files.outlines(path)
    }

    fn numbers(&self, path: &Path, attribute: &str) -> Result<Vec<f64>, String> {
        self.note(path);
        self.files.numbers(path, attribute)
    }

    fn kinds(&self) -> &'static [FileKind] {
        self.files.kinds()
    }

    fn find(&self, path: &Path) -> io::Result<()> {
        self.note(path);
        self.files.find(path)
    }

    fn bytes(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.note(path);
        self.files.bytes(path)
    }

    fn names(&self, folder: &Path) -> Option<Vec<String>> {
        self.files.names(folder)
    }
}

/// The disk, without a reader of polygons; it finds the case file itself.
struct Disk;

impl FileAccess for Disk {
    fn outlines(&self, path: &Path) -> Result<Box<dyn Outline>, String> {
        NoFiles.outlines(path)
    }
}

/// A longer text is no case [bytes].
const LONGEST: u64 = 1 << 24;

/// The text of a case file; one that cannot be read is answered with the nearest name that exists, and nothing is shown of one that
/// is no case: no line of it begins with one of `tables`.
pub(crate) fn read_case(path: &Path, tables: &[String]) -> Result<String, CaseError> {
    let name = path.display().to_string();
    let bytes = start_of(path).map_err(|error| {
        with_neighbour(
            CaseError::unreadable(&name, format!("cannot read the case file: {error}")),
            path,
            &Disk,
        )
    })?;
    let unlike = |why: &str| {
        CaseError::new(&name, "", None, "", format!("this is no case file: {why}"))
            .help("`granflow new --list` shows the kinds of cases to start from")
    };
    if bytes.len() as u64 > LONGEST {
        return Err(unlike("it is longer than 16 MiB"));
    }
    let text = String::from_utf8(bytes).map_err(|_| unlike("it is not UTF-8 text").file())?;
    if !text.lines().any(|line| tables.iter().any(|table| table == first_word(line))) {
        let tables = tables.iter().map(|table| format!("[{table}]")).collect::<Vec<_>>().join(", ");
        return Err(unlike(&format!("it has none of the tables {tables}")));
    }
    Ok(text)
}

/// Opens a file to be read; a pipe or a device is refused, for opening a pipe waits for somebody who writes into it.
///
/// # Errors
/// Why it cannot be read.
pub fn open_file(path: &Path) -> io::Result<File> {
    let kind = std::fs::metadata(path)?.file_type();
    if !kind.is_file() {
        let what = if kind.is_dir() { "a folder" } else { "a pipe or a device" };
        return Err(io::Error::new(io::ErrorKind::InvalidInput, format!("it is {what}, not a file")));
    }
    File::open(path)
}

/// The content of a file, as far as it may be a case.
fn start_of(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open_file(path)?.take(LONGEST + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The table or key that a line of TOML begins with.
fn first_word(line: &str) -> &str {
    let line = line.trim_start_matches(['[', '"', '\'', ' ', '\t', '\u{feff}']);
    let end = line.find(|sign: char| !sign.is_ascii_alphanumeric() && sign != '_');
    &line[..end.unwrap_or(line.len())]
}

/// Adds the nearest name to an error about a file that cannot be read.
pub(crate) fn with_neighbour(error: CaseError, path: &Path, files: &dyn FileAccess) -> CaseError {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let wanted = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let Some(names) = files.names(folder) else {
        if files.find(folder).is_ok() {
            return error.help(format!("{} is a file, not a folder", folder.display()));
        }
        return error.help(format!("the folder {} does not exist", folder.display()));
    };
    match nearest(&wanted, names.iter().map(String::as_str).filter(|name| *name != wanted)) {
        Some(near) => error.help(format!("did you mean `{}`?", path.with_file_name(near).display())),
        None => error,
    }
}
