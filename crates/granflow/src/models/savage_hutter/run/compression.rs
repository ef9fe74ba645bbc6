//! The passive earth pressure, which acts against compression between two steps, axis by axis.

use super::between::BetweenSteps;
use granflow_case::avalanche::{FOREST, Material};
use granflow_engine::grid::Grid;
use granflow_engine::simulation::Simulation;
use granflow_model::savage_hutter::Flow;
use granflow_model::savage_hutter::earth_pressure::{Mass, Standing, excess, holds, stresses};
use granflow_model::savage_hutter::friction::{AnyLaw, LocalFriction};
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
    /// The law that says what a cell at rest holds, if it is the same everywhere; else nothing is held by stresses.
    law: Option<AnyLaw>,
    /// A thinner layer is held.
    film: f64,
    /// All that moved stands, held by stresses.
    held: bool,
}

/// So much of the largest momentum of a line is left by rounding where none is to be left.
const ROUNDING: f64 = 1e-14;

/// So many steps, counted from the start of the run, lie between two looks whether all is held.
const LOOK: u64 = 8;

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
        // Drag holds nothing, a layer is no law.
        let same = material.in_space.iter().all(|parameter| parameter.index >= FOREST);
        let law = same.then_some(material.law);
        (passive > active).then(|| Compression { excess: passive / active - 1.0, mu, law, film, held: false })
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

    /// All wet cells side by side along `axis` among which something moves, after a step `dt`.
    fn lines<const D: usize, S>(&self, simulation: &Simulation<D, S>, axis: usize, dt: f64) -> Vec<Line<D>>
    where
        S: Scheme<D, f64, State = Flow<D, f64>>,
        S::Ground: Bed<D, f64>,
    {
        let grid = simulation.grid();
        let moving = simulation.of_moving(|index, here| (!here.state.is_still()).then_some(index));
        let mut lines: BTreeMap<[usize; D], Vec<usize>> = BTreeMap::new();
        for mut index in moving {
            let at = std::mem::replace(&mut index[axis], 0);
            lines.entry(index).or_default().push(at);
        }
        let mut runs = Vec::new();
        for (begin, mut moving) in lines {
            moving.sort_unstable();
            let wet = |at: usize| {
                let mut index = begin;
                index[axis] = at;
                self.wet(simulation, index, (axis, dt))
            };
            let mut seen = 0;
            for at in moving {
                if at < seen {
                    continue;
                }
                let Some(middle) = wet(at) else { continue };
                let mut run: Vec<Wet<D>> = (0..at).rev().map_while(wet).collect();
                run.reverse();
                run.push(middle);
                run.extend((at + 1..grid.cells[axis]).map_while(wet));
                seen = run.last().map_or(seen, |last| last.index[axis] + 1);
                runs.push(self.line(grid, run, axis, dt / grid.size[axis]));
            }
        }
        runs
    }

    /// Cells side by side along `axis` with the most that compression adds between them in a step with dt/dx = `lambda`.
    fn line<const D: usize>(&self, grid: &Grid<D>, cells: Vec<Wet<D>>, axis: usize, lambda: f64) -> Line<D> {
        let most =
            |a: &Wet<D>, b: &Wet<D>| excess(self.excess, [a.head, b.head], [a.state.h, b.state.h], lambda);
        let at = [&cells[0], &cells[cells.len() - 1]];
        let ends = [at[0].index[axis] == 0, at[1].index[axis] + 1 == grid.cells[axis]];
        let wall = |side: usize| ends[side] && grid.boundary[axis][side] == Boundary::Wall;
        let walls = [0, 1].map(|side| wall(side).then(|| most(at[side], at[side])));
        let next = cells.windows(2).map(|pair| most(&pair[0], &pair[1])).chain([0.0]).collect();
        Line { axis, most: next, walls, cells }
    }

    /// Stop what moves, if stresses and the friction of cells at rest can hold all of it.
    fn stop_if_held<const D: usize, S>(&self, simulation: &mut Simulation<D, S>, dt: f64) -> bool
    where
        S: Scheme<D, f64, State = Flow<D, f64>>,
        S::Ground: Bed<D, f64>,
    {
        let Some(law) = self.law else { return false };
        let (pulls, here) = (simulation.yield_ratios(), law.parameters());
        let columns = simulation.grid().cells[0];
        let standing = |axis: usize, cell: &Wet<D>, most: f64| {
            let ground = simulation.ground(cell.index);
            let number = cell.index[0] + cell.index.get(1).map_or(0, |row| row * columns);
            let (h, weight) = (cell.state.h, ground.weight_at_rest());
            let holding = law.resistance_with(&here, ground.thickness(h), 0.0, weight, weight).holding;
            let friction = h * holding * dt;
            let u = cell.state.velocity();
            let (speed, pull) = (ground.square(u).sqrt(), pulls[number]);
            if pull > 1.0 && speed > 0.0 {
                // Its direction is that in which it moves.
                let [more, less] = [speed, -speed].map(|by| {
                    ground.square(std::array::from_fn(|k| if k == axis { u[k] + by } else { u[k] }))
                });
                let along = 0.25 * (more - less) / (speed * speed);
                return Standing { momentum: friction * (pull - 1.0) * along, spare: 0.0, most };
            }
            // What one axis takes is not there for the other.
            let spare = friction * (1.0 - pull).max(0.0) / (cell.along[axis] * D as f64).sqrt();
            Standing { momentum: 0.0, spare, most }
        };
        let held = (0..D).all(|axis| {
            self.lines(simulation, axis, dt).iter().all(|line| {
                let cells = line.cells.iter().zip(&line.most);
                let standing: Vec<Standing> = cells.map(|(cell, most)| standing(axis, cell, *most)).collect();
                holds(&standing, line.walls)
            })
        });
        let still = |index, h| (index, Flow { h, q: [0.0; D] });
        let stopped = simulation.of_moving(|index, here| Some(still(index, here.state.h)));
        if !held || stopped.is_empty() {
            return false;
        }
        simulation.change(stopped);
        true
    }
}

/// Wet cells side by side along an axis.
struct Line<const D: usize> {
    axis: usize,
    cells: Vec<Wet<D>>,
    /// The most that compression adds at the face of each to the next.
    most: Vec<f64>,
    /// The same at an end that is a wall.
    walls: [Option<f64>; 2],
}

impl<const D: usize> Line<D> {
    /// Has what moves more energy than friction takes in a step? The last of it comes to rest as under k_act, for stresses would take
    /// from step to step a share of what is left.
    fn is_fast(&self) -> bool {
        self.cells.iter().map(|cell| cell.fast).sum::<f64>() > 0.0
    }

    /// The states that stresses leave.
    fn pressed(&self) -> Vec<([usize; D], Flow<D, f64>)> {
        let axis = self.axis;
        let of = |(cell, most): (&Wet<D>, &f64)| Mass {
            mass: cell.state.h / cell.along[axis],
            velocity: cell.state.velocity()[axis],
            most: *most,
        };
        let line: Vec<Mass> = self.cells.iter().zip(&self.most).map(of).collect();
        let pushes = stresses(&line, self.walls);
        let largest = self.cells.iter().map(|cell| cell.state.q[axis].abs()).fold(0.0, f64::max);
        let pressed = self.cells.iter().zip(pushes).filter(|(_, push)| *push != 0.0);
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
        let mut fast = false;
        for axis in 0..D {
            let mut lines = self.lines(simulation, axis, dt);
            lines.retain(Line::is_fast);
            fast |= !lines.is_empty();
            let states: Vec<_> = lines.iter().flat_map(Line::pressed).collect();
            if !states.is_empty() {
                simulation.change(states);
            }
        }
        self.held = !fast && simulation.step().is_multiple_of(LOOK) && self.stop_if_held(simulation, dt);
    }

    fn is_held(&self) -> bool {
        self.held
    }

    fn save(&self) -> Cow<'_, [f64]> {
        Cow::Owned(vec![f64::from(u8::from(self.held))])
    }

    fn restore(&mut self, _simulation: &mut Simulation<D, S>, saved: &[f64]) -> bool {
        let [held] = saved else { return false };
        self.held = *held != 0.0;
        true
    }
}
