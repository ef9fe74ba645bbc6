//! `granflow reproduce`: the tables and figures of the papers, ours beside theirs.

use std::path::Path;

use crate::failure::{Failure, print};
use crate::interrupt::{self, unless_asked};
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
    interrupt::listen()?;
    let page = page::Folder::make(out)?;
    let papers: Vec<_> = kinetic::PAPERS.iter().filter(|paper| wanted(paper.names())).collect();
    let flows = if papers.is_empty() { None } else { unless_asked(kinetic::Runs::compute).transpose()? };
    let piles = match wanted(sandpiles::NAMES) && !interrupt::is_asked() {
        true => unless_asked(sandpiles::Runs::compute).transpose()?,
        false => None,
    };
    if flows.is_none() && piles.is_none() {
        return Err(page.nothing("no paper"));
    }

    let (mut rows, mut chapters) = (Vec::new(), Vec::new());
    let folder = Path::new(page::FIGURES);
    if let Some(runs) = &flows {
        rows.extend(papers.iter().flat_map(|paper| kinetic::rows(paper, runs)));
        chapters.extend(kinetic::chapters(&papers, runs, folder));
    }
    if let Some(runs) = &piles {
        rows.extend(sandpiles::rows(runs));
        chapters.extend(sandpiles::chapters(runs, folder));
    }
    let left = wanted(sandpiles::NAMES) && piles.is_none();
    let title = if left { "The papers on avalanches, reproduced" } else { "The papers, reproduced" };
    print(&page.write(title, &rows, chapters)?)?;
    if left {
        return Err(Failure::Interrupted(format!(
            "{}: the papers on avalanches are complete and written; `granflow reproduce {} --out DIR` computes the other",
            out.display(),
            sandpiles::NAMES[0]
        )));
    }
    Ok(())
}

/// The papers' names, each with its shorter one.
fn names() -> impl Iterator<Item = [&'static str; 2]> {
    kinetic::PAPERS.iter().map(kinetic::Paper::names).chain([sandpiles::NAMES])
}
