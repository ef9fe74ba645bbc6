//! `granflow verify`: every scheme against known answers.

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use granflow::output::tables::Row;

use crate::failure::{Failure, print};
use crate::interrupt;
use crate::page::{self, parallel};

mod arc;
mod avalanches;
mod benchmark;
mod column;
mod convergence;
mod dice;
mod energy;
mod flat_dam;
mod mountain;
mod ode;
mod planes;
mod rest;
mod sandpiles;
mod scheme;
mod sheets;
mod slab;
mod smooth;
mod turned;

use benchmark::{Benchmark, Finding, Piece, Size};

/// All benchmarks, in the order of the page.
fn all() -> impl Iterator<Item = &'static Benchmark> {
    planes::BENCHMARKS
        .iter()
        .chain(&sheets::BENCHMARKS)
        .chain(&smooth::BENCHMARKS)
        .chain(&slab::BENCHMARKS)
        .chain(&arc::BENCHMARKS)
        .chain(&rest::BENCHMARKS)
        .chain([&flat_dam::BENCHMARK, &turned::BENCHMARK, &column::BENCHMARK, &sandpiles::BENCHMARK])
        .chain([&energy::BENCHMARK, &avalanches::BENCHMARK])
}

/// The list under `granflow verify --help`.
pub fn benchmarks_help() -> String {
    let lines = all().map(|benchmark| format!("  {:10} {}\n", benchmark.name, benchmark.title));
    let list: String = lines.collect();
    format!(
        "Benchmarks:\n{list}\n\
         Examples:\n\
         \x20 granflow verify            all; a few minutes\n\
         \x20 granflow verify A I        some; a letter stands for all that begin with it\n\n\
         Writes tables.json, index.html and figures/. Exit status 1 if a row is outside its tolerance.\n\
         Ctrl-C, SIGTERM and SIGHUP end with the page of the benchmarks that are complete; a second one ends at once."
    )
}

/// Computes the benchmarks of these names, or all, and writes what was found; once a signal asks for the end, what was found
/// of those that are complete.
pub fn verify(names: &[String], out: &Path, quick: bool) -> Result<(), Failure> {
    let chosen = choose(names)?;
    interrupt::listen()?;
    let folder = page::Folder::make(out)?;
    let found = compute(&chosen, if quick { Size::Small } else { Size::Full })?;
    if found.is_empty() {
        return Err(folder.nothing("no benchmark"));
    }
    let left: Vec<&str> = (chosen.iter().map(|benchmark| benchmark.name))
        .filter(|name| !found.iter().any(|(complete, _)| complete.name == *name))
        .collect();
    let rows = rows(&found);
    let figures = Path::new(page::FIGURES);
    let chapters =
        found.iter().map(|(benchmark, findings)| benchmark::chapter(benchmark, findings, figures)).collect();
    let title = match left.as_slice() {
        [] => "granflow, verified".to_owned(),
        left => format!("granflow, verified in part: without {}", left.join(", ")),
    };
    print(&folder.write(&title, &rows, chapters)?)?;
    if !left.is_empty() {
        return Err(Failure::Interrupted(format!(
            "{}: {} of {} benchmarks are complete and written; `granflow verify {}{} --out DIR` computes the others",
            out.display(),
            found.len(),
            chosen.len(),
            left.join(" "),
            if quick { " --quick" } else { "" }
        )));
    }
    match rows.iter().filter(|row| !row.pass()).count() {
        0 => Ok(()),
        fail => Err(Failure::Verdict(format!("{fail} of {} rows are outside their tolerances", rows.len()))),
    }
}

/// The benchmarks of these names, in the order of the page.
fn choose(names: &[String]) -> Result<Vec<&'static Benchmark>, Failure> {
    // `I` stands for `I-Ritter` and all others of the letter.
    let is = |name: &str, benchmark: &Benchmark| {
        let (letter, _) = benchmark.name.split_once('-').unwrap_or((benchmark.name, ""));
        [benchmark.name, letter].iter().any(|known| known.eq_ignore_ascii_case(name))
    };
    if let Some(name) = names.iter().find(|name| !all().any(|benchmark| is(name, benchmark))) {
        let list: Vec<String> = all().map(|benchmark| benchmark.name.to_owned()).collect();
        return Err(page::unknown("benchmark", name, all().map(|benchmark| benchmark.name), &list));
    }
    Ok(all().filter(|benchmark| names.is_empty() || names.iter().any(|name| is(name, benchmark))).collect())
}

/// Computes all pieces of these benchmarks, on all cores.
/// What was found of the benchmarks: of all, or of those that were complete when a signal asked for the end.
fn compute(
    chosen: &[&'static Benchmark],
    size: Size,
) -> Result<Vec<(&'static Benchmark, Vec<Finding>)>, Failure> {
    let pieces: Vec<(usize, Piece)> = (chosen.iter().enumerate())
        .flat_map(|(k, benchmark)| (benchmark.pieces)(size).into_iter().map(move |piece| (k, piece)))
        .collect();
    let of: Vec<usize> = pieces.iter().map(|(k, _)| *k).collect();
    let done: Vec<Option<Result<Finding, Failure>>> = pieces.iter().map(|_| None).collect();
    let done = Arc::new(Mutex::new(done));
    let filled = Arc::clone(&done);
    interrupt::unless_asked(move || {
        parallel(pieces.len(), |k| {
            let (_, piece) = &pieces[k];
            let finding = (piece.work)().map(|finding| Finding { scheme: piece.scheme, ..finding });
            // After an interruption nobody is left to take it.
            if let Some(place) = filled.lock().unwrap_or_else(PoisonError::into_inner).get_mut(k) {
                *place = Some(finding);
            }
        });
    });
    let done = std::mem::take(&mut *done.lock().unwrap_or_else(PoisonError::into_inner));
    let mut found: Vec<_> = chosen.iter().map(|benchmark| Some((*benchmark, Vec::new()))).collect();
    for (k, finding) in of.into_iter().zip(done) {
        match (finding.transpose()?, &mut found[k]) {
            (Some(finding), Some((_, findings))) => findings.push(finding),
            _ => found[k] = None,
        }
    }
    Ok(found.into_iter().flatten().collect())
}

fn rows(found: &[(&Benchmark, Vec<Finding>)]) -> Vec<Row> {
    found.iter().flat_map(|(benchmark, findings)| benchmark::rows(benchmark, findings)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_benchmark_is_within_its_tolerances() {
        let chosen: Vec<&Benchmark> = all().collect();
        let rows = rows(&compute(&chosen, Size::Small).unwrap());
        for row in &rows {
            println!("{} | {} | {:.3e} | {:.3e}", row.name, row.quantity, row.computed, row.tolerance);
        }
        let failing: Vec<&Row> = rows.iter().filter(|row| !row.pass()).collect();
        assert!(failing.is_empty(), "{failing:#?}");
    }
}
