//! `[[gauge]]` and `[[section]]`: where one looks at every step.

use crate::fault::CaseError;
use crate::look::Look;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Where a run is looked at.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Watched {
    /// Places.
    pub gauges: Vec<Gauge>,
    /// Lines.
    pub sections: Vec<Section>,
    /// Simulated time between two looks; every step where `None`.
    pub every: Option<f64>,
}

impl Watched {
    /// Whether there is nothing to look at.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.gauges.is_empty() && self.sections.is_empty()
    }
}

/// A place that is looked at.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gauge {
    /// Its name in the files.
    pub name: String,
    /// Where: two coordinates, in one dimension one.
    pub at: Vec<f64>,
}

/// A line through which the passing mass is counted.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Its name in the files.
    pub name: String,
    /// Where.
    pub line: Line,
}

/// Where a section lies.
#[derive(Debug, Clone, PartialEq)]
pub enum Line {
    /// Its points, in one dimension the only one.
    Points(Vec<Vec<f64>>),
    /// A line in a GeoJSON file.
    File(PathBuf),
}

/// A line through which the passing mass is counted: exactly one of `line` and `file`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Section")]
pub(crate) struct SectionWords {
    /// Its name in the files.
    name: String,
    /// Its points [[x, y], [x, y], ...], in one dimension [[x]]; closed where the last is the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<Vec<Vec<f64>>>,
    /// A LineString in a GeoJSON file, in the case's coordinates.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<PathBuf>,
}

/// Checks the names, numbers and files of both tables; whether the places are on the grid shows when it is there.
pub(crate) fn check(
    look: &Look,
    gauges: &[Gauge],
    sections: &[SectionWords],
    every: Option<f64>,
    dimensions: usize,
) -> Result<Watched, CaseError> {
    look.positive("output.series_every", every)?;
    if every.is_some() && gauges.is_empty() && sections.is_empty() {
        let cure = "add [[gauge]] or [[section]], or remove it";
        return Err(look.fault("output.series_every", "there is neither a gauge nor a section", cure));
    }
    names(look, "gauge", gauges.iter().map(|gauge| gauge.name.as_str()))?;
    names(look, "section", sections.iter().map(|section| section.name.as_str()))?;
    for (index, gauge) in gauges.iter().enumerate() {
        place(look, &format!("gauge[{index}].at"), &gauge.at, dimensions)?;
    }
    let sections = sections.iter().enumerate();
    let sections =
        sections.map(|(index, section)| section.check(look, &format!("section[{index}]"), dimensions));
    Ok(Watched { gauges: gauges.to_vec(), sections: sections.collect::<Result<_, _>>()?, every })
}

/// A name is a word of a table, and of one gauge or section only.
fn names<'n>(look: &Look, table: &str, names: impl Iterator<Item = &'n str>) -> Result<(), CaseError> {
    let mut known: Vec<&str> = Vec::new();
    for (index, name) in names.enumerate() {
        let key = format!("{table}[{index}].name");
        let fits = |letter: char| letter.is_alphanumeric() || " _-.".contains(letter);
        if name.trim().is_empty() || !name.chars().all(fits) {
            let message = format!("`{name}` is no name");
            return Err(look.fault(
                &key,
                message,
                "write letters, digits, `_`, `-`, `.` and spaces: name = \"road\"",
            ));
        }
        if let Some(first) = known.iter().position(|other| *other == name) {
            let message = format!("`{name}` is the name of {table}[{first}] too");
            return Err(look.fault(&key, message, "give each a name of its own"));
        }
        known.push(name);
    }
    Ok(())
}

/// A place has as many finite coordinates as the grid has dimensions.
fn place(look: &Look, key: &str, at: &[f64], dimensions: usize) -> Result<(), CaseError> {
    if at.len() != dimensions {
        let cure = if dimensions == 1 { "write one number: [3.0]" } else { "write two numbers: [3.0, 4.0]" };
        let message = format!("found {} numbers, the case has {dimensions} dimensions", at.len());
        return Err(look.fault(key, message.replace("1 dimensions", "1 dimension"), cure));
    }
    let finite =
        |(k, value): (usize, &f64)| look.number(&format!("{key}[{k}]"), *value, |_| true, "a finite number");
    at.iter().enumerate().try_for_each(finite)
}

impl SectionWords {
    fn check(&self, look: &Look, key: &str, dimensions: usize) -> Result<Section, CaseError> {
        let name = self.name.clone();
        let line = match (&self.line, &self.file) {
            (Some(points), None) => {
                let key = format!("{key}.line");
                let enough = if dimensions == 1 { points.len() == 1 } else { points.len() >= 2 };
                if !enough {
                    let (what, cure) = match dimensions {
                        1 => ("one point", "line = [[3.0]]"),
                        _ => ("at least two points", "line = [[0.0, 0.0], [3.0, 4.0]]"),
                    };
                    let message = format!("found {} points, a section has {what} here", points.len());
                    return Err(look.fault(&key, message, &format!("write {cure}")));
                }
                for (k, point) in points.iter().enumerate() {
                    place(look, &format!("{key}[{k}]"), point, dimensions)?;
                }
                Line::Points(points.clone())
            }
            (None, Some(path)) if dimensions == 1 => {
                let message = format!("{} is a line, the case has one dimension", path.display());
                return Err(look.fault(&format!("{key}.file"), message, "write line = [[x]]"));
            }
            (None, Some(path)) => {
                look.file(&format!("{key}.file"), path)?;
                Line::File(look.locate(path))
            }
            _ => {
                let cure = "write line = [[x, y], [x, y]] or file = \"line.geojson\"";
                return Err(look.fault(key, "a section has exactly one of line, file", cure));
            }
        };
        Ok(Section { name, line })
    }
}
