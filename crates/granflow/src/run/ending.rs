//! What a run comes to as it stands: maps, figures, and why it ends.

use super::model::{Maps, Model};
use super::writer::Writer;
use super::{Run, relative};
use crate::case::{self, Case};
use crate::output::frames::Frames;
use crate::output::ledger::{Entry, sum};
use crate::output::summary::{StopReason, Summary};
use crate::results::{Finished, Plane};
use granflow_engine::Maps as Summaries;
use std::path::PathBuf;

/// A finished run but for its series and its ledger, which the writer has.
#[derive(Debug)]
pub(super) struct Ending {
    case: Case,
    directory: PathBuf,
    plane: Plane,
    maps: Maps,
    summary: Summary,
}

impl Ending {
    /// Put it together.
    pub fn finished(self, frames: Frames, ledger: Vec<Entry>) -> Finished {
        let Ending { case, directory, plane, maps, summary } = self;
        Finished::new(&case, directory, plane, frames, ledger, maps, summary)
    }
}

impl<const D: usize, S: Model<D>> Run<'_, '_, D, S> {
    /// What there is now.
    pub(super) fn ending(&mut self, stop_reason: StopReason) -> Ending {
        let end = S::maps(&mut self.simulation, self.sand);
        let (simulation, layout) = (&self.simulation, self.simulation.layout());
        let kept = simulation.maps().into_iter().flat_map(Summaries::named);
        let maps = kept.map(|(name, map)| (name, layout.unpadded(map))).chain(end).collect();
        Ending {
            case: self.work.case.clone(),
            directory: self.work.options.directory.clone(),
            plane: self.plane.clone().with_bed(|| S::elevation(&self.simulation)),
            maps,
            summary: self.summary(stop_reason),
        }
    }

    /// What there is at the end, and the writer. What is done with is given back on the way: to end takes no more memory than
    /// to compute.
    pub(super) fn into_ending(mut self, stop_reason: StopReason) -> (Ending, Writer) {
        self.simulation.release_buffers();
        let end = S::maps(&mut self.simulation, self.sand);
        let summary = self.summary(stop_reason);
        let Run { work, simulation, plane, writer, .. } = self;
        let plane = plane.with_bed(|| S::elevation(&simulation));
        let mut maps = simulation.into_maps();
        maps.extend(end);
        let (case, directory) = (work.case.clone(), work.options.directory.clone());
        (Ending { case, directory, plane, maps, summary }, writer)
    }

    /// The figures of the run as they stand.
    fn summary(&self, stop_reason: StopReason) -> Summary {
        let simulation = &self.simulation;
        let totals = simulation.totals();
        let out = simulation.out();
        let (gone, mass_in) = (sum(out), simulation.poured());
        let wall = self.work.clock.elapsed().as_secs_f64();
        let case = self.work.case;
        let stopped = matches!(stop_reason, StopReason::AtRest | StopReason::Steady);
        let direct = self.sand.is_some_and(|sand| sand.equilibrium.is_some());
        let stopping_time = (stopped && !direct).then(|| simulation.time());
        let mut summary = Summary {
            title: case.title.clone(),
            model: case.model.as_str().to_owned(),
            scheme: if direct { "direct" } else { case.scheme.name.as_str() }.to_owned(),
            cells: (self.plane.x.len() * self.plane.y.len().max(1)) as u64,
            steps: simulation.step(),
            time: simulation.time(),
            stop_reason,
            stopping_time,
            mass_initial: self.initial,
            mass_final: totals.volume,
            mass_in,
            mass_out: gone,
            mass_error: relative(totals.volume + gone - self.initial - mass_in, self.initial + mass_in),
            film_volume: totals.film,
            max_speed_final: totals.speed,
            max_speed: self.peak_speed,
            runout: None,
            reach_angle: None,
            wall_seconds: wall,
            stepping_seconds: self.stepping.as_secs_f64(),
            cell_updates_per_second: (simulation.updates() - self.updates) as f64 / wall,
            threads: rayon::current_num_threads() as u64,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            extra: serde_json::Map::new(),
        };
        for (name, value) in self.plane.outlets().iter().zip(out) {
            summary.add(&format!("mass_out_{name}"), value);
        }
        S::sum_up(simulation, self.sand, &mut summary);
        if case.time.until == Some(case::Until::Steady) && !direct {
            summary.add("steady_rate", case.time.steady_rate());
        }
        summary
    }
}
