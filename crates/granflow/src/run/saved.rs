//! The beginning of a run and its checkpoints: from the case, or on from where another ended.

use super::model::Model;
use super::writer::Writer;
use super::{Run, RunError, Work};
use crate::kernels::Kernel;
use crate::output;
use crate::output::checkpoint::{Checkpoint, Numbers, case_hash};
use crate::output::frames::Frames;
use crate::output::ledger::Ledger;
use crate::results::Plane;
use crate::setup::Sand;
use crate::simulation::{CLOCK, Simulation};
use granflow_engine::Field;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

impl<'s, const D: usize, S: Model<D>> Run<'_, 's, D, S> {
    /// Begin, or go on from the checkpoint.
    pub(super) fn start<'a>(
        work: Work<'a>,
        mut simulation: Simulation<D, S>,
        plane: Plane,
        sand: Option<&'s Sand<D>>,
    ) -> Result<Run<'a, 's, D, S>, RunError> {
        if S::PEAKS {
            simulation.keep_maps();
        }
        let directory = &work.options.directory;
        let (frame_file, ledger_file) = (frames_in(directory), directory.join("mass.csv"));
        let initial = simulation.totals().volume;
        for folder in [directory.clone(), directory.join("checkpoint")] {
            output::remove_leftovers(&folder)?;
        }
        if !work.options.resume {
            // An older one would belong to other frames.
            output::remove_if_there(&checkpoint_in(directory))?;
            let frames = Frames::create(&frame_file, work.case.precision(), plane.series())?;
            let ledger = Ledger::create(&ledger_file, plane.outlets())?;
            let mut run = Run::new(work, simulation, plane, sand, frames, ledger)?;
            run.initial = initial;
            run.peak_speed = run.simulation.speed();
            run.peak_energy = run.energy;
            run.frame()?;
            run.schedule();
            return Ok(run);
        }
        let refused = |problem: String| RunError::Resume { directory: directory.clone(), problem };
        let saved = checkpoint_in(directory);
        if !saved.exists() {
            return Err(refused(format!("there is no checkpoint {}", saved.display())));
        }
        simulation.release_buffers();
        let mut checkpoint = Checkpoint::read(&saved, &case_hash(&work.case.text()))?;
        let (mut frames, _torn) = Frames::open(&frame_file)?;
        let mut ledger = Ledger::open(&ledger_file)?;
        let kept = |name: &str| checkpoint.scalar(name).unwrap_or(checkpoint.time);
        frames.truncate_to(kept("last_frame"))?;
        ledger.truncate_to(kept("last_line"))?;
        if let Some(problem) = restore(&mut simulation, &mut checkpoint) {
            return Err(refused(problem));
        }
        let scalar = |name: &str| checkpoint.scalar(name).unwrap_or(0.0);
        let mut run = Run::new(work, simulation, plane, sand, frames, ledger)?;
        run.peak_speed = scalar("peak_speed");
        run.peak_energy = scalar("peak_energy");
        run.initial = scalar("initial");
        run.next_frame = scalar("next_frame");
        run.next_line = scalar("next_line");
        Ok(run)
    }

    fn new<'a>(
        work: Work<'a>,
        simulation: Simulation<D, S>,
        plane: Plane,
        sand: Option<&'s Sand<D>>,
        frames: Frames,
        ledger: Ledger,
    ) -> Result<Run<'a, 's, D, S>, RunError> {
        let (now, energy) = (Instant::now(), simulation.totals().energy);
        let updates = simulation.updates();
        let line = ledger.entries().last();
        let written = [frames.times().last().copied(), line.map(|entry| entry.time)];
        let wet_cells = line.map_or(0, |entry| entry.wet_cells as usize);
        let (checkpoint, command) = (checkpoint_in(&work.options.directory), work.options.command.clone());
        let writer = Writer::start(frames, ledger, checkpoint, command)
            .map_err(|error| RunError::Threads(error.to_string()))?;
        Ok(Run {
            work,
            simulation,
            plane,
            sand,
            pouring: f64::NEG_INFINITY,
            writer,
            written: written.map(|time| time.unwrap_or(f64::NEG_INFINITY)),
            initial: 0.0,
            peak_speed: 0.0,
            peak_energy: 0.0,
            energy,
            wet_cells,
            next_frame: f64::INFINITY,
            next_line: f64::INFINITY,
            stepping: Duration::ZERO,
            updates,
            saved: now,
            joined: Some((now, 0.0)),
        })
    }

    /// Save what goes on from here. `due` are the times of the last frame and line that an unbroken run has too: the
    /// frame at which an interrupted run ends goes when it is resumed.
    pub(super) fn checkpoint(&mut self, due: [f64; 2]) -> Result<(), RunError> {
        let simulation = &self.simulation;
        let mut scalars: Vec<(String, f64)> = vec![
            ("peak_speed".into(), self.peak_speed),
            ("peak_energy".into(), self.peak_energy),
            ("initial".into(), self.initial),
            ("next_frame".into(), self.next_frame),
            ("next_line".into(), self.next_line),
            ("last_frame".into(), due[0]),
            ("last_line".into(), due[1]),
            ("at_rest".into(), f64::from(u8::from(simulation.at_rest()))),
        ];
        scalars.extend(simulation.clock().iter().enumerate().map(|(k, v)| (format!("clock_{k}"), *v)));
        let state = simulation.arrays().components().iter().enumerate();
        let mut arrays: Vec<(String, Numbers)> =
            state.map(|(k, part)| (format!("state_{k}"), Numbers::Double(part.into()))).collect();
        if let Some(maps) = simulation.maps() {
            arrays.extend(maps.named().map(|(name, map)| (name.to_owned(), Numbers::Single(map))));
        }
        self.writer.checkpoint(&Checkpoint {
            case: case_hash(&self.work.case.text()),
            step: simulation.step(),
            time: simulation.time(),
            scalars,
            arrays,
        })?;
        self.saved = Instant::now();
        Ok(())
    }
}

fn frames_in(directory: &Path) -> PathBuf {
    directory.join("checkpoint").join("frames.bin")
}

fn checkpoint_in(directory: &Path) -> PathBuf {
    directory.join("checkpoint").join("state.bin")
}

/// Put a checkpoint back; what does not fit, if anything.
fn restore<const D: usize, S: Kernel<D>>(
    simulation: &mut Simulation<D, S>,
    saved: &mut Checkpoint<'static>,
) -> Option<String> {
    let clock: Vec<f64> = (0..CLOCK).map_while(|k| saved.scalar(&format!("clock_{k}"))).collect();
    let part = |k: usize| saved.take(&format!("state_{k}"));
    let parts: Vec<Vec<f64>> = (0..simulation.arrays().components().len()).map_while(part).collect();
    if !simulation.restore(&clock, Field::of(parts)) {
        return Some("its state has another shape".to_owned());
    }
    if saved.scalar("at_rest") == Some(1.0) {
        simulation.sleep_all();
    }
    for (name, map) in simulation.maps_mut() {
        match saved.take(name) {
            Some(values) if values.len() == map.len() => {
                map.iter_mut().zip(values).for_each(|(kept, value)| *kept = value as f32);
            }
            _ => return Some(format!("its map {name} is missing or has another shape")),
        }
    }
    None
}
