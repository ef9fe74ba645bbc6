//! One member of an ensemble: its case, its run, and what is kept of it.

use crate::output::summary::Summary;
use crate::results::numbers::{self, Start};
use crate::run::{DriveError, Run, drive};
use crate::sinks::{Sink, Stop};
use crate::stop_reason::StopReason;
use crate::{Checked, StartError};
use granflow_case::Member;
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// What is kept of a member beside its maps: a name, its unit in SI, and where it is found.
pub(super) type Scalar = (&'static str, &'static str, fn(&Summary) -> f64);

/// The numbers that `summary.json` always has, in its order, but for those that say how fast it was computed: they are no results, and
/// differ from one time to the next.
pub(super) const SCALARS: [Scalar; 15] = [
    ("cells", "1", |summary| summary.cells as f64),
    ("steps", "1", |summary| summary.steps as f64),
    ("time", "s", |summary| summary.time),
    ("stopping_time", "s", |summary| summary.stopping_time.unwrap_or(f64::NAN)),
    ("threshold", "m", |summary| summary.threshold.unwrap_or(f64::NAN)),
    ("mass_initial", "m3", |summary| summary.mass_initial),
    ("mass_final", "m3", |summary| summary.mass_final),
    ("mass_in", "m3", |summary| summary.mass_in),
    ("mass_out", "m3", |summary| summary.mass_out),
    ("mass_error", "1", |summary| summary.mass_error),
    ("film_volume", "m3", |summary| summary.film_volume),
    ("max_speed_final", "m s-1", |summary| summary.max_speed_final),
    ("max_speed", "m s-1", |summary| summary.max_speed),
    ("runout", "m", |summary| summary.runout.unwrap_or(f64::NAN)),
    ("reach_angle", "degree", |summary| summary.reach_angle.unwrap_or(f64::NAN)),
];

/// The numbers of a summary beyond the fixed ones.
fn further(summary: &Summary) -> BTreeMap<String, f64> {
    let numbers = summary.extra.iter().filter(|(_, value)| value.is_number() || value.is_null());
    numbers.map(|(name, value)| (name.clone(), value.as_f64().unwrap_or(f64::NAN))).collect()
}

/// A member that was computed, or why it could not be.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The member.
    pub member: Member,
    /// What it left, or why it failed.
    pub result: Result<Computed, String>,
}

/// What a member left.
#[derive(Debug, Clone)]
pub struct Computed {
    /// Why its run ended.
    pub reason: StopReason,
    /// The maps that are added up, not a number where it did not come.
    pub(super) maps: Vec<Vec<f64>>,
    /// Its numbers, those of [`SCALARS`].
    pub(super) scalars: Vec<f64>,
    /// Its further numbers by name.
    pub(super) further: BTreeMap<String, f64>,
    /// Seconds in steps.
    pub stepping_seconds: f64,
}

/// What is kept of a member that was added up.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Row {
    /// The values that it had.
    pub values: Vec<f64>,
    /// Why it ended and its numbers, those of [`SCALARS`] and then the further ones that the members have; or why it failed.
    pub ended: Result<(StopReason, Vec<f64>), String>,
}

impl Row {
    pub fn failure(&self) -> Option<&str> {
        self.ended.as_ref().err().map(String::as_str)
    }
}

/// The cells on which the members of an ensemble are added up.
pub(super) type Cells<'a> = [&'a [f64]; 2];

/// Computes the run of a case to its end and keeps these maps of it; none where `stop` ended it before.
pub(super) fn compute(
    checked: Checked,
    start: impl FnOnce(Checked) -> Result<Box<dyn Run>, StartError>,
    names: &[String],
    cells: Cells,
    stop: &AtomicBool,
) -> Result<Option<Computed>, String> {
    let begun = Instant::now();
    let plan = checked.plan().clone();
    let mut run = start(checked).map_err(|error| error.to_string())?;
    let plane = run.plane();
    if [plane.x.as_slice(), &plane.y] != cells {
        return Err("its cells are not those of the other members: elevation models to choose from must have the same place, size \
                    and cell"
            .to_owned());
    }
    let sinks: &mut [&mut dyn Sink] = &mut [&mut Stop(stop)];
    let reason = match drive(&mut *run, &plan.ends, sinks) {
        Ok(StopReason::Interrupted) => return Ok(None),
        Ok(reason) => reason,
        Err(error @ (DriveError::Step { .. } | DriveError::Law(_))) => {
            return Err(format!("at time {}: {error}", run.time()));
        }
        Err(error) => return Err(error.to_string()),
    };
    run.stepper_mut().release_buffers();
    let end = run.maps();
    let mut summary = numbers::summary(&plan, &*run, reason, Start { at: begun, updates: 0 });
    let plane = run.place();
    let mut maps = run.into_peaks();
    maps.extend(end);
    numbers::complete(&plane, &mut maps, &mut summary);
    let taken = names.iter().map(|name| {
        let place = maps.iter().position(|(own, _)| own == name);
        place.map(|place| maps.swap_remove(place).1).ok_or_else(|| format!("there is no map {name}"))
    });
    let maps = taken.collect::<Result<_, _>>()?;
    let scalars = SCALARS.iter().map(|(_, _, of)| of(&summary)).collect();
    let further = further(&summary);
    Ok(Some(Computed { reason, maps, scalars, further, stepping_seconds: summary.stepping_seconds }))
}
