//! Dam break on a flat bed with Coulomb friction.

use super::values::{ExactError, positive};
use alloc::vec;

/// Dam break on a flat bed with the friction coefficient mu (Kerswell 2005, Phys. Fluids 17, 057101), scaled by the
/// depth h0 and sqrt(h0/G): the reservoir of depth 1 fills x < 0 and must be wide enough to stay at rest at its far end.
///
/// The front runs to `x_f = 2t - mu t^2/2` and stops at `2/mu`, exactly. Behind it the flow is **not** the fan of a
/// sliding reservoir, `x = t (2 - 3 sqrt(h) - mu t/2)`: the reservoir rests without friction until the flow bites
/// into it. A wave that leaves this edge at time tau carries `u + 2c + mu t = 2 + mu tau`, c = sqrt(h), and the fan is
/// right only for tau = 0, at the tip. With `sigma = u - 2c + mu t` the motion is linear:
///
/// ```text
/// d2t/(dtau dsigma) = (3/2) (dt/dtau - mu dt/dsigma) / (2 + mu tau - sigma),
/// t = 0 at tau = 0 (all waves to the left start at the dam),   t = tau where sigma = -2 + mu tau (the edge: u = 0, h = 1),
/// dx = (u + c) dt along tau = const,   dx = (u - c) dt along sigma = const
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlatDamBreak {
    mu: f64,
}

/// Where a [`FlatDamBreak`] has a given depth, and how fast it flows there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlatContour {
    /// Position, in units of h0.
    pub x: f64,
    /// Velocity, in units of sqrt(G h0).
    pub u: f64,
}

impl FlatDamBreak {
    /// Least depth for which [`FlatDamBreak::contour`] is resolved.
    pub const LEAST_CONTOUR: f64 = 1e-3;

    /// Friction coefficient mu = tan d > 0.
    ///
    /// # Errors
    /// [`ExactError::OutOfRange`].
    pub fn new(mu: f64) -> Result<Self, ExactError> {
        Ok(Self { mu: positive("mu", mu)? })
    }

    /// Time at which the front stops, 2/mu.
    pub fn stopping_time(&self) -> f64 {
        2.0 / self.mu
    }

    /// Position of the front at time `t >= 0`: `2t - mu t^2/2` until it stops at `2/mu`.
    pub fn front(&self, t: f64) -> f64 {
        let t = t.min(self.stopping_time());
        2.0 * t - self.mu * t * t / 2.0
    }

    /// The point of depth `h` at time `t`, to about 1e-7/mu in x.
    ///
    /// `None` where the solution is not known: `h` outside \[[`Self::LEAST_CONTOUR`], 1), `t` outside
    /// (0, 2/mu), or a point that has come to rest or was reached by waves from an edge that no longer retreats.
    pub fn contour(&self, h: f64, t: f64) -> Option<FlatContour> {
        if !((Self::LEAST_CONTOUR..1.0).contains(&h) && t > 0.0 && t < self.stopping_time()) {
            return None;
        }
        // Error falls as the square of the step: Richardson.
        let (c, time) = (h.sqrt(), self.mu * t);
        let (coarse, fine) = (hodograph(c, time, 500)?, hodograph(c, time, 1000)?);
        let limit = |coarse: f64, fine: f64| fine + (fine - coarse) / 3.0;
        let u = limit(coarse.1, fine.1);
        (u > 0.0).then_some(FlatContour { x: limit(coarse.0, fine.0) / self.mu, u })
    }
}

/// (mu x, u) where sqrt(h) = `c` at mu t = `time`; `n` steps to a unit of `s = mu tau` and of sigma.
fn hodograph(c: f64, time: f64, n: usize) -> Option<(f64, f64)> {
    let step = 1.0 / n as f64;
    let columns = 4 * n; // sigma = -2 + j step; c = 0 is reached at column 4n + i of row i
    let mut row = vec![0.0; columns + 1];
    let (mut edge, mut edge_speed) = (0.0, -1.0);
    // (mu t, mu x, s) at the depth asked for, row by row
    let mut line = vec![(0.0, 0.0, 0.0)];
    for i in 1..=2 * n {
        let s = i as f64 * step;
        let below = row.clone();
        row[i] = s;
        for j in i..columns {
            // (2 + s - sigma) in the middle of the mesh
            let gap = 4.0 + (i as f64 - j as f64 - 1.0) * step;
            row[j + 1] = below[j + 1] + row[j] - below[j] + 1.5 * step / gap * (row[j] - below[j + 1]);
        }
        // On the edge u = 0, c = 1 and t_s + t_sigma = 1, so that dx/ds = t_sigma - t_s = 2 t_sigma - 1.
        let speed = (4.0 * row[i + 1] - 3.0 * row[i] - row[i + 2]) / step - 1.0;
        if speed >= 0.0 {
            return None;
        }
        edge += (edge_speed + speed) / 2.0 * step;
        edge_speed = speed;
        line.push(point(&row, i, edge, s, c, step)?);
        let last = line.len() - 1;
        if last >= 3 && line[last - 1].0 >= time {
            let known: [(f64, f64, f64); 4] = core::array::from_fn(|k| line[last - 3 + k]);
            let x = cubic(known.map(|p| (p.0, p.1)), time);
            let s = cubic(known.map(|p| (p.0, p.2)), time);
            return Some((x, 2.0 + s - 2.0 * c - time));
        }
    }
    None
}

/// (mu t, mu x, s) of the row `i` where sqrt(h) = `c`.
fn point(row: &[f64], i: usize, edge: f64, s: f64, c: f64, step: f64) -> Option<(f64, f64, f64)> {
    let wanted = (4.0 + s - 4.0 * c) / step;
    let first = (wanted as usize).saturating_sub(1).max(i);
    if first + 3 >= row.len() {
        return None;
    }
    // u + c at column j
    let speed = |j: usize| {
        let sigma = -2.0 + j as f64 * step;
        (2.0 + s + sigma) / 2.0 - row[j] + (2.0 + s - sigma) / 4.0
    };
    let mut x = edge;
    let mut nodes = [(0.0, 0.0, 0.0); 4];
    for j in i..=first + 3 {
        if j > i {
            x += (speed(j - 1) + speed(j)) / 2.0 * (row[j] - row[j - 1]);
        }
        if j >= first {
            nodes[j - first] = (j as f64, row[j], x);
        }
    }
    Some((cubic(nodes.map(|p| (p.0, p.1)), wanted), cubic(nodes.map(|p| (p.0, p.2)), wanted), s))
}

/// Lagrange's cubic through four points.
fn cubic(points: [(f64, f64); 4], at: f64) -> f64 {
    let mut sum = 0.0;
    for (k, (xk, yk)) in points.iter().enumerate() {
        let weight: f64 =
            (0..4).filter(|&m| m != k).map(|m| (at - points[m].0) / (xk - points[m].0)).product();
        sum += weight * yk;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::prelude::v1::*;

    #[test]
    fn flat_front_stops() {
        let dam = FlatDamBreak::new(0.5).unwrap();
        assert_eq!((dam.front(2.0), dam.front(4.0), dam.front(9.0)), (3.0, 4.0, 4.0));
        assert_eq!((dam.stopping_time(), dam.contour(0.01, 4.1), dam.contour(1.0, 1.0)), (4.0, None, None));
    }

    /// Contours against a converged second-order finite-volume run of the same problem (dx = 1/400, made with a
    /// separate program).
    #[test]
    fn flat_contours_match_a_fine_simulation() {
        let dam = FlatDamBreak::new(0.5).unwrap();
        for (h, t, x) in [
            (0.25, 0.2, 0.0965),
            (0.25, 1.0, 0.4069),
            (0.09, 1.0, 0.9229),
            (0.25, 2.0, 0.6329),
            (0.09, 2.0, 1.4959),
        ] {
            let c = dam.contour(h, t).unwrap();
            assert!((c.x - x).abs() < 2e-3, "h = {h}, t = {t}: {c:?} against {x}");
        }
    }

    #[test]
    fn flat_contours_lie_between_the_fan_and_the_front() {
        let dam = FlatDamBreak::new(0.5).unwrap();
        let c = dam.contour(0.01, 2.0).unwrap();
        assert!((c.x - 2.456507).abs() < 1e-6, "{c:?}");
        // At the tip the fan is right.
        let gap = |h: f64| dam.contour(h, 1.0).unwrap().x - (2.0 - 3.0 * h.sqrt() - 0.25);
        assert!(gap(0.09) > 10.0 * gap(0.0025) && gap(0.0025) > 0.0, "{} {}", gap(0.09), gap(0.0025));
        // Without friction it is Ritter's fan everywhere.
        let smooth = FlatDamBreak::new(1e-4).unwrap().contour(0.16, 1.0).unwrap();
        assert!((smooth.x - 0.8).abs() < 1e-3 && (smooth.u - 1.2).abs() < 1e-3, "{smooth:?}");
    }

    /// The equations of motion with h and t as the variables: x_t = u + h u_h and
    /// u_t + (u - x_t) u_h/x_h + 1/x_h + mu = 0.
    #[test]
    fn flat_contours_solve_the_equations() {
        let dam = FlatDamBreak::new(0.5).unwrap();
        for (h, t) in [(0.3, 0.8), (0.1, 1.6), (0.02, 2.4)] {
            let (dh, dt) = (0.01 * h, 0.01 * t);
            let at = |a: f64, b: f64| dam.contour(h + a * dh, t + b * dt).unwrap();
            let (east, west, late, early) = (at(1.0, 0.0), at(-1.0, 0.0), at(0.0, 1.0), at(0.0, -1.0));
            let here = at(0.0, 0.0);
            let (x_h, u_h) = ((east.x - west.x) / (2.0 * dh), (east.u - west.u) / (2.0 * dh));
            let (x_t, u_t) = ((late.x - early.x) / (2.0 * dt), (late.u - early.u) / (2.0 * dt));
            let mass = here.u + h * u_h - x_t;
            let momentum = u_t + (here.u - x_t) * u_h / x_h + 1.0 / x_h + 0.5;
            assert!(mass.abs() < 5e-4 && momentum.abs() < 5e-4, "h = {h}, t = {t}: {mass} {momentum}");
        }
    }

    #[test]
    fn hodograph_converges_with_second_order() {
        for (c, time) in [(0.1, 1.0), (0.3, 0.5), (0.9, 0.3), (0.04, 1.8)] {
            let [a, b, d] = [250, 500, 1000].map(|n| hodograph(c, time, n).unwrap());
            for (coarse, fine) in [(a.0 - b.0, b.0 - d.0), (a.1 - b.1, b.1 - d.1)] {
                let ratio = coarse / fine;
                assert!((3.5..4.5).contains(&ratio), "c = {c}, mu t = {time}: {a:?} {b:?} {d:?}");
            }
        }
    }
}
