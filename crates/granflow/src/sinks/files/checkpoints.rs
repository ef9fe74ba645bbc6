//! A run on disk: what of it goes into `checkpoint/state.bin`, and back.

use super::BeginError;
use crate::output::checkpoint::{Checkpoint, Numbers, case_hash};
use crate::run::{Record, Run, Saved};
use granflow_case::RunPlan;
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// The checkpoint of the runs in a folder.
pub(super) fn file_in(directory: &Path) -> PathBuf {
    directory.join("checkpoint").join("state.bin")
}

/// The run as it stands; `due` are the times of the next frame and line, `written` those of the last ones.
pub(super) fn of<'a>(run: &'a dyn Run, plan: &RunPlan, due: [f64; 2], written: [f64; 2]) -> Checkpoint<'a> {
    let Saved { clock, state, maps, at_rest, record } = run.save();
    let mut scalars: Vec<(String, f64)> = vec![
        ("peak_speed".into(), record.peak_speed),
        ("peak_energy".into(), record.peak_energy),
        ("flowed".into(), record.flowed),
        ("initial".into(), record.initial),
        ("next_frame".into(), due[0]),
        ("next_line".into(), due[1]),
        ("last_frame".into(), written[0]),
        ("last_line".into(), written[1]),
        ("at_rest".into(), f64::from(u8::from(at_rest))),
    ];
    scalars.extend(clock.iter().enumerate().map(|(k, value)| (format!("clock_{k}"), *value)));
    let state = state.into_iter().enumerate();
    let mut arrays: Vec<(String, Numbers)> =
        state.map(|(k, part)| (format!("state_{k}"), Numbers::Double(part))).collect();
    arrays.extend(maps.into_iter().map(|(name, map)| (name.to_owned(), Numbers::Single(map))));
    Checkpoint { case: case_hash(&plan.text()), step: run.steps(), time: run.time(), scalars, arrays }
}

/// What a checkpoint holds.
pub(super) struct Taken {
    /// The run.
    pub saved: Saved<'static>,
    /// Times of the next frame and line.
    pub due: [f64; 2],
    /// Times of the last ones.
    pub written: [f64; 2],
}

/// Read a checkpoint of the case for a run of the same kind.
pub(super) fn read(path: &Path, plan: &RunPlan, run: &dyn Run) -> Result<Taken, BeginError> {
    let mut saved = Checkpoint::read(path, &case_hash(&plan.text()))?;
    let scalar = |name: &str| saved.scalar(name).unwrap_or(0.0);
    let kept = |name: &str| saved.scalar(name).unwrap_or(saved.time);
    let now = run.save();
    let record = Record {
        initial: scalar("initial"),
        peak_speed: scalar("peak_speed"),
        peak_energy: scalar("peak_energy"),
        flowed: scalar("flowed"),
        ..*run.record()
    };
    let (due, written) =
        ([scalar("next_frame"), scalar("next_line")], [kept("last_frame"), kept("last_line")]);
    let at_rest = saved.scalar("at_rest") == Some(1.0);
    let clock = (0..now.clock.len()).map_while(|k| saved.scalar(&format!("clock_{k}"))).collect();
    let names: Vec<&'static str> = now.maps.iter().map(|(name, _)| *name).collect();
    let parts = now.state.len();
    let state = (0..parts).map_while(|k| saved.take(&format!("state_{k}"))).map(Cow::Owned).collect();
    let single = |values: Vec<f64>| Cow::Owned(values.into_iter().map(|value| value as f32).collect());
    let maps = names.into_iter().filter_map(|name| Some((name, single(saved.take(name)?)))).collect();
    Ok(Taken { saved: Saved { clock, state, maps, at_rest, record }, due, written })
}
