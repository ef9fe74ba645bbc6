//! A run as its figures see it: plain numbers, from the run itself or from its files.

use super::along::Along;
use super::quantity::Units;
use crate::output::figures::short;
use crate::output::ledger::Entry;
use crate::output::lines::Table;
use std::borrow::Cow;

/// A run as its figures see it.
#[derive(Debug, Clone)]
pub struct View<'a> {
    /// The case's title.
    pub title: String,
    /// Scheme, why and when the run ended, in one line.
    pub subtitle: String,
    /// Units of all numbers.
    pub units: Units,
    /// Cell centres along x.
    pub x: Vec<f64>,
    /// Cell centres along y; empty in one dimension.
    pub y: Vec<f64>,
    /// The instants that are kept: all in one dimension, the first and the last otherwise.
    pub times: Vec<f64>,
    /// The series that figures show, at these instants.
    pub series: Vec<(&'static str, Vec<Vec<f64>>)>,
    /// The maps by name.
    pub maps: Vec<(&'static str, Cow<'a, [f64]>)>,
    /// The ledger; empty where it is not known.
    pub ledger: Vec<Entry>,
    /// The tables of gauges and of sections, where there are some.
    pub watched: [Option<Table>; 2],
    /// What passed along the path, where that is known.
    pub along: Option<Along>,
    /// The thresholds of the maps of durations, by the names of these maps.
    pub thresholds: Vec<(&'static str, f64)>,
}

/// The maps of durations, and what each counts: its name, and its SI unit.
pub(crate) const DURATIONS: [(&str, &str, &str); 3] = [
    ("duration_thickness", "thickness", "m"),
    ("duration_speed", "speed", "m/s"),
    ("duration_pressure", "pressure", "kPa"),
];

impl View<'_> {
    /// What a map of durations shows, as "time above 0.5 m"; in the papers' scaling "time above thickness 0.5".
    #[must_use]
    pub fn time_above(&self, map: &str) -> Option<String> {
        let (_, quantity, unit) = DURATIONS.into_iter().find(|(name, ..)| *name == map)?;
        let threshold = self.thresholds.iter().find(|(name, _)| *name == map).map(|(_, value)| short(*value));
        Some(match (threshold, self.unit(unit)) {
            (None, _) => format!("time above the {quantity}"),
            (Some(threshold), "") => format!("time above {quantity} {threshold}"),
            (Some(threshold), unit) => format!("time above {threshold} {unit}"),
        })
    }

    /// A series by its name; empty if it is not shown.
    #[must_use]
    pub fn series(&self, name: &str) -> &[Vec<f64>] {
        self.series.iter().find(|(known, _)| *known == name).map_or(&[], |(_, series)| series)
    }

    /// A map by its name.
    #[must_use]
    pub fn map(&self, name: &str) -> Option<&[f64]> {
        self.maps.iter().find(|(known, _)| *known == name).map(|(_, values)| values.as_ref())
    }

    /// 1 or 2.
    #[must_use]
    pub fn dimensions(&self) -> usize {
        if self.y.is_empty() { 1 } else { 2 }
    }

    /// Unit of a quantity: `si`, or nothing in the papers' scaling.
    #[must_use]
    pub fn unit<'s>(&self, si: &'s str) -> &'s str {
        self.units.label(si)
    }
}
