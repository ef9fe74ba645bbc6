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
/// Numbers that figures and animation of a line hold for each of its cells and frames.
const LINE: [(&str, f64); 2] = [("figures", 11.5), ("animation", 4.0)];
/// Pictures of a plane while they are drawn, and bytes for each cell beside the maps.
const PICTURES: (f64, f64) = (45e6, 32.0);

/// How large a run is.
pub(crate) struct Size {
    pub cells: usize,
    /// One dimension.
    pub line: bool,
    /// Bytes for each cell while it is set up, and while it computes.
    pub setup: f64,
    pub run: f64,
    /// Numbers for each cell that stay to the end: maps, elevation.
    pub maps: usize,
    /// Numbers of a frame.
    pub frame: usize,
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
        let pieces = PIECES.min(self.frame_bytes(run) * frames + self.run * cells);
        let asked = |kind: &str| run.output.files.iter().any(|file| file.name == kind);
        let maps = 8.0 * self.maps as f64 * cells;
        let mut end = maps;
        if self.line {
            let held = LINE.iter().filter(|(kind, _)| asked(kind)).map(|(_, numbers)| numbers).sum::<f64>();
            end += 8.0 * held * cells * frames;
        } else {
            if asked("csv") || asked("vtk") {
                end += maps; // the tables have maps of their own
            }
            if ["figures", "animation", "report"].iter().any(|kind| asked(kind)) {
                // What is drawn is drawn beside the other files.
                end += PICTURES.0 + PICTURES.1 * cells;
            }
        }
        PROGRAM + (pieces + (self.run * cells).max(end)).max(self.setup * cells)
    }
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
