//! All that `result.nc` holds of a run from a case, wherever its series are.

use super::dataset::{About, dataset};
use super::watched;
use crate::model::{Maps, Plane};
use crate::output::Precision;
use crate::output::lines::Table;
use crate::output::netcdf::{Dataset, Values};
use crate::output::summary::Summary;

/// A run from a case, as a result shows it.
pub(crate) struct Contents<'a> {
    pub plane: &'a Plane,
    pub precision: Precision,
    pub times: Vec<f64>,
    pub series: Vec<(&'a str, Values<'a>)>,
    pub maps: &'a Maps,
    /// Gauges and sections.
    pub tables: [Option<Table>; 2],
    pub summary: &'a Summary,
    /// The case as it was computed, and its text as it was written.
    pub case: [&'a str; 2],
}

impl<'a> Contents<'a> {
    /// The dataset, which `history` says how it was made.
    ///
    /// # Errors
    /// The name of a series or a map that is no quantity of the model.
    pub fn dataset(self, history: String) -> Result<Dataset<'a>, String> {
        let Contents { plane, precision, times, series, maps, tables, summary, case } = self;
        let about = About {
            title: summary.title.clone(),
            history,
            case: case[0].to_owned(),
            case_text: case[1].to_owned(),
            scheme: summary.scheme.clone(),
            stop_reason: summary.stop_reason.to_string(),
            threshold: summary.threshold,
        };
        let mut result = dataset(plane, precision, times, series, maps, about)?;
        for name in ["thickness", "speed", "pressure"].map(|what| format!("duration_{what}_threshold")) {
            let threshold = summary.extra(&name);
            result.attributes.extend(threshold.map(|threshold| (name, threshold.to_string())));
        }
        for (table, kind) in tables.into_iter().zip([watched::GAUGE, watched::SECTION]) {
            if let Some(table) = table {
                watched::add(&mut result, &kind, table, plane.domain.units());
            }
        }
        Ok(result)
    }
}
