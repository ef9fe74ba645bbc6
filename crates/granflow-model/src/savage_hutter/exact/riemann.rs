//! The Riemann problem without source.

use super::values::{ExactError, Flow1, finite, not_negative, positive};

/// One of the two waves of a Riemann solution, by its speeds from left to right.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wave {
    /// A continuous fan between two speeds; `from == to` where nothing happens.
    Rarefaction {
        /// Speed of the left edge.
        from: f64,
        /// Speed of the right edge.
        to: f64,
    },
    /// A jump.
    Shock {
        /// Its speed.
        speed: f64,
    },
}

/// Exact solution of `h_t + (hu)_x = 0`, `(hu)_t + (hu^2 + beta h^2/2)_x = 0` for two constant states that
/// meet at x = 0: every pattern of shocks and fans, dry sides, and a dry middle.
///
/// The states left and right of the middle are joined to it by `u_m = u_l - f(h_m; h_l) = u_r + f(h_m; h_r)`,
///
/// ```text
/// f(h; h_k) = 2 (sqrt(beta h) - sqrt(beta h_k))                      h <= h_k, fan
///           = (h - h_k) sqrt(beta (h + h_k) / (2 h h_k))             h >  h_k, shock
/// ```
///
/// (Toro 2001, *Shock-capturing methods for free-surface shallow flows*, ch. 5). For a left fan and a right shock
/// it is section 4 of Kaland & Struckmeier (2007), whose fan must read
/// `u = (2/3) (x/t + sqrt(beta h_l) + u_l/2)`; they print `- u_l/2`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Riemann {
    beta: f64,
    left: Flow1,
    right: Flow1,
    middle: Option<Flow1>,
    left_wave: Option<Wave>,
    right_wave: Option<Wave>,
}

impl Riemann {
    /// Solves the problem for `beta > 0` and two states with `h >= 0` and finite `u`; a dry side's `u` is ignored.
    ///
    /// # Errors
    /// [`ExactError::OutOfRange`] for any other value.
    pub fn new(beta: f64, left: Flow1, right: Flow1) -> Result<Self, ExactError> {
        positive("beta", beta)?;
        not_negative("h_l", left.h)?;
        not_negative("h_r", right.h)?;
        finite("u_l", left.u)?;
        finite("u_r", right.u)?;
        let wet = |s: Flow1| if s.h > 0.0 { s } else { Flow1::DRY };
        let (left, right) = (wet(left), wet(right));
        let (cl, cr) = ((beta * left.h).sqrt(), (beta * right.h).sqrt());

        let dry_middle = left.h == 0.0 || right.h == 0.0 || right.u - left.u >= 2.0 * (cl + cr);
        let middle = (!dry_middle).then(|| middle(beta, left, right));
        let left_wave = (left.h > 0.0).then(|| match middle {
            Some(m) if m.h > left.h => Wave::Shock { speed: left.u - shock_speed(beta, m.h, left.h) },
            Some(m) => Wave::Rarefaction { from: left.u - cl, to: m.u - (beta * m.h).sqrt() },
            None => Wave::Rarefaction { from: left.u - cl, to: left.u + 2.0 * cl },
        });
        let right_wave = (right.h > 0.0).then(|| match middle {
            Some(m) if m.h > right.h => Wave::Shock { speed: right.u + shock_speed(beta, m.h, right.h) },
            Some(m) => Wave::Rarefaction { from: m.u + (beta * m.h).sqrt(), to: right.u + cr },
            None => Wave::Rarefaction { from: right.u - 2.0 * cr, to: right.u + cr },
        });
        Ok(Self { beta, left, right, middle, left_wave, right_wave })
    }

    /// Stoker's dam break: depths `h_l` and `h_r` at rest (Stoker 1957).
    ///
    /// # Errors
    /// As [`Riemann::new`].
    pub fn stoker(beta: f64, h_l: f64, h_r: f64) -> Result<Self, ExactError> {
        Self::new(beta, Flow1 { h: h_l, u: 0.0 }, Flow1 { h: h_r, u: 0.0 })
    }

    /// Ritter's dam break onto a dry bed: `h = (2 sqrt(beta h_l) - x/t)^2 / (9 beta)` in the fan (Ritter 1892).
    ///
    /// # Errors
    /// As [`Riemann::new`].
    pub fn ritter(beta: f64, h_l: f64) -> Result<Self, ExactError> {
        Self::stoker(beta, h_l, 0.0)
    }

    /// The constant state between the waves; `None` where the middle is dry.
    pub fn middle(&self) -> Option<Flow1> {
        self.middle
    }

    /// The wave into the left state; `None` where the left side is dry.
    pub fn left_wave(&self) -> Option<Wave> {
        self.left_wave
    }

    /// The wave into the right state; `None` where the right side is dry.
    pub fn right_wave(&self) -> Option<Wave> {
        self.right_wave
    }

    /// The solution on the ray `x/t = speed`; on a shock, the state left of it.
    pub fn on_ray(&self, speed: f64) -> Flow1 {
        let between = self.middle.unwrap_or(Flow1::DRY);
        match self.left_wave {
            Some(Wave::Shock { speed: s }) if speed <= s => return self.left,
            Some(Wave::Rarefaction { from, .. }) if speed <= from => return self.left,
            Some(Wave::Rarefaction { to, .. }) if speed <= to => {
                // u + 2c is that of the left state and u - c is the ray
                let c = (self.left.u + 2.0 * (self.beta * self.left.h).sqrt() - speed) / 3.0;
                return Flow1 { h: c * c / self.beta, u: speed + c };
            }
            _ => {}
        }
        match self.right_wave {
            Some(Wave::Shock { speed: s }) if speed <= s => between,
            Some(Wave::Rarefaction { from, .. }) if speed <= from => between,
            Some(Wave::Rarefaction { to, .. }) if speed <= to => {
                let c = (speed - self.right.u + 2.0 * (self.beta * self.right.h).sqrt()) / 3.0;
                Flow1 { h: c * c / self.beta, u: speed - c }
            }
            Some(_) => self.right,
            None => between,
        }
    }

    /// The solution at `x` and time `t`; for `t <= 0` the initial data, the left state up to and with x = 0.
    pub fn flow(&self, x: f64, t: f64) -> Flow1 {
        if t > 0.0 {
            self.on_ray(x / t)
        } else if x <= 0.0 {
            self.left
        } else {
            self.right
        }
    }
}

/// f(h; h_k) and its derivative by h.
fn wave_curve(beta: f64, h: f64, h_k: f64) -> (f64, f64) {
    if h <= h_k {
        (2.0 * ((beta * h).sqrt() - (beta * h_k).sqrt()), (beta / h).sqrt())
    } else {
        let s = (beta / 2.0 * (h + h_k) / (h * h_k)).sqrt();
        ((h - h_k) * s, s - beta * (h - h_k) / (4.0 * h * h * s))
    }
}

/// Speed of a shock against the state `h_k` it runs into, (h u - h_k u_k)/(h - h_k) without the cancellation.
fn shock_speed(beta: f64, h: f64, h_k: f64) -> f64 {
    (beta / 2.0 * (h + h_k) * h / h_k).sqrt()
}

fn middle(beta: f64, left: Flow1, right: Flow1) -> Flow1 {
    let balance = |h: f64| {
        let (l, r) = (wave_curve(beta, h, left.h), wave_curve(beta, h, right.h));
        (l.0 + r.0 + right.u - left.u, l.1 + r.1)
    };
    let lower = left.h.min(right.h);
    let h = if balance(lower).0 >= 0.0 {
        // two fans
        let c = ((beta * left.h).sqrt() + (beta * right.h).sqrt()) / 2.0 + (left.u - right.u) / 4.0;
        c * c / beta
    } else {
        // The balance grows with h and is concave: from below Newton's steps rise to the root.
        let mut h = lower;
        for _ in 0..200 {
            let (value, slope) = balance(h);
            let next = h - value / slope;
            if next <= h {
                break;
            }
            h = next;
        }
        h
    };
    let (l, r) = (wave_curve(beta, h, left.h).0, wave_curve(beta, h, right.h).0);
    Flow1 { h, u: (left.u - l + right.u + r) / 2.0 }
}

#[cfg(test)]
mod tests {
    use super::super::tests::residual;
    use super::*;
    use std::prelude::v1::*;

    fn state(h: f64, u: f64) -> Flow1 {
        Flow1 { h, u }
    }

    #[test]
    fn published_example() {
        let beta: f64 = 0.4;
        let r = Riemann::stoker(beta, 1.0, 0.5).unwrap();
        let m = r.middle().unwrap();
        assert!((m.h - 0.7269204461872865).abs() < 2e-16, "{m:?}");
        assert!((m.u - 0.18645257441665675).abs() < 2e-16, "{m:?}");
        let Some(Wave::Shock { speed }) = r.right_wave() else { unreachable!("{r:?}") };
        assert!((speed - 0.5972850435692381).abs() < 1e-15, "{speed}");
        assert!((m.q() / (m.h - 0.5) - speed).abs() < 1e-15, "the printed formula");
        assert_eq!(
            r.left_wave(),
            Some(Wave::Rarefaction { from: -beta.sqrt(), to: m.u - (beta * m.h).sqrt() })
        );
        // The printed fan (x0 = 0, u_l = 0).
        let y = -0.45;
        let inside = r.on_ray(y);
        assert!((inside.h - (2.0 * beta.sqrt() - y).powi(2) / (9.0 * beta)).abs() < 1e-15);
        assert!((inside.u - 2.0 / 3.0 * (y + beta.sqrt())).abs() < 1e-15);
        assert_eq!(r.flow(5.0, 5.0), state(0.5, 0.0));
        assert_eq!((r.flow(0.0, 0.0).h, r.flow(1e-9, 0.0).h), (1.0, 0.5));
    }

    /// Across every shock mass and momentum balance and the shock is compressive; in every fan the PDE holds.
    #[test]
    fn every_pattern_solves_the_equations() {
        let beta = 0.7;
        let states = [0.0, 0.2, 1.0, 1.3];
        let speeds = [-3.5, -0.4, 0.0, 0.9, 3.5];
        let mut seen = [0; 4];
        for hl in states {
            for hr in states {
                for ul in speeds {
                    for ur in speeds {
                        let r = Riemann::new(beta, state(hl, ul), state(hr, ur)).unwrap();
                        for wave in [r.left_wave(), r.right_wave()].into_iter().flatten() {
                            match wave {
                                Wave::Shock { speed: s } => {
                                    let d = 1e-9;
                                    let (a, b) = (r.on_ray(s - d), r.on_ray(s + d));
                                    let force = |f: Flow1| f.q() * f.u + beta * f.h * f.h / 2.0;
                                    assert!((s * (b.h - a.h) - (b.q() - a.q())).abs() < 1e-12, "{r:?}");
                                    assert!(
                                        (s * (b.q() - a.q()) - (force(b) - force(a))).abs() < 1e-11,
                                        "{r:?}"
                                    );
                                    assert!(a.u > b.u - 1e-12, "expansion shock: {r:?}");
                                }
                                Wave::Rarefaction { from, to } => {
                                    assert!(to >= from, "{r:?}");
                                    if to - from > 0.02 {
                                        let x = 0.3 * from + 0.7 * to;
                                        let (m, q) = residual(|x, t| r.flow(x, t), beta, 0.0, x, 1.0, 1e-3);
                                        assert!(m.abs() < 1e-8 && q.abs() < 1e-8, "{m} {q} {r:?}");
                                    }
                                    // continuous at both edges
                                    for edge in [from, to] {
                                        let (a, b) = (r.on_ray(edge - 1e-10), r.on_ray(edge + 1e-10));
                                        assert!((a.h - b.h).abs() < 1e-8, "{r:?}");
                                    }
                                }
                            }
                        }
                        seen[match (r.left_wave(), r.right_wave()) {
                            (Some(Wave::Shock { .. }), Some(Wave::Shock { .. })) => 0,
                            (Some(Wave::Shock { .. }), _) => 1,
                            (_, Some(Wave::Shock { .. })) => 2,
                            _ => 3,
                        }] += 1;
                    }
                }
            }
        }
        assert!(seen.iter().all(|&n| n > 10), "shock-shock, shock-fan, fan-shock, fan-fan: {seen:?}");
    }

    #[test]
    fn ritter_front_runs_at_twice_the_wave_speed() {
        let (beta, h0) = (9.81, 2.0);
        let r = Riemann::ritter(beta, h0).unwrap();
        let c0 = (beta * h0).sqrt();
        assert_eq!(r.middle(), None);
        assert_eq!(r.left_wave(), Some(Wave::Rarefaction { from: -c0, to: 2.0 * c0 }));
        assert!((r.flow(0.0, 3.0).h - 4.0 / 9.0 * h0).abs() < 1e-15);
        assert_eq!(r.flow(2.001 * c0, 1.0), Flow1::DRY);
        // the mirror image
        let m = Riemann::stoker(beta, 0.0, h0).unwrap();
        let (a, b) = (r.flow(0.7, 0.2), m.flow(-0.7, 0.2));
        assert!((a.h - b.h).abs() < 1e-14 && (a.u + b.u).abs() < 1e-14);
        assert_eq!(m.flow(-2.001 * c0, 1.0), Flow1::DRY);
    }

    #[test]
    fn equal_states_stay_and_receding_ones_leave_a_dry_middle() {
        let s = state(0.6, -0.3);
        let r = Riemann::new(0.5, s, s).unwrap();
        for y in [-2.0, -0.3, 0.0, 1.0] {
            let f = r.on_ray(y);
            assert!((f.h - s.h).abs() < 1e-15 && (f.u - s.u).abs() < 1e-15, "{f:?}");
        }
        let apart = Riemann::new(0.5, state(1.0, -3.0), state(1.0, 3.0)).unwrap();
        assert_eq!((apart.middle(), apart.on_ray(0.0)), (None, Flow1::DRY));
        let nothing = Riemann::stoker(0.5, 0.0, 0.0).unwrap();
        assert_eq!(nothing.flow(0.1, 1.0), Flow1::DRY);
    }

    #[test]
    fn bad_input_is_refused() {
        assert!(Riemann::stoker(0.0, 1.0, 1.0).is_err());
        assert!(Riemann::stoker(1.0, -1.0, 1.0).is_err());
        assert!(Riemann::new(1.0, state(1.0, f64::NAN), state(1.0, 0.0)).is_err());
    }
}
