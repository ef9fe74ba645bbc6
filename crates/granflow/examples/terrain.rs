//! An avalanche on terrain from an array of elevations, and its deposit.
//!
//! `cargo run --release -p granflow --example terrain`

use granflow::build::{Avalanche, Grid};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A slope of 35 degrees that runs out on a plain, in cells of 5 m.
    let grid = Grid::rectangle([0.0, 200.0], [0.0, 500.0], [40, 100]);
    let height = |[_, y]: [f64; 2]| 0.7 * (y - 200.0_f64).max(0.0);
    let elevations = (0..grid.count()).map(|n| height(grid.centre(grid.index(n)))).collect();
    let cap = |[x, y]: [f64; 2]| 2.0 * (1.0 - (x - 100.0).hypot(y - 400.0) / 40.0).max(0.0);

    let mut run = Avalanche::on_terrain(grid, elevations, 15.0).mu(0.4).thickness(cap).start()?;
    let volume = run.totals().volume;
    let rests = run.to_rest(300.0)?;
    assert!(rests && run.stepper().speed() == 0.0, "it comes to rest");
    let left: f64 = run.stepper().outflow().iter().sum();
    assert!(((run.totals().volume + left) / volume - 1.0).abs() < 1e-12, "mass is kept");

    let deposit = run.field("thickness").expect("an avalanche has a thickness");
    let thickest = deposit.iter().fold(0.0, f64::max);
    println!("{volume:.0} m3 at rest after {:.1} s, up to {thickest:.2} m thick", run.time());
    Ok(())
}
