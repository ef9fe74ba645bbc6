//! What should start starts, what flows comes to rest by itself. What should rest: `granflow verify G`.

use super::support::{
    GRAVITY, ORDERS, Surface, alone, depths, grid, ground, line, lost, on_plane, plane, run, states, steps,
    terrain,
};
use crate::oracle::published;
use granflow::savage_hutter::Flow;
use granflow::savage_hutter::ground::{Bed, Terrain};
use granflow::scheme::Boundary;
use granflow::simulation::StepSize;

const MU: f64 = 0.5;
const FILM: f64 = 1e-6;
/// A little more than friction holds.
const BEYOND: f64 = 1.0 + 1e-6;

fn inclined([x, y]: [f64; 2], slope: [f64; 2]) -> Surface<2> {
    Surface { z: 700.0 + slope[0] * x + slope[1] * y, slope, bent: [[0.0; 2]; 2] }
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
