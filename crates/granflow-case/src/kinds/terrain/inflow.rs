//! `[[inflow]]`: mass that enters in the course of a run.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use crate::array;
use crate::choice::{Plain, plain_or_table};
use crate::fault::CaseError;
use crate::look::Look;

/// Mass that enters: where, and how much by the time.
#[derive(Debug, Clone, PartialEq)]
pub struct Inflow {
    /// Where it enters.
    pub over: Over,
    /// Discharge and speed by the time.
    pub hydrograph: Hydrograph,
    /// The direction in which it moves, if it is not down the slope.
    pub direction: Option<[f64; 2]>,
}

/// Where mass enters.
#[derive(Debug, Clone, PartialEq)]
pub enum Over {
    /// Along a line of points [x, y] in the raster's coordinates.
    Line(Vec<[f64; 2]>),
    /// Over the polygons of a file.
    Polygons(PathBuf),
}

/// Discharge by the time, straight between instants, none before the first and after the last.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hydrograph {
    /// Instants in s, growing.
    pub time: Vec<f64>,
    /// Discharge at them in m^3/s.
    pub discharge: Vec<f64>,
    /// Speed along the bed at them in m/s (default 0: it enters at rest).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub speed: Vec<f64>,
}

/// Mass that enters in the course of a run: over exactly one of `line`, `polygons`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Inflow")]
pub(super) struct Words {
    /// Points [x, y] of a line in the raster's coordinates.
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<Vec<[f64; 2]>>,
    /// Polygons: a shapefile or GeoJSON.
    #[serde(skip_serializing_if = "Option::is_none")]
    polygons: Option<PathBuf>,
    /// A file with a line "time, discharge" or "time, discharge, speed" for each instant, or the same as a table.
    hydrograph: Given,
    /// Direction [x, y] in which the mass moves where it has a speed (default: down the slope).
    #[serde(skip_serializing_if = "Option::is_none")]
    direction: Option<[f64; 2]>,
}

/// A hydrograph: a file, or a table.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
enum Given {
    /// A file.
    File(PathBuf),
    /// As a table.
    Table(Hydrograph),
}

impl<'de> Deserialize<'de> for Given {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let expected = "a file as in \"q.csv\", or { time = [0, 60], discharge = [5, 0] }";
        let read = |value: Plain| match value {
            Plain::Text(text) => Ok(Self::File(text.into())),
            Plain::Number(number) => Err(format!("found the number {number}, expected {expected}")),
        };
        plain_or_table(from, expected, read, Self::Table)
    }
}

impl Words {
    /// Checks the numbers, and reads the hydrograph.
    pub fn check(&self, look: &Look, key: &str) -> Result<Inflow, CaseError> {
        let over = match (&self.line, &self.polygons) {
            (Some(points), None) => {
                let finite = points.iter().flatten().all(|value| value.is_finite());
                if points.len() < 2 || !finite {
                    let message = "a line needs at least two points [x, y] of finite numbers";
                    return Err(look.fault(
                        &format!("{key}.line"),
                        message,
                        "as in line = [[10, 20], [10, 40]]",
                    ));
                }
                Over::Line(points.clone())
            }
            (None, Some(path)) => {
                look.file(&format!("{key}.polygons"), path)?;
                Over::Polygons(look.locate(path))
            }
            _ => {
                return Err(look.fault(
                    key,
                    "an inflow has exactly one of line, polygons",
                    "split it into several [[inflow]] tables, or remove what is too much",
                ));
            }
        };
        let at = format!("{key}.hydrograph");
        let hydrograph = match &self.hydrograph {
            Given::Table(table) => table.clone(),
            Given::File(path) => {
                look.file(&at, path)?;
                read(look, &look.locate(path))
                    .map_err(|error| look.fault(&at, error, "a line for each instant: time, discharge"))?
            }
        };
        if let Err(problem) = hydrograph.check() {
            return Err(look.fault(&at, problem, "as in { time = [0, 10, 60], discharge = [0, 5, 0] }"));
        }
        if let Some([x, y]) = self.direction
            && !(x.is_finite() && y.is_finite() && x.hypot(y) > 0.0)
        {
            let message = format!("found [{x}, {y}], expected a direction [x, y]");
            return Err(look.fault(
                &format!("{key}.direction"),
                message,
                "as in direction = [1, 0], to the east",
            ));
        }
        Ok(Inflow { over, hydrograph, direction: self.direction })
    }
}

/// What the columns of a hydrograph may be called, in the order that they have without names, and their units.
const COLUMNS: [(&[&str], &[&str]); 3] = [
    (&["time", "t", "zeit"], &["", "s", "sec", "seconds"]),
    (&["discharge", "q", "abfluss"], &["", "m3/s", "m^3/s", "m³/s"]),
    (&["speed", "velocity", "v", "geschwindigkeit"], &["", "m/s"]),
];

/// A hydrograph from a text file: its columns by the names in the first line, or without names in the order time, discharge, speed.
fn read(look: &Look, path: &Path) -> Result<Hydrograph, String> {
    let name = path.display();
    let bytes = look.files.bytes(path).map_err(|error| format!("cannot read {name}: {error}"))?;
    let text = std::str::from_utf8(&bytes).map_err(|_| format!("{name} is not text"))?;
    let text = text.trim_start_matches('\u{feff}');
    let header = text
        .lines()
        .next()
        .filter(|line| line.trim_start().starts_with(|sign: char| sign.is_alphabetic() || sign == '"'));
    // The header stays as an empty line, so that the lines keep their numbers.
    let start = header.map_or(0, str::len);
    let (shape, values) =
        array::read_text(&text.as_bytes()[start..]).map_err(|error| format!("cannot use {name}: {error}"))?;
    let columns = shape[1];
    if !(2..=3).contains(&columns) {
        return Err(format!("{name} has {columns} columns, expected time, discharge and perhaps speed"));
    }
    let order = match header {
        None => (0..columns).collect(),
        Some(header) => named(header).map_err(|problem| format!("{name}: {problem}"))?,
    };
    if order.len() != columns {
        return Err(format!("{name} names {} columns and has {columns}", order.len()));
    }
    let column = |which: usize| match order.iter().position(|of| *of == which) {
        Some(k) => values.chunks_exact(columns).map(|row| row[k]).collect(),
        None => Vec::new(),
    };
    Ok(Hydrograph { time: column(0), discharge: column(1), speed: column(2) })
}

/// Which of [`COLUMNS`] each name of a header is.
fn named(header: &str) -> Result<Vec<usize>, String> {
    let mut order = Vec::new();
    for word in header.split([',', ';', '\t']) {
        let word = word.trim().trim_matches('"').to_lowercase();
        let (name, unit) = word.split_once(['[', '(']).unwrap_or((&word, ""));
        let (name, unit) = (name.trim(), unit.trim_end_matches([']', ')']).trim());
        let Some(which) = COLUMNS.iter().position(|(names, _)| names.contains(&name)) else {
            return Err(format!("its column `{word}` is none of time, discharge, speed"));
        };
        if !COLUMNS[which].1.contains(&unit) {
            let (names, units) = COLUMNS[which];
            return Err(format!("its column `{name}` is in `{unit}`; {} is in {}", names[0], units[1]));
        }
        if order.contains(&which) {
            return Err(format!("its column `{name}` is there twice"));
        }
        order.push(which);
    }
    match [0, 1].iter().find(|which| !order.contains(which)) {
        Some(which) => Err(format!("it has no column `{}`", COLUMNS[*which].0[0])),
        None => Ok(order),
    }
}

impl Hydrograph {
    /// What is wrong with it.
    fn check(&self) -> Result<(), String> {
        let Self { time, discharge, speed } = self;
        let growing = time.is_sorted_by(|a, b| a < b) && time.iter().all(|t| t.is_finite() && *t >= 0.0);
        if time.len() < 2 || !growing {
            return Err("the times must be at least two, growing numbers from 0 s on".to_owned());
        }
        for (name, values) in [("discharge", discharge), ("speed", speed)] {
            if name == "speed" && values.is_empty() {
                continue;
            }
            if values.len() != time.len() {
                return Err(format!("{} times and {} values of {name}", time.len(), values.len()));
            }
            if let Some(value) = values.iter().find(|value| !(value.is_finite() && **value >= 0.0)) {
                return Err(format!("found a {name} of {value}, expected numbers >= 0"));
            }
        }
        if self.volume(f64::INFINITY) <= 0.0 {
            return Err("no volume enters: every discharge is 0".to_owned());
        }
        Ok(())
    }

    /// The time after which nothing enters \[s\].
    #[must_use]
    pub fn end(&self) -> f64 {
        self.time.last().copied().unwrap_or(0.0)
    }

    /// The straight pieces before `time`: the number of the instant at the end of each, its length, and the share of it before `time`.
    fn pieces(&self, time: f64) -> impl Iterator<Item = (usize, f64, f64)> {
        let begun = self.time.windows(2).take_while(move |ends| ends[0] < time).enumerate();
        begun.map(move |(k, ends)| {
            (k + 1, ends[1] - ends[0], ((time - ends[0]) / (ends[1] - ends[0])).min(1.0))
        })
    }

    /// The volume that has entered by `time` \[m^3\]: the exact integral of the straight pieces.
    #[must_use]
    pub fn volume(&self, time: f64) -> f64 {
        let of = |(k, length, share): (usize, f64, f64)| {
            let [from, to] = [self.discharge[k - 1], self.discharge[k]];
            length * share * (from + 0.5 * share * (to - from))
        };
        self.pieces(time).map(of).fold(0.0, |sum, part| sum + part)
    }

    /// The momentum by volume that has entered by `time`: the integral of discharge times speed \[m^4/s\], exact (Simpson's rule for a
    /// product of two straight lines).
    fn momentum(&self, time: f64) -> f64 {
        if self.speed.is_empty() {
            return 0.0;
        }
        let of = |(k, length, share): (usize, f64, f64)| {
            let at = |share: f64| {
                let between = |values: &[f64]| values[k - 1] + share * (values[k] - values[k - 1]);
                between(&self.discharge) * between(&self.speed)
            };
            length * share / 6.0 * (at(0.0) + 4.0 * at(0.5 * share) + at(share))
        };
        self.pieces(time).map(of).fold(0.0, |sum, part| sum + part)
    }

    /// The mean speed of what enters between two times \[m/s\]; 0 where nothing does.
    #[must_use]
    pub fn mean_speed(&self, from: f64, to: f64) -> f64 {
        let volume = self.volume(to) - self.volume(from);
        if volume > 0.0 { (self.momentum(to) - self.momentum(from)) / volume } else { 0.0 }
    }
}
