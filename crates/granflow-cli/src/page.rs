//! What `granflow reproduce` and `granflow verify` share: the rows, the pictures and the page that they write.

use std::fs;
use std::path::Path;
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
    /// Its place and what stands below it.
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

/// Makes the folder of the results, before any work starts.
pub fn folder(out: &Path) -> Result<(), Failure> {
    fs::create_dir_all(out).map_err(|error| {
        if out.exists() {
            Failure::usage(
                format!("the results cannot go to {}: it is a file", out.display()),
                "--out takes a folder, which is made where there is none",
            )
        } else {
            Failure::file("make", out, &error)
        }
    })
}

/// Draws the pictures and writes `tables.json` and `index.html` into `out`; what to say on the terminal.
pub fn write(out: &Path, title: &str, rows: &[Row], chapters: Vec<Chapter>) -> Result<String, Failure> {
    let pictures: Vec<&Picture> = chapters.iter().flat_map(|chapter| &chapter.pictures).collect();
    let drawn = pictures.len();
    parallel(drawn, |k| (pictures[k].draw)(&pictures[k].figure.path))
        .into_iter()
        .collect::<Result<(), PictureError>>()
        .map_err(|error| Failure::File(error.to_string()))?;
    let written = |result: Result<(), granflow::output::Error>| {
        result.map_err(|error| Failure::File(error.to_string()))
    };
    written(tables::write(&out.join("tables.json"), rows))?;
    let index = out.join("index.html");
    let sections: Vec<Section> = chapters.into_iter().map(Chapter::section).collect();
    written(report::write_index(&index, title, rows, &sections))?;
    Ok(short_table(rows, drawn, &index))
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
