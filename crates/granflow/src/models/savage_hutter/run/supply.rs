//! Mass that comes in the course of a run: late and secondary releases, inflows.

use granflow_case::terrain::{Hydrograph, Starts};
use granflow_engine::simulation::Simulation;
use granflow_model::savage_hutter::Flow;
use granflow_model::savage_hutter::ground::Bed;
use granflow_model::scheme::Scheme;
use std::collections::BTreeMap;

/// A release that does not start with the run.
pub(crate) struct Late {
    pub starts: Starts,
    /// Its cells by column and row, with the volume per plan area \[m\].
    pub cells: Vec<([usize; 2], f64)>,
    /// It has started.
    pub came: bool,
}

/// A cell through which mass enters.
pub(crate) struct Inlet {
    pub cell: [usize; 2],
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
}

/// All that comes in the course of a run.
#[derive(Default)]
pub(crate) struct Supply {
    pub late: Vec<Late>,
    pub inflows: Vec<Inflow>,
    /// A layer of this thickness lets a secondary release start \[m\].
    pub threshold: f64,
}

/// The share of a cell that entering mass may cross in a step.
const CROSSED: f64 = 0.25;

impl Supply {
    /// Nothing comes.
    pub fn is_empty(&self) -> bool {
        self.late.is_empty() && self.inflows.is_empty()
    }

    /// Nothing begins or goes on after `time`, but a secondary release that nothing reaches any more.
    pub fn is_settled(&self, time: f64) -> bool {
        let begun = |late: &Late| late.came || late.starts == Starts::Hit;
        self.late.iter().all(begun) && self.inflows.iter().all(|inflow| inflow.hydrograph.end() <= time)
    }

    /// Bring what has come up to the time of the simulation; the time up to which nothing else comes, or by which it must be asked
    /// again.
    pub fn bring<const D: usize, S>(&mut self, simulation: &mut Simulation<D, S>) -> f64
    where
        S: Scheme<D, f64, State = Flow<D, f64>>,
        S::Ground: Bed<D, f64>,
    {
        let time = simulation.time();
        self.release(simulation, time);
        let mut next = f64::INFINITY;
        for late in self.late.iter().filter(|late| !late.came) {
            if let Starts::At(at) = late.starts {
                next = next.min(at);
            }
        }
        for inflow in &mut self.inflows {
            inflow.enter(simulation, time);
            next = next.min(inflow.next(simulation, time));
        }
        next
    }

    /// The releases that start now; where several cover a cell their order does not matter.
    fn release<const D: usize, S>(&mut self, simulation: &mut Simulation<D, S>, time: f64)
    where
        S: Scheme<D, f64, State = Flow<D, f64>>,
        S::Ground: Bed<D, f64>,
    {
        let threshold = self.threshold;
        let reached = |cell: &[usize; 2]| {
            let here = simulation.cell(index(*cell));
            !here.state.is_still() && here.ground.thickness(here.state.h) > threshold
        };
        let starts = |late: &&mut Late| {
            !late.came
                && match late.starts {
                    Starts::At(at) => at <= time,
                    Starts::Hit => late.cells.iter().any(|(cell, _)| reached(cell)),
                }
        };
        let mut volumes: BTreeMap<[usize; 2], Vec<f64>> = BTreeMap::new();
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
                let old = simulation.state(index(cell));
                (index(cell), Flow { h: old.h + volumes.iter().sum::<f64>(), ..old })
            })
            .collect();
        if !states.is_empty() {
            simulation.change(states);
        }
    }

    /// What a checkpoint must keep.
    pub fn save(&self) -> Vec<f64> {
        let came = self.late.iter().map(|late| f64::from(u8::from(late.came)));
        came.chain(self.inflows.iter().map(|inflow| inflow.entered)).collect()
    }

    /// Take it up again; false where it does not fit.
    pub fn restore(&mut self, saved: &[f64]) -> bool {
        if saved.len() != self.late.len() + self.inflows.len() {
            return false;
        }
        let (came, entered) = saved.split_at(self.late.len());
        self.late.iter_mut().zip(came).for_each(|(late, came)| late.came = *came != 0.0);
        self.inflows.iter_mut().zip(entered).for_each(|(inflow, entered)| inflow.entered = *entered);
        true
    }

    /// Volume per cell area of the secondary releases that nothing has reached \[m\].
    pub fn unreleased(&self) -> f64 {
        let waiting = self.late.iter().filter(|late| !late.came);
        waiting.flat_map(|late| &late.cells).map(|(_, volume)| volume).sum()
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
        let due = self.hydrograph.volume(time) - self.entered;
        if due <= 0.0 {
            return;
        }
        let speed = self.hydrograph.speed_at(time);
        let measure = simulation.grid().measure();
        let states: Vec<_> = self
            .inlets
            .iter()
            .map(|inlet| {
                let here = simulation.cell(index(inlet.cell));
                let (old, h) = (here.state, due * inlet.share / measure);
                let along: [f64; D] = std::array::from_fn(|k| inlet.direction[k]);
                let horizontal = speed / here.ground.square(along).sqrt();
                let q = std::array::from_fn(|k| old.q[k] + h * horizontal * along[k]);
                (index(inlet.cell), Flow { h: old.h + h, q })
            })
            .collect();
        let before = simulation.poured();
        simulation.change(states);
        self.entered += simulation.poured() - before;
    }

    /// The end of a step after `time` in which no cell takes up more than a step can carry on.
    fn next<const D: usize, S>(&self, simulation: &Simulation<D, S>, time: f64) -> f64
    where
        S: Scheme<D, f64, State = Flow<D, f64>>,
        S::Ground: Bed<D, f64>,
    {
        let Hydrograph { time: instants, discharge, speed } = &self.hydrograph;
        let Some(change) = instants.iter().copied().find(|instant| *instant > time) else {
            return f64::INFINITY;
        };
        if time < instants[0] {
            return change;
        }
        let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        let grid = simulation.grid();
        let size = grid.size.into_iter().fold(f64::INFINITY, f64::min);
        let step = |inlet: &Inlet| {
            let rises = largest(discharge) * inlet.share / grid.measure();
            let pull = simulation.ground(index(inlet.cell)).gravity();
            // The cell's own wave sqrt(2 g h) of what comes in the step, and its speed.
            let by_wave = (CROSSED * size / (2.0 * pull * rises).sqrt()).powf(2.0 / 3.0);
            by_wave.min(CROSSED * size / largest(speed))
        };
        let most = self.inlets.iter().map(step).fold(f64::INFINITY, f64::min);
        change.min(time + most)
    }
}

/// Column and row as the index of a cell.
fn index<const D: usize>(cell: [usize; 2]) -> [usize; D] {
    std::array::from_fn(|k| cell[k])
}
