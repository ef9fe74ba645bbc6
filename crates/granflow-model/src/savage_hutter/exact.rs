//! Exact and semi-analytic solutions of the Savage-Hutter and shallow water equations, to measure schemes by.
//!
//! In one dimension all of them solve
//!
//! ```text
//! h_t + (h u)_x = 0,    (h u)_t + (h u^2 + beta h^2/2)_x = (s - sgn(u) r) h
//! ```
//!
//! with the pressure constant `beta`, the pull of the slope `s` and the friction `r`. In SI units
//! `beta = G k cos z` (m/s2), `s = G sin z`, `r = G cos z tan d` with gravity `G`, bed slope angle `z`, friction
//! angle `d` and earth pressure coefficient `k`; in the scaled variables of Kaland & Struckmeier (2007, eq. 1;
//! lengths by L, heights by H = eps L, times by sqrt(L/G)) `beta = eps k cos z`, `s = sin z`,
//! `r = cos z tan d`. Angles are in radians, distances are measured along the bed.

mod cap;
mod dam_break;
mod flat_dam_break;
mod jump;
mod riemann;
mod slab;
mod thacker;
mod values;

pub use cap::{CapMotion, CapRelease, ParabolicCap, SimilarityCap, SimilarityCapState};
pub use dam_break::SlopeDamBreak;
pub use flat_dam_break::{FlatContour, FlatDamBreak};
pub use jump::GranularJump;
pub use riemann::{Riemann, Wave};
pub use slab::SlidingSlab;
pub use thacker::{ThackerParaboloid, lake_depth};
pub use values::{ExactError, Flow1, Flow2};

#[cfg(test)]
mod tests {
    use super::{ExactError, Flow1};
    use std::prelude::v1::*;

    /// What is left of the two equations of motion at a point of a smooth solution, by central differences
    /// of fourth order: mass, and momentum against the given `source` (force per depth).
    pub(super) fn residual(
        flow: impl Fn(f64, f64) -> Flow1,
        beta: f64,
        source: f64,
        x: f64,
        t: f64,
        step: f64,
    ) -> (f64, f64) {
        let d = |f: &dyn Fn(f64) -> f64| {
            (8.0 * (f(step) - f(-step)) - (f(2.0 * step) - f(-2.0 * step))) / (12.0 * step)
        };
        let force = |s: Flow1| s.h * s.u * s.u + beta * s.h * s.h / 2.0;
        let mass = d(&|e| flow(x, t + e).h) + d(&|e| flow(x + e, t).q());
        let momentum = d(&|e| flow(x, t + e).q()) + d(&|e| force(flow(x + e, t))) - source * flow(x, t).h;
        (mass, momentum)
    }

    #[test]
    fn errors_name_the_parameter_and_the_range() {
        let text = super::values::positive("height", -1.0).unwrap_err().to_string();
        assert_eq!(text, "height = -1, but it must be positive and finite");
        assert!(super::values::not_negative("depth", f64::NAN).is_err());
        assert!(super::values::angle("slope", 1.6).is_err());
        assert!(super::values::finite("velocity", f64::INFINITY).is_err());
        assert!(matches!(
            super::values::angle("slope", -0.1),
            Err(ExactError::OutOfRange { name: "slope", .. })
        ));
    }
}
