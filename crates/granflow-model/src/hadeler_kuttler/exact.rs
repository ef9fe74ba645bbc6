//! Exact equilibria (eq. 5) to measure by: u is the distance d to the open edges, v the sand poured uphill along the ray,
//! -div(v grad d) = f.
//!
//! Positions and lengths in the paper's scaling, f the source \[thickness per time\]. At re-entrant corners and at the ends
//! of an open edge rays fan out and v grows like 1/r: those have no place here.

use super::Pile;

/// \[0, length\] open at both ends: u = min(x, length - x), v = |int_x^{length/2} f|
/// (Aggarwal, Veerappa Gowda & Sudarshan Kumar 2023, eq. 52, for any f), from B(x) = int_0^x f.
pub fn open_line(length: f64, x: f64, b: impl Fn(f64) -> f64) -> Pile<f64> {
    Pile { u: x.min(length - x), v: (b(length / 2.0) - b(x)).abs() }
}

/// \[0, length\] open at 0, a wall at the other end: u = x, v = int_x^length f, from B(x) = int_0^x f.
pub fn half_open_line(length: f64, x: f64, b: impl Fn(f64) -> f64) -> Pile<f64> {
    Pile { u: x, v: b(length) - b(x) }
}

/// The rectangle \[0, sides\] under a constant source, `open[axis]` its lower and upper side, the others walls; `None` if all
/// are walls.
///
/// The nearest open place lies straight below some open side, u = its distance, and the ray runs straight up to the ridge,
/// where another side becomes as near, or to a wall: v = f (length of the ray uphill).
pub fn rectangle(sides: [f64; 2], open: [[bool; 2]; 2], f: f64, [x, y]: [f64; 2]) -> Option<Pile<f64>> {
    let ends = |axis: usize, place: f64| {
        [place, sides[axis] - place]
            .into_iter()
            .zip(open[axis])
            .filter_map(|(distance, open)| open.then_some(distance))
            .fold(f64::INFINITY, f64::min)
    };
    let near = [ends(0, x), ends(1, y)];
    let u = near[0].min(near[1]);
    let axis = if near[0] <= near[1] { 0 } else { 1 };
    let both = open[axis][0] && open[axis][1];
    let summit = near[1 - axis].min(if both { sides[axis] / 2.0 } else { sides[axis] });
    u.is_finite().then_some(Pile { u, v: f * (summit - u) })
}

/// A round table of radius R, open all round, under a constant source, at distance r of its centre: u = R - r, v = f r/2.
pub fn disc(radius: f64, f: f64, r: f64) -> Pile<f64> {
    Pile { u: radius - r, v: f * r / 2.0 }
}

/// A round table of radius R with a wall round it and an open hole of radius a in its middle, under a constant source, at
/// distance r of its centre: u = r - a, v = f (R^2 - r^2)/(2 r), the sand of the ring outside falling through the
/// circle of radius r.
pub fn funnel(radius: f64, hole: f64, f: f64, r: f64) -> Pile<f64> {
    Pile { u: r - hole, v: f * (radius * radius - r * r) / (2.0 * r) }
}

#[cfg(test)]
mod tests {
    use super::{disc, funnel, half_open_line, open_line, rectangle};
    use std::prelude::v1::*;

    const F: f64 = 0.7;

    /// |grad u| - 1 and -div(v grad u) - f at a smooth point, by central differences.
    fn residual(pile: impl Fn(f64, f64) -> super::Pile<f64>, x: f64, y: f64) -> [f64; 2] {
        let e = 1e-4;
        let u = |x, y| pile(x, y).u;
        let grad = |x, y| [(u(x + e, y) - u(x - e, y)) / (2.0 * e), (u(x, y + e) - u(x, y - e)) / (2.0 * e)];
        let flow = |x, y, k: usize| pile(x, y).v * grad(x, y)[k];
        let div = (flow(x + e, y, 0) - flow(x - e, y, 0) + flow(x, y + e, 1) - flow(x, y - e, 1)) / (2.0 * e);
        let [a, b] = grad(x, y);
        [a.hypot(b) - 1.0, -div - F]
    }

    #[test]
    fn they_solve_the_equations() {
        let open =
            |open: [[bool; 2]; 2]| move |x: f64, y: f64| rectangle([1.0, 0.8], open, F, [x, y]).unwrap();
        let (yes, no) = (true, false);
        for sides in [[[yes; 2]; 2], [[yes, no], [yes, yes]], [[yes, no], [no, yes]], [[no, yes], [no, no]]] {
            for [x, y] in [[0.1, 0.3], [0.3, 0.12], [0.9, 0.5], [0.62, 0.71]] {
                let left = residual(open(sides), x, y);
                assert!(left.iter().all(|r| r.abs() < 1e-6), "{sides:?} {x} {y}: {left:?}");
            }
        }
        let round = |x: f64, y: f64| disc(1.0, F, x.hypot(y));
        let hole = |x: f64, y: f64| funnel(1.0, 0.2, F, x.hypot(y));
        for [x, y] in [[0.3, 0.4], [-0.6, 0.2], [0.1, -0.7]] {
            assert!(residual(round, x, y).iter().all(|r| r.abs() < 1e-6));
            assert!(residual(hole, x, y).iter().all(|r| r.abs() < 1e-6));
        }
    }

    #[test]
    fn a_table_with_two_walls_is_a_line() {
        let line = |x: f64| open_line(2.0, x, |x| F * x);
        let half = |x: f64| half_open_line(2.0, x, |x| F * x);
        for x in [0.1, 0.9, 1.3, 1.8] {
            let strip = |right| rectangle([2.0, 0.3], [[true, right], [false; 2]], F, [x, 0.1]).unwrap();
            assert!((strip(true).v - line(x).v).abs() < 1e-15 && strip(true).u == line(x).u);
            assert!((strip(false).v - half(x).v).abs() < 1e-15 && strip(false).u == half(x).u);
        }
        assert!(rectangle([1.0; 2], [[false; 2]; 2], F, [0.5; 2]).is_none());
    }
}
