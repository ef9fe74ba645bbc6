//! Reads changed inputs until so many are read, and reports those that panic, hang or take too much memory.

use crate::MEMORY;
use crate::mutate::{Dice, mutated};
use crate::readers::Reader;
use std::io::{Seek, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// How long one input may take.
const LONGEST: Duration = Duration::from_secs(10);
/// What any input may take, and how many times its own size more \[bytes\].
const MEMORY_LEAST: usize = 256 << 20;
const MEMORY_FACTOR: usize = 65_536;

/// When a campaign ends.
#[derive(Debug, Clone, Copy)]
pub enum Until {
    /// After so many inputs.
    Inputs(usize),
    /// After so long.
    Time(Duration),
}

/// What a campaign came to.
#[derive(Debug, Default)]
pub struct Outcome {
    /// Inputs read.
    pub inputs: usize,
    /// Where the inputs that failed were kept, with what happened.
    pub failures: Vec<(PathBuf, String)>,
}

/// Where inputs that failed before are kept.
fn corpus(reader: &Reader) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(reader.name)
}

/// Reads the corpus and the seeds of a reader, then changed ones; the same inputs for the same `seed`.
pub fn campaign(reader: &Reader, until: Until, seed: u64) -> std::io::Result<Outcome> {
    let mut seeds = (reader.seeds)();
    if let Ok(folder) = std::fs::read_dir(corpus(reader)) {
        let mut paths: Vec<PathBuf> = folder.flatten().map(|entry| entry.path()).collect();
        paths.sort();
        seeds.extend(paths.iter().map(std::fs::read).collect::<Result<Vec<_>, _>>()?);
    }
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/fuzz");
    std::fs::create_dir_all(&kept)?;
    let mut last = std::fs::File::create(kept.join(reader.name))?;
    let mut dice = Dice(seed);
    let begun = Instant::now();
    let mut outcome = Outcome::default();
    loop {
        let bytes = match seeds.get(outcome.inputs) {
            Some(bytes) => bytes.clone(),
            None => mutated(&seeds, &mut dice),
        };
        // Where the process is killed, this is what it read.
        last.rewind()?;
        last.write_all(&bytes)?;
        last.set_len(bytes.len() as u64)?;
        if let Err(problem) = once(reader, &bytes) {
            let path = kept.join(format!("{}-{}", reader.name, outcome.failures.len()));
            std::fs::write(&path, &bytes)?;
            outcome.failures.push((path, problem));
        }
        outcome.inputs += 1;
        let done = match until {
            Until::Inputs(inputs) => outcome.inputs >= inputs,
            Until::Time(time) => outcome.inputs >= seeds.len() && begun.elapsed() >= time,
        };
        if done || outcome.failures.len() >= 20 {
            return Ok(outcome);
        }
    }
}

/// Reads one input.
///
/// # Errors
/// That it panicked, and how; that it took too long or too much memory.
pub fn once(reader: &Reader, bytes: &[u8]) -> Result<(), String> {
    let (begun, before, highest) = (Instant::now(), MEMORY.allocated(), MEMORY.max_allocated());
    let done = catch_unwind(AssertUnwindSafe(|| (reader.read)(bytes)));
    if let Err(panic) = done {
        let text = panic.downcast_ref::<String>().cloned();
        let text = text.or(panic.downcast_ref::<&str>().map(|text| (*text).to_owned()));
        return Err(format!("it panicked: {}", text.unwrap_or_default()));
    }
    let (took, now) = (begun.elapsed(), MEMORY.max_allocated());
    // The allocator knows the highest amount since the program began; a smaller one was allowed before.
    let memory = if now > highest { now.saturating_sub(before) } else { 0 };
    if memory > MEMORY_LEAST + MEMORY_FACTOR * bytes.len() {
        return Err(format!("{} bytes took {} MiB", bytes.len(), memory >> 20));
    }
    if took > LONGEST {
        return Err(format!("it took {took:.1?}"));
    }
    Ok(())
}
