//! granflow says where a granular mass comes to rest.
//!
//! # The equations
//!
//! Depth-averaged granular flow with bed friction, after Savage & Hutter. On a chute, scaled as in Kaland & Struckmeier
//! (2007, eq. 1: lengths by L, depths by H = epsilon L, times by sqrt(L/g)):
//!
//! ```text
//! h_t + div(h u) = 0
//! (h u)_t + div(h u u) + grad(beta h^2/2) = h (s - R u/|u|),   beta = epsilon k cos(zeta),  R = cos(zeta) tan(delta)
//! ```
//!
//! with the driving force s = sin(zeta) down the slope. A mass at rest stays at rest exactly where |beta grad h - s| does not
//! exceed R. On terrain z = b(x, y) the same in SI units for the volume per plan area H \[m\] and the horizontal velocity
//! w \[m/s\] (Bouchut & Westdickenberg 2004): [`savage_hutter::ground::Terrain`]. Growing sandpiles after Hadeler & Kuttler:
//! [`hadeler_kuttler`].
//!
//! # A column of sand collapses and comes to rest
//!
//! ```
//! use granflow::build::{Avalanche, Grid};
//! let column = |[x]: [f64; 1]| if x.abs() < 1.0 { 1.0 } else { 0.0 };
//! let mut run = Avalanche::on_plane(Grid::line([-8.0, 8.0], 320), 0.0).mu(0.32).thickness(column).start()?;
//! let before = run.totals().volume;
//! assert!(run.to_rest(100.0)?);
//! assert_eq!(run.stepper().speed(), 0.0); // not small: zero
//! assert!((run.totals().volume / before - 1.0).abs() < 1e-13);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # A case file
//!
//! ```no_run
//! let case = granflow::Case::read("silo.toml")?.check()?;
//! let end = case.plan().ends.time.unwrap_or(10.0); // the run itself goes on for as long as one steps it
//! let mut run = case.start()?;
//! let mut frames = run.frames(0.5);
//! while let Some(run) = frames.next()? {
//!     let thickness = run.field("thickness").expect("an avalanche has one"); // no copy
//!     println!("t = {}: {} at the first cell", run.time(), thickness.at(0, 0));
//!     if run.time() >= end {
//!         break; // some schemes never rest
//!     }
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Map
//!
//! | module | what |
//! | --- | --- |
//! | [`build`] | runs without a case file, in a few lines |
//! | [`case`], [`Case`] | the case file, from TOML to a checked case and its run |
//! | [`run`] | a run one can hold: stepped, looked into, saved; the loop to an end; models of your own by [`run::Physics`] |
//! | [`sinks`] | what is shown a run after every step: memory, files, a callback |
//! | [`session`] | from a checked case to its files, as `granflow run` does it |
//! | [`watch`] | gauges and sections of a case on the cells of its run |
//! | [`model`], [`models`] | a model as files and figures see it; those of this library |
//! | [`results`], [`output`] | what a run leaves; one file per format |
//! | [`ensemble`] | many runs of one case with values drawn, added up to maps of probability |
//! | [`compare`](mod@compare) | how well a run meets another one, or what was mapped |
//! | [`speed`] | what a step costs: runs to measure by, and what the memory can do |
//! | [`scheme`], [`real`], [`limiter`], [`time`], [`savage_hutter`], [`hadeler_kuttler`] | from `granflow-model`: what the papers say, as pointwise functions |
//! | [`grid`], [`mod@kernel`], [`kernels`], [`simulation`] | from `granflow-engine`: what steps a scheme |
//! | [`raster`], [`terrain`], [`release`] | from `granflow-geo`: elevation, slopes and curvatures, what is released |
//!
//! The pages under `docs/` of the repository hold the equations, the schemes, the errata of the papers, the case file
//! and the output files; `ARCHITECTURE.md` and `CONTRIBUTING.md` say how it is built and how to extend it.
//!
//! # Features
//!
//! `threads`, `files`, `geo` and `figures`, all on by default: several threads; results on disk; terrain; pictures.

mod access;
pub mod build;
pub mod case;
mod check_value;
#[cfg(all(feature = "figures", feature = "geo"))]
pub mod compare;
pub mod describe;
#[cfg(all(feature = "figures", feature = "geo"))]
pub mod ensemble;
mod entry;
mod field;
mod inputs;
mod memory;
pub mod model;
pub mod models;
#[cfg(feature = "files")]
pub mod output;
#[cfg(feature = "files")]
pub mod results;
pub mod run;
#[cfg(feature = "files")]
pub mod session;
pub mod sinks;
#[cfg(all(feature = "geo", feature = "threads"))]
pub mod speed;
mod start_error;
mod stop_reason;
pub mod watch;

pub use access::file_kinds;
pub use case::{Case, Checked};
pub use granflow_engine::{grid, kernel, kernels, simulation};
#[cfg(feature = "geo")]
pub use granflow_geo::{raster, release, terrain};
pub use granflow_model::{hadeler_kuttler, limiter, real, savage_hutter, scheme, time};
pub use inputs::Inputs;
pub use model::Words;
pub use start_error::StartError;

/// The README's library example is a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
