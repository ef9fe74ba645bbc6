//! The program `granflow`: where a granular mass comes to rest.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Parser, Subcommand};
use granflow::{Case, Checked};

mod bench;
mod check;
mod compare;
mod demo;
mod ensemble;
mod failure;
mod interrupt;
mod mountain;
mod new;
mod page;
mod plain;
mod plot;
mod progress;
mod reproduce;
mod run;
mod schema;
mod snippet;
mod verify;

use failure::Failure;

const EXAMPLES: &str = "\
Examples:
  granflow demo                          a mountain avalanche that comes to rest, no file needed
  granflow new --list                    the kinds of cases to start from
  granflow new silo                      writes silo.toml, commented
  granflow check silo.toml               what would be computed, and how large it is
  granflow run silo.toml                 writes silo/result.nc, silo/summary.json, silo/figures/
  granflow run silo.toml --set scheme.name=energy_stable --set time.until=rest --out rest

Exit status: 0 done; 1 a row of `granflow verify` fails; 2 bad usage or bad case; 3 the computation failed; 4 a file could not be read or written;
130 interrupted.";

/// Where a granular mass comes to rest: Savage-Hutter avalanches on grids and real terrain, Hadeler-Kuttler sandpiles on tables.
#[derive(Debug, Parser)]
#[command(name = "granflow", version, after_help = EXAMPLES, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Computes a case and writes its results
    #[command(
        after_help = "Ctrl-C, SIGTERM and SIGHUP end at the next step with everything valid and a checkpoint; a second one ends at once. A run locks its folder; what an earlier run left there is moved into previous/."
    )]
    Run {
        /// The case file
        #[arg(value_name = "CASE.toml")]
        case: PathBuf,
        /// Where the results go (default: the case's name)
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Changes a key of the case; may be repeated
        #[arg(long, value_name = "key.path=value")]
        set: Vec<String>,
        /// Number of threads (default: all cores)
        #[arg(long, value_name = "N")]
        threads: Option<std::num::NonZeroUsize>,
        /// Goes on from the last checkpoint of a run that was interrupted, killed, or has ended; with --set to a later end or with other friction
        #[arg(long)]
        resume: bool,
        /// No progress
        #[arg(long, short)]
        quiet: bool,
    },
    /// Computes many runs of a case with some of its values drawn: probabilities, percentiles, tables
    #[command(
        after_help = "The case says under [ensemble] how many members and which values differ. Ctrl-C keeps what is done, and the same command goes on. A member that fails is booked, and the rest goes on; exit status 3 if all fail."
    )]
    Ensemble(ensemble::Arguments),
    /// Puts parts of an ensemble together, which may have been computed on many machines
    #[command(after_help = "The result is the same, bit for bit, as that of one run on one machine.")]
    Merge(ensemble::MergeArguments),
    /// Reads a case and says what would be computed; computes nothing
    Check {
        /// The case file
        #[arg(value_name = "CASE.toml")]
        case: PathBuf,
        /// Changes a key of the case; may be repeated
        #[arg(long, value_name = "key.path=value")]
        set: Vec<String>,
    },
    /// Writes a commented case to start from
    New {
        /// The kind of case; see --list
        kind: Option<String>,
        /// The file to write (default: KIND.toml); an existing one is never overwritten
        file: Option<PathBuf>,
        /// Lists the kinds
        #[arg(long)]
        list: bool,
    },
    /// Computes the tables and figures of the papers, ours beside theirs
    Reproduce {
        /// The paper (default: all)
        paper: Option<String>,
        /// Where the results go
        #[arg(long, value_name = "DIR", default_value = "reproduce")]
        out: PathBuf,
    },
    /// Holds every scheme against known answers: errors, orders, rest, energy, conservation
    #[command(after_help = verify::benchmarks_help())]
    Verify {
        /// The benchmarks (default: all)
        #[arg(value_name = "BENCHMARK")]
        benchmarks: Vec<String>,
        /// One of them; may be given again
        #[arg(long, value_name = "NAME")]
        only: Vec<String>,
        /// Where the results go
        #[arg(long, value_name = "DIR", default_value = "verify")]
        out: PathBuf,
        /// Without the finest grids and with fewer random cases, as the tests do
        #[arg(long)]
        quick: bool,
    },
    /// Draws the figures of finished runs again
    Plot {
        /// Results of finished runs
        #[arg(required = true, value_name = "RESULT.nc")]
        results: Vec<PathBuf>,
        /// Where the figures go (default: figures/ beside each result)
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
    /// Says how well a run meets another one, or what was mapped
    #[command(
        after_help = "B is what A is held against: what only B has is missed, what only A has is false. Differences are A minus B."
    )]
    Compare(compare::Options),
    /// Measures what a step of each scheme costs on this machine
    #[command(
        after_help = "Medians of five repeats of 0.3 s, every cell wet and moving. The triad of the same run says what the memory can do."
    )]
    Bench(bench::Options),
    /// Prints the JSON Schema of the case file
    Schema,
    /// Computes a built-in mountain avalanche to its rest; needs no file
    Demo {
        /// Where the results go
        #[arg(long, value_name = "DIR", default_value = "demo")]
        out: PathBuf,
    },
}

/// Does what a command line asks for, its first word being the name of the program; returns the exit status.
///
/// The program `granflow` is this function, and the script that the Python package installs calls it too. It listens to the signals of
/// the process it runs in.
pub fn run_command_line(words: Vec<OsString>) -> u8 {
    let arguments = match Arguments::try_parse_from(&words) {
        Ok(arguments) => arguments,
        Err(error) => {
            let _ = error.print(); // nobody is left to be told if that fails
            return error.exit_code().try_into().unwrap_or(2);
        }
    };
    interrupt::outlive_limits();
    run::note_command(&words);
    match act(arguments.command) {
        Ok(()) => 0,
        Err(failure) => failure.report(),
    }
}

fn act(command: Command) -> Result<(), Failure> {
    match command {
        Command::Run { case, out, set, threads, resume, quiet } => {
            let case = read(&case, &set)?;
            run::run(case, &run::RunOptions { out, threads, resume, quiet })
        }
        Command::Ensemble(arguments) => ensemble::ensemble(&arguments),
        Command::Merge(arguments) => ensemble::merge(&arguments),
        Command::Check { case, set } => check::check(&Case::read_with(&case, &set)?),
        Command::New { list: true, .. } => new::list(),
        Command::New { kind: None, .. } => {
            Err(Failure::usage("which kind of case?", "granflow new --list shows the kinds"))
        }
        Command::New { kind: Some(kind), file, .. } => new::new(&kind, file),
        Command::Reproduce { paper, out } => reproduce::reproduce(paper.as_deref(), &out),
        Command::Verify { mut benchmarks, only, out, quick } => {
            benchmarks.extend(only);
            verify::verify(&benchmarks, &out, quick)
        }
        Command::Plot { results, out } => plot::plot(&results, out.as_deref()),
        Command::Compare(options) => compare::compare(&options),
        Command::Bench(options) => bench::bench(&options),
        Command::Schema => schema::schema(),
        Command::Demo { out } => demo::demo(&out),
    }
}

/// Reads a case with its overrides and checks it.
fn read(path: &std::path::Path, overrides: &[String]) -> Result<Checked, Failure> {
    Ok(Case::read_with(path, overrides)?.check()?)
}
