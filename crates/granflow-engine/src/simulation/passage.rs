//! What passed faces in the last step, found once more from the state before it by the scheme's own functions: the inner loops
//! keep no flux, and a section asks for few.

use super::state::Simulation;
use crate::boundary;
use crate::field::Field;
use granflow_model::real::{for_axis, per_axis};
use granflow_model::scheme::{Cell, Forecasts, Scheme, Side, Spacing, Stencil};

/// A face between a cell and the next one towards larger coordinates along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Face {
    /// Column and row of the cell; -1 is the one below the first, which makes the face one of the grid's edge.
    pub cell: [isize; 2],
    /// The axis across which it lies.
    pub axis: usize,
}

/// The cells around one in the state before a stage.
struct Before<'a, const D: usize, S: Scheme<D, f64>> {
    simulation: &'a Simulation<D, S>,
    state: &'a Field,
    place: usize,
}

impl<const D: usize, S: Scheme<D, f64>> Before<'_, D, S> {
    fn moved(&self, offset: [isize; D]) -> Self {
        Before { place: self.simulation.layout.moved(self.place, offset), ..*self }
    }

    fn forecast(&self, offset: [isize; D], dt: f64) -> S::Forecast {
        self.simulation.scheme.forecast(&self.moved(offset), dt)
    }

    /// What the cell offered to its faces in a step of `dt`.
    fn face_states(&self, dt: f64) -> S::FaceStates {
        let here = self.forecast([0; D], dt);
        let (mut lo, mut hi) = ([here; D], [here; D]);
        for_axis!(axis in D => {
            let mut step = [0; D];
            step[axis] = 1;
            hi[axis] = self.forecast(step, dt);
            step[axis] = -1;
            lo[axis] = self.forecast(step, dt);
        });
        let scheme = &self.simulation.scheme;
        let primitives = scheme.primitives(&self.at([0; D]));
        scheme.reconstruct(self, &primitives, &Forecasts { here, lo, hi }, dt)
    }
}

impl<const D: usize, S: Scheme<D, f64>> Stencil<D, f64, S::State, S::Ground, S::Forcing>
    for Before<'_, D, S>
{
    fn at(&self, offset: [isize; D]) -> Cell<S::State, S::Ground, S::Forcing> {
        let Simulation { layout, grounds, forcings, .. } = self.simulation;
        let place = layout.moved(self.place, offset);
        Cell { state: self.state.get(place), ground: grounds.get(place), forcing: forcings.get(place) }
    }
    fn spacing(&self) -> &Spacing<D, f64> {
        &self.simulation.spacing
    }
}

impl<const D: usize, S: Scheme<D, f64>> Simulation<D, S> {
    /// Volume that passed each of `faces` towards larger coordinates in the last step; 0 before the first one.
    ///
    /// To be asked for after a step, before [`Simulation::show`] shows a state within it. A scheme of two stages needs the
    /// state before the step: [`Simulation::expect`] an instant in it (`f64::NEG_INFINITY` keeps every one).
    ///
    /// # Panics
    /// Where the state before the step was not kept, and beyond the grid.
    #[must_use]
    pub fn passed(&mut self, faces: &[Face]) -> Vec<f64> {
        let mut passed = vec![0.0; faces.len()];
        if self.step == 0 || faces.is_empty() {
            return passed;
        }
        assert!(!self.last.shown, "a state within the step is shown");
        let stages = self.stages.len();
        assert!(stages <= 2, "the states between more than two stages are not kept");
        if stages == 2 {
            assert!(self.last.kept, "nobody asked for the state before the step");
            let (scheme, before) = (&self.scheme, &mut self.last.before);
            boundary::fill(before, &self.grid, &self.layout, |axis, s| scheme.mirror(axis, &s));
        }
        for (stage, &rk_weight) in self.stages.iter().enumerate() {
            // A step writes into `next` and swaps: what the last stage began with is there now, ghosts included.
            let state = if stage + 1 == stages { &self.next } else { &self.last.before };
            for (sum, face) in passed.iter_mut().zip(faces) {
                *sum = (1.0 - rk_weight) * (*sum + self.volume_through(face, state));
            }
        }
        passed
    }

    /// The volume that a stage which begins with `state` brings through a face.
    fn volume_through(&self, face: &Face, state: &Field) -> f64 {
        let Face { cell: [i, j], axis } = *face;
        let inside = |k: isize, count: usize| (-1..count as isize).contains(&k);
        assert!(
            axis < D && inside(i, self.layout.columns) && inside(j, self.layout.rows),
            "no face {face:?}"
        );
        let left = Before { simulation: self, state, place: self.layout.place(i, j) };
        let right = left.moved(per_axis!(k => isize::from(k == axis)));
        let lambda = self.last.dt * self.spacing.inv[axis];
        let dt = self.last.dt;
        let flux = self.scheme.flux(axis, &left.face_states(dt), &right.face_states(dt), lambda);
        self.scheme.outflow(&flux, Side::Left, lambda) * self.grid.measure()
    }
}
