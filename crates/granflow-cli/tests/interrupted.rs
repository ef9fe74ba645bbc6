//! Commands other than `run` that a signal, a limit or a full disk ends: what is complete stays, nothing half does.

#![cfg(unix)]

mod support;

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};
use support::{PROGRAM, granflow, said, shell, signal, told};

/// Starts a command and sends it a signal once `ready` is true.
fn interrupted(folder: &Path, words: &[&str], name: &str, ready: impl Fn() -> bool) -> Output {
    let mut command = Command::new(PROGRAM);
    command.current_dir(folder).args(words).stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().unwrap();
    let begun = Instant::now();
    while !ready() {
        assert!(begun.elapsed() < Duration::from_secs(60), "{words:?} does not begin");
        std::thread::sleep(Duration::from_millis(5));
    }
    signal(name, child.id());
    let sent = Instant::now();
    let output = child.wait_with_output().unwrap();
    assert!(sent.elapsed() < Duration::from_secs(30), "{words:?} goes on");
    output
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn a_signal_before_anything_is_complete_leaves_nothing_or_what_was_there() {
    let folder = tempfile::tempdir().unwrap();
    for (name, words) in [
        ("INT", &["verify", "energy", "--out", "out"][..]),
        ("TERM", &["reproduce", "sandpiles", "--out", "out"]),
        ("HUP", &["verify", "L", "M", "--out", "out"]),
    ] {
        let out = folder.path().join("out");
        let output = interrupted(folder.path(), words, name, || out.exists());
        assert_eq!(output.status.code(), Some(130), "{}", told(&output));
        let text = told(&output);
        assert!(text.contains("nothing was written; the same command starts again"), "{text}");
        assert!(!out.exists());

        fs::create_dir(&out).unwrap();
        fs::write(out.join("index.html"), "of an earlier one").unwrap();
        let begun = Instant::now();
        let later = || begun.elapsed() > Duration::from_millis(300);
        let output = interrupted(folder.path(), words, name, later);
        assert_eq!(output.status.code(), Some(130), "{}", told(&output));
        assert!(told(&output).contains("as it was"), "{}", told(&output));
        assert_eq!(names(&out), ["index.html"]);
        fs::remove_dir_all(&out).unwrap();
    }
}

#[test]
fn benchmarks_that_are_complete_stay_and_the_command_for_the_others_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let begun = Instant::now();
    // Ritter's dam break takes much less than that, the law of the energy much more.
    let later = || begun.elapsed() > Duration::from_secs(5);
    let output = interrupted(folder.path(), &["verify", "I-Ritter", "energy", "--out", "out"], "TERM", later);
    let text = told(&output);
    assert_eq!(output.status.code(), Some(130), "{text}");
    assert!(
        text.contains("1 of 2 benchmarks are complete") && text.contains("`granflow verify energy"),
        "{text}"
    );
    assert!(said(&output).contains("Ritter"));
    assert_eq!(names(&folder.path().join("out")), ["figures", "index.html", "tables.json"]);
    let page = fs::read_to_string(folder.path().join("out/index.html")).unwrap();
    assert!(page.contains("in part: without energy"));
}

#[test]
fn a_second_signal_ends_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let line = "$GRANFLOW bench --json b.json >out 2>err & p=$!; sleep 0.5; kill -TERM $p; kill -HUP $p; \
                sleep 0.2; kill -INT $p; wait $p; echo $?";
    let begun = Instant::now();
    let output = shell(folder.path(), line);
    assert_eq!(said(&output).trim(), "130", "{}", told(&output));
    assert!(begun.elapsed() < Duration::from_secs(3));
}

#[test]
fn a_bench_ends_with_the_rows_it_has_and_with_the_program_beside() {
    let folder = tempfile::tempdir().unwrap();
    let json = folder.path().join("b.json");
    let begun = folder.path().join("begun");
    let beside = "echo > begun; (sleep 2; echo late > late)";
    let words = ["bench", "--quick", "--json", "b.json", "--beside", beside];
    let output = interrupted(folder.path(), &words, "TERM", || begun.exists());
    assert_eq!(output.status.code(), Some(130), "{}", told(&output));
    assert!(told(&output).contains("0 rows are measured") && !json.exists(), "{}", told(&output));
    std::thread::sleep(Duration::from_millis(2500));
    assert!(!folder.path().join("late").exists(), "the program beside goes on");

    let words = ["bench", "--quick", "--json", "b.json", "--cells", "1000"];
    let row = || fs::read_to_string(&json).is_ok_and(|text| text.contains("mcups"));
    let output = interrupted(folder.path(), &words, "INT", row);
    assert_eq!(output.status.code(), Some(130), "{}", told(&output));
    let saved: serde_json::Value = serde_json::from_str(&fs::read_to_string(&json).unwrap()).unwrap();
    assert_eq!(saved["complete"], false);
    let rows = saved["rows"].as_array().unwrap().len();
    assert!(
        told(&output).contains(&format!("{rows} rows are measured; b.json holds them")),
        "{}",
        told(&output)
    );
}

#[test]
fn a_limit_on_the_size_of_files_leaves_nothing_half() {
    let folder = tempfile::tempdir().unwrap();
    // The first limit is too small for the pictures, the second for the page that holds them.
    for blocks in [40, 400] {
        let line = format!("ulimit -f {blocks}; exec $GRANFLOW verify --quick I-Ritter --out out");
        let output = shell(folder.path(), &line);
        assert_eq!(output.status.code(), Some(4), "{}", told(&output));
        assert!(told(&output).contains("make room"), "{}", told(&output));
        assert!(!folder.path().join("out").exists());
    }
    let mut raster = "ncols 200\nnrows 200\nxllcorner 0\nyllcorner 0\ncellsize 5\n".to_owned();
    (0..40_000).for_each(|k| raster += &format!("{} ", k % 7));
    fs::write(folder.path().join("a.asc"), &raster).unwrap();
    fs::write(folder.path().join("b.asc"), raster.replace('5', "6")).unwrap();
    let output = shell(folder.path(), "ulimit -f 4; exec $GRANFLOW compare a.asc b.asc --out out");
    assert_eq!(output.status.code(), Some(4), "{}", told(&output));
    assert!(names(&folder.path().join("out")).is_empty(), "{}", told(&output));
    let whole = granflow(folder.path(), &["compare", "a.asc", "b.asc", "--out", "out"]);
    assert!(whole.status.success(), "{}", told(&whole));
    assert_eq!(names(&folder.path().join("out")), ["compare.json", "compare.png"]);
}
