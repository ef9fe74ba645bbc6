//! Builds the runs of the test suite: chutes, terrain from a function; `super::tried` says of which scheme.
#![allow(dead_code)]

use granflow::grid::Grid;
use granflow::kernels::Kernel;
use granflow::savage_hutter::Flow;
use granflow::savage_hutter::ground::{Bed, Chute, Terrain};
use granflow::scheme::Boundary;
use granflow::simulation::{Simulation, StepSize};

#[allow(unused_imports)]
pub use super::tried::{ORDERS, Order, Tried};

/// Gravity of the runs in SI units.
pub const GRAVITY: f64 = 9.81;

/// A run of the scheme that is tried on the bed `B`.
pub type Run<const D: usize, B> = Simulation<D, Tried<B>>;

/// Square cells with one kind of boundary all round.
pub fn grid<const D: usize>(cells: [usize; D], origin: [f64; D], size: f64, ends: Boundary) -> Grid<D> {
    Grid { cells, origin, size: [size; D], boundary: [[ends; 2]; D] }
}

/// An interval cut into cells.
pub fn line(from: f64, to: f64, cells: usize, ends: Boundary) -> Grid<1> {
    grid([cells], [from], (to - from) / cells as f64, ends)
}

/// A plane whose sin(zeta) as a vector is `tilt`, with beta = `pressure` cos(zeta); gravity is 1.
pub fn plane<const D: usize>(tilt: [f64; D], pressure: f64) -> Chute<D, f64> {
    let cos = (1.0 - tilt.iter().map(|s| s * s).sum::<f64>()).sqrt();
    Chute { tilt, beta: pressure * cos, cos, curvature: 0.0 }
}

/// A plane chute in SI units: slope angle `zeta` along x.
pub fn incline<const D: usize>(zeta: f64) -> Chute<D, f64> {
    let mut tilt = [0.0; D];
    tilt[0] = GRAVITY * zeta.sin();
    Chute { tilt, beta: GRAVITY * zeta.cos(), cos: GRAVITY * zeta.cos(), curvature: 0.0 }
}

/// A bed at one point: height, gradient, second derivatives.
#[derive(Clone, Copy, Debug)]
pub struct Surface<const D: usize> {
    pub z: f64,
    pub slope: [f64; D],
    pub bent: [[f64; D]; D],
}

/// The ground of a bed at one point.
pub fn ground<const D: usize>(Surface { z, slope, bent }: Surface<D>) -> Terrain<D, f64> {
    let cos = 1.0 / (1.0 + slope.iter().map(|s| s * s).sum::<f64>()).sqrt();
    Terrain {
        level: z,
        slope,
        cos,
        curvature: bent.map(|row| row.map(|b| cos * b)),
        gravity: GRAVITY,
        pressure: GRAVITY,
    }
}

/// The grounds of a grid over `bed`, which answers `None` outside the data; slopes are rounded as a grid keeps them.
pub fn terrain<const D: usize>(
    grid: &Grid<D>,
    bed: impl Fn([f64; D]) -> Option<Surface<D>>,
) -> Vec<Terrain<D, f64>> {
    let kept = |surface: Surface<D>| Surface { slope: surface.slope.map(|s| f64::from(s as f32)), ..surface };
    let at = |centre| bed(centre).map_or(Terrain::nothing(GRAVITY), |surface| ground(kept(surface)));
    (0..grid.count()).map(|number| at(grid.centre(grid.index(number)))).collect()
}

/// A run of the scheme that is tried over given grounds, one for each cell.
pub fn run<const D: usize, B: Bed<D, f64>>(
    order: Order,
    (mu, film): (f64, f64),
    step: StepSize,
    grid: Grid<D>,
    grounds: &[B],
    start: impl Fn([f64; D], &B) -> Flow<D, f64> + Sync,
) -> Run<D, B>
where
    Tried<B>: Kernel<D, Ground = B, State = Flow<D, f64>>,
{
    let number = |index: [usize; D]| index[0] + if D > 1 { index[D - 1] * grid.cells[0] } else { 0 };
    Simulation::new(
        order.scheme(mu, film),
        grid,
        step,
        |index| grounds[number(index)],
        |index| start(grid.centre(index), &grounds[number(index)]),
    )
    .unwrap()
}

/// A run on a plane.
pub fn on_plane<const D: usize>(
    order: Order,
    friction: (f64, f64),
    step: StepSize,
    grid: Grid<D>,
    ground: Chute<D, f64>,
    start: impl Fn([f64; D]) -> Flow<D, f64> + Sync,
) -> Run<D, Chute<D, f64>> {
    run(order, friction, step, grid, &vec![ground; grid.count()], |x, _| start(x))
}

/// Steps without a last time.
pub fn steps<const D: usize, S: Kernel<D>>(run: &mut Simulation<D, S>, count: usize) {
    for _ in 0..count {
        run.advance(f64::INFINITY).expect("the step is finite");
    }
}

/// Steps up to the time `end`.
pub fn until<const D: usize, S: Kernel<D>>(run: &mut Simulation<D, S>, end: f64) {
    while run.time() < end {
        run.advance(end).expect("the state is finite");
    }
}

/// All states, x fastest.
pub fn states<const D: usize, S: Kernel<D, State = Flow<D, f64>>>(
    run: &Simulation<D, S>,
) -> Vec<Flow<D, f64>> {
    run.collect(|cell| cell.state)
}

/// All depths, x fastest.
pub fn depths<const D: usize, S: Kernel<D, State = Flow<D, f64>>>(run: &Simulation<D, S>) -> Vec<f64> {
    run.collect(|cell| cell.state.h)
}

/// Relative error of the ledger: volume now and booked as gone, against the volume at the start.
pub fn lost<const D: usize, S: Kernel<D>>(run: &Simulation<D, S>, before: f64) -> f64 {
    (run.totals().volume + run.out().iter().sum::<f64>() - before) / before
}

/// Runs the work on one thread, without the traffic between threads that small grids do not repay.
pub fn alone<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread").install(work)
}

/// Numbers from 0 to 1 that look random and are the same everywhere (splitmix64, Vigna 2015).
pub struct Dice(pub u64);

impl Dice {
    pub fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64
    }
    pub fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.roll()
    }
}

/// Every number of the state of a flow, its totals and what left it, as bits.
pub fn bits<S: Kernel<2, State = Flow<2, f64>>>(run: &Simulation<2, S>) -> Vec<u64> {
    let mut all: Vec<f64> = run.collect(|c| [c.state.h, c.state.q[0], c.state.q[1]]).concat();
    let totals = run.totals();
    all.extend([totals.volume, totals.film, totals.speed, totals.energy, run.time(), run.step() as f64]);
    all.extend(run.out());
    all.into_iter().map(f64::to_bits).collect()
}

/// Two runs after `count` steps, one of them with all its tiles awake in each: no step may tell them apart.
pub fn asleep_and_awake<S: Kernel<2, State = Flow<2, f64>>>(
    name: &str,
    build: impl Fn() -> Simulation<2, S>,
    count: usize,
) -> [Simulation<2, S>; 2] {
    let (mut asleep, mut awake) = (build(), build());
    alone(|| {
        for step in 0..count {
            steps(&mut asleep, 1);
            awake.wake_all();
            steps(&mut awake, 1);
            assert!(bits(&asleep) == bits(&awake), "{name}, step {step}");
        }
    });
    [asleep, awake]
}
