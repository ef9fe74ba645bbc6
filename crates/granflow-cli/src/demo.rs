//! `granflow demo`: a mountain avalanche to its rest, without any file.

use std::path::Path;

use crate::failure::Failure;

/// Computes the built-in avalanche into `out`.
pub fn demo(out: &Path) -> Result<(), Failure> {
    Err(Failure::usage(
        format!("this build cannot compute the demonstration into {}", out.display()),
        "take a build with the solver",
    ))
}
