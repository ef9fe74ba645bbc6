//! Friction laws: what resists a moving mass, and what holds one at rest.

mod any;
mod coulomb;
mod granular;
mod samosat;
mod voellmy;
mod yielding;

pub use any::{AnyLaw, Parameters};
pub use coulomb::{Cohesion, Coulomb};
pub use granular::{MuI, PouliquenForterre};
pub use samosat::SamosAt;
pub use voellmy::Voellmy;
pub use yielding::{HerschelBulkley, Quadratic};

use crate::real::Real;
use crate::scheme::Components;

/// The resistance of one law, as accelerations along the bed.
#[derive(Clone, Copy, Debug)]
pub struct Resistance<R> {
    /// Part that a step takes as it is at its begin.
    pub dry: R,
    /// Coefficient of |V|, which may itself depend on |V|: a step solves for the speed in it.
    pub viscous: R,
    /// Coefficient of |V|^2.
    pub drag: R,
    /// Largest pull that a mass at rest withstands (the law at |V| -> 0).
    pub holding: R,
}

/// A friction law with the same parameters in all cells.
pub trait Friction: Copy + Send + Sync + 'static {
    /// Resistance of a mass of `thickness` (normal to the bed) under the normal acceleration `load` in motion and
    /// `weight` at rest; `speed_squared` is the square of the speed along the bed.
    fn resistance<R: Real>(&self, thickness: R, speed_squared: R, load: R, weight: R) -> Resistance<R>;
}

/// Friction as a scheme asks for it in a cell: any [`Friction`], or a law with parameters of the cell ([`AnyLaw`]).
pub trait LocalFriction: Copy + Send + Sync + 'static {
    /// The parameters of a cell; `()` where they are the law's own.
    type Parameters<R: Real>: Components<R>;

    /// The parameters of a cell for which no others are given.
    fn parameters<R: Real>(&self) -> Self::Parameters<R>;
    /// [`Friction::resistance`] with the parameters `here`.
    fn resistance_with<R: Real>(
        &self,
        here: &Self::Parameters<R>,
        thickness: R,
        speed_squared: R,
        load: R,
        weight: R,
    ) -> Resistance<R>;
    /// The share of `speed` that the parts of the resistance leave which grow with the speed, in a step of `dt`.
    #[inline(always)]
    fn kept<R: Real>(
        &self,
        _here: &Self::Parameters<R>,
        law: &Resistance<R>,
        _thickness: R,
        speed: R,
        dt: R,
    ) -> R {
        if !R::any(!(law.drag + law.viscous).equals(R::zero())) {
            return R::splat(1.0);
        }
        kept(law.viscous, law.drag, speed, dt)
    }
}

impl<F: Friction> LocalFriction for F {
    type Parameters<R: Real> = ();

    #[inline(always)]
    fn parameters<R: Real>(&self) {}
    #[inline(always)]
    fn resistance_with<R: Real>(
        &self,
        _here: &(),
        thickness: R,
        speed_squared: R,
        load: R,
        weight: R,
    ) -> Resistance<R> {
        self.resistance(thickness, speed_squared, load, weight)
    }
}

/// v/speed where v + dt (viscous v + drag v^2) = speed: what the parts that grow with the speed leave of it, implicitly.
#[inline(always)]
pub(super) fn kept<R: Real>(viscous: R, drag: R, speed: R, dt: R) -> R {
    let one = R::splat(1.0) + dt * viscous;
    R::splat(2.0) / (one + (one * one + R::splat(4.0) * (dt * drag * speed)).sqrt())
}

/// A law that the loops of all schemes have. One type for all, so that each scheme is built once, not once a law; in a
/// sweep the choice is the same for every cell and costs nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// [`Coulomb`].
    Coulomb(Coulomb),
    /// [`Voellmy`].
    Voellmy(Voellmy),
    /// [`Cohesion`].
    Cohesion(Cohesion),
    /// [`SamosAt`].
    SamosAt(SamosAt),
}

impl Friction for Law {
    #[inline(always)]
    fn resistance<R: Real>(&self, thickness: R, speed_squared: R, load: R, weight: R) -> Resistance<R> {
        match self {
            Law::Coulomb(law) => law.resistance(thickness, speed_squared, load, weight),
            Law::Voellmy(law) => law.resistance(thickness, speed_squared, load, weight),
            Law::Cohesion(law) => law.resistance(thickness, speed_squared, load, weight),
            Law::SamosAt(law) => law.resistance(thickness, speed_squared, load, weight),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::prelude::v1::*;

    #[test]
    fn the_laws_agree_with_the_table() {
        let (h, v, n, w) = (1.5_f64, 12.0, 8.0, 7.5);
        let voellmy = Voellmy { mu: 0.2, xi: 1500.0, gravity: 9.81 }.resistance(h, v * v, n, w);
        assert!((voellmy.dry + voellmy.drag * v * v - (0.2 * n + 9.81 * v * v / (1500.0 * h))).abs() < 1e-12);
        let cohesion = Cohesion { mu: 0.2, bond: 50.0 / 200.0 }.resistance(h, v * v, n, w);
        assert!((cohesion.holding - (0.2 * w + 50.0 / (200.0 * h))).abs() < 1e-12);
        let law = SamosAt { mu: 0.155, bond: 0.1, rs0: 0.222, kappa: 0.43, r: 0.05, b: 4.13 };
        let (rho, tau0) = (200.0, 20.0);
        let sigma = rho * n * h;
        let rs = rho * v * v / sigma;
        let tau = tau0
            + 0.155 * sigma * (1.0 + 0.222 / (0.222 + rs))
            + rho * v * v / ((h / 0.05_f64).ln() / 0.43 + 4.13).powi(2);
        let ours = law.resistance(h, v * v, n, w);
        assert!((ours.dry + ours.drag * v * v - tau / (rho * h)).abs() < 1e-12);
        let slow = law.resistance(h, 0.0, w, w);
        assert_eq!(slow.dry, ours.holding);
    }
}
