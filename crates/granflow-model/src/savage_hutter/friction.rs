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
use crate::scheme::{Components, components};

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

/// The most parameters that a law has: twice [`HALF`].
const MOST: usize = 6;
const HALF: usize = 3;

/// Any law of this folder, computed one cell after the other: the laws with powers and iterations would crowd the loops that all others
/// share ([`Law`]), and those loops have one set of parameters for all cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnyLaw {
    /// [`Coulomb`].
    Coulomb(Coulomb),
    /// [`Voellmy`].
    Voellmy(Voellmy),
    /// [`Cohesion`].
    Cohesion(Cohesion),
    /// [`SamosAt`].
    SamosAt(SamosAt),
    /// [`PouliquenForterre`].
    PouliquenForterre(PouliquenForterre),
    /// [`MuI`].
    MuI(MuI),
    /// [`HerschelBulkley`].
    HerschelBulkley(HerschelBulkley),
    /// [`Quadratic`].
    Quadratic(Quadratic),
}

/// The parameters of a law in a cell, and what stands on the bed there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters<R> {
    /// Those of the law, in the order of its fields.
    of_law: [[R; HALF]; 2],
    /// Drag of what stands on the bed and is not overflown (a forest): it takes `drag` |V|^2 \[1/m\].
    pub drag: R,
}

components!([R: Real] Parameters<R> { of_law: [[R; HALF]; 2], drag: R });

impl<R: Real> Parameters<R> {
    /// Those of `law`, on a bare bed.
    #[must_use]
    pub fn of(law: &AnyLaw) -> Self {
        let mut numbers = [[R::zero(); HALF]; 2];
        let put = |k: usize, number| numbers[k / HALF][k % HALF] = R::splat(number);
        match law {
            AnyLaw::Coulomb(law) => law.store(put),
            AnyLaw::Voellmy(law) => law.store(put),
            AnyLaw::Cohesion(law) => law.store(put),
            AnyLaw::SamosAt(law) => law.store(put),
            AnyLaw::PouliquenForterre(law) => law.store(put),
            AnyLaw::MuI(law) => law.store(put),
            AnyLaw::HerschelBulkley(law) => law.store(put),
            AnyLaw::Quadratic(law) => law.store(put),
        }
        Parameters { of_law: numbers, drag: R::zero() }
    }

    /// Parameter `index` of the law.
    #[must_use]
    pub fn get(&self, index: usize) -> R {
        self.of_law[index / HALF][index % HALF]
    }

    /// The same where nothing stands on the bed.
    #[must_use]
    pub fn on_bare_bed(self) -> Self {
        Parameters { drag: R::zero(), ..self }
    }

    /// The same with another parameter `index` of the law.
    #[must_use]
    pub fn with(mut self, index: usize, number: R) -> Self {
        self.of_law[index / HALF][index % HALF] = number;
        self
    }
}

/// A law of a kind with these parameters.
#[inline(always)]
fn with<L: Components<f64>>(_kind: &L, numbers: &[f64; MOST]) -> L {
    L::load(|k| numbers[k])
}

impl From<Law> for AnyLaw {
    fn from(law: Law) -> AnyLaw {
        match law {
            Law::Coulomb(law) => AnyLaw::Coulomb(law),
            Law::Voellmy(law) => AnyLaw::Voellmy(law),
            Law::Cohesion(law) => AnyLaw::Cohesion(law),
            Law::SamosAt(law) => AnyLaw::SamosAt(law),
        }
    }
}

impl AnyLaw {
    /// The same as one that the loops of all schemes have, if it is one of these.
    #[must_use]
    pub fn in_loops(self) -> Option<Law> {
        match self {
            AnyLaw::Coulomb(law) => Some(Law::Coulomb(law)),
            AnyLaw::Voellmy(law) => Some(Law::Voellmy(law)),
            AnyLaw::Cohesion(law) => Some(Law::Cohesion(law)),
            AnyLaw::SamosAt(law) => Some(Law::SamosAt(law)),
            AnyLaw::PouliquenForterre(_)
            | AnyLaw::MuI(_)
            | AnyLaw::HerschelBulkley(_)
            | AnyLaw::Quadratic(_) => None,
        }
    }
    /// A part of the friction grows with the speed: it limits that of a thin layer, which therefore drains ever more slowly.
    #[must_use]
    pub fn has_drag(&self) -> bool {
        !matches!(self, AnyLaw::Coulomb(_) | AnyLaw::Cohesion(_))
    }

    /// The resistance of one cell: dry, viscous, drag, holding.
    fn of_one(&self, of_law: &[f64; MOST], [thickness, speed_squared, load, weight]: [f64; 4]) -> [f64; 4] {
        // No power of it overflows.
        let h = thickness.max(1e-100);
        let Resistance { dry, viscous, drag, holding } = match self {
            AnyLaw::Coulomb(law) => with(law, of_law).resistance(h, speed_squared, load, weight),
            AnyLaw::Voellmy(law) => with(law, of_law).resistance(h, speed_squared, load, weight),
            AnyLaw::Cohesion(law) => with(law, of_law).resistance(h, speed_squared, load, weight),
            AnyLaw::SamosAt(law) => with(law, of_law).resistance(h, speed_squared, load, weight),
            AnyLaw::PouliquenForterre(law) => with(law, of_law).resistance(h, speed_squared, load, weight),
            AnyLaw::MuI(law) => with(law, of_law).resistance(h, speed_squared, load, weight),
            AnyLaw::HerschelBulkley(law) => with(law, of_law).yields(h),
            AnyLaw::Quadratic(law) => with(law, of_law).resistance(h),
        };
        [dry, viscous, drag, holding]
    }
}

impl LocalFriction for AnyLaw {
    type Parameters<R: Real> = Parameters<R>;

    fn parameters<R: Real>(&self) -> Parameters<R> {
        Parameters::of(self)
    }
    #[inline(always)]
    fn resistance_with<R: Real>(
        &self,
        here: &Parameters<R>,
        thickness: R,
        speed_squared: R,
        load: R,
        weight: R,
    ) -> Resistance<R> {
        let [[a, b, c], [d, e, f]] = here.of_law;
        let values = [a, b, c, d, e, f, thickness, speed_squared, load, weight];
        let [dry, viscous, drag, holding] =
            R::each(values, |[a, b, c, d, e, f, layer @ ..]| self.of_one(&[a, b, c, d, e, f], layer));
        Resistance { dry, viscous, drag: drag + here.drag, holding }
    }
    #[inline(always)]
    fn kept<R: Real>(&self, here: &Parameters<R>, law: &Resistance<R>, thickness: R, speed: R, dt: R) -> R {
        if let AnyLaw::HerschelBulkley(kind) = self {
            let [[a, b, c], [d, e, f]] = here.of_law;
            let [share] =
                R::each([a, b, c, d, e, f, thickness, speed, dt], |[a, b, c, d, e, f, h, speed, dt]| {
                    [with(kind, &[a, b, c, d, e, f]).kept(h, speed, dt)]
                });
            return share * kept(R::zero(), law.drag, share * speed, dt);
        }
        kept(law.viscous, law.drag, speed, dt)
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
