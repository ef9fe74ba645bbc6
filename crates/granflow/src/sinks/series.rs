//! Gauges and sections as a run goes: lines of `gauges.csv` and `sections.csv`, on the disk or in memory.

use crate::output::Error;
use crate::output::lines::{Lines, Table};
use crate::output::mark::Mark;
use crate::run::{Run, after};
use crate::watch::Watch;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The files, and their headers.
const FILES: [(&str, &str); 2] = [
    ("gauges.csv", "name,time,thickness,velocity_x,velocity_y,speed,pressure"),
    ("sections.csv", "name,time,discharge,volume,thickness,pressure"),
];
/// Whoever writes lines takes them once they have so many bytes, and before a frame, a checkpoint and the end.
const HELD: usize = 1 << 16;

/// What is looked at, and when next.
pub(super) struct Series {
    watch: Watch,
    /// Numbers of the fields that are looked at, where the run has them: thickness, velocities, speed.
    fields: [Option<usize>; 4],
    every: Option<f64>,
    next: f64,
    /// Time of the last lines.
    written: f64,
    held: [String; 2],
}

impl Series {
    /// Nothing has been looked at yet; `run` is asked to count what passes the sections.
    pub fn new(watch: Watch, every: Option<f64>, run: &mut dyn Run) -> Series {
        if !watch.sections.is_empty() {
            run.track_passage(watch.sections.iter().map(|section| section.faces.clone()).collect());
        }
        let series = run.plane().series();
        let number = |name: &str| series.iter().position(|field| field.name == name);
        let fields = ["thickness", "velocity_x", "velocity_y", "speed"].map(number);
        let (next, written) = (f64::INFINITY, f64::NEG_INFINITY);
        Series { watch, fields, every, next, written, held: Default::default() }
    }

    fn is_used(&self) -> [bool; 2] {
        [!self.watch.gauges.is_empty(), !self.watch.sections.is_empty()]
    }

    /// The paths of the files that there are.
    pub fn paths(&self, directory: &Path) -> [Option<PathBuf>; 2] {
        let used = self.is_used();
        [0, 1].map(|k| used[k].then(|| directory.join(FILES[k].0)))
    }

    /// The path that the case names.
    pub fn path(&self) -> Option<Vec<[f64; 2]>> {
        self.watch.path.clone()
    }

    /// Begin the files.
    pub fn create(&self, directory: &Path) -> Result<[Option<Lines>; 2], Error> {
        self.opened(directory, |k, path| Lines::create(path, FILES[k].1))
    }

    /// Take the files up at their marks.
    pub fn resume(&self, directory: &Path, marks: [Mark; 2]) -> Result<[Option<Lines>; 2], Error> {
        self.opened(directory, |k, path| Lines::resume(path, FILES[k].1, marks[k]))
    }

    fn opened(
        &self,
        directory: &Path,
        open: impl Fn(usize, &Path) -> Result<Lines, Error>,
    ) -> Result<[Option<Lines>; 2], Error> {
        let [gauges, sections] = self.paths(directory);
        let gauges = gauges.map(|path| open(0, &path)).transpose()?;
        Ok([gauges, sections.map(|path| open(1, &path)).transpose()?])
    }

    /// The next instant at which it wants to look; infinite where it looks after every step, or at nothing.
    pub fn next(&self) -> f64 {
        self.next
    }

    /// Time between two looks; infinite where it looks after every step.
    pub fn every(&self) -> f64 {
        self.every.unwrap_or(f64::INFINITY)
    }

    /// Go on with this instant, the last lines being those of `time`.
    pub fn resumed(&mut self, next: f64, time: f64) {
        (self.next, self.written) = (next, time);
    }

    /// Find the instant after the present time, and after the one that is shown now.
    pub fn plan(&mut self, run: &dyn Run) {
        if let Some(every) = self.every.filter(|_| !self.watch.is_empty()) {
            let due = if self.next.is_finite() { self.next } else { f64::NEG_INFINITY };
            self.next = after(run.time().max(due), every);
        }
    }

    /// Whether it looks after every step.
    pub fn is_every_step(&self) -> bool {
        self.every.is_none() && !self.watch.is_empty()
    }

    /// Lines of the state that is shown, unless it has some.
    pub fn look(&mut self, run: &dyn Run) {
        if self.watch.is_empty() || self.written == run.time() {
            return;
        }
        self.written = run.time();
        self.gauges(run);
        self.sections(run);
    }

    /// So much is held that it should be written.
    pub fn is_full(&self) -> bool {
        self.held.iter().any(|held| held.len() > HELD)
    }

    /// The lines that are held, if there are some.
    pub fn take(&mut self) -> Option<[String; 2]> {
        let any = self.held.iter().any(|held| !held.is_empty());
        any.then(|| std::mem::take(&mut self.held))
    }

    /// All lines that are held, as the tables of gauges and of sections, where there are some.
    pub fn into_tables(self) -> Result<[Option<Table>; 2], Error> {
        let used = self.is_used();
        let table = |k: usize| {
            let text = format!("{}\n{}", FILES[k].1, self.held[k]);
            used[k].then(|| Table::parse(Path::new(FILES[k].0), &text)).transpose()
        };
        Ok([table(0)?, table(1)?])
    }

    /// Thickness, velocities and speed in a cell; NaN for what the run does not have.
    fn values(&self, run: &dyn Run, cell: usize) -> [f64; 4] {
        let value = |field: usize| {
            let mut value = [0.0];
            run.fill(field, cell, &mut value);
            value[0]
        };
        let [h, u, v, speed] = self.fields.map(|field| field.map_or(f64::NAN, value));
        let across = if v.is_nan() { 0.0 } else { v };
        [h, u, v, if self.fields[3].is_none() { u.hypot(across) } else { speed }]
    }

    fn gauges(&mut self, run: &dyn Run) {
        let mut lines = std::mem::take(&mut self.held[0]);
        for (name, cell) in &self.watch.gauges {
            let [h, u, v, speed] = self.values(run, *cell);
            let pressure = run.plane().domain.pressure(speed);
            line(&mut lines, name, &[run.time(), h, u, v, speed, pressure]);
        }
        self.held[0] = lines;
    }

    fn sections(&mut self, run: &dyn Run) {
        let mut lines = std::mem::take(&mut self.held[1]);
        for (section, passage) in self.watch.sections.iter().zip(run.passages()) {
            let (mut thickness, mut pressure) = (0.0_f64, f64::NAN);
            for cell in &section.cells {
                let [h, _, _, speed] = self.values(run, *cell);
                thickness = thickness.max(h);
                pressure = pressure.max(run.plane().domain.pressure(speed));
            }
            line(
                &mut lines,
                &section.name,
                &[run.time(), passage.discharge, passage.volume, thickness, pressure],
            );
        }
        self.held[1] = lines;
    }
}

/// A line of a table; NaN is an empty cell.
fn line(lines: &mut String, name: &str, values: &[f64]) {
    lines.push_str(name);
    for value in values {
        // A String takes everything.
        let _ = if value.is_nan() { write!(lines, ",") } else { write!(lines, ",{value:?}") };
    }
    lines.push('\n');
}
