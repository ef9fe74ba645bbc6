//! What Aggarwal, Veerappa Gowda & Sudarshan Kumar (2023) find on the interval; `granflow reproduce sandpiles` has their
//! tables whole.

use granflow::hadeler_kuttler::exact;
use granflow::hadeler_kuttler::scheme::{ADAPTIVE, FIRST_ORDER, HadelerKuttler, SECOND_ORDER, Slopes};
use granflow::hadeler_kuttler::table::Table;
use granflow::models::hadeler_kuttler::run::site::Site;
use granflow::simulation::{Simulation, StepSize};

const F: f64 = 0.5;
const LAMBDA: f64 = 0.45;

/// u at the nodes and v in the cells of the equilibrium on [0, 1], open at both ends.
fn steady(n: usize) -> (Vec<f64>, Vec<f64>) {
    let at = |i: f64| exact::open_line(1.0, i / n as f64, |x| F * x);
    ((0..=n).map(|i| at(i as f64).u).collect(), (0..n).map(|i| at(i as f64 + 0.5).v).collect())
}

fn run(scheme: HadelerKuttler, (u, v): (&[f64], &[f64])) -> Simulation<1, HadelerKuttler> {
    let n = v.len();
    let h = 1.0 / n as f64;
    let site = Site::level(Table::rectangle([n], [[true; 2]]), [h]);
    site.simulation(scheme, StepSize::Fixed(LAMBDA * h), &vec![F; n], (u, v)).unwrap()
}

/// sup |u - ū| and the L1 norm of v - v̄.
fn errors(run: &Simulation<1, HadelerKuttler>, (u, v): &(Vec<f64>, Vec<f64>)) -> [f64; 2] {
    let sup = u.iter().enumerate().fold(0.0_f64, |sup, (i, u)| sup.max((run.state([i]).u - u).abs()));
    let sum: f64 = v.iter().enumerate().map(|(i, v)| (run.state([i]).v - v).abs()).sum();
    [sup, sum / v.len() as f64]
}

/// Table 2: first order and the adaptive scheme keep the steady state, second order moves v by f h² (2 λ - λ²).
#[test]
fn one_step_from_the_steady_state() {
    for n in [50, 100, 200, 400] {
        let kick = F / (n * n) as f64 * (2.0 * LAMBDA - LAMBDA * LAMBDA);
        for (scheme, moved) in [(FIRST_ORDER, 0.0), (SECOND_ORDER, kick), (ADAPTIVE, 0.0)] {
            let steady = steady(n);
            let mut run = run(scheme, (&steady.0, &steady.1));
            run.advance(f64::INFINITY).unwrap();
            let [u, v] = errors(&run, &steady);
            assert!(u <= 1e-14 && (v - moved).abs() <= 1e-14, "{scheme:?}, {n} cells: {u:e}, {v:e}");
        }
    }
}

/// Example 4 with 50 cells: with the exponent of Θ from 2 to 2.5 the adaptive scheme needs fewer steps than first order for
/// u and for v, and its error of v never rises again.
#[test]
fn the_adaptive_scheme_needs_fewer_steps_than_first_order() {
    const N: usize = 50;
    let steady = steady(N);
    // Steps to sup |u - ū| < 1e-3, and to an error of v below 1e-4 and 1e-5 for good.
    let steps = |scheme| {
        let mut run = run(scheme, (&vec![0.0; N + 1], &vec![0.0; N]));
        let (mut first_u, mut above, mut least) = (None, [0; 2], f64::INFINITY);
        let mut last = f64::INFINITY;
        while last > 1e-7 {
            run.advance(40.0).unwrap();
            let [u, v] = errors(&run, &steady);
            if u < 1e-3 {
                first_u = first_u.or(Some(run.step()));
            }
            for (above, bound) in above.iter_mut().zip([1e-4, 1e-5]) {
                if v >= bound {
                    *above = run.step();
                }
            }
            if v < 1e-3 {
                assert!(v <= least * (1.0 + 1e-9), "{scheme:?}: v is off by {v:e} after {least:e}");
                least = least.min(v);
            }
            last = v;
        }
        [first_u.expect("u comes near"), above[0], above[1]]
    };
    let mut before = steps(FIRST_ORDER);
    for exponent in [2.0, 2.25, 2.5] {
        let now = steps(HadelerKuttler { slopes: Slopes::Adaptive { exponent } });
        assert!(
            now.iter().zip(before).all(|(now, before)| *now < before),
            "m = {exponent}: {now:?}, {before:?}"
        );
        before = now;
    }
}
