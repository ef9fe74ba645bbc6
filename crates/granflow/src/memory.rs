//! What a run takes of the memory at its peak: said by `granflow check`, and refused where it cannot fit.

use crate::StartError;
use granflow_case::memory::available;
use granflow_case::{Precision, RunPlan};

/// The program itself, before it reads anything.
const PROGRAM: f64 = 13e6;
/// The pieces that wait to be written, at most.
const PIECES: f64 = 33.6e6;
/// Frames of a run whose end is not known.
const FRAMES: u64 = 21;
/// Numbers for each cell and frame of a line that its animation holds.
const ANIMATION: f64 = 4.0;
/// Bytes for each cell that pictures of a plane take beside the maps, and those of maps that a line has at its end beside its
/// fields: pieces so small stay with the allocator.
const PICTURE: f64 = 32.0;
const LINE: f64 = 32.0;

/// How large a run is.
pub(crate) struct Size {
    pub cells: usize,
    /// One dimension.
    pub line: bool,
    /// Bytes while the files of a mountain are read.
    pub reading: f64,
    /// Bytes for each cell while it is set up, and while it computes.
    pub setup: f64,
    pub run: f64,
    /// Bytes for each cell of a checkpoint.
    pub saved: f64,
    /// Numbers for each cell that stay to the end: maps, elevation.
    pub maps: usize,
    /// Numbers of a frame.
    pub frame: usize,
    /// Bytes of the pictures of a plane that are drawn at once; numbers that the figures of a line hold for each cell and frame.
    pub drawn: f64,
}

impl Size {
    /// Bytes of a frame on disk.
    pub fn frame_bytes(&self, run: &RunPlan) -> f64 {
        let width = match run.output.precision {
            Precision::F32 => 4.0,
            Precision::F64 => 8.0,
        };
        self.frame as f64 * width
    }

    /// The largest number of bytes that the process holds at once: set-up, steps, or the files at the end.
    pub fn peak(&self, run: &RunPlan) -> f64 {
        let cells = self.cells as f64;
        let frames = run.output.frames.count(&run.ends).unwrap_or(FRAMES) as f64;
        // There are two checkpoints at least.
        let pieces = PIECES.min(self.frame_bytes(run) * frames + 2.0 * self.saved * cells);
        let end = if self.line { self.line_end(run, frames) } else { self.plane_end(run) };
        PROGRAM + (pieces + (self.run * cells).max(end)).max(self.setup * cells).max(self.reading)
    }

    /// Bytes while the files of a line are made.
    fn line_end(&self, run: &RunPlan, frames: f64) -> f64 {
        let of = |kind: &str, numbers: f64| if asked(run, kind) { numbers } else { 0.0 };
        let held = of("figures", self.drawn) + of("animation", ANIMATION);
        let cells = self.cells as f64;
        ((self.run + LINE) * cells).max(8.0 * (self.maps as f64 + held * frames) * cells)
    }

    /// Bytes while the files of a plane are made.
    fn plane_end(&self, run: &RunPlan) -> f64 {
        let maps = 8.0 * self.maps as f64 * self.cells as f64;
        // Tables have maps of their own.
        let tables = ["csv", "vtk"].iter().filter(|kind| asked(run, kind)).count() as f64 * maps;
        let drawn = ["figures", "animation", "report"].iter().any(|kind| asked(run, kind));
        let pictures = if drawn { self.drawn + PICTURE * self.cells as f64 } else { 0.0 };
        maps + tables.max(pictures)
    }
}

fn asked(run: &RunPlan, kind: &str) -> bool {
    run.output.files.iter().any(|file| file.name == kind)
}

/// Refuses what cannot fit before it is asked for.
pub(crate) fn fits(cells: usize, bytes_per_cell: usize) -> Result<(), StartError> {
    let needed = cells as f64 * bytes_per_cell as f64;
    match available() {
        Some(available) if needed > available as f64 => {
            Err(StartError::Memory { cells, needed, available: available as f64 })
        }
        _ => Ok(()),
    }
}
