//! `granflow plot`: the figures of finished runs.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use granflow::results::Story;

use crate::failure::{Failure, print};
use crate::interrupt;

/// Draws the standard figures of finished runs into `out`, or into `figures/` beside each; of several results each has
/// its own folder in `out`, called as the result's folder.
pub fn plot(results: &[PathBuf], out: Option<&Path>) -> Result<(), Failure> {
    let stop = interrupt::listen()?;
    for (place, result) in results.iter().enumerate() {
        if stop.load(Ordering::SeqCst) {
            let left: Vec<String> = results[place..].iter().map(|path| path.display().to_string()).collect();
            let message =
                format!("{place} of {} results are drawn; left: {}", results.len(), left.join(", "));
            return Err(Failure::Interrupted(message));
        }
        let beside = result.parent().unwrap_or(Path::new(""));
        let folder = match out {
            None => beside.join("figures"),
            Some(out) if results.len() == 1 => out.to_owned(),
            Some(out) => {
                out.join(beside.file_name().map_or_else(|| place.to_string().into(), ToOwned::to_owned))
            }
        };
        let figures = Story::read(result)?.draw(&folder)?;
        let lines: String = figures.iter().map(|figure| format!("{}\n", figure.path.display())).collect();
        print(&lines)?;
    }
    Ok(())
}
