//! The case file: what is simulated, in one TOML document.
//!
//! [`Case::read`] reads a file, [`Case::parse`] a text; both know the place of every key, so that each error names
//! file, line and key, what was found and what is allowed. [`Case::check`] then says everything that can be said
//! before work starts and gives a [`Checked`] case: every formula read and looked at in every cell, every file and default evaluated once, for a run to take.
//!
//! ```
//! use granflow_case::{Case, Kind, NoFiles};
//! let case = Case::parse(
//!     r#"
//!     title = "A silo breaks"
//!     model = "savage_hutter"
//!     grid.x = { from = -6.0, to = 6.0, cells = 240 }
//!     material.friction.coulomb = { angle = "18 deg" }
//!     initial.thickness.steps = { at = [-1.0, 1.0], values = [0.3, 2.3, 0.3] }
//!     time.until = "rest"
//!     "#,
//!     "silo.toml",
//! )?;
//! let checked = case.check(&NoFiles)?;
//! assert_eq!(checked.run.scheme, "energy_stable");
//! let Kind::Chute(chute) = checked.kind else { unreachable!("it has a grid") };
//! assert_eq!(chute.initial.thickness.at(120), 2.3);
//! # Ok::<(), granflow_case::CaseError>(())
//! ```
//!
//! The model and the place, `[grid]` or `[terrain]`, make the kind of a case. Each kind has a struct of its own that
//! denies unknown keys, and stands in one folder below `kinds` and one line of the list there: nothing else knows it.

mod array;
mod boundary;
mod case;
mod changes;
mod checked;
mod choice;
mod durations;
pub mod ensemble;
mod fault;
mod file_kind;
mod files;
mod formula;
mod grid;
mod kinds;
mod look;
pub mod memory;
mod nearest;
mod npy;
mod output;
mod plan;
mod precision;
mod quantity;
mod region;
mod shown;
mod source;
mod stepping;
mod units;
mod watched;

pub use boundary::Side;
pub use case::Case;
pub use changes::{Change, Concerns, changes};
pub use checked::Checked;
pub use durations::Durations;
pub use ensemble::{Ensemble, Member};
pub use fault::{CaseError, CaseErrorKind};
pub use file_kind::FileKind;
pub use files::{FileAccess, NoFiles, Outline, on_disk, open_file};
pub use formula::{Formula, FormulaError};
pub use grid::{Axis, Grid, Places, Points};
pub use kinds::*;
pub use nearest::nearest;
pub use plan::{Ends, Frames, OutputPlan, RunPlan, Stepping, Until};
pub use precision::Precision;
pub use shown::{short_numbers, steers};
pub use watched::{Gauge, Line, Section, Watched};

#[cfg(test)]
mod tests;
