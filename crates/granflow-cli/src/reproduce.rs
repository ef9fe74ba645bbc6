//! `granflow reproduce`: the tables and figures of the papers, ours beside theirs.

use std::path::Path;

use crate::failure::{Failure, print};
use crate::page;

mod kinetic;
pub mod sandpiles;

/// Computes the tables and figures of a paper, or of all.
pub fn reproduce(paper: Option<&str>, out: &Path) -> Result<(), Failure> {
    let wanted = |names: [&str; 2]| paper.is_none_or(|paper| names.contains(&paper));
    if !names().any(wanted) {
        let list: Vec<String> = names().map(|[name, short]| format!("{name} (or {short})")).collect();
        return Err(page::unknown("paper", paper.unwrap_or_default(), names().flatten(), &list));
    }
    page::folder(out)?;
    let papers: Vec<_> = kinetic::PAPERS.iter().filter(|paper| wanted(paper.names())).collect();
    let flows = if papers.is_empty() { None } else { Some(kinetic::Runs::compute()?) };
    let piles = if wanted(sandpiles::NAMES) { Some(sandpiles::Runs::compute()?) } else { None };

    let (mut rows, mut chapters) = (Vec::new(), Vec::new());
    let folder = out.join("figures");
    if let Some(runs) = &flows {
        rows.extend(papers.iter().flat_map(|paper| kinetic::rows(paper, runs)));
        chapters.extend(kinetic::chapters(&papers, runs, &folder));
    }
    if let Some(runs) = &piles {
        rows.extend(sandpiles::rows(runs));
        chapters.extend(sandpiles::chapters(runs, &folder));
    }
    print(&page::write(out, "The papers, reproduced", &rows, chapters)?)
}

/// The papers' names, each with its shorter one.
fn names() -> impl Iterator<Item = [&'static str; 2]> {
    kinetic::PAPERS.iter().map(kinetic::Paper::names).chain([sandpiles::NAMES])
}
