//! A scheme of one's own, stepped by the engine: a mixture of five parts that is carried by a wind.
//!
//! u_t + div(a u) = 0 by the upwind flux a+ u_left + a- u_right. A scheme is this file's upper half; [`kernel!`] does the rest.

use granflow_engine::grid::Grid;
use granflow_engine::kernel;
use granflow_engine::simulation::{SimdLevel, Simulation, StepSize};
use granflow_model::real::{Real, for_axis, per_axis};
use granflow_model::scheme::{
    Boundary, Cell, Diagnostics, Faces, Forecasts, Scheme, SchemeVisitor, Side, Spacing, Stencil, components,
};
use granflow_model::time::{EULER, Stages};

/// The unknowns: a volume, and how much of it is of each of four kinds.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Mixture<R> {
    volume: R,
    kinds: [[R; 2]; 2],
}
components!([R: Real] Mixture<R> { volume: R, kinds: [[R; 2]; 2] });

impl<R: Real> Mixture<R> {
    #[inline(always)]
    fn combine(self, other: Self, f: impl Fn(R, R) -> R) -> Self {
        Mixture {
            volume: f(self.volume, other.volume),
            kinds: per_axis!(i => per_axis!(j => f(self.kinds[i][j], other.kinds[i][j]))),
        }
    }
    #[inline(always)]
    fn is_none(self) -> R::Mask {
        let mut none = self.volume.equals(R::zero());
        let two = 2;
        for_axis!(i in two => {
            for_axis!(j in two => {
                none = none & self.kinds[i][j].equals(R::zero());
            });
        });
        none
    }
}

/// The wind.
#[derive(Clone, Copy, Debug)]
struct Wind<const D: usize, R> {
    speed: [R; D],
}
components!([const D: usize, R: Real] Wind<D, R> { speed: [R; D] });

/// What a cell offers to its faces.
#[derive(Clone, Copy, Debug)]
struct Carried<const D: usize, R> {
    state: Mixture<R>,
    speed: [R; D],
}
components!([const D: usize, R: Real] Carried<D, R> { state: Mixture<R>, speed: [R; D] });

#[derive(Clone, Copy, Debug)]
struct Upwind;

impl<const D: usize, R: Real> Scheme<D, R> for Upwind {
    type State = Mixture<R>;
    type Ground = Wind<D, R>;
    type Forcing = ();
    type Primitives = ();
    type Forecast = ();
    type FaceStates = Carried<D, R>;
    type Flux = Mixture<R>;
    type Corner = ();

    fn stages(&self) -> Stages {
        EULER
    }
    fn max_courant(&self) -> f64 {
        1.0
    }
    fn with_scalar<L: Real, V: SchemeVisitor<D, L>>(&self, visitor: V) -> V::Output {
        visitor.visit(self)
    }

    #[inline(always)]
    fn primitives(&self, _here: &Cell<Mixture<R>, Wind<D, R>>) {}
    #[inline(always)]
    fn forecast(&self, _stencil: &impl Stencil<D, R, Mixture<R>, Wind<D, R>>, _dt: R) {}
    #[inline(always)]
    fn reconstruct(
        &self,
        stencil: &impl Stencil<D, R, Mixture<R>, Wind<D, R>>,
        _: &(),
        _forecasts: &Forecasts<D, ()>,
        _dt: R,
    ) -> Carried<D, R> {
        let Cell { state, ground, .. } = stencil.at([0; D]);
        Carried { state, speed: ground.speed }
    }
    #[inline(always)]
    fn flux(&self, axis: usize, left: &Carried<D, R>, right: &Carried<D, R>, _lambda: R) -> Mixture<R> {
        let speed = (left.speed[axis] + right.speed[axis]) * R::splat(0.5);
        let (up, down) = (speed.positive_part(), -(-speed).positive_part());
        left.state.combine(
            right.state,
            #[inline(always)]
            |left, right| up * left + down * right,
        )
    }
    #[inline(always)]
    fn corner(&self, _around: [[&Carried<D, R>; 2]; 2]) {}
    #[inline(always)]
    fn update(
        &self,
        stencil: &impl Stencil<D, R, Mixture<R>, Wind<D, R>>,
        _states: &Carried<D, R>,
        faces: &[Faces<Mixture<R>>; D],
        _corners: &[[(); 2]; 2],
        dt: R,
    ) -> Mixture<R> {
        let mut state = stencil.at([0; D]).state;
        for_axis!(axis in D => {
            let lambda = dt * stencil.spacing().inv[axis];
            let Faces { lo, hi } = faces[axis];
            let loss = hi.combine(
                lo,
                #[inline(always)]
                |hi, lo| lambda * (hi - lo),
            );
            state = state.combine(
                loss,
                #[inline(always)]
                |state, loss| state - loss,
            );
        });
        state
    }

    fn mirror(&self, _axis: usize, state: &Mixture<R>) -> Mixture<R> {
        *state
    }
    fn mirror_ground(&self, axis: usize, ground: &Wind<D, R>) -> Wind<D, R> {
        let mut mirrored = *ground;
        mirrored.speed[axis] = -mirrored.speed[axis];
        mirrored
    }
    #[inline(always)]
    fn rate(&self, here: &Cell<Mixture<R>, Wind<D, R>>, spacing: &Spacing<D, R>) -> R {
        let mut sum = R::zero();
        for_axis!(axis in D => {
            sum = sum + here.ground.speed[axis].abs() * spacing.inv[axis];
        });
        sum
    }
    #[inline(always)]
    fn is_static(&self, here: &Cell<Mixture<R>, Wind<D, R>>) -> R::Mask {
        here.state.is_none()
    }
    #[inline(always)]
    fn is_nodata(&self, _ground: &Wind<D, R>) -> R::Mask {
        R::splat(1.0).lt(R::zero())
    }
    #[inline(always)]
    fn outflow(&self, flux: &Mixture<R>, _side: Side, lambda: R) -> R {
        lambda * flux.volume
    }
    fn yield_ratio(&self, _stencil: &impl Stencil<D, R, Mixture<R>, Wind<D, R>>) -> R {
        R::zero()
    }
    #[inline(always)]
    fn diagnostics(&self, here: &Cell<Mixture<R>, Wind<D, R>>) -> Diagnostics<R> {
        let Mixture { volume, .. } = here.state;
        Diagnostics {
            volume,
            speed_squared: R::zero(),
            energy: R::zero(),
            thickness: volume,
            film: R::zero(),
        }
    }
}

kernel!(upwind: Upwind);

/// A lump in the lower half of each axis, of kinds that differ from cell to cell.
fn run<const D: usize>(cells: [usize; D], ends: Boundary) -> Simulation<D, Upwind> {
    let grid = Grid { cells, origin: [0.0; D], size: [0.1; D], boundary: [[ends; 2]; D] };
    let wind = |_: [usize; D]| Wind { speed: std::array::from_fn(|axis| [0.9, -0.4][axis]) };
    let start = |index: [usize; D]| {
        let inside = (0..D).all(|k| index[k] >= cells[k] / 8 && index[k] < cells[k] / 2);
        let volume = if inside { 1.0 + (index[0] % 7) as f64 } else { 0.0 };
        let kind = |k: usize| if index[0] % 4 == k { volume } else { 0.0 };
        Mixture { volume, kinds: [[kind(0), kind(1)], [kind(2), kind(3)]] }
    };
    Simulation::new(Upwind, grid, StepSize::Courant(0.8), wind, start)
        .expect("cells, and a step that it takes")
}

fn is_carried_and_kept<const D: usize>(cells: [usize; D]) {
    let mut runs = [SimdLevel::Scalar, SimdLevel::Avx2, SimdLevel::Best].map(|simd| {
        let mut run = run(cells, Boundary::Open);
        run.use_simd(simd);
        run
    });
    let before = runs[0].totals().volume;
    for step in 0..100 {
        for run in &mut runs {
            run.advance(f64::INFINITY).unwrap();
        }
        let gone: f64 = runs[0].out().iter().sum();
        let now = runs[0].totals().volume + gone;
        assert!((now / before - 1.0).abs() < 1e-13, "step {step}: {now} of {before}");
    }
    for number in 0..runs[0].grid().count() {
        let index = runs[0].grid().index(number);
        let state = runs[0].state(index);
        assert!(runs.iter().all(|run| run.state(index) == state), "{index:?}");
        let kinds: f64 = state.kinds.concat().iter().sum();
        assert!((kinds - state.volume).abs() < 1e-12, "{index:?}: {state:?}");
    }
    assert!(runs[0].out()[1] > 0.1 * before, "some has left to the right: {:?}", runs[0].out());
    assert!(D == 1 || runs[0].out()[2] > 0.0, "and below");
}

#[test]
fn five_components_are_carried_and_kept_on_a_line() {
    is_carried_and_kept([70]);
}

#[test]
fn five_components_are_carried_and_kept_on_a_plane() {
    is_carried_and_kept([70, 45]);
}

/// Small enough for Miri: every read and write of the loops is checked there.
#[test]
fn a_few_steps_of_few_cells() {
    for ends in [Boundary::Open, Boundary::Wall, Boundary::Periodic] {
        let (mut line, mut plane) = (run([9], ends), run([9, 6], ends));
        line.use_simd(SimdLevel::Scalar);
        plane.use_simd(SimdLevel::Scalar);
        for _ in 0..3 {
            line.advance(f64::INFINITY).unwrap();
            plane.advance(f64::INFINITY).unwrap();
        }
        assert!(line.totals().volume > 0.0 && plane.totals().volume > 0.0);
    }
}

#[test]
fn tiles_sleep_until_the_mixture_comes() {
    let mut run = run([400, 60], Boundary::Wall);
    run.advance(f64::INFINITY).unwrap();
    run.advance(f64::INFINITY).unwrap();
    let before = run.updates();
    run.advance(f64::INFINITY).unwrap();
    let share = (run.updates() - before) as f64 / run.grid().count() as f64;
    assert!(share < 0.6, "{share} of the cells were computed");
}
