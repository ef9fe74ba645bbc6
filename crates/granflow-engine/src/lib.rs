//! Steps a scheme of [`granflow_model`] on a uniform grid: fields, SIMD lanes, tiles that sleep, threads, the ledger.

mod boundary;
mod disjoint;
mod field;
pub mod grid;
pub mod kernels;
mod lanes;
mod observe;
pub mod simulation;
mod stepper;
mod sweep;
mod tiles;
mod view;

pub use field::Field;
pub use observe::Maps;
pub use stepper::Stepper;
pub use view::View;
