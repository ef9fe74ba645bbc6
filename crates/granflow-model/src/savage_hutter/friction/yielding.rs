//! Laws of mud and debris that yield under a stress and then flow, whatever the load.

use super::Resistance;
use crate::real::{Real, power};
use crate::scheme::components;
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

components!(HerschelBulkley { bond: f64, consistency: f64, n: f64 });

/// A layer at one rate of shear: the logarithms of the rate and of the stress above the yield stress (over density), and how fast
/// either grows.
struct Shear {
    ln_rate: f64,
    ln_excess: f64,
    slopes: [f64; 2],
}

impl HerschelBulkley {
    /// What it withstands at rest; what grows with the speed is solved for by [`Self::kept`].
    pub(super) fn yields(&self, thickness: f64) -> Resistance<f64> {
        let bond = self.bond / thickness;
        Resistance { dry: bond, viscous: 0.0, drag: 0.0, holding: bond }
    }

    /// The share of `speed` that a layer keeps: v/speed where v + dt (tau_b - tau0)/(rho h) = speed.
    pub(super) fn kept(&self, thickness: f64, speed: f64, dt: f64) -> f64 {
        // Beyond, the share is of no use.
        const LEAST: f64 = 1e-150;
        if speed < LEAST || dt <= 0.0 {
            return 1.0;
        }
        let h = thickness.max(1e-100);
        let rate = self.rate(h, dt / h, speed);
        (h * rate / speed).min(1.0)
    }

    /// The rate of shear \[1/s\] at which `a` rate + `b` (tau_b - tau0)/rho = `sum`, a and b positive: Newton's method for the
    /// logarithms, which are nearly straight in each other, between the bounds found so far.
    fn rate(&self, a: f64, b: f64, sum: f64) -> f64 {
        let (ln_a, ln_b, wanted) = (Real::ln(a), Real::ln(b), Real::ln(sum));
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut y = self.begin(wanted - ln_a).min(self.begin_excess(wanted - ln_b));
        let mut found = self.shear(y);
        for _ in 0..100 {
            let (rate, excess) = (ln_a + found.ln_rate, ln_b + found.ln_excess);
            let most = rate.max(excess);
            let (rate, excess) = (power(E, rate - most), power(E, excess - most));
            let all = rate + excess;
            let value = most + Real::ln(all) - wanted;
            if value > 0.0 {
                high = y
            } else {
                low = y
            }
            let slope = (rate * found.slopes[0] + excess * found.slopes[1]) / all;
            let mut next = y - value / slope;
            if next < low || next > high {
                next = 0.5 * (low.max(y - 50.0) + high.min(y + 50.0));
            }
            let step = (next - y).abs();
            y = next;
            found = self.shear(y);
            // The next step would be the square of this one.
            if step < 1e-8 {
                break;
            }
        }
        power(E, found.ln_rate)
    }

    /// With a bond y = ln(xi/(1 - xi)), without one y = ln(rate).
    fn shear(&self, y: f64) -> Shear {
        let HerschelBulkley { bond, consistency, n } = *self;
        let s = 1.0 / n;
        if bond <= 0.0 {
            let ln_excess = Real::ln(consistency) + n * (y + Real::ln(2.0 + s));
            return Shear { ln_rate: y, ln_excess, slopes: [1.0, n] };
        }
        let c = n / (2.0 * n + 1.0);
        // ln(1 + z) and xi, z = exp(y), without overflow.
        let z = power(E, -y.abs());
        let (more, xi) = if y > 0.0 { (y, 1.0 / (1.0 + z)) } else { (0.0, z / (1.0 + z)) };
        let ln_1z = more + Real::ln(1.0 + z);
        let ln_rate = Real::ln(n / (n + 1.0))
            + s * (Real::ln(bond / consistency) + ln_1z)
            + (1.0 + s) * (y - ln_1z)
            + Real::ln(1.0 - c * xi);
        let slope = (1.0 + s) * (1.0 - xi) + s * xi - c * xi * (1.0 - xi) / (1.0 - c * xi);
        Shear { ln_rate, ln_excess: Real::ln(bond) + y, slopes: [slope, 1.0] }
    }

    /// A y of about this logarithm of the rate.
    fn begin(&self, ln_rate: f64) -> f64 {
        let s = 1.0 / self.n;
        if self.bond <= 0.0 {
            return ln_rate;
        }
        (ln_rate - Real::ln(self.n / (self.n + 1.0)) - s * Real::ln(self.bond / self.consistency)) / (1.0 + s)
    }
    /// The y of this logarithm of the excess.
    fn begin_excess(&self, ln_excess: f64) -> f64 {
        if self.bond <= 0.0 {
            return (ln_excess - Real::ln(self.consistency)) / self.n - Real::ln(2.0 + 1.0 / self.n);
        }
        ln_excess - Real::ln(self.bond)
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

components!(Quadratic { bond: f64, viscosity: f64, k: f64, manning: f64, gravity: f64 });

impl Quadratic {
    /// [`Friction::resistance`](super::Friction::resistance), of one cell; neither load nor speed matter.
    pub(super) fn resistance(&self, thickness: f64) -> Resistance<f64> {
        let bond = self.bond / thickness;
        let drag = self.gravity * (self.manning * self.manning) / power(thickness, 4.0 / 3.0);
        let viscous = self.viscosity * self.k / 8.0 / (thickness * thickness);
        Resistance { dry: bond, viscous, drag, holding: bond }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::prelude::v1::*;

    /// (tau_b - tau0)/rho at a rate of shear, from the formula as printed, by bisection of the stress.
    fn excess(law: &HerschelBulkley, rate: f64) -> f64 {
        let HerschelBulkley { bond, consistency, n } = *law;
        let rate_of = |excess: f64| {
            let (stress, xi) = (bond + excess, excess / (bond + excess));
            n / (n + 1.0)
                * (stress / consistency).powf(1.0 / n)
                * xi.powf(1.0 + 1.0 / n)
                * (1.0 - n * xi / (2.0 * n + 1.0))
        };
        let (mut low, mut high) = (1e-30_f64, 1e30_f64);
        for _ in 0..400 {
            let middle = (low * high).sqrt();
            if rate_of(middle) < rate { low = middle } else { high = middle }
        }
        high
    }

    #[test]
    fn what_a_yielding_layer_keeps_solves_the_implicit_equation() {
        for n in [0.2, 0.4, 1.0, 2.0, 4.0] {
            for bond in [0.0, 1e-6, 0.1, 10.0] {
                for (h, speed, dt) in
                    [(1.0, 3.0, 0.1), (0.01, 0.2, 1e-3), (2.0, 1e-9, 1.0), (0.5, 40.0, 1e3), (1e-5, 5.0, 0.1)]
                {
                    let law = HerschelBulkley { bond, consistency: 0.07, n };
                    let share = law.kept(h, speed, dt);
                    assert!((0.0..=1.0).contains(&share), "{share}");
                    let v = share * speed;
                    if v > 1e-25 {
                        let sum = v + dt * excess(&law, v / h) / h;
                        assert!(
                            (sum / speed - 1.0).abs() < 1e-10,
                            "n {n}, bond {bond}, {h} {speed} {dt}: {sum}"
                        );
                    }
                }
            }
        }
    }
}
