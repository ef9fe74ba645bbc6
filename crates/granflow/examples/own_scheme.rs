//! A scheme of one's own: u_t + div(a u) = 0 by the first-order upwind flux, in one and two dimensions, stepped by the engine
//! on all lanes and threads. A pulse goes once around a periodic domain and keeps its volume.
//!
//! `cargo run --release -p granflow --example own_scheme`

use granflow::grid::Grid;
use granflow::real::{Real, per_axis, total};
use granflow::scheme::{
    Boundary, Cell, Diagnostics, Faces, Forecasts, Scheme, SchemeVisitor, Side, Spacing, Stencil,
};
use granflow::simulation::{Simulation, StepSize};
use granflow::time::{EULER, Stages};

/// Carries a quantity with velocity a, the same along each axis.
#[derive(Clone, Copy, Debug)]
struct Upwind {
    a: f64,
}

impl<const D: usize, R: Real> Scheme<D, R> for Upwind {
    type State = R;
    type Ground = ();
    type Forcing = ();
    type Primitives = ();
    type Forecast = ();
    type FaceStates = R;
    type Flux = R;
    type Corner = ();

    fn with_scalar<L: Real, V: SchemeVisitor<D, L>>(&self, visitor: V) -> V::Output {
        visitor.visit(self)
    }
    fn stages(&self) -> Stages {
        EULER
    }
    fn max_courant(&self) -> f64 {
        1.0
    }
    #[inline(always)]
    fn primitives(&self, _here: &Cell<R, ()>) {}
    #[inline(always)]
    fn forecast(&self, _stencil: &impl Stencil<D, R, R, ()>, _dt: R) {}
    #[inline(always)]
    fn reconstruct(
        &self,
        stencil: &impl Stencil<D, R, R, ()>,
        _primitives: &(),
        _forecasts: &Forecasts<D, ()>,
        _dt: R,
    ) -> R {
        stencil.at([0; D]).state
    }
    /// a+ u_left + a- u_right
    #[inline(always)]
    fn flux(&self, _axis: usize, left: &R, right: &R, _lambda: R) -> R {
        R::splat(self.a.max(0.0)) * *left + R::splat(self.a.min(0.0)) * *right
    }
    #[inline(always)]
    fn corner(&self, _around: [[&R; 2]; 2]) {}
    #[inline(always)]
    fn update(
        &self,
        stencil: &impl Stencil<D, R, R, ()>,
        _own: &R,
        faces: &[Faces<R>; D],
        _corners: &[[(); 2]; 2],
        dt: R,
    ) -> R {
        let inv = stencil.spacing().inv;
        let gone: [R; D] = per_axis!(k => dt * inv[k] * (faces[k].hi - faces[k].lo));
        stencil.at([0; D]).state - total(gone)
    }
    fn mirror(&self, _axis: usize, state: &R) -> R {
        *state
    }
    fn mirror_ground(&self, _axis: usize, _ground: &()) {}
    #[inline(always)]
    fn rate(&self, _here: &Cell<R, ()>, spacing: &Spacing<D, R>) -> R {
        total(spacing.inv) * R::splat(self.a.abs())
    }
    /// Where there is nothing, and nothing comes, there will be nothing.
    #[inline(always)]
    fn is_static(&self, here: &Cell<R, ()>) -> R::Mask {
        here.state.equals(R::zero())
    }
    #[inline(always)]
    fn is_nodata(&self, _ground: &()) -> R::Mask {
        R::zero().lt(R::zero())
    }
    #[inline(always)]
    fn outflow(&self, flux: &R, _side: Side, lambda: R) -> R {
        lambda * *flux
    }
    fn yield_ratio(&self, _stencil: &impl Stencil<D, R, R, ()>) -> R {
        R::zero()
    }
    #[inline(always)]
    fn diagnostics(&self, here: &Cell<R, ()>) -> Diagnostics<R> {
        let zero = R::zero();
        Diagnostics {
            volume: here.state,
            speed_squared: zero,
            energy: zero,
            thickness: here.state,
            film: zero,
        }
    }
}

granflow::kernel!(upwind: Upwind);

/// A pulse in the middle of a periodic domain \[0, 1\], carried around once; the largest value at the end.
fn around<const D: usize>(cells: usize) -> Result<f64, Box<dyn std::error::Error>> {
    let grid = Grid {
        cells: [cells; D],
        origin: [0.0; D],
        size: [1.0 / cells as f64; D],
        boundary: [[Boundary::Periodic; 2]; D],
    };
    let pulse = |index| {
        let x: [f64; D] = grid.centre(index);
        if x.iter().all(|x| (x - 0.5).abs() < 0.2) { 1.0 } else { 0.0 }
    };
    let courant = StepSize::Courant(0.9);
    let mut run = Simulation::new(Upwind { a: 1.0 }, grid, courant, |_| (), pulse)?;
    let before = run.totals().volume;
    while run.time() < 1.0 {
        run.advance(1.0)?;
    }
    assert!((run.totals().volume / before - 1.0).abs() < 1e-13, "nothing is lost");
    Ok(run.collect(|cell| cell.state).into_iter().fold(0.0, f64::max))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (line, plane) = (around::<1>(200)?, around::<2>(100)?);
    println!("largest value after one time around: {line:.4} on a line, {plane:.4} on a plane");
    assert!(line > 0.99 && plane > 0.8 && line <= 1.0 + 1e-12 && plane <= 1.0 + 1e-12);
    Ok(())
}
