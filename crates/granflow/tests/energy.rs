//! The energy of the scheme `energy_stable` never grows, whatever the bed, the depth and the law.

mod support;
#[path = "support/energy_stable.rs"]
mod tried;

use granflow::grid::Grid;
use granflow::kernels::Kernel;
use granflow::savage_hutter::Flow;
use granflow::savage_hutter::energy_stable::EnergyStable;
use granflow::savage_hutter::friction::{
    CellByCell, Cohesion, Coulomb, HerschelBulkley, Law, MuI, PouliquenForterre, Quadratic, SamosAt, Voellmy,
};
use granflow::savage_hutter::ground::{Chute, Terrain};
use granflow::scheme::Boundary;
use granflow::simulation::{Simulation, StepSize};
use support::mountain::{Mountain, Roughness, energy};
use support::{Dice, GRAVITY, alone, grid, plane};

type Run = Simulation<2, EnergyStable<Law, Terrain<2, f64>>>;

fn laws(dice: &mut Dice) -> Law {
    let mu = [0.0, dice.between(0.0, 0.3), dice.between(0.3, 0.6)][(dice.roll() * 2.999) as usize];
    match (dice.roll() * 8.0) as usize {
        0 => Law::Voellmy(Voellmy { mu, xi: dice.between(200.0, 3000.0), gravity: GRAVITY }),
        1 => Law::Cohesion(Cohesion { mu, bond: dice.between(0.0, 5.0) }),
        2 => Law::SamosAt(SamosAt { mu, bond: 0.0, rs0: 0.222, kappa: 0.43, r: 0.05, b: 4.13 }),
        3 => {
            let granular = [mu, mu + dice.between(0.05, 0.4), mu + dice.between(0.0, 0.1)];
            let law = PouliquenForterre { mu: granular, length: 0.1, beta: 0.136, gamma: 1e-3 };
            CellByCell::PouliquenForterre(law).into()
        }
        4 => {
            let law = MuI { mu1: mu, mu2: mu + 0.3, i0: 0.3, grain: dice.between(1e-3, 0.1), phi: 0.6 };
            CellByCell::MuI(law).into()
        }
        5 => {
            let (bond, consistency, n) =
                (dice.between(0.0, 2.0), dice.between(0.0, 0.2), dice.between(0.3, 2.0));
            CellByCell::HerschelBulkley(HerschelBulkley { bond, consistency, n }).into()
        }
        6 => {
            let (bond, viscosity, manning) =
                (dice.between(0.0, 2.0), dice.between(0.0, 0.2), dice.between(0.0, 0.1));
            CellByCell::Quadratic(Quadratic { bond, viscosity, k: 24.0, manning, gravity: GRAVITY }).into()
        }
        _ => Law::Coulomb(Coulomb { mu }),
    }
}

/// Both orders in turn.
fn of_order<B>(seed: u64, law: Law) -> EnergyStable<Law, B> {
    if seed.is_multiple_of(2) { EnergyStable::first(law, 1e-6) } else { EnergyStable::second(law, 1e-6) }
}

/// A run on a random mountain with a random release, moving or at rest.
fn random(seed: u64) -> (Mountain, Run) {
    let mut dice = Dice(seed ^ 0x5eed);
    let dx = dice.between(0.5, 10.0);
    let rough = Roughness {
        height: dice.between(0.0, 3.0) * dx,
        cliff: if dice.roll() < 0.5 { 0.0 } else { dice.between(1.0, 11.0) * dx },
        pits: dice.between(0.0, 3.0) * dx,
        holes: if dice.roll() < 0.5 { 0.0 } else { dice.between(0.0, 0.1) },
    };
    let cells = [28, 22];
    let mountain = Mountain::random(seed, cells, dx, rough);
    let depth = 10.0_f64.powf(dice.between(-6.0, 1.5));
    let speed = if dice.roll() < 0.5 { 0.0 } else { dice.between(0.0, 20.0) };
    let direction = dice.between(0.0, 6.3);
    let flow = speed * direction.cos();
    let across = speed * direction.sin();
    let wet: Vec<f64> = (0..cells[0] * cells[1])
        .map(|number| {
            let (i, j) = (number % cells[0], number / cells[0]);
            let spot = (i as f64 - 9.0).powi(2) + (j as f64 - 11.0).powi(2) < 40.0;
            if spot { depth * dice.between(0.2, 1.0) } else { 0.0 }
        })
        .collect();
    let sheet: Grid<2> = grid(cells, [0.0; 2], dx, Boundary::Absorbing);
    let run = Simulation::new(
        of_order(seed, laws(&mut dice)),
        sheet,
        StepSize::Courant(0.9),
        |index| mountain.ground(index),
        |[i, j]| {
            let h =
                if mountain.level(i as isize, j as isize).is_some() { wet[j * cells[0] + i] } else { 0.0 };
            Flow { h, q: [h * flow, h * across] }
        },
    );
    (mountain, run.unwrap())
}

#[test]
fn the_energy_falls_while_anything_moves_on_random_mountains() {
    let worst = alone(|| {
        let mut worst = f64::NEG_INFINITY;
        for seed in 0..1000 {
            let (mountain, mut run) = random(seed);
            if run.rate() == 0.0 {
                continue; // all of it lies on holes
            }
            let lowest = mountain.lowest();
            let mut before: f64 = energy(&run, lowest).iter().sum();
            let range = before;
            for step in 0..80 {
                run.advance(f64::INFINITY).unwrap();
                let [kinetic, potential] = energy(&run, lowest);
                let now = kinetic + potential;
                // It falls by a millionth of the kinetic energy at least.
                let growth = (now + 1e-6 * kinetic - before) / range;
                if growth > 1e-12 {
                    println!("mountain {seed}, step {step}, {:?}: grows by {growth:e}", run.scheme());
                }
                worst = worst.max(growth);
                before = now;
                if run.at_rest() || run.rate() == 0.0 {
                    break;
                }
            }
            let lost = (run.totals().volume + run.out().iter().sum::<f64>()) / volume(&mountain, seed) - 1.0;
            assert!(lost.abs() < 1e-13, "mountain {seed} lost {lost:e} of its mass");
            assert!(run.collect(|cell| cell.state.h).iter().all(|h| *h >= 0.0), "mountain {seed}");
        }
        worst
    });
    assert!(worst <= 1e-12, "{worst:e}");
}

fn volume(_: &Mountain, seed: u64) -> f64 {
    random(seed).1.totals().volume
}

/// Random layers on a chute between walls; the energy counts the fall from x = 0.
fn on_chutes<const D: usize>(cells: [usize; D], seeds: u64)
where
    EnergyStable<Law, Chute<D, f64>>: Kernel<D, State = Flow<D, f64>, Ground = Chute<D, f64>, Forcing = ()>,
{
    for seed in 0..seeds {
        let mut dice = Dice(seed ^ 0xc4073);
        let tilt: [f64; D] = std::array::from_fn(|_| dice.between(-0.6, 0.6));
        let ground = plane(tilt, dice.between(0.1, 1.0));
        let scheme = of_order(seed, laws(&mut dice));
        let deep = 10.0_f64.powf(dice.between(-3.0, 0.5));
        let sheet = grid(cells, [0.0; D], dice.between(0.02, 0.5), Boundary::Wall);
        let start = |index: [usize; D]| {
            let mut dice = Dice(index.iter().fold(seed, |key, i| key * 1009 + *i as u64));
            let h = if dice.roll() < 0.3 { 0.0 } else { deep * dice.roll() };
            Flow { h, q: std::array::from_fn(|_| h * dice.between(-2.0, 2.0)) }
        };
        let mut run = Simulation::new(scheme, sheet, StepSize::Courant(0.9), |_| ground, start).unwrap();
        let energy = |run: &Simulation<D, _>| {
            let cells = run.collect(|cell| cell.state);
            let parts = cells.iter().enumerate().map(|(number, Flow { h, q })| {
                let x = sheet.centre(sheet.index(number));
                let fall: f64 = (0..D).map(|k| tilt[k] * x[k]).sum();
                let kinetic = if *h > 0.0 { q.iter().map(|q| q * q).sum::<f64>() / (2.0 * h) } else { 0.0 };
                [kinetic, ground.beta * h * h / 2.0 - h * fall]
            });
            let parts: Vec<[f64; 2]> = parts.collect();
            [0, 1].map(|which| granflow::run::sum(parts.iter().map(|part| part[which])))
        };
        let mut before: f64 = energy(&run).iter().sum();
        // What there is to lose is of the size of the mass times the fall over the chute.
        let fall: f64 = (0..D).map(|k| tilt[k].abs() * sheet.size[k] * sheet.cells[k] as f64).sum();
        let range = before.abs() + run.totals().volume / sheet.measure() * (fall + ground.beta * deep);
        for step in 0..120 {
            run.advance(f64::INFINITY).unwrap();
            let [kinetic, potential] = energy(&run);
            let now = kinetic + potential;
            let growth = (now + 1e-6 * kinetic - before) / range;
            assert!(growth <= 1e-12, "chute {seed}, D = {D}, step {step}: {growth:e}");
            before = now;
        }
    }
}

#[test]
fn the_energy_falls_while_anything_moves_on_random_chutes() {
    alone(|| {
        on_chutes([60], 200);
        on_chutes([24, 18], 120);
    });
}
