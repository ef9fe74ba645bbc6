//! `[grid]`: the cells of a scaled case.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::fault::CaseError;
use super::look::{LARGEST, Look};
use super::memory;

/// More cells than any machine holds.
const MAX_CELLS: u64 = 1 << 36;

/// A regular grid along x, and along y if the case is two-dimensional, in the case's unit of length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Grid {
    /// The cells along x, down the chute.
    pub x: Axis,
    /// The cells along y, across the chute; without it the case is one-dimensional.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y: Option<Axis>,
}

impl Grid {
    /// Number of cells along x and along y (1 if the case is one-dimensional).
    #[must_use]
    pub fn cells(&self) -> [usize; 2] {
        [self.x.cells, self.y.as_ref().map_or(1, |y| y.cells)]
    }

    /// The axes, in their order.
    pub fn axes(&self) -> impl Iterator<Item = &Axis> {
        std::iter::once(&self.x).chain(&self.y)
    }

    /// Ends, widths and number of the cells; a cell takes `bytes` at least, before any of them is asked for.
    pub(crate) fn check(&self, look: &Look, bytes: f64) -> Result<(), CaseError> {
        self.x.check(look, "grid.x")?;
        self.y.as_ref().map_or(Ok(()), |y| y.check(look, "grid.y"))?;
        let cells = self.cells();
        if cells[0].checked_mul(cells[1]).is_none_or(|count| count as u64 > MAX_CELLS) {
            let message = format!("{} x {} cells are more than any machine holds", cells[0], cells[1]);
            return Err(look.source.fault("grid.x.cells", message));
        }
        let needed = bytes * cells[0] as f64 * cells[1] as f64;
        if let Some(free) = memory::available().filter(|free| needed > *free as f64) {
            let [needed, free] = [needed, free as f64].map(memory::in_words);
            let message =
                format!("{} x {} cells need more than {needed}, {free} are free", cells[0], cells[1]);
            return Err(look.fault(
                "grid.x.cells",
                message,
                "take fewer cells, or a machine with more memory",
            ));
        }
        Ok(())
    }

    /// The centres of the cells.
    #[must_use]
    pub fn centres(&self) -> Points {
        self.points(Axis::centre, 0)
    }

    /// The corners of the cells, one more along each axis than there are cells.
    #[must_use]
    pub fn nodes(&self) -> Points {
        self.points(Axis::face, 1)
    }

    fn points(&self, place: fn(&Axis, usize) -> f64, more: usize) -> Points {
        let along = |axis: &Axis| Places { axis: axis.clone(), place, count: axis.cells + more };
        Points { x: along(&self.x), y: self.y.as_ref().map(along) }
    }
}

/// Equal cells between two ends: cell i is [from + i dx, from + (i + 1) dx] with dx = (to - from)/cells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// Low end of the first cell.
    pub from: f64,
    /// High end of the last cell.
    pub to: f64,
    /// Number of cells, at least 3.
    pub cells: usize,
}

impl Axis {
    fn check(&self, look: &Look, key: &str) -> Result<(), CaseError> {
        for (end, value) in [("from", self.from), ("to", self.to)] {
            let near = |value: f64| value.abs() <= LARGEST;
            let cure = "take a unit of length in which the grid is neither huge nor tiny";
            look.number(&format!("{key}.{end}"), value, near, "a number between -1e12 and 1e12")
                .map_err(|error| error.help(cure))?;
        }
        let (from, to, cells) = (self.from, self.to, self.cells);
        if from >= to {
            return Err(look.fault(
                &format!("{key}.from"),
                format!("from = {from} is not below to = {to}"),
                "from is the low end of the grid, to the high end",
            ));
        }
        let cells_key = format!("{key}.cells");
        if cells < 3 {
            return Err(look.source.fault(&cells_key, format!("found {cells} cells, expected at least 3")));
        }
        let width = self.width();
        if !(width >= 1.0 / LARGEST && from + width > from && to - width < to) {
            return Err(look.fault(
                &cells_key,
                format!("the cells are {width:e} wide, too small to be told apart"),
                "take fewer cells, or a unit of length in which they are wider than 1e-12",
            ));
        }
        Ok(())
    }

    /// Width of a cell, dx = (to - from)/cells.
    #[must_use]
    pub fn width(&self) -> f64 {
        (self.to - self.from) / self.cells as f64
    }

    /// Centre of cell `index`; the grid is exactly symmetric if its ends are.
    #[must_use]
    pub fn centre(&self, index: usize) -> f64 {
        self.between(2 * index + 1)
    }

    /// Face number `index` of cells + 1: the low end of cell `index`.
    #[must_use]
    pub fn face(&self, index: usize) -> f64 {
        self.between(2 * index)
    }

    /// The point `halves` half cells from the low end, by weights that a mirrored axis mirrors bit for bit.
    fn between(&self, halves: usize) -> f64 {
        let all = 2 * self.cells;
        (self.from * (all - halves) as f64 + self.to * halves as f64) / all as f64
    }
}

/// The points where a quantity has values: every x with every y, x fastest. They take no memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    /// Places along x.
    pub x: Places,
    /// Places along y; none in one dimension, where y = 0.
    pub y: Option<Places>,
}

/// The centres of the cells of an axis, or their ends.
#[derive(Clone)]
pub struct Places {
    axis: Axis,
    place: fn(&Axis, usize) -> f64,
    count: usize,
}

impl Places {
    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    /// Place number `index`.
    #[must_use]
    pub fn at(&self, index: usize) -> f64 {
        (self.place)(&self.axis, index)
    }

    /// All of them.
    #[must_use]
    pub fn to_vec(&self) -> Vec<f64> {
        (0..self.count).map(|index| self.at(index)).collect()
    }
}

impl PartialEq for Places {
    fn eq(&self, other: &Self) -> bool {
        (&self.axis, self.count) == (&other.axis, other.count)
    }
}

impl fmt::Debug for Places {
    fn fmt(&self, to: &mut fmt::Formatter) -> fmt::Result {
        write!(to, "{} places of {:?}", self.count, self.axis)
    }
}

impl Points {
    /// Number of points along x and along y (1 in one dimension).
    #[must_use]
    pub fn counts(&self) -> [usize; 2] {
        [self.x.count(), self.y.as_ref().map_or(1, Places::count)]
    }

    /// Point number `index`.
    #[must_use]
    pub fn at(&self, index: usize) -> [f64; 2] {
        let columns = self.x.count();
        let y = self.y.as_ref().map_or(0.0, |y| y.at(index / columns));
        [self.x.at(index % columns), y]
    }

    /// All points in their order.
    pub fn iter(&self) -> impl Iterator<Item = [f64; 2]> {
        let [nx, ny] = self.counts();
        (0..nx * ny).map(|index| self.at(index))
    }

    /// Point number `index` in words.
    #[must_use]
    pub fn place(&self, index: usize) -> String {
        self.words(self.at(index))
    }

    /// A place in words, as long as it has coordinates.
    pub(crate) fn words(&self, [x, y]: [f64; 2]) -> String {
        if self.y.is_some() { format!("x = {x}, y = {y}") } else { format!("x = {x}") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_symmetric_axis_is_symmetric_bit_for_bit() {
        let axis = Axis { from: -6.0, to: 6.0, cells: 240 };
        for index in 0..240 {
            assert_eq!(axis.centre(index), -axis.centre(239 - index));
        }
        assert_eq!((axis.face(0), axis.face(120), axis.face(240)), (-6.0, 0.0, 6.0));
        assert_eq!(axis.width(), 0.05);
        assert_eq!(axis.face(100), -1.0, "a step at a face must not fall to either side by rounding");
    }
}
