//! A named field of every frame.

use serde::{Deserialize, Serialize};

/// A named field of every frame and how many numbers it has.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Field {
    /// The name, as the variable of the result is called.
    pub name: String,
    /// How many numbers one frame holds.
    pub length: usize,
}
