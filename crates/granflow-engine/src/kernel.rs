//! A scheme whose inner loops are compiled.

use crate::sweep::{Output, Sweep};
use granflow_model::scheme::Scheme;

/// A scheme that a simulation can step; [`crate::kernel!`] makes one of a [`Scheme`].
pub trait Kernel<const D: usize>: Scheme<D, f64> {
    /// Compute one stage in the tiles that are awake.
    #[doc(hidden)]
    fn sweep(&self, sweep: &Sweep, output: Output);
}

/// The inner loops of a scheme in D dimensions, compiled by [`crate::kernel!`]: how a type of other crates, say `Balanced`
/// with a friction law of your own, is stepped ([`crate::simulation::Simulation::with_loops`]).
pub struct Loops<const D: usize, S>(fn(&S, &Sweep, Output));

impl<const D: usize, S> Clone for Loops<D, S> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<const D: usize, S> Copy for Loops<D, S> {}

impl<const D: usize, S> Loops<D, S> {
    #[doc(hidden)]
    pub const fn new(sweep: fn(&S, &Sweep, Output)) -> Self {
        Loops(sweep)
    }
    /// Those of a scheme that has its own.
    pub(crate) const fn of() -> Self
    where
        S: Kernel<D>,
    {
        Loops(S::sweep)
    }
    pub(crate) fn sweep(self, scheme: &S, sweep: &Sweep, output: Output) {
        (self.0)(scheme, sweep, output);
    }
}

/// Compile the inner loops of a scheme, so that [`crate::simulation::Simulation`] can step it: for one dimension and two, or
/// for the one that is named, and for each set of instructions (none, AVX2, AVX-512, NEON), in a module of this name.
///
/// ```ignore
/// kernel!(burgers: Burgers);       // `Burgers` is `Scheme<D, R>` for any D and R
/// kernel!(burgers: Burgers, 2);    // ... for D = 2 alone
/// kernel!(mine: const LOOPS = Balanced<MyLaw, Chute<2, f64>>, 2);  // of a type that belongs to another crate: `Loops`
/// ```
///
/// Everything that a scheme does on lanes must be inlined whole: give its functions `#[inline(always)]`, and write loops
/// over axes with [`granflow_model::real::per_axis`] and [`granflow_model::real::for_axis`] instead of `map` and `from_fn`, and
/// [`granflow_model::real::repeated`] instead of `[value; D]`.
/// A function that is left as a call is still right, but slow. `crates/granflow-engine/tests/own_scheme.rs` has schemes of its own.
#[macro_export]
macro_rules! kernel {
    ($module:ident: const $name:ident = $scheme:ty, $dimensions:literal) => {
        #[doc(hidden)]
        mod $module {
            $crate::contexts!();
        }
        const $name: $crate::kernel::Loops<$dimensions, $scheme> =
            $crate::kernel::Loops::new(|scheme, sweep: &$crate::private::Sweep, output| {
                sweep.run::<$dimensions, _, $module::Here>(scheme, output);
            });
    };
    ($module:ident: $scheme:ty, $dimensions:literal) => {
        #[doc(hidden)]
        mod $module {
            $crate::contexts!();
        }
        impl $crate::kernel::Kernel<$dimensions> for $scheme {
            fn sweep(&self, sweep: &$crate::private::Sweep, output: $crate::private::Output) {
                sweep.run::<$dimensions, _, $module::Here>(self, output);
            }
        }
    };
    ($module:ident: $scheme:ty) => {
        $crate::kernel!($module: $scheme, $scheme, $scheme, clone);
    };
    // A type that depends on the dimension: in any, in one, in two, and the method that makes the latter of the first; with `scalar`
    // the loops for one dimension are compiled for one cell at a time alone, with `scalar; scalar` all of them.
    ($module:ident: $scheme:ty, $line:ty, $plane:ty, $made:ident $(, $scalar:ident)? $(; $all:ident)?) => {
        #[doc(hidden)]
        mod $module {
            pub mod line {
                $crate::contexts!($($scalar)?);
            }
            pub mod plane {
                $crate::contexts!($($all)?);
            }
        }
        impl<const D: usize> $crate::kernel::Kernel<D> for $scheme {
            fn sweep(&self, sweep: &$crate::private::Sweep, output: $crate::private::Output) {
                // Generic in nothing: else every crate that steps the scheme would compile its loops again.
                fn line(scheme: $line, sweep: &$crate::private::Sweep, output: $crate::private::Output) {
                    sweep.run::<1, _, $module::line::Here>(&scheme, output);
                }
                fn plane(scheme: $plane, sweep: &$crate::private::Sweep, output: $crate::private::Output) {
                    sweep.run::<2, _, $module::plane::Here>(&scheme, output);
                }
                match D {
                    1 => line(self.$made(), sweep, output),
                    2 => plane(self.$made(), sweep, output),
                    _ => unreachable!("a grid has one dimension or two"),
                }
            }
        }
    };
}
