//! `granflow bench` as a user meets it, on grids too small to say anything of the machine.

mod support;

use serde_json::Value;
use std::path::Path;
use std::process::Output;
use std::time::Instant;
use support::{granflow, said, told};

fn bench(folder: &Path, arguments: &[&str]) -> Output {
    granflow(folder, &[&["bench"], arguments].concat())
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn every_scheme_has_its_row_on_every_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let sizes = ["--quick", "--cells", "64", "--threads", "1", "--threads", "2", "--json", "deep/speed.json"];
    let output = bench(folder.path(), &sizes);
    let text = said(&output);
    assert!(output.status.success(), "{}", told(&output));
    let found: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("deep/speed.json")).unwrap()).unwrap();
    assert_eq!([&found["complete"], &found["quick"]], [true; 2]);
    let rows = found["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 28);
    let bandwidth = |threads: &Value| {
        let all = found["triad"]["measured"].as_array().unwrap();
        number(&all.iter().find(|one| one["threads"] == *threads).unwrap()["bytes_per_second"])
    };
    for row in rows {
        let (name, mcups) = (row["scheme"].as_str().unwrap(), number(&row["mcups"]));
        // The table shows what the file holds.
        let columns: Vec<&str> = text
            .lines()
            .map(|line| line.split_whitespace().collect::<Vec<_>>())
            .find(|words| {
                let threads = if name == "balanced_1d" { 2 } else { 4 };
                words.first() == Some(&name)
                    && words.get(threads) == Some(&row["threads"].to_string().as_str())
            })
            .unwrap_or_else(|| panic!("{name} in {text}"));
        assert!(columns.contains(&format!("{mcups:.1}").as_str()), "{mcups} in {columns:?}");
        // What is derived follows from what is measured.
        let repeats: Vec<f64> = row["repeats"].as_array().unwrap().iter().map(number).collect();
        let below = repeats.iter().filter(|repeat| **repeat < mcups).count();
        let above = repeats.iter().filter(|repeat| **repeat > mcups).count();
        assert!(repeats.len() == 3 && repeats.contains(&mcups) && below <= 1 && above <= 1, "{repeats:?}");
        assert!(mcups > 0.0);
        let ns = 1e3 * number(&row["threads"]) / mcups;
        assert!((number(&row["ns_per_cell"]) / ns - 1.0).abs() < 1e-12);
        let bytes = &row["bytes_per_cell"];
        let bytes = number(&bytes["read"]) + number(&bytes["written"]) + number(&bytes["allocated"]);
        let share = bytes * 1e6 * mcups / bandwidth(&row["threads"]);
        assert!((number(&row["share_of_triad"]) / share - 1.0).abs() < 1e-12);
    }
}

#[test]
fn what_ran_beside_is_compared_with() {
    let folder = tempfile::tempdir().unwrap();
    // Another speed the second time, and a line that is none.
    let command = "echo noise; if [ -e again ]; then echo threads=1 theirs 9x9 Mcups 30; \
                   else echo threads=1 theirs 9x9 Mcups 10; touch again; fi; echo threads=7 theirs 9x9 Mcups 70";
    let arguments =
        ["--quick", "--cells", "64", "--threads", "1", "--scheme", "balanced", "--json", "speed.json"];
    let output = bench(folder.path(), &[&arguments[..], &["--beside", command]].concat());
    assert!(output.status.success(), "{}", told(&output));
    let found: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("speed.json")).unwrap()).unwrap();
    let row = &found["rows"][0];
    let ratio = number(&row["mcups"]) / 20.0;
    assert!((number(&row["ratios"]["theirs 9x9"]) / ratio - 1.0).abs() < 1e-12, "{row}");
    assert_eq!(found["beside"].as_array().unwrap().len(), 4);
    let text = said(&output);
    let last = text.lines().last().unwrap();
    assert!(last.starts_with("balanced ") && last.ends_with(&format!("{ratio:.2}")), "{text}");
}

#[test]
fn what_is_wrong_is_said_before_work_starts() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file"), "").unwrap();
    let wrong: [(&[&str], i32, &[&str]); 12] = [
        (&["--scheme", "balancd"], 2, &["`balancd`", "did you mean `balanced`?", "adaptive"]),
        (&["--threads", "0"], 2, &["--threads"]),
        (&["--threads", "2000"], 2, &["2000 threads", "cores"]),
        (&["--cells", "4"], 2, &["4 cells", "8 and more"]),
        (&["--cells", "10000000"], 2, &["GB are free", "fewer --cells"]),
        (&["--wet", "0"], 2, &["share of 0", "up to 1"]),
        (&["--wet", "nan"], 2, &["share of NaN"]),
        (&["--scheme", "verfahren_5", "--wet", "0.5"], 2, &["verfahren_5 is not positive"]),
        (&["--instructions", "wide"], 2, &["`wide`", "widest, narrow, scalar"]),
        (&["--json", "file/speed.json"], 4, &["file/speed.json", "cannot write"]),
        (&["--beside", "exit 3"], 2, &["`exit 3` failed"]),
        (&["--beside", "echo nothing"], 2, &["printed no speed", "threads=2 name 2000x2000 Mcups"]),
    ];
    for (arguments, status, fragments) in wrong {
        let clock = Instant::now();
        let output = bench(folder.path(), arguments);
        let message = told(&output);
        assert_eq!(output.status.code(), Some(status), "{arguments:?}: {message}");
        assert!(fragments.iter().all(|part| message.contains(part)), "{arguments:?}: {message}");
        // A row takes longer than that.
        assert!(output.stdout.is_empty() && clock.elapsed().as_secs_f64() < 1.5, "{arguments:?}");
    }
}

#[test]
fn a_grid_in_part_dry_has_no_share_of_the_triad() {
    let folder = tempfile::tempdir().unwrap();
    let row = |wet: &str| {
        let sizes = ["--cells", "400", "--threads", "1", "--scheme", "balanced", "--json", "speed.json"];
        let output = bench(folder.path(), &[&["--quick", "--wet", wet], &sizes[..]].concat());
        assert!(output.status.success(), "{}", told(&output));
        let found = std::fs::read(folder.path().join("speed.json")).unwrap();
        let found: Value = serde_json::from_slice(&found).unwrap();
        found["rows"][0].clone()
    };
    for (wet, whole) in [("1", true), ("0.1", false)] {
        let row = row(wet);
        assert_eq!(row["share_of_triad"].is_null(), !whole, "{row}");
        assert!(number(&row["mcups"]) > 0.0, "{row}");
    }
}

#[test]
fn the_instructions_asked_for_are_taken() {
    let folder = tempfile::tempdir().unwrap();
    let arguments =
        ["--quick", "--cells", "64", "--threads", "1", "--scheme", "balanced", "--instructions", "scalar"];
    let text = said(&bench(folder.path(), &arguments));
    assert!(text.starts_with("instructions: scalar"), "{text}");
}
