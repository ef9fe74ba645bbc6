//! What a step costs: nanoseconds of a thread for each cell, and the ratio to `balanced`. `cargo bench -p granflow --bench
//! schemes` prints a table; medians of rounds that are taken in turn, so that other work on the machine falls on all
//! alike. On grids that fit the second-level cache: formulas are compared here, the memory by `granflow bench`.

use granflow::models::setups;
use granflow::speed::{Extent, Load, median};
use std::time::Instant;

/// Cells along each axis.
const CELLS: usize = 180;
const ROUNDS: usize = 9;

/// Nanoseconds for each cell of a step.
fn cost(load: &mut dyn Load) -> f64 {
    load.restart().expect("a sound step");
    let (clock, steps) = (Instant::now(), load.steps_left());
    for _ in 0..steps {
        load.step().expect("a sound step");
    }
    clock.elapsed().as_nanos() as f64 / (steps * load.cells()) as f64
}

fn main() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    pool.install(|| {
        let planes = || setups().filter(|setup| setup.dimensions == 2);
        let mut loads: Vec<_> =
            planes().map(|setup| setup.start(Extent { cells: CELLS, wet: 1.0 })).collect();
        let rounds: Vec<Vec<f64>> =
            (0..ROUNDS).map(|_| loads.iter_mut().map(|load| cost(load.as_mut())).collect()).collect();
        println!("{CELLS} x {CELLS} cells, one thread\n{:18} {:>8}  of balanced", "scheme", "ns/cell");
        let costs = (0..loads.len()).map(|k| median(rounds.iter().map(|round| round[k])));
        let costs: Vec<f64> = costs.collect();
        for (setup, cost) in planes().zip(&costs) {
            println!("{:18} {cost:8.1} {:12.2}", setup.name, cost / costs[0]);
        }
    });
}
