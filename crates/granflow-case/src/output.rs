//! `[output]`: which files, how many instants, how many digits, and how thick a layer must be to count.

use crate::durations::Durations;
use crate::fault::CaseError;
use crate::file_kind::FileKind;
use crate::look::Look;
use crate::plan::{Ends, Frames, OutputPlan};
use crate::precision::Precision;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// What is written.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Output {
    /// Simulated time between two instants (default: 20 instants up to the end).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub every: Option<f64>,
    /// Steps between two instants; instead of `every`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps: Option<u64>,
    /// Kinds of files (default: netcdf and figures; on terrain geotiff, vector and report as well).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub files: Option<Vec<String>>,
    /// Precision of the numbers in the files (default f64 on a grid, f32 on terrain).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub precision: Option<Precision>,
    /// Simulated time between two lines of gauges.csv and sections.csv (default: a line after every step).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub series_every: Option<f64>,
    /// Thresholds of which maps say for how long they were exceeded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub durations: Option<Durations>,
    /// On terrain: a GeoJSON file with the line along which the run is shown over time (default: found, from the highest release down
    /// the core of the flow).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<PathBuf>,
    /// On terrain: how wide what passes along the path is looked at, in metres (default 100).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path_width: Option<f64>,
    /// Thickness normal to the bed that a layer must exceed to count in peaks, times and outlines (default
    /// 0.01 m on terrain, 1e-3 on a chute).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub threshold: Option<f64>,
}

/// What a kind of case writes where its case does not say.
pub(crate) struct Defaults {
    /// Kinds of files, as far as they can be written.
    pub files: &'static [&'static str],
    /// Precision of the numbers in them.
    pub precision: Precision,
    /// See [`OutputPlan::threshold`].
    pub threshold: f64,
}

/// How wide what passes along a path is looked at where nobody says it \[m\].
const PATH_WIDTH: f64 = 100.0;

/// Frames of a run whose end is known.
const FRAMES: u32 = 20;

impl Output {
    /// What is written. Files that need a place on the earth are refused unless they are among those of `defaults`.
    pub(crate) fn check(
        &self,
        look: &Look,
        ends: &Ends,
        defaults: &Defaults,
    ) -> Result<OutputPlan, CaseError> {
        if self.every.is_some() && self.steps.is_some() {
            let message = "both `every` and `steps` are given";
            return Err(look.fault("output.steps", message, "keep one of them"));
        }
        look.positive("output.every", self.every)?;
        look.not_zero("output.steps", self.steps)?;
        look.not_negative("output.threshold", self.threshold)?;
        let frames = match (self.every, self.steps, ends.time, ends.steps) {
            (Some(every), ..) => Frames::Every(every),
            (None, Some(steps), ..) => Frames::Steps(steps),
            (None, None, Some(end), _) => Frames::Every(end / f64::from(FRAMES)),
            (None, None, None, Some(steps)) => Frames::Steps(steps.div_ceil(u64::from(FRAMES)).max(1)),
            (None, None, None, None) => Frames::Ends,
        };
        self.bounded(look, frames, ends)?;
        let durations = self.durations.unwrap_or_default();
        look.not_negative("output.durations.thickness", durations.thickness)?;
        look.not_negative("output.durations.speed", durations.speed)?;
        look.not_negative("output.durations.pressure", durations.pressure)?;
        look.positive("output.path_width", self.path_width)?;
        for (key, given) in
            [("output.path", self.path.is_some()), ("output.path_width", self.path_width.is_some())]
        {
            if given && !defaults.files.contains(&"report") {
                return Err(look.fault(key, "a path needs [terrain]", "remove it: on a grid x is the path"));
            }
        }
        self.path.iter().try_for_each(|path| look.file("output.path", path))?;
        Ok(OutputPlan {
            path: self.path.as_ref().map(|path| look.locate(path)),
            path_width: self.path_width.unwrap_or(PATH_WIDTH),
            frames,
            files: self.kinds(look, defaults.files)?,
            precision: self.precision.unwrap_or(defaults.precision),
            threshold: self.threshold.unwrap_or(defaults.threshold),
            durations,
        })
    }

    /// What is written must have an end that a disk can hold.
    fn bounded(&self, look: &Look, frames: Frames, ends: &Ends) -> Result<(), CaseError> {
        let (Some(count), most) = (frames.count(ends), Frames::MOST) else { return Ok(()) };
        if count <= most {
            return Ok(());
        }
        let (key, cure) = match (frames, ends.time, ends.steps) {
            (Frames::Every(_), Some(end), _) => ("output.every", format!("every = {}", end / 1000.0)),
            (_, _, steps) => ("output.steps", format!("steps = {}", (steps.unwrap_or(0) / 1000).max(1))),
        };
        let message = format!("up to {count} frames would be written, more than {most}");
        Err(look.fault(key, message, &format!("write {cure} for a thousand of them")))
    }

    /// The kinds of files that are asked for; where the case does not say, those of `files` that can be written.
    fn kinds(&self, look: &Look, files: &[&str]) -> Result<Vec<FileKind>, CaseError> {
        let known = look.files.kinds();
        let Some(asked) = &self.files else {
            let named = |name: &&str| known.iter().find(|kind| kind.name == *name).copied();
            return Ok(files.iter().filter_map(named).collect());
        };
        let find = |(index, name): (usize, &String)| {
            let key = format!("output.files[{index}]");
            let Some(kind) = known.iter().find(|kind| kind.name == name) else {
                let message = format!("found `{name}`, which is not one of the choices");
                return Err(look
                    .source
                    .fault(&key, message)
                    .allowed(name, known.iter().map(|kind| kind.name)));
            };
            if kind.needs_terrain && !files.contains(&kind.name) {
                let on_a_grid: Vec<&str> =
                    known.iter().filter(|kind| !kind.needs_terrain).map(|kind| kind.name).collect();
                let message = format!("`{name}` needs [terrain]");
                return Err(look.fault(&key, message, &format!("on a grid: {}", on_a_grid.join(", "))));
            }
            Ok(*kind)
        };
        asked.iter().enumerate().map(find).collect()
    }
}

/// Files of a case on a grid that does not say which.
pub(crate) const ON_A_GRID: &[&str] = &["netcdf", "figures"];
