//! Parabolic caps that slide down a plane and spread.

use super::values::{ExactError, Flow1, Flow2, angle, positive};

/// A parabolic cap at rest on a plane, to be released at t = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CapRelease {
    /// Depth H in the middle, m.
    pub height: f64,
    /// Half length L down the slope, m.
    pub length: f64,
    /// Bed slope angle z, rad.
    pub slope: f64,
    /// Friction angle d, rad.
    pub friction: f64,
    /// Earth pressure coefficient k down the slope.
    pub earth_pressure: f64,
    /// Gravity G, m/s2.
    pub gravity: f64,
}

/// Stretch of a cap and motion of its centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CapMotion {
    /// Half length over its first value, g.
    pub stretch: f64,
    /// dg/dt, 1/s.
    pub stretch_rate: f64,
    /// Position of the centre, m (0 at the start).
    pub centre: f64,
    /// Speed of the centre, m/s.
    pub velocity: f64,
}

/// The constants of a release in scaled form (lengths by L, heights by H, times by sqrt(L/G)).
#[derive(Debug, Clone, Copy, PartialEq)]
struct Scaled {
    /// A = sin z
    pull: f64,
    /// C = cos z tan d
    friction: f64,
    /// B = eps k cos z
    pressure: f64,
}

impl CapRelease {
    fn scaled(&self) -> Result<Scaled, ExactError> {
        positive("height", self.height)?;
        positive("length", self.length)?;
        angle("slope", self.slope)?;
        angle("friction", self.friction)?;
        positive("earth pressure", self.earth_pressure)?;
        positive("gravity", self.gravity)?;
        let scaled = Scaled {
            pull: self.slope.sin(),
            friction: self.slope.cos() * self.friction.tan(),
            pressure: self.height / self.length * self.earth_pressure * self.slope.cos(),
        };
        if scaled.pull - scaled.friction < 2.0 * scaled.pressure {
            return Err(ExactError::NotValid {
                solution: "the sliding cap",
                requirement: "sin z - cos z tan d >= 2 (H/L) k cos z (the tail moves down as well)",
                left: scaled.pull - scaled.friction,
                right: 2.0 * scaled.pressure,
            });
        }
        Ok(scaled)
    }

    /// One unit of scaled time, s.
    fn time_unit(&self) -> f64 {
        (self.length / self.gravity).sqrt()
    }

    /// Position and speed of the centre after `t` seconds.
    fn centre(&self, scaled: &Scaled, t: f64) -> (f64, f64) {
        let a = self.gravity * (scaled.pull - scaled.friction);
        (a * t * t / 2.0, a * t)
    }
}

/// Parabolic cap on a plane in one dimension, exact (Savage & Hutter 1989, J. Fluid Mech. 199, section 5).
///
/// Scaled by L, H and sqrt(L/G), with `A = sin z`, `C = cos z tan d`, `B = (H/L) k cos z`:
///
/// ```text
/// h = (1/g) (1 - xi^2/g^2),   x = (A - C) t^2/2 + xi,   u = (A - C) t + xi g'/g
/// g'' = 2B/g^2, g(0) = 1, g'(0) = 0:   sqrt(g (g - 1)) + ln(sqrt g + sqrt(g - 1)) = 2 sqrt(B) t
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParabolicCap {
    release: CapRelease,
    scaled: Scaled,
}

impl ParabolicCap {
    /// Sets the solution up.
    ///
    /// # Errors
    /// [`ExactError::OutOfRange`] for a value without meaning, [`ExactError::NotValid`] unless
    /// `A - C >= 2B`, since friction would then point the other way at the tail.
    pub fn new(release: CapRelease) -> Result<Self, ExactError> {
        Ok(Self { release, scaled: release.scaled()? })
    }

    /// Stretch and centre at time `t >= 0`, s.
    pub fn motion(&self, t: f64) -> CapMotion {
        let unit = self.release.time_unit();
        // g = cosh(w)^2 turns the implicit relation into sinh(2w)/2 + w = 2 sqrt(B) t, which is smooth and
        // convex: from above Newton's steps fall to the root.
        let target = 2.0 * self.scaled.pressure.sqrt() * t / unit;
        let mut w = (target / 2.0).min((2.0 * target).asinh() / 2.0);
        for _ in 0..100 {
            let next = w - ((2.0 * w).sinh() / 2.0 + w - target) / ((2.0 * w).cosh() + 1.0);
            if next >= w {
                break;
            }
            w = next;
        }
        let (centre, velocity) = self.release.centre(&self.scaled, t);
        CapMotion {
            stretch: w.cosh().powi(2),
            stretch_rate: 2.0 * self.scaled.pressure.sqrt() * w.tanh() / unit,
            centre,
            velocity,
        }
    }

    /// The flow at `x` (m, down the slope from the first centre) and time `t >= 0` (s).
    pub fn flow(&self, x: f64, t: f64) -> Flow1 {
        let m = self.motion(t);
        let xi = x - m.centre;
        let r = xi / (self.release.length * m.stretch);
        if r.abs() >= 1.0 {
            return Flow1::DRY;
        }
        Flow1 {
            h: self.release.height / m.stretch * (1.0 - r * r),
            u: m.velocity + xi * m.stretch_rate / m.stretch,
        }
    }
}

/// Cap of elliptic plan on a plane in two dimensions, semi-analytic (Hutter, Siegel, Savage & Nohguchi 1993, Acta
/// Mechanica 100), with the lateral friction linearised: `-C v/|V|` is replaced by `-C v/((A - C) t)`.
///
/// Scaled as [`ParabolicCap`], y and v by `L_y`, with `D = (eps_y^2/eps_x) cos z k_y`, `eps_x = H/L`, `eps_y = H/L_y`:
///
/// ```text
/// h = (1 - xi^2/g^2 - eta^2/f^2)/(g f),   u = (A - C) t + xi g'/g,   v = eta f'/f
/// g'' = 2B/(g^2 f),   f'' = 2D/(g f^2) - C f'/((A - C) t),   g(0) = f(0) = 1, g'(0) = f'(0) = 0
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimilarityCap {
    release: CapRelease,
    scaled: Scaled,
    length_y: f64,
    lateral: f64,
}

/// A [`SimilarityCap`] at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimilarityCapState {
    /// Stretch down the slope and motion of the centre.
    pub along: CapMotion,
    /// Half width over its first value, f.
    pub stretch_y: f64,
    /// df/dt, 1/s.
    pub stretch_y_rate: f64,
    cap: SimilarityCap,
}

impl SimilarityCap {
    /// Sets the solution up for a half width `length_y` (m) and an earth pressure coefficient across the slope.
    ///
    /// # Errors
    /// As [`ParabolicCap::new`].
    pub fn new(release: CapRelease, length_y: f64, earth_pressure_y: f64) -> Result<Self, ExactError> {
        let scaled = release.scaled()?;
        positive("length_y", length_y)?;
        positive("earth pressure across", earth_pressure_y)?;
        let lateral =
            release.height * release.length / (length_y * length_y) * release.slope.cos() * earth_pressure_y;
        Ok(Self { release, scaled, length_y, lateral })
    }

    /// The cap at time `t >= 0` (s): stretches integrated to better than 1e-9.
    pub fn at(&self, t: f64) -> SimilarityCapState {
        let unit = self.release.time_unit();
        let [g, dg, f, df] = self.integrate(t / unit, 0.005);
        let (centre, velocity) = self.release.centre(&self.scaled, t);
        SimilarityCapState {
            along: CapMotion { stretch: g, stretch_rate: dg / unit, centre, velocity },
            stretch_y: f,
            stretch_y_rate: df / unit,
            cap: *self,
        }
    }

    /// (g, g', f, f') at the scaled time `t`: power series in t^2 over the singular start, then the classical
    /// Runge-Kutta method with steps of at most `step`.
    fn integrate(&self, t: f64, step: f64) -> [f64; 4] {
        let Scaled { pull, friction, pressure: b } = self.scaled;
        let d = self.lateral;
        let drag = friction / (pull - friction);
        let e = 1.0 / (1.0 + drag);
        let (g4, f4) = (-b * (2.0 * b + d * e) / 6.0, -d * (b + 2.0 * d * e) / (6.0 + 2.0 * drag));
        let series = |t: f64| {
            let s = t * t;
            [
                1.0 + b * s + g4 * s * s,
                t * (2.0 * b + 4.0 * g4 * s),
                1.0 + d * e * s + f4 * s * s,
                t * (2.0 * d * e + 4.0 * f4 * s),
            ]
        };
        let start = 0.02;
        if t <= start {
            return series(t);
        }
        let rate = |t: f64, [g, dg, f, df]: [f64; 4]| {
            [dg, 2.0 * b / (g * g * f), df, 2.0 * d / (g * f * f) - drag * df / t]
        };
        let along = |y: [f64; 4], k: [f64; 4], w: f64| core::array::from_fn(|i| y[i] + w * k[i]);
        let n = ((t - start) / step).ceil();
        let w = (t - start) / n;
        let mut y = series(start);
        for i in 0..n as usize {
            let t = start + i as f64 * w;
            let k1 = rate(t, y);
            let k2 = rate(t + w / 2.0, along(y, k1, w / 2.0));
            let k3 = rate(t + w / 2.0, along(y, k2, w / 2.0));
            let k4 = rate(t + w, along(y, k3, w));
            y = core::array::from_fn(|j| y[j] + w / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]));
        }
        y
    }
}

impl SimilarityCapState {
    /// Greatest depth, m.
    pub fn max_depth(&self) -> f64 {
        self.cap.release.height / (self.along.stretch * self.stretch_y)
    }

    /// The flow at `x` (m, down the slope from the first centre) and `y` (m, across from the line of symmetry).
    pub fn flow(&self, x: f64, y: f64) -> Flow2 {
        let m = self.along;
        let xi = x - m.centre;
        let (rx, ry) = (xi / (self.cap.release.length * m.stretch), y / (self.cap.length_y * self.stretch_y));
        let shape = 1.0 - rx * rx - ry * ry;
        if shape <= 0.0 {
            return Flow2::DRY;
        }
        Flow2 {
            h: self.max_depth() * shape,
            u: m.velocity + xi * m.stretch_rate / m.stretch,
            v: y * self.stretch_y_rate / self.stretch_y,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::residual;
    use super::*;
    use std::prelude::v1::*;

    const RELEASE: CapRelease = CapRelease {
        height: 4.0,
        length: 80.0,
        slope: 35.0 * core::f64::consts::PI / 180.0,
        friction: 25.0 * core::f64::consts::PI / 180.0,
        earth_pressure: 1.0,
        gravity: 9.81,
    };

    #[test]
    fn one_dimension_numbers_at_five_seconds() {
        let cap = ParabolicCap::new(RELEASE).unwrap();
        let m = cap.motion(5.0);
        assert!((m.stretch - 1.1207386).abs() < 5e-8, "{m:?}");
        assert!((cap.flow(m.centre, 5.0).h - 3.569075).abs() < 5e-7);
        assert!((m.centre - 23.49490).abs() < 5e-6, "{m:?}");
        assert!((m.velocity - 9.39796).abs() < 5e-6, "{m:?}");
        // the implicit relation itself
        let (g, b) = (m.stretch, RELEASE.height / RELEASE.length * RELEASE.slope.cos());
        let left = (g * (g - 1.0)).sqrt() + (g.sqrt() + (g - 1.0).sqrt()).ln();
        assert!((left - 2.0 * b.sqrt() * 5.0 / RELEASE.time_unit()).abs() < 1e-14);
        assert_eq!(cap.motion(0.0).stretch, 1.0);
        assert_eq!(cap.flow(m.centre - 1.13 * 80.0, 5.0), Flow1::DRY);
    }

    #[test]
    fn one_dimension_solves_the_equations() {
        let cap = ParabolicCap::new(RELEASE).unwrap();
        let (g, z, d) = (RELEASE.gravity, RELEASE.slope, RELEASE.friction);
        let source = g * (z.sin() - z.cos() * d.tan());
        for (x, t) in [(-60.0, 1.0), (30.0, 3.0), (200.0, 14.0), (500.0, 25.0)] {
            assert!(cap.flow(x, t).h > 0.1 && cap.flow(x, t).u > 0.0);
            let (m, q) = residual(|x, t| cap.flow(x, t), g * z.cos(), source, x, t, 0.01);
            assert!(m.abs() < 1e-9 && q.abs() < 1e-8, "{x} {t}: {m} {q}");
        }
    }

    #[test]
    fn two_dimensions_numbers() {
        let cap = SimilarityCap::new(RELEASE, 80.0, 1.0).unwrap();
        for (t, g, f, h) in [
            (1.0, 1.00501265, 1.00167351, 3.97340),
            (2.0, 1.0199352, 1.00664446, 3.89593),
            (5.0, 1.11998098, 1.0395397, 3.43564),
        ] {
            let s = cap.at(t);
            assert!((s.along.stretch - g).abs() < 6e-8, "{t}: g = {}", s.along.stretch);
            assert!((s.stretch_y - f).abs() < 6e-8, "{t}: f = {}", s.stretch_y);
            assert!((s.max_depth() - h).abs() < 6e-6, "{t}: h = {}", s.max_depth());
        }
        assert!((cap.at(5.0).along.centre - 23.49490).abs() < 5e-6);
    }

    #[test]
    fn two_dimensions_integration_is_converged() {
        let cap = SimilarityCap::new(RELEASE, 40.0, 0.7).unwrap();
        for t in [0.019, 0.021, 0.3, 2.0, 10.0] {
            let (a, b) = (cap.integrate(t, 0.005), cap.integrate(t, 0.00125));
            for i in 0..4 {
                assert!((a[i] - b[i]).abs() < 1e-9, "t = {t}: {a:?} {b:?}");
            }
        }
    }

    #[test]
    fn two_dimensions_solve_the_linearised_equations() {
        let cap = SimilarityCap::new(RELEASE, 50.0, 0.8).unwrap();
        let (z, d, gravity) = (RELEASE.slope, RELEASE.friction, RELEASE.gravity);
        let pull = gravity * (z.sin() - z.cos() * d.tan());
        let step = 0.02;
        let der = |f: &dyn Fn(f64) -> f64| (f(step) - f(-step)) / (2.0 * step);
        for (x, y, t) in [(10.0, 5.0, 2.0), (60.0, -20.0, 6.0), (20.0, 30.0, 4.0)] {
            let f = |dx: f64, dy: f64, dt: f64| cap.at(t + dt).flow(x + dx, y + dy);
            let s = f(0.0, 0.0, 0.0);
            assert!(s.h > 0.1);
            let mass = der(&|e| f(0.0, 0.0, e).h)
                + der(&|e| f(e, 0.0, 0.0).h * f(e, 0.0, 0.0).u)
                + der(&|e| f(0.0, e, 0.0).h * f(0.0, e, 0.0).v);
            let mx = der(&|e| f(0.0, 0.0, e).u) + s.u * der(&|e| f(e, 0.0, 0.0).u) - pull
                + gravity * z.cos() * der(&|e| f(e, 0.0, 0.0).h);
            let my = der(&|e| f(0.0, 0.0, e).v)
                + s.v * der(&|e| f(0.0, e, 0.0).v)
                + gravity * z.cos() * d.tan() * s.v / (pull * t)
                + gravity * z.cos() * 0.8 * der(&|e| f(0.0, e, 0.0).h);
            assert!(mass.abs() < 1e-5 && mx.abs() < 1e-5 && my.abs() < 1e-5, "{mass} {mx} {my}");
        }
    }

    #[test]
    fn refused_where_the_tail_would_climb() {
        let steep = CapRelease { friction: 34.0f64.to_radians(), ..RELEASE };
        assert!(matches!(ParabolicCap::new(steep), Err(ExactError::NotValid { .. })));
        assert!(ParabolicCap::new(CapRelease { height: 0.0, ..RELEASE }).is_err());
        assert!(SimilarityCap::new(RELEASE, -1.0, 1.0).is_err());
    }
}
