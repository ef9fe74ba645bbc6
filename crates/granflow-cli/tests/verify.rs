//! `granflow verify` through the binary: rows with reasons, page, and what it says to names and folders that cannot be.

mod support;

use std::path::Path;
use support::{granflow, said, told};

#[test]
fn a_benchmark_is_verified() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("jump");
    let done = granflow(Path::new("."), &["verify", "j", "--quick", "--out", out.to_str().expect("a path")]);
    assert!(done.status.success(), "{}{}", said(&done), told(&done));
    let rows: serde_json::Value =
        serde_json::from_slice(&std::fs::read(out.join("tables.json")).expect("tables.json")).expect("JSON");
    let rows = rows.as_array().expect("rows");
    assert_eq!(rows.len(), 12, "error and order of six schemes: {rows:#?}");
    for row in rows {
        assert_eq!(row["pass"], true, "{row:#}");
        assert!(row["reason"].as_str().is_some_and(|reason| reason.len() > 20), "{row:#}");
    }
    let page = std::fs::read_to_string(out.join("index.html")).expect("index.html");
    assert_eq!(page.matches("<img").count(), 2);
    for told in ["Why this tolerance", "energy_stable_2", "Tai, Noelle"] {
        assert!(page.contains(told), "{told}");
    }
}

#[test]
fn an_unknown_benchmark_is_answered_with_the_list() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("none");
    let failed =
        granflow(Path::new("."), &["verify", "A", "I-Riter", "--out", out.to_str().expect("a path")]);
    assert_eq!(failed.status.code(), Some(2));
    let said = told(&failed);
    for part in ["no benchmark `I-Riter`", "did you mean `I-Ritter`", "smooth-1D", "none for all"] {
        assert!(said.contains(part), "{said}");
    }
    assert!(!out.exists());
}

#[test]
fn results_that_cannot_go_to_a_file_are_refused_before_any_work() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("taken");
    std::fs::write(&file, "mine").expect("a file");
    for command in ["verify", "reproduce"] {
        let failed = granflow(Path::new("."), &[command, "--out", file.to_str().expect("a path")]);
        assert_eq!(failed.status.code(), Some(2), "{command}");
        let said = told(&failed);
        assert!(said.contains("taken") && said.contains("it is a file") && said.contains("--out"), "{said}");
    }
    assert_eq!(std::fs::read_to_string(&file).expect("the file"), "mine");
}
