//! Runs without a case file: a bed, a mass on it, a law, in a few lines.
//!
//! ```
//! use granflow::build::{Avalanche, Grid};
//! let column = |[x]: [f64; 1]| if x.abs() < 1.0 { 1.0 } else { 0.0 };
//! let mut run = Avalanche::on_plane(Grid::line([-8.0, 8.0], 320), 0.0).mu(0.32).thickness(column).start()?;
//! assert!(run.to_rest(100.0)?);
//! assert_eq!(run.stepper().speed(), 0.0); // not small: zero
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Each builder gives a [`Run`](crate::run::Run); the scheme itself says its time stepping and its Courant number.

pub use crate::models::hadeler_kuttler::run::sandpile::Sandpile;
pub use crate::models::savage_hutter::run::avalanche::Avalanche;
pub use granflow_engine::grid::Grid;
pub use granflow_engine::simulation::{BuildError, StepSize};
pub use granflow_model::hadeler_kuttler::table::Table;
pub use granflow_model::savage_hutter::friction::*;
