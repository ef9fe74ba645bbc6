//! The world of a case on terrain: elevation models, coordinate systems, release areas.
//!
//! [`raster`] reads and writes GeoTIFF and ESRI ASCII, [`terrain`] fits slope and curvature to the cells, [`release`] turns
//! polygons, rasters and caps into volume per plan area.

mod cells;
mod line;
pub mod raster;
pub mod release;
mod remark;
pub mod terrain;

pub use line::{line, line_from};
pub use remark::Remark;
