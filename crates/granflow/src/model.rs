//! What everything after a run knows of a model: a table of quantities, words, and functions that draw it.
//!
//! Files, report, animation and `granflow plot` go over these and name no model. A model gives one [`Model`] and,
//! for each kind of place that it flows on, one [`Domain`]; the models of this library stand in [`crate::models`].

#[cfg(feature = "figures")]
mod along;
mod domain;
#[cfg(feature = "figures")]
mod drawing;
#[cfg(feature = "figures")]
mod history;
mod plane;
#[cfg(feature = "figures")]
mod profiles;
mod quantity;
#[cfg(feature = "files")]
mod result_file;
#[cfg(feature = "figures")]
mod view;
#[cfg(feature = "figures")]
mod watched;

pub use crate::field::Field;
#[cfg(feature = "figures")]
pub use along::Along;
pub use domain::{Domain, Maps, Model, Words};
#[cfg(feature = "figures")]
pub use domain::{Instants, Pictures, Scene};
#[cfg(feature = "figures")]
pub use drawing::{Drawing, colour_limit, save_all};
#[cfg(feature = "figures")]
pub use history::history;
pub use plane::Plane;
#[cfg(feature = "figures")]
pub use profiles::{Line, PILE, profiles};
pub use quantity::{At, Kind, Quantity, Units};
#[cfg(feature = "files")]
pub use result_file::ResultFile;
#[cfg(feature = "figures")]
pub(crate) use view::DURATIONS;
#[cfg(feature = "figures")]
pub use view::View;
#[cfg(feature = "figures")]
pub use watched::watched;
