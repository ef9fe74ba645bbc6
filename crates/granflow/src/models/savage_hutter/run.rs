//! From a case of an avalanche to its run.

pub mod avalanche;
pub(crate) mod chute;
pub(crate) mod describe;
pub(crate) mod flowing;
pub(crate) mod speed;
#[cfg(feature = "geo")]
pub(crate) mod terrain;
