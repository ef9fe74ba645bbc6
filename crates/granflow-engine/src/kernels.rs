//! The schemes that a simulation can step: their inner loops are compiled here, once, and called from elsewhere.

use crate::sweep::{Output, Sweep};
use granflow_model::hadeler_kuttler::scheme::HadelerKuttler;
use granflow_model::savage_hutter::balanced::Balanced;
use granflow_model::savage_hutter::friction::Law;
use granflow_model::savage_hutter::ground::{Chute, Terrain};
use granflow_model::savage_hutter::kinetic::Kinetic;
use granflow_model::scheme::Scheme;

/// A scheme that a simulation can step. Where a scheme is generic, the list below says over which friction law and bed.
pub trait Kernel<const D: usize>: Scheme<D, f64> {
    /// Compute one stage in the tiles that are awake.
    #[doc(hidden)]
    fn sweep(&self, sweep: &Sweep, output: Output);
}

/// Scheme in D dimensions; in one; in two; how to make these of it. What does the work is generic in nothing: else every crate
/// that steps a scheme would compile its loops anew.
macro_rules! kernels {
    ($($scheme:ty, $line:ty, $plane:ty, $made:ident;)*) => {$(
        impl<const D: usize> Kernel<D> for $scheme {
            fn sweep(&self, sweep: &Sweep, output: Output) {
                fn line(scheme: $line, sweep: &Sweep, output: Output) {
                    sweep.run::<1, _>(&scheme, output);
                }
                fn plane(scheme: $plane, sweep: &Sweep, output: Output) {
                    sweep.run::<2, _>(&scheme, output);
                }
                match D {
                    1 => line(self.$made(), sweep, output),
                    2 => plane(self.$made(), sweep, output),
                    _ => unreachable!("a grid has one dimension or two"),
                }
            }
        }
    )*};
}

kernels! {
    Kinetic, Kinetic, Kinetic, clone;
    Balanced<Law, Chute<D, f64>>, Balanced<Law, Chute<1, f64>>, Balanced<Law, Chute<2, f64>>, over;
    Balanced<Law, Terrain<D, f64>>, Balanced<Law, Terrain<1, f64>>, Balanced<Law, Terrain<2, f64>>, over;
    HadelerKuttler, HadelerKuttler, HadelerKuttler, clone;
}
