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
//! with the pull s = sin(zeta) down the slope. A mass at rest stays at rest exactly where the pull |beta grad h - s|
//! does not exceed R. On terrain z = b(x, y) the same in SI units for the volume per plan area H \[m\] and the
//! horizontal velocity w \[m/s\] (Bouchut & Westdickenberg 2004): [`savage_hutter::ground::Terrain`].
//!
//! # A column of sand collapses and comes to rest
//!
//! ```
//! use granflow::savage_hutter::{Flow, balanced::Balanced, friction::Coulomb, friction::Law, ground::Chute};
//! use granflow::{grid::Grid, scheme::Boundary, simulation::{Simulation, StepSize}, time::SSP_RK2};
//!
//! let grid = Grid { cells: [240], origin: [-6.0], size: [0.05], boundary: [[Boundary::Open; 2]] };
//! let flat = Chute { tilt: [0.0], beta: 0.4, cos: 1.0, curvature: 0.0 };
//! let column = |i| Flow::still(if grid.centre(i)[0].abs() < 1.0 { 1.0 } else { 0.0 });
//! let (scheme, step) = (Balanced::second(Law::Coulomb(Coulomb { mu: 0.32 }), 1e-6), StepSize::Courant(0.45));
//! let mut run = Simulation::new(scheme, grid, SSP_RK2, step, |_| flat, column);
//! let before = run.totals().volume;
//! while !run.at_rest() {
//!     run.advance(f64::INFINITY)?;
//! }
//! assert_eq!(run.speed(), 0.0); // not small: zero
//! assert!((run.totals().volume / before - 1.0).abs() < 1e-13);
//! # Ok::<(), granflow::simulation::Failure>(())
//! ```
//!
//! # Map of the modules
//!
//! | modules | what |
//! | --- | --- |
//! | [`scheme`], [`real`] | what a scheme is: `reconstruct` (cell), `flux` (face), `update` (cell), written for any scalar; read this first |
//! | [`savage_hutter`] | the model: unknowns, [`ground`](savage_hutter::ground), [`friction`](savage_hutter::friction), the kinetic [`flux`](savage_hutter::flux) |
//! | [`savage_hutter::kinetic`] | the five published schemes, Verfahren 1 to 5, as five constants |
//! | [`savage_hutter::balanced`] | the default scheme: conservative, positive, exactly resting; first and second order |
//! | [`savage_hutter::exact`] | exact solutions to measure schemes by |
//! | [`grid`], `field`, `boundary`, [`limiter`], [`time`] | cells, arrays, ghost cells, limited slopes, Runge-Kutta weights |
//! | `backend`, [`simulation`], `observe` | the sweep over tiles on all threads; fields, clock and ledger; maps of peaks and times |
//! | [`raster`], [`terrain`], [`release`] | GeoTIFF and ESRI ASCII, the bed's slope and curvature, what is released |
//! | [`case`] | the case file, from TOML to numbers, with errors that name line and key |
//! | [`output`] | the files of a run, one module per format |
//! | [`speed`] | what a step costs: runs to measure by, and what the memory can do |
//!
//! The pages under `docs/` of the repository hold the equations, the schemes, the errata of the papers, the case file
//! and the output files; `ARCHITECTURE.md` and `CONTRIBUTING.md` say how it is built and how to extend it.

pub use disk::Disk;
pub use granflow_case as case;
pub use granflow_engine::{grid, kernels, simulation};
pub use granflow_geo::{raster, release, terrain};
pub use granflow_model::{hadeler_kuttler, limiter, real, savage_hutter, scheme, time};

mod disk;
pub mod output;

pub mod results;
pub mod run;

pub mod setup;
pub mod site;

pub mod speed;

/// The README's library example is a test.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
