//! The engine of granflow for Python: what the package `granflow` (the folder `python/granflow`) is built on.
//!
//! Nothing here is for users; their names, shapes and units are said in the package.

#![cfg(feature = "extension")]

mod case;
mod ensemble;
mod error;
mod exact;
mod interrupt;
mod program;
mod results;
mod run;
mod simulation;

use pyo3::prelude::*;

/// The module `granflow._native`.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::case::Case;
    #[pymodule_export]
    use super::ensemble::{Ensemble, Members};
    #[pymodule_export]
    use super::exact::{
        flat_dam_break, flat_dam_break_front, granular_jump, parabolic_cap, pile_on_disc, pile_on_rectangle,
        riemann, similarity_cap, sliding_slab, slope_dam_break, thacker,
    };
    #[pymodule_export]
    use super::program::program;
    #[pymodule_export]
    use super::run::run;
    #[pymodule_export]
    use super::simulation::{Checkpoint, Simulation};

    use super::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
