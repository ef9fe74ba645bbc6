//! A run as it ends: maps, figures, and why.

use super::Files;
use crate::model::Plane;
use crate::output::folder::Folder;
use crate::output::frames::Frames;
use crate::output::summary::{StopReason, Summary};
use crate::results::Finished;
use crate::results::numbers;
use crate::run::{Entry, Maps, Run};
use granflow_case::FileKind;
use std::path::PathBuf;

/// A finished run but for its series and its ledger, which the writer has.
#[derive(Debug)]
pub(super) struct Ending {
    directory: PathBuf,
    files: Vec<FileKind>,
    case: String,
    case_text: String,
    plane: Plane,
    maps: Maps,
    series: [Option<PathBuf>; 2],
    path: Option<Vec<[f64; 2]>>,
    path_width: f64,
    history: Vec<String>,
    summary: Summary,
}

impl Ending {
    /// What there is now.
    pub fn of(files: &Files, run: &mut dyn Run, reason: StopReason) -> Ending {
        let end = run.maps();
        let mut maps = run.peaks();
        maps.extend(end);
        Ending::with(files, run.place(), maps, summary(files, run, reason))
    }

    /// What there is at the end.
    pub fn last(files: &Files, mut run: Box<dyn Run>, reason: StopReason) -> Ending {
        run.stepper_mut().release_buffers();
        let end = run.maps();
        let summary = summary(files, &*run, reason);
        let plane = run.place();
        let mut maps = run.into_peaks();
        maps.extend(end);
        Ending::with(files, plane, maps, summary)
    }

    fn with(files: &Files, plane: Plane, maps: Maps, summary: Summary) -> Ending {
        let past = files.past_and_now();
        Ending {
            directory: files.folder.path().to_owned(),
            files: files.plan.output.files.clone(),
            case: files.plan.resolved(),
            case_text: files.plan.text(),
            plane,
            maps,
            series: files.series.paths(files.folder.path()),
            path: files.series.path(),
            path_width: files.plan.output.path_width,
            history: past.commands.into_iter().chain(past.events).collect(),
            summary,
        }
    }

    /// Say in the summary why the run failed.
    pub fn explain(&mut self, failure: &str) {
        self.summary.extra.insert("failure".to_owned(), failure.into());
    }

    /// Put it together; `folder` keeps its lock for as long as files are made.
    pub fn finished(self, folder: Option<Folder>, frames: Frames, ledger: Vec<Entry>) -> Finished {
        let Ending {
            directory,
            files,
            case,
            case_text,
            plane,
            mut maps,
            series,
            path,
            path_width,
            history,
            mut summary,
        } = self;
        numbers::complete(&plane, &mut maps, &mut summary);
        Finished {
            directory,
            folder,
            files,
            case,
            case_text,
            plane,
            frames,
            ledger,
            maps,
            series,
            path,
            path_width,
            history,
            summary,
        }
    }
}

fn summary(files: &Files, run: &dyn Run, reason: StopReason) -> Summary {
    let mut summary = numbers::summary(&files.plan, run, reason, files.start);
    numbers::went_on(&files.past, &mut summary);
    summary
}
