//! A run on disk: what of it goes into `checkpoint/state.bin`, and back.

use super::BeginError;
use crate::output;
use crate::output::checkpoint::{Checkpoint, Marks, Numbers, Origin, Past};
use crate::run::{Record, Run, Saved, StopReason};
use granflow_case::Change;
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// The checkpoint of the runs in a folder.
pub(super) fn file_in(directory: &Path) -> PathBuf {
    directory.join("checkpoint").join("state.bin")
}

/// The checkpoint that a run which ended by time goes on from to a later end: the last one before the step that the end cut.
pub(super) fn before_end_in(directory: &Path) -> PathBuf {
    directory.join("checkpoint").join("before_end.bin")
}

/// When what is written beside the checkpoints comes next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Due {
    /// Times of the next frame, line and look at gauges and sections.
    pub next: [f64; 3],
    /// Times between two frames, and between two looks; infinite where there is none.
    pub every: [f64; 2],
}

/// The run as it stands; `ended` says why it goes no further.
pub(super) fn of<'a>(
    run: &'a dyn Run,
    (origin, past): (&Origin, &Past),
    due: Due,
    ended: Option<StopReason>,
) -> Checkpoint<'a> {
    let Saved { cells, clock, state, maps, at_rest, drift, model, passed, durations, record } = run.save();
    let mut scalars: Vec<(String, f64)> = vec![
        ("peak_speed".into(), record.peak_speed),
        ("peak_energy".into(), record.peak_energy),
        ("flowed".into(), record.flowed),
        ("initial".into(), record.initial),
        ("next_frame".into(), due.next[0]),
        ("next_line".into(), due.next[1]),
        ("next_series".into(), due.next[2]),
        ("every_frame".into(), due.every[0]),
        ("every_series".into(), due.every[1]),
        ("at_rest".into(), f64::from(u8::from(at_rest))),
        ("columns".into(), cells[0] as f64),
        ("rows".into(), cells[1] as f64),
    ];
    let passed = passed.into_iter().flatten().collect();
    for (list, values) in [("clock", clock), ("drift", drift), ("passed", passed)] {
        scalars.extend(values.iter().enumerate().map(|(k, value)| (format!("{list}_{k}"), *value)));
    }
    let state = state.into_iter().enumerate();
    let mut arrays: Vec<(String, Numbers)> =
        state.map(|(k, part)| (format!("state_{k}"), Numbers::Double(part))).collect();
    arrays.extend(maps.into_iter().map(|(name, map)| (name.to_owned(), Numbers::Single(map))));
    for (list, parts) in [("duration", durations), ("model", model)] {
        let parts = parts.into_iter().enumerate();
        arrays.extend(parts.map(|(k, part)| (format!("{list}_{k}"), Numbers::Double(part))));
    }
    let (origin, past) = (origin.clone(), past.clone());
    Checkpoint { origin, past, ended, step: run.steps(), time: run.time(), scalars, arrays }
}

/// Write the run as it stands, with no files beside it.
pub(crate) fn write(run: &dyn Run, origin: &Origin, path: &Path) -> Result<(), output::Error> {
    let due = Due { next: [f64::INFINITY; 3], every: [f64::INFINITY; 2] };
    of(run, (origin, &Past::default()), due, None).write(path, Marks::default())
}

/// Read a checkpoint whatever files were beside it; says what changes in the case.
pub(crate) fn take(
    path: &Path,
    origin: &Origin,
    run: &dyn Run,
) -> Result<(Saved<'static>, Vec<Change>), BeginError> {
    read(path, origin, run).map(|(saved, taken)| (saved, taken.changes))
}

/// What a checkpoint holds beside the run.
pub(super) struct Taken {
    /// When what is written beside it comes next.
    pub due: Due,
    /// How far the files beside it had come.
    pub marks: Marks,
    /// Why the run had ended, if it had.
    pub ended: Option<StopReason>,
    /// What changes in the case.
    pub changes: Vec<Change>,
    /// How it came to where it stands.
    pub past: Past,
}

/// Read a checkpoint that a run of the same kind, still as its case made it, goes on from with this origin.
pub(super) fn read(
    path: &Path,
    origin: &Origin,
    run: &dyn Run,
) -> Result<(Saved<'static>, Taken), BeginError> {
    let (mut saved, marks, changes) = Checkpoint::read(path, origin)?;
    let scalar = |name: &str| saved.scalar(name).unwrap_or(0.0);
    let list = |name: &str| (0..).map_while(|k| saved.scalar(&format!("{name}_{k}"))).collect::<Vec<f64>>();
    let now = run.save();
    let record = Record {
        initial: scalar("initial"),
        peak_speed: scalar("peak_speed"),
        peak_energy: scalar("peak_energy"),
        flowed: scalar("flowed"),
        ..*run.record()
    };
    let due = Due {
        next: ["next_frame", "next_line", "next_series"].map(scalar),
        every: ["every_frame", "every_series"].map(scalar),
    };
    let cells = ["columns", "rows"].map(|name| scalar(name) as usize);
    let at_rest = scalar("at_rest") == 1.0;
    let (clock, drift) = (list("clock"), list("drift"));
    let passed = list("passed").as_chunks().0.to_vec();
    let names: Vec<&'static str> = now.maps.iter().map(|(name, _)| *name).collect();
    let mut arrays = |list: &str| -> Vec<Cow<'static, [f64]>> {
        (0..).map_while(|k| saved.take(&format!("{list}_{k}"))).map(Cow::Owned).collect()
    };
    let [mut state, mut durations, mut model] = ["state", "duration", "model"].map(&mut arrays);
    let single = |values: Vec<f64>| Cow::Owned(values.into_iter().map(|value| value as f32).collect());
    let mut maps = names.into_iter().filter_map(|name| Some((name, single(saved.take(name)?)))).collect();
    if saved.step == 0 && state.is_empty() {
        // Saved as it began: the case has made it again.
        if run.steps() > 0 {
            let problem =
                "it was saved before the first step and holds no state; make the run anew in its place";
            return Err(output::Error::mismatch(path, problem).into());
        }
        Saved { state, durations, model, maps, .. } = now.into_owned();
    }
    let (ended, past) = (saved.ended, std::mem::take(&mut saved.past));
    let saved = Saved { cells, clock, state, maps, at_rest, drift, model, passed, durations, record };
    Ok((saved, Taken { due, marks, ended, changes, past }))
}
