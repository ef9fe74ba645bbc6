//! `granflow bench`: what a step of each scheme costs on this machine.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Duration;

use granflow::case::nearest;
use granflow::models::setups;
use granflow::simulation::SimdLevel;
use granflow::speed::{Extent, Setup, SpeedError, Triad, spells};

use crate::failure::{Failure, print};
use crate::interrupt;

mod beside;
mod report;

use beside::{When, yardsticks};
use report::{Report, Row};

/// Cells along each axis, in one dimension and in two, unless the user says.
const CELLS: [usize; 2] = [100_000, 2000];
/// Fewer have no inside.
const LEAST_CELLS: usize = 8;
/// More threads than this only wait for each other.
const MOST_THREADS: usize = 1024;
/// No setup takes more for a cell: on terrain 32 of the ground and 8 of the elevation it comes from; the state now, next, at
/// the start, and once more while a run restarts, three numbers of 8 each; and what is kept of a tile.
const BYTES_PER_CELL: f64 = (32 + 8 + 4 * 24 + 2) as f64;

/// What the command line says.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// A scheme to measure; may be repeated (default: all)
    #[arg(long, value_name = "NAME")]
    scheme: Vec<String>,
    /// Cells along each axis; may be repeated (default: 2000, in one dimension 100000)
    #[arg(long, value_name = "N")]
    cells: Vec<usize>,
    /// Number of threads; may be repeated (default: 1, and all cores)
    #[arg(long, value_name = "N")]
    threads: Vec<NonZeroUsize>,
    /// Share of the grid that is wet; the rest is dry and sleeps
    #[arg(long, value_name = "SHARE", default_value_t = 1.0)]
    wet: f64,
    /// The vectors to compute with: widest, narrow (no wider than AVX2), scalar
    #[arg(long, value_name = "NAME", default_value = "widest")]
    instructions: String,
    /// A try: short repeats and small arrays, rough numbers
    #[arg(long)]
    quick: bool,
    /// Writes all numbers to this file too, again after every row
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// A program to compare with, run before and after; prints lines `threads=T NAME NxN Mcups X`
    #[arg(long, value_name = "COMMAND")]
    beside: Option<String>,
}

/// What is measured, in order, and how.
struct Plan {
    setups: Vec<&'static Setup>,
    cells: Vec<usize>,
    threads: Vec<usize>,
    instructions: SimdLevel,
}

/// Measures and prints a table, row by row.
pub fn bench(options: &Options) -> Result<(), Failure> {
    let plan = plan(options)?;
    interrupt::listen()?;
    let mut report = Report::new(options.json.clone(), plan.instructions, options.wet, options.quick);
    report.save()?;
    if let Some(command) = &options.beside {
        match yardsticks(command, When::Before)? {
            Some(found) => report.yardsticks = found,
            None => return Err(report.interrupted()),
        }
    }
    let (numbers, passes) = if options.quick { (1 << 21, 5) } else { (Triad::beyond_caches(), 11) };
    let mut triad = Triad::new(numbers);
    report.array = triad.size();
    report.triad = plan.threads.iter().map(|&threads| (threads, triad.bandwidth(threads, passes))).collect();
    drop(triad);
    print(&report.head())?;
    let (repeats, seconds) = if options.quick { (3, 0.02) } else { (5, 0.3) };
    for setup in plan.setups {
        for cells in sizes(setup, &plan.cells) {
            let mut load = setup.start(Extent { cells, wet: options.wet });
            load.use_simd(plan.instructions);
            for &threads in &plan.threads {
                if interrupt::is_asked() {
                    return Err(report.interrupted());
                }
                let spells = spells(load.as_mut(), threads, repeats, Duration::from_secs_f64(seconds));
                let row = Row::new(setup, cells, threads, load.as_ref(), &spells?);
                print(&report.add(row))?;
                report.save()?;
            }
        }
    }
    if let Some(command) = &options.beside {
        match yardsticks(command, When::After)? {
            Some(found) => report.yardsticks.extend(found),
            None => return Err(report.interrupted()),
        }
        print(&report.ratios())?;
    }
    report.complete = true;
    report.save()
}

impl From<SpeedError> for Failure {
    fn from(error: SpeedError) -> Self {
        match error {
            SpeedError::Step(_) => Failure::Computation(error.to_string()),
            SpeedError::Threads { .. } => Failure::usage(error.to_string(), "try a smaller --threads"),
        }
    }
}

/// Cells along each axis of a setup.
fn sizes(setup: &Setup, asked: &[usize]) -> Vec<usize> {
    if asked.is_empty() { vec![CELLS[setup.dimensions - 1]] } else { asked.to_vec() }
}

/// Checks everything that can be wrong before work starts.
fn plan(options: &Options) -> Result<Plan, Failure> {
    let setups = match options.scheme.as_slice() {
        [] => setups().filter(|setup| setup.dry || options.wet == 1.0).collect(),
        names => names.iter().map(|name| named(name)).collect::<Result<_, _>>()?,
    };
    let instructions = match options.instructions.as_str() {
        "widest" => SimdLevel::Best,
        "narrow" => SimdLevel::Avx2,
        "scalar" => SimdLevel::Scalar,
        other => {
            let message = format!("there are no instructions `{other}`");
            return Err(Failure::usage(message, "allowed: widest, narrow, scalar"));
        }
    };
    if !(options.wet > 0.0 && options.wet <= 1.0) {
        let message = format!("a share of {} cannot be wet", options.wet);
        return Err(Failure::usage(message, "allowed: above 0, up to 1"));
    }
    let all = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let mut threads: Vec<usize> = options.threads.iter().map(|threads| threads.get()).collect();
    if threads.is_empty() {
        threads = vec![1, all];
        threads.dedup();
    }
    if let Some(many) = threads.iter().find(|threads| **threads > MOST_THREADS) {
        return Err(Failure::usage(
            format!("{many} threads are more than {MOST_THREADS}"),
            format!("this machine has {all} cores"),
        ));
    }
    let plan = Plan { setups, cells: options.cells.clone(), threads, instructions };
    for setup in &plan.setups {
        if !setup.dry && options.wet < 1.0 {
            let message = format!("{} is not positive beside dry cells", setup.name);
            return Err(Failure::usage(message, "leave it out, or --wet"));
        }
        for cells in sizes(setup, &plan.cells) {
            fits(setup, cells)?;
        }
    }
    Ok(plan)
}

fn named(name: &str) -> Result<&'static Setup, Failure> {
    setups().find(|setup| setup.name == name).ok_or_else(|| {
        let names = || setups().map(|setup| setup.name);
        let near = nearest(name, names()).map(|near| format!("did you mean `{near}`? ")).unwrap_or_default();
        Failure::usage(
            format!("there is no scheme `{name}` to measure"),
            format!("{near}allowed: {}; none for all", names().collect::<Vec<_>>().join(", ")),
        )
    })
}

/// Are there neither too few cells nor too many for the memory that is free?
fn fits(setup: &Setup, cells: usize) -> Result<(), Failure> {
    if cells < LEAST_CELLS {
        let message = format!("{cells} cells along an axis are too few");
        return Err(Failure::usage(message, format!("allowed: {LEAST_CELLS} and more")));
    }
    let needed = BYTES_PER_CELL * (cells as f64).powi(setup.dimensions as i32);
    let free = free_memory().unwrap_or(f64::from(u32::MAX) * 1024.0);
    if needed > free {
        return Err(Failure::usage(
            format!(
                "{} on {cells} cells along each axis needs about {:.1} GB, {:.1} GB are free",
                setup.name,
                1e-9 * needed,
                1e-9 * free
            ),
            "try fewer --cells",
        ));
    }
    Ok(())
}

/// Bytes of memory that are free, where the system tells.
fn free_memory() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    line.split_whitespace().next()?.parse::<f64>().ok().map(|kib| 1024.0 * kib)
}
