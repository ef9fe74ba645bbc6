//! A run that the page holds: opened from a case text, stepped for a while, looked into.

use crate::answer::{of_case, of_start, plain};
use granflow::Case;
use granflow::case::RunPlan;
use granflow::run::{Entry, Run, Sink, SinkError, StopReason, checksums, drive};
use granflow::savage_hutter::exact::Riemann;
use serde_json::{Map, Value, json};
use std::path::Path;
use std::time::{Duration, Instant};

/// No files are written here, whatever the case asks for.
const NO_FILES: &str = "output.files=[]";

pub struct Held {
    run: Box<dyn Run>,
    plan: RunPlan,
    ended: Option<StopReason>,
    /// Seconds that steps have taken.
    seconds: f64,
}

/// Ends a run for now.
struct Pause {
    time: f64,
    steps: f64,
    deadline: Instant,
    is_due: bool,
}

impl Sink for Pause {
    fn wants_end(&self) -> bool {
        self.is_due
    }
    fn after_step(&mut self, run: &mut dyn Run) -> Result<(), SinkError> {
        self.steps -= 1.0;
        self.is_due = self.steps < 1.0 || run.time() >= self.time || Instant::now() >= self.deadline;
        Ok(())
    }
}

/// The run of a case text, and its plan; after a NUL each come overrides `key.path=value`.
fn started(text: &str) -> Result<(Box<dyn Run>, RunPlan), Value> {
    let mut parts = text.split('\0');
    let text = parts.next().unwrap_or_default();
    let overrides: Vec<String> = parts.chain([NO_FILES]).map(str::to_owned).collect();
    let case = Case::parse_with(text, "case.toml", &overrides).map_err(|error| of_case(&error))?;
    let checked = case.check().map_err(|error| of_case(&error))?;
    let plan = checked.plan().clone();
    let mut run = checked.start().map_err(|error| of_start(&error))?;
    run.bring();
    Ok((run, plan))
}

impl Held {
    /// The run of a case text.
    pub fn open(text: &str) -> Result<Held, Value> {
        let (run, plan) = started(text)?;
        Ok(Held { run, plan, ended: None, seconds: 0.0 })
    }

    /// Goes on as the run of another case text.
    pub fn change(&mut self, text: &str) -> Result<(), Value> {
        let (mut run, plan) = started(text)?;
        let mut saved = self.run.save().into_owned();
        // Under other sources nothing rests or is steady because it did.
        saved.at_rest = false;
        saved.drift.fill(f64::INFINITY);
        run.restore(saved).map_err(plain)?;
        (self.run, self.plan, self.ended) = (run, plan, None);
        Ok(())
    }

    /// What the run is: cells, places, fields with their units, notes.
    pub fn about(&self) -> Value {
        let plane = self.run.plane();
        let units = plane.domain.units();
        let quantities = plane.model().quantities.iter().map(|quantity| {
            json!({
                "name": quantity.name, "long_name": quantity.long_name, "units": quantity.units_in(units),
                "kind": format!("{:?}", quantity.kind), "values": plane.length(quantity.at),
            })
        });
        let stepper = self.run.stepper();
        json!({
            "title": self.plan.title, "model": self.plan.model, "scheme": self.plan.scheme,
            "cells": stepper.cells(), "origin": stepper.origin(), "size": stepper.size(),
            "dimensions": stepper.dimensions(), "outlets": plane.outlets(),
            "quantities": quantities.collect::<Vec<_>>(),
            "remarks": self.plan.notes.iter().cloned().chain(plane.domain.remarks()).collect::<Vec<_>>(),
            "bytes": self.run.bytes_per_cell(false) * plane.cells(),
        })
    }

    /// Steps until a time, a number of steps or a moment, whichever comes first, or to the end of the case.
    pub fn advance(&mut self, time: f64, steps: f64, milliseconds: f64) -> Result<(), Value> {
        if self.ended.is_some() || self.run.time() >= time {
            return Ok(());
        }
        let now = Instant::now();
        let moment = Duration::from_secs_f64((milliseconds / 1e3).clamp(0.0, 1e6));
        let mut pause = Pause { time, steps, deadline: now + moment, is_due: steps < 1.0 };
        let reason = drive(&mut *self.run, &self.plan.ends, &mut [&mut pause]).map_err(plain)?;
        self.seconds += now.elapsed().as_secs_f64();
        self.ended = (reason != StopReason::Interrupted).then_some(reason);
        Ok(())
    }

    /// One of the case's ends was reached.
    pub fn has_ended(&self) -> bool {
        self.ended.is_some()
    }

    /// Where the run stands: the ledger, why it ended.
    pub fn state(&mut self) -> Value {
        let entry = Entry::of(&mut *self.run);
        json!({
            "time": entry.time, "steps": entry.step, "mass": entry.mass, "mass_in": entry.mass_in, "out": entry.out,
            "mass_out": entry.mass_out(), "mass_error": entry.mass_error, "wet_cells": entry.wet_cells,
            "moving_cells": entry.moving_cells, "max_speed": entry.max_speed, "kinetic_energy": entry.kinetic_energy,
            "at_rest": self.run.at_rest(), "stop_reason": self.ended, "in_words": self.ended.map(|end| end.to_string()),
            "wall_seconds": self.seconds, "source_rate": self.run.stepper().source_rate(),
        })
    }

    /// The numbers of a field, a map of peaks or of the state, or of what is fixed; none where no such thing is kept.
    pub fn fill(&mut self, name: &str, numbers: &mut Vec<f64>) {
        numbers.clear();
        if let Some(field) = self.run.field(name) {
            numbers.extend(field.iter());
            return;
        }
        let named = |maps: Vec<(&'static str, Vec<f64>)>| maps.into_iter().find(|(known, _)| *known == name);
        if let Some((_, map)) = named(self.run.peaks()).or_else(|| named(self.run.maps())) {
            *numbers = map;
            return;
        }
        let place = self.run.place();
        if let Some((_, fixed)) = place.domain.fixed().into_iter().find(|(known, _)| *known == name) {
            numbers.extend(fixed.iter());
        }
    }

    /// Writes a field or map as a GeoTIFF, `NAME.tif`.
    pub fn write(&mut self, name: &str) -> Result<(), Value> {
        let mut numbers = Vec::new();
        self.fill(name, &mut numbers);
        let plane = self.run.plane();
        let raster = plane.domain.raster().ok_or_else(|| plain("only what lies on a map has a GeoTIFF"))?;
        if numbers.len() != plane.cells() {
            return Err(plain(format!("{name} has no value for each cell")));
        }
        raster.write_values(Path::new(&format!("{name}.tif")), |cell| numbers[cell]).map_err(plain)
    }

    /// The summary, and the checksums of all fields and maps.
    pub fn checksums(&mut self) -> Value {
        let sums: Map<String, Value> = checksums(&mut *self.run)
            .into_iter()
            .map(|(name, sum)| (name, json!(format!("{sum:016x}"))))
            .collect();
        let (about, mut summary) = (self.about(), self.state());
        for key in ["title", "model", "scheme", "cells"] {
            summary[key] = about[key].clone();
        }
        for (name, number) in self.run.numbers() {
            summary[name] = json!(number);
        }
        json!({ "summary": summary, "checksums": sums })
    }

    /// The thickness of Stoker's dam break at the centres of the cells, at the time of the run.
    pub fn exact_dam_break(&self, beta: f64, left: f64, right: f64) -> Result<Vec<f64>, Value> {
        let exact = Riemann::stoker(beta, left, right).map_err(plain)?;
        let time = self.run.time();
        Ok(self.run.plane().x.iter().map(|x| exact.flow(*x, time).h).collect())
    }
}
