//! States that are given from outside between two steps.

use granflow_engine::grid::Grid;
use granflow_engine::simulation::{Simulation, StepSize};
use granflow_model::savage_hutter::Flow;
use granflow_model::savage_hutter::energy_stable::EnergyStable;
use granflow_model::savage_hutter::friction::{Coulomb, Law};
use granflow_model::savage_hutter::ground::Chute;
use granflow_model::scheme::Boundary;

type Run = Simulation<2, EnergyStable<Law, Chute<2, f64>>>;

/// A dry table of 300 x 110 cells.
fn table() -> Run {
    let grid =
        Grid { cells: [300, 110], origin: [0.0; 2], size: [0.1; 2], boundary: [[Boundary::Open; 2]; 2] };
    let ground = Chute { tilt: [0.0; 2], beta: 1.0, cos: 1.0, curvature: 0.0 };
    let scheme = EnergyStable::first(Law::Coulomb(Coulomb { mu: 0.4 }), 1e-9);
    Simulation::new(scheme, grid, StepSize::Courant(0.9), |_| ground, |_| Flow::still(0.0)).unwrap()
}

/// A heap of 5 x 5 cells around a cell.
fn heap([x, y]: [usize; 2]) -> impl Iterator<Item = ([usize; 2], Flow<2, f64>)> {
    (0..25).map(move |k| ([x + k % 5 - 2, y + k / 5 - 2], Flow::still(0.4)))
}

fn to_rest(run: &mut Run) {
    for _ in 0..5000 {
        run.advance(f64::INFINITY).unwrap();
        if run.at_rest() {
            return;
        }
    }
    panic!("moves at {} m/s", run.speed());
}

#[test]
fn what_is_given_is_booked_wakes_its_surroundings_and_flows_as_from_the_start() {
    let mut early = table();
    early.change(heap([200, 55]));
    assert!((early.poured() - 0.1).abs() < 1e-15, "{}", early.poured());
    to_rest(&mut early);
    let volume = early.totals().volume;
    assert!((volume - 0.1).abs() < 1e-13, "{volume}");

    // The same far away, in tiles that have slept for long.
    early.change(heap([70, 55]));
    assert!(!early.at_rest());
    to_rest(&mut early);
    assert!((early.poured() - 0.2).abs() < 1e-15 && (early.totals().volume - 0.2).abs() < 1e-13);
    for j in 15..95 {
        for i in 20..120 {
            let (first, second) = (early.state([130 + i, j]), early.state([i, j]));
            assert!((first.h - second.h).abs() < 1e-12, "{i}, {j}: {first:?} and {second:?}");
        }
    }
}

#[test]
fn nothing_new_wakes_nothing() {
    let mut run = table();
    run.change(heap([200, 55]));
    to_rest(&mut run);
    let (step, states) = (run.step(), run.collect(|cell| cell.state));
    let same: Vec<_> = (0..300).map(|i| ([i, 55], run.state([i, 55]))).collect();
    run.change(same);
    assert!(run.at_rest() && run.step() == step && run.collect(|cell| cell.state) == states);
    assert!((run.poured() - 0.1).abs() < 1e-15);
}
