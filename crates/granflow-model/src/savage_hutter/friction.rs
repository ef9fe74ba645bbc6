//! Friction laws: what resists a moving mass, and what holds one at rest.

mod coulomb;
mod granular;
mod samosat;
mod voellmy;
mod yielding;

pub use coulomb::{Cohesion, Coulomb};
pub use granular::{MuI, PouliquenForterre};
pub use samosat::SamosAt;
pub use voellmy::Voellmy;
pub use yielding::{HerschelBulkley, Quadratic};

use crate::real::Real;

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

/// A friction law.
pub trait Friction: Copy + Send + Sync + 'static {
    /// Resistance of a mass of `thickness` (normal to the bed) under the normal acceleration `load` in motion and
    /// `weight` at rest; `speed_squared` is the square of the speed along the bed.
    fn resistance<R: Real>(&self, thickness: R, speed_squared: R, load: R, weight: R) -> Resistance<R>;
}

/// v/speed where v + dt (viscous v + drag v^2) = speed: what the parts that grow with the speed leave of it, implicitly.
#[inline(always)]
pub(super) fn kept<R: Real>(viscous: R, drag: R, speed: R, dt: R) -> R {
    let one = R::splat(1.0) + dt * viscous;
    R::splat(2.0) / (one + (one * one + R::splat(4.0) * (dt * drag * speed)).sqrt())
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
    /// One that is computed cell by cell.
    CellByCell(CellByCell),
}

/// The laws that are computed one cell after the other: their powers and iterations would crowd the loops of all other laws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CellByCell {
    /// [`PouliquenForterre`].
    PouliquenForterre(PouliquenForterre),
    /// [`MuI`].
    MuI(MuI),
    /// [`HerschelBulkley`].
    HerschelBulkley(HerschelBulkley),
    /// [`Quadratic`].
    Quadratic(Quadratic),
}

impl Law {
    /// A part of the friction grows with the speed: it limits that of a thin layer, which therefore drains ever more slowly.
    #[must_use]
    pub fn has_drag(&self) -> bool {
        match self {
            Law::Coulomb(_) | Law::Cohesion(_) => false,
            Law::Voellmy(_) | Law::SamosAt(_) | Law::CellByCell(_) => true,
        }
    }
}

impl From<CellByCell> for Law {
    fn from(law: CellByCell) -> Law {
        Law::CellByCell(law)
    }
}

impl CellByCell {
    /// The resistance of one cell as an array. (Cold, and with a body that the compiler of the loops sees: of a call that it knows
    /// nothing of it would think that it changes what the loops hold in registers.)
    #[cold]
    #[inline]
    fn of_one(&self, [thickness, speed_squared, load, weight]: [f64; 4]) -> [f64; 4] {
        // No power of it overflows.
        let thickness = thickness.max(1e-100);
        let Resistance { dry, viscous, drag, holding } = match self {
            CellByCell::PouliquenForterre(law) => law.resistance(thickness, speed_squared, load, weight),
            CellByCell::MuI(law) => law.resistance(thickness, speed_squared, load, weight),
            CellByCell::HerschelBulkley(law) => law.resistance(thickness, speed_squared, load, weight),
            CellByCell::Quadratic(law) => law.resistance(thickness, speed_squared, load, weight),
        };
        [dry, viscous, drag, holding]
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
            Law::CellByCell(law) => {
                let values = [thickness, speed_squared, load, weight];
                let [dry, viscous, drag, holding] = R::each(values, |values| law.of_one(values));
                Resistance { dry, viscous, drag, holding }
            }
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
