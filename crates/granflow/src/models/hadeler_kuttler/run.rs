//! From a case of a growing sandpile to its run.

pub(crate) mod describe;
mod pouring;
mod sand;
pub mod sandpile;
pub mod site;
#[cfg(all(feature = "geo", feature = "threads"))]
pub(crate) mod speed;
pub(crate) mod start;
