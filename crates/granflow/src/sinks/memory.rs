//! Memory as a sink: frames as arrays, the ledger as lines.

use super::schedule::{Due, Schedule};
use super::{Sink, SinkError};
use crate::model::Plane;
#[cfg(feature = "files")]
use crate::output::{Error, netcdf::Values};
#[cfg(feature = "files")]
use crate::results::{About, dataset};
use crate::run::{Entry, Maps, Run, check_state};
use granflow_case::Frames;
#[cfg(feature = "files")]
use granflow_case::Precision;
#[cfg(feature = "files")]
use std::path::Path;

/// Keeps the frames of a run: its fields at every due instant, all fields unless some are named.
#[derive(Debug)]
pub struct Memory {
    schedule: Schedule,
    recording: Recording,
    /// Numbers of the fields that are kept, and their lengths.
    kept: Vec<(usize, usize)>,
}

/// What a run left in memory.
#[derive(Debug, Clone)]
pub struct Recording {
    /// Where the cells are, and on what.
    pub plane: Plane,
    /// Name of the scheme.
    pub scheme: String,
    /// Thickness that a layer must exceed to count in peaks and times (units of the thickness); none where
    /// there are no such maps.
    pub threshold: Option<f64>,
    /// The instants.
    pub times: Vec<f64>,
    /// The fields by name: one array for each instant, x fastest, the first row in the south.
    pub fields: Vec<(String, Vec<Vec<f64>>)>,
    /// The ledger, a line for each instant.
    pub ledger: Vec<Entry>,
    /// The maps of the last state: peaks, times, and those of the model.
    pub maps: Maps,
}

impl Memory {
    /// Begins with the present state of `run` as the first frame; `names` are the fields to keep, none for all.
    ///
    /// # Panics
    /// If the run has no field of such a name, or the interval of the frames is not positive.
    #[must_use]
    pub fn begin(run: &mut dyn Run, frames: Frames, names: &[&str]) -> Memory {
        if let Frames::Every(interval) = frames {
            assert!(interval > 0.0, "the interval of the frames is {interval}: give a number > 0");
        }
        let series = run.plane().series();
        let known = |name: &&str| series.iter().any(|field| field.name == **name);
        assert!(names.iter().all(known), "the run has no such field among {names:?}");
        let kept =
            series.iter().enumerate().filter(|(_, f)| names.is_empty() || names.contains(&f.name.as_str()));
        let kept: Vec<_> = kept.map(|(k, field)| (k, field.length)).collect();
        let recording = Recording {
            plane: run.place(),
            scheme: run.scheme().to_owned(),
            threshold: run.threshold(),
            times: Vec::new(),
            fields: kept.iter().map(|(k, _)| (series[*k].name.clone(), Vec::new())).collect(),
            ledger: Vec::new(),
            maps: Vec::new(),
        };
        let mut memory = Memory { schedule: Schedule::new(frames, run.plane()), recording, kept };
        memory.frame(run);
        memory.schedule.plan(run);
        memory
    }

    fn frame(&mut self, run: &mut dyn Run) {
        for ((_, series), (number, length)) in self.recording.fields.iter_mut().zip(&self.kept) {
            let mut values = vec![0.0; *length];
            run.fill(*number, 0, &mut values);
            series.push(values);
        }
        self.recording.times.push(run.time());
        self.recording.ledger.push(Entry::of(run));
    }

    /// The recording, with the present state of `run` as its last frame.
    #[must_use]
    pub fn finish(mut self, run: &mut dyn Run) -> Recording {
        if self.recording.times.last() != Some(&run.time()) {
            self.frame(run);
        }
        let end = run.maps();
        self.recording.maps = run.peaks();
        self.recording.maps.extend(end);
        self.recording
    }
}

impl Sink for Memory {
    fn next_instant(&self) -> f64 {
        self.schedule.next()[0]
    }
    fn at_instant(&mut self, run: &mut dyn Run) -> Result<(), SinkError> {
        check_state(run).map_err(SinkError::of)?;
        self.frame(run);
        self.schedule.plan(run);
        Ok(())
    }
    fn after_step(&mut self, run: &mut dyn Run) -> Result<(), SinkError> {
        if self.schedule.due(run) == Due::Frame { self.at_instant(run) } else { Ok(()) }
    }
}

impl Recording {
    /// A field at every instant; none of this name was kept where there is none.
    #[must_use]
    pub fn field(&self, name: &str) -> Option<&[Vec<f64>]> {
        self.fields.iter().find(|(own, _)| own == name).map(|(_, series)| series.as_slice())
    }
    /// Writes everything as a NetCDF-4 file after the CF conventions, as a run from a case leaves it.
    ///
    /// # Errors
    /// [`Error`] naming the file; [`Error::Invalid`] for a field or a map that is no quantity of the model.
    #[cfg(feature = "files")]
    pub fn write_netcdf(&self, path: &Path) -> Result<(), Error> {
        let series = self
            .fields
            .iter()
            .map(|(name, values)| (name.as_str(), Values::Series(values.as_slice().into())));
        let about = About { scheme: self.scheme.clone(), threshold: self.threshold, ..About::default() };
        let data =
            dataset(&self.plane, Precision::F64, self.times.clone(), series.collect(), &self.maps, about);
        data.map_err(|problem| Error::invalid(path, problem))?.write(path, None)
    }
    /// A map by its name.
    #[must_use]
    pub fn map(&self, name: &str) -> Option<&[f64]> {
        self.maps.iter().find(|(own, _)| *own == name).map(|(_, map)| map.as_slice())
    }
}
