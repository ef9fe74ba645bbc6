//! Steps a scheme of [`granflow_model`] on a uniform grid: fields, SIMD lanes, tiles that sleep, threads, the ledger.

mod backend;
mod boundary;
mod field;
pub mod grid;
pub mod kernels;
mod lanes;
mod observe;
pub mod simulation;

pub use field::Field;
pub use observe::Maps;
