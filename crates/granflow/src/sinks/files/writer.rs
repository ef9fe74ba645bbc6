//! The thread that writes a run's frames, ledger and checkpoints, beside the steps.
//!
//! It does one order after the other, so a checkpoint is written only when every frame and line that it counts on is synced.
//! What is large comes in pieces, a bounded number of them: those that have been written are filled again, and the
//! steps wait only while all are still to be written.

use super::ending::Ending;
use crate::output;
use crate::output::checkpoint::{self, Checkpoint, Marks, Numbers};
use crate::output::frames::Frames;
use crate::output::ledger::{Entry, Ledger};
use crate::output::lines::Lines;
use crate::output::mark::Mark;
use crate::output::{Error, Precision};
use rayon::prelude::*;
use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::{Builder, JoinHandle};
use std::time::Instant;

/// Numbers in a piece, and how many pieces there may be: at most 32 MiB.
const NUMBERS: usize = 1 << 15;
const PIECES: usize = 128;
/// Numbers that are worked out before they are rounded, so that they stay in the nearest cache.
const AT_ONCE: usize = 1 << 9;

/// What the thread is asked to do; a frame or a checkpoint is followed by the pieces of its `bytes`.
enum Order {
    Line(Entry),
    Series([String; 2]),
    Frame { time: f64, bytes: usize },
    Checkpoint { head: Vec<u8>, bytes: usize },
    Keep(PathBuf),
    Piece(Vec<u8>),
    Join(Box<Ending>),
}

/// The writing end of a run.
pub(super) struct Writer {
    precision: Precision,
    /// Lengths of the fields of a frame.
    lengths: Vec<usize>,
    orders: Option<SyncSender<Order>>,
    written: Receiver<Vec<u8>>,
    made: usize,
    joined: Receiver<f64>,
    saved: Receiver<f64>,
    thread: Option<JoinHandle<Result<(Frames, Ledger), Error>>>,
}

impl Writer {
    /// Start the thread; it appends to these and saves checkpoints under this name.
    pub fn start(
        frames: Frames,
        ledger: Ledger,
        series: [Option<Lines>; 2],
        checkpoint: PathBuf,
    ) -> io::Result<Writer> {
        let (orders, given) = sync_channel(PIECES);
        let (free, written) = channel();
        let (costs, joined) = channel();
        let (save_costs, saved) = channel();
        let precision = frames.precision();
        let lengths = frames.fields().iter().map(|field| field.length).collect();
        let desk = Desk { frames, ledger, series, checkpoint, given, free, costs, save_costs };
        let thread = Builder::new().name("granflow-writer".to_owned()).spawn(|| desk.work())?;
        let (orders, thread) = (Some(orders), Some(thread));
        Ok(Writer { precision, lengths, orders, written, made: 0, joined, saved, thread })
    }

    /// Append a line to the ledger.
    pub fn line(&mut self, entry: Entry) -> Result<(), Error> {
        self.send(Order::Line(entry))
    }

    /// Append lines to the tables of gauges and of sections.
    pub fn series(&mut self, lines: [String; 2]) -> Result<(), Error> {
        self.send(Order::Series(lines))
    }

    /// Append a frame; `fill` gives the numbers of a field from one on, on any thread. When this returns nothing more is
    /// asked of it.
    pub fn frame(&mut self, time: f64, fill: impl Fn(usize, usize, &mut [f64]) + Sync) -> Result<(), Error> {
        let precision = self.precision;
        let numbers: usize = self.lengths.iter().sum();
        self.send(Order::Frame { time, bytes: numbers * precision.width() })?;
        let cut = |(field, &length): (usize, &usize)| {
            (0..length).step_by(NUMBERS).map(move |from| (field, from, (from + NUMBERS).min(length)))
        };
        let parts: Vec<_> = self.lengths.iter().enumerate().flat_map(cut).collect();
        self.pieces(&parts, |&(field, from, to), bytes| {
            let mut values = [0.0; AT_ONCE];
            for start in (from..to).step_by(AT_ONCE) {
                let values = &mut values[..AT_ONCE.min(to - start)];
                fill(field, start, values);
                precision.encode(values, bytes);
            }
        })
    }

    /// Save a checkpoint. When this returns it has been copied.
    pub fn checkpoint(&mut self, checkpoint: &Checkpoint) -> Result<(), Error> {
        let arrays = checkpoint.arrays.iter().map(|(_, values)| values);
        let parts: Vec<Numbers> = arrays.clone().flat_map(|values| values.chunks(NUMBERS)).collect();
        let bytes = arrays.map(Numbers::bytes).sum();
        let head = checkpoint.head();
        self.send(Order::Checkpoint { head, bytes })?;
        self.pieces(&parts, Numbers::encode)
    }

    /// Keep the last checkpoint under this name too, before the next takes its place.
    pub fn keep(&mut self, name: PathBuf) -> Result<(), Error> {
        self.send(Order::Keep(name))
    }

    /// Join what there is into `result.nc`; see [`Writer::joined`].
    pub fn join(&mut self, ending: Ending) -> Result<(), Error> {
        self.send(Order::Join(Box::new(ending)))
    }

    /// What the last [`Writer::join`] cost \[s\], once, when it is done.
    pub fn joined(&self) -> Option<f64> {
        self.joined.try_recv().ok()
    }

    /// What the last [`Writer::checkpoint`] cost \[s\] beside the steps, once, when it is on disk.
    pub fn saved(&self) -> Option<f64> {
        self.saved.try_recv().ok()
    }

    /// Has everything gone well so far?
    ///
    /// # Errors
    /// The first file that could not be written.
    pub fn check(&mut self) -> Result<(), Error> {
        match &self.thread {
            Some(thread) if thread.is_finished() => Err(self.failure()),
            _ => Ok(()),
        }
    }

    /// Wait until everything is written.
    pub fn end(mut self) -> Result<(Frames, Ledger), Error> {
        self.wait()
    }

    fn wait(&mut self) -> Result<(Frames, Ledger), Error> {
        self.orders = None;
        let thread = self.thread.take().expect("the thread is waited for once");
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }

    fn failure(&mut self) -> Error {
        match self.wait() {
            Err(error) => error,
            Ok(_) => unreachable!("the thread ends by an error while it can be given orders"),
        }
    }

    fn send(&mut self, order: Order) -> Result<(), Error> {
        match self.orders.as_ref().map(|orders| orders.send(order)) {
            Some(Ok(())) => Ok(()),
            _ => Err(self.failure()),
        }
    }

    /// Fill a piece from each of `parts`, several at once, and send them in their order.
    fn pieces<P: Sync>(&mut self, parts: &[P], fill: impl Fn(&P, &mut Vec<u8>) + Sync) -> Result<(), Error> {
        let mut rest = parts;
        while !rest.is_empty() {
            let mut pieces = self.take(rest.len().min(2 * rayon::current_num_threads()))?;
            let (now, after) = rest.split_at(pieces.len());
            pieces.par_iter_mut().zip(now).for_each(|(piece, part)| {
                piece.clear();
                fill(part, piece);
            });
            pieces.into_iter().try_for_each(|piece| self.send(Order::Piece(piece)))?;
            rest = after;
        }
        Ok(())
    }

    /// At least one piece and at most so many: those that have been written, else new ones, else the next that is.
    fn take(&mut self, most: usize) -> Result<Vec<Vec<u8>>, Error> {
        let mut pieces: Vec<Vec<u8>> = self.written.try_iter().take(most).collect();
        let new = (most - pieces.len()).min(PIECES - self.made);
        self.made += new;
        pieces.resize_with(pieces.len() + new, Vec::new);
        if pieces.is_empty() {
            pieces.push(self.written.recv().map_err(|_| self.failure())?);
        }
        Ok(pieces)
    }
}

impl Drop for Writer {
    /// A run that ends by an error leaves everything that it had ordered.
    fn drop(&mut self) {
        self.orders = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// What the thread works with.
struct Desk {
    frames: Frames,
    ledger: Ledger,
    series: [Option<Lines>; 2],
    checkpoint: PathBuf,
    given: Receiver<Order>,
    free: Sender<Vec<u8>>,
    costs: Sender<f64>,
    save_costs: Sender<f64>,
}

impl Desk {
    fn work(self) -> Result<(Frames, Ledger), Error> {
        let Desk { mut frames, mut ledger, mut series, checkpoint, given, free, costs, save_costs } = self;
        while let Ok(order) = given.recv() {
            let pass = |bytes, out: &mut dyn Write| pass(&given, &free, bytes, out);
            match order {
                Order::Line(entry) => ledger.append(entry)?,
                Order::Series(lines) => {
                    for (table, text) in series.iter_mut().zip(&lines) {
                        table.iter_mut().try_for_each(|table| table.append(text))?;
                    }
                }
                Order::Frame { time, bytes } => frames.append_from(time, |out| pass(bytes, out))?,
                Order::Checkpoint { head, bytes } => {
                    let begin = Instant::now();
                    ledger.sync()?;
                    series.iter().flatten().try_for_each(Lines::sync)?;
                    let marks = Marks {
                        frames: frames.mark(),
                        ledger: ledger.mark(),
                        series: series
                            .each_ref()
                            .map(|table| table.as_ref().map_or_else(Mark::default, Lines::mark)),
                    };
                    checkpoint::write_from(&checkpoint, &head, marks, |out| pass(bytes, out))?;
                    let _ = save_costs.send(begin.elapsed().as_secs_f64()); // nobody asks at the end of a run
                }
                Order::Keep(name) => output::keep(&checkpoint, &name)?,
                Order::Join(ending) => {
                    let begin = Instant::now();
                    ending.finished(None, frames.again()?, ledger.entries().to_vec()).write_result()?;
                    let _ = costs.send(begin.elapsed().as_secs_f64()); // nobody asks at the end of a run
                }
                Order::Piece(_) => unreachable!("a piece belongs to a frame or a checkpoint"),
            }
        }
        Ok((frames, ledger))
    }
}

/// Hand so many bytes of pieces on to `out`, and the pieces back.
fn pass(
    given: &Receiver<Order>,
    free: &Sender<Vec<u8>>,
    mut bytes: usize,
    out: &mut dyn Write,
) -> io::Result<()> {
    while bytes > 0 {
        let Ok(Order::Piece(piece)) = given.recv() else {
            return Err(io::Error::new(io::ErrorKind::BrokenPipe, "the run ended in the middle of it"));
        };
        out.write_all(&piece)?;
        bytes -= piece.len();
        let _ = free.send(piece); // nobody waits for the last ones
    }
    Ok(())
}

#[cfg(test)]
mod tests;
