//! From a case of an avalanche to its run.

pub mod avalanche;
pub(crate) mod chute;
pub(crate) mod describe;
pub mod flowing;
#[cfg(feature = "geo")]
mod left;
#[cfg(feature = "geo")]
mod parameters;
#[cfg(all(feature = "geo", feature = "threads"))]
pub(crate) mod speed;
mod supply;
#[cfg(feature = "geo")]
pub(crate) mod terrain;
