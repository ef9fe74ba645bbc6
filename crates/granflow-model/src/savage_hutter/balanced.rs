//! The conservative, positive, exactly resting scheme, in one and two dimensions, on chutes and on terrain.
//!
//! Kinetic flux between moving cells; no mass between cells that hold themselves; friction clipped after the flux,
//! so that it stops and never reverses. The rules and what they were measured against:
//! `docs/decisions/0002-rest.md`.

mod faces;
mod friction;
mod reconstruct;
mod rest;
mod slopes;
mod steps;
mod variant;

pub use faces::{FaceStates, Flux};
pub use slopes::{CellSlopes, Order, Slope, SlopeStorage};
pub use variant::Balanced;
