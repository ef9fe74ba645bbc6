//! Instructions of a cell update, counted by valgrind: the same on a busy machine as on an idle one.
//!
//! `.ci/instructions` counts, and fails where a number differs by more than 2 % from `instructions.txt`, up or down;
//! `.ci/instructions --record` writes that file. valgrind knows no AVX-512: what is counted are the lanes of AVX2.

use granflow::models::setups;
use granflow::speed::{Extent, Setup};
use std::path::Path;
use std::process::{Command, ExitCode};

/// What is counted.
const COUNTED: [&str; 8] = [
    "energy_stable",
    "energy_stable_terrain",
    "energy_stable_2_terrain",
    "balanced",
    "balanced_terrain",
    "verfahren_5",
    "balanced_2",
    "first_order",
];
/// Cells along each axis: whole tiles, as most tiles of a large grid are.
const CELLS: usize = 120;
/// Steps of the shorter run; the longer has twice as many, and their difference knows nothing of the start.
const STEPS: u64 = 7;
/// Allowed difference to what is recorded.
const BOUND: f64 = 0.02;
const RECORD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/instructions.txt");

type Trouble = Box<dyn std::error::Error>;

fn main() -> Result<ExitCode, Trouble> {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    match words.as_slice() {
        [] => compare(),
        ["--record"] => record(),
        ["steps", name, steps] => {
            take(setup(name)?, steps.parse()?)?;
            Ok(ExitCode::SUCCESS)
        }
        other => Err(format!("{other:?}: nothing, or --record").into()),
    }
}

fn setup(name: &str) -> Result<&'static Setup, Trouble> {
    setups().find(|setup| setup.name == name).ok_or_else(|| format!("there is no setup {name}").into())
}

/// Take steps on one thread.
fn take(setup: &Setup, steps: u64) -> Result<(), Trouble> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    Ok(pool.install(|| {
        let mut load = setup.start(Extent { cells: CELLS, wet: 1.0 });
        (0..steps).try_for_each(|_| load.step())
    })?)
}

/// Instructions that this program executes for so many steps of a setup.
fn count(name: &str, steps: u64) -> Result<f64, Trouble> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(std::env::current_exe()?)
        .args(["steps", name, &steps.to_string()])
        .output()
        .map_err(|error| format!("cannot start valgrind: {error}"))?;
    let said = String::from_utf8_lossy(&output.stderr);
    let collected = said.lines().find_map(|line| line.split_once("Collected :"));
    match collected {
        Some((_, number)) if output.status.success() => Ok(number.trim().parse()?),
        _ => Err(format!("valgrind counted nothing: {said}").into()),
    }
}

/// Instructions of a cell update.
fn cost(name: &str) -> Result<f64, Trouble> {
    let cells = CELLS.pow(setup(name)?.dimensions as u32) as f64;
    Ok((count(name, 2 * STEPS)? - count(name, STEPS)?) / (STEPS as f64 * cells))
}

/// The compiler and the target, without which a record means nothing.
fn tools() -> Result<String, Trouble> {
    let output = Command::new("rustc").arg("--version").output()?;
    let version = String::from_utf8(output.stdout)?;
    Ok(format!("{} on {}", version.trim(), std::env::consts::ARCH))
}

fn record() -> Result<ExitCode, Trouble> {
    let mut text = format!(
        "# Instructions of a cell update, AVX2, {CELLS} x {CELLS} cells; written by `.ci/instructions --record`.\n# {}\n",
        tools()?
    );
    for name in COUNTED {
        let line = format!("{name} {:.1}\n", cost(name)?);
        print!("{line}");
        text += &line;
    }
    std::fs::write(RECORD, text)?;
    println!("recorded in {RECORD}");
    Ok(ExitCode::SUCCESS)
}

fn compare() -> Result<ExitCode, Trouble> {
    let text = std::fs::read_to_string(Path::new(RECORD))
        .map_err(|error| format!("{RECORD}: {error}; `.ci/instructions --record` writes it"))?;
    let tools = tools()?;
    let recorded = |name: &str| -> Result<f64, Trouble> {
        let line = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' '));
        Ok(line.ok_or_else(|| format!("{RECORD} has no {name}; `.ci/instructions --record`"))?.parse()?)
    };
    println!("{:18} {:>9} {:>9}", "a cell update", "recorded", "now");
    let mut differs = false;
    for name in COUNTED {
        let (before, now) = (recorded(name)?, cost(name)?);
        let change = now / before - 1.0;
        let verdict = match change {
            change if change > BOUND => "costs more: find out why; if it is meant, record it and say why",
            change if change < -BOUND => "a gain: record it, so that the next change is held against it",
            _ => "",
        };
        differs |= !verdict.is_empty();
        println!("{name:18} {before:9.1} {now:9.1} {:+7.1} %  {verdict}", 100.0 * change);
    }
    if !differs {
        return Ok(ExitCode::SUCCESS);
    }
    if !text.lines().any(|line| line == format!("# {tools}")) {
        println!("recorded by other tools than {tools}: the bound is not held; record again");
        return Ok(ExitCode::SUCCESS);
    }
    println!("more than {:.0} %; `.ci/instructions --record` records", 100.0 * BOUND);
    Ok(ExitCode::FAILURE)
}
