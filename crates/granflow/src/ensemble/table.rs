//! The members in tables: values, numbers, and why they ended.

use super::member::{Row, SCALARS};
use super::{Ensemble, EnsembleError, Reduced};
use crate::output::netcdf::{Axis, Dataset, Values, Variable, history};
use crate::output::{Precision, whole_file};
use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;
use std::time::SystemTime;

impl Ensemble {
    /// Writes `members.csv`.
    pub(super) fn write_table(&self, reduced: &Reduced, path: &Path) -> Result<(), EnsembleError> {
        Ok(whole_file(path, |out| self.table(reduced, out))?)
    }

    /// What `members.csv` holds: a line for each member, with the override that each value was, its numbers, and how it ended.
    ///
    /// # Errors
    /// What `out` could not take.
    pub fn table(&self, reduced: &Reduced, out: &mut dyn Write) -> io::Result<()> {
        let columns = self.plan().columns();
        let keys = columns.iter().map(|column| column.name.as_str());
        let further = reduced.further.iter().map(String::as_str);
        let names: Vec<String> =
            keys.chain(SCALARS.map(|(name, ..)| name)).chain(further).map(quoted).collect();
        writeln!(out, "member,status,{},stop_reason,failure", names.join(","))?;
        for (number, row) in &reduced.rows {
            let status = if row.failure().is_some() { "failed" } else { "computed" };
            let mut line = format!("{number},{status}");
            for (value, column) in row.values.iter().zip(&columns) {
                // a String takes everything
                let _ = match &column.choices {
                    Some(choices) => {
                        write!(line, ",{}", quoted(choices.get(*value as usize).map_or("", String::as_str)))
                    }
                    None => write!(line, ",{value:?}"),
                };
            }
            for value in numbers(reduced, row) {
                let _ = if value.is_finite() { write!(line, ",{value:?}") } else { write!(line, ",") };
            }
            match &row.ended {
                Ok((reason, _)) => {
                    let reason = serde_json::to_value(reason)?;
                    writeln!(out, "{line},{},", reason.as_str().unwrap_or_default())?;
                }
                Err(failure) => writeln!(out, "{line},,{}", quoted(failure))?,
            }
        }
        Ok(())
    }

    /// `members.nc`: the same for programs, along the axis `member`; of a choice its number in the list of the attribute, from 0.
    pub(super) fn write_member_file(
        &self,
        reduced: &Reduced,
        path: &Path,
        command: &str,
    ) -> Result<(), EnsembleError> {
        let columns = self.plan().columns();
        let rows: Vec<&Row> = reduced.rows.values().collect();
        let members: Vec<f64> = reduced.rows.keys().map(|number| f64::from(*number)).collect();
        let variable = |name: &str, long_name: String, units: &str, values: Vec<f64>| Variable {
            name: name.to_owned(),
            long_name,
            units: units.to_owned(),
            axes: vec!["member".to_owned()],
            precision: Precision::F64,
            values: Values::Static(values.into()),
        };
        let mut variables = Vec::new();
        for (k, column) in columns.iter().enumerate() {
            let values = rows.iter().map(|row| row.values[k]).collect();
            let words = match &column.choices {
                Some(choices) => format!("number of the choice from {}, from 0", choices.join(" | ")),
                None => format!("value of {}", column.name),
            };
            variables.push(variable(&column.name.replace('.', "_"), words, "1", values));
        }
        let known = SCALARS.iter().map(|(name, units, _)| (*name, *units));
        let further = reduced.further.iter().map(|name| (name.as_str(), self.units_of_largest(name)));
        for (k, (name, units)) in known.chain(further).enumerate() {
            let values = rows.iter().map(|row| numbers(reduced, row)[k]).collect();
            let units = if self.plane().domain.raster().is_some() { units } else { "1" };
            variables.push(variable(name, name.replace('_', " "), units, values));
        }
        let failed = rows.iter().map(|row| f64::from(u8::from(row.failure().is_some()))).collect();
        variables.push(variable("failed", "1 where the member failed".to_owned(), "1", failed));
        let axis = Axis {
            name: "member".to_owned(),
            values: members,
            units: "1".to_owned(),
            long_name: "number of the member".to_owned(),
            standard_name: Some("realization".to_owned()),
            axis: "",
        };
        let dataset = Dataset { axes: vec![axis], variables, ..self.about(command) };
        Ok(dataset.write(path, None)?)
    }

    /// Units of the largest value of a map, as `peak_speed_max`; none of other numbers.
    fn units_of_largest(&self, name: &str) -> &'static str {
        let map = name.strip_suffix("_max").and_then(|map| self.plane().model().quantity(map));
        map.map_or("", |quantity| quantity.units_in(self.plane().domain.units()))
    }

    /// What both files say of the ensemble.
    pub(super) fn about(&self, command: &str) -> Dataset<'_> {
        let run = self.run_plan();
        Dataset {
            title: run.title.clone(),
            history: history(SystemTime::now(), command),
            case: run.resolved(),
            attributes: vec![
                ("model".to_owned(), run.model.to_owned()),
                ("scheme".to_owned(), run.scheme.to_owned()),
                ("ensemble".to_owned(), self.plan().to_string()),
                ("case_text".to_owned(), run.text()),
            ],
            ..Dataset::default()
        }
    }
}

/// The numbers of a member; none of one that failed.
fn numbers(reduced: &Reduced, row: &Row) -> Vec<f64> {
    let count = SCALARS.len() + reduced.further.len();
    row.ended.as_ref().map_or_else(|_| vec![f64::NAN; count], |(_, numbers)| numbers.clone())
}

/// A text as a field of a table: in quotes where it has to be.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
