//! A dam that stops, and a jump that stays a jump. Errors and orders: `granflow verify`.

use super::support::{ORDERS, alone, depths, line, on_plane, plane, steps};
use granflow::savage_hutter::Flow;
use granflow::savage_hutter::exact::FlatDamBreak;
use granflow::savage_hutter::ground::Chute;
use granflow::scheme::Boundary;
use granflow::simulation::StepSize;

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
