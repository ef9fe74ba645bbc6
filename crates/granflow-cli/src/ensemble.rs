//! `granflow ensemble` and `granflow merge`: many runs of one case, on one machine or on many.

use std::io::{self, IsTerminal};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::{Duration, Instant};

use clap::Args;
use granflow::Case;
use granflow::ensemble::{Done, Ensemble, EnsembleError, Options, Progress, case_of_part};

use crate::failure::{Failure, print, tell};
use crate::interrupt;
use crate::progress::LongWork;
use crate::run::{SET_UP, command};

/// Between two lines of progress.
const PAUSE: Duration = Duration::from_secs(5);
/// Members that failed of which a line is told.
const TOLD: usize = 10;

/// What the command line says about an ensemble.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The case file, with a table [ensemble]
    #[arg(value_name = "CASE.toml")]
    case: PathBuf,
    /// Computes these members only, the first one and the one after the last, from 0; what the folder has counts too
    #[arg(long, value_name = "FROM..TO", conflicts_with = "part")]
    members: Option<Members>,
    /// Computes one of several equal parts and writes it as a file for `granflow merge`
    #[arg(long, value_name = "K/N")]
    part: Option<Part>,
    /// Where the results go, or the part
    #[arg(long, value_name = "DIR", default_value = "ensemble")]
    out: PathBuf,
    /// Changes a key of the case; may be repeated
    #[arg(long, value_name = "key.path=value")]
    set: Vec<String>,
    /// Members computed at a time, one thread each (default: all cores)
    #[arg(long, value_name = "N")]
    threads: Option<std::num::NonZeroUsize>,
    /// Goes on from what is in the folder, or says why that cannot be; without it other files there are moved into previous/
    #[arg(long)]
    resume: bool,
    /// Writes the peaks of each member too, members/N.nc
    #[arg(long)]
    keep_members: bool,
    /// No progress
    #[arg(long, short)]
    quiet: bool,
}

/// What the command line says about parts to be put together.
#[derive(Debug, Args)]
pub struct MergeArguments {
    /// The parts, all of one ensemble; they know their case
    #[arg(required = true, value_name = "PART")]
    parts: Vec<PathBuf>,
    /// Where the results go
    #[arg(long, value_name = "DIR", default_value = "ensemble")]
    out: PathBuf,
    /// Where the case is now, if the files that it names are no longer where the parts were computed
    #[arg(long, value_name = "CASE.toml")]
    case: Option<PathBuf>,
    /// No notes
    #[arg(long, short)]
    quiet: bool,
}

/// Members from one to another, as in `200..400`.
#[derive(Debug, Clone, PartialEq)]
struct Members(Range<u32>);

impl FromStr for Members {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once("..").and_then(|(from, to)| Some(from.parse().ok()?..to.parse().ok()?));
        match numbers.filter(|range: &Range<u32>| range.start < range.end) {
            Some(range) => Ok(Self(range)),
            None => Err("write the first member and the one after the last, as in 200..400".to_owned()),
        }
    }
}

/// A part of several, as in `3/16`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Part([u32; 2]);

impl FromStr for Part {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let numbers =
            text.split_once('/').and_then(|(one, all)| Some([one.parse().ok()?, all.parse().ok()?]));
        match numbers.filter(|[one, all]| (1..=*all).contains(one)) {
            Some(part) => Ok(Self(part)),
            None => Err("write which part of how many, from 1, as in 3/16".to_owned()),
        }
    }
}

/// Computes an ensemble or a part of it.
pub fn ensemble(arguments: &Arguments) -> Result<(), Failure> {
    let case = Case::read_with(&arguments.case, &arguments.set)?;
    let ensemble = begin(&case, arguments.quiet)?;
    let all = ensemble.plan().members;
    let members = arguments.members.clone().map_or(0..all, |members| members.0);
    if members.end > all {
        let message = format!("--members {}..{}: the case has {all} members", members.start, members.end);
        return Err(Failure::usage(message, "take a range within them, or set ensemble.members"));
    }
    let stop = interrupt::listen()?;
    let mut shown = Shown::new(arguments.quiet);
    let mut options = options(&arguments.out, arguments.quiet);
    options.members = members;
    options.workers = arguments.threads.map_or(0, std::num::NonZeroUsize::get);
    (options.resume, options.keep_members) = (arguments.resume, arguments.keep_members);
    if let Some(Part([number, count])) = arguments.part {
        if arguments.keep_members {
            let message = "--keep-members: a part is one file and keeps sums, not members";
            return Err(Failure::usage(message, "leave it out, or compute the members without --part"));
        }
        if count > all {
            let message = format!("--part {number}/{count}: the case has only {all} members");
            return Err(Failure::usage(message, "take at most as many parts as members"));
        }
        return match ensemble
            .into_part([number, count], &options, stop, &mut |progress| shown.show(progress))?
        {
            Some(path) => print(&format!("{}\n", path.display())),
            None => Err(Failure::Interrupted(format!("part {number} of {count}; the same command goes on"))),
        };
    }
    let begun = Instant::now();
    let done = ensemble.into_folder(&options, stop, &mut |progress| shown.show(progress))?;
    if done.missing > 0 {
        let message = format!("{} members are still to be computed; the same command goes on", done.missing);
        return Err(Failure::Interrupted(message));
    }
    finish(&ensemble, &done, &options, begun.elapsed(), arguments.quiet)
}

/// Puts parts together.
pub fn merge(arguments: &MergeArguments) -> Result<(), Failure> {
    let case = case_of_part(&arguments.parts[0], arguments.case.as_deref())?;
    let ensemble = begin(&case, arguments.quiet).inspect_err(|_| {
        if arguments.case.is_none() {
            let name = case.source_name();
            tell(&format!("note: the case of the parts was {name}; --case CASE.toml says where it is now\n"));
        }
    })?;
    let options = options(&arguments.out, arguments.quiet);
    let begun = Instant::now();
    let done = ensemble.merge(&arguments.parts, &options)?;
    finish(&ensemble, &done, &options, begun.elapsed(), arguments.quiet)
}

/// Sets the case up once.
fn begin(case: &Case, quiet: bool) -> Result<Ensemble, Failure> {
    let work = LongWork::new(quiet, SET_UP);
    let ensemble = Ensemble::of(case)?;
    drop(work);
    if !quiet {
        ensemble.plane().domain.remarks().iter().for_each(|remark| tell(&format!("{remark}\n")));
    }
    Ok(ensemble)
}

fn options(out: &Path, quiet: bool) -> Options {
    Options {
        directory: out.to_owned(),
        members: 0..0,
        workers: 0,
        resume: false,
        keep_members: false,
        command: command(),
        notice: if quiet { |_| () } else { |text| tell(&format!("note: {text}\n")) },
    }
}

/// Says which members failed, and in one line what was done.
fn finish(
    ensemble: &Ensemble,
    done: &Done,
    options: &Options,
    wall: Duration,
    quiet: bool,
) -> Result<(), Failure> {
    let failed = done.reduced.failures().count();
    for (number, failure) in done.reduced.failures().take(TOLD) {
        let values = ensemble.sample(number).overrides.join(" ");
        let seed = ensemble.plan().seed;
        tell(&format!("warning: member {number} (seed {seed}, {values}) failed: {failure}\n"));
    }
    if failed > TOLD {
        tell(&format!("warning: {} more members failed; members.csv names them\n", failed - TOLD));
    }
    let (computed, place) = (done.reduced.computed(), options.directory.display());
    let steps = match done.stepping_seconds {
        0.0 => String::new(),
        seconds => format!(", {seconds:.2} s in steps"),
    };
    let line = format!(
        "{computed} members computed, {failed} failed: {place} ({:.2} s{steps})\n",
        wall.as_secs_f64()
    );
    if quiet { Ok(()) } else { print(&line) }
}

/// Progress on standard error: a line in place on a terminal, one every few seconds elsewhere.
struct Shown {
    quiet: bool,
    terminal: bool,
    begun: Instant,
    first: Option<usize>,
    shown: Option<Instant>,
}

impl Shown {
    fn new(quiet: bool) -> Self {
        let terminal = io::stderr().is_terminal();
        Self { quiet, terminal, begun: Instant::now(), first: None, shown: None }
    }

    fn show(&mut self, progress: Progress) {
        let Progress { done, wanted, failed, .. } = progress;
        let first = *self.first.get_or_insert(done);
        let pause = if self.terminal { PAUSE / 50 } else { PAUSE };
        let last = done == wanted;
        if self.quiet || (!last && self.shown.is_some_and(|shown| shown.elapsed() < pause)) {
            return;
        }
        self.shown = Some(Instant::now());
        let failed = if failed > 0 { format!(", {failed} failed") } else { String::new() };
        let each = self.begun.elapsed().as_secs_f64() / (done - first).max(1) as f64;
        let left = match done > first && !last {
            true => format!(", about {:.0} s left", each * (wanted - done) as f64),
            false => String::new(),
        };
        let line = format!("{done} of {wanted} members{failed}{left}");
        match self.terminal {
            true => crate::failure::send(&format!("\r\x1b[2K{line}{}", if last { "\n" } else { "" })),
            false => tell(&format!("{line}\n")),
        }
    }
}

impl From<EnsembleError> for Failure {
    fn from(error: EnsembleError) -> Self {
        match error {
            EnsembleError::Case(error) => error.into(),
            EnsembleError::Start(error) => error.into(),
            EnsembleError::Output(_) | EnsembleError::Raster(_) | EnsembleError::Figure(_) => {
                Self::File(error.to_string())
            }
            EnsembleError::Parts(message) => {
                Self::usage(message, "granflow merge PART ... takes every part of one ensemble once")
            }
            EnsembleError::Threads(_) => Self::usage(error.to_string(), "try a smaller --threads"),
            EnsembleError::AllFailed { .. } => Self::Computation(error.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_and_parts_are_read_or_refused() {
        assert_eq!("200..400".parse(), Ok(Members(200..400)));
        assert_eq!("3/16".parse(), Ok(Part([3, 16])));
        for wrong in ["", "3", "..", "4..4", "5..2", "-1..3", "a..b"] {
            assert!(wrong.parse::<Members>().is_err(), "{wrong}");
        }
        for wrong in ["", "3", "0/4", "5/4", "1/0", "1/a"] {
            assert!(wrong.parse::<Part>().is_err(), "{wrong}");
        }
    }
}
