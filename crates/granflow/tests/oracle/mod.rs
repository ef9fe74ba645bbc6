//! A literal transcription of the five published kinetic schemes for the Savage-Hutter equations, to check
//! the library against. It uses nothing of the library: plain `f64`, plain loops, one dimension.
//!
//! Sources: C. Kaland and J. Struckmeier, *A kinetic scheme for the Savage-Hutter equations*, Hamburger
//! Beiträge zur Angewandten Mathematik 2007-15 ("report": Schemes 1, 2, 3), and C. Kaland, *Ein kinetisches
//! Verfahren für die Savage-Hutter-Gleichungen*, Diplomarbeit, Hamburg 2007 ("thesis": Verfahren 1 to 5).
//! Report Scheme 1, 2, 3 = Verfahren 1, 4, 5.
//!
//! The formulas are the printed ones, with `arcsin`, `sin(2 arcsin)`, `cos^3(arcsin)` and the three printed
//! cases, save these misprints:
//!
//! - `I_3`, |a_1| < 1: `sin(a_1)/32` reads `sin(4 arcsin a_1)/32`, and the cos^3 term has a plus sign;
//! - `I_4`, a_2 >= 1: `(u_i)^2` reads `(u_{i+1})^2`;
//! - Verfahren 5 of the thesis, moving branch: the source `dt g(q) h^{n+1}` is added (the report has it).
//!
//! Where the papers are silent: the ghost cells copy the edge cells, initial data are point values at the
//! cell centres `x_from + (i + 1/2) dx`, a cell with h = 0 has u = 0 and sends nothing, q = 0 counts as rest
//! (with zeta = delta = 0 the printed strict test `0 < 0` never holds), and mu = 0 there. The earth pressure
//! coefficient is the one of equal friction angles, k = 1 + 2 tan^2 delta. All quantities are dimensionless:
//! lengths by L, heights by H = eps L, time by sqrt(L/g).
#![allow(dead_code)]

use std::f64::consts::PI;

/// One published example: the model's constants, the grid and the initial height (the mass starts at rest).
#[derive(Clone, Copy)]
pub struct Case {
    /// Characteristic height over characteristic length.
    pub eps: f64,
    /// Inclination of the chute, rad.
    pub zeta: f64,
    /// Friction angle, inside and at the bed, rad.
    pub delta: f64,
    /// Left end of the domain.
    pub x_from: f64,
    /// Right end of the domain.
    pub x_to: f64,
    /// Number of cells.
    pub cells: usize,
    /// Time step.
    pub dt: f64,
    /// Height at t = 0 as a function of x.
    pub initial: fn(f64) -> f64,
}

impl Case {
    /// Cell width.
    pub fn dx(&self) -> f64 {
        (self.x_to - self.x_from) / self.cells as f64
    }

    /// Cell centres.
    pub fn centres(&self) -> Vec<f64> {
        (0..self.cells).map(|i| self.x_from + (i as f64 + 0.5) * self.dx()).collect()
    }

    /// beta = eps k cos(zeta), k = 1 + 2 tan^2(delta).
    pub fn beta(&self) -> f64 {
        self.eps * (1.0 + 2.0 * self.delta.tan() * self.delta.tan()) * self.zeta.cos()
    }
}

/// The examples of the papers by name: `constant`, `constant_inclined`, `riemann`, `silo`, `inclined_silo`,
/// `parabola`, `sine`; dx = 0.05 and dt = 0.001 in all of them.
///
/// The papers do not print the domains, the silo's walls and the positions x0. Chosen here: \[-6, 6\] with 240
/// cells for the constant states and both silos (walls at -1 and 1), \[-5, 5\] with 200 cells and x0 = 0 for
/// `riemann`, \[-2, 2\] with 80 cells and x0 = 0 for `parabola`, \[-1, 9\] with 200 cells for `sine`.
pub fn published(name: &str) -> Case {
    let silo = |x: f64| if -1.0 < x && x <= 1.0 { 2.3 } else { 0.3 };
    let rest = Case {
        eps: 0.4,
        zeta: 0.0,
        delta: PI / 8.0,
        x_from: -6.0,
        x_to: 6.0,
        cells: 240,
        dt: 0.001,
        initial: |_| 1.0,
    };
    match name {
        "constant" => rest,
        "constant_inclined" => Case { zeta: PI / 16.0, ..rest },
        "riemann" => Case {
            delta: 0.0,
            x_from: -5.0,
            x_to: 5.0,
            cells: 200,
            initial: |x| if x <= 0.0 { 1.0 } else { 0.5 },
            ..rest
        },
        "silo" => Case { delta: PI / 10.0, initial: silo, ..rest },
        "inclined_silo" => Case { zeta: PI / 15.0, delta: PI / 5.0, initial: silo, ..rest },
        "parabola" => Case {
            delta: PI / 15.0,
            x_from: -2.0,
            x_to: 2.0,
            cells: 80,
            initial: |x| f64::max(1.0 / 10.0, 1.0 - 4.0 * x * x),
            ..rest
        },
        "sine" => Case {
            eps: 0.3218,
            zeta: PI / 6.0,
            delta: PI / 18.0,
            x_from: -1.0,
            x_to: 9.0,
            cells: 200,
            initial: |x| {
                if 0.6 < x && x < 1.6 {
                    let y = PI * (x - 0.6);
                    f64::max(0.9 * y.sin() - 0.3 * (2.0 * y).sin(), 0.1)
                } else {
                    0.1
                }
            },
            ..rest
        },
        _ => panic!("no published case is called {name}"),
    }
}

/// I_1: mass that leaves a cell of height `h` and momentum `hu` to the right (xi >= 0).
pub fn i1(h: f64, hu: f64, u: f64, beta: f64) -> f64 {
    if h == 0.0 {
        return 0.0;
    }
    let a1 = -u / (2.0 * beta * h).sqrt();
    if a1 <= -1.0 {
        hu
    } else if a1 >= 1.0 {
        0.0
    } else {
        2.0 / (3.0 * PI) * (2.0 * beta).sqrt() * h.powf(1.5) * a1.asin().cos().powi(3)
            + 2.0 / PI * hu * (PI / 4.0 - a1.asin() / 2.0 - (2.0 * a1.asin()).sin() / 4.0)
    }
}

/// I_2: mass that leaves a cell to the left (xi < 0), counted to the right.
pub fn i2(h: f64, hu: f64, u: f64, beta: f64) -> f64 {
    if h == 0.0 {
        return 0.0;
    }
    let a2 = -u / (2.0 * beta * h).sqrt();
    if a2 <= -1.0 {
        0.0
    } else if a2 >= 1.0 {
        hu
    } else {
        -2.0 / (3.0 * PI) * (2.0 * beta).sqrt() * h.powf(1.5) * a2.asin().cos().powi(3)
            + 2.0 / PI * hu * (PI / 4.0 + a2.asin() / 2.0 + (2.0 * a2.asin()).sin() / 4.0)
    }
}

/// I_3, corrected: momentum carried to the right out of a cell.
pub fn i3(h: f64, hu: f64, u: f64, beta: f64) -> f64 {
    if h == 0.0 {
        return 0.0;
    }
    let a1 = -u / (2.0 * beta * h).sqrt();
    if a1 <= -1.0 {
        h * u * u + 0.5 * beta * h * h
    } else if a1 >= 1.0 {
        0.0
    } else {
        4.0 / PI * beta * h * h * (PI / 16.0 - a1.asin() / 8.0 + (4.0 * a1.asin()).sin() / 32.0)
            + 4.0 / (3.0 * PI) * (2.0 * beta).sqrt() * hu * h.sqrt() * a1.asin().cos().powi(3)
            + 2.0 / PI * h * u * u * (PI / 4.0 - a1.asin() / 2.0 - (2.0 * a1.asin()).sin() / 4.0)
    }
}

/// I_3 for |a_1| < 1 as both papers print it, misprints included.
pub fn i3_as_printed(h: f64, u: f64, beta: f64) -> f64 {
    let a1 = -u / (2.0 * beta * h).sqrt();
    4.0 / PI * beta * h * h * (PI / 16.0 - a1.asin() / 8.0 + a1.sin() / 32.0)
        - 4.0 / (3.0 * PI) * (2.0 * beta).sqrt() * h * u * h.sqrt() * a1.asin().cos().powi(3)
        + 2.0 / PI * h * u * u * (PI / 4.0 - a1.asin() / 2.0 - (2.0 * a1.asin()).sin() / 4.0)
}

/// I_4, corrected: momentum carried to the left out of a cell.
pub fn i4(h: f64, hu: f64, u: f64, beta: f64) -> f64 {
    if h == 0.0 {
        return 0.0;
    }
    let a2 = -u / (2.0 * beta * h).sqrt();
    if a2 <= -1.0 {
        0.0
    } else if a2 >= 1.0 {
        h * u * u + 0.5 * beta * h * h
    } else {
        4.0 / PI * beta * h * h * (a2.asin() / 8.0 + PI / 16.0 - (4.0 * a2.asin()).sin() / 32.0)
            - 4.0 / (3.0 * PI) * (2.0 * beta).sqrt() * hu * h.sqrt() * a2.asin().cos().powi(3)
            + 2.0 / PI * h * u * u * (PI / 4.0 + a2.asin() / 2.0 + (2.0 * a2.asin()).sin() / 4.0)
    }
}

fn speed(h: f64, q: f64) -> f64 {
    if h == 0.0 { 0.0 } else { q / h }
}

/// F_{i+1/2}: each cell sends with its own height.
fn flux_own(hl: f64, ql: f64, hr: f64, qr: f64, beta: f64) -> (f64, f64) {
    let (ul, ur) = (speed(hl, ql), speed(hr, qr));
    (i1(hl, ql, ul, beta) + i2(hr, qr, ur, beta), i3(hl, ql, ul, beta) + i4(hr, qr, ur, beta))
}

/// F~_{i+1/2}: both cells send with the mean height, upwinding in u only.
fn flux_mean(hl: f64, ql: f64, hr: f64, qr: f64, beta: f64) -> (f64, f64) {
    let (ul, ur) = (speed(hl, ql), speed(hr, qr));
    let h = (hl + hr) / 2.0;
    (i1(h, h * ul, ul, beta) + i2(h, h * ur, ur, beta), i3(h, h * ul, ul, beta) + i4(h, h * ur, ur, beta))
}

/// One step of Verfahren `verfahren` (1 to 5) on `h` and `q = h u`.
pub fn step(verfahren: u8, case: &Case, h: &[f64], q: &[f64]) -> (Vec<f64>, Vec<f64>) {
    assert!((1..=5).contains(&verfahren), "there are Verfahren 1 to 5, not {verfahren}");
    let n = h.len();
    let (dx, dt, beta) = (case.dx(), case.dt, case.beta());
    let lambda = dt / dx;
    let sin_zeta = case.zeta.sin();
    let r = case.zeta.cos() * case.delta.tan();
    // g(q), only used for q != 0
    let g = |q: f64| if q > 0.0 { sin_zeta - r } else { sin_zeta + r };

    // Face f lies between the cells f - 1 and f; the ghosts copy the edge cells.
    let mut own = vec![(0.0, 0.0); n + 1];
    let mut mean = vec![(0.0, 0.0); n + 1];
    for f in 0..=n {
        let l = if f == 0 { 0 } else { f - 1 };
        let r = if f == n { n - 1 } else { f };
        if verfahren == 1 || verfahren == 5 {
            own[f] = flux_own(h[l], q[l], h[r], q[r], beta);
        }
        if verfahren >= 2 {
            mean[f] = flux_mean(h[l], q[l], h[r], q[r], beta);
        }
    }

    let mut h_new = vec![0.0; n];
    let mut q_new = vec![0.0; n];
    for i in 0..n {
        let left = if i == 0 { 0 } else { i - 1 };
        let right = if i == n - 1 { n - 1 } else { i + 1 };
        let (own_left, own_right) = (own[i], own[i + 1]);
        let (mean_left, mean_right) = (mean[i], mean[i + 1]);

        let g_tilde =
            f64::min(sin_zeta + r, f64::max(beta * ((h[right] - h[left]) / (2.0 * dx)), sin_zeta - r));
        let h_bar = (h[right] + 2.0 * h[i] + h[left]) / 4.0;

        let h_own = h[i] - lambda * (own_right.0 - own_left.0);
        let h_mean = h[i] - lambda * (mean_right.0 - mean_left.0);
        let q_own = q[i] - lambda * (own_right.1 - own_left.1);
        let q_mean = q[i] - lambda * (mean_right.1 - mean_left.1);
        let resting = |h_next: f64| q[i] == 0.0 || q[i].abs() < (dt * g(q[i]) * h_next).abs();
        let mu = |h_next: f64| if q[i] == 0.0 { 0.0 } else { -q[i] / (dt * g(q[i]) * h_next) };

        (h_new[i], q_new[i]) = match verfahren {
            1 if q[i] == 0.0 => (h_own, q_own + dt * g_tilde * h_own),
            1 => (h_own, q_own + dt * g(q[i]) * h_own),
            2 if q[i] == 0.0 => (h_mean, q_mean + dt * g_tilde * h_bar),
            2 => (h_mean, q_mean + dt * g(q[i]) * h_mean),
            3 if resting(h_mean) => (h_mean, q_mean + dt * g_tilde * h_bar),
            3 => (h_mean, q_mean + dt * g(q[i]) * h_mean),
            4 if resting(h_mean) => {
                (h_mean, -lambda * (mean_right.1 - mean_left.1) + (1.0 - mu(h_mean)) * dt * g_tilde * h_bar)
            }
            4 => (h_mean, q_mean + dt * g(q[i]) * h_mean),
            _ if resting(h_own) => {
                (h_mean, -lambda * (mean_right.1 - mean_left.1) + (1.0 - mu(h_own)) * dt * g_tilde * h_bar)
            }
            _ => (h_own, q_own + dt * g(q[i]) * h_own),
        };
    }
    (h_new, q_new)
}

/// The initial heights of a case and q = 0.
pub fn start(case: &Case) -> (Vec<f64>, Vec<f64>) {
    (case.centres().into_iter().map(case.initial).collect(), vec![0.0; case.cells])
}

/// Heights and momenta after `steps` steps of Verfahren `verfahren` (1 to 5), starting at rest.
pub fn run(verfahren: u8, case: &Case, steps: usize) -> (Vec<f64>, Vec<f64>) {
    let (mut h, mut q) = start(case);
    for _ in 0..steps {
        (h, q) = step(verfahren, case, &h, &q);
    }
    (h, q)
}
