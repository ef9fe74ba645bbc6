//! Text and files of others: shown and not sent, named and not quoted, refused before they fill the memory.

mod support;

use std::path::Path;
use support::{PROGRAM, granflow, said, told};

const CASE: &str = r#"title = "test"
[grid]
x = { from = -6.0, to = 6.0, cells = 24 }
[material]
friction.coulomb = { mu = 0.3 }
[initial]
thickness = 1.0
[time]
steps = 3
"#;

fn put(folder: &Path, name: &str, text: &str) {
    std::fs::write(folder.join(name), text).expect("a file");
}

/// Nothing in what was said steers a terminal.
fn is_plain(text: &str) -> bool {
    !text.contains(|sign: char| (sign.is_control() && sign != '\n') || sign == '\u{202e}')
}

#[test]
fn no_text_of_others_steers_the_terminal() {
    let folder = tempfile::tempdir().expect("a folder");
    let escapes = "\\u001b[2J\\u0007\\u202e";
    for (what, by) in [
        ("title = \"test\"", format!("title = \"red {escapes}\"")),
        ("mu = 0.3", format!("\"m{escapes}\" = 0.3")),
        ("thickness = 1.0", format!("thickness.formula = \"x + {escapes}\"")),
        ("thickness = 1.0", format!("thickness.file = \"h{escapes}.csv\"")),
        ("mu = 0.3", format!("angle = \"18 {escapes}\"")),
        ("steps = 3", "steps = 3 # \u{1b}[31m".to_owned()),
        ("steps = 3", format!("steps = 3\nuntil = \"{escapes}\"")),
    ] {
        put(folder.path(), "case.toml", &CASE.replace(what, &by));
        for command in ["check", "run"] {
            let output = granflow(
                folder.path(),
                &[command, "case.toml", "--out", "out"][..if command == "run" { 4 } else { 2 }],
            );
            let text = said(&output) + &told(&output);
            assert!(is_plain(&text), "{by}: {text:?}");
        }
    }
    let name = "odd\u{1b}[31m.toml";
    put(folder.path(), name, CASE);
    for arguments in
        [&["check", name] as &[&str], &["run", name], &["run", name, "--resume"], &["plot", name]]
    {
        let output = granflow(folder.path(), arguments);
        let text = said(&output) + &told(&output);
        assert!(
            is_plain(&text) && (text.contains("odd\\u{1b}[31m") || text.is_empty()),
            "{arguments:?}: {text:?}"
        );
    }
}

#[test]
fn of_a_file_that_is_no_case_only_the_name_is_shown() {
    let folder = tempfile::tempdir().expect("a folder");
    let secret = "hunter2";
    for (name, text) in [
        ("passwd", format!("root:x:0:0:{secret}\n")),
        ("credentials.toml", format!("title = \"keys\"\n[registry]\ntoken = \"{secret}\"\n")),
        ("broken.toml", format!("{secret} = = 3\n")),
        ("zeros", format!("\0\0{secret}\0")),
        ("empty.toml", String::new()),
    ] {
        put(folder.path(), name, &text);
        let output = granflow(folder.path(), &["run", name]);
        let message = told(&output);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(name) && message.contains("this is no case file"), "{message}");
        assert!(message.contains("granflow new --list") && !message.contains(secret), "{message}");
    }
    // a case with a mistake is shown
    put(folder.path(), "case.toml", &CASE.replace("steps = 3", "steps = = 3"));
    assert!(told(&granflow(folder.path(), &["run", "case.toml"])).contains("steps = = 3"));
}

#[test]
#[cfg(target_os = "linux")]
fn a_check_takes_little_memory_and_what_cannot_fit_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    // More than twice the memory that is allowed: the fields of the run alone would take more than 1 GB.
    let many = CASE
        .replace("cells = 24", "cells = 8000000")
        .replace("thickness = 1.0", "thickness.formula = \"x + 6\"");
    put(folder.path(), "case.toml", &many);
    let line = format!("ulimit -v 350000; exec {PROGRAM} check case.toml");
    let output = std::process::Command::new("sh")
        .current_dir(folder.path())
        .args(["-c", &line])
        .env("RAYON_NUM_THREADS", "2")
        .output()
        .expect("a shell");
    assert_eq!(output.status.code(), Some(0), "{}", told(&output));
    let text = said(&output);
    assert!(text.contains("mass 72.000000, 7999999 wet cells") && text.contains("GB at its peak"), "{text}");
    for model in ["", "model = \"hadeler_kuttler\"\n"] {
        let case =
            format!("{model}grid.x = {{ from = 0, to = 1e6, cells = 60000000000 }}\n[time]\nsteps = 1\n");
        let case = if model.is_empty() {
            case + "[material]\nfriction.coulomb.mu = 0.3\n[initial]\nthickness = 1\n"
        } else {
            case
        };
        put(folder.path(), "case.toml", &case);
        let output = granflow(folder.path(), &["run", "case.toml"]);
        let message = told(&output);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("grid.x.cells") && message.contains("are free"), "{message}");
    }
}

#[test]
fn deep_keys_and_endless_lines_are_refused_in_few_words() {
    let folder = tempfile::tempdir().expect("a folder");
    let deep = 20_000;
    let long = "x".repeat(1 << 20);
    for text in [
        format!("{CASE}\n{} = 1\n", vec!["a"; deep].join(".")),
        format!("{CASE}\n[{}]\nb = 1\n", vec!["a"; deep].join(".")),
        format!("{CASE}\na = {}{}\n", "[".repeat(deep), "]".repeat(deep)),
        format!("{CASE}\na = {}1{}\n", "{a=".repeat(deep), "}".repeat(deep)),
        format!("{CASE}\nuntil = \"{long}\"\n"),
        format!("{CASE}\n\"{long}\" = 1\n"),
        CASE.replace("mu = 0.3", &format!("mu = {}", "3".repeat(1 << 20))),
    ] {
        put(folder.path(), "case.toml", &text);
        let output = granflow(folder.path(), &["check", "case.toml"]);
        let message = told(&output);
        assert_eq!(output.status.code(), Some(2), "{}", &message[..message.len().min(2000)]);
        assert!(message.len() < 4000, "{} bytes", message.len());
    }
    let key = vec!["a"; deep].join(".");
    assert_eq!(
        granflow(folder.path(), &["check", "case.toml", "--set", &format!("{key}=1")]).status.code(),
        Some(2)
    );
}

/// A title is one line in every file, whatever stands in the case.
#[test]
fn a_title_of_lines_and_escapes_breaks_no_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let title = "title = \"two\\nlines, \\u001b[31m & <b>\""; // as TOML writes it
    let case = CASE.replace("title = \"test\"", title) + "[output]\nfiles = [\"netcdf\", \"csv\"]\n";
    put(folder.path(), "case.toml", &case);
    let output = granflow(folder.path(), &["run", "case.toml", "--out", "out"]);
    assert!(output.status.success(), "{}", told(&output));
    let shown = "two lines, \\u{1b}[31m & <b>";
    let read = |name: &str| std::fs::read_to_string(folder.path().join("out").join(name)).expect("the file");
    let summary: serde_json::Value = serde_json::from_str(&read("summary.json")).expect("JSON");
    assert_eq!(summary["title"], shown);
    let result = netcdf_reader::NcFile::open(folder.path().join("out/result.nc")).expect("the result");
    let attribute = result.global_attribute("title").expect("a title").value.as_string();
    assert_eq!(attribute.as_deref(), Some(shown));
    let ledger = read("mass.csv");
    let columns = |line: &str| line.split(',').count();
    let widths: Vec<usize> = ledger.lines().map(columns).collect();
    assert!(widths.iter().all(|width| *width == widths[0]), "{ledger}");
    assert!(granflow(folder.path(), &["plot", "out/result.nc", "--out", "again"]).status.success());
}

#[test]
fn numbers_of_any_size_are_shown_in_few_signs() {
    let folder = tempfile::tempdir().expect("a folder");
    put(folder.path(), "case.toml", CASE);
    for set in ["initial.thickness=1e308", "grid.x.from=-1e300", "output.every=1e-300", "time.end=1e308"] {
        let output = granflow(folder.path(), &["check", "case.toml", "--set", set]);
        let text = said(&output) + &told(&output);
        let longest = text.split(|sign: char| !sign.is_ascii_digit()).map(str::len).max();
        assert!(longest < Some(30), "{set}: {text}");
    }
}

/// What is no file is refused and not waited for.
#[test]
#[cfg(unix)]
fn pipes_and_devices_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    assert!(support::shell(folder.path(), "mkfifo pipe.nc").status.success());
    for words in [
        &["check", "pipe.nc"][..],
        &["run", "/dev/zero"],
        &["plot", "pipe.nc"],
        &["compare", "pipe.nc", "pipe.nc"],
    ] {
        let output = granflow(folder.path(), words);
        assert_eq!(output.status.code(), Some(4), "{words:?}: {}", told(&output));
        assert!(told(&output).contains("a pipe or a device, not a file"), "{words:?}: {}", told(&output));
    }
}
