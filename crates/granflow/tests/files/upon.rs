//! What a finished run left is where a next one begins: on a mountain, on a chute, and where it cannot be.

use super::*;
use std::cell::Cell;

/// A run that came to rest, and runs upon what it left.
struct Deposit {
    folder: tempfile::TempDir,
    case: PathBuf,
    /// Key of the case that names what lies there, and what stands around a value of it.
    key: [&'static str; 2],
    volume: f64,
    depths: Vec<f64>,
    runs: Cell<usize>,
}

impl Deposit {
    fn of(make: impl FnOnce(&Path) -> PathBuf, key: [&'static str; 2]) -> Deposit {
        let folder = tempfile::tempdir().unwrap();
        let case = make(folder.path());
        let first = begin(&with(&case, &[]), &folder.path().join("out"), false, &mut |_| false).unwrap();
        let (volume, depths) = (first.summary.mass_final, first.map("deposit").unwrap().to_vec());
        drop(first.close().unwrap());
        Deposit { folder, case, key, volume, depths, runs: Cell::new(0) }
    }

    /// A run that begins with this, in a folder of its own.
    fn next(&self, start: &str, changes: &[&str]) -> Finished {
        self.runs.set(self.runs.get() + 1);
        let start = format!("{}{start}{}", self.key[0], self.key[1]);
        let changes: Vec<&str> = [start.as_str()].iter().chain(changes).copied().collect();
        let out = self.folder.path().join(format!("next{}", self.runs.get()));
        begin(&with(&self.case, &changes), &out, false, &mut |_| false).unwrap()
    }
}

/// What a run left lies on the mountain of the next one, with its volume, and stays where it held.
#[test]
fn a_deposit_is_a_release_of_a_next_run() {
    let left = Deposit::of(file, ["release=[", "]"]);
    let volume = left.volume;
    let next = |release: &str, changes: &[&str]| left.next(release, changes);
    for named in [r#"{ result = "out" }"#, r#"{ result = "out/result.nc" }"#] {
        let same = next(named, &[]);
        let share = same.summary.mass_initial / volume - 1.0;
        assert!(share.abs() < 1e-14, "{share:e}");
        assert_eq!(same.summary.stop_reason, StopReason::AtRest);
        let now = same.map("deposit").unwrap();
        let moved = now.iter().zip(&left.depths).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(moved < 1e-12, "{moved}");
    }
    // Cells of another size have the same volume.
    let coarse = next(r#"{ result = "out" }"#, &["terrain.cell=10"]);
    assert!((coarse.summary.mass_initial / volume - 1.0).abs() < 1e-12);
    // A second avalanche runs upon it.
    let cap = "{ cap = { height = 2.0, centre = [1075.0, 2230.0], radius = 25.0 } }";
    let both = next(&format!(r#"{{ result = "out" }}, {cap}"#), &[]);
    let alone = next(cap, &[]);
    assert!((both.summary.mass_initial - volume - alone.summary.mass_initial).abs() < 1e-9 * volume);
    assert!(both.summary.max_speed > 1.0 && both.summary.mass_error.abs() < 1e-13);
}

#[test]
fn a_result_that_is_no_mountain_is_no_release() {
    let folder = tempfile::tempdir().unwrap();
    let slope = chute(folder.path(), None);
    begin(&with(&slope, &[]), &folder.path().join("out"), false, &mut |_| false).unwrap();
    let case = file(folder.path());
    let refused = |release: &str| match with(&case, &[release]).check() {
        Ok(checked) => checked.start().err().unwrap().to_string(),
        Err(error) => error.to_string(),
    };
    let message = refused(r#"release=[{ result = "out" }]"#);
    assert!(
        message.contains("no result of an avalanche on a terrain") && message.contains("result.nc"),
        "{message}"
    );
    let message = refused(r#"release=[{ result = "none" }]"#);
    assert!(message.contains("result.nc"), "{message}");
    let message = refused(r#"release=[{ result = "out", measured = "vertical" }]"#);
    assert!(message.contains("no meaning for a result"), "{message}");
}

/// A pile that slumps on a chute and rests, along x or in the plane.
fn chute(folder: &Path, cells_across: Option<usize>) -> PathBuf {
    let across = cells_across
        .map_or(String::new(), |cells| format!("grid.y = {{ from = -2.0, to = 2.0, cells = {cells} }}\n"));
    let text = format!(
        "grid.x = {{ from = -6.0, to = 6.0, cells = 60 }}\n{across}material.friction.coulomb = {{ angle = \"18 deg\" }}\n\
         initial.thickness.cap = {{ height = 1.0, radius = 1.5 }}\ntime.until = \"rest\"\noutput.files = [\"netcdf\"]\n"
    );
    super::case(&text, folder);
    folder.join("case.toml")
}

/// What a run on a chute left lies under the layer of the next one.
#[test]
fn a_deposit_on_a_chute_is_the_start_of_a_next_run() {
    for across in [None, Some(20)] {
        let left = Deposit::of(|folder| chute(folder, across), ["initial=", ""]);
        let volume = left.volume;
        let next = |initial: &str, changes: &[&str]| left.next(initial, changes);
        for named in [r#"{ result = "out" }"#, r#"{ result = "out/result.nc" }"#] {
            let same = next(named, &[]);
            // The same cells, added up once and not step by step.
            assert!((same.summary.mass_initial / volume - 1.0).abs() <= 1e-14);
            // One step shows that nothing moves.
            assert_eq!((same.summary.stop_reason, same.summary.steps), (StopReason::AtRest, 1));
            let now = same.map("deposit").unwrap();
            assert!(now.iter().zip(&left.depths).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
        // Cells of another size, and a longer chute, have the same volume.
        for grid in
            [["grid.x.cells=24", "time.steps=1"], ["grid.x={from=-7.3,to=9.1,cells=57}", "time.steps=1"]]
        {
            let other = next(r#"{ result = "out" }"#, &grid).summary.mass_initial;
            assert!((other / volume - 1.0).abs() < 1e-13, "{other} {volume}");
        }
        // What is scaled by another epsilon is said.
        let thinner = with(&left.case, &[r#"initial={ result = "out" }"#, "material.epsilon=0.5"]);
        let said = thinner.check().unwrap().describe().unwrap();
        assert!(said.iter().any(|(kind, text)| *kind == "warning" && text.contains("epsilon = 1,")));
        // A second layer runs over it, and it alone has the speed.
        let layer = "thickness = { cap = { height = 0.5, centre = -3.0, radius = 1.0 } }, velocity_x = 2.0";
        let alone = next(&format!("{{ {layer} }}"), &["time.steps=1"]).summary.mass_initial;
        let both = next(&format!("{{ result = \"out\", {layer} }}"), &[]).summary;
        assert!((both.mass_initial - volume - alone).abs() < 1e-12 && both.mass_error.abs() < 1e-13);
        assert!(both.max_speed > 1.0 && both.stop_reason == StopReason::AtRest);
    }
}

#[test]
fn what_cannot_be_the_start_of_a_run_on_a_chute_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let case = chute(folder.path(), None);
    drop(
        begin(&with(&case, &[]), &folder.path().join("out"), false, &mut |_| false).unwrap().close().unwrap(),
    );
    let refused = |changes: &[&str]| match with(&case, changes).check() {
        Ok(checked) => checked.start().err().unwrap().to_string(),
        Err(error) => error.to_string(),
    };
    let left = r#"initial={ result = "out" }"#;
    let narrow = refused(&[left, "grid.x={from=-0.5,to=0.5,cells=10}"]);
    assert!(narrow.contains("% of what lay on it lies beyond the grid"), "{narrow}");
    let plane = refused(&[left, "grid.y={from=-1,to=1,cells=10}"]);
    assert!(plane.contains("it has 1 dimensions, this case 2"), "{plane}");
    let nothing = refused(&[r#"initial={ result = "none" }"#]);
    assert!(nothing.contains("initial.result") && nothing.contains("result.nc"), "{nothing}");
    let still = refused(&[r#"initial={ result = "out", velocity_x = 1.0 }"#]);
    assert!(still.contains("initial.velocity_x") && still.contains("at rest"), "{still}");
    let neither = refused(&["initial={ velocity_x = 1.0 }"]);
    assert!(neither.contains("`thickness` is missing") && neither.contains("initial.result"), "{neither}");

    let mountain = tempfile::tempdir().unwrap();
    let changes = ["time.end=0.1"];
    let on =
        begin(&with(&file(mountain.path()), &changes), &mountain.path().join("out"), false, &mut |_| false);
    drop(on.unwrap().close().unwrap());
    let named = format!("initial={{ result = {:?} }}", mountain.path().join("out"));
    let terrain = refused(&[&named]);
    assert!(terrain.contains("no result of an avalanche on a chute"), "{terrain}");
}
