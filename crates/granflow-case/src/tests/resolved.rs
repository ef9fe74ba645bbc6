//! The resolved case computes the same as the case with its overrides.

use crate::*;
use std::fs;
use std::path::{Path, PathBuf};

/// Every file is there.
struct Everywhere;

impl FileAccess for Everywhere {
    fn kinds(&self) -> &'static [FileKind] {
        super::Disk.kinds()
    }

    fn outlines(&self, path: &Path) -> Result<Box<dyn Outline>, String> {
        Err(format!("{} holds no polygon", path.display()))
    }
    fn find(&self, _path: &Path) -> std::io::Result<()> {
        Ok(())
    }
}

/// Everything that was evaluated, but for the text it came from.
fn values(case: &Case) -> String {
    let checked = case.check(&Everywhere);
    let Checked { run, kind } = checked.unwrap_or_else(|error| panic!("{error}\n{}", case.text()));
    let RunPlan { title, model, scheme, stepping, max_courant, ends, output, notes, .. } = run;
    let run = (title, model, scheme, stepping, max_courant, ends, output, notes);
    // the debug format of a float is exact
    format!("{run:?} {kind:?}")
}

fn cases() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases");
    let mut files: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|end| end == "toml"));
    files.sort();
    assert!(files.len() >= 17);
    files
}

/// Reads what `resolved` says again.
fn again(path: &Path, overrides: &[&str]) -> Case {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    let case = Case::read_with(path, &overrides).unwrap_or_else(|error| panic!("{error}"));
    let resolved = case.resolved();
    let again = Case::parse(&resolved, &path.display().to_string());
    let again = again.unwrap_or_else(|error| panic!("{overrides:?}: {error}\n{resolved}"));
    assert_eq!(values(&case), values(&again), "{overrides:?}\n{resolved}");
    assert_eq!(case.to_toml(), again.to_toml());
    assert_eq!(again.resolved(), resolved, "what is resolved stays");
    case
}

#[test]
fn every_case_as_it_is_and_with_overrides() {
    for path in cases() {
        let case = again(&path, &[]);
        assert_eq!(case.resolved(), case.text(), "without overrides it is the text");
        let case = again(&path, &["title=Again", "output={steps=7,precision=\"f32\"}", "time.steps=3"]);
        assert!(case.resolved().contains("title = \"Again\"") && !case.resolved().contains("--set"));
    }
}

#[test]
fn numbers_angles_lists_and_replaced_tables() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases");
    let silo = folder.join("silo.toml");
    for changes in [
        &["grid.x.cells=0x1_F", "grid.x.from=-1_6", "scheme.step=1e-300"] as &[&str],
        &["time.end=12345678901234567890", "output={steps=9}"],
        &["material.slope=5.1 deg"],
        &["material.slope=pi/10 rad", "material.friction={coulomb={mu=0.30000000000000004}}"],
        &["material.slope={x=[-1,0.1],angle=[\"5 deg\",0.1],curvature=\"x\"}", "scheme.name=balanced"],
        &["initial.thickness={steps={at=[-1,0.5],values=[0.3,2.3,1]}}", "initial.thickness.steps.at.1=0.25"],
        &["initial.thickness={formula=\"where(x < 0, 1, 0.1)\"}", "initial.velocity_x=-0.0"],
        &["grid.y={from=0,to=1,cells=4}", "grid.boundary={x=[\"wall\",\"open\"],y=\"periodic\"}"],
        &["title=\"quotes \\\" and \\n lines \u{e9}\""],
    ] {
        again(&silo, changes);
    }
    let square = folder.join("sandpile_source.toml");
    again(&square, &["source=[{rate=1,on.box=[0.2,0.4]},{rate.formula=\"t\",to=2}]", "source.1.to=3"]);
    again(
        &square,
        &["table={open=[\"left\",\"hole\"],cut=[{box=[0.4,0.6,0.4,0.6]}]}", "table.cut.0.box.0=0.5"],
    );
    let mountain = folder.join("avalanche.toml");
    again(
        &mountain,
        &["release.0.thickness=1.25", "terrain.curvature=off", "material.friction={samosat={}}"],
    );
}
