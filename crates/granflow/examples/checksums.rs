//! The checksums of all fields and maps that a case ends with: two programs that print the same computed the same bits.
//!
//! `cargo run --release -p granflow --example checksums -- CASE.toml`; without a case it holds lanes against single cells.

use granflow::run::{checksums, drive};
use granflow::simulation::SimdLevel;
use granflow::{Case, Checked};

const SILO: &str = r#"
model = "savage_hutter"
grid = { x = { from = -6.0, to = 6.0, cells = 240 }, boundary = "open" }
material = { epsilon = 0.4, friction.coulomb = { mu = 0.325 } }
initial.thickness.steps = { at = [-1.0, 1.0], values = [0.3, 2.3, 0.3] }
scheme.name = "energy_stable"
time = { until = "rest", end = 100.0 }
"#;

/// Runs a case to its end and gives what it ended with, one line each.
fn ended(case: Checked, simd: SimdLevel) -> Result<Vec<String>, Box<dyn std::error::Error>> {
    let ends = case.plan().ends;
    let mut run = case.start()?;
    run.stepper_mut().use_simd(simd);
    let reason = drive(&mut *run, &ends, &mut [])?;
    let mut lines =
        vec![format!("stopped {reason:?}"), format!("steps {}", run.steps()), format!("time {}", run.time())];
    lines.extend(checksums(&mut *run).into_iter().map(|(name, sum)| format!("{name} {sum:016x}")));
    eprintln!("stepping {:.3} s", run.record().stepping.as_secs_f64());
    Ok(lines)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let Some(file) = std::env::args().nth(1) else {
        let silo = |simd| ended(Case::parse(SILO, "silo")?.check()?, simd);
        let lines = silo(SimdLevel::Best)?;
        assert_eq!(lines, silo(SimdLevel::Scalar)?, "lanes and single cells give the same bits");
        println!("{}", lines.join("\n"));
        return Ok(());
    };
    println!("{}", ended(Case::read(file)?.check()?, SimdLevel::Best)?.join("\n"));
    Ok(())
}
