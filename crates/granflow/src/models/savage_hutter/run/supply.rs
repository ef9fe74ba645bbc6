//! Mass that comes in the course of a run: late and secondary releases, inflows.

use super::between::BetweenSteps;
use crate::run::Numbers;
use granflow_case::terrain::{Hydrograph, Starts};
use granflow_engine::simulation::Simulation;
use granflow_model::savage_hutter::Flow;
use granflow_model::savage_hutter::ground::Bed;
use granflow_model::scheme::Scheme;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// A release that does not start with the run.
pub(crate) struct Late {
    pub starts: Starts,
    /// Numbers of its cells, x fastest, with the volume per plan area \[m\].
    pub cells: Vec<(usize, f64)>,
    /// It has started.
    pub came: bool,
}

/// A cell through which mass enters.
pub(crate) struct Inlet {
    /// Its number, x fastest.
    pub cell: usize,
    /// Its share of the discharge.
    pub share: f64,
    /// The direction in which the mass moves, of length 1.
    pub direction: [f64; 2],
}

/// Mass that enters by a hydrograph.
pub(crate) struct Inflow {
    pub inlets: Vec<Inlet>,
    pub hydrograph: Hydrograph,
    /// The volume that has entered \[m^3\].
    pub entered: f64,
    /// The time up to which it has; negative before the run.
    pub until: f64,
}

/// All that comes in the course of a run; by default nothing.
#[derive(Default)]
pub(crate) struct Supply {
    pub late: Vec<Late>,
    pub inflows: Vec<Inflow>,
    /// The time at which something last came.
    pub came: f64,
}

/// Flowing mass of this thickness reaches a place, picks up what lies there and breaks what stands there \[m\].
pub(super) const REACHES: f64 = 0.01;

/// The share of a cell that entering mass may cross in a step.
const CROSSED: f64 = 0.25;

impl Supply {
    /// Nothing comes.
    pub fn is_empty(&self) -> bool {
        self.late.is_empty() && self.inflows.is_empty()
    }

    /// The releases that start now; where several cover a cell their order does not matter.
    fn release<const D: usize, S>(&mut self, simulation: &mut Simulation<D, S>, time: f64)
    where
        S: Scheme<D, f64, State = Flow<D, f64>>,
        S::Ground: Bed<D, f64>,
    {
        let grid = *simulation.grid();
        let reached = |cell: usize| {
            let here = simulation.cell(grid.index(cell));
            !here.state.is_still() && here.ground.thickness(here.state.h) > REACHES
        };
        let starts = |late: &&mut Late| {
            !late.came
                && match late.starts {
                    Starts::At(at) => at <= time,
                    Starts::Hit => late.cells.iter().any(|(cell, _)| reached(*cell)),
                }
        };
        let mut volumes: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
        for late in self.late.iter_mut().filter(starts) {
            late.came = true;
            for (cell, volume) in &late.cells {
                volumes.entry(*cell).or_default().push(*volume);
            }
        }
        let states: Vec<_> = volumes
            .into_iter()
            .map(|(cell, mut volumes)| {
                volumes.sort_by(f64::total_cmp);
                let index = grid.index(cell);
                let old = simulation.state(index);
                (index, Flow { h: old.h + volumes.iter().sum::<f64>(), ..old })
            })
            .collect();
        give(simulation, states);
    }
}

impl<const D: usize, S> BetweenSteps<D, S> for Supply
where
    S: Scheme<D, f64, State = Flow<D, f64>>,
    S::Ground: Bed<D, f64>,
{
    fn act(&mut self, simulation: &mut Simulation<D, S>, _dt: f64) {
        let (time, before) = (simulation.time(), simulation.poured());
        self.release(simulation, time);
        for inflow in &mut self.inflows {
            inflow.enter(simulation, time);
        }
        if simulation.poured() != before {
            self.came = time;
        }
    }

    fn next(&self, simulation: &Simulation<D, S>) -> f64 {
        let time = simulation.time();
        let late = self.late.iter().filter(|late| !late.came).filter_map(|late| match late.starts {
            Starts::At(at) => Some(at),
            Starts::Hit => None,
        });
        let inflows = self.inflows.iter().map(|inflow| inflow.next(simulation, time));
        late.chain(inflows).fold(f64::INFINITY, f64::min)
    }

    /// But for a secondary release that nothing reaches any more.
    fn is_settled(&self, time: f64) -> bool {
        let begun = |late: &Late| late.came || late.starts == Starts::Hit;
        let ended = |inflow: &Inflow| inflow.hydrograph.end() <= time.min(inflow.until);
        self.late.iter().all(begun) && self.inflows.iter().all(ended)
    }

    fn came(&self) -> f64 {
        self.came
    }

    fn save(&self) -> Cow<'_, [f64]> {
        let came = self.late.iter().map(|late| f64::from(u8::from(late.came)));
        let entered = self.inflows.iter().flat_map(|inflow| [inflow.entered, inflow.until]);
        std::iter::once(self.came).chain(came).chain(entered).collect()
    }

    fn restore(&mut self, _simulation: &mut Simulation<D, S>, saved: &[f64]) -> bool {
        self.came = saved[0];
        let (came, entered) = saved[1..].split_at(self.late.len());
        self.late.iter_mut().zip(came).for_each(|(late, came)| late.came = *came != 0.0);
        for (inflow, entered) in self.inflows.iter_mut().zip(entered.chunks_exact(2)) {
            (inflow.entered, inflow.until) = (entered[0], entered[1]);
        }
        true
    }

    fn numbers(&self, simulation: &Simulation<D, S>) -> Numbers {
        let waiting = self.late.iter().filter(|late| !late.came);
        let volume: f64 = waiting.flat_map(|late| &late.cells).map(|(_, volume)| volume).sum();
        if volume == 0.0 {
            return Numbers::default();
        }
        vec![("unreleased_volume".to_owned(), volume * simulation.grid().measure())]
    }
}

impl Inflow {
    /// Bring what has come by `time` and is not there yet. The sum follows the integral of the hydrograph and not that of the steps:
    /// what rounding kept back comes with the next step.
    fn enter<const D: usize, S>(&mut self, simulation: &mut Simulation<D, S>, time: f64)
    where
        S: Scheme<D, f64, State = Flow<D, f64>>,
        S::Ground: Bed<D, f64>,
    {
        if time <= self.until {
            return;
        }
        let due = self.hydrograph.volume(time) - self.entered;
        let speed = self.hydrograph.mean_speed(self.until.max(0.0), time);
        self.until = time;
        if due <= 0.0 {
            return;
        }
        let grid = *simulation.grid();
        let measure = grid.measure();
        let states: Vec<_> = self
            .inlets
            .iter()
            .map(|inlet| {
                let index = grid.index(inlet.cell);
                let here = simulation.cell(index);
                let (old, h) = (here.state, due * inlet.share / measure);
                let along: [f64; D] = std::array::from_fn(|k| inlet.direction[k]);
                let horizontal = if speed > 0.0 { speed / here.ground.square(along).sqrt() } else { 0.0 };
                let q = std::array::from_fn(|k| old.q[k] + h * horizontal * along[k]);
                (index, Flow { h: old.h + h, q })
            })
            .collect();
        let before = simulation.poured();
        give(simulation, states);
        self.entered += simulation.poured() - before;
    }

    /// The end of a step after `time` in which no cell takes up more than a step can carry on.
    fn next<const D: usize, S>(&self, simulation: &Simulation<D, S>, time: f64) -> f64
    where
        S: Scheme<D, f64, State = Flow<D, f64>>,
        S::Ground: Bed<D, f64>,
    {
        let Hydrograph { time: instants, discharge, speed } = &self.hydrograph;
        let Some(next) = instants.iter().position(|instant| *instant > time) else { return f64::INFINITY };
        if next == 0 {
            return instants[0];
        }
        let most = |values: &[f64]| values.get(next - 1..=next).map_or(0.0, |two| two[0].max(two[1]));
        let grid = simulation.grid();
        let size = grid.size.into_iter().fold(f64::INFINITY, f64::min);
        let step = |inlet: &Inlet| {
            let rises = most(discharge) * inlet.share / grid.measure();
            let here = simulation.cell(grid.index(inlet.cell));
            let pull = here.ground.gravity();
            // The cell's own wave sqrt(2 g h) of what comes in the step, and its speed; on a dry bed the front must not be late.
            let by_wave = (CROSSED * size / (2.0 * pull * rises).sqrt()).powf(2.0 / 3.0);
            let dry = here.ground.thickness(here.state.h) < REACHES;
            let by_front = if dry { CROSSED * REACHES / rises } else { f64::INFINITY };
            by_wave.min(CROSSED * size / most(speed)).min(by_front)
        };
        let longest = self.inlets.iter().map(step).fold(f64::INFINITY, f64::min);
        instants[next].min(time + longest)
    }
}

/// Give cells these states, and count them in the maps of peaks and arrivals.
pub(super) fn give<const D: usize, S>(
    simulation: &mut Simulation<D, S>,
    states: Vec<([usize; D], Flow<D, f64>)>,
) where
    S: Scheme<D, f64, State = Flow<D, f64>>,
    S::Ground: Bed<D, f64>,
{
    if states.is_empty() {
        return;
    }
    let cells: Vec<[usize; D]> = states.iter().map(|(cell, _)| *cell).collect();
    simulation.change(states);
    let (time, threshold) = (simulation.time(), simulation.maps().map(|maps| maps.threshold()));
    let Some(threshold) = threshold else { return };
    let counted: Vec<_> = cells
        .iter()
        .map(|cell| (simulation.place(*cell), simulation.diagnostics(*cell)))
        .filter(|(_, watch)| watch.thickness > threshold)
        .collect();
    for (name, map) in simulation.maps_mut() {
        for (place, watch) in &counted {
            let value = match name {
                "peak_thickness" => watch.thickness as f32,
                "peak_speed" => watch.speed_squared.sqrt() as f32,
                "arrival_time" if map[*place].is_nan() => time as f32,
                _ => continue,
            };
            // `max` takes the number of the two.
            map[*place] = map[*place].max(value);
        }
    }
}
