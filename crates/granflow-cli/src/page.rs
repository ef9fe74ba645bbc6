//! What `granflow reproduce` and `granflow verify` share: the rows, the pictures and the page that they write.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use granflow::case::nearest;
use granflow::output::figures::PictureError;
use granflow::output::report::{self, Figure, Section, Table};
use granflow::output::tables::{self, Row};

use crate::failure::Failure;

/// Draws a picture into a file.
pub type Draw<'a> = Box<dyn Fn(&Path) -> Result<(), PictureError> + Sync + 'a>;

/// A picture still to be drawn.
pub struct Picture<'a> {
    /// Its place, from the folder of the page on, and what stands below it.
    pub figure: Figure,
    /// What draws it.
    pub draw: Draw<'a>,
}

/// A section of the page with pictures still to be drawn.
#[derive(Default)]
pub struct Chapter<'a> {
    /// Heading.
    pub title: String,
    /// One paragraph each.
    pub text: Vec<String>,
    /// The tables, after the text.
    pub tables: Vec<Table>,
    /// The pictures, in order.
    pub pictures: Vec<Picture<'a>>,
}

impl Chapter<'_> {
    fn section(self) -> Section {
        let figures = self.pictures.into_iter().map(|picture| picture.figure).collect();
        Section { title: self.title, text: self.text, tables: self.tables, figures, ..Section::default() }
    }
}

/// The folder of the results. All files of a page are made in a folder beside them and then take their places, so that an
/// earlier page stays whole until the new one is.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    /// There was none before.
    made: bool,
}

impl Folder {
    /// Makes the folder, before any work starts.
    pub fn make(out: &Path) -> Result<Self, Failure> {
        let folder = Folder { path: out.to_owned(), made: !out.exists() };
        let made = fs::create_dir_all(out).map_err(|error| {
            if out.exists() {
                Failure::usage(
                    format!("the results cannot go to {}: it is a file", out.display()),
                    "--out takes a folder, which is made where there is none",
                )
            } else {
                Failure::file("make", out, &error)
            }
        });
        made.map(|()| folder)
    }

    /// Draws the pictures and writes `tables.json` and `index.html`; what to say on the terminal.
    pub fn write(&self, title: &str, rows: &[Row], mut chapters: Vec<Chapter>) -> Result<String, Failure> {
        let stage = Stage::make(&self.path)?;
        let failed = |error: &dyn std::fmt::Display| {
            Failure::File(format!(
                "{}: the page cannot be written, what was there before is as it was: {error}; make room, or choose another folder with --out",
                self.path.display()
            ))
        };
        for picture in chapters.iter_mut().flat_map(|chapter| &mut chapter.pictures) {
            picture.figure.path = stage.place(&picture.figure.path);
        }
        let pictures: Vec<&Picture> = chapters.iter().flat_map(|chapter| &chapter.pictures).collect();
        let drawn = pictures.len();
        let mut files: Vec<PathBuf> = pictures.iter().map(|picture| picture.figure.path.clone()).collect();
        parallel(drawn, |k| (pictures[k].draw)(&pictures[k].figure.path))
            .into_iter()
            .collect::<Result<(), PictureError>>()
            .map_err(|error| failed(&error))?;
        files.extend([TABLES, INDEX].map(|name| stage.place(Path::new(name))));
        tables::write(&stage.place(Path::new(TABLES)), rows).map_err(|error| failed(&error))?;
        let sections: Vec<Section> = chapters.into_iter().map(Chapter::section).collect();
        report::write_index(&stage.place(Path::new(INDEX)), title, rows, &sections)
            .map_err(|error| failed(&error))?;
        files.iter().try_for_each(|file| stage.settle(file))?;
        Ok(short_table(rows, drawn, &self.path.join(INDEX)))
    }

    /// What an interruption says where nothing was complete.
    pub fn nothing(&self, what: &str) -> Failure {
        let rest = if self.made { "nothing was written" } else { "what was there before is as it was" };
        Failure::Interrupted(format!(
            "{}: {what} was complete, {rest}; the same command starts again",
            self.path.display()
        ))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        if self.made {
            // Only an empty one goes.
            let _ = fs::remove_dir(&self.path);
        }
    }
}

/// The folder of the pictures, beside the page.
pub const FIGURES: &str = "figures";
const TABLES: &str = "tables.json";
const INDEX: &str = "index.html";

/// The folder in which the files of a page are made; it goes with what is still in it.
struct Stage<'a> {
    path: PathBuf,
    out: &'a Path,
}

impl<'a> Stage<'a> {
    fn make(out: &'a Path) -> Result<Self, Failure> {
        let path = out.join(".granflow-page.part");
        let failed = |error| Failure::file("make", &path, &error);
        if path.exists() {
            // Of a command that was killed.
            fs::remove_dir_all(&path).map_err(failed)?;
        }
        fs::create_dir(&path).map_err(failed)?;
        Ok(Stage { path, out })
    }

    fn place(&self, name: &Path) -> PathBuf {
        self.path.join(name)
    }

    /// Gives a file that was made here its place.
    fn settle(&self, file: &Path) -> Result<(), Failure> {
        let place = self.out.join(file.strip_prefix(&self.path).unwrap_or(file));
        let folder = place.parent().unwrap_or(self.out);
        fs::create_dir_all(folder)
            .and_then(|()| fs::rename(file, &place))
            .map_err(|error| Failure::file("write", &place, &error))
    }
}

impl Drop for Stage<'_> {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.path);
    }
}

/// The answer to a name that is not among `names`; `kind` says what it should name, `list` how the names are shown.
pub fn unknown<'a>(
    kind: &str,
    name: &str,
    names: impl IntoIterator<Item = &'a str>,
    list: &[String],
) -> Failure {
    let near = nearest(name, names).map(|near| format!("did you mean `{near}`? ")).unwrap_or_default();
    Failure::usage(
        format!("there is no {kind} `{name}`"),
        format!("{near}allowed: {}; none for all", list.join(", ")),
    )
}

/// Does numbered pieces of work on all cores, each piece on one; the results are in order.
pub fn parallel<T: Send>(count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZeroUsize::get);
    let worker = || {
        // A small grid does not repay the traffic between threads.
        let _alone = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
        let mut done = Vec::new();
        loop {
            let k = next.fetch_add(1, Ordering::Relaxed);
            if k >= count {
                return done;
            }
            done.push((k, work(k)));
        }
    };
    let mut all: Vec<(usize, T)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..cores.min(count)).map(|_| scope.spawn(worker)).collect();
        let results = workers.into_iter().map(std::thread::ScopedJoinHandle::join);
        results.flat_map(|done| done.unwrap_or_else(|panic| std::panic::resume_unwind(panic))).collect()
    });
    all.sort_by_key(|(k, _)| *k);
    all.into_iter().map(|(_, result)| result).collect()
}

/// Passed and failed rows by name, for the terminal.
fn short_table(rows: &[Row], figures: usize, index: &Path) -> String {
    let mut names: Vec<&str> = rows.iter().map(|row| row.name.as_str()).collect();
    names.dedup();
    let count = |name: &str, pass| rows.iter().filter(|row| row.name == name && row.pass() == pass).count();
    let width = names.iter().map(|name| name.chars().count()).max().unwrap_or(0);
    let lines = names
        .iter()
        .map(|name| format!("{name:width$}  {:6}  {:6}\n", count(name, true), count(name, false)));
    let table: String = [format!("{:width$}  passed  failed\n", "")].into_iter().chain(lines).collect();
    let failing: String = (rows.iter().filter(|row| !row.pass()))
        .map(|row| {
            format!("FAIL {}, {}: {:?}, computed {}\n", row.name, row.quantity, row.expected, row.computed)
        })
        .collect();
    let fail = rows.iter().filter(|row| !row.pass()).count();
    format!("{table}{failing}{} of {} rows fail; {figures} figures: {}\n", fail, rows.len(), index.display())
}
