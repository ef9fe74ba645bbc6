//! The members in tables: values, numbers, and why they ended.

use super::member::{Row, SCALARS};
use super::{Ensemble, EnsembleError, Reduced};
use crate::output::netcdf::{Axis, Dataset, Values, Variable, history};
use crate::output::{Precision, whole_file};
use std::fmt::Write as _;
use std::path::Path;
use std::time::SystemTime;

impl Ensemble {
    /// `members.csv`: a line for each member, with the override that each value was, its numbers, and how it ended.
    pub(super) fn write_table(&self, reduced: &Reduced, path: &Path) -> Result<(), EnsembleError> {
        let columns = self.plan().columns();
        whole_file(path, |out| {
            let mut line = "member".to_owned();
            for name in
                columns.iter().map(|column| column.name.as_str()).chain(SCALARS.map(|(name, ..)| name))
            {
                let _ = write!(line, ",{}", quoted(name)); // a String takes everything
            }
            writeln!(out, "{line},ended,failure")?;
            for (number, row) in &reduced.rows {
                line = number.to_string();
                for (value, column) in row.values.iter().zip(&columns) {
                    let _ = match &column.choices {
                        Some(choices) => write!(
                            line,
                            ",{}",
                            quoted(choices.get(*value as usize).map_or("", String::as_str))
                        ),
                        None => write!(line, ",{value:?}"),
                    };
                }
                for value in numbers(row) {
                    let _ = if value.is_finite() { write!(line, ",{value:?}") } else { write!(line, ",") };
                }
                match &row.ended {
                    Ok((reason, _)) => writeln!(out, "{line},{},", quoted(&reason.to_string()))?,
                    Err(failure) => writeln!(out, "{line},failed,{}", quoted(failure))?,
                }
            }
            Ok(())
        })?;
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
        for (k, (name, units, _)) in SCALARS.iter().enumerate() {
            let values = rows.iter().map(|row| numbers(row)[k]).collect();
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
fn numbers(row: &Row) -> Vec<f64> {
    row.ended.as_ref().map_or_else(|_| vec![f64::NAN; SCALARS.len()], |(_, numbers)| numbers.clone())
}

/// A text as a field of a table: in quotes where it has to be.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
