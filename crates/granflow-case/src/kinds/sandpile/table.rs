//! `[table]`: what the sand lies on, where it falls off and where walls hold it back.

use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize};

use crate::quantity::Quantity;
use crate::region::Region;
use granflow_model::hadeler_kuttler::table as library;
use granflow_model::scheme::Side;

/// The table: the whole grid, unless `mask` and `cut` say otherwise; a cell belongs to it if
/// its centre does.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Table")]
pub(super) struct Words {
    /// Edges over which the sand falls: "all" (the default, holes too), or a list of left, right, bottom, top, hole; the
    /// other edges are walls.
    #[serde(default, deserialize_with = "open", skip_serializing_if = "Option::is_none")]
    #[schemars(schema_with = "open_schema")]
    pub open: Option<Vec<Edge>>,
    /// Walls on parts of open edges.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub wall: Vec<Wall>,
    /// The shape of the table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mask: Option<Region>,
    /// What is cut out of the table.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cut: Vec<Region>,
    /// Height of the table at the corners of the cells, nowhere steeper than 1 (default 0: flat).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub height: Option<Quantity>,
}

/// An edge of the table, by the side it faces; towards a hole it is an edge of the hole, whichever side it faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Edge {
    /// It faces towards smaller x.
    Left,
    /// It faces towards greater x.
    Right,
    /// It faces towards smaller y.
    Bottom,
    /// It faces towards greater y.
    Top,
    /// It faces an enclosed part of the grid that is off the table.
    Hole,
}

impl Edge {
    /// The name of an edge of the library's table.
    #[must_use]
    pub fn of<const D: usize>(edge: &library::Edge<D>) -> Self {
        match (edge.hole, edge.axis, edge.faces) {
            (true, ..) => Self::Hole,
            (false, 0, Side::Left) => Self::Left,
            (false, 0, Side::Right) => Self::Right,
            (false, _, Side::Left) => Self::Bottom,
            (false, _, Side::Right) => Self::Top,
        }
    }

    /// The name a case file writes.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
            Self::Bottom => "bottom",
            Self::Top => "top",
            Self::Hole => "hole",
        }
    }
}

/// A wall along the edges of the table whose midpoints lie in a region.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Wall {
    /// The region.
    pub on: Region,
}

/// Reads "all" as `None`, or a list of edges.
fn open<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Vec<Edge>>, D::Error> {
    struct Words;
    impl<'de> serde::de::Visitor<'de> for Words {
        type Value = Option<Vec<Edge>>;
        fn expecting(&self, to: &mut fmt::Formatter) -> fmt::Result {
            to.write_str("\"all\" or a list of \"left\", \"right\", \"bottom\", \"top\", \"hole\"")
        }
        fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Self::Value, E> {
            let wrong = || serde::de::Error::invalid_value(serde::de::Unexpected::Str(text), &self);
            if text == "all" { Ok(None) } else { Err(wrong()) }
        }
        fn visit_seq<A: serde::de::SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
            let mut found = Vec::new();
            while let Some(edge) = list.next_element()? {
                found.push(edge);
            }
            Ok(Some(found))
        }
    }
    from.deserialize_any(Words)
}

fn open_schema(generator: &mut SchemaGenerator) -> Schema {
    let edges = generator.subschema_for::<Vec<Edge>>();
    json_schema!({
        "description": "Edges over which the sand falls: \"all\", or a list of left, right, bottom, top, hole.",
        "anyOf": [{ "const": "all" }, edges],
    })
}
