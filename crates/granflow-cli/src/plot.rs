//! `granflow plot`: the figures of finished runs.

use std::path::{Path, PathBuf};

use crate::failure::Failure;

/// Draws the figures of finished runs into `out`, or beside each.
pub fn plot(results: &[PathBuf], out: Option<&Path>) -> Result<(), Failure> {
    let place = out.map_or_else(|| "beside each".to_owned(), |out| out.display().to_string());
    Err(Failure::usage(
        format!("this build draws no figures ({} results, {place})", results.len()),
        "take a build with the figures",
    ))
}
