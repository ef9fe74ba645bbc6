//! `[[source]]`: sand that is poured on the table.

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use super::plan::TablePlan;
use crate::choice::{Plain, plain_or_table};
use crate::fault::{CaseError, PartFault};
use crate::formula::Formula;
use crate::look::Look;
use crate::region::Region;

/// A source of sand; several add up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Source")]
pub(super) struct Words {
    /// Rate f, thickness per time, not negative.
    pub rate: Rate,
    /// Where it pours: the cells whose centres lie in the region (default: the whole table).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub on: Option<Region>,
    /// When it begins (default 0).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from: Option<f64>,
    /// When it ends (default: never).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to: Option<f64>,
}

/// The rate of a source: a number, or a formula in x, y and the time t.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub(super) enum Rate {
    /// The same everywhere and always.
    Constant(f64),
    /// It varies.
    Varying(Varying),
}

/// A rate that varies in place or time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum Varying {
    /// A formula in x, y and t; where it falls below 0, or is no number, after its beginning it counts as 0.
    Formula(String),
}

impl<'de> Deserialize<'de> for Rate {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let expected = "a number or a formula";
        let read = |value: Plain| match value {
            Plain::Number(number) => Ok(Self::Constant(number)),
            Plain::Text(text) => Err(format!(
                "found the text \"{text}\", expected {expected}; write rate.formula = \"{text}\""
            )),
        };
        plain_or_table(from, expected, read, Self::Varying)
    }
}

impl Words {
    /// When it pours: from <= t < to.
    pub(super) fn span(&self) -> [f64; 2] {
        [self.from.unwrap_or(0.0), self.to.unwrap_or(f64::INFINITY)]
    }
}

/// All sources of a case, cell by cell.
#[derive(Debug, Clone)]
pub struct Sources {
    cells: usize,
    pub(super) parts: Vec<Part>,
}

/// One source on its cells.
#[derive(Debug, Clone)]
pub(super) struct Part {
    pub span: [f64; 2],
    /// Numbers and centres of its cells on the table.
    pub cells: Vec<(usize, [f64; 2])>,
    rate: Law,
    /// Share of its cells on the grid that lie off the table.
    pub lost: f64,
    /// Whether its region reaches beyond the grid.
    pub beyond: bool,
}

#[derive(Debug, Clone)]
enum Law {
    Constant(f64),
    Formula(Formula),
}

/// Number of t among the variables of a rate.
const TIME: usize = 2;

impl Part {
    /// The rate as it is written, at a place and a time.
    pub(super) fn written(&self, [x, y]: [f64; 2], t: f64) -> f64 {
        match &self.rate {
            Law::Constant(rate) => *rate,
            Law::Formula(formula) => formula.at(&[x, y, t]),
        }
    }

    pub(super) fn is_moving(&self) -> bool {
        matches!(&self.rate, Law::Formula(formula) if formula.uses(TIME))
    }

    fn add(&self, t: f64, rates: &mut [f64]) {
        for (cell, place) in &self.cells {
            rates[*cell] += self.written(*place, t).max(0.0);
        }
    }
}

impl Sources {
    /// Bytes that the places of its cells take.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.parts.iter().map(|part| size_of_val(part.cells.as_slice())).sum()
    }

    /// The rate f of every cell at time t, x fastest; 0 off the table.
    #[must_use]
    pub fn rate(&self, t: f64) -> Vec<f64> {
        let mut rates = vec![0.0; self.cells];
        let pouring = |part: &&Part| part.span[0] <= t && t < part.span[1];
        self.parts.iter().filter(pouring).for_each(|part| part.add(t, &mut rates));
        rates
    }

    /// The times after 0 at which a source begins or ends, growing.
    #[must_use]
    pub fn changes(&self) -> Vec<f64> {
        let times = self.parts.iter().flat_map(|part| part.span);
        let mut times: Vec<f64> = times.filter(|time| *time > 0.0 && time.is_finite()).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }

    /// Whether a rate depends on the time by a formula at `time` or later, so that it changes between the times of
    /// [`Sources::changes`].
    #[must_use]
    pub fn is_moving(&self, time: f64) -> bool {
        self.parts.iter().any(|part| part.span[1] > time && part.is_moving())
    }

    /// The rate of every cell once all switching is over, from the sources that never end; `None` if one of them moves.
    #[must_use]
    pub fn lasting(&self) -> Option<Vec<f64>> {
        let mut rates = vec![0.0; self.cells];
        for part in self.parts.iter().filter(|part| part.span[1] == f64::INFINITY) {
            if part.is_moving() {
                return None;
            }
            part.add(part.span[0], &mut rates);
        }
        Some(rates)
    }
}

/// Evaluates the sources on the cells of the table.
pub(super) fn sources<const D: usize>(
    look: &Look,
    written: &[Words],
    plan: &TablePlan<D>,
) -> Result<Sources, CaseError> {
    let parts = written.iter().enumerate();
    let parts = parts.map(|(index, source)| part(look, &format!("source[{index}]"), source, plan));
    Ok(Sources { cells: plan.rolling.len(), parts: parts.collect::<Result<_, _>>()? })
}

/// One source, which stands at `key`.
fn part<const D: usize>(
    look: &Look,
    key: &str,
    source: &Words,
    plan: &TablePlan<D>,
) -> Result<Part, CaseError> {
    let fault = |name: &str, fault: PartFault| look.part_fault(&format!("{key}.{name}"), fault);
    let points = &plan.centres;
    let rate = match &source.rate {
        Rate::Constant(rate) => Law::Constant(*rate),
        Rate::Varying(Varying::Formula(text)) => Formula::parse(text, &["x", "y", "t"])
            .map(Law::Formula)
            .map_err(|error| fault("rate", PartFault::formula("formula", error)))?,
    };
    let area = source.on.as_ref().map(|on| on.area(points, look)).transpose();
    let area = area.map_err(|part| fault("on", part))?;
    let on = |place| area.as_ref().is_none_or(|area| area.holds(place, plan.slack));
    let meant: Vec<_> = points.iter().enumerate().filter(|(_, place)| on(*place)).collect();
    let cells: Vec<_> = meant.iter().copied().filter(|(cell, _)| plan.inside(*cell)).collect();
    let lost = match &area {
        Some(_) if !meant.is_empty() => 1.0 - cells.len() as f64 / meant.len() as f64,
        _ => 0.0,
    };
    let beyond = area.is_some_and(|area| plan.reaches_beyond(area.bounds()));
    Ok(Part { span: source.span(), cells, rate, lost, beyond })
}
