//! Friction laws: what resists a moving mass, and what holds one at rest.

use crate::real::Real;

/// The resistance of one law, as accelerations along the bed.
#[derive(Clone, Copy, Debug)]
pub struct Resistance<R> {
    /// Part that does not grow with the speed squared.
    pub dry: R,
    /// Coefficient of |V|^2.
    pub drag: R,
    /// Largest pull that a mass at rest withstands (the law at |V| -> 0).
    pub holding: R,
}

/// A friction law.
pub trait Friction: Copy + Send + Sync + 'static {
    /// Resistance of a mass of `thickness` (normal to the bed) under the normal acceleration `load` in motion and
    /// `weight` at rest; `speed_squared` is the square of the speed along the bed.
    fn resistance<R: Real>(&self, thickness: R, speed_squared: R, load: R, weight: R) -> Resistance<R>;
}

/// mu N+ (Coulomb 1776; report eq. 1, R = cos zeta tan delta).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coulomb {
    /// mu = tan(delta).
    pub mu: f64,
}

impl Friction for Coulomb {
    #[inline(always)]
    fn resistance<R: Real>(&self, _thickness: R, _speed_squared: R, load: R, weight: R) -> Resistance<R> {
        let mu = R::splat(self.mu);
        Resistance { dry: mu * load, drag: R::zero(), holding: mu * weight }
    }
}

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

impl Friction for Voellmy {
    #[inline(always)]
    fn resistance<R: Real>(&self, thickness: R, speed_squared: R, load: R, weight: R) -> Resistance<R> {
        let coulomb = Coulomb { mu: self.mu }.resistance(thickness, speed_squared, load, weight);
        Resistance { drag: R::splat(self.gravity / self.xi) / thickness, ..coulomb }
    }
}

/// mu N+ + tau0/(rho h): Coulomb with a cohesive bond to the bed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cohesion {
    /// mu = tan(delta).
    pub mu: f64,
    /// Cohesion over density, tau0/rho \[m^2/s^2\].
    pub bond: f64,
}

impl Friction for Cohesion {
    #[inline(always)]
    fn resistance<R: Real>(&self, thickness: R, speed_squared: R, load: R, weight: R) -> Resistance<R> {
        let coulomb = Coulomb { mu: self.mu }.resistance(thickness, speed_squared, load, weight);
        let bond = R::splat(self.bond) / thickness;
        Resistance { dry: coulomb.dry + bond, holding: coulomb.holding + bond, ..coulomb }
    }
}

/// samosAT, the default law of AvaFrame's com1DFA (Sampl & Granig 2009; AvaFrame documentation).
///
/// \[tau0 + mu sigma (1 + Rs0/(Rs0 + Rs)) + rho |V|^2/(ln(h/R)/kappa + B)^2\]/(rho h), sigma = rho N+ h,
/// Rs = rho |V|^2/sigma; h/R is taken as at least 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SamosAt {
    /// mu.
    pub mu: f64,
    /// tau0/rho \[m^2/s^2\].
    pub bond: f64,
    /// Rs0.
    pub rs0: f64,
    /// kappa.
    pub kappa: f64,
    /// R \[m\].
    pub r: f64,
    /// B.
    pub b: f64,
}

impl Friction for SamosAt {
    #[inline(always)]
    fn resistance<R: Real>(&self, thickness: R, speed_squared: R, load: R, weight: R) -> Resistance<R> {
        let (mu, rs0, one) = (R::splat(self.mu), R::splat(self.rs0), R::splat(1.0));
        let bond = R::splat(self.bond) / thickness;
        // Rs0/(Rs0 + Rs) with Rs = |V|^2/(N h), multiplied through by N h: no division by a vanishing load.
        let pressure = rs0 * load * thickness;
        let sum = pressure + speed_squared;
        let share = R::select(sum.le(R::zero()), one, pressure / R::select(sum.le(R::zero()), one, sum));
        let wall = (thickness * R::splat(1.0 / self.r)).max(one).ln() * R::splat(1.0 / self.kappa)
            + R::splat(self.b);
        Resistance {
            dry: bond + mu * load * (one + share),
            drag: one / (wall * wall * thickness),
            holding: bond + mu * (weight + weight),
        }
    }
}

/// A law that is known when a case has been read. One type for all, so that each scheme is built once, not once a law; in a
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

impl Law {
    /// A part of the friction grows with |V|^2: it limits the speed of a thin layer, which therefore drains ever more slowly.
    #[must_use]
    pub fn has_drag(&self) -> bool {
        match self {
            Law::Coulomb(_) | Law::Cohesion(_) => false,
            Law::Voellmy(_) | Law::SamosAt(_) => true,
        }
    }
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
