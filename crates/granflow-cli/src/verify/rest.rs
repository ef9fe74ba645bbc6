//! Rest and start (G), and the lake of the water limit (I): what should rest rests bit for bit, what should start starts.

use granflow::run::Stepper;
use granflow::savage_hutter::Flow;
use granflow::savage_hutter::ground::Chute;
use granflow::scheme::Boundary;

use super::benchmark::{Benchmark, Check, Finding, Piece, Size};
use super::scheme::{
    RESTING, Run, Scheme, Setting, Surface, component, failed, grid, line, on_bed, on_chute, steps, terrain,
};
use crate::failure::Failure;

mod piles;

use piles::{FILM, MU, SHAPES, Shape, chute_pile, curved_pile, hills, terrain_pile, winding};

/// The benchmarks of this file.
pub const BENCHMARKS: [Benchmark; 2] = [
    Benchmark {
        name: "G",
        title: "Rest and start",
        about: "Cones, roofs and hips, wet on dry or on a layer, turned through any angle, on planes of chutes and terrain at the yield \
                slope (a cone across the grid at 0.999 of it), on random hills, in a bowl and in a valley with a kink at 0.9 of it, beside \
                holes in the data; profiles on a winding chute. None may change by a bit in 10000 steps. With (1 + 10⁻⁶) times the yield \
                slope roofs must start, and cones; with energy_stable and energy_stable_2 a cone of a few cells at 1.05, because what \
                the grid does not resolve of its surface holds too.",
        pieces: |size| {
            RESTING.map(|scheme| Piece::new(scheme.name(), move || rest_and_start(scheme, size))).into()
        },
        curves: None,
        errors: None,
    },
    Benchmark {
        name: "I-lake",
        title: "Lake at rest with islands",
        about: "A level lake over random hills that stand out of it, without friction, with and without a hole in the data. It may not \
                change by a bit in 10000 steps.",
        pieces: |size| RESTING.map(|scheme| Piece::new(scheme.name(), move || lakes(scheme, size))).into(),
        curves: None,
        errors: None,
    },
];

const BITS: &str = "held exactly: rest is a state that a step gives back bit for bit";
const STARTS: &str = "the yield slope is exact: a millionth more than friction holds moves";

/// A little more than friction holds.
const BEYOND: f64 = 1.0 + 1e-6;
const STEPS: usize = 10_000;

/// Counts over many runs.
#[derive(Default)]
struct Count {
    runs: usize,
    /// Cells that changed in a pile that should rest, or 1 for a run that does not know that it is at rest.
    changed: usize,
    /// Piles that should start and do not.
    stay: usize,
    starts: usize,
}

impl Count {
    /// A pile that should not change in [`STEPS`] steps.
    fn rests(&mut self, run: Run) -> Result<(), Failure> {
        self.rests_awake(run, 10)
    }

    /// The same, with the whole grid computed in the first `awake` steps, though it sleeps.
    fn rests_awake(&mut self, mut run: Run, awake: usize) -> Result<(), Failure> {
        let state = |run: &dyn Stepper| -> Vec<Vec<f64>> {
            (0..run.components()).map(|k| component(run, k)).collect()
        };
        let before = state(&*run);
        if before[0].iter().filter(|h| **h > 0.0).count() < 10 {
            return Err(failed("a pile of fewer than ten cells shows nothing"));
        }
        for _ in 0..awake {
            run.wake_all();
            steps(&mut *run, 1)?;
        }
        steps(&mut *run, STEPS - awake)?;
        let pairs = state(&*run).into_iter().flatten().zip(before.into_iter().flatten());
        self.changed += pairs.filter(|(now, then)| now != then).count();
        self.changed += usize::from(!run.at_rest() || run.speed() != 0.0);
        self.runs += 1;
        Ok(())
    }

    /// A pile that should move in its first steps.
    fn starts(&mut self, mut run: Run) -> Result<(), Failure> {
        let mut moved = false;
        for _ in 0..3 {
            steps(&mut *run, 1)?;
            moved |= run.totals().moving > 0 && run.speed() > 0.0;
        }
        self.stay += usize::from(!moved);
        self.starts += 1;
        Ok(())
    }

    fn rest_check(&self, what: &str) -> Check {
        Check::error(format!("{what}: numbers changed in {} runs", self.runs), self.changed as f64, 0.0, BITS)
    }
}

fn rest_and_start(scheme: Scheme, size: Size) -> Result<Finding, Failure> {
    let (mut planes, mut curved, mut winding) = (Count::default(), Count::default(), Count::default());
    on_planes(scheme, &mut planes)?;
    on_curved_beds(scheme, if size == Size::Full { 4 } else { 2 }, &mut curved)?;
    on_winding_chutes(scheme, &mut winding)?;
    let stay = planes.stay as f64;
    let checks = vec![
        planes.rest_check("piles on planes"),
        curved.rest_check("piles on curved beds"),
        winding.rest_check("profiles on winding chutes"),
        Check::error(
            format!("piles of {} beyond the yield slope that stay", planes.starts),
            stay,
            0.0,
            STARTS,
        ),
    ];
    Ok(Finding { checks, ..Finding::default() })
}

/// The share of the yield slope at which a cone starts.
fn cone_starts(scheme: Scheme) -> f64 {
    if matches!(scheme, Scheme::EnergyStable | Scheme::EnergyStable2) { 1.05 } else { BEYOND }
}

fn on_planes(scheme: Scheme, count: &mut Count) -> Result<(), Failure> {
    // The metric of a plane that falls across the grid is rounded.
    let rest = |shape, fall: [f64; 2]| {
        if matches!(shape, Shape::Cone) && fall[0] * fall[1] != 0.0 { 0.999 } else { 1.0 }
    };
    for shape in SHAPES {
        for tilt in [[0.0, 0.0], [0.2, 0.0], [0.0, -0.25], [0.12, 0.18]] {
            for layer in [false, true] {
                count.rests(chute_pile(scheme, tilt, shape, rest(shape, tilt), layer)?)?;
            }
            if matches!(shape, Shape::Roof(_)) {
                count.starts(chute_pile(scheme, tilt, shape, BEYOND, false)?)?;
            }
        }
        for slope in [[0.0, 0.0], [-0.3_f32, 0.0], [0.0, 0.25], [0.3, -0.2]] {
            let slope = slope.map(f64::from);
            count.rests(terrain_pile(scheme, slope, shape, rest(shape, slope))?)?;
            let cone = matches!(shape, Shape::Cone);
            if !cone || slope == [0.0; 2] {
                let beyond = if cone { cone_starts(scheme) } else { BEYOND };
                count.starts(terrain_pile(scheme, slope, shape, beyond)?)?;
            }
        }
    }
    // Rest does not come from the sleeping.
    for shape in [Shape::Cone, Shape::Roof(30.0)] {
        count.rests_awake(chute_pile(scheme, [0.2, 0.0], shape, 1.0, false)?, 1000)?;
        count.rests_awake(terrain_pile(scheme, [0.3, -0.2], shape, 0.999)?, 1000)?;
    }
    count.starts(chute_pile(scheme, [0.0; 2], Shape::Cone, cone_starts(scheme), false)?)
}

fn on_curved_beds(scheme: Scheme, seeds: u64, count: &mut Count) -> Result<(), Failure> {
    let bowl = |[x, y]: [f64; 2]| Surface {
        z: 500.0 + 1e-3 * (x * x + y * y),
        slope: [2e-3 * x, 2e-3 * y],
        bent: [[2e-3, 0.0], [0.0, 2e-3]],
    };
    // A bed with a kink: a valley of two planes.
    let valley = |[x, y]: [f64; 2]| Surface {
        z: 500.0 + 0.3 * x.abs() + 0.1 * y,
        slope: [0.3 * x.signum(), 0.1],
        bent: [[0.0; 2]; 2],
    };
    for shape in SHAPES {
        for hole in [false, true] {
            for seed in 1..=seeds {
                count.rests(curved_pile(scheme, hills(seed), shape, hole)?)?;
            }
            count.rests(curved_pile(scheme, bowl, shape, hole)?)?;
            count.rests(curved_pile(scheme, valley, shape, hole)?)?;
        }
    }
    Ok(())
}

fn on_winding_chutes(scheme: Scheme, count: &mut Count) -> Result<(), Failure> {
    for share in [-0.9, -0.4, 0.0, 0.5, 0.9] {
        for dry in [false, true] {
            let grid = line([-6.0, 6.0], 240, Boundary::Open);
            let grounds = winding(&grid);
            // (sqrt(beta) h)_x sqrt(beta) = sin(zeta) + share mu cos(zeta), by the trapezium rule.
            let force = |g: &Chute<1, f64>| (g.tilt[0] + share * MU * g.cos) / g.beta.sqrt();
            let mut level = vec![0.0; grounds.len()];
            for i in 1..grounds.len() {
                level[i] = level[i - 1] + 0.5 * (force(&grounds[i - 1]) + force(&grounds[i])) * grid.size[0];
            }
            let lowest = level.iter().copied().fold(f64::INFINITY, f64::min);
            let mean = level.iter().sum::<f64>() / level.len() as f64;
            let base = if dry { mean } else { lowest - 0.2 };
            let profile: Vec<f64> =
                level.iter().zip(&grounds).map(|(y, g)| ((y - base) / g.beta.sqrt()).max(0.0)).collect();
            let start = |[x]: [f64; 1]| Flow::still(profile[((x + 6.0) / grid.size[0]) as usize]);
            count.rests(on_chute(Setting::coulomb(scheme, MU, FILM), grid, &grounds, start)?)?;
        }
    }
    Ok(())
}

fn lakes(scheme: Scheme, size: Size) -> Result<Finding, Failure> {
    let mut count = Count::default();
    for seed in 1..=if size == Size::Full { 8 } else { 4 } {
        for hole in [false, true] {
            let bed = hills(seed);
            let sheet = grid([60, 50], [-150.0, -125.0], 5.0, Boundary::Absorbing);
            let outside = |[x, y]: [f64; 2]| hole && (x - 60.0).hypot(y) < 20.0;
            let grounds = terrain(&sheet, |x| if outside(x) { None } else { Some(bed(x)) });
            count.rests(on_bed(Setting::coulomb(scheme, 0.0, FILM), sheet, &grounds, |x, ground| {
                let h = if ground.cos > 0.0 { (901.0 - bed(x).z) / ground.cos.powi(2) } else { 0.0 };
                Flow::still(h.max(0.0))
            })?)?;
        }
    }
    Ok(Finding { checks: vec![count.rest_check("lakes")], ..Finding::default() })
}
