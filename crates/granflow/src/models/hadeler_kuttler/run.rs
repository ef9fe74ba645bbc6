//! From a case of a growing sandpile to its run.

pub(crate) mod describe;
mod pouring;
pub mod sandpile;
pub mod site;
pub(crate) mod speed;
pub(crate) mod start;
