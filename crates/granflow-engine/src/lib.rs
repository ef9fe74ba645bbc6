//! Steps a scheme of [`granflow_model`] on a uniform grid: fields, SIMD lanes, tiles that sleep, threads, the ledger.

mod boundary;
mod disjoint;
mod field;
pub mod grid;
pub mod kernel;
pub mod kernels;
mod lanes;
mod observe;
mod parallel;
pub mod simulation;
mod stepper;
mod sweep;
mod tiles;
mod view;

pub use field::Field;
pub use observe::Maps;
pub use stepper::Stepper;
pub use view::View;

/// What the macros of this crate expand to; not for other use.
#[doc(hidden)]
pub mod private {
    pub use crate::lanes::Contexts;
    pub use crate::sweep::{Output, Sweep};
}
