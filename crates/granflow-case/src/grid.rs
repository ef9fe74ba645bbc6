//! `[grid]`: the cells of a scaled case and what happens at its edges.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A regular grid along x, and along y if the case is two-dimensional, in the case's unit of length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Grid {
    /// The cells along x, down the chute.
    pub x: Axis,
    /// The cells along y, across the chute; without it the case is one-dimensional.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y: Option<Axis>,
    /// What happens at the edges: one word for all, or { x = ..., y = ... } with a word or a pair [low, high] each (default
    /// "open"); hadeler_kuttler has table.open instead.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub boundary: Option<Boundary>,
}

impl Grid {
    /// Number of cells along x and along y (1 if the case is one-dimensional).
    #[must_use]
    pub fn cells(&self) -> [usize; 2] {
        [self.x.cells, self.y.as_ref().map_or(1, |y| y.cells)]
    }

    /// The centres of the cells.
    #[must_use]
    pub fn centres(&self) -> Points {
        Points { x: self.x.centres(), y: self.y.as_ref().map(Axis::centres) }
    }

    /// The corners of the cells, one more along each axis than there are cells.
    #[must_use]
    pub fn nodes(&self) -> Points {
        Points { x: self.x.faces(), y: self.y.as_ref().map(Axis::faces) }
    }

    /// What happens at the low and the high edge along x and along y.
    #[must_use]
    pub fn sides(&self) -> [[Side; 2]; 2] {
        match &self.boundary {
            None => [[Side::Open; 2]; 2],
            Some(Boundary::Uniform(side)) => [[*side; 2]; 2],
            Some(Boundary::Axes(axes)) => [axes.x.sides(), axes.y.sides()],
        }
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

    /// Centres of all cells.
    #[must_use]
    pub fn centres(&self) -> Vec<f64> {
        (0..self.cells).map(|index| self.centre(index)).collect()
    }

    /// All faces, one more than there are cells.
    #[must_use]
    pub fn faces(&self) -> Vec<f64> {
        (0..=self.cells).map(|index| self.face(index)).collect()
    }
}

/// The points where a quantity has values: every x with every y, x fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    /// Places along x.
    pub x: Vec<f64>,
    /// Places along y; none in one dimension, where y = 0.
    pub y: Option<Vec<f64>>,
}

impl Points {
    /// Number of points along x and along y (1 in one dimension).
    #[must_use]
    pub fn counts(&self) -> [usize; 2] {
        [self.x.len(), self.y.as_ref().map_or(1, Vec::len)]
    }

    /// Point number `index`.
    #[must_use]
    pub fn at(&self, index: usize) -> [f64; 2] {
        let y = self.y.as_ref().map_or(0.0, |y| y[index / self.x.len()]);
        [self.x[index % self.x.len()], y]
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
    pub(super) fn words(&self, [x, y]: [f64; 2]) -> String {
        if self.y.is_some() { format!("x = {x}, y = {y}") } else { format!("x = {x}") }
    }
}

/// What happens at an edge of the grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// What arrives leaves: the ghost cell copies the edge cell.
    #[default]
    Open,
    /// Nothing passes: the ghost cell mirrors the edge cell.
    Wall,
    /// What leaves here enters at the opposite edge.
    Periodic,
}

/// The edges of the grid: all alike, or axis by axis.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Boundary {
    /// The same at every edge.
    Uniform(Side),
    /// Axis by axis.
    Axes(AxisSides),
}

impl Default for Boundary {
    fn default() -> Self {
        Self::Uniform(Side::Open)
    }
}

/// The edges along each axis; an axis that is not named is open.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AxisSides {
    /// At the low and the high end of x.
    #[serde(default)]
    pub x: SidePair,
    /// At the low and the high end of y.
    #[serde(default)]
    pub y: SidePair,
}

/// One word for both ends of an axis, or a pair [low, high].
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum SidePair {
    /// Both ends.
    Both(Side),
    /// The low and the high end.
    Pair([Side; 2]),
}

impl Default for SidePair {
    fn default() -> Self {
        Self::Both(Side::Open)
    }
}

impl SidePair {
    fn sides(&self) -> [Side; 2] {
        match self {
            Self::Both(side) => [*side; 2],
            Self::Pair(pair) => *pair,
        }
    }
}

/// Reads a side from a word, with serde's own message for a wrong one.
fn word<E: serde::de::Error>(text: &str) -> Result<Side, E> {
    Side::deserialize(serde::de::value::StrDeserializer::new(text))
}

impl<'de> Deserialize<'de> for SidePair {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Words;
        impl<'de> serde::de::Visitor<'de> for Words {
            type Value = SidePair;
            fn expecting(&self, to: &mut std::fmt::Formatter) -> std::fmt::Result {
                to.write_str("\"open\", \"wall\", \"periodic\" or a pair of them, [low, high]")
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<SidePair, E> {
                word(text).map(SidePair::Both)
            }
            fn visit_seq<A: serde::de::SeqAccess<'de>>(self, mut list: A) -> Result<SidePair, A::Error> {
                let mut found = Vec::new();
                while let Some(side) = list.next_element()? {
                    found.push(side);
                }
                let count = found.len();
                found
                    .try_into()
                    .map(SidePair::Pair)
                    .map_err(|_| serde::de::Error::invalid_length(count, &self))
            }
        }
        from.deserialize_any(Words)
    }
}

impl<'de> Deserialize<'de> for Boundary {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct WordOrAxes;
        impl<'de> serde::de::Visitor<'de> for WordOrAxes {
            type Value = Boundary;
            fn expecting(&self, to: &mut std::fmt::Formatter) -> std::fmt::Result {
                to.write_str("\"open\", \"wall\", \"periodic\" or { x = ..., y = ... }")
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Boundary, E> {
                word(text).map(Boundary::Uniform)
            }
            fn visit_map<A: serde::de::MapAccess<'de>>(self, map: A) -> Result<Boundary, A::Error> {
                AxisSides::deserialize(serde::de::value::MapAccessDeserializer::new(map)).map(Boundary::Axes)
            }
        }
        from.deserialize_any(WordOrAxes)
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
