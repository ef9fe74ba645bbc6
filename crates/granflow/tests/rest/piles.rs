//! Benchmark G: what should rest rests bit for bit, what should start starts, what flows comes to rest by itself.

use super::support::{
    GRAVITY, ORDERS, Order, Run, Surface, alone, depths, grid, ground, line, lost, on_plane, plane, run,
    states, steps, terrain,
};
use crate::oracle::published;
use granflow::kernels::Kernel;
use granflow::savage_hutter::Flow;
use granflow::savage_hutter::ground::{Bed, Chute, Terrain};
use granflow::scheme::Boundary;
use granflow::simulation::{Simulation, StepSize};

const MU: f64 = 0.5;
const FILM: f64 = 1e-6;
/// A little more than friction holds.
const BEYOND: f64 = 1.0 + 1e-6;

/// The shape of a pile around the origin, as a length: 1 along its steepest descent.
#[derive(Clone, Copy, Debug)]
enum Shape {
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

const SHAPES: [Shape; 7] = [
    Shape::Cone,
    Shape::Roof(0.0),
    Shape::Roof(90.0),
    Shape::Roof(30.0),
    Shape::Roof(45.0),
    Shape::Roof(63.0),
    Shape::Roof(-17.0),
];

/// Nothing changes in `count` steps, and the run knows that it is at rest.
fn rests<const D: usize, S: Kernel<D, State = Flow<D, f64>>>(
    name: &str,
    run: &mut Simulation<D, S>,
    count: usize,
    awake: bool,
) {
    let before = states(run);
    assert!(before.iter().filter(|s| s.h > 0.0).count() > 9, "{name}: a pile");
    alone(|| {
        for _ in 0..count {
            if awake {
                run.wake_all();
            }
            steps(run, 1);
        }
    });
    for (number, (now, then)) in states(run).iter().zip(&before).enumerate() {
        assert!(now == then, "{name}: {:?}: {then:?} became {now:?}", run.grid().index(number));
    }
    assert!(run.at_rest() && run.speed() == 0.0, "{name}: at rest");
}

/// Something moves in the first steps (and may come to rest again, a millionth lower).
fn starts<const D: usize, S: Kernel<D, State = Flow<D, f64>>>(name: &str, run: &mut Simulation<D, S>) {
    let moved = alone(|| {
        (0..3).any(|_| {
            steps(run, 1);
            run.totals().moving > 0 && run.speed() > 0.0
        })
    });
    assert!(moved, "{name} stays");
}

/// A pile of yield share `s` on the plane chute of this tilt; wet on dry, or on a layer.
fn chute_pile(order: Order, tilt: [f64; 2], shape: Shape, s: f64, layer: bool) -> Run<2, Chute<2, f64>> {
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
    on_plane(order, (MU, FILM), order.courant(), sheet, ground, pile)
}

#[test]
fn piles_on_planes_rest_at_the_yield_slope_and_start_beyond_it() {
    for order in ORDERS {
        for shape in SHAPES {
            for tilt in [[0.0, 0.0], [0.2, 0.0], [0.0, -0.25], [0.12, 0.18]] {
                for layer in [false, true] {
                    let name = format!("{order:?} {shape:?} on {tilt:?}, layer {layer}");
                    let s =
                        if matches!(shape, Shape::Cone) && tilt[0] * tilt[1] != 0.0 { 0.999 } else { 1.0 };
                    rests(&name, &mut chute_pile(order, tilt, shape, s, layer), 10_000, false);
                    if !layer && matches!(shape, Shape::Roof(_)) {
                        starts(&name, &mut chute_pile(order, tilt, shape, BEYOND, layer));
                    }
                }
            }
        }
        starts("cone on the flat", &mut chute_pile(order, [0.0; 2], Shape::Cone, order.cone_starts(), false));
    }
}

#[test]
fn rest_does_not_come_from_the_sleeping() {
    for order in ORDERS {
        for shape in [Shape::Cone, Shape::Roof(30.0)] {
            rests("chute", &mut chute_pile(order, [0.2, 0.0], shape, 1.0, false), 1000, true);
            rests("terrain", &mut terrain_pile(order, [0.3, -0.2], shape, 0.999), 1000, true);
        }
    }
}

fn inclined([x, y]: [f64; 2], slope: [f64; 2]) -> Surface<2> {
    Surface { z: 700.0 + slope[0] * x + slope[1] * y, slope, bent: [[0.0; 2]; 2] }
}

/// A pile of yield share `s` on a tilted plane of terrain, its lengths measured along the bed.
fn terrain_pile(order: Order, slope: [f64; 2], shape: Shape, s: f64) -> Run<2, Terrain<2, f64>> {
    let sheet = grid([48, 45], [-120.0, -112.5], 5.0, Boundary::Absorbing);
    let grounds = terrain(&sheet, |x| Some(inclined(x, slope)));
    run(order, (MU, FILM), order.courant(), sheet, &grounds, |x, ground| {
        let surface = 712.0 - s * MU * ground.cos * shape.distance(x, slope);
        Flow::still(((surface - inclined(x, slope).z) / ground.cos.powi(2)).max(0.0))
    })
}

#[test]
fn piles_on_terrain_planes_rest_at_the_yield_slope_and_start_beyond_it() {
    for order in ORDERS {
        for shape in SHAPES {
            for slope in [[0.0, 0.0], [-0.3_f32, 0.0], [0.0, 0.25], [0.3, -0.2]] {
                let slope = slope.map(f64::from);
                let name = format!("{order:?} {shape:?} on {slope:?}");
                let cone = matches!(shape, Shape::Cone);
                let s = if cone && slope[0] * slope[1] != 0.0 { 0.999 } else { 1.0 };
                rests(&name, &mut terrain_pile(order, slope, shape, s), 10_000, false);
                if !cone || slope == [0.0; 2] {
                    let beyond = if matches!(shape, Shape::Cone) { order.cone_starts() } else { BEYOND };
                    starts(&name, &mut terrain_pile(order, slope, shape, beyond));
                }
            }
        }
    }
}

/// Smooth random hills, slopes up to about 0.35.
fn hills(seed: u64) -> impl Fn([f64; 2]) -> Surface<2> {
    let mut dice = super::support::Dice(seed);
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
fn curved_pile(
    order: Order,
    bed: impl Fn([f64; 2]) -> Surface<2> + Sync,
    shape: Shape,
    hole: bool,
) -> Run<2, Terrain<2, f64>> {
    let sheet = grid([48, 45], [-120.0, -112.5], 5.0, Boundary::Absorbing);
    let outside = |[x, y]: [f64; 2]| hole && x - y > 20.0 + 7.0 * (0.2 * y).sin();
    let grounds = terrain(&sheet, |x| if outside(x) { None } else { Some(bed(x)) });
    let flattest = grounds.iter().map(|g| g.cos).filter(|c| *c > 0.0).fold(1.0, f64::min);
    let top = bed([0.0; 2]).z + 9.0;
    run(order, (MU, FILM), order.courant(), sheet, &grounds, |x, ground| {
        let surface = top - 0.9 * MU * flattest * shape.distance(x, [0.0; 2]);
        let h = if ground.cos > 0.0 { (surface - bed(x).z) / ground.cos.powi(2) } else { 0.0 };
        Flow::still(h.max(0.0))
    })
}

#[test]
fn piles_on_curved_beds_rest_with_nodata_beside_them() {
    for order in ORDERS {
        for shape in SHAPES {
            for hole in [false, true] {
                for seed in 1..=4 {
                    let name = format!("{order:?} {shape:?} on hills {seed}, hole {hole}");
                    rests(&name, &mut curved_pile(order, hills(seed), shape, hole), 10_000, false);
                }
                let bowl = |[x, y]: [f64; 2]| Surface {
                    z: 500.0 + 1e-3 * (x * x + y * y),
                    slope: [2e-3 * x, 2e-3 * y],
                    bent: [[2e-3, 0.0], [0.0, 2e-3]],
                };
                rests(
                    &format!("{order:?} {shape:?} in a bowl, hole {hole}"),
                    &mut curved_pile(order, bowl, shape, hole),
                    10_000,
                    false,
                );
                // A bed with a kink: a valley of two planes.
                let valley = |[x, y]: [f64; 2]| Surface {
                    z: 500.0 + 0.3 * x.abs() + 0.1 * y,
                    slope: [0.3 * x.signum(), 0.1],
                    bent: [[0.0; 2]; 2],
                };
                rests(
                    &format!("{order:?} {shape:?} in a valley, hole {hole}"),
                    &mut curved_pile(order, valley, shape, hole),
                    10_000,
                    false,
                );
            }
        }
    }
}

#[test]
fn a_slab_steeper_than_friction_starts_everywhere_also_at_the_edges_of_the_data() {
    for order in ORDERS {
        // Also in a step that is much too short.
        for (hole, step) in
            [(false, order.courant()), (true, order.courant()), (false, StepSize::Fixed(1e-9))]
        {
            let sheet = grid([20, 18], [0.0; 2], 5.0, Boundary::Absorbing);
            let slope = [-0.4, 0.45];
            let inside = |[x, y]: [f64; 2]| !(hole && x + y > 130.0);
            let grounds = terrain(&sheet, |x| inside(x).then(|| inclined(x, slope)));
            let mut run = run(order, (MU, FILM), step, sheet, &grounds, |x, _| {
                Flow::still(if inside(x) { 1.0 } else { 0.0 })
            });
            alone(|| steps(&mut run, 1));
            for number in 0..sheet.count() {
                let index = sheet.index(number);
                let moves = run.state(index).q != [0.0; 2];
                assert!(moves == inside(sheet.centre(index)), "{order:?}, hole {hole}: {index:?}");
            }
        }
    }
}

#[test]
fn a_lake_with_an_island_is_exactly_at_rest_without_friction() {
    for order in ORDERS {
        for seed in 1..=4 {
            for hole in [false, true] {
                let bed = hills(seed);
                let sheet = grid([60, 50], [-150.0, -125.0], 5.0, Boundary::Absorbing);
                let outside = |[x, y]: [f64; 2]| hole && (x - 60.0).hypot(y) < 20.0;
                let grounds = terrain(&sheet, |x| if outside(x) { None } else { Some(bed(x)) });
                let mut run = run(order, (0.0, FILM), order.courant(), sheet, &grounds, |x, ground| {
                    let h = if ground.cos > 0.0 { (901.0 - bed(x).z) / ground.cos.powi(2) } else { 0.0 };
                    Flow::still(h.max(0.0))
                });
                let dry = depths(&run).iter().filter(|h| **h == 0.0).count();
                assert!(dry > 100 && dry < 2900, "islands: {dry} dry cells");
                rests(&format!("{order:?} lake {seed}, hole {hole}"), &mut run, 10_000, false);
            }
        }
    }
}

/// A chute whose slope and curvature change: zeta(x) and beta(x), cos(x), eta kappa(x).
fn winding(grid: &granflow::grid::Grid<1>) -> Vec<Chute<1, f64>> {
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

#[test]
fn admissible_profiles_on_a_winding_chute_rest() {
    for order in ORDERS {
        for share in [-0.9, -0.4, 0.0, 0.5, 0.9] {
            for dry in [false, true] {
                let grid = line(-6.0, 6.0, 240, Boundary::Open);
                let grounds = winding(&grid);
                // (sqrt(beta) h)_x sqrt(beta) = sin(zeta) + share mu cos(zeta), by the trapezium rule.
                let force = |g: &Chute<1, f64>| (g.tilt[0] + share * MU * g.cos) / g.beta.sqrt();
                let mut level = vec![0.0; grounds.len()];
                for i in 1..grounds.len() {
                    level[i] =
                        level[i - 1] + 0.5 * (force(&grounds[i - 1]) + force(&grounds[i])) * grid.size[0];
                }
                let lowest = level.iter().copied().fold(f64::INFINITY, f64::min);
                let mean = level.iter().sum::<f64>() / level.len() as f64;
                let base = if dry { mean } else { lowest - 0.2 };
                let profile: Vec<f64> =
                    level.iter().zip(&grounds).map(|(y, g)| ((y - base) / g.beta.sqrt()).max(0.0)).collect();
                let mut run = run(order, (MU, FILM), order.courant(), grid, &grounds, |[x], _| {
                    Flow::still(profile[((x + 6.0) / grid.size[0]) as usize])
                });
                rests(&format!("{order:?}, share {share}, dry {dry}"), &mut run, 10_000, false);
            }
        }
    }
}

#[test]
fn towers_and_ridges_of_one_cell_fall() {
    for order in ORDERS {
        for ridge in [false, true] {
            let sheet = grid([31, 29], [0.0; 2], 0.1, Boundary::Open);
            let tower = |[x, y]: [f64; 2]| {
                let stands = (x - 1.55).abs() < 0.01 && (ridge || (y - 1.45).abs() < 0.01);
                Flow::still(if stands { 2.0 } else { 0.0 })
            };
            let mut run = on_plane(order, (MU, FILM), order.courant(), sheet, plane([0.0; 2], 0.4), tower);
            let before = run.totals().volume;
            alone(|| {
                for _ in 0..20_000 {
                    if run.at_rest() {
                        break;
                    }
                    steps(&mut run, 1);
                }
            });
            let top = depths(&run).into_iter().fold(0.0, f64::max);
            assert!(run.at_rest() && run.speed() == 0.0, "{order:?}, ridge {ridge}: step {}", run.step());
            assert!(top < 0.7, "{order:?}, ridge {ridge}: {top} left of 2");
            assert!(lost(&run, before).abs() < 1e-13);
        }
    }
}

#[test]
fn films_stay_and_take_what_comes() {
    for order in ORDERS {
        let line = line(0.0, 4.0, 40, Boundary::Open);
        let thin = 0.9 * FILM;
        let steep = plane([0.9], 0.4);
        let mut run = on_plane(order, (MU, FILM), order.courant(), line, steep, |_| Flow::still(thin));
        alone(|| {
            for _ in 0..100 {
                run.advance(run.time() + 0.01).expect("finite");
            }
        });
        assert!(run.at_rest() && depths(&run).iter().all(|h| *h == thin), "{order:?}");
        let film = run.totals().film;
        assert!((film - 4.0 * thin).abs() < 1e-20, "{film}");

        let pile = |[x]: [f64; 1]| Flow::still(if x < 1.0 { 0.5 } else { thin });
        let mut run = on_plane(order, (MU, FILM), order.courant(), line, steep, pile);
        let before = run.totals().volume;
        alone(|| steps(&mut run, 15));
        assert!(depths(&run)[11] > FILM, "{order:?}: the film is overrun");
        assert!(lost(&run, before).abs() < 1e-13);
    }
}

#[test]
fn the_published_piles_come_to_rest_by_themselves() {
    for order in ORDERS {
        for name in ["silo", "inclined_silo", "parabola"] {
            let case = published(name);
            let domain = line(case.x_from, case.x_to, case.cells, Boundary::Open);
            let ground = plane([case.zeta.sin()], case.eps * (1.0 + 2.0 * case.delta.tan().powi(2)));
            let start = |[x]: [f64; 1]| Flow::still((case.initial)(x));
            let mut run = on_plane(order, (case.delta.tan(), 0.0), order.courant(), domain, ground, start);
            let before = run.totals().volume;
            alone(|| {
                while !run.at_rest() && run.time() < 100.0 {
                    steps(&mut run, 1);
                }
            });
            let h = depths(&run);
            println!(
                "{order:?} {name}: at rest after {:.3}, {} steps, top {:.4}",
                run.time(),
                run.step(),
                h.iter().copied().fold(0.0, f64::max)
            );
            assert!(
                run.at_rest() && run.speed() == 0.0,
                "{order:?} {name}: {} at {}",
                run.speed(),
                run.time()
            );
            assert!(states(&run).iter().all(|s| s.q == [0.0]), "{order:?} {name}");
            assert!(lost(&run, before).abs() < 1e-13, "{order:?} {name}: {:e}", lost(&run, before));
            let floor = if name == "parabola" { 0.1 } else { 0.3 };
            assert!(h.iter().all(|h| *h >= floor - 1e-12), "{order:?} {name}: the floor stays");
            if case.zeta == 0.0 {
                let uneven = h.iter().zip(h.iter().rev()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(uneven < 1e-13, "{order:?} {name}: {uneven:e}");
            }
        }
    }
}

#[test]
fn the_static_bound_is_a_disc_in_the_metric() {
    // The pull on a uniform slab of slope theta is g sin(theta), whatever its direction.
    for angle in [0.0, 20.0, 45.0, 70.0, 90.0_f64] {
        let (sin, cos) = angle.to_radians().sin_cos();
        for (slope, held) in [(MU * (1.0 - 1e-9), true), (MU * BEYOND, false)] {
            let slope = [slope * cos, slope * sin];
            let ground = ground(inclined([0.5; 2], slope));
            let pull =
                ground.driving_force(slope.map(|s| -GRAVITY * s), slope.map(|s| GRAVITY * s), [1.0; 2]);
            let size = ground.square(pull).sqrt();
            let bound = MU * ground.weight_at_rest();
            assert_eq!(size <= bound, held, "{angle}: {size} against {bound}");
        }
    }
}

/// The pressure correction of a bent bed must not keep a cell from resting between held ones.
#[test]
fn a_release_in_a_bowl_comes_to_rest_by_itself() {
    for order in ORDERS {
        let sheet = grid([61, 61], [0.0; 2], 5.0, Boundary::Absorbing);
        let bowl = |[x, y]: [f64; 2]| {
            let (dx, dy) = (x - 220.0, y - 150.0);
            Some(Surface {
                z: 1000.0 + 0.004 * dx * dx + 0.002 * dy * dy,
                slope: [0.008 * dx, 0.004 * dy],
                bent: [[0.008, 0.0], [0.0, 0.004]],
            })
        };
        let grounds = terrain(&sheet, bowl);
        let start = |[x, y]: [f64; 2], _: &Terrain<2, f64>| {
            Flow::still(if (x - 80.0).hypot(y - 170.0) < 30.0 { 2.0 } else { 0.0 })
        };
        let mut run = run(order, (0.2, FILM), order.courant(), sheet, &grounds, start);
        let before = run.totals().volume;
        alone(|| {
            while !run.at_rest() && run.time() < 600.0 {
                run.advance(600.0).unwrap();
            }
        });
        let totals = run.totals();
        assert!(run.at_rest(), "{order:?}: {} cells at up to {:e}", totals.moving, totals.speed);
        assert_eq!(totals.speed, 0.0);
        assert!(lost(&run, before).abs() < 1e-12);
    }
}

/// Joined ends: where the pile lies does not matter, not even in a corner.
#[test]
fn a_pile_in_the_corner_of_a_periodic_plane_is_the_one_in_the_middle() {
    for order in ORDERS {
        let sheet = grid([20, 20], [0.0; 2], 0.1, Boundary::Periodic);
        let flow = |shift: usize| {
            let wrap = |x: f64| (x - 1.0 + 0.1 * shift as f64 + 1.0).rem_euclid(2.0) - 1.0;
            let pile = |[x, y]: [f64; 2]| Flow::still((0.8 - wrap(x).hypot(wrap(y))).max(0.0) + 0.1);
            let mut run = on_plane(order, (0.5, FILM), order.courant(), sheet, plane([0.3, 0.1], 0.4), pile);
            let before = run.totals().volume;
            alone(|| steps(&mut run, 150));
            assert!((run.totals().volume / before - 1.0).abs() < 1e-13, "{order:?} {shift}");
            assert_eq!(run.out(), [0.0; 5]);
            run
        };
        let (middle, corner) = (flow(0), flow(10));
        for number in 0..sheet.count() {
            let [i, j] = sheet.index(number);
            let there = [(i + 10) % 20, (j + 10) % 20];
            let (a, b) = (middle.state([i, j]), corner.state(there));
            assert!((a.h - b.h).abs() < 1e-12, "{order:?} {i} {j}: {} {}", a.h, b.h);
        }
    }
}
