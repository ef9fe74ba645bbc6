//! Laws of dense granular flow, in which friction grows with the speed and falls with the thickness.

use super::Resistance;
use crate::real::{Real, power};
use crate::scheme::components;

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

components!(PouliquenForterre { mu: [f64; 3], length: f64, beta: f64, gamma: f64 });

impl PouliquenForterre {
    /// [`Friction::resistance`](super::Friction::resistance), of one cell.
    pub(super) fn resistance(
        &self,
        thickness: f64,
        speed_squared: f64,
        load: f64,
        weight: f64,
    ) -> Resistance<f64> {
        let [mu1, mu2, mu3] = self.mu;
        let rise = mu2 - mu1;
        let by_thickness = rise * (self.length / (self.length + thickness));
        let (stop, start) = (mu1 + by_thickness, mu3 + by_thickness);
        let speed = Real::sqrt(speed_squared);
        // beta sqrt(N h): the speed at Fr = beta.
        let least = self.beta * Real::sqrt(load * thickness);
        let holding = start * weight;
        if least <= speed && speed > 0.0 {
            // (mu - mu1) N/|V|: what grows with the speed, to be solved for implicitly.
            let viscous = rise * self.length * load / (self.length * speed + thickness * least);
            return Resistance { dry: mu1 * load, viscous, drag: 0.0, holding };
        }
        let share = if least <= 0.0 { 1.0 } else { (speed / least).min(1.0) };
        let mu = start + power(share, self.gamma) * (stop - start);
        Resistance { dry: mu * load, viscous: 0.0, drag: 0.0, holding }
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

components!(MuI { mu1: f64, mu2: f64, i0: f64, grain: f64, phi: f64 });

impl MuI {
    /// [`Friction::resistance`](super::Friction::resistance), of one cell.
    pub(super) fn resistance(
        &self,
        thickness: f64,
        speed_squared: f64,
        load: f64,
        weight: f64,
    ) -> Resistance<f64> {
        let per_speed = 2.5 * self.grain;
        let slow = self.i0 * thickness * Real::sqrt(self.phi * load * thickness);
        let sum = per_speed * Real::sqrt(speed_squared) + slow;
        let rise = (self.mu2 - self.mu1) * per_speed * load;
        let viscous = if sum <= 0.0 { 0.0 } else { rise / sum };
        Resistance { dry: self.mu1 * load, viscous, drag: 0.0, holding: self.mu1 * weight }
    }
}
