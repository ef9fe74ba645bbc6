//! The scheme whose energy never grows, in one and two dimensions, on chutes and on terrain.
//!
//! With psi the potential of the free surface per mass (terrain: g (b + c^2 H), chute: beta h less the fall of the plane) the energy
//! of a cell is E = h |V|^2/2 + integral of psi dh. A step has three parts:
//!
//! 1. **Force and friction**, cell by cell, u -> w: w = u + dt M phi, then friction, which stops and never reverses.
//! 2. **Transport**: a kinetic flux, whose thermal part lives on what both cells of a face have above each other's bed. Where friction
//!    could stop a cell within a few steps it goes over into donor cells: the force is the downstream difference of psi, the flux
//!    carries h (u + w)/2 of the upstream cell and no pressure, and what stands steeper than friction holds spreads.
//! 3. **The limiter**: beside mass and momentum a face carries a flux of energy; the new momentum of a cell is scaled down where the
//!    cell would keep more energy than this leaves it. Faces carry no more than can be paid, so that the scale is almost always 1.
//!
//! The sum of E over the cells never grows, and falls while anything moves, whatever the step and the law, on any
//! terrain and on straight chutes: the proof and what it costs are in `docs/rest.md`.

mod budget;
mod ends;
mod faces;
mod flux;
mod force;
mod forecast;
mod friction;
mod limiter;
mod meeting;
mod reconstruct;
mod rest;
mod sides;
mod steps;
mod variant;

pub use ends::{Ends, EndsOf, EndsStorage};
pub use faces::{FaceStates, Flux};
pub use forecast::Forecast;
pub use variant::EnergyStable;
