//! What `granflow bench` prints and writes.

use std::fmt::Write;
use std::path::PathBuf;

use granflow::output::whole_file;
use granflow::simulation::{SimdLevel, Traffic};
use granflow::speed::{Load, Setup, Spell, Triad, median};
use serde_json::{Value, json};

use super::beside::{When, Yardstick};
use crate::failure::Failure;

/// One measurement.
pub struct Row {
    scheme: &'static str,
    about: &'static str,
    cells: Vec<usize>,
    threads: usize,
    /// Of each repeat, 10^6 cell updates a second.
    repeats: Vec<f64>,
    /// Share of the time that the threads had a core, where the system tells.
    busy: Option<f64>,
    traffic: Traffic,
}

impl Row {
    /// From what was timed.
    pub fn new(setup: &Setup, cells: usize, threads: usize, load: &dyn Load, spells: &[Spell]) -> Row {
        let computing: Option<f64> = spells.iter().map(|spell| spell.computing).sum();
        let wall: f64 = spells.iter().map(|spell| spell.wall).sum();
        Row {
            scheme: setup.name,
            about: setup.about,
            cells: vec![cells; setup.dimensions],
            threads,
            repeats: spells.iter().map(|spell| spell.mcups(load.cells())).collect(),
            busy: computing.map(|computing| computing / (wall * threads as f64)),
            traffic: load.traffic(),
        }
    }
    fn mcups(&self) -> f64 {
        median(self.repeats.iter().copied())
    }
    /// Nanoseconds of one thread for a cell.
    fn nanoseconds(&self) -> f64 {
        1e3 * self.threads as f64 / self.mcups()
    }
    /// Half of the way from the slowest to the fastest repeat, as a share of the median.
    fn spread(&self) -> f64 {
        let most = self.repeats.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let least = self.repeats.iter().copied().fold(f64::INFINITY, f64::min);
        0.5 * (most - least) / self.mcups()
    }
    fn grid(&self) -> String {
        self.cells.iter().map(usize::to_string).collect::<Vec<_>>().join(" x ")
    }
}

/// Everything that was measured so far.
pub struct Report {
    json: Option<PathBuf>,
    instructions: SimdLevel,
    /// Share of the grid that is wet.
    wet: f64,
    quick: bool,
    /// Bytes of an array of the triad, and its bytes a second by number of threads.
    pub array: usize,
    pub triad: Vec<(usize, f64)>,
    /// What the command beside said.
    pub yardsticks: Vec<Yardstick>,
    rows: Vec<Row>,
    /// All is measured.
    pub complete: bool,
}

impl Report {
    /// Nothing yet; `json` is the file to write.
    pub fn new(json: Option<PathBuf>, instructions: SimdLevel, wet: f64, quick: bool) -> Report {
        let (triad, yardsticks, rows) = (Vec::new(), Vec::new(), Vec::new());
        Report { json, instructions, wet, quick, array: 0, triad, yardsticks, rows, complete: false }
    }

    /// What stands above the table.
    pub fn head(&self) -> String {
        let mut text = format!("instructions: {}\n", self.instructions.found());
        let of = format!("{} bytes a number, arrays of {:.0} MiB", Triad::BYTES, mebibytes(self.array));
        let speeds: Vec<String> = self.triad.iter().map(|(t, b)| format!("{:.1} on {t}", 1e-9 * b)).collect();
        let _ = writeln!(text, "triad: {} threads, GB/s ({of})", speeds.join(", "));
        if self.wet < 1.0 {
            let _ = writeln!(
                text,
                "wet: {} of the cells, the others sleep; Mcups and ns are of all cells",
                self.wet
            );
        }
        if self.quick {
            text += "a try: repeats too short and arrays too small for numbers to be quoted\n";
        }
        text += "bytes: read + written + fetched to be written over; of triad: those bytes as a share of its bandwidth\n\n";
        let names = ["Mcups", "+-", "ns", "bytes", "of triad", "of first", "speed-up", "busy"];
        text += &begun("scheme", "cells", "threads");
        for (name, width) in names.iter().zip(WIDTHS) {
            let _ = write!(text, " {name:>width$}");
        }
        text + "\n"
    }

    /// Takes a row and gives its line.
    pub fn add(&mut self, row: Row) -> String {
        let Traffic { read, written, allocated } = row.traffic;
        let ratio = |other: Option<&Row>| match other {
            Some(other) => format!("{:.2}", row.mcups() / other.mcups()),
            None => String::new(),
        };
        let first = self.rows.iter().find(|other| other.threads == row.threads);
        let same = |other: &&Row| (other.scheme, &other.cells) == (row.scheme, &row.cells);
        let alone = self.rows.iter().filter(same).find(|other| other.threads == 1);
        let columns = [
            format!("{:.1}", row.mcups()),
            format!("{:.0} %", 100.0 * row.spread()),
            format!("{:.1}", row.nanoseconds()),
            format!("{read:.0}+{written:.0}+{allocated:.0}"),
            self.share(&row).map_or_else(String::new, |share| format!("{:.0} %", 100.0 * share)),
            ratio(first),
            ratio(alone),
            row.busy.map_or_else(String::new, |busy| format!("{:.0} %", 100.0 * busy)),
        ];
        let mut line = begun(row.scheme, &row.grid(), row.threads);
        for (column, width) in columns.iter().zip(WIDTHS) {
            let _ = write!(line, " {column:>width$}");
        }
        self.rows.push(row);
        line.trim_end().to_owned() + "\n"
    }

    /// Share of the bandwidth of the triad on the same threads, if every cell was computed.
    fn share(&self, row: &Row) -> Option<f64> {
        if self.wet < 1.0 {
            return None;
        }
        let (_, bandwidth) = self.triad.iter().find(|(threads, _)| *threads == row.threads)?;
        Some(row.traffic.sum() * 1e6 * row.mcups() / bandwidth)
    }

    /// The yardsticks' names, in their order, with the speed on so many threads before and after.
    fn columns(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for yardstick in &self.yardsticks {
            if !names.contains(&yardstick.name.as_str()) {
                names.push(&yardstick.name);
            }
        }
        names
    }

    fn yardstick(&self, name: &str, threads: usize, when: Option<When>) -> Option<f64> {
        let fits = |found: &&Yardstick| {
            found.name == name && found.threads == threads && when.is_none_or(|when| found.when == when)
        };
        let speed = median(self.yardsticks.iter().filter(fits).map(|found| found.mcups));
        speed.is_finite().then_some(speed)
    }

    /// Our rows as ratios to what ran beside, on the same number of threads: to the mean of before and after.
    pub fn ratios(&self) -> String {
        let names = self.columns();
        let width = names.iter().map(|name| name.len()).max().unwrap_or(0).max(12);
        let cell = |number: Option<f64>, digits: usize| {
            number.map_or_else(|| format!(" {:>width$}", ""), |number| format!(" {number:>width$.digits$}"))
        };
        let mut text = format!("\n{}", begun("beside", "", ""));
        names.iter().for_each(|name| text += &format!(" {name:>width$}"));
        let mut counts: Vec<usize> = self.yardsticks.iter().map(|yardstick| yardstick.threads).collect();
        counts.sort_unstable();
        counts.dedup();
        for threads in counts {
            for (when, word) in [(When::Before, "before"), (When::After, "after")] {
                let _ = write!(text, "\n{}", begun(&format!("Mcups, {word}"), "", threads));
                names.iter().for_each(|name| text += &cell(self.yardstick(name, threads, Some(when)), 1));
            }
        }
        text += "\nratios\n";
        for row in &self.rows {
            text += &begun(row.scheme, &row.grid(), row.threads);
            for name in &names {
                text += &cell(self.yardstick(name, row.threads, None).map(|speed| row.mcups() / speed), 2);
            }
            text += "\n";
        }
        text
    }

    /// The end by a signal: the rows that were measured stay, a file without any goes.
    pub fn interrupted(&self) -> Failure {
        let rows = self.rows.len();
        let file = match &self.json {
            Some(path) if rows == 0 => match std::fs::remove_file(path) {
                Ok(()) => format!("; {} would be empty and is removed", path.display()),
                Err(error) => return Failure::file("remove", path, &error),
            },
            Some(path) => format!("; {} holds them, with `complete` false", path.display()),
            None => String::new(),
        };
        Failure::Interrupted(format!(
            "{rows} rows are measured{file}; the same command starts again, --scheme measures one"
        ))
    }

    /// Writes the file, if there is to be one.
    pub fn save(&self) -> Result<(), Failure> {
        let Some(path) = &self.json else { return Ok(()) };
        let text = format!("{:#}\n", self.to_json());
        whole_file(path, |out| out.write_all(text.as_bytes()))
            .map_err(|error| Failure::File(error.to_string()))
    }

    fn to_json(&self) -> Value {
        let triad = |(threads, bandwidth): &(usize, f64)| json!({ "threads": threads, "bytes_per_second": bandwidth });
        let yardstick = |found: &Yardstick| {
            let when = if found.when == When::Before { "before" } else { "after" };
            json!({ "when": when, "threads": found.threads, "name": found.name, "mcups": found.mcups })
        };
        let row = |row: &Row| {
            let ratios = self.columns().into_iter().filter_map(|name| {
                let speed = self.yardstick(name, row.threads, None)?;
                Some((name.to_owned(), json!(row.mcups() / speed)))
            });
            json!({
                "scheme": row.scheme,
                "about": row.about,
                "cells": row.cells,
                "threads": row.threads,
                "mcups": row.mcups(),
                "repeats": row.repeats,
                "ns_per_cell": row.nanoseconds(),
                "bytes_per_cell": {
                    "read": row.traffic.read,
                    "written": row.traffic.written,
                    "allocated": row.traffic.allocated,
                },
                "share_of_triad": self.share(row),
                "busy": row.busy,
                "ratios": ratios.collect::<serde_json::Map<_, _>>(),
            })
        };
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            "instructions": self.instructions.found(),
            "cores": std::thread::available_parallelism().map_or(0, std::num::NonZeroUsize::get),
            "quick": self.quick,
            "wet": self.wet,
            "complete": self.complete,
            "triad": {
                "bytes_per_number": Triad::BYTES,
                "array_bytes": self.array,
                "measured": self.triad.iter().map(triad).collect::<Vec<_>>(),
            },
            "rows": self.rows.iter().map(row).collect::<Vec<_>>(),
            "beside": self.yardsticks.iter().map(yardstick).collect::<Vec<_>>(),
        })
    }
}

/// The first three columns of a line.
fn begun(scheme: &str, cells: &str, threads: impl std::fmt::Display) -> String {
    format!("{scheme:23} {cells:>13} {threads:>7}")
}

/// Of the columns from Mcups on.
const WIDTHS: [usize; 8] = [8, 5, 8, 11, 8, 8, 8, 6];

fn mebibytes(bytes: usize) -> f64 {
    bytes as f64 / f64::from(1 << 20)
}
