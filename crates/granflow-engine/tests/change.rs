//! States that are given from outside between two steps.

use granflow_engine::grid::Grid;
use granflow_engine::simulation::{Simulation, StepSize};
use granflow_model::savage_hutter::Flow;
use granflow_model::savage_hutter::energy_stable::EnergyStable;
use granflow_model::savage_hutter::friction::{Coulomb, Law};
use granflow_model::savage_hutter::ground::Chute;
use granflow_model::scheme::Boundary;

type Run = Simulation<2, EnergyStable<Law, Chute<2, f64>>>;

/// A dry table of 300 x 70 cells.
fn table() -> Run {
    let grid =
        Grid { cells: [300, 70], origin: [0.0; 2], size: [0.1; 2], boundary: [[Boundary::Open; 2]; 2] };
    let ground = Chute { tilt: [0.0; 2], beta: 1.0, cos: 1.0, curvature: 0.0 };
    let scheme = EnergyStable::first(Law::Coulomb(Coulomb { mu: 0.4 }), 1e-9);
    Simulation::new(scheme, grid, StepSize::Courant(0.9), |_| ground, |_| Flow::still(0.0)).unwrap()
}

/// A heap of 5 x 5 cells around a cell.
fn heap([x, y]: [usize; 2]) -> impl Iterator<Item = ([usize; 2], Flow<2, f64>)> {
    (0..25).map(move |k| ([x + k % 5 - 2, y + k / 5 - 2], Flow::still(1.0)))
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
    early.change(heap([150, 35]));
    assert!((early.poured() - 0.25).abs() < 1e-15, "{}", early.poured());
    to_rest(&mut early);
    let volume = early.totals().volume;
    assert!((volume - 0.25).abs() < 1e-13, "{volume}");

    // The same far away, in tiles that have slept for long.
    early.change(heap([40, 12]));
    assert!(!early.at_rest());
    to_rest(&mut early);
    assert!((early.poured() - 0.5).abs() < 1e-15 && (early.totals().volume - 0.5).abs() < 1e-13);
    for j in 0..24 {
        for i in 0..80 {
            let (first, second) = (early.state([150 + i - 40, 35 + j - 12]), early.state([i, j]));
            assert!((first.h - second.h).abs() < 1e-12, "{i}, {j}: {first:?} and {second:?}");
        }
    }
}

#[test]
fn nothing_new_wakes_nothing() {
    let mut run = table();
    run.change(heap([150, 35]));
    to_rest(&mut run);
    let (step, states) = (run.step(), run.collect(|cell| cell.state));
    let same: Vec<_> = (0..300).map(|i| ([i, 35], run.state([i, 35]))).collect();
    run.change(same);
    assert!(run.at_rest() && run.step() == step && run.collect(|cell| cell.state) == states);
    assert!((run.poured() - 0.25).abs() < 1e-15);
}
