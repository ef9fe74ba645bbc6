//! What happens at the edges of a grid.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::fault::CaseError;
use super::grid::Grid;
use super::look::Look;

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

impl Boundary {
    /// What happens at the low and the high edge along x and along y; both or none of the edges of an axis are periodic.
    pub(crate) fn check(&self, look: &Look, grid: &Grid) -> Result<[[Side; 2]; 2], CaseError> {
        if grid.y.is_none() && look.source.has("grid.boundary.y") {
            return Err(look.fault("grid.boundary.y", "the grid has no y", "remove it, or add grid.y"));
        }
        let sides = match self {
            Self::Uniform(side) => [[*side; 2]; 2],
            Self::Axes(axes) => [axes.x.sides(), axes.y.sides()],
        };
        for (name, pair) in ["x", "y"].into_iter().zip(sides) {
            if (pair[0] == Side::Periodic) != (pair[1] == Side::Periodic) {
                let key = format!("grid.boundary.{name}");
                let cure = format!("write {name} = \"periodic\" for both ends");
                return Err(look.fault(&key, "one end is periodic, the other is not", &cure));
            }
        }
        Ok(sides)
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
    pub(crate) fn sides(&self) -> [Side; 2] {
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
