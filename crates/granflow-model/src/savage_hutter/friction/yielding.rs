//! Laws of mud and debris that yield under a stress and then flow, whatever the load.

use super::{Friction, Resistance};
use crate::real::{Real, power};
use core::f64::consts::E;

/// Herschel and Bulkley's law tau = tau0 + k (du/dz)^n, averaged over the depth of a uniform flow; n = 1 is Bingham's, k its viscosity.
///
/// The stress tau_b at the bed of a layer of mean speed |V| solves, with xi = 1 - tau0/tau_b,
///
/// |V|/h = n/(n + 1) (tau_b/k)^(1/n) xi^(1 + 1/n) (1 - n xi/(2 n + 1))
///
/// (Huang & Garcia, J. Fluid Mech. 374, 1998, eq. 14 with the plug). It acts as tau_b/(rho h).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HerschelBulkley {
    /// Yield stress over density, tau0/rho \[m^2/s^2\].
    pub bond: f64,
    /// Consistency over density, k/rho \[m^2/s^2 s^n\].
    pub consistency: f64,
    /// Exponent n.
    pub n: f64,
}

/// A smaller rate of shear \[1/s\] has the viscosity of this one: that of a fluid that yields is infinite at rest.
const LEAST_RATE: f64 = 1e-6;

impl HerschelBulkley {
    /// (tau_b - tau0)/rho \[m^2/s^2\] at |V|/h = `rate` > 0.
    pub fn excess(&self, rate: f64) -> f64 {
        let HerschelBulkley { bond, consistency, n } = *self;
        let s = 1.0 / n;
        if bond <= 0.0 {
            return consistency * power(rate * (2.0 + s), n);
        }
        // Newton's method for y = ln(xi/(1 - xi)), in which the logarithm of the equation is nearly straight.
        let c = n / (2.0 * n + 1.0);
        let wanted = Real::ln(rate) - Real::ln(n / (n + 1.0)) - s * Real::ln(bond / consistency);
        let mut y = wanted / (1.0 + s);
        for _ in 0..40 {
            let z = power(E, y);
            let xi = z / (1.0 + z);
            let value =
                (1.0 + s) * (y - Real::ln(1.0 + z)) + s * Real::ln(1.0 + z) + Real::ln(1.0 - c * xi) - wanted;
            let slope = (1.0 + s) * (1.0 - xi) + s * xi - c * xi * (1.0 - xi) / (1.0 - c * xi);
            let step = value / slope;
            y -= step;
            // The next step would be the square of this one.
            if step.abs() < 1e-8 {
                break;
            }
        }
        bond * power(E, y)
    }
}

impl Friction for HerschelBulkley {
    #[inline(always)]
    fn resistance<R: Real>(&self, thickness: R, speed_squared: R, _load: R, _weight: R) -> Resistance<R> {
        let per = R::splat(1.0) / thickness;
        let rate = (speed_squared.sqrt() * per).max(R::splat(LEAST_RATE));
        let [excess] = R::each([rate], |[rate]| [self.excess(rate)]);
        let bond = R::splat(self.bond) * per;
        Resistance { dry: bond, viscous: excess / rate * (per * per), drag: R::zero(), holding: bond }
    }
}

/// The quadratic law of mud and debris, tau0/(rho h) + K eta |V|/(8 rho h^2) + g n^2 |V|^2/h^(4/3)
/// (O'Brien, Julien & Fullerton, J. Hydraul. Eng. 119, 1993, eq. 7).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadratic {
    /// Yield stress over density, tau0/rho \[m^2/s^2\].
    pub bond: f64,
    /// Viscosity over density, eta/rho \[m^2/s\].
    pub viscosity: f64,
    /// Resistance parameter K of laminar flow, 24 on a wide smooth bed.
    pub k: f64,
    /// Manning's n \[s/m^(1/3)\].
    pub manning: f64,
    /// Gravity g \[m/s^2\].
    pub gravity: f64,
}

impl Friction for Quadratic {
    #[inline(always)]
    fn resistance<R: Real>(&self, thickness: R, _speed_squared: R, _load: R, _weight: R) -> Resistance<R> {
        let per = R::splat(1.0) / thickness;
        let bond = R::splat(self.bond) * per;
        let rough = self.gravity * (self.manning * self.manning);
        let [drag] = R::each([thickness], |[thickness]| [rough / power(thickness, 4.0 / 3.0)]);
        let viscous = R::splat(self.viscosity * self.k / 8.0) * (per * per);
        Resistance { dry: bond, viscous, drag, holding: bond }
    }
}
