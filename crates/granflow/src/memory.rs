//! What a run takes of the memory at its peak: said by `granflow check`, and refused where it cannot fit.

use crate::StartError;
use granflow_case::ensemble::Exceed;
use granflow_case::memory::available;
use granflow_case::{Ensemble, Precision, RunPlan};

/// The program itself and what it reads of its own file.
const PROGRAM: f64 = 18e6;
/// The pieces that wait to be written, at most; those of a checkpoint and of so many frames wait where the disk keeps up.
const PIECES: f64 = 33.6e6;
const WAITING: f64 = 2.0;
/// Frames of a run whose end is not known.
const FRAMES: u64 = 21;
/// Numbers for each cell and frame of a line that its animation holds.
const ANIMATION: f64 = 4.0;
/// Bytes for each cell that figures and the animation of a plane take beside the maps.
const BESIDE: [f64; 2] = [40.0, 20.0];
/// Those of maps that a line has at its end beside its fields: pieces so small stay with the allocator.
const LINE: f64 = 32.0;
/// The share of what tables took that stays with the allocator while pictures are drawn.
const LEFT: f64 = 0.4;
/// Figures of a plane, about: not more are drawn at once.
const FIGURES: f64 = 8.0;
/// The share of the cells that the members of an ensemble reach, about. What is added up elsewhere is 0, and takes no memory.
const REACHED: f64 = 0.25;

/// What pictures take while they are drawn.
#[derive(Clone, Copy)]
pub(crate) struct Drawn {
    /// Bytes of a figure; as many are drawn at once as there are cores. Of a line those of all of them: one of them is far the largest.
    pub figure: f64,
    /// Bytes of a picture of the animation, and of one of an ensemble, of which as many are drawn at once.
    pub picture: f64,
    pub of_ensemble: f64,
    /// Numbers for each cell and frame that the figures of a line hold.
    pub held: f64,
}

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
    /// Bytes for each cell that all members of an ensemble share.
    pub shared: f64,
    /// Bytes for each cell of a checkpoint.
    pub saved: f64,
    /// Numbers for each cell that stay to the end: maps, elevation.
    pub maps: usize,
    /// Numbers of a frame.
    pub frame: usize,
    pub drawn: Drawn,
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
        let pieces = PIECES.min(WAITING * self.frame_bytes(run) + self.saved * cells);
        let end = if self.line { self.line_end(run, frames) } else { self.plane_end(run) };
        PROGRAM + (pieces + (self.run * cells).max(end)).max(self.setup * cells).max(self.reading)
    }

    /// Bytes while the files of a line are made.
    fn line_end(&self, run: &RunPlan, frames: f64) -> f64 {
        let (cells, Drawn { figure, picture, held, .. }) = (self.cells as f64, self.drawn);
        let of = |kind: &str, numbers: f64, once: f64| {
            if asked(run, kind) { 8.0 * numbers * frames * cells + once } else { 0.0 }
        };
        let pictures = of("figures", held, figure).max(of("animation", ANIMATION, cores() * picture));
        ((self.run + LINE) * cells).max(8.0 * self.maps as f64 * cells + pictures)
    }

    /// Bytes while the files of a plane are made.
    fn plane_end(&self, run: &RunPlan) -> f64 {
        let maps = 8.0 * self.maps as f64 * self.cells as f64;
        // Tables have maps of their own.
        let tables = ["csv", "vtk"].iter().filter(|kind| asked(run, kind)).count() as f64 * maps;
        let pictures = self.pictures(run);
        maps + tables.max(pictures) + LEFT * tables.min(pictures)
    }

    /// Bytes of the pictures of a plane while they are drawn.
    fn pictures(&self, run: &RunPlan) -> f64 {
        let (cells, Drawn { figure, picture, .. }) = (self.cells as f64, self.drawn);
        let of = |kinds: &[&str], bytes: f64| {
            if kinds.iter().any(|kind| asked(run, kind)) { bytes } else { 0.0 }
        };
        let figures = of(&["figures", "report"], cores().min(FIGURES) * figure + BESIDE[0] * cells);
        figures.max(of(&["animation"], cores() * picture + BESIDE[1] * cells))
    }

    /// The same of an ensemble with a member on each core: what is added up of the members, and they themselves or the maps of all.
    pub fn of_ensemble(&self, run: &RunPlan, ensemble: &Ensemble) -> f64 {
        let cells = self.cells as f64;
        let Exceed { peak_thickness, peak_speed, peak_pressure } = &ensemble.exceed;
        let thresholds = (peak_thickness.len() + peak_speed.len() + peak_pressure.len()) as f64;
        let peaks = if self.shared > 0.0 { 3.0 } else { 2.0 };
        let percentiles = ensemble.percentiles.len() as f64;
        // A sum and the largest value, counts of members, and for percentiles a list of counts in each cell.
        let counted = 4.0 + 24.0 * peaks + 4.0 * thresholds;
        let lists = if percentiles > 0.0 { 32.0 * peaks } else { 0.0 };
        // The run that was begun to look at its cells stays with the allocator.
        let members = (1.0 + cores().min(f64::from(ensemble.members))) * self.run;
        let maps = 8.0 * (1.0 + peaks * (2.0 + percentiles) + thresholds);
        let drawn = ["figures", "report"].iter().any(|kind| asked(run, kind));
        let pictures = if drawn { cores() * self.drawn.of_ensemble + BESIDE[0] * cells } else { 0.0 };
        PROGRAM
            + (self.shared + REACHED * counted + lists) * cells
            + (members * cells).max(maps * cells + pictures)
    }
}

fn cores() -> f64 {
    std::thread::available_parallelism().map_or(1.0, |cores| cores.get() as f64)
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
