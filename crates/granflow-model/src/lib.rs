//! What the papers say about granular flow, as pointwise functions: no array, axis, thread or file appears here.
//!
//! | module | what |
//! | --- | --- |
//! | [`scheme`], [`real`] | what a scheme is: `reconstruct` (cell), `flux` (face), `update` (cell), written for any scalar |
//! | [`limiter`], [`time`] | limited slopes; Runge-Kutta methods as tables of Shu-Osher weights |
//! | [`savage_hutter`] | avalanches: unknowns, beds, friction laws, the kinetic flux, the schemes, exact solutions |
//! | [`hadeler_kuttler`] | growing sandpiles: tables, schemes, the equilibrium, exact solutions |
//!
//! The crate is `no_std`, has no dependency and no unsafe code. The feature `std` (default) takes square roots, fused
//! multiply-add and the logarithm from the standard library and adds the exact solutions; without it they are computed here.

#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;
#[cfg(any(feature = "std", test))]
extern crate std;

pub mod hadeler_kuttler;
pub mod limiter;
pub mod real;
pub mod savage_hutter;
pub mod scheme;
pub mod time;
