//! Slabs and dams that stop, and a jump that stays a jump. Errors and orders: `granflow verify`.

use super::support::{
    GRAVITY, ORDERS, Order, Surface, alone, depths, grid, incline, line, on_plane, plane, run, states, steps,
    terrain,
};
use granflow::savage_hutter::Flow;
use granflow::savage_hutter::exact::{FlatDamBreak, SlidingSlab};
use granflow::savage_hutter::ground::Chute;
use granflow::scheme::Boundary;
use granflow::simulation::StepSize;

/// A two-stage step whose last stage stops is at rest at its end, within its last step before the exact time.
fn ends_early(order: Order, u: f64, exact: f64, lost_per_step: f64) -> bool {
    order.ends_early() && u == 0.0 && exact <= lost_per_step
}

/// Benchmark F on a chute: moves until the exact time, then not at all.
#[test]
fn a_slab_stops_at_the_exact_time_and_is_then_exactly_still() {
    let (zeta, delta) = (20.0_f64.to_radians(), 30.0_f64.to_radians());
    let exact = SlidingSlab::new(GRAVITY, zeta, delta, 5.0).expect("it stops");
    for order in ORDERS {
        for step in [0.01, 0.0173, 0.1] {
            if step > 0.05 && !order.takes_long_steps() {
                continue;
            }
            let domain = line(0.0, 10.0, 40, Boundary::Periodic);
            let mut run =
                on_plane(order, (delta.tan(), 0.0), StepSize::Fixed(step), domain, incline(zeta), |_| Flow {
                    h: 1.0,
                    q: [5.0],
                });
            let name = format!("{order:?}, dt = {step}");
            let lost_per_step = exact.velocity(0.0) - exact.velocity(step);
            alone(|| {
                while run.time() < 1.5 * exact.stopping_time() {
                    steps(&mut run, 1);
                    let u = states(&run)[7].q[0];
                    let right = exact.velocity(run.time());
                    assert!(
                        (u - right).abs() < 1e-12 || ends_early(order, u, right, lost_per_step),
                        "{name}: {u} at {}",
                        run.time()
                    );
                    if run.time() > exact.stopping_time() + 1e-12 {
                        assert!(u == 0.0 && run.speed() == 0.0, "{name}: {u} at {}", run.time());
                    }
                }
            });
            assert!(depths(&run).iter().all(|h| *h == 1.0), "{name}");
        }
        println!(
            "F slab, chute, {order:?}: exact to 1e-12, 0 from the first step after {:.4} s",
            exact.stopping_time()
        );
    }
}

/// Benchmark F on terrain: the middle of a long slab, untouched by its ends.
#[test]
fn a_slab_on_terrain_stops_at_the_exact_time() {
    let (steep, delta) = (20.0_f64.to_radians().tan(), 30.0_f64.to_radians());
    for order in ORDERS {
        for angle in [0.0, 35.0_f64] {
            let (sin, cos) = angle.to_radians().sin_cos();
            let sheet = grid([121, 121], [0.0; 2], 2.0, Boundary::Absorbing);
            // A slope that a grid keeps as it is.
            let fall = [-steep * cos, -steep * sin].map(|slope| f64::from(slope as f32));
            let tan = fall[0].hypot(fall[1]);
            let (zeta, down) = (tan.atan(), fall.map(|slope| -slope / tan));
            let exact = SlidingSlab::new(GRAVITY, zeta, delta, 5.0).expect("it stops");
            let grounds = terrain(&sheet, |[x, y]| {
                Some(Surface { z: 900.0 + fall[0] * x + fall[1] * y, slope: fall, bent: [[0.0; 2]; 2] })
            });
            let mut run =
                run(order, (delta.tan(), 1e-6), StepSize::Fixed(0.03), sheet, &grounds, |_, ground| {
                    let h = 1.0 / ground.cos;
                    Flow { h, q: down.map(|n| h * 5.0 * zeta.cos() * n) }
                });
            let lost_per_step = exact.velocity(0.0) - exact.velocity(0.03);
            alone(|| {
                while run.time() < 1.2 * exact.stopping_time() {
                    steps(&mut run, 1);
                    let v = run.diagnostics([60, 60]).speed_squared.sqrt();
                    let right = exact.velocity(run.time());
                    assert!(
                        (v - right).abs() < 1e-10 || ends_early(order, v, right, lost_per_step),
                        "{order:?} {angle}: {v} at {}",
                        run.time()
                    );
                    assert!(
                        run.time() <= exact.stopping_time() || v == 0.0,
                        "{order:?} {angle}: {v} at {}",
                        run.time()
                    );
                }
            });
        }
    }
}

#[test]
fn riemann_is_monotone_at_the_published_step() {
    let case = crate::oracle::published("riemann");
    for order in ORDERS {
        let domain = line(case.x_from, case.x_to, case.cells, Boundary::Open);
        let start = |[x]: [f64; 1]| Flow::still((case.initial)(x));
        let mut run =
            on_plane(order, (0.0, 0.0), StepSize::Fixed(case.dt), domain, plane([0.0], case.eps), start);
        alone(|| steps(&mut run, 5000));
        let h = depths(&run);
        let variation: f64 = h.windows(2).map(|w| (w[1] - w[0]).abs()).sum();
        println!("Riemann, {order:?}: total variation {variation:.5}");
        assert!(variation <= order.variation(), "{order:?}: {variation}");
        let off = (order.variation() - 0.502) / 2.0 + 1e-12;
        assert!(h.iter().all(|h| (0.5 - off..=1.0 + off).contains(h)), "{order:?}");
    }
}

/// Benchmark E: the flow on the flat stops by itself, its tip (a millionth of the dam) before the exact 2/mu.
#[test]
fn the_dam_break_on_the_flat_comes_to_rest_behind_its_exact_front() {
    for order in ORDERS {
        let exact = FlatDamBreak::new(0.5).expect("friction");
        let domain = line(-10.0, 6.0, 400, Boundary::Open);
        let ground = Chute { tilt: [0.0], beta: 1.0, cos: 1.0, curvature: 0.0 };
        let start = |[x]: [f64; 1]| Flow::still(if x < 0.0 { 1.0 } else { 0.0 });
        let mut run = on_plane(order, (0.5, 1e-9), order.courant(), domain, ground, start);
        alone(|| {
            while !run.at_rest() && run.time() < 50.0 {
                steps(&mut run, 1);
            }
        });
        let tip = depths(&run).iter().rposition(|h| *h > 1e-6).expect("mass");
        let front = domain.centre([tip])[0];
        println!("E dam on flat, {order:?}: at rest after {:.3}, front {front:.3} (exact 4)", run.time());
        assert!(run.at_rest(), "{order:?}");
        assert!(front < exact.front(4.0) + 2.0 * domain.size[0] && front > 3.0, "{order:?}: {front}");
    }
}
