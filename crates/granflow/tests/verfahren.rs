//! The five published schemes: against the independent oracle, against the numbers of the published examples, and
//! figure by figure.

mod oracle;
mod support;
#[path = "support/balanced.rs"]
mod tried;

use granflow::savage_hutter::Flow;
use granflow::savage_hutter::exact::Riemann;
use granflow::savage_hutter::friction::Coulomb;
use granflow::savage_hutter::kinetic::{
    Kinetic, VERFAHREN_1, VERFAHREN_2, VERFAHREN_3, VERFAHREN_4, VERFAHREN_5, Variant,
};
use granflow::scheme::Boundary;
use granflow::simulation::{Simulation, StepSize};
use oracle::{Case, published};
use support::{alone, asleep_and_awake, depths, grid, line, plane, states, steps};

const PUBLISHED: [Variant; 5] = [VERFAHREN_1, VERFAHREN_2, VERFAHREN_3, VERFAHREN_4, VERFAHREN_5];

/// The library's run of a published example.
fn library(verfahren: u8, case: &Case) -> Simulation<1, Kinetic> {
    let scheme = PUBLISHED[verfahren as usize - 1].with(Coulomb { mu: case.delta.tan() });
    let grid = line(case.x_from, case.x_to, case.cells, Boundary::Open);
    let ground = plane([case.zeta.sin()], case.eps * (1.0 + 2.0 * case.delta.tan().powi(2)));
    Simulation::new(
        scheme,
        grid,
        StepSize::Fixed(case.dt),
        |_| ground,
        |index| Flow::still((case.initial)(grid.centre(index)[0])),
    )
    .unwrap()
}

/// The library's run after some steps.
fn after(verfahren: u8, name: &str, count: usize) -> Simulation<1, Kinetic> {
    alone(|| {
        let mut run = library(verfahren, &published(name));
        steps(&mut run, count);
        run
    })
}

/// The largest value; NaN if any is, so that no comparison passes by leaving one out.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most, value| if value.is_nan() || most.is_nan() { f64::NAN } else { most.max(value) })
}

fn speed(run: &Simulation<1, Kinetic>) -> f64 {
    largest(states(run).iter().map(|s| (s.q[0] / s.h).abs()))
}

fn asymmetry(h: &[f64]) -> f64 {
    largest(h.iter().zip(h.iter().rev()).map(|(a, b)| (a - b).abs()))
}

fn variation(h: &[f64]) -> f64 {
    h.windows(2).map(|w| (w[1] - w[0]).abs()).sum()
}

/// Largest |beta h_x - sin zeta| over the static bound, by central differences.
fn yielding(run: &Simulation<1, Kinetic>, case: &Case) -> f64 {
    let h = depths(run);
    let bound = case.zeta.cos() * case.delta.tan();
    largest(h.windows(3).map(|w| (case.beta() * (w[2] - w[0]) / (2.0 * case.dx()) - case.zeta.sin()).abs()))
        / bound
}

fn centre_of_mass(run: &Simulation<1, Kinetic>, above: f64) -> f64 {
    let (mut moment, mut mass) = (0.0, 0.0);
    for (i, h) in depths(run).iter().enumerate() {
        moment += (h - above) * run.grid().centre([i])[0];
        mass += h - above;
    }
    moment / mass
}

/// (verfahren, example, steps, largest difference allowed in h and q): exact agreement where rounding is not
/// amplified, the growth of a last-place difference elsewhere.
const AGAINST_THE_ORACLE: &[(&[u8], &str, usize, f64)] = &[
    (&[3, 4, 5], "silo", 10_000, 1e-9),
    (&[3, 4, 5], "inclined_silo", 8000, 1e-9),
    (&[3, 4, 5], "parabola", 6000, 1e-9),
    (&[1, 2, 3, 4], "riemann", 5000, 1e-9),
    (&[1], "sine", 4000, 1e-9),
    (&[5], "riemann", 5000, 1e-7),
    (&[1, 2], "silo", 10_000, 5e-3),
    (&[1, 2], "inclined_silo", 8000, 5e-3),
    (&[1, 2], "parabola", 6000, 5e-3),
    (&[4], "sine", 1000, 5e-3),
    (&[5], "sine", 4000, 5e-3),
    (&[1, 2, 3, 4, 5], "constant", 2000, 1e-9),
    (&[1, 2, 3, 4, 5], "constant_inclined", 2000, 1e-9),
];

#[test]
fn every_scheme_is_the_printed_one() {
    let mut worse = String::new();
    for &(which, name, count, bound) in AGAINST_THE_ORACLE {
        for &verfahren in which {
            let ours = states(&after(verfahren, name, count));
            let (h, q) = oracle::run(verfahren, &published(name), count);
            let apart = largest(
                ours.iter().zip(h.iter().zip(&q)).map(|(s, (h, q))| (s.h - h).abs().max((s.q[0] - q).abs())),
            );
            println!("Verfahren {verfahren} {name:18} {count:6} steps: {apart:.1e} (allowed {bound:.0e})");
            if apart.is_nan() || apart > bound {
                worse += &format!("Verfahren {verfahren} {name}: {apart:e} > {bound:e}\n");
            }
        }
    }
    assert!(worse.is_empty(), "{worse}");
}

#[test]
fn riemann_has_the_published_error_and_variation() {
    let case = published("riemann");
    let exact = Riemann::stoker(case.beta(), 1.0, 0.5).expect("two wet sides");
    let middle = exact.middle().expect("a wet middle");
    assert!((middle.h - 0.7269204461872865).abs() < 1e-14, "{middle:?}");
    assert!((middle.u - 0.18645257441665675).abs() < 1e-14, "{middle:?}");
    for (verfahren, l1, total) in [
        (1, 0.0901453, 0.5008),
        (2, 0.0739002, 1.0276),
        (3, 0.0739002, 1.0276),
        (4, 0.0739002, 1.0276),
        (5, 0.0901276, 0.5008),
    ] {
        let h = depths(&after(verfahren, "riemann", 5000));
        let error: f64 =
            case.centres().iter().zip(&h).map(|(&x, h)| (h - exact.flow(x, 5.0).h).abs() * case.dx()).sum();
        assert!((error - l1).abs() <= 0.5e-7, "Verfahren {verfahren}: L1(h) = {error}");
        assert!((variation(&h) - total).abs() <= 0.5e-4, "Verfahren {verfahren}: {}", variation(&h));
    }
}

#[test]
fn mean_depth_loses_positivity_on_the_sine() {
    for (verfahren, expected) in [(1, None), (2, Some(1570)), (3, Some(1570)), (4, Some(1567)), (5, None)] {
        let first = alone(|| {
            let mut run = library(verfahren, &published("sine"));
            let mut lowest = f64::INFINITY;
            for n in 1..=4000 {
                steps(&mut run, 1);
                lowest = depths(&run).iter().copied().fold(lowest, f64::min);
                if lowest < 0.0 {
                    return Some(n);
                }
            }
            assert!(lowest >= 0.1 - 1e-6, "Verfahren {verfahren}: h falls to {lowest}");
            None
        });
        assert_eq!(first, expected, "Verfahren {verfahren}");
    }
}

#[test]
fn after_its_negative_depth_the_run_ends_with_the_place() {
    let failure = alone(|| {
        let mut run = library(4, &published("sine"));
        (0..4000).find_map(|_| run.advance(f64::INFINITY).err())
    });
    let text = failure.expect("Verfahren 4 fails on the sine").to_string();
    assert!(text.contains("not finite after step") && text.contains("verfahren_1"), "{text}");
}

#[test]
fn verfahren_5_gains_mass_the_others_keep_it() {
    for (verfahren, expected, within) in
        [(1, 0.0, 1e-4), (2, 0.0, 1e-4), (3, 0.0, 1e-4), (4, 0.0, 1e-13), (5, 3.67e-3, 0.5e-5)]
    {
        let before = library(verfahren, &published("silo")).totals().volume;
        let gained = after(verfahren, "silo", 10_000).totals().volume / before - 1.0;
        assert!((gained - expected).abs() <= within, "Verfahren {verfahren}: {gained}");
    }
}

#[test]
fn a_tile_that_sleeps_holds_what_a_step_would_write() {
    let sheet = grid([90, 60], [0.0; 2], 0.1, Boundary::Open);
    let build = || {
        // Where there is no mass a velocity leaves the sign of its momentum.
        let start = |[i, j]: [usize; 2]| match i < 12 && j < 9 {
            true => Flow { h: 1.0, q: [0.3, -0.2] },
            false => Flow { h: 0.0, q: [-0.0, 0.0] },
        };
        // The others do not go on beside a cell without mass.
        let scheme = VERFAHREN_1.with(Coulomb { mu: 0.1 });
        Simulation::new(scheme, sheet, StepSize::Fixed(2e-4), |_| plane([0.5, -0.1], 0.9), start).unwrap()
    };
    let [asleep, awake] = asleep_and_awake("verfahren_1", build, 31);
    assert!(asleep.updates() < awake.updates(), "nothing slept");
}

#[test]
fn report_figure_1_riemann_by_scheme_3() {
    let case = published("riemann");
    let exact = Riemann::stoker(case.beta(), 1.0, 0.5).expect("two wet sides");
    let h = depths(&after(5, "riemann", 5000));
    assert!((variation(&h) - 0.5008).abs() < 0.5e-4);
    for (x, h) in case.centres().iter().zip(&h) {
        // Away from the corners of the fan and from the shock, dots and line cannot be told apart.
        let smooth = [-5.0 * case.beta().sqrt(), -1.76, 2.986].iter().all(|corner| (x - corner).abs() > 0.6);
        let apart = (h - exact.flow(*x, 5.0).h).abs();
        assert!(!smooth || apart < 0.02, "x = {x}: {apart}");
    }
}

#[test]
fn report_figure_2_silo_at_three_times() {
    let case = published("silo");
    let (start, middle, end) = (after(5, "silo", 0), after(5, "silo", 1100), after(5, "silo", 10_000));
    let peak = |run: &Simulation<1, Kinetic>| largest(depths(run).into_iter());
    let foot = |run: &Simulation<1, Kinetic>| depths(run).iter().filter(|h| **h > 0.301).count();
    assert!(peak(&start) == 2.3 && peak(&middle) < 2.25 && peak(&end) < 1.4);
    assert!(foot(&start) == 40 && foot(&middle) > 80 && foot(&end) > foot(&middle));
    assert!(speed(&middle) > 0.1 && speed(&end) < 1e-15);
    assert!(yielding(&end, &case) <= 1.0 + 1e-9, "{}", yielding(&end, &case));
}

#[test]
fn report_figure_3_silo_in_time() {
    let mut run = library(5, &published("silo"));
    let mut last = 2.3;
    alone(|| {
        for _ in 0..100 {
            steps(&mut run, 100);
            let h = depths(&run);
            assert!(asymmetry(&h) < 1e-14, "step {}: {}", run.step(), asymmetry(&h));
            assert!(h[120] <= last + 0.01, "the middle falls: {} after {last}", h[120]);
            last = h[120];
        }
    });
    assert!(speed(&run) < 1e-15);
}

/// The silo on the incline: runs to the right, stops, ends admissible.
fn inclined_silo() -> [Simulation<1, Kinetic>; 3] {
    [0, 2000, 8000].map(|count| after(5, "inclined_silo", count))
}

#[test]
fn report_figure_4_inclined_silo_runs_right_and_stops() {
    let [start, middle, end] = inclined_silo();
    assert!(centre_of_mass(&start, 0.3).abs() < 1e-12);
    assert!(centre_of_mass(&middle, 0.3) > 0.2);
    assert!(centre_of_mass(&end, 0.3) >= centre_of_mass(&middle, 0.3));
    assert!(speed(&end) < 1e-14, "{}", speed(&end));
}

#[test]
fn report_figure_5_parabola_spreads_and_stops() {
    let (start, end) = (after(5, "parabola", 0), after(5, "parabola", 6000));
    let (before, h) = (depths(&start), depths(&end));
    assert!(asymmetry(&h) < 1e-14);
    assert!(h[40] < 0.7 * before[40], "{}", h[40]);
    assert!(h[25] > before[25]);
    assert!(speed(&end) < 1e-14, "{}", speed(&end));
    assert!(yielding(&end, &published("parabola")) <= 1.0 + 1e-9);
}

/// Places where the depth is larger than at both neighbours and well above the layer.
fn hills(run: &Simulation<1, Kinetic>) -> usize {
    depths(run).windows(3).filter(|w| w[1] > w[0] && w[1] >= w[2] && w[1] > 0.13).count()
}

#[test]
fn report_figure_6_sine_splits_and_accelerates() {
    let case = published("sine");
    let g = case.zeta.sin() - case.zeta.cos() * case.delta.tan();
    let (start, end) = (after(5, "sine", 0), after(5, "sine", 4000));
    assert_eq!(hills(&start), 1);
    assert_eq!(hills(&end), 2);
    let pace = |run: &Simulation<1, Kinetic>| {
        let all = states(run);
        all.iter().map(|s| s.q[0]).sum::<f64>() / all.iter().map(|s| s.h).sum::<f64>()
    };
    for count in [1000, 2000, 3000] {
        let run = after(5, "sine", count);
        let ratio = pace(&run) / (g * run.time());
        assert!((ratio - 1.0).abs() < 0.1, "step {count}: mean speed over g t = {ratio}");
    }
}

#[test]
fn thesis_figure_5_1_constant_states_stay() {
    for name in ["constant", "constant_inclined"] {
        for verfahren in 1..=5 {
            let run = after(verfahren, name, 2000);
            assert!(depths(&run).iter().all(|h| (h - 1.0).abs() <= 1e-15), "{name}, Verfahren {verfahren}");
            assert!(speed(&run) <= 1e-15, "{name}, Verfahren {verfahren}: {}", speed(&run));
        }
    }
}

#[test]
fn thesis_figure_5_2_riemann_fan_and_shock_in_time() {
    let case = published("riemann");
    for count in [1000, 3000, 5000] {
        let h = depths(&after(5, "riemann", count));
        let t = count as f64 * case.dt;
        let crossing = |level: f64| {
            let i =
                h.windows(2).position(|w| w[0] >= level && w[1] < level).expect("falls through the level");
            case.centres()[i] + case.dx() * (h[i] - level) / (h[i] - h[i + 1])
        };
        let middle = 0.7269204461872865;
        assert!((crossing((middle + 0.5) / 2.0) - 0.5972850435692381 * t).abs() < 1.5 * case.dx());
        // In the fan h = (2 sqrt(beta) - x/t)^2/(9 beta).
        let root = case.beta().sqrt();
        assert!((crossing(0.86) - t * root * (2.0 - 3.0 * 0.86_f64.sqrt())).abs() < 1.5 * case.dx());
    }
}

#[test]
fn thesis_figure_5_3_riemann_by_verfahren_5() {
    let h = depths(&after(5, "riemann", 5000));
    assert!(h.windows(2).all(|w| w[1] <= w[0] + 1e-3), "no oscillation");
    assert!(h.iter().all(|h| (0.5 - 1e-12..=1.0 + 1e-12).contains(h)));
}

#[test]
fn thesis_figure_5_4_riemann_by_verfahren_4_oscillates() {
    let h = depths(&after(4, "riemann", 5000));
    assert!((variation(&h) - 1.0276).abs() <= 0.5e-4, "{}", variation(&h));
    assert!(h.iter().any(|h| *h > 1.001) || h.windows(2).filter(|w| w[1] > w[0] + 1e-3).count() > 5);
}

#[test]
fn thesis_figure_5_5_silo_height_and_velocity() {
    for verfahren in [4, 5] {
        let middle = after(verfahren, "silo", 1000);
        let u: Vec<f64> = states(&middle).iter().map(|s| s.q[0] / s.h).collect();
        assert!(u[..120].iter().all(|u| *u < 1e-12) && u[120..].iter().all(|u| *u > -1e-12), "apart");
        let end = after(verfahren, "silo", 10_000);
        assert!(speed(&end) < 1e-15, "Verfahren {verfahren}: {}", speed(&end));
        assert!(asymmetry(&depths(&end)) < 1e-14);
    }
}

#[test]
fn thesis_figure_5_6_silo_in_space_and_time() {
    let mut run = library(5, &published("silo"));
    let fastest: Vec<f64> = alone(|| {
        (0..10)
            .map(|_| {
                steps(&mut run, 1000);
                speed(&run)
            })
            .collect()
    });
    assert!(fastest[0] > 0.1 && fastest[9] < 1e-15, "{fastest:?}");
    assert!(fastest.windows(2).all(|w| w[1] <= w[0]), "slows down all the way: {fastest:?}");
}

#[test]
fn thesis_figure_5_7_silo_final_profile() {
    let case = published("silo");
    let end = after(5, "silo", 10_000);
    let h = depths(&end);
    assert!(h[..120].windows(2).all(|w| w[0] <= w[1] + 1e-12), "rises to the middle");
    assert!(yielding(&end, &case) <= 1.0 + 1e-9 && yielding(&end, &case) > 0.9);
    assert!((h[0] - 0.3).abs() < 1e-12 && h[120] > 1.0);
}

#[test]
fn thesis_figure_5_8_inclined_silo_height_and_velocity() {
    let [_, middle, end] = inclined_silo();
    let u: Vec<f64> = states(&middle).iter().map(|s| s.q[0] / s.h).collect();
    let (right, left) = (largest(u.iter().copied()), largest(u.iter().map(|u| -u)));
    assert!(right > 0.3 && left < 1e-6, "to the right {right}, to the left {left}");
    assert!(speed(&end) < 1e-14);
}

#[test]
fn thesis_figure_5_9_inclined_silo_in_space_and_time() {
    let mut run = library(5, &published("inclined_silo"));
    alone(|| {
        let mut last = centre_of_mass(&run, 0.3);
        for _ in 0..16 {
            steps(&mut run, 500);
            let now = centre_of_mass(&run, 0.3);
            assert!(now >= last - 1e-3, "the mass only moves down the slope: {now} after {last}");
            last = now;
        }
    });
    assert!(yielding(&run, &published("inclined_silo")) <= 1.0 + 1e-9);
}

#[test]
fn thesis_figure_5_10_parabola_height_and_velocity() {
    for verfahren in [4, 5] {
        let end = after(verfahren, "parabola", 6000);
        assert!(speed(&end) < 1e-14, "Verfahren {verfahren}: {}", speed(&end));
        assert!(asymmetry(&depths(&end)) < 1e-14);
    }
}

#[test]
fn thesis_figure_5_11_parabola_in_space_and_time() {
    let mut run = library(5, &published("parabola"));
    alone(|| {
        let mut last = 1.0;
        for _ in 0..60 {
            steps(&mut run, 100);
            let peak = largest(depths(&run).into_iter());
            assert!(peak <= last + 1e-3, "the top sinks: {peak} after {last}");
            last = peak;
        }
    });
}

#[test]
fn thesis_figure_5_12_sine_splits_and_accelerates_evenly() {
    let counts = [1000, 2000, 3000, 4000];
    let fastest = counts.map(|count| speed(&after(5, "sine", count)));
    let gains: Vec<f64> = fastest.windows(2).map(|w| w[1] - w[0]).collect();
    let g = 0.5 - (3.0_f64.sqrt() / 2.0) * (std::f64::consts::PI / 18.0).tan();
    for gain in gains {
        assert!((gain / g - 1.0).abs() < 0.25, "speeds {fastest:?}, g = {g}");
    }
}
