//! The models of this library: each is one folder and one line.

pub mod hadeler_kuttler;
pub mod savage_hutter;

use crate::model::Model;

/// All models, by which a result file finds its own.
pub static MODELS: &[&Model] = &[
    &savage_hutter::MODEL, //
    &hadeler_kuttler::MODEL,
];
