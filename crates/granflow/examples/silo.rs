//! A silo breaks: a column of sand on a level plane collapses and comes to rest. Prints its profile at four instants.
//!
//! `cargo run --release -p granflow --example silo`

use granflow::build::{Avalanche, Grid};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let column = |[x]: [f64; 1]| if x.abs() < 1.0 { 2.3 } else { 0.3 };
    let floor = Grid::line([-6.0, 6.0], 240);
    let mut run = Avalanche::on_plane(floor, 0.0)
        .scaled(0.4)
        .mu(18_f64.to_radians().tan())
        .thickness(column)
        .start()?;
    let volume = run.totals().volume;
    for time in [0.0, 0.5, 1.0, 2.0] {
        run.until(time)?;
        let thickness = run.field("thickness").expect("an avalanche has a thickness");
        let bar = |h: f64| char::from_digit((3.0 * h) as u32, 10).unwrap_or('#');
        println!("t = {time}  {}", thickness.iter().step_by(4).map(bar).collect::<String>());
    }
    assert!(run.to_rest(100.0)?, "it comes to rest");
    assert_eq!(run.stepper().speed(), 0.0, "exactly");
    assert!((run.totals().volume / volume - 1.0).abs() < 1e-13, "mass is kept");
    println!("at rest after {} steps, time {:.3}", run.steps(), run.time());
    Ok(())
}
