//! The figures of a run, as it ends or as it stands.

use crate::model::Plane;
use crate::output::checkpoint::Past;
use crate::output::summary::{StopReason, Summary};
use crate::run::{Maps, Run, Until, mass_error, sum};
use granflow_case::RunPlan;
use std::time::Instant;

/// From when on a process has worked on a run.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Start {
    /// On the clock.
    pub at: Instant,
    /// The updates of a cell before it.
    pub updates: u64,
}

/// Add what follows from the maps: further maps, figures, warnings.
pub(crate) fn complete(plane: &Plane, maps: &mut Maps, summary: &mut Summary) {
    count(maps, summary);
    plane.derive(maps, summary);
    let found = (plane.model().warnings)(plane.model(), summary);
    summary.warnings.extend(found);
}

/// Say of a run that went on with another case where, and what its figures then are.
pub(crate) fn went_on(past: &Past, summary: &mut Summary) {
    if !past.events.is_empty() {
        summary.extra.insert("history".to_owned(), past.events.clone().into());
    }
    if past.mixed {
        let text =
            "the friction changed in the course of the run: peaks, times and runout are those of both parts";
        summary.warnings.push(text.to_owned());
    }
}

/// Put the largest of the maps of peaks and times, in which films do not count, for the figures of the run.
fn count(maps: &Maps, summary: &mut Summary) {
    let largest = |map: &str| -> Option<f64> {
        let (_, values) = maps.iter().find(|(name, _)| *name == map)?;
        Some(values.iter().copied().fold(f64::NAN, f64::max))
    };
    if let Some(speed) = largest("peak_speed") {
        summary.max_speed = speed.max(0.0);
    }
    if let Some(time) = largest("stopping_time") {
        summary.stopping_time = summary.stopping_time.map(|_| time).filter(|time| time.is_finite());
    }
}

/// The figures of the run as they stand; what its maps say follows in [`complete`].
pub(crate) fn summary(plan: &RunPlan, run: &dyn Run, stop_reason: StopReason, start: Start) -> Summary {
    let (stepper, record, plane) = (run.stepper(), run.record(), run.plane());
    let totals = run.totals();
    let out = stepper.outflow();
    let (gone, mass_in, initial) = (sum(out), stepper.poured(), record.initial);
    let wall = start.at.elapsed().as_secs_f64();
    let speed = |speed: f64| if run.has_speed() { speed } else { f64::NAN };
    let mut summary = Summary {
        title: plan.title.clone(),
        model: plan.model.to_owned(),
        scheme: run.scheme().to_owned(),
        cells: (plane.x.len() * plane.y.len().max(1)) as u64,
        steps: run.steps(),
        time: run.time(),
        stop_reason,
        threshold: run.threshold(),
        stopping_time: (stop_reason.is_rest() && !run.is_equilibrium()).then(|| run.time()),
        mass_initial: initial,
        mass_final: totals.volume,
        mass_in,
        mass_out: gone,
        mass_error: mass_error(run, &totals),
        film_volume: totals.film,
        max_speed_final: speed(totals.speed),
        max_speed: speed(record.peak_speed),
        runout: None,
        reach_angle: None,
        wall_seconds: wall,
        stepping_seconds: record.stepping.as_secs_f64(),
        cell_updates_per_second: (stepper.updates() - start.updates) as f64 / wall,
        threads: rayon::current_num_threads() as u64,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        warnings: Vec::new(),
        extra: serde_json::Map::new(),
    };
    for (name, value) in plane.outlets().iter().zip(out) {
        summary.add(&format!("mass_out_{name}"), value);
    }
    for (name, value) in run.numbers() {
        summary.add(&name, value);
    }
    let durations = plan.output.durations;
    for (name, threshold) in
        [("thickness", durations.thickness), ("speed", durations.speed), ("pressure", durations.pressure)]
    {
        if let Some(threshold) = threshold {
            summary.add(&format!("duration_{name}_threshold"), threshold);
        }
    }
    if let Some(Until::Steady { rate }) = plan.ends.until {
        summary.add("steady_rate", rate);
    }
    summary
}
