//! What can be said about the table and the sources of hadeler_kuttler.

use crate::fault::CaseError;
use crate::plan::TablePlan;
use crate::sand::{Part, Rate, SandSource, Sources};
use crate::{Case, Quantity, Region, Until};
use std::collections::HashSet;

/// Instants of a moving source, besides its beginning, at which its rate is checked.
const INSTANTS: u32 = 16;

impl Case {
    pub(super) fn check_sandpile(&self) -> Result<(), CaseError> {
        self.check_table_files()?;
        for (index, source) in self.sources.iter().enumerate() {
            self.check_span(&format!("source[{index}]"), source)?;
        }
        match self.grid.as_ref().and_then(|grid| grid.y.as_ref()) {
            None => self.check_pouring::<1>(),
            Some(_) => self.check_pouring::<2>(),
        }
    }

    /// The table, and what is poured on it.
    fn check_pouring<const D: usize>(&self) -> Result<(), CaseError> {
        let plan = self.table::<D>()?;
        let sources = self.sources(&plan)?;
        for (index, part) in sources.parts.iter().enumerate() {
            self.check_rate(&format!("source[{index}]"), part, &plan)?;
        }
        self.check_direct(&sources)?;
        if self.time.until == Some(Until::Steady)
            && let Some((source, cell)) = swamped(&plan, &sources)
        {
            let place = plan.centres.place(cell);
            let message = format!(
                "the pile can never be steady: source[{source}] pours for ever on a piece of the table without an open edge, at {place}"
            );
            return Err(self.fault(
                "time.until",
                message,
                "open an edge of that piece (table.open, fewer [[table.wall]]), end the source with to = ..., or run to end = ...",
            ));
        }
        Ok(())
    }

    fn check_table_files(&self) -> Result<(), CaseError> {
        let regions = |key: String, region: &Region| match region.needs_file() {
            Some(path) => self.check_file(&format!("{key}.file"), path),
            None => Ok(()),
        };
        if let Some(table) = &self.table {
            table.mask.iter().try_for_each(|mask| regions("table.mask".to_owned(), mask))?;
            for (index, cut) in table.cut.iter().enumerate() {
                regions(format!("table.cut[{index}]"), cut)?;
            }
            for (index, wall) in table.wall.iter().enumerate() {
                regions(format!("table.wall[{index}].on"), &wall.on)?;
            }
            if let Some(path) = table.height.as_ref().and_then(Quantity::needs_file) {
                self.check_file("table.height.file", path)?;
            }
        }
        for (index, source) in self.sources.iter().enumerate() {
            source.on.iter().try_for_each(|on| regions(format!("source[{index}].on"), on))?;
        }
        Ok(())
    }

    /// The times of a source.
    fn check_span(&self, key: &str, source: &SandSource) -> Result<(), CaseError> {
        let [from, to] = source.span();
        self.number(&format!("{key}.from"), from, |from| from >= 0.0, "a time >= 0")?;
        if to.is_nan() || from >= to {
            let message = format!("from = {from} is not before to = {to}");
            return Err(self.fault(&format!("{key}.to"), message, "a source pours while from <= t < to"));
        }
        Ok(())
    }

    /// The rate of a source on its cells: at its beginning, and some way on if it moves.
    fn check_rate<const D: usize>(
        &self,
        key: &str,
        part: &Part,
        plan: &TablePlan<D>,
    ) -> Result<(), CaseError> {
        if part.cells.is_empty() {
            return Err(self.fault(
                &format!("{key}.on"),
                "the source lies off the table: no cell of the table has its centre in it",
                "move or widen it; without `on` it pours on the whole table",
            ));
        }
        let [from, to] = part.span;
        let end = to.min(self.time.end.unwrap_or(f64::INFINITY));
        let mut times = vec![from];
        if part.is_moving() && end > from && end.is_finite() {
            let instant = |k| from + (end - from) * f64::from(k) / f64::from(INSTANTS);
            times.extend((1..=INSTANTS).map(instant));
        }
        for t in times {
            for (cell, place) in &part.cells {
                let rate = part.written(*place, t);
                if !(rate >= 0.0 && rate.is_finite()) {
                    let message = format!("the rate is {rate} at {}, time {t}", plan.centres.place(*cell));
                    return Err(self.fault(
                        &format!("{key}.rate"),
                        message,
                        "a source only pours, at a finite rate; max(..., 0) cuts a formula off",
                    ));
                }
            }
        }
        Ok(())
    }

    /// What the equilibrium without stepping needs, and what would have no effect on it.
    fn check_direct(&self, sources: &Sources) -> Result<(), CaseError> {
        if self.time.method.is_none() {
            return Ok(());
        }
        for (key, given) in [
            ("time.steps", self.time.steps.is_some()),
            ("time.end", self.time.end.is_some()),
            ("time.steady_rate", self.time.steady_rate.is_some()),
            ("scheme.step", self.scheme.step.is_some()),
            ("scheme.courant", self.scheme.courant.is_some()),
            ("scheme.theta_exponent", self.scheme.theta_exponent.is_some()),
            ("initial", self.initial.is_some()),
        ] {
            if given {
                let message = format!("`{key}` has no effect with time.method = \"direct\"");
                return Err(self.fault(key, message, "remove it, or remove the method to step through time"));
            }
        }
        let Some(rates) = sources.lasting() else {
            let moving = |source: &SandSource| matches!(source.rate, Rate::Varying(_));
            let index = self.sources.iter().position(moving).unwrap_or(0);
            return Err(self.fault(
                &format!("source[{index}].rate"),
                "a source that moves has no equilibrium, which time.method = \"direct\" computes",
                "leave t out of the formula, end the source with to = ..., or remove the method to step through time",
            ));
        };
        if rates.iter().all(|rate| *rate == 0.0) {
            return Err(self.fault(
                "time.method",
                "no source pours for ever, so the equilibrium is not determined by the equations",
                "add a [[source]] without `to`, or remove the method to step through time",
            ));
        }
        Ok(())
    }

    /// What is allowed but may surprise; nothing where the case is not in order.
    pub(super) fn sandpile_notes(&self) -> Vec<String> {
        let notes = match self.grid.as_ref().and_then(|grid| grid.y.as_ref()) {
            None => self.pouring_notes::<1>(),
            Some(_) => self.pouring_notes::<2>(),
        };
        notes.unwrap_or_default()
    }

    fn pouring_notes<const D: usize>(&self) -> Result<Vec<String>, CaseError> {
        let plan = self.table::<D>()?;
        let sources = self.sources(&plan)?;
        let mut notes = Vec::new();
        let pieces = plan.table.pieces().len();
        if pieces > 1 {
            notes.push(format!("the table is in {pieces} pieces, each with a pile of its own"));
        }
        if plan.table.dropped() > 0 {
            notes.push(format!(
                "{} cells are taken off the table: it is one cell wide there between open edges, so that no sand can stand on them",
                plan.table.dropped()
            ));
        }
        for (index, part) in sources.parts.iter().enumerate() {
            if part.lost > 0.0 {
                let percent = 100.0 * part.lost;
                notes.push(format!(
                    "source[{index}]: {percent:.1} % of its cells lie off the table and get nothing"
                ));
            }
            if part.beyond {
                notes.push(format!("source[{index}] reaches beyond the grid; what lies there gets nothing"));
            }
        }
        if plan.clipped > 0.0 {
            notes.push(format!(
                "initial.standing_layer is up to {} at open edges, where sand falls off: it is 0 there",
                plan.clipped
            ));
        }
        if let Some((source, cell)) = swamped(&plan, &sources) {
            notes.push(format!(
                "source[{source}] pours for ever on a piece of the table without an open edge, at {}: its layers grow until the end",
                plan.centres.place(cell)
            ));
        }
        if self.sources.is_empty() && plan.rolling.iter().all(|v| *v == 0.0) {
            notes.push("no [[source]] and no initial.rolling_layer: nothing will move".to_owned());
        }
        Ok(notes)
    }
}

/// The first source that pours for ever on a piece of the table without an open edge, and one of its cells there.
fn swamped<const D: usize>(plan: &TablePlan<D>, sources: &Sources) -> Option<(usize, usize)> {
    let walled = plan.table.pieces().into_iter().filter(|piece| piece.open_edges == 0);
    let walled: HashSet<[usize; D]> = walled.flat_map(|piece| piece.cells).collect();
    let lasting = sources.parts.iter().enumerate().filter(|(_, part)| part.span[1] == f64::INFINITY);
    lasting.into_iter().find_map(|(index, part)| {
        let pours = |(cell, place): &&(usize, [f64; 2])| {
            walled.contains(&plan.index(*cell)) && part.written(*place, part.span[0]) > 0.0
        };
        part.cells.iter().find(pours).map(|(cell, _)| (index, *cell))
    })
}
