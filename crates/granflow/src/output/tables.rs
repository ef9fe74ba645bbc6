//! `tables.json`: what a paper prints or a formula gives beside what this program computes, and the verdict.

use super::{Error, whole_file};
use serde::{Deserialize, Serialize};
use std::io;
use std::path::Path;

/// What a computed number is held against.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Expected {
    /// A number printed in a paper.
    Published(f64),
    /// A number known from a formula.
    Exact(f64),
    /// A number of an independent run: another program's, of the same equations.
    Independent(f64),
}

impl Expected {
    /// The number.
    #[must_use]
    pub const fn value(self) -> f64 {
        match self {
            Self::Published(value) | Self::Exact(value) | Self::Independent(value) => value,
        }
    }
}

/// What the tolerance of a row measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// |computed - expected| <= tolerance.
    Absolute,
    /// |computed - expected| <= tolerance |expected|.
    Relative,
    /// computed <= expected + tolerance: an error or a share that must stay small.
    AtMost,
    /// computed >= expected - tolerance: an order of convergence that must be reached.
    AtLeast,
}

/// One row: its verdict is computed when it is made and cannot be set.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The table, figure or benchmark.
    pub name: String,
    /// What is compared.
    pub quantity: String,
    /// The number it is held against, under the key `published`, `exact` or `independent`.
    #[serde(flatten)]
    pub expected: Expected,
    /// Our number.
    pub computed: f64,
    /// How far it may be off, in the sense of `measure`.
    pub tolerance: f64,
    /// What the tolerance measures.
    pub measure: Measure,
    /// Why it may be off that far, where that is said.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    pass: bool,
}

impl Row {
    /// Compares `computed` with `expected`; a NaN anywhere fails.
    #[must_use]
    pub fn new(
        name: impl Into<String>,
        quantity: impl Into<String>,
        expected: Expected,
        computed: f64,
        measure: Measure,
        tolerance: f64,
    ) -> Self {
        let value = expected.value();
        let off = computed - value;
        let pass = match measure {
            Measure::Absolute => off.abs() <= tolerance,
            Measure::Relative => off.abs() <= tolerance * value.abs(),
            Measure::AtMost => off <= tolerance,
            Measure::AtLeast => -off <= tolerance,
        };
        Self {
            name: name.into(),
            quantity: quantity.into(),
            expected,
            computed,
            tolerance,
            measure,
            reason: None,
            pass,
        }
    }

    /// The row with the reason for its tolerance.
    #[must_use]
    pub fn because(self, reason: impl Into<String>) -> Self {
        Self { reason: Some(reason.into()), ..self }
    }

    /// Whether the computed number is within the tolerance.
    #[must_use]
    pub const fn pass(&self) -> bool {
        self.pass
    }
}

/// Writes all rows, failing ones included, as a JSON array; numbers that are not finite become null.
///
/// # Errors
/// [`Error::Io`] if the file cannot be written.
pub fn write(path: &Path, rows: &[Row]) -> Result<(), Error> {
    whole_file(path, |out| {
        serde_json::to_writer_pretty(&mut *out, rows).map_err(io::Error::from)?;
        writeln!(out)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pass(expected: f64, computed: f64, measure: Measure, tolerance: f64) -> bool {
        Row::new("A", "speed", Expected::Exact(expected), computed, measure, tolerance).pass()
    }

    #[test]
    fn verdicts() {
        assert!(pass(2.0, 2.25, Measure::Absolute, 0.25) && !pass(2.0, 2.26, Measure::Absolute, 0.25));
        assert!(pass(-4.0, -5.0, Measure::Relative, 0.25) && !pass(-4.0, -2.9, Measure::Relative, 0.25));
        assert!(pass(0.0, 1e-13, Measure::AtMost, 1e-12) && !pass(0.0, 1e-11, Measure::AtMost, 1e-12));
        assert!(pass(2.0, 1.9, Measure::AtLeast, 0.1001) && !pass(2.0, 1.8, Measure::AtLeast, 0.1));
        for measure in [Measure::Absolute, Measure::Relative, Measure::AtMost, Measure::AtLeast] {
            assert!(!pass(f64::NAN, 1.0, measure, 1.0) && !pass(1.0, f64::NAN, measure, 1.0));
        }
    }

    #[test]
    fn the_keys_are_those_of_the_contract() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("tables.json");
        let rows = [
            Row::new("Table 1", "mass", Expected::Published(1.5), 1.5, Measure::Absolute, 0.05),
            Row::new("B", "order", Expected::Exact(1.0), f64::INFINITY, Measure::Absolute, 0.1),
            Row::new("C", "steps", Expected::Independent(7.0), 7.0, Measure::Absolute, 0.0)
                .because("a count"),
        ];
        write(&path, &rows).unwrap();
        let read: serde_json::Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        assert_eq!(
            read[0],
            serde_json::json!({"name": "Table 1", "quantity": "mass", "published": 1.5, "computed": 1.5,
                "tolerance": 0.05, "measure": "absolute", "pass": true})
        );
        assert_eq!((&read[1]["exact"], &read[1]["computed"]), (&1.0.into(), &serde_json::Value::Null));
        assert_eq!(read[1]["pass"], false);
        assert_eq!((&read[2]["independent"], &read[2]["reason"]), (&7.0.into(), &"a count".into()));
    }
}
