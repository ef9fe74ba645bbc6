//! Sand is poured on a square table whose edges are open, until as much falls as is poured.
//!
//! `cargo run --release -p granflow --example sandpile`

use granflow::build::{Sandpile, Table};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    const CELLS: usize = 20;
    let table = Table::rectangle([CELLS; 2], [[true; 2]; 2]);
    let mut run = Sandpile::on(table, [1.0 / CELLS as f64; 2]).source(|_| 0.5).start()?;
    while !run.is_steady(1e-6) {
        run.step(100.0)?;
        assert!(run.time() < 100.0, "it becomes steady");
    }
    let pile = run.field("standing_layer").expect("a pile has one");
    let top = pile.iter().fold(0.0, f64::max);
    println!("steady at time {:.3} after {} steps: {top:.4} high (exact 0.5)", run.time(), run.steps());
    assert!((top - 0.5).abs() < 1.0 / CELLS as f64, "the distance of the middle from the nearest edge");
    Ok(())
}
