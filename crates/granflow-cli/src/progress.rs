//! Progress on standard error: a bar on a terminal, plain lines every few seconds elsewhere.

use std::io::{self, IsTerminal};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

use granflow::Words;
use granflow::run::Run;

use crate::failure::{send, tell};
use crate::plain::plain;

/// Between two plain lines.
const PLAIN: Duration = Duration::from_secs(5);
/// Between two looks at the clock that redraw the bar.
const BAR: Duration = Duration::from_millis(100);
/// Letters of the bar.
const WIDTH: usize = 24;

/// Where a run is.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Status {
    /// Simulated time.
    time: f64,
    /// Simulated time at which the run ends at the latest, if it is known.
    end: Option<f64>,
    /// Steps done.
    step: u64,
    /// Cells with a depth at the last line of the ledger.
    wet_cells: usize,
    /// Largest speed of a cell, or what the model shows in its place.
    fastest: f64,
    /// How the model calls the two.
    words: Words,
}

impl Status {
    /// The share of the run that is done, if its end is known.
    fn share(&self) -> Option<f64> {
        let end = self.end.filter(|end| *end > 0.0)?;
        Some((self.time / end).clamp(0.0, 1.0))
    }

    /// One line of words and numbers; `elapsed` is the wall time since `begin`, the share at the start.
    fn line(&self, begin: f64, elapsed: Duration) -> String {
        let Self { time, end, step, wet_cells, fastest, words: Words { wet, fastest: name } } = self;
        let end = end.map(|end| format!(" of {end:.4}")).unwrap_or_default();
        let left = self
            .left(begin, elapsed)
            .map(|left| format!(", at most {} left", duration(left)))
            .unwrap_or_default();
        format!("time {time:.4}{end}, step {step}, {wet_cells} {wet}, {name} {fastest:.3e}{left}")
    }

    /// Wall time left if the rest goes as fast as what was done.
    fn left(&self, begin: f64, elapsed: Duration) -> Option<Duration> {
        let done = self.share()? - begin;
        let left = elapsed.as_secs_f64() * (1.0 - begin - done) / done;
        Duration::try_from_secs_f64(left).ok()
    }
}

/// A wall time in words.
fn duration(time: Duration) -> String {
    let seconds = time.as_secs();
    match seconds {
        0..60 => format!("{seconds} s"),
        60..3600 => format!("{} min {:02} s", seconds / 60, seconds % 60),
        _ => format!("{} h {:02} min", seconds / 3600, seconds / 60 % 60),
    }
}

/// Where the status is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Shown {
    Bar,
    Lines,
    Nowhere,
}

/// Shows a run's status while it works.
#[derive(Debug)]
pub struct Progress {
    how: Shown,
    end: Option<f64>,
    start: Instant,
    begin: Option<f64>,
    shown: Option<Instant>,
}

impl Progress {
    /// A bar if standard error is a terminal, plain lines if not, nothing if `quiet`; the run ends at time `end` at the
    /// latest.
    pub fn new(quiet: bool, end: Option<f64>) -> Self {
        let how = match (quiet, io::stderr().is_terminal()) {
            (true, _) => Shown::Nowhere,
            (false, true) => Shown::Bar,
            (false, false) => Shown::Lines,
        };
        Self { how, end, start: Instant::now(), begin: None, shown: None }
    }

    /// Shows where a run is, if it is time to.
    pub fn show(&mut self, run: &dyn Run) {
        self.show_status(&Status {
            time: run.time(),
            end: self.end,
            step: run.steps(),
            wet_cells: run.record().wet_cells,
            fastest: run.stepper().speed(),
            words: run.plane().model().words,
        });
    }

    fn show_status(&mut self, status: &Status) {
        let pause = if self.how == Shown::Bar { BAR } else { PLAIN };
        let begin = *self.begin.get_or_insert(status.share().unwrap_or(0.0));
        if self.shown.is_some_and(|shown| shown.elapsed() < pause) {
            return;
        }
        self.shown = Some(Instant::now());
        let line = status.line(begin, self.start.elapsed());
        match self.how {
            Shown::Bar => send(&bar(status.share().unwrap_or(0.0), &plain(&line))),
            Shown::Lines => tell(&format!("{line}\n")),
            Shown::Nowhere => {}
        }
    }

    /// Takes the bar away; the lines that follow stand alone.
    pub fn finish(&self) {
        if self.how == Shown::Bar && self.shown.is_some() {
            send(CLEAR);
        }
    }
}

/// Says what takes long, once it has taken two seconds; dropped when it is done.
#[derive(Debug)]
pub struct LongWork {
    /// The thread that waits hears when this is dropped.
    _until: Option<Sender<()>>,
}

impl LongWork {
    /// Begins to wait; `what` is said after the word "still", as in "reading the files".
    pub fn new(quiet: bool, what: &'static str) -> Self {
        const PATIENCE: Duration = Duration::from_secs(2);
        let (done, waiting) = channel::<()>();
        let wait = move || {
            if waiting.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                tell(&format!("still {what}\n"));
            }
        };
        // Without a thread nothing is said, and nothing else is lost.
        let begun = !quiet && thread::Builder::new().spawn(wait).is_ok();
        LongWork { _until: begun.then_some(done) }
    }
}

/// Begins the line of a terminal again, empty.
const CLEAR: &str = "\r\x1b[2K";

/// The line of a bar in place of the one before, cut at the terminal's edge: wrapping is off while it is written.
fn bar(share: f64, line: &str) -> String {
    let full = (share * WIDTH as f64) as usize;
    let [full, empty] = ["█".repeat(full), "░".repeat(WIDTH - full)];
    format!("{CLEAR}\x1b[?7l{full}{empty} {:>3.0} % {line}\x1b[?7h", 100.0 * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOW: Words = Words { wet: "wet cells", fastest: "speed" };
    const SAND: Words = Words { wet: "cells with sand", fastest: "rolling layer at most" };

    #[test]
    fn the_line_says_where_the_run_is() {
        let status =
            Status { time: 2.5, end: Some(10.0), step: 250, wet_cells: 40, fastest: 1.25, words: FLOW };
        let line = status.line(0.0, Duration::from_secs(30));
        assert_eq!(
            line,
            "time 2.5000 of 10.0000, step 250, 40 wet cells, speed 1.250e0, at most 1 min 30 s left"
        );
        let open = Status { end: None, ..status };
        assert_eq!(
            open.line(0.0, Duration::from_secs(30)),
            "time 2.5000, step 250, 40 wet cells, speed 1.250e0"
        );
        let pile = Status { words: SAND, ..open };
        assert_eq!(
            pile.line(0.0, Duration::from_secs(30)),
            "time 2.5000, step 250, 40 cells with sand, rolling layer at most 1.250e0"
        );
        let resumed = status.left(0.2, Duration::from_secs(10));
        assert_eq!(resumed.map(|left| left.as_secs()), Some(150), "only the part of this session counts");
        let first = Status { time: 0.0, ..status };
        assert_eq!(first.left(0.0, Duration::from_secs(1)), None);
        assert_eq!(duration(Duration::from_secs(7265)), "2 h 01 min");
    }

    #[test]
    fn the_bar_fills_and_is_redrawn_in_place() {
        let half = bar(0.5, "time 1");
        assert!(
            half.starts_with(CLEAR) && half.contains("████████████░░░░░░░░░░░░  50 % time 1"),
            "{half:?}"
        );
        let full = bar(1.0, "");
        assert!(full.contains(&"█".repeat(WIDTH)) && !full.contains('░') && !full.contains('\n'), "{full:?}");
    }
}
