//! granflow says where a granular mass comes to rest.

pub mod backend;
pub mod boundary;
pub mod case;
pub mod field;
pub mod grid;
pub mod limiter;
pub mod observe;
pub mod output;
pub mod raster;
pub mod real;
pub mod release;
pub mod results;
pub mod run;
pub mod savage_hutter;
pub mod scheme;
pub mod setup;
pub mod simulation;
pub mod terrain;
pub mod time;
