//! The well-balanced finite-volume scheme of first order, of second order, and the adaptive one between them.
//!
//! The transport flux v grad u is taken together with the source, -f = div B (Aggarwal, Veerappa Gowda & Sudarshan Kumar
//! 2023, eqs. 7, 42). B itself is an integral over the table; only its differences enter, so that the flux is written
//! here as H less the value of B at the face: sand poured within half a cell of a face passes it with the rest, and the
//! sum over a cell of what is left is its own source.

mod adaptive;
mod cell;
mod rates;
mod reconstruct;
mod steps;
mod variant;

pub use cell::{CellSlopes, FaceStates, Halves, SlopeStorage};
pub use variant::{ADAPTIVE, FIRST_ORDER, HadelerKuttler, SECOND_ORDER, Slopes};
