//! What a moving source costs: a disc that pours while it goes over an empty table, with every tile awake after each of its moves
//! (as a change of the ground woke them), and with those alone that it touches. Both give the same bits.
//!
//! `cargo bench --bench moving_source [-- CELLS STEPS]`

use granflow::grid::Grid;
use granflow::hadeler_kuttler::Pile;
use granflow::hadeler_kuttler::scheme::{FIRST_ORDER, HadelerKuttler};
use granflow::hadeler_kuttler::table::Table;
use granflow::scheme::Boundary;
use granflow::simulation::{Simulation, StepSize};
use std::time::Instant;

/// A run of so many steps; the seconds of a step, the share of the cells that were computed, and the run.
fn go(table: &Table<2>, cells: usize, steps: usize, all: bool) -> (f64, f64, Simulation<2, HadelerKuttler>) {
    let size = 1.0 / cells as f64;
    let grid = Grid {
        cells: table.nodes(),
        origin: [0.0; 2],
        size: [size; 2],
        boundary: [[Boundary::Absorbing; 2]; 2],
    };
    let (ground, start) = (|index| table.ground(index, 0.0), |_| Pile { u: 0.0, v: 0.0 });
    let mut run = Simulation::new(FIRST_ORDER, grid, StepSize::Courant(0.45), ground, start)
        .expect("a step that the scheme takes");
    let clock = Instant::now();
    for step in 0..steps {
        let middle = [0.2 + 0.6 * step as f64 / steps as f64, 0.5];
        run.apply(|index, _| {
            let away: f64 = (0..2).map(|k| ((index[k] as f64 + 0.5) * size - middle[k]).powi(2)).sum();
            table.source(index, if away < 0.05 * 0.05 { [0.3, 0.2] } else { [0.0; 2] })
        });
        if all {
            run.wake_all();
        }
        run.advance(f64::INFINITY).expect("a state that is finite");
    }
    let share = run.updates() as f64 / (steps * run.grid().count()) as f64;
    (clock.elapsed().as_secs_f64() / steps as f64, share, run)
}

fn main() {
    let numbers: Vec<usize> = std::env::args().skip(1).filter_map(|word| word.parse().ok()).collect();
    let (cells, steps) = (numbers.first().copied().unwrap_or(1000), numbers.get(1).copied().unwrap_or(100));
    let table = Table::rectangle([cells; 2], [[true; 2]; 2]);
    let [all, some] = [true, false].map(|all| go(&table, cells, steps, all));
    assert_eq!(all.2.arrays().components(), some.2.arrays().components(), "the same bits");
    println!("{cells} x {cells} cells, {steps} steps, first_order   ms a step   cells computed");
    for (name, (seconds, share, _)) in [("every tile awake", &all), ("tiles it touches", &some)] {
        println!("{name:40} {:13.3} {:14.1} %", seconds * 1e3, share * 100.0);
    }
}
