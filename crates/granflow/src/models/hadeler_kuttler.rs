//! Growing sandpiles after Hadeler & Kuttler, as the files show them: on a table, in the papers' scaling.

#[cfg(feature = "figures")]
mod figures;
#[cfg(feature = "figures")]
mod history;
#[cfg(feature = "figures")]
mod pictures;
pub mod run;
mod table;

pub use table::TableDomain;

use crate::model::{At, Model, Quantity, Words};

const PURE: [&str; 2] = ["1", "1"];

/// The model.
pub static MODEL: Model = Model {
    name: "hadeler_kuttler",
    quantities: &[
        Quantity::series("standing_layer", "thickness of the standing layer", PURE).at(At::Nodes),
        Quantity::series("rolling_layer", "thickness of the rolling layer", PURE),
        Quantity::fixed("table_height", "height of the table", PURE).at(At::Nodes).exact().tabulated(),
        Quantity::fixed("wall_x", "1 where the face across x is a wall, else 0", PURE).at(At::FacesX),
        Quantity::fixed("wall_y", "1 where the face across y is a wall, else 0", PURE).at(At::FacesY),
        Quantity::map("source", "sand poured on per area and time at the end", PURE),
        Quantity::map("determined", "1 where the equilibrium fixes the standing layer, else 0", PURE)
            .at(At::Nodes),
    ],
    outlets: ["left", "right", "bottom", "top", "hole"],
    words: Words { wet: "cells with sand", fastest: "rolling layer at most" },
    last_instant: true,
    #[cfg(feature = "figures")]
    pictures: Some(&pictures::Sandpile),
    ..Model::PLAIN
};
