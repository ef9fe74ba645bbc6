//! The schemes for avalanches as data, and the runs that they make.

use granflow::grid::Grid;
use granflow::kernels::Kernel;
use granflow::run::Stepper;
use granflow::savage_hutter::Flow;
use granflow::savage_hutter::balanced::Balanced;
use granflow::savage_hutter::energy_stable::EnergyStable;
use granflow::savage_hutter::friction::{Coulomb, Law};
use granflow::savage_hutter::ground::{Bed, Chute, Terrain};
use granflow::savage_hutter::kinetic::{
    Kinetic, VERFAHREN_1, VERFAHREN_2, VERFAHREN_3, VERFAHREN_4, VERFAHREN_5, Variant,
};
use granflow::scheme::Boundary;
use granflow::simulation::{BuildError, Simulation, StepSize};

use crate::failure::Failure;

/// Gravity of the runs in SI units \[m/s²\].
pub const GRAVITY: f64 = 9.81;

/// A run of any scheme.
pub type Run = Box<dyn Stepper>;

/// A scheme by its name in a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    EnergyStable,
    EnergyStable2,
    Balanced,
    Balanced2,
    /// Verfahren 1 to 5.
    Verfahren(usize),
}

use Scheme::{Balanced as First, Balanced2 as Second, EnergyStable as Stable, EnergyStable2 as Stable2};

/// The schemes that come to rest, on any bed and beside dry cells.
pub const RESTING: [Scheme; 4] = [Stable, Stable2, First, Second];

/// All schemes; the Verfahren run on planes, under Coulomb friction, where no cell is dry.
pub const ALL: [Scheme; 9] = [
    Stable,
    Stable2,
    First,
    Second,
    Scheme::Verfahren(1),
    Scheme::Verfahren(2),
    Scheme::Verfahren(3),
    Scheme::Verfahren(4),
    Scheme::Verfahren(5),
];

impl Scheme {
    /// Its name in a case.
    pub fn name(self) -> &'static str {
        match self {
            Stable => "energy_stable",
            Stable2 => "energy_stable_2",
            First => "balanced",
            Second => "balanced_2",
            Self::Verfahren(number) => {
                ["verfahren_1", "verfahren_2", "verfahren_3", "verfahren_4", "verfahren_5"][number - 1]
            }
        }
    }

    /// Second order in smooth flow.
    pub fn is_second_order(self) -> bool {
        matches!(self, Stable2 | Second)
    }

    /// The step of an ordinary run.
    pub fn courant(self) -> StepSize {
        StepSize::Courant(match self {
            Stable | First => 0.9,
            Stable2 => 0.7,
            Second | Self::Verfahren(_) => 0.45,
        })
    }
}

fn variant(number: usize) -> Variant {
    [VERFAHREN_1, VERFAHREN_2, VERFAHREN_3, VERFAHREN_4, VERFAHREN_5][number - 1]
}

/// What a run needs beside grid, bed and initial state.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    pub scheme: Scheme,
    pub law: Law,
    /// Thinner layers keep what they hold, in units of the depth.
    pub film: f64,
    pub step: StepSize,
}

impl Setting {
    /// Coulomb friction and the step of an ordinary run.
    pub fn coulomb(scheme: Scheme, mu: f64, film: f64) -> Self {
        Setting { scheme, law: Law::Coulomb(Coulomb { mu }), film, step: scheme.courant() }
    }

    /// The same with another step.
    pub fn with_step(self, step: StepSize) -> Self {
        Setting { step, ..self }
    }
}

/// A run over given grounds, one for each cell, by a scheme that takes any bed.
pub fn on_bed<const D: usize, B: Bed<D, f64> + 'static>(
    setting: Setting,
    grid: Grid<D>,
    grounds: &[B],
    start: impl Fn([f64; D], &B) -> Flow<D, f64> + Sync,
) -> Result<Run, Failure>
where
    Balanced<Law, B>: Kernel<D, Ground = B, State = Flow<D, f64>>,
    EnergyStable<Law, B>: Kernel<D, Ground = B, State = Flow<D, f64>>,
{
    let Setting { scheme, law, film, step } = setting;
    match scheme {
        Stable => simulation(EnergyStable::first(law, film), grid, step, grounds, start),
        Stable2 => simulation(EnergyStable::second(law, film), grid, step, grounds, start),
        First => simulation(Balanced::first(law, film), grid, step, grounds, start),
        Second => simulation(Balanced::second(law, film), grid, step, grounds, start),
        Scheme::Verfahren(_) => unreachable!("the Verfahren run on planes"),
    }
}

/// A run on a plane or a winding chute, by any scheme.
pub fn on_chute<const D: usize>(
    setting: Setting,
    grid: Grid<D>,
    grounds: &[Chute<D, f64>],
    start: impl Fn([f64; D]) -> Flow<D, f64> + Sync,
) -> Result<Run, Failure>
where
    Kinetic: Kernel<D, Ground = Chute<D, f64>, State = Flow<D, f64>>,
    Balanced<Law, Chute<D, f64>>: Kernel<D, Ground = Chute<D, f64>, State = Flow<D, f64>>,
    EnergyStable<Law, Chute<D, f64>>: Kernel<D, Ground = Chute<D, f64>, State = Flow<D, f64>>,
{
    match (setting.scheme, setting.law) {
        (Scheme::Verfahren(number), Law::Coulomb(law)) => {
            simulation(variant(number).with(law), grid, setting.step, grounds, |x, _| start(x))
        }
        _ => on_bed(setting, grid, grounds, |x, _| start(x)),
    }
}

/// A run on a plane chute, by any scheme.
pub fn on_plane<const D: usize>(
    setting: Setting,
    grid: Grid<D>,
    ground: Chute<D, f64>,
    start: impl Fn([f64; D]) -> Flow<D, f64> + Sync,
) -> Result<Run, Failure>
where
    Kinetic: Kernel<D, Ground = Chute<D, f64>, State = Flow<D, f64>>,
    Balanced<Law, Chute<D, f64>>: Kernel<D, Ground = Chute<D, f64>, State = Flow<D, f64>>,
    EnergyStable<Law, Chute<D, f64>>: Kernel<D, Ground = Chute<D, f64>, State = Flow<D, f64>>,
{
    on_chute(setting, grid, &vec![ground; grid.count()], start)
}

fn simulation<const D: usize, S: Kernel<D, State = Flow<D, f64>> + 'static>(
    scheme: S,
    grid: Grid<D>,
    step: StepSize,
    grounds: &[S::Ground],
    start: impl Fn([f64; D], &S::Ground) -> Flow<D, f64> + Sync,
) -> Result<Run, Failure> {
    let number = |index: [usize; D]| index[0] + if D > 1 { index[D - 1] * grid.cells[0] } else { 0 };
    let ground = |index| grounds[number(index)];
    let state = |index| start(grid.centre(index), &grounds[number(index)]);
    let run: Result<_, BuildError> = Simulation::new(scheme, grid, step, ground, state);
    Ok(Box::new(run.map_err(failed)?))
}

/// A failure of a run.
pub fn failed(error: impl std::fmt::Display) -> Failure {
    Failure::Computation(error.to_string())
}

/// Steps up to the time `end`.
pub fn until(run: &mut dyn Stepper, end: f64) -> Result<(), Failure> {
    while run.time() < end {
        run.advance(end).map_err(failed)?;
    }
    Ok(())
}

/// Steps without a last time.
pub fn steps(run: &mut dyn Stepper, count: usize) -> Result<(), Failure> {
    (0..count).try_for_each(|_| run.advance(f64::INFINITY).map(|_| ()).map_err(failed))
}

/// Component `k` of the state (0 the depth, then the momenta), x fastest.
pub fn component(run: &dyn Stepper, k: usize) -> Vec<f64> {
    run.component(k).rows().flatten().copied().collect()
}

/// All depths, x fastest.
pub fn depths(run: &dyn Stepper) -> Vec<f64> {
    component(run, 0)
}

/// Relative error of the ledger: volume now and gone, against the volume at the start.
pub fn lost(run: &dyn Stepper, before: f64) -> f64 {
    (run.totals().volume + run.outflow().iter().sum::<f64>() - before) / before
}

/// Square cells with one kind of boundary all round.
pub fn grid<const D: usize>(cells: [usize; D], origin: [f64; D], size: f64, ends: Boundary) -> Grid<D> {
    Grid { cells, origin, size: [size; D], boundary: [[ends; 2]; D] }
}

/// An interval cut into cells.
pub fn line([from, to]: [f64; 2], cells: usize, ends: Boundary) -> Grid<1> {
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

/// The grounds of a grid over `bed`, which answers `None` outside the data; slopes are rounded as a grid keeps them.
pub fn terrain<const D: usize>(
    grid: &Grid<D>,
    bed: impl Fn([f64; D]) -> Option<Surface<D>>,
) -> Vec<Terrain<D, f64>> {
    let at = |centre| {
        bed(centre).map_or(Terrain::nothing(GRAVITY), |Surface { z, slope, bent }| {
            let slope = slope.map(|s| f64::from(s as f32));
            let cos = 1.0 / (1.0 + slope.iter().map(|s| s * s).sum::<f64>()).sqrt();
            Terrain {
                level: z,
                slope,
                cos,
                curvature: bent.map(|row| row.map(|b| cos * b)),
                gravity: GRAVITY,
                pressure: GRAVITY,
            }
        })
    };
    (0..grid.count()).map(|number| at(grid.centre(grid.index(number)))).collect()
}
