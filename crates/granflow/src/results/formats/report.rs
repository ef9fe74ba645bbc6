//! `report.html`: one page that shows it all.

use crate::output;
use crate::output::report::{Figure, Report, write_report};
use crate::results::format::{Format, Work};
use crate::results::{FilesError, Finished};
use granflow_case::FileKind;
use std::path::PathBuf;

/// The report, which shows the figures.
pub(super) static REPORT: Format = Format {
    kind: FileKind {
        name: "report",
        about: "One page that shows it all, report.html (terrain).",
        needs_terrain: true,
    },
    drawn: true,
    after_figures: true,
    write,
};

fn write(work: &Work) -> Result<Vec<PathBuf>, FilesError> {
    Ok(vec![page(work.run, work.figures.get().map_or(&[], Vec::as_slice))?])
}

fn page(run: &Finished, figures: &[Figure]) -> Result<PathBuf, output::Error> {
    let path = run.directory.join("report.html");
    let key_figures = (run.plane.model().key_figures)(&run.summary);
    let report = Report {
        summary: &run.summary,
        key_figures: &key_figures,
        figures,
        case: &run.case_text,
        ledger: &run.ledger,
    };
    write_report(&path, report)?;
    Ok(path)
}
