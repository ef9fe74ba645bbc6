//! x

pub mod raster;
