//! Laws of dense granular flow, in which friction grows with the speed and falls with the thickness.

use super::{Friction, Resistance};
use crate::real::{Real, power};

/// Pouliquen and Forterre's law with a start and a stop (J. Fluid Mech. 453, 2002, eqs. 3.1-3.6), Fr = |V|/sqrt(N+ h):
///
/// - at rest up to mu_start(h) = mu3 + (mu2 - mu1)/(1 + h/L),
/// - Fr >= beta: mu1 + (mu2 - mu1)/(1 + h beta/(L Fr)),
/// - Fr < beta: mu_start(h) + (Fr/beta)^gamma (mu_stop(h) - mu_start(h)), mu_stop(h) = mu1 + (mu2 - mu1)/(1 + h/L).
///
/// A layer between h_stop and h_start rests if it rested and moves if it moved: whether a cell moves is all the memory there is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PouliquenForterre {
    /// Tangents of the three angles: of thick layers that stop, of thin ones, of thick layers that start.
    pub mu: [f64; 3],
    /// The length L over which the thickness matters \[m\].
    pub length: f64,
    /// The Froude number of the thinnest uniform flow.
    pub beta: f64,
    /// The exponent of slow flow.
    pub gamma: f64,
}

impl Friction for PouliquenForterre {
    #[inline(always)]
    fn resistance<R: Real>(&self, thickness: R, speed_squared: R, load: R, weight: R) -> Resistance<R> {
        let [mu1, mu2, mu3] = self.mu;
        let (zero, one, length) = (R::zero(), R::splat(1.0), R::splat(self.length));
        let rise = R::splat(mu2 - mu1);
        let by_thickness = rise * (length / (length + thickness));
        let (stop, start) = (R::splat(mu1) + by_thickness, R::splat(mu3) + by_thickness);
        let speed = speed_squared.sqrt();
        // beta sqrt(N h): the speed at Fr = beta.
        let least = R::splat(self.beta) * (load * thickness).sqrt();
        let fast = least.le(speed) & zero.lt(speed);
        let path = length * speed + thickness * least;
        let per = one / R::select(fast, path, one);
        // (mu - mu1) N/|V|: what grows with the speed, to be solved for implicitly.
        let viscous = R::select(fast, rise * length * load * per, zero);
        let still = least.le(zero);
        let share = (speed / R::select(still, one, least)).min(one);
        let [share] = R::each([share], |[share]| [power(share, self.gamma)]);
        let slow = start + share * (stop - start);
        Resistance {
            dry: R::select(fast, R::splat(mu1), slow) * load,
            viscous,
            drag: zero,
            holding: start * weight,
        }
    }
}

/// The law mu(I) averaged over the depth (Gray & Edwards, J. Fluid Mech. 755, 2014, eq. 2.23): mu1 + (mu2 - mu1)/(1 + I0/I),
/// I = (5/2) |V| d/(h sqrt(phi N+ h)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MuI {
    /// mu of slow flow.
    pub mu1: f64,
    /// mu of fast flow.
    pub mu2: f64,
    /// The inertial number I0 half way between them.
    pub i0: f64,
    /// Diameter d of the grains \[m\].
    pub grain: f64,
    /// Share phi of the volume that the grains fill.
    pub phi: f64,
}

impl Friction for MuI {
    #[inline(always)]
    fn resistance<R: Real>(&self, thickness: R, speed_squared: R, load: R, weight: R) -> Resistance<R> {
        let (zero, one, mu1) = (R::zero(), R::splat(1.0), R::splat(self.mu1));
        let per_speed = R::splat(2.5 * self.grain);
        let slow = R::splat(self.i0) * thickness * (R::splat(self.phi) * load * thickness).sqrt();
        let sum = per_speed * speed_squared.sqrt() + slow;
        let none = sum.le(zero);
        let rise = R::splat(self.mu2 - self.mu1) * per_speed * load;
        let viscous = R::select(none, zero, rise / R::select(none, one, sum));
        Resistance { dry: mu1 * load, viscous, drag: zero, holding: mu1 * weight }
    }
}
