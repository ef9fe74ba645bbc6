//! Lanes change what a step costs, not one bit of what it gives.

mod support;
#[path = "support/balanced.rs"]
mod tried;

use granflow::grid::Grid;
use granflow::hadeler_kuttler::scheme::{ADAPTIVE, FIRST_ORDER, HadelerKuttler, SECOND_ORDER, Slopes};
use granflow::hadeler_kuttler::{Ground, Pile, Source};
use granflow::kernels::Kernel;
use granflow::savage_hutter::Flow;
use granflow::savage_hutter::balanced::Balanced;
use granflow::savage_hutter::energy_stable::EnergyStable;
use granflow::savage_hutter::friction::{AnyLaw, Cohesion, Coulomb, Law, SamosAt, Voellmy};
use granflow::savage_hutter::kinetic::{VERFAHREN_1, VERFAHREN_2, VERFAHREN_3, VERFAHREN_4, VERFAHREN_5};
use granflow::scheme::{Boundary, Components};
use granflow::simulation::{SimdLevel, Simulation, StepSize};
use support::{Dice, Surface, alone, grid, plane, terrain};

/// Every number that a run shows, as bits.
fn bits<const D: usize, S: Kernel<D>>(run: &Simulation<D, S>) -> Vec<u64> {
    let mut numbers = Vec::new();
    for cell in run.collect(|cell| cell.state) {
        cell.store(|_, value| numbers.push(value));
    }
    let totals = run.totals();
    numbers.extend([totals.volume, totals.film, totals.speed, totals.energy, run.rate()]);
    numbers.extend([totals.wet, totals.moving].map(|count| count as f64));
    numbers.extend(run.out());
    numbers.extend(run.drift());
    for (_, map) in run.maps().expect("kept from the start").named() {
        numbers.extend(map.iter().copied().map(f64::from));
    }
    numbers.iter().map(|number| number.to_bits()).collect()
}

/// Some of the cells are thicker and others not, in one vector and in the course of a run.
const THRESHOLD: f64 = 0.6;

/// Take steps with each kind of instructions and compare after each few.
fn compare<const D: usize, S: Kernel<D>>(name: &str, build: impl Fn() -> Simulation<D, S> + Sync) {
    alone(|| {
        let mut scalar = build();
        let mut narrow = build();
        let mut widest = build();
        narrow.use_simd(SimdLevel::Avx2);
        widest.use_simd(SimdLevel::Best);
        scalar.use_simd(SimdLevel::Scalar);
        for step in 0..12 {
            for run in [&mut scalar, &mut narrow, &mut widest] {
                if step == 0 {
                    run.keep_maps(THRESHOLD);
                }
                for _ in 0..3 {
                    run.advance(f64::INFINITY).expect("finite");
                }
            }
            let expected = bits(&scalar);
            assert!(expected == bits(&narrow), "{name}, D = {D}: narrow lanes, step {step}");
            assert!(expected == bits(&widest), "{name}, D = {D}: widest lanes, step {step}");
        }
        assert!(scalar.time() > 0.0);
    });
}

/// Wet and dry, moving and still, thick and thinner than a film; a dry half for tiles to sleep in.
fn rough<const D: usize>(
    seed: u64,
    cells: [usize; D],
    positive: bool,
) -> impl Fn([usize; D]) -> Flow<D, f64> {
    move |index| {
        let mut dice = Dice(seed);
        for i in index {
            dice = Dice((dice.roll() * 1e15) as u64 + i as u64);
        }
        let h = dice.between(0.5, 1.5);
        let fastest = if positive { 1.5 } else { 0.3 };
        let u: [f64; D] = std::array::from_fn(|_| dice.between(-fastest, fastest));
        let lot = (dice.roll() * 210.0) as usize;
        match lot {
            _ if positive && index[0] > cells[0] / 2 => Flow::still(0.0),
            _ if positive && lot.is_multiple_of(7) => {
                Flow::still(if lot.is_multiple_of(2) { 0.0 } else { 1e-7 })
            }
            _ if lot.is_multiple_of(5) => Flow::still(h),
            _ => Flow { h, q: u.map(|u| h * u) },
        }
    }
}

fn on_planes<const D: usize>(cells: [usize; D], ends: Boundary) {
    let sheet = grid(cells, [0.0; D], 0.05, ends);
    let tilt = std::array::from_fn(|k| [0.21, -0.13][k]);
    let run = |scheme, step| {
        Simulation::new(scheme, sheet, step, |_| plane::<D>(tilt, 0.4), rough(3, cells, true)).unwrap()
    };
    let friction = Coulomb { mu: 0.3 };
    compare("balanced", || run(Balanced::first(Law::Coulomb(friction), 1e-6), StepSize::Courant(0.9)));
    let law = Law::Coulomb(friction);
    for (name, scheme) in [
        ("energy_stable", EnergyStable::first(law, 1e-6)),
        ("energy_stable_2", EnergyStable::second(law, 1e-6)),
    ] {
        compare(name, || {
            let start = rough(3, cells, true);
            Simulation::new(scheme, sheet, StepSize::Courant(0.7), |_| plane::<D>(tilt, 0.4), start).unwrap()
        });
    }
    compare("balanced_2", || run(Balanced::second(Law::Coulomb(friction), 1e-6), StepSize::Courant(0.45)));
    let published = [VERFAHREN_1, VERFAHREN_2, VERFAHREN_3, VERFAHREN_4, VERFAHREN_5];
    for (number, scheme) in published.into_iter().enumerate() {
        compare(&format!("verfahren_{}", number + 1), || {
            let scheme = scheme.with(friction);
            // A bed that varies, so that no tile takes the ground of its first cell for all.
            let ground = |index: [usize; D]| {
                plane::<D>(tilt.map(|s: f64| s + 1e-3 * index[0] as f64 / cells[0] as f64), 0.4)
            };
            Simulation::new(scheme, sheet, StepSize::Fixed(0.002), ground, rough(4, cells, false)).unwrap()
        });
    }
}

#[test]
fn lanes_are_the_scalar_on_planes() {
    on_planes([1], Boundary::Open);
    on_planes([63], Boundary::Wall);
    on_planes([1201], Boundary::Periodic);
    on_planes([67, 21], Boundary::Wall);
    on_planes([130, 9], Boundary::Open);
    on_planes([9, 40], Boundary::Periodic);
    // Rectangles of tiles, several rows high.
    on_planes([66, 260], Boundary::Open);
}

fn of_order<F, B>(second: bool, law: F, film: f64) -> EnergyStable<F, B> {
    if second { EnergyStable::second(law, film) } else { EnergyStable::first(law, film) }
}

/// Take steps with two schemes that are to be one.
fn same<const D: usize, S: Kernel<D>, T: Kernel<D>>(
    name: &str,
    mut one: Simulation<D, S>,
    mut other: Simulation<D, T>,
) {
    one.keep_maps(THRESHOLD);
    other.keep_maps(THRESHOLD);
    for step in 0..36 {
        one.advance(f64::INFINITY).expect("finite");
        other.advance(f64::INFINITY).expect("finite");
        assert!(bits(&one) == bits(&other), "{name}: step {step}");
    }
}

/// On waves of these wave numbers \[1/m\] along x and y.
fn on_terrain(name: &str, friction: Law, film: f64, [a, b]: [f64; 2]) {
    let sheet: Grid<2> = grid([101, 43], [0.0; 2], 5.0, Boundary::Absorbing);
    let grounds = terrain(&sheet, |[x, y]| {
        let outside = (x - 300.0).hypot(y - 90.0) < 22.0 || x + y < 60.0;
        (!outside).then(|| {
            let (s, c) = ((a * x).sin(), (b * y).cos());
            Surface {
                z: 30.0 * s * c - 0.3 * x,
                slope: [30.0 * a * (a * x).cos() * c - 0.3, -30.0 * s * b * (b * y).sin()],
                bent: [
                    [-30.0 * a * a * s * c, -30.0 * a * b * (a * x).cos() * (b * y).sin()],
                    [-30.0 * a * b * (a * x).cos() * (b * y).sin(), -30.0 * b * b * s * c],
                ],
            }
        })
    });
    let start = rough(5, sheet.cells, true);
    let number = |[i, j]: [usize; 2]| j * sheet.cells[0] + i;
    let begin =
        |index: [usize; 2]| if grounds[number(index)].cos > 0.0 { start(index) } else { Flow::still(0.0) };
    for second in [false, true] {
        compare(name, || {
            let (scheme, step) = match second {
                false => (Balanced::first(friction, film), StepSize::Courant(0.9)),
                true => (Balanced::second(friction, film), StepSize::Courant(0.45)),
            };
            Simulation::new(scheme, sheet, step, |index| grounds[number(index)], begin).unwrap()
        });
    }
    let ground = |index| grounds[number(index)];
    for second in [false, true] {
        let scheme = of_order(second, friction, film);
        let build = || Simulation::new(scheme, sheet, StepSize::Courant(0.7), ground, begin).unwrap();
        compare(name, build);
        let scheme = of_order(second, AnyLaw::from(friction), film);
        let own = Simulation::new(scheme, sheet, StepSize::Courant(0.7), ground, begin).unwrap();
        same(&format!("{name}, cell by cell"), build(), own);
    }
}

#[test]
fn lanes_are_the_scalar_on_terrain() {
    let (hills, ridges) = ([0.02, 0.03], [0.1, 0.15]);
    // With the thicker film many cells are dry and no thinner than their neighbours.
    for film in [1e-6, 0.7] {
        on_terrain("coulomb", Law::Coulomb(Coulomb { mu: 0.4 }), film, hills);
        on_terrain("voellmy", Law::Voellmy(Voellmy { mu: 0.2, xi: 1500.0, gravity: 9.81 }), film, hills);
        let samos = SamosAt { mu: 0.155, bond: 0.1, rs0: 0.222, kappa: 0.43, r: 0.05, b: 4.13 };
        on_terrain("samosat", Law::SamosAt(samos), film, hills);
        // Cells are held between moving ones, in planes far from each other.
        on_terrain("cohesion", Law::Cohesion(Cohesion { mu: 0.3, bond: 20.0 }), film, ridges);
    }
}

/// On a bed of waves this high.
fn on_tables<const D: usize>(cells: [usize; D], waves: f64) {
    let table = grid(cells, [0.0; D], 0.02, Boundary::Absorbing);
    // A hole, a wall, a source on one side; where the bed is even, a hole so large that tiles lie in it.
    let wide = if waves == 0.0 { [34, 40] } else { [1, 1] };
    let ground = |index: [usize; D]| {
        let last: [usize; D] = cells.map(|n| n - 1);
        let beside = (0..D).any(|k| index[k] == last[k]);
        let hole = D > 1 && (0..D).all(|k| (5 + k..5 + k + wide[k]).contains(&index[k]));
        let inside = f64::from(u8::from(!beside && !hole));
        let free = (0..D).all(|k| index[k] > 0 && index[k] < last[k]) && !hole;
        Ground {
            bed: waves * (0.7 * index[0] as f64).sin(),
            inside,
            weight: f64::from(u8::from(free)),
            wall: std::array::from_fn(|k| if k == 0 && index[0] == 0 { 1.0 } else { 0.0 }),
            hole: f64::from(u8::from(hole)),
        }
    };
    let start = |index: [usize; D]| {
        let mut dice = Dice(1 + index.iter().fold(7, |sum, i| sum * 31 + *i as u64));
        let ground = ground(index);
        let (u, v) = (0.004 * dice.roll(), 0.2 * dice.roll());
        Pile { u: u * ground.weight, v: if dice.roll() < 0.3 { 0.0 } else { v * ground.inside } }
    };
    let third = HadelerKuttler { slopes: Slopes::Adaptive { exponent: 3.0 } };
    for (name, scheme) in [
        ("first order", FIRST_ORDER),
        ("second order", SECOND_ORDER),
        ("adaptive", ADAPTIVE),
        ("adaptive, 3", third),
    ] {
        compare(name, || {
            let mut run = Simulation::new(scheme, table, StepSize::Courant(0.4), ground, start).unwrap();
            run.apply(|index, _| Source {
                split: std::array::from_fn(|k| {
                    ground(index).inside * if index[0] < cells[0] / 2 { 0.3 + 0.1 * k as f64 } else { 0.0 }
                }),
            });
            run
        });
    }
}

#[test]
fn lanes_are_the_scalar_on_tables() {
    on_tables([40], 0.01);
    on_tables([1100], 0.01);
    on_tables([71, 35], 0.01);
    // Tiles on even ground have loops of their own.
    on_tables([1100], 0.0);
    on_tables([150, 90], 0.0);
}
