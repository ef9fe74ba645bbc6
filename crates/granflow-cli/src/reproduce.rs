//! `granflow reproduce`: the tables and figures of the papers, ours beside theirs.

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use granflow::case::nearest;
use granflow::output::figures::PictureError;
use granflow::output::report::{self, Figure, Section, Table};
use granflow::output::tables::{self, Row};

use crate::failure::{Failure, print};

mod kinetic;
mod sandpiles;

/// What stands beside values that no paper prints: the papers' schemes, transcribed and run independently.
const INDEPENDENT: &str = "independent run of the printed scheme";

/// Draws a picture into a file.
type Draw<'a> = Box<dyn Fn(&Path) -> Result<(), PictureError> + Sync + 'a>;

/// A picture still to be drawn.
struct Picture<'a> {
    figure: Figure,
    draw: Draw<'a>,
}

/// A section of the page with pictures still to be drawn.
#[derive(Default)]
struct Chapter<'a> {
    title: String,
    text: Vec<String>,
    tables: Vec<Table>,
    pictures: Vec<Picture<'a>>,
}

impl Chapter<'_> {
    fn section(self) -> Section {
        let figures = self.pictures.into_iter().map(|picture| picture.figure).collect();
        Section { title: self.title, text: self.text, tables: self.tables, figures }
    }
}

/// Computes the tables and figures of a paper, or of all.
pub fn reproduce(paper: Option<&str>, out: &Path) -> Result<(), Failure> {
    let wanted = |names: [&str; 2]| paper.is_none_or(|paper| names.contains(&paper));
    if !names().any(wanted) {
        return Err(unknown(paper.unwrap_or_default()));
    }
    let papers: Vec<_> = kinetic::PAPERS.iter().filter(|paper| wanted(paper.names())).collect();
    let flows = if papers.is_empty() { None } else { Some(kinetic::Runs::compute()?) };
    let piles = if wanted(sandpiles::NAMES) { Some(sandpiles::Runs::compute()?) } else { None };

    let (mut rows, mut chapters) = (Vec::new(), Vec::new());
    let folder = out.join("figures");
    if let Some(runs) = &flows {
        rows.extend(papers.iter().flat_map(|paper| kinetic::rows(paper, runs)));
        chapters.extend(kinetic::chapters(&papers, runs, &folder));
    }
    if let Some(runs) = &piles {
        rows.extend(sandpiles::rows(runs));
        chapters.extend(sandpiles::chapters(runs, &folder));
    }
    let pictures: Vec<&Picture> = chapters.iter().flat_map(|chapter| &chapter.pictures).collect();
    let drawn = pictures.len();
    parallel(drawn, |k| (pictures[k].draw)(&pictures[k].figure.path))
        .into_iter()
        .collect::<Result<(), PictureError>>()
        .map_err(|error| Failure::File(error.to_string()))?;
    let written = |result: Result<(), granflow::output::Error>| {
        result.map_err(|error| Failure::File(error.to_string()))
    };
    written(tables::write(&out.join("tables.json"), &rows))?;
    let index = out.join("index.html");
    let sections: Vec<Section> = chapters.into_iter().map(Chapter::section).collect();
    written(report::write_index(&index, "The papers, reproduced", &rows, &sections))?;
    print(&short_table(&rows, drawn, &index))
}

/// The papers' names, each with its shorter one.
fn names() -> impl Iterator<Item = [&'static str; 2]> {
    kinetic::PAPERS.iter().map(kinetic::Paper::names).chain([sandpiles::NAMES])
}

fn unknown(name: &str) -> Failure {
    let near =
        nearest(name, names().flatten()).map(|near| format!("did you mean `{near}`? ")).unwrap_or_default();
    let list: Vec<String> = names().map(|[name, short]| format!("{name} (or {short})")).collect();
    Failure::usage(
        format!("there is no paper `{name}`"),
        format!("{near}allowed: {}; none for all", list.join(", ")),
    )
}

/// Does numbered pieces of work on all cores; the results are in order.
fn parallel<T: Send>(count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZeroUsize::get);
    let worker = || {
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
