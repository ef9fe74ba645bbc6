//! The end of another run of an avalanche, from its `result.nc`.

use crate::model::ResultFile;
use crate::stop_reason::StopReason;
use std::path::Path;

/// A finished run, open at its last instant.
pub(super) struct Ended {
    /// Its file.
    pub file: ResultFile,
    /// Number of its last instant.
    pub instant: usize,
    /// That instant, as a time.
    pub time: f64,
    /// It had come to rest.
    pub rests: bool,
}

/// Opens the end of a run on a terrain, or on a chute.
pub(super) fn open(path: &Path, on_terrain: bool) -> Result<Ended, String> {
    let file = ResultFile::open(path)?;
    if !file.has("thickness") || file.has("bed") != on_terrain {
        let place = if on_terrain { "terrain" } else { "chute" };
        return Err(format!("it is no result of an avalanche on a {place}"));
    }
    let times = file.whole("time")?;
    let (Some(instant), Some(&time)) = (times.len().checked_sub(1), times.last()) else {
        return Err("it has no instant".to_owned());
    };
    let reason = file.text("stop_reason");
    if reason == StopReason::Failed.to_string() {
        return Err("it failed, and its last state is worth nothing".to_owned());
    }
    let rests = [StopReason::AtRest, StopReason::Trickle].iter().any(|rest| rest.to_string() == reason);
    Ok(Ended { file, instant, time, rests })
}

/// What to know of a run's end, `at` its time, with which another run begins: whether it is a mere note, and the sentence.
pub(super) fn remark(path: &Path, at: &str, rests: bool) -> (bool, String) {
    let name = path.display();
    let text = if rests {
        format!("{name}: what lay at rest at its end, t = {at}, is released")
    } else {
        format!(
            "{name}: its mass still moved at its end, t = {at}; here it starts at rest (--resume goes on with its speed)"
        )
    };
    (rests, text)
}
