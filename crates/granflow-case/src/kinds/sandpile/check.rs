//! What can be said about the table and the sources of a sandpile.

use super::source::{Part, Rate, Sources, sources};
use super::{Pile, SourceWords, TablePlan, Words};
use crate::fault::CaseError;
use crate::look::Look;
use crate::quantity::Quantity;
use crate::region::Region;
use std::collections::HashSet;

/// Instants of a moving source, besides its beginning, at which its rate is checked.
const INSTANTS: u32 = 16;

impl Words {
    /// The table and what is poured on it, checked together; a run that `waits` for the steady state must be able to
    /// reach it.
    pub(super) fn pile<const D: usize>(
        &self,
        look: &Look,
        waits: bool,
        notes: &mut Vec<String>,
    ) -> Result<Pile<D>, CaseError> {
        for (index, source) in self.sources.iter().enumerate() {
            check_span(look, &format!("source[{index}]"), source)?;
        }
        let table = self.table(look)?;
        let sources = sources(look, &self.sources, &table)?;
        for (index, part) in sources.parts.iter().enumerate() {
            self.check_rate(look, &format!("source[{index}]"), part, &table)?;
        }
        self.check_direct(look, &sources)?;
        let pile = Pile { table, sources };
        let swamped = pile.swamped().map(|(source, cell)| (source, pile.table.centres.place(cell)));
        if waits && let Some((source, place)) = swamped {
            let message = format!(
                "the pile can never be steady: source[{source}] pours for ever on a piece of the table without an open edge, at {place}"
            );
            return Err(look.fault(
                "time.until",
                message,
                "open an edge of that piece (table.open, fewer [[table.wall]]), end the source with to = ..., or run to end = ...",
            ));
        }
        pile.note(swamped, notes);
        Ok(pile)
    }

    /// The files of the regions and the quantities must exist.
    pub(super) fn check_files(&self, look: &Look) -> Result<(), CaseError> {
        let layers = self.initial.iter().flat_map(|initial| {
            [("standing_layer", &initial.standing_layer), ("rolling_layer", &initial.rolling_layer)]
        });
        for (name, layer) in layers {
            if let Some(path) = layer.as_ref().and_then(Quantity::needs_file) {
                look.file(&format!("initial.{name}.file"), path)?;
            }
        }
        let regions = |key: String, region: &Region| match region.needs_file() {
            Some(path) => look.file(&format!("{key}.file"), path),
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
                look.file("table.height.file", path)?;
            }
        }
        for (index, source) in self.sources.iter().enumerate() {
            source.on.iter().try_for_each(|on| regions(format!("source[{index}].on"), on))?;
        }
        Ok(())
    }

    /// The rate of a source on its cells: at its beginning, and some way on if it moves.
    fn check_rate<const D: usize>(
        &self,
        look: &Look,
        key: &str,
        part: &Part,
        plan: &TablePlan<D>,
    ) -> Result<(), CaseError> {
        if part.cells.is_empty() {
            return Err(look.fault(
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
                    return Err(look.fault(
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
    fn check_direct(&self, look: &Look, sources: &Sources) -> Result<(), CaseError> {
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
                return Err(look.fault(key, message, "remove it, or remove the method to step through time"));
            }
        }
        let Some(rates) = sources.lasting() else {
            let moving = |source: &SourceWords| matches!(source.rate, Rate::Varying(_));
            let index = self.sources.iter().position(moving).unwrap_or(0);
            return Err(look.fault(
                &format!("source[{index}].rate"),
                "a source that moves has no equilibrium, which time.method = \"direct\" computes",
                "leave t out of the formula, end the source with to = ..., or remove the method to step through time",
            ));
        };
        if rates.iter().all(|rate| *rate == 0.0) {
            return Err(look.fault(
                "time.method",
                "no source pours for ever, so the equilibrium is not determined by the equations",
                "add a [[source]] without `to`, or remove the method to step through time",
            ));
        }
        Ok(())
    }
}

/// The times of a source.
fn check_span(look: &Look, key: &str, source: &SourceWords) -> Result<(), CaseError> {
    let [from, to] = source.span();
    look.number(&format!("{key}.from"), from, |from| from >= 0.0, "a time >= 0")?;
    if to.is_nan() || from >= to {
        let message = format!("from = {from} is not before to = {to}");
        return Err(look.fault(&format!("{key}.to"), message, "a source pours while from <= t < to"));
    }
    Ok(())
}

impl<const D: usize> Pile<D> {
    /// What is allowed but may surprise; `swamped` is the source that never ends and its place.
    fn note(&self, swamped: Option<(usize, String)>, notes: &mut Vec<String>) {
        let Self { table, sources } = self;
        let pieces = table.table.pieces().len();
        if pieces > 1 {
            notes.push(format!("the table is in {pieces} pieces, each with a pile of its own"));
        }
        if table.table.dropped() > 0 {
            notes.push(format!(
                "{} cells are taken off the table: it is one cell wide there between open edges, so that no sand can stand on them",
                table.table.dropped()
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
        if table.clipped > 0.0 {
            notes.push(format!(
                "initial.standing_layer is up to {} at open edges, where sand falls off: it is 0 there",
                table.clipped
            ));
        }
        if let Some((source, place)) = swamped {
            notes.push(format!(
                "source[{source}] pours for ever on a piece of the table without an open edge, at {place}: its layers grow until the end"
            ));
        }
        if sources.parts.is_empty() && table.rolling.iter().all(|v| *v == 0.0) {
            notes.push("no [[source]] and no initial.rolling_layer: nothing will move".to_owned());
        }
    }

    /// The first source that pours for ever on a piece of the table without an open edge, and one of its cells there.
    fn swamped(&self) -> Option<(usize, usize)> {
        let Self { table: plan, sources } = self;
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
}
