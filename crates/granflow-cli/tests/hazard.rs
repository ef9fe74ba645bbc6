//! The cases for hazards: each is checked, runs to rest as it is made, and says that it is not calibrated.

use std::path::Path;
use std::process::{Command, Output};

fn granflow(folder: &Path, arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_granflow");
    Command::new(program).args(arguments).current_dir(folder).output().expect("the program runs")
}

fn runs_to_rest(kind: &str, [least, most]: [f64; 2]) {
    let folder = tempfile::tempdir().expect("a folder");
    let made = granflow(folder.path(), &["new", kind]);
    let told = String::from_utf8_lossy(&made.stderr).into_owned();
    assert!(made.status.success() && told.contains("not calibrated"), "{told}");
    let case = format!("{kind}.toml");
    let text = std::fs::read_to_string(folder.path().join(&case)).expect("the case");
    assert!(
        text.contains("# NOT CALIBRATED") && text.contains("title = ") && text.contains("(not calibrated)")
    );
    assert!(granflow(folder.path(), &["check", &case]).status.success());
    let run = granflow(folder.path(), &["run", &case, "-q", "--set", r#"output.files=["netcdf"]"#]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let summary = std::fs::read_to_string(folder.path().join(kind).join("summary.json")).expect("a summary");
    let summary: serde_json::Value = serde_json::from_str(&summary).expect("it is JSON");
    let number = |key: &str| summary[key].as_f64().expect("a number");
    assert!(["trickle", "at_rest"].contains(&summary["stop_reason"].as_str().expect("a word")), "{summary}");
    assert!(number("mass_error").abs() < 1e-12 && number("mass_out") == 0.0, "{summary}");
    assert!((least..most).contains(&number("runout")), "{summary}");
}

#[test]
fn a_snow_avalanche_runs_to_rest() {
    runs_to_rest("snow_avalanche", [1100.0, 1300.0]);
}

#[test]
fn a_debris_flow_runs_to_rest() {
    runs_to_rest("debris_flow", [600.0, 720.0]);
}

#[test]
fn a_rock_avalanche_runs_to_rest() {
    runs_to_rest("rock_avalanche", [1550.0, 1800.0]);
}
