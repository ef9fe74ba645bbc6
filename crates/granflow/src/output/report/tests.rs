//! The pages as a reader finds them.

use super::*;
use crate::output::summary::tests::sample;

fn figure(folder: &Path) -> Figure {
    let path = folder.join("deposit.png");
    fs::write(&path, b"\x89PNG").unwrap();
    Figure { name: "Deposit".into(), caption: "Thickness <in> m & more".into(), path }
}

#[test]
fn the_report_holds_everything_and_needs_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("report.html");
    let figures = [figure(folder.path())];
    let mut summary = sample();
    summary.title = "A <slide> & more".into();
    summary.warnings = vec!["the film holds 0.6 %".into()];
    let ledger: Vec<_> = (0..100).map(|step| Entry { step, time: step as f64, ..Entry::default() }).collect();
    let key_figures = [
        KeyFigure::number("Volume", Some(8.0), " m³"),
        KeyFigure::number("Runout", None, " m"),
        KeyFigure { name: "Ended because".into(), value: summary.stop_reason.to_string() },
        KeyFigure { name: "Cells steeper than 60°".into(), value: "746".into() },
    ];
    let report = Report {
        summary: &summary,
        key_figures: &key_figures,
        figures: &figures,
        case: "x = \"<b>\"",
        ledger: &ledger,
    };
    write_report(&path, report).unwrap();
    let page = fs::read_to_string(&path).unwrap();
    for part in [
        "<title>A &lt;slide&gt; &amp; more</title>",
        "src=\"data:image/png;base64,iVBORw==\" alt=\"Deposit\"",
        "Thickness &lt;in&gt; m &amp; more",
        "at rest",
        "746",
        "the film holds 0.6 %",
        "x = &quot;&lt;b&gt;&quot;",
        "One line in 3 and the last",
        "<td>8 m³</td>",
        "<td>–</td>",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("http") && !page.contains("<script") && !page.contains("NaN"));
}

#[test]
fn failing_rows_are_marked() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("index.html");
    let row =
        |computed| Row::new("Table 1", "mass", Expected::Published(1.5), computed, Measure::Relative, 0.05);
    let sections = [Section {
        title: "Silo".into(),
        text: vec!["Text.".into()],
        tables: vec![Table {
            title: "Schemes".into(),
            head: vec!["scheme".into()],
            lines: vec![vec!["balanced <exact>".into()]],
        }],
        figures: vec![figure(folder.path())],
        code: "mu < 1".into(),
    }];
    write_index(&path, "Reproduced", &[row(1.5), row(2.0)], &sections).unwrap();
    let page = fs::read_to_string(&path).unwrap();
    assert!(page.contains("<td>balanced &lt;exact&gt;</td>"));
    assert!(page.contains("<pre><code>mu &lt; 1</code></pre>"));
    assert!(
        page.contains("1 of 2 rows fail") && page.contains("<tr class=\"fail\">") && page.contains("✗ FAIL")
    );
    assert!(page.contains("± 5 %") && page.contains("<small>published</small>"));
    assert!(!page.contains("Why this tolerance"));
    write_index(&path, "Reproduced", &[row(1.5).because("two digits")], &[]).unwrap();
    let page = fs::read_to_string(&path).unwrap();
    assert!(page.contains("Why this tolerance") && page.contains("<td>two digits</td>"));
    assert!(fs::read_to_string(&path).unwrap().contains("All 1 rows"));
}

#[test]
fn a_missing_figure_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let mut figure = figure(folder.path());
    figure.path = folder.path().join("absent.png");
    let sections = [Section { figures: vec![figure], ..Section::default() }];
    let message =
        write_index(&folder.path().join("index.html"), "x", &[], &sections).unwrap_err().to_string();
    assert!(message.contains("absent.png"), "{message}");
}

#[test]
fn numbers_are_readable() {
    let cases = [
        (0.0, "0"),
        (-0.0, "0"),
        (8.0, "8"),
        (-1.5, "-1.5"),
        (1377.04, "1377"),
        (1377.46, "1377.5"),
        (99_999.7, "100000"),
        (41_261.0, "41261"),
        (178_435.6, "178436"),
        (1e7, "1e7"),
        (1.25e8, "1.25e8"),
        (0.0126, "0.0126"),
        (1e-16, "1e-16"),
        (f64::NAN, "NaN"),
    ];
    for (value, text) in cases {
        assert_eq!(readable(value), text);
    }
}
