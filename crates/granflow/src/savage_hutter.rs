//! The Savage-Hutter model.

pub mod exact;
