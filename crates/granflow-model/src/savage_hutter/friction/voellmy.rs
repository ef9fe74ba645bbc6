//! Voellmy's law.

use super::{Coulomb, Friction, Resistance};
use crate::real::Real;
use crate::scheme::components;

/// mu N+ + g |V|^2/(xi h) (Voellmy, Schweiz. Bauzeitung 73, 1955).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Voellmy {
    /// mu = tan(delta).
    pub mu: f64,
    /// Turbulent friction xi \[m/s^2\].
    pub xi: f64,
    /// Gravity g \[m/s^2\].
    pub gravity: f64,
}

components!(Voellmy { mu: f64, xi: f64, gravity: f64 });

impl Friction for Voellmy {
    #[inline(always)]
    fn resistance<R: Real>(&self, thickness: R, speed_squared: R, load: R, weight: R) -> Resistance<R> {
        let coulomb = Coulomb { mu: self.mu }.resistance(thickness, speed_squared, load, weight);
        Resistance { drag: R::splat(self.gravity / self.xi) / thickness, ..coulomb }
    }
}
