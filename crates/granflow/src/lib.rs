//! x

pub mod raster;
pub mod release;
pub mod terrain;
