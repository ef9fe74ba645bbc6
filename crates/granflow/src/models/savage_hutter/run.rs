//! From a case of an avalanche to its run.

pub mod avalanche;
mod between;
pub(crate) mod chute;
mod compression;
pub(crate) mod describe;
#[cfg(feature = "geo")]
mod erosion;
pub mod flowing;
#[cfg(feature = "geo")]
mod forest;
pub(crate) mod laid;
#[cfg(feature = "geo")]
mod left;
#[cfg(feature = "geo")]
mod loaded;
#[cfg(feature = "geo")]
pub(crate) mod mountain;
#[cfg(feature = "geo")]
mod parameters;
#[cfg(all(feature = "geo", feature = "threads"))]
pub(crate) mod speed;
#[cfg(feature = "geo")]
mod supply;
#[cfg(feature = "geo")]
pub(crate) mod terrain;
