//! The law of the energy, with volume and positivity, on random mountains and chutes.

use granflow::grid::Grid;
use granflow::kernels::Kernel;
use granflow::savage_hutter::Flow;
use granflow::savage_hutter::energy_stable::EnergyStable;
use granflow::savage_hutter::friction::{
    AnyLaw, Cohesion, Coulomb, HerschelBulkley, Law, LocalFriction, MuI, Parameters, PouliquenForterre,
    Quadratic, SamosAt, Voellmy,
};
use granflow::savage_hutter::ground::{Chute, Terrain};
use granflow::scheme::Boundary;
use granflow::simulation::{Simulation, StepSize};

use super::benchmark::{Benchmark, Check, Finding, Piece, Size};
use super::dice::Dice;
use super::mountain::{Mountain, Roughness, energy};
use super::scheme::{GRAVITY, failed, grid, plane};
use crate::failure::Failure;

type Run<F> = Simulation<2, EnergyStable<F, Terrain<2, f64>>>;

/// The benchmark of this file.
pub const BENCHMARK: Benchmark = Benchmark {
    name: "energy",
    title: "The law of the energy",
    about: "Random layers under a random law of all there are, moving or at rest, on random mountains with \
            cliffs, pits and holes in the data, and on random chutes between walls, in one and two dimensions. In every step kinetic \
            and potential energy together fall by a millionth of the kinetic energy at least; no volume is lost, no depth is \
            negative. Proved in docs/rest.md.",
    pieces: |size| {
        let orders = [(false, "energy_stable"), (true, "energy_stable_2")];
        let work = |(second, name)| Piece::new(name, move || by(second, size));
        orders.map(work).into()
    },
    curves: None,
    errors: None,
};

const REASON: &str = "the law is a theorem: rounding, as a share of the energy there is to lose";

/// What the runs of one order came to at worst.
#[derive(Default)]
struct Worst {
    /// Growth of the energy in a step, as a share of what there is.
    growth: f64,
    /// Relative error of the ledger.
    lost: f64,
    /// Cells of negative depth.
    negative: usize,
}

impl Worst {
    fn grew(&mut self, growth: f64) {
        // `max` would forget what is not a number.
        if growth.is_nan() || growth > self.growth {
            self.growth = growth;
        }
    }
}

fn by(second: bool, size: Size) -> Result<Finding, Failure> {
    let (mountains, chutes) = if size == Size::Full { (1000, 200) } else { (500, 100) };
    let (mut on_mountains, mut on_chutes) = (Worst::default(), Worst::default());
    (0..mountains).try_for_each(|seed| mountain(seed, second, &mut on_mountains))?;
    (0..chutes).try_for_each(|seed| chute([60], seed, second, &mut on_chutes))?;
    (0..chutes * 3 / 5).try_for_each(|seed| chute([24, 18], seed, second, &mut on_chutes))?;
    let energy = |where_: &str, growth| {
        Check::error(format!("{where_}: largest growth of the energy in a step"), growth, 1e-12, REASON)
    };
    let checks = vec![
        energy(&format!("{mountains} mountains"), on_mountains.growth),
        energy(&format!("{} chutes", chutes + chutes * 3 / 5), on_chutes.growth),
        Check::error(
            format!("{mountains} mountains: largest relative error of the volume, outflow included"),
            on_mountains.lost,
            1e-13,
            "what leaves a cell enters another or the ledger: rounding",
        ),
        Check::error(
            "cells of negative depth",
            on_mountains.negative as f64,
            0.0,
            "no cell gives more than it holds",
        ),
    ];
    Ok(Finding { checks, ..Finding::default() })
}

fn laws(dice: &mut Dice) -> AnyLaw {
    let mu = [0.0, dice.between(0.0, 0.3), dice.between(0.3, 0.6)][(dice.roll() * 2.999) as usize];
    match (dice.roll() * 8.0) as usize {
        0 => AnyLaw::Voellmy(Voellmy { mu, xi: dice.between(200.0, 3000.0), gravity: GRAVITY }),
        1 => AnyLaw::Cohesion(Cohesion { mu, bond: dice.between(0.0, 5.0) }),
        2 => AnyLaw::SamosAt(SamosAt { mu, bond: 0.0, rs0: 0.222, kappa: 0.43, r: 0.05, b: 4.13 }),
        3 => {
            let granular = [mu, mu + dice.between(0.05, 0.4), mu + dice.between(0.0, 0.1)];
            let law = PouliquenForterre { mu: granular, length: 0.1, beta: 0.136, gamma: 1e-3 };
            AnyLaw::PouliquenForterre(law)
        }
        4 => {
            let law = MuI { mu1: mu, mu2: mu + 0.3, i0: 0.3, grain: dice.between(1e-3, 0.1), phi: 0.6 };
            AnyLaw::MuI(law)
        }
        5 => {
            let (bond, consistency) = (dice.between(0.0, 2.0), dice.between(0.0, 0.2));
            let n = dice.between(0.2, 4.0);
            AnyLaw::HerschelBulkley(HerschelBulkley { bond, consistency, n })
        }
        6 => {
            let (bond, viscosity) = (dice.between(0.0, 2.0), dice.between(0.0, 0.2));
            let manning = dice.between(0.0, 0.1);
            let law = Quadratic { bond, viscosity, k: 24.0, manning, gravity: GRAVITY };
            AnyLaw::Quadratic(law)
        }
        _ => AnyLaw::Coulomb(Coulomb { mu }),
    }
}

/// The law as the loops of all schemes have it, for half of those that they have.
fn in_loops(law: AnyLaw, seed: u64) -> Option<Law> {
    law.in_loops().filter(|_| seed.is_multiple_of(2))
}

/// Parameters of a law in a cell: its first one, mu or the bond, from a third of the usual one up to it.
fn elsewhere(parameters: Parameters<f64>, dice: &mut Dice) -> Parameters<f64> {
    parameters.with(0, parameters.get(0) * dice.between(1.0 / 3.0, 1.0))
}

/// The scheme of first or second order.
fn of_order<F, B>(second: bool, law: F) -> EnergyStable<F, B> {
    if second { EnergyStable::second(law, 1e-6) } else { EnergyStable::first(law, 1e-6) }
}

/// A run on a random mountain with a random release, moving or at rest.
fn random<F: LocalFriction>(seed: u64, second: bool, law: F) -> Result<(Mountain, Run<F>), Failure>
where
    EnergyStable<F, Terrain<2, f64>>: Kernel<2, State = Flow<2, f64>, Ground = Terrain<2, f64>>,
{
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
        of_order(second, law),
        sheet,
        StepSize::Courant(0.9),
        |index| mountain.ground(index),
        |[i, j]| {
            let h =
                if mountain.level(i as isize, j as isize).is_some() { wet[j * cells[0] + i] } else { 0.0 };
            Flow { h, q: [h * flow, h * across] }
        },
    );
    Ok((mountain, run.map_err(failed)?))
}

/// 80 steps on a mountain, under one law or with other parameters in each cell.
fn mountain(seed: u64, second: bool, worst: &mut Worst) -> Result<(), Failure> {
    let mut dice = Dice(seed ^ 0x1a3);
    let law = laws(&mut dice);
    if let Some(law) = in_loops(law, seed) {
        let (mountain, run) = random(seed, second, law)?;
        return slide(&mountain, run, worst);
    }
    let (mountain, mut run) = random(seed, second, law)?;
    if dice.roll() < 0.7 {
        run.apply(|[i, j], own| elsewhere(own, &mut Dice(seed ^ (1009 * i + j) as u64)));
    }
    slide(&mountain, run, worst)
}

fn slide<F: LocalFriction>(mountain: &Mountain, mut run: Run<F>, worst: &mut Worst) -> Result<(), Failure>
where
    EnergyStable<F, Terrain<2, f64>>: Kernel<2, State = Flow<2, f64>, Ground = Terrain<2, f64>>,
{
    if run.rate() == 0.0 {
        return Ok(()); // all of it lies on holes
    }
    let (lowest, volume) = (mountain.lowest(), run.totals().volume);
    let mut before: f64 = energy(&run, lowest).iter().sum();
    let range = before;
    for _ in 0..80 {
        run.advance(f64::INFINITY).map_err(failed)?;
        let [kinetic, potential] = energy(&run, lowest);
        let now = kinetic + potential;
        worst.grew((now + 1e-6 * kinetic - before) / range);
        before = now;
        if run.at_rest() || run.rate() == 0.0 {
            break;
        }
    }
    let lost = (run.totals().volume + run.out().iter().sum::<f64>()) / volume - 1.0;
    worst.lost = worst.lost.max(lost.abs());
    worst.negative += run.collect(|cell| cell.state.h).iter().filter(|h| h.is_nan() || **h < 0.0).count();
    Ok(())
}

/// Random layers on a chute between walls, under one law or another.
fn chute<const D: usize>(cells: [usize; D], seed: u64, second: bool, worst: &mut Worst) -> Result<(), Failure>
where
    EnergyStable<Law, Chute<D, f64>>: Kernel<D, State = Flow<D, f64>, Ground = Chute<D, f64>>,
    EnergyStable<AnyLaw, Chute<D, f64>>: Kernel<D, State = Flow<D, f64>, Ground = Chute<D, f64>>,
{
    let law = laws(&mut Dice(seed ^ 0x1a3));
    match in_loops(law, seed) {
        Some(law) => chute_under(law, cells, seed, second, worst),
        None => chute_under(law, cells, seed, second, worst),
    }
}

/// The energy counts the fall from x = 0.
fn chute_under<F: LocalFriction, const D: usize>(
    law: F,
    cells: [usize; D],
    seed: u64,
    second: bool,
    worst: &mut Worst,
) -> Result<(), Failure>
where
    EnergyStable<F, Chute<D, f64>>: Kernel<D, State = Flow<D, f64>, Ground = Chute<D, f64>>,
{
    let mut dice = Dice(seed ^ 0xc4073);
    let tilt: [f64; D] = std::array::from_fn(|_| dice.between(-0.6, 0.6));
    let ground = plane(tilt, dice.between(0.1, 1.0));
    let scheme = of_order(second, law);
    let deep = 10.0_f64.powf(dice.between(-3.0, 0.5));
    let sheet = grid(cells, [0.0; D], dice.between(0.02, 0.5), Boundary::Wall);
    let start = |index: [usize; D]| {
        let mut dice = Dice(index.iter().fold(seed, |key, i| key * 1009 + *i as u64));
        let h = if dice.roll() < 0.3 { 0.0 } else { deep * dice.roll() };
        Flow { h, q: std::array::from_fn(|_| h * dice.between(-2.0, 2.0)) }
    };
    let mut run =
        Simulation::new(scheme, sheet, StepSize::Courant(0.9), |_| ground, start).map_err(failed)?;
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
    for _ in 0..120 {
        run.advance(f64::INFINITY).map_err(failed)?;
        let [kinetic, potential] = energy(&run);
        let now = kinetic + potential;
        worst.grew((now + 1e-6 * kinetic - before) / range);
        before = now;
    }
    Ok(())
}
