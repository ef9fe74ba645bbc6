//! `granflow reproduce` through the binary: rows, figures, page, and what it says to a name it does not know.

mod support;

use std::path::Path;
use support::{granflow, said, told};

/// Width and height of a PNG that is whole: signature, chunks end to end, IHDR first and IEND last.
fn size_of_png(path: &Path) -> (u32, u32) {
    let bytes = std::fs::read(path).expect("the figure is there");
    let word = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
    assert!(bytes.starts_with(b"\x89PNG\r\n\x1a\n"), "{}", path.display());
    let (mut at, mut kinds) = (8, Vec::new());
    while at < bytes.len() {
        kinds.push(String::from_utf8_lossy(&bytes[at + 4..at + 8]).into_owned());
        at += 12 + word(at) as usize;
    }
    assert_eq!(at, bytes.len(), "{} is cut off", path.display());
    assert!(
        kinds[0] == "IHDR" && kinds[kinds.len() - 1] == "IEND" && kinds.iter().any(|kind| kind == "IDAT")
    );
    (word(16), word(20))
}

#[test]
fn the_report_is_reproduced() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("report");
    let done = granflow(Path::new("."), &["reproduce", "report", "--out", out.to_str().expect("a path")]);
    assert!(done.status.success(), "{}", told(&done));
    let said = said(&done);

    let rows: serde_json::Value =
        serde_json::from_slice(&std::fs::read(out.join("tables.json")).expect("tables.json")).expect("JSON");
    let rows = rows.as_array().expect("rows");
    assert_eq!(rows.len(), 44, "{rows:#?}");
    for row in rows {
        assert_eq!(row["pass"], true, "{row:#}");
        assert!(
            row["computed"].is_f64()
                && ["published", "exact", "independent"].iter().any(|key| row[*key].is_f64()),
            "{row:#}"
        );
    }
    assert!(said.contains("0 of 44 rows fail"), "{said}");

    let page = std::fs::read_to_string(out.join("index.html")).expect("index.html");
    let figures: Vec<_> = std::fs::read_dir(out.join("figures"))
        .expect("figures/")
        .map(|entry| entry.expect("an entry").path())
        .collect();
    for figure in &figures {
        let (width, height) = size_of_png(figure);
        assert!(width >= 800 && height >= 500, "{}: {width} x {height}", figure.display());
    }
    let named = |start: &str| {
        let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        figures.iter().filter(|path| name(path).starts_with(start)).count()
    };
    for number in 1..=6 {
        assert!(named(&format!("report_{number}_")) > 0, "figure {number}");
        assert!(page.contains(&format!("Report Fig. {number}.")), "figure {number}");
    }
    assert_eq!((named("schemes_"), named("failure_sine_verfahren_")), (7, 3));
    assert_eq!(page.matches("<img").count(), figures.len());
    // What fails is told, with the step.
    for told in ["h &lt; 0 at step 1570", "h &lt; 0 at step 1567", "balanced_2", "yes: proven at rest"] {
        assert!(page.contains(told), "{told}");
    }
}

#[test]
#[ignore = "half a minute and more of computing: cargo test --release -p granflow-cli --test reproduce -- --ignored"]
fn the_sandpiles_are_reproduced() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("sandpiles");
    let done = granflow(Path::new("."), &["reproduce", "sandpiles", "--out", out.to_str().expect("a path")]);
    assert!(done.status.success(), "{}", told(&done));
    // Tables 1 and 2 have 30 and 24 numbers, and 4 by a formula; a pile that is no longer steady would lose its 4 rows.
    let said = said(&done);
    assert!(said.contains("0 of 87 rows fail; 12 figures"), "{said}");
    let page = std::fs::read_to_string(out.join("index.html")).expect("index.html");
    assert_eq!(page.matches("<img").count(), 12);
    assert!(!page.contains("kinetic schemes"), "the other papers were not asked for");
    for entry in std::fs::read_dir(out.join("figures")).expect("figures/") {
        let (width, height) = size_of_png(&entry.expect("an entry").path());
        assert!(width >= 800 && height >= 500);
    }
}

#[test]
fn an_unknown_paper_is_answered_with_the_nearest_and_the_list() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("none");
    let failed = granflow(Path::new("."), &["reproduce", "thesys", "--out", out.to_str().expect("a path")]);
    assert_eq!(failed.status.code(), Some(2));
    let said = told(&failed);
    for part in
        ["no paper `thesys`", "did you mean `thesis`", "kaland_2007", "kaland_struckmeier_2007", "sandpiles"]
    {
        assert!(said.contains(part), "{said}");
    }
    assert!(!out.exists());
}
