//! An ensemble on the cores of one machine: one thread a member.

use super::{Ensemble, EnsembleError, Outcome, Reduced};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// At least so long between two times that what is done is kept, and at least so many times what keeping it took.
const PAUSE: Duration = Duration::from_secs(20);
const RARER: u32 = 50;

/// How far an ensemble is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Members done, also those that failed.
    pub done: usize,
    /// Members that are to be done.
    pub wanted: usize,
    /// Those that failed.
    pub failed: usize,
    /// Seconds in the steps of the members of this run, summed.
    pub stepping_seconds: f64,
}

/// What the workers share.
struct Board<'a> {
    left: std::vec::IntoIter<u32>,
    reduced: Reduced,
    progress: Progress,
    kept: Instant,
    pause: Duration,
    error: Option<EnsembleError>,
    hear: &'a mut (dyn FnMut(Progress, Option<&Outcome>) + Send),
}

impl Ensemble {
    /// Computes those of `members` that `reduced` does not have, each on one thread, `workers` at a time (0: as many as there are
    /// cores). `keep` is given what is done now and then and at the end, `hear` every outcome. Once `stop` is set the members under way are
    /// given up; what is done is returned.
    ///
    /// # Errors
    /// What `keep` could not do; [`EnsembleError::Threads`].
    pub fn run(
        &self,
        members: std::ops::Range<u32>,
        reduced: Reduced,
        workers: usize,
        stop: &AtomicBool,
        keep: &(dyn Fn(&Reduced) -> Result<(), EnsembleError> + Sync),
        hear: &mut (dyn FnMut(Progress, Option<&Outcome>) + Send),
    ) -> Result<Reduced, EnsembleError> {
        let wanted = members.len();
        let left: Vec<u32> = members.filter(|number| !reduced.has(*number)).collect();
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let workers = if workers == 0 { cores } else { workers }.min(left.len().max(1));
        let failed = reduced.failures().count();
        let progress = Progress { done: wanted - left.len(), wanted, failed, stepping_seconds: 0.0 };
        hear(progress, None);
        let (left, kept, pause) = (left.into_iter(), Instant::now(), PAUSE);
        let board = Mutex::new(Board { left, reduced, progress, kept, pause, error: None, hear });
        std::thread::scope(|scope| {
            for number in 0..workers {
                let work = || self.work(&board, stop, keep);
                let started =
                    std::thread::Builder::new().name(format!("member-{number}")).spawn_scoped(scope, work);
                if let Err(error) = started {
                    let mut board = board.lock().unwrap_or_else(PoisonError::into_inner);
                    board.error.get_or_insert(EnsembleError::Threads(error.to_string()));
                }
            }
        });
        let board = board.into_inner().unwrap_or_else(PoisonError::into_inner);
        keep(&board.reduced)?;
        board.error.map_or(Ok(board.reduced), Err)
    }

    /// Takes members from the board until there are none.
    fn work(
        &self,
        board: &Mutex<Board>,
        stop: &AtomicBool,
        keep: &(dyn Fn(&Reduced) -> Result<(), EnsembleError> + Sync),
    ) {
        let lock = || board.lock().unwrap_or_else(PoisonError::into_inner);
        // The inner loops take the threads of the pool that they are called in.
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
        if let Err(error) = alone {
            lock().error.get_or_insert(EnsembleError::Threads(error.to_string()));
            return;
        }
        while !stop.load(Ordering::Relaxed) {
            let next = {
                let mut board = lock();
                if board.error.is_some() { None } else { board.left.next() }
            };
            let Some(outcome) = next.and_then(|number| self.compute(number, stop)) else { return };
            lock().take(outcome, keep);
        }
    }
}

impl Board<'_> {
    /// Adds a member, and keeps what is done if that was long ago.
    fn take(&mut self, outcome: Outcome, keep: &(dyn Fn(&Reduced) -> Result<(), EnsembleError> + Sync)) {
        self.progress.done += 1;
        match &outcome.result {
            Ok(computed) => self.progress.stepping_seconds += computed.stepping_seconds,
            Err(_) => self.progress.failed += 1,
        }
        (self.hear)(self.progress, Some(&outcome));
        self.reduced.add(outcome);
        if self.kept.elapsed() > self.pause {
            let begun = Instant::now();
            if let Err(error) = keep(&self.reduced) {
                self.error.get_or_insert(error);
            }
            self.pause = PAUSE.max(RARER * begun.elapsed());
            self.kept = Instant::now();
        }
    }
}
