//! Cell updates per second of the schemes, all wet: `speed [FILTER] [CELLS PER AXIS] [STEPS] [THREADS] [scalar|narrow]`.
//!
//! The initial state is a cap of 0.2 on a layer of 0.02 that spreads slowly: everything moves, nothing is dry.

use granflow::grid::Grid;
use granflow::hadeler_kuttler::scheme::{ADAPTIVE, FIRST_ORDER, HadelerKuttler, SECOND_ORDER};
use granflow::hadeler_kuttler::{self, Pile};
use granflow::raster::Raster;
use granflow::savage_hutter::Flow;
use granflow::savage_hutter::balanced::Balanced;
use granflow::savage_hutter::friction::Coulomb;
use granflow::savage_hutter::ground::{self, Chute};
use granflow::savage_hutter::kinetic::{Kinetic, VERFAHREN_1, VERFAHREN_5};
use granflow::scheme::{Boundary, Scheme};
use granflow::simulation::{Instructions, Simulation, StepSize};
use granflow::terrain::{Curvature, Terrain};
use granflow::time::{EULER, SSP_RK2};
use std::time::Instant;

const FRICTION: Coulomb = Coulomb { mu: 0.47 };

fn grid<const D: usize>(n: usize, boundary: Boundary) -> Grid<D> {
    Grid { cells: [n; D], origin: [-0.5; D], size: [1.0 / n as f64; D], boundary: [[boundary; 2]; D] }
}

fn plane<const D: usize>() -> Chute<D, f64> {
    let mut tilt = [0.0; D];
    tilt[0] = 0.3;
    Chute { tilt, beta: 0.9, cos: 0.954, curvature: 0.0 }
}

fn cap<const D: usize>(x: [f64; D]) -> Flow<D, f64> {
    let square: f64 = x.iter().map(|x| x * x).sum();
    let h = 0.02 + 0.2 * (1.0 - square / 0.09).max(0.0);
    Flow { h, q: x.map(|x| h * 0.2 * x) }
}

/// Seconds that the threads of this process have been computing, where the system tells; other work on the machine
/// does not enter.
fn computing() -> Option<f64> {
    let mut sum = 0.0;
    for task in std::fs::read_dir("/proc/self/task").ok()? {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        sum += text.split(' ').next()?.parse::<f64>().ok()? * 1e-9;
    }
    Some(sum)
}

struct Speed {
    filter: String,
    n: usize,
    steps: usize,
    threads: usize,
    instructions: Instructions,
}

impl Speed {
    fn measure<const D: usize, S: Scheme<D, f64>>(
        &self,
        name: &str,
        build: impl Fn() -> Simulation<D, S> + Sync,
    ) {
        if !name.contains(&self.filter) {
            return;
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads).build().expect("threads");
        let mut speeds = pool.install(|| {
            let mut run = build();
            run.use_instructions(self.instructions);
            let mut speeds = Vec::new();
            for repeat in 0..4 {
                let (clock, spent, before) = (Instant::now(), computing(), run.updates());
                for _ in 0..self.steps {
                    run.advance(f64::INFINITY).expect("finite");
                }
                if repeat > 0 {
                    let cells = (run.updates() - before) as f64 / 1e6;
                    let computed = computing().zip(spent).map_or(f64::NAN, |(now, then)| now - then);
                    speeds.push([cells / computed, cells / clock.elapsed().as_secs_f64()]);
                }
            }
            speeds
        });
        speeds.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let [computed, wall] = speeds[1];
        println!(
            "{name:20} {} cells an axis, {} threads: {wall:6.1} Mcups, {computed:6.1} a second of one thread",
            self.n, self.threads
        );
    }
}

fn main() {
    let mut words = std::env::args().skip(1);
    let filter = words.next().unwrap_or_default();
    let mut number = |default: usize| words.next().and_then(|word| word.parse().ok()).unwrap_or(default);
    let (n, steps, threads) = (number(1000), number(10), number(1));
    let instructions = match words.next().as_deref() {
        Some("scalar") => Instructions::Scalar,
        Some("narrow") => Instructions::Narrow,
        _ => Instructions::Widest,
    };
    let speed = Speed { filter, n, steps, threads, instructions };
    let n = speed.n;
    let open = |scheme, stages, courant| {
        let sheet = grid::<2>(n, Boundary::Open);
        let start = move |index| cap(sheet.centre(index));
        Simulation::new(scheme, sheet, stages, StepSize::Courant(courant), |_| plane::<2>(), start)
    };
    speed.measure("balanced flat", || open(Balanced::first(FRICTION, 1e-9), EULER, 0.4));
    speed.measure("balanced_2 flat", || open(Balanced::second(FRICTION, 1e-9), SSP_RK2, 0.4));
    for (name, published) in [("verfahren_1", VERFAHREN_1), ("verfahren_5", VERFAHREN_5)] {
        speed.measure(name, || {
            let sheet = grid::<2>(n, Boundary::Open);
            let scheme = Kinetic { friction: FRICTION, ..published };
            let start = move |index| cap(sheet.centre(index));
            Simulation::new(scheme, sheet, EULER, StepSize::Courant(0.4), |_| plane::<2>(), start)
        });
    }
    for (name, second) in [("balanced terrain", false), ("balanced_2 terrain", true)] {
        speed.measure(name, || {
            let sheet = grid::<2>(n, Boundary::Nothing);
            let (height, cell) =
                (|x: f64, y: f64| 0.3 * x + 0.02 * (9.0 * x).sin() * (7.0 * y).cos(), 1.0 / n as f64);
            let centre = |k: usize| (k as f64 + 0.5) * cell - 0.5;
            let values = (0..n * n).map(|k| height(centre(k % n), centre(k / n))).collect();
            let bed = Raster { columns: n, rows: n, west: -0.5, south: -0.5, cell, values, crs: None };
            let grounds = ground::Terrain::cells(&Terrain::new(bed, Curvature::Length(3.0 * cell)), 1.0);
            let start = move |index| cap(sheet.centre(index));
            let (scheme, stages) = match second {
                false => (Balanced::first(FRICTION, 1e-9), EULER),
                true => (Balanced::second(FRICTION, 1e-9), SSP_RK2),
            };
            Simulation::new(scheme, sheet, stages, StepSize::Courant(0.4), |[i, j]| grounds[j * n + i], start)
        });
    }
    speed.measure("balanced 1-D", || {
        let line = grid::<1>(100_000, Boundary::Open);
        let start = move |index| cap(line.centre(index));
        Simulation::new(
            Balanced::first(FRICTION, 1e-9),
            line,
            EULER,
            StepSize::Courant(0.4),
            |_| plane::<1>(),
            start,
        )
    });
    let table = |scheme: HadelerKuttler, stages| {
        let sheet = grid::<2>(n, Boundary::Nothing);
        let last = n - 1;
        let ground = move |[i, j]: [usize; 2]| {
            let inside = if i < last && j < last { 1.0 } else { 0.0 };
            let free = i > 0 && j > 0 && i < last && j < last;
            let weight = if free { 1.0 } else { 0.0 };
            let source = [0.25 * inside; 2];
            hadeler_kuttler::Ground { source, bed: 0.0, inside, weight, wall: [0.0; 2], hole: 0.0 }
        };
        let start = move |[i, j]: [usize; 2]| {
            let from_edge = i.min(j).min(last - i.min(last)).min(last - j.min(last));
            Pile { u: 0.5 * from_edge as f64 / n as f64, v: 0.1 * ground([i, j]).inside }
        };
        Simulation::new(scheme, sheet, stages, StepSize::Courant(0.4), ground, start)
    };
    speed.measure("sandpile", || table(FIRST_ORDER, EULER));
    speed.measure("sandpile second", || table(SECOND_ORDER, SSP_RK2));
    speed.measure("sandpile adaptive", || table(ADAPTIVE, SSP_RK2));
}
