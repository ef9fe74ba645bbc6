//! Every law there is, with parameters that may differ from cell to cell.

use super::{
    Cohesion, Coulomb, Friction, HerschelBulkley, Law, LocalFriction, MuI, PouliquenForterre, Quadratic,
    Resistance, SamosAt, Voellmy, kept,
};
use crate::real::Real;
use crate::scheme::{Components, components};

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
