//! The HTML pages: `report.html` of a run on terrain and `index.html` of `granflow reproduce` and `granflow verify`.
//!
//! Each is one self-contained page, figures inlined, that prints well and needs no script.

use super::base64::base64;
use super::ledger::Entry;
use super::summary::Summary;
use super::tables::{Expected, Measure, Row};
use super::{Error, whole_file};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use std::fs;
use std::path::{Path, PathBuf};

/// The ledger on a page shows at most so many lines; the file has them all.
const LEDGER_LINES: usize = 40;

const STYLE: &str = include_str!("report.css");

/// A figure on disk and what stands below it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// Short name, the alternative text of the picture.
    pub name: String,
    /// What one sees, with units.
    pub caption: String,
    /// The PNG.
    pub path: PathBuf,
}

/// A row of the key figures.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyFigure {
    /// What it is.
    pub name: String,
    /// Its value with unit.
    pub value: String,
}

impl KeyFigure {
    /// A number with its unit; a dash for one that does not apply.
    #[must_use]
    pub fn number(name: &str, value: Option<f64>, unit: &str) -> KeyFigure {
        let value = match value.filter(|value| value.is_finite()) {
            Some(value) => format!("{}{unit}", readable(value)),
            None => "–".into(),
        };
        KeyFigure { name: name.into(), value }
    }

    /// What can be said of a run of any model.
    #[must_use]
    pub fn of_any(summary: &Summary) -> Vec<KeyFigure> {
        let figure = KeyFigure::number;
        vec![
            figure("Mass at the start", Some(summary.mass_initial), ""),
            figure("Mass at the end", Some(summary.mass_final), ""),
            KeyFigure { name: "Ended because".into(), value: summary.stop_reason.to_string() },
            figure("Simulated time", Some(summary.time), ""),
            figure("Largest speed", Some(summary.max_speed), ""),
            figure("Left over the edges", Some(summary.mass_out), ""),
            figure("Mass error (relative)", Some(summary.mass_error), ""),
        ]
    }
}

/// The page of one run.
#[derive(Debug, Clone, Copy)]
pub struct Report<'a> {
    /// The run in numbers.
    pub summary: &'a Summary,
    /// The rows of the table of key figures.
    pub key_figures: &'a [KeyFigure],
    /// The pictures, in order.
    pub figures: &'a [Figure],
    /// The text of the case as it was written.
    pub case: &'a str,
    /// The lines of `mass.csv`.
    pub ledger: &'a [Entry],
}

/// A table of a page, texts only.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Table {
    /// What stands above it.
    pub title: String,
    /// One text for each column.
    pub head: Vec<String>,
    /// The lines, each as long as the head.
    pub lines: Vec<Vec<String>>,
}

/// A part of an index page.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Section {
    /// Heading.
    pub title: String,
    /// One paragraph each.
    pub text: Vec<String>,
    /// The tables, after the text.
    pub tables: Vec<Table>,
    /// The pictures, in order.
    pub figures: Vec<Figure>,
    /// A text that is shown as it is, such as a case; empty for none.
    pub code: String,
}

/// Writes `report.html`.
///
/// # Errors
/// [`Error::Io`] if the page cannot be written or a figure not read.
pub fn write_report(path: &Path, report: Report) -> Result<(), Error> {
    let Report { summary, key_figures, figures, case, ledger } = report;
    let body = html! {
        p.lead {
            (summary.model) ", " (summary.scheme) ", " (summary.cells) " cells, " (summary.steps) " steps, "
            (readable(summary.wall_seconds)) " s on " (summary.threads) " threads, granflow " (summary.version)
        }
        @for event in summary.texts("history") { p { "This run " (event) "." } }
        @for warning in &summary.warnings { p.warning role="note" { strong { "Note: " } (warning) } }
        h2 { "Key figures" }
        table.key {
            tbody {
                @for KeyFigure { name, value } in key_figures {
                    tr { th scope="row" { (name) } td { (value) } }
                }
            }
        }
        h2 { "Figures" }
        @for figure in figures { (inline(figure)?) }
        h2 { "Mass ledger" }
        (ledger_table(ledger))
        h2 { "Case" }
        pre { code { (case) } }
    };
    write_page(path, &summary.title, &body)
}

/// Writes `index.html`: the verdict, the table of all rows with the failing ones marked, then the sections.
///
/// # Errors
/// [`Error::Io`] if the page cannot be written or a figure not read.
pub fn write_index(path: &Path, title: &str, rows: &[Row], sections: &[Section]) -> Result<(), Error> {
    let failing = rows.iter().filter(|row| !row.pass()).count();
    let body = html! {
        @if failing > 0 {
            p.warning role="note" { strong { (failing) " of " (rows.len()) " rows fail." } }
        } @else if !rows.is_empty() {
            p.lead { "All " (rows.len()) " rows are within their tolerances." }
        }
        @if !rows.is_empty() { (rows_table(rows)) }
        @for section in sections {
            section {
                h2 { (section.title) }
                @for paragraph in &section.text { p { (paragraph) } }
                @for table in &section.tables { (text_table(table)) }
                @for figure in &section.figures { (inline(figure)?) }
                @if !section.code.is_empty() { pre { code { (section.code) } } }
            }
        }
    };
    write_page(path, title, &body)
}

fn write_page(path: &Path, title: &str, body: &Markup) -> Result<(), Error> {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="generator" content=(concat!("granflow ", env!("CARGO_PKG_VERSION")));
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body { main { h1 { (title) } (body) } }
        }
    };
    whole_file(path, |out| out.write_all(page.into_string().as_bytes()))
}

fn inline(figure: &Figure) -> Result<Markup, Error> {
    let picture = fs::read(&figure.path).map_err(Error::io(&figure.path, "read"))?;
    // Base64 holds nothing to escape, and is megabytes long.
    let source = format!("data:image/png;base64,{}", base64(&picture));
    Ok(html! {
        figure {
            img src=(PreEscaped(&source)) alt=(figure.name);
            figcaption { strong { (figure.name) "." } " " (figure.caption) }
        }
    })
}

fn rows_table(rows: &[Row]) -> Markup {
    let reasons = rows.iter().any(|row| row.reason.is_some());
    html! {
        div.wide { table.rows {
            thead { tr {
                @for head in ["", "Name", "Quantity", "Expected", "Computed", "Tolerance"] { th scope="col" { (head) } }
                @if reasons { th scope="col" { "Why this tolerance" } }
            } }
            tbody {
                @for row in rows {
                    tr.fail[!row.pass()] {
                        td.verdict { @if row.pass() { "✓ pass" } @else { "✗ FAIL" } }
                        td { (row.name) }
                        td { (row.quantity) }
                        td.number { (readable(row.expected.value())) " " small { (origin(row.expected)) } }
                        td.number { (readable(row.computed)) }
                        td.number { (tolerance(row)) }
                        @if reasons { td { (row.reason.as_deref().unwrap_or_default()) } }
                    }
                }
            }
        } }
    }
}

fn text_table(table: &Table) -> Markup {
    html! {
        p { strong { (table.title) } }
        div.wide { table.rows {
            thead { tr { @for head in &table.head { th scope="col" { (head) } } } }
            tbody { @for line in &table.lines { tr { @for text in line { td { (text) } } } } }
        } }
    }
}

fn origin(expected: Expected) -> &'static str {
    match expected {
        Expected::Published(_) => "published",
        Expected::Exact(_) => "exact",
        Expected::Independent(_) => "independent run",
    }
}

fn tolerance(row: &Row) -> String {
    let size = readable(row.tolerance);
    match row.measure {
        Measure::Absolute => format!("± {size}"),
        Measure::Relative => format!("± {} %", readable(100.0 * row.tolerance)),
        Measure::AtMost => format!("at most + {size}"),
        Measure::AtLeast => format!("at least − {size}"),
    }
}

fn ledger_table(ledger: &[Entry]) -> Markup {
    let every = ledger.len().div_ceil(LEDGER_LINES).max(1);
    let shown = ledger.iter().enumerate().filter(|(line, _)| line % every == 0 || line + 1 == ledger.len());
    html! {
        @if every > 1 { p { "One line in " (every) " and the last; mass.csv has all " (ledger.len()) "." } }
        div.wide { table.rows {
            thead { tr {
                @for head in ["Time", "Step", "Mass", "In", "Out", "Error", "Wet cells", "Moving", "Largest speed", "Kinetic energy"] {
                    th scope="col" { (head) }
                }
            } }
            tbody {
                @for (_, line) in shown {
                    tr {
                        td.number { (readable(line.time)) }
                        td.number { (line.step) }
                        @for number in [line.mass, line.mass_in, line.mass_out(), line.mass_error] {
                            td.number { (readable(number)) }
                        }
                        td.number { (line.wet_cells) }
                        td.number { (line.moving_cells) }
                        td.number { (readable(line.max_speed)) }
                        td.number { (readable(line.kinetic_energy)) }
                    }
                }
            }
        } }
    }
}

/// A number for people: five significant digits, powers of ten only where the number is very large or small.
fn readable(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.abs().to_string();
    }
    let rounded = format!("{value:.4e}");
    let (digits, exponent) = rounded.split_once('e').unwrap_or((&rounded, "0"));
    let trim = |text: &str| text.trim_end_matches('0').trim_end_matches('.').to_owned();
    match exponent.parse::<usize>() {
        Ok(power @ 4..7) => format!("{value:.0$}", 4_usize.saturating_sub(power)),
        Ok(power @ 0..4) => trim(&format!("{value:.0$}", 4 - power)),
        _ if value.abs() >= 1e-3 && value.abs() < 1.0 => trim(&format!("{value:.6}")),
        _ => format!("{}e{exponent}", if digits.contains('.') { trim(digits) } else { digits.into() }),
    }
}

#[cfg(test)]
mod tests;
