//! `summary.json`: a run in thirty numbers.

use super::{Error, whole_file};
pub use crate::stop_reason::StopReason;
use serde::{Deserialize, Deserializer, Serialize};
use std::fs;
use std::io;
use std::path::Path;

/// The keys of `summary.json` in their order; a number that is not finite or does not apply is `null`.
///
/// Units are the case's: scaled on a grid, SI on terrain, where mass means volume in m³.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// The case's title.
    pub title: String,
    /// The model's name, as in the case file.
    pub model: String,
    /// The scheme's name.
    pub scheme: String,
    /// Cells of the grid.
    pub cells: u64,
    /// Steps done.
    pub steps: u64,
    /// Simulated time at the end.
    #[serde(deserialize_with = "number")]
    pub time: f64,
    /// Why the run ended.
    pub stop_reason: StopReason,
    /// The last time at which a layer thicker than the threshold moved, if the run ended at rest; of a model
    /// without maps of peaks and times when it came to rest.
    pub stopping_time: Option<f64>,
    /// Thickness normal to the bed that a layer must exceed to count; none where there are no maps of peaks and times.
    pub threshold: Option<f64>,
    /// Mass at the start.
    #[serde(deserialize_with = "number")]
    pub mass_initial: f64,
    /// Mass at the end.
    #[serde(deserialize_with = "number")]
    pub mass_final: f64,
    /// Mass released or poured on during the run.
    #[serde(deserialize_with = "number")]
    pub mass_in: f64,
    /// Mass that left over the edges.
    #[serde(deserialize_with = "number")]
    pub mass_out: f64,
    /// (final - initial - in + out) / (initial + in + what came over open edges).
    #[serde(deserialize_with = "number")]
    pub mass_error: f64,
    /// Mass in cells thinner than a film.
    #[serde(deserialize_with = "number")]
    pub film_volume: f64,
    /// Largest speed at the end, films too.
    #[serde(deserialize_with = "number")]
    pub max_speed_final: f64,
    /// Largest speed of the run, of layers thicker than the threshold.
    #[serde(deserialize_with = "number")]
    pub max_speed: f64,
    /// Horizontal length from the highest released cell to the farthest cell reached, where that is defined.
    pub runout: Option<f64>,
    /// Angle of that line below the horizontal, in degrees.
    pub reach_angle: Option<f64>,
    /// Seconds on the clock.
    #[serde(deserialize_with = "number")]
    pub wall_seconds: f64,
    /// Part of them in steps alone: the outputs, set-up and figures are beside or around them.
    #[serde(default = "unknown", deserialize_with = "number")]
    pub stepping_seconds: f64,
    /// Cells times steps by seconds on the clock.
    #[serde(deserialize_with = "number")]
    pub cell_updates_per_second: f64,
    /// Threads used.
    pub threads: u64,
    /// Version of granflow.
    pub version: String,
    /// What to know before the numbers are trusted.
    #[serde(default)]
    pub warnings: Vec<String>,
    /// What else is worth knowing, such as `peak_thickness_max`; further keys of the same JSON object, in
    /// alphabetical order.
    #[serde(flatten)]
    pub extra: serde_json::Map<String, serde_json::Value>,
}

impl Summary {
    /// Adds a number beyond the fixed keys.
    pub fn add(&mut self, key: &str, value: f64) {
        self.extra.insert(key.into(), value.into()); // serde_json turns a number that is not finite into null
    }

    /// The number under a key beyond the fixed ones.
    #[must_use]
    pub fn extra(&self, key: &str) -> Option<f64> {
        self.extra.get(key)?.as_f64()
    }

    /// The texts under a key beyond the fixed ones.
    pub fn texts(&self, key: &str) -> impl Iterator<Item = &str> {
        let list = self.extra.get(key).and_then(serde_json::Value::as_array);
        list.into_iter().flatten().filter_map(serde_json::Value::as_str)
    }

    /// A volume by what there was at the start and what came, by sources or over open edges; 0 where there was nothing.
    #[must_use]
    pub fn share(&self, volume: f64) -> f64 {
        let whole = self.mass_initial + self.mass_in + (-self.mass_out).max(0.0);
        if whole > 0.0 { volume / whole } else { 0.0 }
    }

    /// Writes the summary as indented JSON.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        whole_file(path, |out| {
            serde_json::to_writer_pretty(&mut *out, self).map_err(io::Error::from)?;
            writeln!(out)
        })
    }

    /// Reads a summary back; a null number comes back as NaN.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Damaged`] with line and column of what is not a summary.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let text = fs::read_to_string(path).map_err(Error::io(path, "read"))?;
        serde_json::from_str(&text)
            .map_err(|error| Error::damaged(path, format!("this is no summary of a run: {error}")))
    }
}

fn number<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::NAN))
}

/// What a summary does not say that was written before it was asked for.
fn unknown() -> f64 {
    f64::NAN
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in crate::output) fn sample() -> Summary {
        let mut summary = Summary {
            title: "A silo breaks".into(),
            model: "savage_hutter".into(),
            scheme: "balanced".into(),
            cells: 240,
            steps: 10_000,
            time: 10.0,
            stop_reason: StopReason::AtRest,
            stopping_time: Some(9.5),
            threshold: Some(0.01),
            mass_initial: 8.0,
            mass_final: 8.0,
            mass_in: 0.0,
            mass_out: 0.0,
            mass_error: 1e-16,
            film_volume: 4e-3,
            max_speed_final: 0.0,
            max_speed: f64::NAN,
            runout: None,
            reach_angle: Some(f64::INFINITY),
            wall_seconds: 1.5,
            stepping_seconds: 1.25,
            cell_updates_per_second: 1.6e6,
            threads: 2,
            version: "0.1.0".into(),
            warnings: Vec::new(),
            extra: serde_json::Map::new(),
        };
        summary.add("peak_thickness_max", 2.3);
        summary.add("deposit_area", f64::NAN);
        summary
    }

    #[test]
    fn the_keys_are_those_of_the_contract_in_its_order() {
        let text = serde_json::to_string_pretty(&sample()).unwrap();
        let keys: Vec<_> =
            text.lines().filter_map(|line| line.trim().strip_prefix('"')?.split('"').next()).collect();
        assert_eq!(
            keys.join(", "),
            "title, model, scheme, cells, steps, time, stop_reason, stopping_time, threshold, mass_initial, mass_final, \
             mass_in, mass_out, mass_error, film_volume, max_speed_final, max_speed, runout, reach_angle, wall_seconds, \
             stepping_seconds, cell_updates_per_second, threads, version, warnings, deposit_area, peak_thickness_max"
        );
        for null in ["max_speed", "runout", "reach_angle", "deposit_area"] {
            assert!(text.contains(&format!("\"{null}\": null")), "{null}");
        }
    }

    #[test]
    fn the_stop_reasons_are_spelt_as_the_contract_says() {
        use StopReason::*;
        let reasons = [AtRest, Trickle, Steady, EndTime, Steps, KineticEnergy, BelowSpeed, Interrupted];
        assert_eq!(
            serde_json::to_string(&reasons).unwrap(),
            r#"["at_rest","trickle","steady","end_time","steps","kinetic_energy","below_speed","interrupted"]"#
        );
    }

    #[test]
    fn it_comes_back_from_disk() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("summary.json");
        sample().write(&path).unwrap();
        let read = Summary::read(&path).unwrap();
        assert!(read.max_speed.is_nan() && read.reach_angle.is_none());
        assert_eq!((read.extra("peak_thickness_max"), read.extra("deposit_area")), (Some(2.3), None));
        assert_eq!(read.share(read.film_volume), 5e-4);
        fs::write(&path, "{\"title\": 3}").unwrap();
        assert!(Summary::read(&path).unwrap_err().to_string().contains("line 1"));
    }
}
