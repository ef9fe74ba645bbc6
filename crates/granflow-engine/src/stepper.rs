//! A run of whatever scheme and dimension, behind one type.

use crate::field::Field;
use crate::grid::Layout;
use crate::observe::Maps;
use crate::simulation::{Failure, SimdLevel, Simulation, Totals, Traffic};
use crate::tiles::OUTLETS;
use crate::view::View;
use granflow_model::scheme::{Components, Scheme};

/// A [`Simulation`] whose scheme and dimension are not known to whoever steps it: `Box<dyn Stepper>`.
///
/// Every simulation is one. Axes come in pairs, x and y; in one dimension there is one cell along y.
pub trait Stepper: Send + Sync {
    /// One step, not beyond time `until`; returns dt.
    ///
    /// # Errors
    /// As [`Simulation::advance`].
    fn advance(&mut self, until: f64) -> Result<f64, Failure>;
    /// As [`Simulation::expect`].
    fn expect(&mut self, time: f64);
    /// As [`Simulation::show`].
    ///
    /// # Panics
    /// As [`Simulation::show`].
    fn show(&mut self, time: f64);
    /// As [`Simulation::show_end`].
    fn show_end(&mut self);
    /// Time reached, or shown.
    fn time(&self) -> f64;
    /// Steps done.
    fn steps(&self) -> u64;
    /// Forward-Euler maps of one cell computed so far, sleeping tiles left out.
    fn updates(&self) -> u64;
    /// Every cell rests by the scheme's proof and the last step changed nothing: nothing ever will.
    fn at_rest(&self) -> bool;
    /// max over cells of [`granflow_model::scheme::Scheme::rate`]: the Courant number of a step dt is dt times this. \[1/time\]
    fn rate(&self) -> f64;
    /// The step that the Courant condition or the case asks for; infinite where nothing could move.
    fn wanted_step(&self) -> f64;
    /// Does the step follow from the state?
    fn is_adaptive(&self) -> bool;
    /// Largest speed along the bed.
    fn speed(&self) -> f64;
    /// Sums over all cells, as [`Simulation::totals`].
    fn totals(&self) -> Totals;
    /// Take the sums over the cells that have changed, so that [`Stepper::totals`] need not.
    fn take_sums(&mut self);
    /// Volume that has left by each of [`OUTLETS`] since the start.
    fn outflow(&self) -> [f64; OUTLETS.len()];
    /// Volume that has been poured in since the start.
    fn poured(&self) -> f64;
    /// Volume per time that is poured in now.
    fn source_rate(&self) -> f64;
    /// The largest change of each component of the state per time in the last step, as [`Simulation::drift`].
    fn drift(&self) -> &[f64];

    /// One axis or two.
    fn dimensions(&self) -> usize;
    /// Cells along x and y.
    fn cells(&self) -> [usize; 2];
    /// Lower corner of the first cell; 0 along an axis that there is not.
    fn origin(&self) -> [f64; 2];
    /// Cell size along x and y; 1 along an axis that there is not.
    fn size(&self) -> [f64; 2];
    /// Where in the padded arrays the cells are.
    fn layout(&self) -> &Layout;
    /// How many components the state has.
    fn components(&self) -> usize;
    /// Component `k` of the state, where it is kept.
    ///
    /// # Panics
    /// If there is no such component.
    fn component(&self, k: usize) -> View<'_>;
    /// [`granflow_model::scheme::Scheme::yield_ratio`] in every cell, x fastest.
    fn yield_ratios(&mut self) -> Vec<f64>;

    /// The numbers that a restart needs beside the state.
    fn clock(&self) -> Vec<f64>;
    /// The state arrays, padded, for a checkpoint.
    fn arrays(&self) -> &Field;
    /// Take up a run from [`Stepper::clock`] and [`Stepper::arrays`]; false where the sizes do not fit.
    fn restore(&mut self, clock: &[f64], arrays: Field) -> bool;

    /// Let every tile be computed in the next step; changes no result, only what it costs.
    fn wake_all(&mut self);
    /// Let no tile be computed any more: the state was found to be at rest before it was saved.
    fn sleep_all(&mut self);
    /// Compute with these instructions; changes no result, only what it costs.
    fn use_simd(&mut self, simd: SimdLevel);
    /// Give back the memory that only steps need, for there will be none, or none before [`Stepper::restore`].
    fn release_buffers(&mut self);

    /// Keep summary maps from now on, beginning with the state as it stands; counted is what is thicker than
    /// `threshold` (units of the thickness, normal to the bed).
    fn keep_maps(&mut self, threshold: f64);
    /// The summary maps, where they are kept.
    fn maps(&self) -> Option<&Maps>;
    /// A summary map by its name, padded, to be overwritten.
    fn map_mut(&mut self, name: &str) -> Option<&mut [f32]>;
    /// The summary maps by name, x fastest; all else is given back first.
    fn into_maps(self: Box<Self>) -> Vec<(&'static str, Vec<f64>)>;

    /// Bytes that a cell takes while a run computes, with or without summary maps.
    fn bytes_per_cell(&self, maps: bool) -> usize;
    /// The bytes a cell and step that pass between memory and caches where every tile is awake.
    fn traffic(&self) -> Traffic;
}

/// The methods that a simulation has under the same name and signature.
macro_rules! forward {
    ($(fn $name:ident(&self $(, $arg:ident: $kind:ty)*) $(-> $out:ty)?;)* mut: $(fn $name_mut:ident(&mut self $(, $arg_mut:ident: $kind_mut:ty)*) $(-> $out_mut:ty)?;)*) => {
        $(fn $name(&self $(, $arg: $kind)*) $(-> $out)? {
            Simulation::$name(self $(, $arg)*)
        })*
        $(fn $name_mut(&mut self $(, $arg_mut: $kind_mut)*) $(-> $out_mut)? {
            Simulation::$name_mut(self $(, $arg_mut)*)
        })*
    };
}

impl<const D: usize, S: Scheme<D, f64>> Stepper for Simulation<D, S> {
    forward! {
        fn time(&self) -> f64;
        fn updates(&self) -> u64;
        fn at_rest(&self) -> bool;
        fn rate(&self) -> f64;
        fn wanted_step(&self) -> f64;
        fn is_adaptive(&self) -> bool;
        fn speed(&self) -> f64;
        fn totals(&self) -> Totals;
        fn poured(&self) -> f64;
        fn drift(&self) -> &[f64];
        fn layout(&self) -> &Layout;
        fn clock(&self) -> Vec<f64>;
        fn arrays(&self) -> &Field;
        fn maps(&self) -> Option<&Maps>;
        fn traffic(&self) -> Traffic;
        mut:
        fn advance(&mut self, until: f64) -> Result<f64, Failure>;
        fn expect(&mut self, time: f64);
        fn show(&mut self, time: f64);
        fn show_end(&mut self);
        fn take_sums(&mut self);
        fn yield_ratios(&mut self) -> Vec<f64>;
        fn restore(&mut self, clock: &[f64], arrays: Field) -> bool;
        fn wake_all(&mut self);
        fn sleep_all(&mut self);
        fn use_simd(&mut self, simd: SimdLevel);
        fn release_buffers(&mut self);
        fn keep_maps(&mut self, threshold: f64);
    }
    fn steps(&self) -> u64 {
        self.step()
    }
    fn outflow(&self) -> [f64; OUTLETS.len()] {
        self.out()
    }
    fn source_rate(&self) -> f64 {
        self.supply()
    }
    fn dimensions(&self) -> usize {
        D
    }
    fn cells(&self) -> [usize; 2] {
        both(self.grid().cells, 1)
    }
    fn origin(&self) -> [f64; 2] {
        both(self.grid().origin, 0.0)
    }
    fn size(&self) -> [f64; 2] {
        both(self.grid().size, 1.0)
    }
    fn components(&self) -> usize {
        S::State::COUNT
    }
    fn component(&self, k: usize) -> View<'_> {
        View::new(&Simulation::arrays(self).components()[k], Simulation::layout(self))
    }
    fn map_mut(&mut self, name: &str) -> Option<&mut [f32]> {
        self.maps_mut().find(|(known, _)| *known == name).map(|(_, map)| map)
    }
    fn into_maps(self: Box<Self>) -> Vec<(&'static str, Vec<f64>)> {
        Simulation::into_maps(*self)
    }
    fn bytes_per_cell(&self, maps: bool) -> usize {
        // Several stages write over the state before the step, which what is shown at instants needs.
        let before =
            if self.scheme().stages().len() > 1 { crate::field::bytes_per_cell::<S::State>() } else { 0 };
        Simulation::<D, S>::bytes_per_cell(maps) + before
    }
}

/// A number for x and y, `other` along an axis that there is not.
fn both<const D: usize, T: Copy>(axes: [T; D], other: T) -> [T; 2] {
    std::array::from_fn(|k| axes.get(k).copied().unwrap_or(other))
}
