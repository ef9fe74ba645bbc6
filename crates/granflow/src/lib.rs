//! x

pub mod raster;
pub mod terrain;
