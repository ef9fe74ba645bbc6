//! A run as it ends: maps, figures, and why.

use super::Files;
use crate::model::Plane;
use crate::output::folder::Folder;
use crate::output::frames::Frames;
use crate::output::summary::{StopReason, Summary};
use crate::results::Finished;
use crate::run::{Entry, Maps, Run, Until, mass_error, sum};
use granflow_case::FileKind;
use std::path::PathBuf;

/// A finished run but for its series and its ledger, which the writer has.
#[derive(Debug)]
pub(super) struct Ending {
    directory: PathBuf,
    files: Vec<FileKind>,
    case: String,
    case_text: String,
    plane: Plane,
    maps: Maps,
    series: [Option<PathBuf>; 2],
    path: Option<Vec<[f64; 2]>>,
    path_width: f64,
    history: Vec<String>,
    summary: Summary,
}

impl Ending {
    /// What there is now.
    pub fn of(files: &Files, run: &mut dyn Run, reason: StopReason) -> Ending {
        let end = run.maps();
        let mut maps = run.peaks();
        maps.extend(end);
        Ending::with(files, run.place(), maps, summary(files, run, reason))
    }

    /// What there is at the end.
    pub fn last(files: &Files, mut run: Box<dyn Run>, reason: StopReason) -> Ending {
        run.stepper_mut().release_buffers();
        let end = run.maps();
        let summary = summary(files, &*run, reason);
        let plane = run.place();
        let mut maps = run.into_peaks();
        maps.extend(end);
        Ending::with(files, plane, maps, summary)
    }

    fn with(files: &Files, plane: Plane, maps: Maps, mut summary: Summary) -> Ending {
        count(&maps, &mut summary);
        let past = files.past_and_now();
        Ending {
            directory: files.folder.path().to_owned(),
            files: files.plan.output.files.clone(),
            case: files.plan.resolved(),
            case_text: files.plan.text(),
            plane,
            maps,
            series: files.series.paths(files.folder.path()),
            path: files.series.path(),
            path_width: files.plan.output.path_width,
            history: past.commands.into_iter().chain(past.events).collect(),
            summary,
        }
    }

    /// Say in the summary why the run failed.
    pub fn explain(&mut self, failure: &str) {
        self.summary.extra.insert("failure".to_owned(), failure.into());
    }

    /// Put it together; `folder` keeps its lock for as long as files are made.
    pub fn finished(self, folder: Option<Folder>, frames: Frames, ledger: Vec<Entry>) -> Finished {
        let Ending {
            directory,
            files,
            case,
            case_text,
            plane,
            mut maps,
            series,
            path,
            path_width,
            history,
            mut summary,
        } = self;
        plane.derive(&mut maps, &mut summary);
        let found = (plane.model().warnings)(plane.model(), &summary);
        summary.warnings.extend(found);
        Finished {
            directory,
            folder,
            files,
            case,
            case_text,
            plane,
            frames,
            ledger,
            maps,
            series,
            path,
            path_width,
            history,
            summary,
        }
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

/// The figures of the run as they stand; those that the maps know better follow in [`count`].
fn summary(files: &Files, run: &dyn Run, stop_reason: StopReason) -> Summary {
    let (stepper, record, plan, plane) = (run.stepper(), run.record(), &files.plan, run.plane());
    let totals = run.totals();
    let out = stepper.outflow();
    let (gone, mass_in, initial) = (sum(out), stepper.poured(), record.initial);
    let wall = files.begun.elapsed().as_secs_f64();
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
        cell_updates_per_second: (stepper.updates() - files.updates) as f64 / wall,
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
    if !files.past.events.is_empty() {
        summary.extra.insert("history".to_owned(), files.past.events.clone().into());
    }
    if files.past.mixed {
        let text =
            "the friction changed in the course of the run: peaks, times and runout are those of both parts";
        summary.warnings.push(text.to_owned());
    }
    if let Some(Until::Steady { rate }) = plan.ends.until {
        summary.add("steady_rate", rate);
    }
    summary
}
