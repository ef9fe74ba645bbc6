//! The piles of [`super`]: shapes, and the beds that they lie on.

use granflow::grid::Grid;
use granflow::savage_hutter::Flow;
use granflow::savage_hutter::ground::Chute;
use granflow::scheme::Boundary;

use crate::failure::Failure;
use crate::verify::dice::Dice;
use crate::verify::scheme::{Run, Scheme, Setting, Surface, grid, on_bed, on_plane, plane, terrain};

/// Friction and film of all piles.
pub const MU: f64 = 0.5;
pub const FILM: f64 = 1e-6;

/// The shape of a pile around the origin, as a length: 1 along its steepest descent.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    Cone,
    /// A ridge whose sides fall in the direction of this angle, in degrees.
    Roof(f64),
    /// The same with ends that fall along the ridge.
    Hip(f64),
}

impl Shape {
    /// Distance in the metric of the tangent plane over the gradient `slope` (chute: 0).
    fn distance(self, [x, y]: [f64; 2], slope: [f64; 2]) -> f64 {
        match self {
            Shape::Cone => (x * x + y * y + (slope[0] * x + slope[1] * y).powi(2)).sqrt(),
            Shape::Roof(angle) => {
                let (sin, cos) = angle.to_radians().sin_cos();
                let c2 = 1.0 / (1.0 + slope[0].powi(2) + slope[1].powi(2));
                // |n|^2 in the dual metric I - s s^T
                let dual = 1.0 - c2 * (cos * slope[0] + sin * slope[1]).powi(2);
                (x * cos + y * sin).abs() / dual.sqrt()
            }
            Shape::Hip(angle) => {
                let ends = Shape::Roof(angle + 90.0).distance([x, y], slope) - 0.2;
                Shape::Roof(angle).distance([x, y], slope).max(ends)
            }
        }
    }
}

pub const SHAPES: [Shape; 7] = [
    Shape::Cone,
    Shape::Roof(0.0),
    Shape::Roof(90.0),
    Shape::Roof(30.0),
    Shape::Roof(45.0),
    Shape::Roof(63.0),
    Shape::Roof(-17.0),
];

/// A pile of yield share `s` on the plane chute of this tilt; wet on dry, or on a layer.
pub fn chute_pile(scheme: Scheme, tilt: [f64; 2], shape: Shape, s: f64, layer: bool) -> Result<Run, Failure> {
    let sheet = grid([48, 45], [-1.2, -1.125], 0.05, Boundary::Open);
    let ground = plane(tilt, 0.4);
    // An open end continues the layer, not the pile: on the incline roofs have ends.
    let shape = match shape {
        Shape::Roof(angle) if tilt != [0.0; 2] => Shape::Hip(angle),
        other => other,
    };
    let pile = move |x: [f64; 2]| {
        let away = shape.distance(x, [0.0; 2]);
        let fall = tilt[0] * x[0] + tilt[1] * x[1] - s * MU * ground.cos * away;
        let h = 0.2 + fall / ground.beta;
        Flow::still(if layer { h.max(0.07) } else { h.max(0.0) })
    };
    on_plane(Setting::coulomb(scheme, MU, FILM), sheet, ground, pile)
}

pub fn inclined([x, y]: [f64; 2], slope: [f64; 2]) -> Surface<2> {
    Surface { z: 700.0 + slope[0] * x + slope[1] * y, slope, bent: [[0.0; 2]; 2] }
}

/// A pile of yield share `s` on a tilted plane of terrain, its lengths measured along the bed.
pub fn terrain_pile(scheme: Scheme, slope: [f64; 2], shape: Shape, s: f64) -> Result<Run, Failure> {
    let sheet = grid([48, 45], [-120.0, -112.5], 5.0, Boundary::Absorbing);
    let grounds = terrain(&sheet, |x| Some(inclined(x, slope)));
    on_bed(Setting::coulomb(scheme, MU, FILM), sheet, &grounds, |x, ground| {
        let surface = 712.0 - s * MU * ground.cos * shape.distance(x, slope);
        Flow::still(((surface - inclined(x, slope).z) / ground.cos.powi(2)).max(0.0))
    })
}

/// Smooth random hills, slopes up to about 0.35.
pub fn hills(seed: u64) -> impl Fn([f64; 2]) -> Surface<2> {
    let mut dice = Dice(seed);
    let waves: Vec<[f64; 4]> = (0..5)
        .map(|_| {
            let (angle, length) = (dice.between(0.0, 6.3), dice.between(40.0, 160.0));
            let k = std::f64::consts::TAU / length;
            [0.07 / k, k * angle.cos(), k * angle.sin(), dice.between(0.0, 6.3)]
        })
        .collect();
    move |[x, y]| {
        let mut s = Surface { z: 900.0, slope: [0.0; 2], bent: [[0.0; 2]; 2] };
        for [a, kx, ky, phase] in &waves {
            let (sin, cos) = (kx * x + ky * y + phase).sin_cos();
            s.z += a * sin;
            for (i, ki) in [kx, ky].into_iter().enumerate() {
                s.slope[i] += a * ki * cos;
                for (j, kj) in [kx, ky].into_iter().enumerate() {
                    s.bent[i][j] -= a * ki * kj * sin;
                }
            }
        }
        s
    }
}

/// A pile of 0.9 times the yield slope where the bed lets it be steepest, on hills or in a bowl; `hole` cuts the data.
pub fn curved_pile(
    scheme: Scheme,
    bed: impl Fn([f64; 2]) -> Surface<2> + Sync,
    shape: Shape,
    hole: bool,
) -> Result<Run, Failure> {
    let sheet = grid([48, 45], [-120.0, -112.5], 5.0, Boundary::Absorbing);
    let outside = |[x, y]: [f64; 2]| hole && x - y > 20.0 + 7.0 * (0.2 * y).sin();
    let grounds = terrain(&sheet, |x| if outside(x) { None } else { Some(bed(x)) });
    let flattest = grounds.iter().map(|g| g.cos).filter(|c| *c > 0.0).fold(1.0, f64::min);
    let top = bed([0.0; 2]).z + 9.0;
    on_bed(Setting::coulomb(scheme, MU, FILM), sheet, &grounds, |x, ground| {
        let surface = top - 0.9 * MU * flattest * shape.distance(x, [0.0; 2]);
        let h = if ground.cos > 0.0 { (surface - bed(x).z) / ground.cos.powi(2) } else { 0.0 };
        Flow::still(h.max(0.0))
    })
}

/// A chute whose slope and curvature change: zeta(x) and beta(x), cos(x), eta kappa(x).
pub fn winding(grid: &Grid<1>) -> Vec<Chute<1, f64>> {
    (0..grid.count())
        .map(|i| {
            let [x] = grid.centre([i]);
            let zeta = 0.25 * (1.1 * x).cos() + 0.05;
            Chute {
                tilt: [zeta.sin()],
                beta: 0.4 * zeta.cos(),
                cos: zeta.cos(),
                curvature: 0.1 * 0.25 * 1.1 * (1.1 * x).sin(),
            }
        })
        .collect()
}
