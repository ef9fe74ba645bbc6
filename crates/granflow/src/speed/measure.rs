//! How long steps take.

use super::Load;
use crate::simulation::Failure;
use std::time::{Duration, Instant};

/// Steps that were timed together.
#[derive(Clone, Copy, Debug, Default)]
pub struct Spell {
    /// Number of steps.
    pub steps: usize,
    /// Seconds on the clock.
    pub wall: f64,
    /// Seconds that all threads of the process were computing, where the system tells and the spell is long enough for it.
    pub computing: Option<f64>,
}

impl Spell {
    /// Updates of a cell per microsecond (10^6 a second); a step of two stages counts once.
    pub fn mcups(&self, cells: usize) -> f64 {
        1e-6 * (self.steps * cells) as f64 / self.wall
    }
}

/// Why steps could not be timed.
#[derive(Debug, thiserror::Error)]
pub enum SpeedError {
    /// A step could not be taken.
    #[error(transparent)]
    Step(#[from] Failure),
    /// The threads could not be started.
    #[error("cannot start {threads} threads: {problem}")]
    Threads {
        /// How many.
        threads: usize,
        /// What the system said.
        problem: String,
    },
}

/// `count` spells of at least `at_least` each on so many threads, from the start of the run and a first step that is not
/// timed; restarts are not timed either.
///
/// # Errors
/// [`SpeedError`].
pub fn spells(
    load: &mut dyn Load,
    threads: usize,
    count: usize,
    at_least: Duration,
) -> Result<Vec<Spell>, SpeedError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|error| SpeedError::Threads { threads, problem: error.to_string() })?;
    let spells = pool.install(|| {
        load.restart()?;
        load.step()?;
        (0..count).map(|_| spell(load, at_least)).collect::<Result<_, Failure>>()
    });
    Ok(spells?)
}

fn spell(load: &mut dyn Load, at_least: Duration) -> Result<Spell, Failure> {
    /// The system's account of a thread lags behind by a tick, some milliseconds.
    const ACCOUNTABLE: f64 = 0.05;
    let mut spell = Spell { computing: Some(0.0), ..Spell::default() };
    while spell.wall < at_least.as_secs_f64() {
        if load.steps_left() == 0 {
            load.restart()?;
        }
        let left = at_least.as_secs_f64() - spell.wall;
        let (before, clock) = (computing(), Instant::now());
        while load.steps_left() > 0 && clock.elapsed().as_secs_f64() < left {
            load.step()?;
            spell.steps += 1;
        }
        let wall = clock.elapsed().as_secs_f64();
        let computed = computing().zip(before).map(|(now, then)| now - then);
        spell.computing = spell.computing.zip(computed.filter(|_| wall > ACCOUNTABLE)).map(|(a, b)| a + b);
        spell.wall += wall;
    }
    Ok(spell)
}

/// Seconds that the threads of this process have been computing so far.
fn computing() -> Option<f64> {
    let mut sum = 0.0;
    for task in std::fs::read_dir("/proc/self/task").ok()? {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        sum += 1e-9 * text.split_whitespace().next()?.parse::<f64>().ok()?;
    }
    Some(sum)
}

/// The middle one of the values, or the mean of the two in the middle; NaN of none.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => f64::NAN,
        n => 0.5 * (values[(n - 1) / 2] + values[n / 2]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::{SimdLevel, Traffic};

    /// Takes 2 ms a step and 300 ms to restart after three.
    struct Clockwork(usize);

    impl Load for Clockwork {
        fn cells(&self) -> usize {
            1
        }
        fn step(&mut self) -> Result<(), Failure> {
            self.0 -= 1;
            std::thread::sleep(Duration::from_millis(2));
            Ok(())
        }
        fn steps_left(&self) -> usize {
            self.0
        }
        fn restart(&mut self) -> Result<(), Failure> {
            std::thread::sleep(Duration::from_millis(300));
            self.0 = 3;
            Ok(())
        }
        fn traffic(&self) -> Traffic {
            Traffic { read: 0.0, written: 0.0, allocated: 0.0 }
        }
        fn use_simd(&mut self, _instructions: SimdLevel) {}
    }

    #[test]
    fn a_spell_is_long_enough_and_knows_nothing_of_restarts() {
        let found = spells(&mut Clockwork(0), 1, 2, Duration::from_millis(10)).unwrap();
        assert_eq!(found.len(), 2);
        for spell in found {
            assert!(spell.wall >= 0.01 && (1..=5).contains(&spell.steps), "{spell:?}");
            // Sleep may be late, but not by as much as a third of a restart.
            assert!((0.002..0.1).contains(&(spell.wall / spell.steps as f64)), "{spell:?}");
            assert_eq!(spell.mcups(3_000_000), 3.0 * spell.steps as f64 / spell.wall);
        }
    }

    #[test]
    fn the_median_is_the_middle() {
        assert_eq!(median([3.0, 1.0, 9.0]), 3.0);
        assert_eq!(median([4.0, 1.0, 2.0, 9.0]), 3.0);
        assert!(median([]).is_nan());
    }
}
