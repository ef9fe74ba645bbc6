//! Ordinary differential equations, by the classical Runge-Kutta method.

/// y at time `end` of dy/dt = `rate`(t, y) from `start` at 0, in `steps` equal steps.
pub fn solve<const N: usize>(
    start: [f64; N],
    end: f64,
    steps: u32,
    rate: impl Fn(f64, [f64; N]) -> [f64; N],
) -> [f64; N] {
    let dt = end / f64::from(steps);
    let along = |y: [f64; N], k: [f64; N], t: f64| -> [f64; N] { std::array::from_fn(|i| y[i] + t * k[i]) };
    let mut y = start;
    for step in 0..steps {
        let t = f64::from(step) * dt;
        let k1 = rate(t, y);
        let k2 = rate(t + dt / 2.0, along(y, k1, dt / 2.0));
        let k3 = rate(t + dt / 2.0, along(y, k2, dt / 2.0));
        let k4 = rate(t + dt, along(y, k3, dt));
        y = std::array::from_fn(|i| y[i] + dt / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    y
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_pendulum_swings_back() {
        let [x, v] = super::solve([1.0, 0.0], std::f64::consts::TAU, 1000, |_, [x, v]| [v, -x]);
        assert!((x - 1.0).abs() < 1e-10 && v.abs() < 1e-10);
    }
}
