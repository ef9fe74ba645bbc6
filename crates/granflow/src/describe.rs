//! What a case would compute, in lines of a name and a value: what `granflow check` prints.

use crate::memory::Size;
use granflow_case::memory::{available, in_words};
use granflow_case::{Axis, Ensemble, Frames, RunPlan, Stepping, Until};

/// A line: a name, empty where it continues the line before, and a value.
pub type Line = (&'static str, String);

/// What the case says, with its defaults; `material` stands after the model, `scheme` says the order and the parameters of
/// the scheme.
pub(crate) fn case(run: &RunPlan, material: Vec<Line>, scheme: &str) -> Vec<Line> {
    let files: Vec<&str> = run.output.files.iter().map(|kind| kind.name).collect();
    let frames = match run.output.frames {
        Frames::Every(time) => format!("every {time} in time"),
        Frames::Steps(steps) => format!("every {steps} steps"),
        Frames::Ends => "at the start and at the end".to_owned(),
    };
    let title = if run.title.is_empty() { "without a title" } else { &run.title };
    let stepping = match run.stepping {
        Stepping::Fixed(step) => format!("step {step}"),
        Stepping::Courant(courant) => format!("Courant number {courant}"),
    };
    let mut lines =
        vec![("case", format!("{title} ({})", run.source_name())), ("model", run.model.to_owned())];
    lines.extend(material);
    lines.extend([
        ("scheme", format!("{}, {scheme}{stepping}", run.scheme)),
        ("ends", ends(run)),
        ("output", format!("{} {frames}, {:?}", files.join(", "), run.output.precision).to_lowercase()),
    ]);
    lines
}

fn ends(run: &RunPlan) -> String {
    let ends = &run.ends;
    let mut ways = Vec::new();
    ways.extend(ends.until.map(|until| match until {
        Until::Equilibrium => "at the equilibrium, computed directly".to_owned(),
        Until::Steady { rate } => format!("steady, changes below {rate:e} in time"),
        Until::Rest { speed, trickle } => {
            let rest = speed.map_or("at rest".to_owned(), |speed| format!("below speed {speed:e}"));
            let trickle = trickle.map(|h| format!(", or at rest but for a trickle (layers of {h})"));
            rest + &trickle.unwrap_or_default()
        }
    }));
    ways.extend(ends.kinetic_energy.map(|share| format!("at {share} of the peak kinetic energy")));
    ways.extend(ends.time.map(|end| format!("at time {end}")));
    ways.extend(ends.steps.map(|steps| format!("after {steps} steps")));
    ways.join(", or ")
}

/// Memory, frames and steps, from the Courant number `rate` of a step of length 1 at the start.
pub(crate) fn effort(run: &RunPlan, size: &Size, rate: f64) -> Vec<Line> {
    let mut lines = vec![("memory", memory(run, size))];
    lines.extend(run.ensemble.as_ref().map(|ensemble| ("", of_ensemble(run, size, ensemble))));
    lines.extend([("writes", written(run, size)), ("steps", steps(run, rate))]);
    if let Stepping::Fixed(step) = run.stepping {
        let (courant, limit) = (step * rate, run.max_courant);
        let verdict = if courant <= limit { "in order" } else { "too large, the scheme is not stable there" };
        lines.push(("Courant number", format!("{courant:.4} at the start (at most {limit}): {verdict}")));
    }
    lines
}

pub(crate) fn memory(run: &RunPlan, size: &Size) -> String {
    let peak = size.peak(run);
    format!("about {} at its peak{}", in_words(peak), too_much(peak))
}

/// The same of `granflow ensemble`.
fn of_ensemble(run: &RunPlan, size: &Size, ensemble: &Ensemble) -> String {
    let peak = size.of_ensemble(run, ensemble);
    format!("an ensemble with a member on each core about {}{}", in_words(peak), too_much(peak))
}

fn too_much(peak: f64) -> String {
    let beyond = available().filter(|free| peak > *free as f64);
    beyond.map(|free| format!(", more than the {} that are free", in_words(free as f64))).unwrap_or_default()
}

/// From so many bytes on `check` says how `result.nc` is packed.
const LARGE: f64 = 1e8;

/// How many frames there will be, and what they take on disk.
pub(crate) fn written(run: &RunPlan, size: &Size) -> String {
    let bytes = size.frame_bytes(run);
    match run.output.frames.count(&run.ends) {
        Some(count) => {
            let bytes = bytes * count as f64;
            let pack = if bytes < LARGE { "" } else { "; `nccopy -d 4 -s result.nc small.nc` packs it" };
            let all = in_words(bytes);
            format!("at most {count} frames, {all} in result.nc, and once more while the run goes on{pack}")
        }
        None => format!(
            "at most {} frames of {}: how many is not known before the run ends",
            Frames::MOST,
            in_words(bytes)
        ),
    }
}

/// Number of steps, exact for a fixed step, from the step at the start for an adaptive one.
fn steps(run: &RunPlan, rate: f64) -> String {
    let (step, about) = match run.stepping {
        Stepping::Fixed(step) => (step, ""),
        Stepping::Courant(courant) if rate > 0.0 => (courant / rate, "about "),
        Stepping::Courant(_) => return "unknown: nothing is there to move".to_owned(),
    };
    let by_time = run.ends.time.map(|end| (end / step).ceil());
    match (by_time, run.ends.steps) {
        (None, None) => format!("unknown, {about}{step:.3e} in time each at the start"),
        (Some(count), None) => format!(
            "{about}{count} of {step:.3e} in time{}",
            if about.is_empty() { "" } else { ", as at the start" }
        ),
        (None, Some(steps)) => format!("{steps}, {about}{:.4} in time", steps as f64 * step),
        (Some(count), Some(steps)) => format!("at most {}", count.min(steps as f64)),
    }
}

/// An axis of a grid.
pub(crate) fn axis(name: &str, axis: &Axis) -> String {
    format!("{name} from {} to {}, {} cells of {}", axis.from, axis.to, axis.cells, axis.width())
}

/// The smallest and the largest of the values.
pub(crate) fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let both = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
    values.fold((f64::INFINITY, f64::NEG_INFINITY), both)
}
