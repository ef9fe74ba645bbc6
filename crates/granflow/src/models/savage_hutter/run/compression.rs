//! The passive earth pressure, which acts against compression between two steps, axis by axis.

use super::between::BetweenSteps;
use granflow_case::avalanche::Material;
use granflow_engine::grid::Grid;
use granflow_engine::simulation::Simulation;
use granflow_model::savage_hutter::Flow;
use granflow_model::savage_hutter::earth_pressure::{Mass, excess, stresses};
use granflow_model::savage_hutter::ground::Bed;
use granflow_model::scheme::{Boundary, Scheme};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// What compression adds to the earth pressure of a scheme.
pub(super) struct Compression {
    /// k_pas/k_act - 1.
    excess: f64,
    /// The friction coefficient of the bed.
    mu: f64,
    /// A thinner layer is held.
    film: f64,
}

/// So much of the largest momentum of a line is left by rounding where none is to be left.
const ROUNDING: f64 = 1e-14;

/// A wet cell of a line.
struct Wet<const D: usize> {
    index: [usize; D],
    state: Flow<D, f64>,
    /// M e, the acceleration that a force along the line gives.
    along: [f64; D],
    head: f64,
    /// h (|u|^2 - (dt mu g_n)^2) if it moves: above 0 if it is faster than friction stops it within the step.
    fast: f64,
}

impl Compression {
    /// Of a material whose coefficients of stretching and compression differ.
    pub fn of(material: &Material, film: f64) -> Option<Self> {
        let [active, passive] = [material.pressure_coefficient, material.passive_coefficient];
        let mu = material.mu.unwrap_or(0.0);
        (passive > active).then(|| Compression { excess: passive / active - 1.0, mu, film })
    }

    /// A cell as a line along `axis` sees it, if it is more than a film.
    fn wet<const D: usize, S>(
        &self,
        simulation: &Simulation<D, S>,
        index: [usize; D],
        (axis, dt): (usize, f64),
    ) -> Option<Wet<D>>
    where
        S: Scheme<D, f64, State = Flow<D, f64>>,
        S::Ground: Bed<D, f64>,
    {
        let (state, ground) = (simulation.state(index), simulation.ground(index));
        if simulation.scheme().is_nodata(&ground) || state.h < self.film || state.h <= 0.0 {
            return None;
        }
        let unit = std::array::from_fn(|k| if k == axis { 1.0 } else { 0.0 });
        let along = S::Ground::metric(&ground.plane(), unit);
        let stopped = self.mu * ground.weight_at_rest() * dt;
        let over = ground.square(state.velocity()) - stopped * stopped;
        let fast = if state.is_still() { 0.0 } else { state.h * over };
        Some(Wet { index, state, along, head: ground.head(), fast })
    }

    /// The wet cells side by side to be pressed, of the line along `axis` from `begin`; `moving` are the places of its moving cells,
    /// growing. What moves in them has more energy than friction takes in a step: the last of it comes to rest as under k_act, for
    /// stresses would take from step to step a share of what is left.
    fn runs<const D: usize, S>(
        &self,
        simulation: &Simulation<D, S>,
        begin: [usize; D],
        (axis, dt): (usize, f64),
        moving: &[usize],
    ) -> Vec<Vec<Wet<D>>>
    where
        S: Scheme<D, f64, State = Flow<D, f64>>,
        S::Ground: Bed<D, f64>,
    {
        let wet = |at: usize| {
            let mut index = begin;
            index[axis] = at;
            self.wet(simulation, index, (axis, dt))
        };
        let end = simulation.grid().cells[axis];
        let (mut runs, mut seen) = (Vec::new(), 0);
        for &at in moving {
            if at < seen {
                continue;
            }
            let Some(middle) = wet(at) else { continue };
            let mut run: Vec<Wet<D>> = (0..at).rev().map_while(wet).collect();
            run.reverse();
            run.push(middle);
            run.extend((at + 1..end).map_while(wet));
            seen = run.last().map_or(end, |last| last.index[axis] + 1);
            if run.iter().map(|cell| cell.fast).sum::<f64>() > 0.0 {
                runs.push(run);
            }
        }
        runs
    }

    /// The states of wet cells side by side along `axis` after a step `dt`.
    fn pressed<const D: usize>(
        &self,
        grid: &Grid<D>,
        cells: &[Wet<D>],
        (axis, dt): (usize, f64),
    ) -> Vec<([usize; D], Flow<D, f64>)> {
        let lambda = dt / grid.size[axis];
        let (first, last) = (&cells[0], &cells[cells.len() - 1]);
        let ends = [first.index[axis] == 0, last.index[axis] + 1 == grid.cells[axis]];
        let walls = [0, 1].map(|side| ends[side] && grid.boundary[axis][side] == Boundary::Wall);
        let most =
            |a: &Wet<D>, b: &Wet<D>| excess(self.excess, [a.head, b.head], [a.state.h, b.state.h], lambda);
        let of = |(k, cell): (usize, &Wet<D>)| Mass {
            mass: cell.state.h / cell.along[axis],
            velocity: cell.state.velocity()[axis],
            most: cells.get(k + 1).map_or(0.0, |next| most(cell, next)),
        };
        let line: Vec<Mass> = cells.iter().enumerate().map(of).collect();
        let at = [first, last];
        let walls = [0, 1].map(|side| walls[side].then(|| most(at[side], at[side])));
        let pushes = stresses(&line, walls);
        let largest = cells.iter().map(|cell| cell.state.q[axis].abs()).fold(0.0, f64::max);
        let pressed = cells.iter().zip(pushes).filter(|(_, push)| *push != 0.0);
        pressed
            .map(|(cell, push)| {
                let q = std::array::from_fn(|k| {
                    let new = cell.state.q[k] + cell.along[k] * push;
                    // What comes to rest is at rest, and does not move by a rounding.
                    if new.abs() <= ROUNDING * largest { 0.0 } else { new }
                });
                (cell.index, Flow { h: cell.state.h, q })
            })
            .collect()
    }
}

impl<const D: usize, S> BetweenSteps<D, S> for Compression
where
    S: Scheme<D, f64, State = Flow<D, f64>>,
    S::Ground: Bed<D, f64>,
{
    fn act(&mut self, simulation: &mut Simulation<D, S>, dt: f64) {
        if dt <= 0.0 {
            return;
        }
        let grid = *simulation.grid();
        for axis in 0..D {
            let moving = simulation.of_moving(|index, here| (!here.state.is_still()).then_some(index));
            let mut lines: BTreeMap<[usize; D], Vec<usize>> = BTreeMap::new();
            for mut index in moving {
                let at = std::mem::replace(&mut index[axis], 0);
                lines.entry(index).or_default().push(at);
            }
            let mut states = Vec::new();
            for (begin, mut moving) in lines {
                moving.sort_unstable();
                for run in self.runs(simulation, begin, (axis, dt), &moving) {
                    states.extend(self.pressed(&grid, &run, (axis, dt)));
                }
            }
            if !states.is_empty() {
                simulation.change(states);
            }
        }
    }

    fn save(&self) -> Cow<'_, [f64]> {
        Cow::Borrowed(&[])
    }

    fn restore(&mut self, _simulation: &mut Simulation<D, S>, saved: &[f64]) -> bool {
        saved.is_empty()
    }
}
