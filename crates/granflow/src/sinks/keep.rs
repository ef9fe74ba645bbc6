//! Memory as a sink for a run from a case: what `result.nc` would hold, each series one array over time.

use super::schedule::{Due, Schedule};
use super::series::Series;
use super::{Sink, SinkError};
use crate::model::Plane;
use crate::output::lines::Table;
use crate::output::netcdf::{Dataset, Values, history};
use crate::output::summary::{StopReason, Summary};
use crate::output::{Error, Precision};
use crate::results::numbers::{self, Start};
use crate::results::{Contents, Numbers};
use crate::run::{Maps, Run, check_state};
use crate::watch::Watch;
use granflow_case::RunPlan;
use std::path::Path;
use std::time::{Instant, SystemTime};

/// Keeps the frames of a run, its gauges and its sections, as its case asks for them.
pub struct Keep {
    plan: RunPlan,
    schedule: Schedule,
    watched: Series,
    notes: Vec<String>,
    start: Start,
    lengths: Vec<usize>,
    times: Vec<f64>,
    series: Vec<(String, Numbers)>,
}

/// A run from a case that has ended, in memory.
#[derive(Debug)]
pub struct Kept {
    /// Where the cells are, and on what.
    pub plane: Plane,
    /// The series by name: the numbers of all instants, the first instant first, x fastest, the first row in the south.
    pub series: Vec<(String, Numbers)>,
    /// The run in numbers.
    pub summary: Summary,
    /// What is to be said of its gauges and sections.
    pub notes: Vec<String>,
    precision: Precision,
    times: Vec<f64>,
    maps: Maps,
    tables: [Option<Table>; 2],
    case: [String; 2],
}

impl Keep {
    /// Begins with the present state of `run` as the first frame; wall time counts from `begun` on.
    #[must_use]
    pub fn begin(plan: &RunPlan, begun: Instant, watch: Watch, run: &mut dyn Run) -> Keep {
        let notes = watch.notes.clone();
        let watched = Series::new(watch, plan.watched.every, run);
        let fields = run.plane().series();
        let precision = plan.output.precision;
        let mut keep = Keep {
            plan: plan.clone(),
            schedule: Schedule::new(plan.output.frames, run.plane()),
            watched,
            notes,
            start: Start { at: begun, updates: run.stepper().updates() },
            lengths: fields.iter().map(|field| field.length).collect(),
            times: Vec::new(),
            series: fields.into_iter().map(|field| (field.name, Numbers::none(precision))).collect(),
        };
        keep.frame(run);
        keep.schedule.plan(run);
        keep.watched.plan(run);
        keep
    }

    fn frame(&mut self, run: &dyn Run) {
        for (number, ((_, numbers), length)) in self.series.iter_mut().zip(&self.lengths).enumerate() {
            numbers.extend(*length, |from, values| run.fill(number, from, values));
        }
        self.times.push(run.time());
        self.watched.look(run);
    }

    fn frame_due(&mut self, run: &mut dyn Run) -> Result<(), SinkError> {
        check_state(run).map_err(SinkError::of)?;
        self.frame(run);
        self.schedule.plan(run);
        Ok(())
    }

    /// What the run left, with its last state as the last frame.
    ///
    /// # Errors
    /// [`Error`] of tables of gauges and sections that do not fit together.
    pub fn finish(mut self, mut run: Box<dyn Run>, reason: StopReason) -> Result<Kept, Error> {
        if self.times.last() != Some(&run.time()) {
            self.frame(&*run);
        }
        run.stepper_mut().release_buffers();
        let end = run.maps();
        let mut summary = numbers::summary(&self.plan, &*run, reason, self.start);
        let plane = run.place();
        let mut maps = run.into_peaks();
        maps.extend(end);
        numbers::complete(&plane, &mut maps, &mut summary);
        Ok(Kept {
            plane,
            series: self.series,
            summary,
            precision: self.plan.output.precision,
            times: self.times,
            maps,
            notes: self.notes,
            tables: self.watched.into_tables()?,
            case: [self.plan.resolved(), self.plan.text()],
        })
    }
}

impl Sink for Keep {
    fn next_instant(&self) -> f64 {
        self.schedule.next()[0].min(self.watched.next())
    }
    fn at_instant(&mut self, run: &mut dyn Run) -> Result<(), SinkError> {
        let instant = self.next_instant();
        if self.watched.next() == instant {
            self.watched.look(run);
            self.watched.plan(run);
        }
        if self.schedule.next()[0] > instant { Ok(()) } else { self.frame_due(run) }
    }
    fn after_step(&mut self, run: &mut dyn Run) -> Result<(), SinkError> {
        if self.watched.is_every_step() {
            self.watched.look(run);
        }
        if self.schedule.due(run) == Due::Frame { self.frame_due(run) } else { Ok(()) }
    }
}

impl Kept {
    /// All that `result.nc` would say, made by `command`. The numbers of its series stand in [`Kept::series`]: there
    /// [`Values::Stored`] names them.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a series or a map that is no quantity of the model.
    pub fn dataset(&self, command: &str) -> Result<Dataset<'_>, Error> {
        let series = self.series.iter().map(|(name, _)| (name.as_str(), Values::Stored(name.clone())));
        let contents = Contents {
            plane: &self.plane,
            precision: self.precision,
            times: self.times.clone(),
            series: series.collect(),
            maps: &self.maps,
            tables: self.tables.clone(),
            summary: &self.summary,
            case: [&self.case[0], &self.case[1]],
        };
        contents
            .dataset(history(SystemTime::now(), command))
            .map_err(|problem| Error::invalid(Path::new("result"), problem))
    }
}
