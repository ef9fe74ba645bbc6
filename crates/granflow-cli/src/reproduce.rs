//! `granflow reproduce`: the tables and figures of the papers.

use std::path::Path;

use crate::failure::Failure;

/// Computes the tables and figures of a paper, or of all.
pub fn reproduce(paper: Option<&str>, out: &Path) -> Result<(), Failure> {
    let what = paper.unwrap_or("all papers");
    Err(Failure::usage(
        format!("this build cannot compute, so it cannot reproduce {what} into {}", out.display()),
        "take a build with the solver",
    ))
}
