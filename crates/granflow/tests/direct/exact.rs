//! Against exact equilibria and distances.

use crate::setup::{ALL, F, Setup, corner, disc, on_the_left, square, with_hole};
use granflow::hadeler_kuttler::direct::{Equilibrium, equilibrium_along, surface};
use granflow::hadeler_kuttler::table::Table;
use granflow::hadeler_kuttler::{Pile, exact};

/// A line of n cells on \[0, 1\] with the source f(x).
fn line(n: usize, right: bool, f: impl Fn(f64) -> f64) -> Setup<1> {
    let mut setup = Setup::new("line", Table::rectangle([n], [[true, right]]), [1.0 / n as f64]);
    for i in 0..n {
        setup.source[i] = f((i as f64 + 0.5) / n as f64);
    }
    setup
}

fn matches(setup: &Setup<1>, exact: impl Fn(f64) -> Pile<f64>) {
    let (state, h) = (setup.solve(), setup.size[0]);
    for (i, u) in state.u.iter().enumerate() {
        assert!((u - exact(i as f64 * h).u).abs() < 1e-14, "u {i}");
    }
    for (i, v) in state.v.iter().enumerate() {
        assert!((v - exact((i as f64 + 0.5) * h).v).abs() < 1e-14, "v {i}");
    }
}

#[test]
fn lines_are_exact() {
    for n in [60, 61] {
        let setup = line(n, true, |_| F);
        matches(&setup, |x| exact::open_line(1.0, x, |x| F * x));
        assert!(setup.one_step().iter().all(|change| *change < 1e-15));
    }
    let heap = |x: f64| if (x - 0.5).abs() < 0.25 { 1.0 } else { 0.2 };
    let poured = |x: f64| 0.2 * x + 0.8 * (x - 0.25).clamp(0.0, 0.5);
    matches(&line(60, true, heap), |x| exact::open_line(1.0, x, poured));
    let step = |x: f64| if x > 0.6 { 1.0 } else { 0.3 };
    matches(&line(60, false, step), |x| {
        exact::half_open_line(1.0, x, |x| 0.3 * x + 0.7 * (x - 0.6).max(0.0))
    });
}

#[test]
fn a_source_on_a_part_builds_the_least_pile_that_carries_it() {
    let setup = line(100, true, |x| if x > 0.2 && x < 0.3 { 1.0 } else { 0.0 });
    let state = setup.solve();
    for i in 0..=100 {
        let x = i as f64 / 100.0;
        let least = if x < 0.3 { x } else { (0.6 - x).max(0.0) };
        assert!((state.u[i] - least).abs() < 1e-14, "{i}: {} {least}", state.u[i]);
        assert!((state.most[i] - x.min(1.0 - x)).abs() < 1e-14);
        assert_eq!(state.determined[i], i <= 30);
    }

    let mut setup = square(60);
    for cell in Setup::<2>::indices([60; 2]) {
        let [x, y] = setup.centre(cell);
        let number = setup.cell(cell);
        setup.source[number] = if (x - 0.3).hypot(y - 0.55) < 0.1 { 1.0 } else { 0.0 };
    }
    let state = setup.solve();
    let supports: Vec<[usize; 2]> =
        Setup::<2>::indices([61; 2]).filter(|n| state.determined[setup.node(*n)]).collect();
    let mut sup = 0.0_f64;
    for node in Setup::<2>::indices([61; 2]) {
        let number = setup.node(node);
        let (u, most) = (state.u[number], state.most[number]);
        assert!(0.0 <= u && u <= most + 1e-15);
        if state.determined[number] {
            assert!((u - most).abs() < 1e-15);
        }
        let cone = |y: &[usize; 2]| {
            let far = [0, 1].map(|k| node[k].abs_diff(y[k]) as f64 / 60.0);
            state.u[setup.node(*y)] - far[0].hypot(far[1])
        };
        sup = sup.max((u - supports.iter().map(cone).fold(0.0, f64::max)).abs());
    }
    assert!(sup < 1.0 / 60.0);
}

/// Largest error of u, L1 error of u and v, and largest error of v.
fn errors(setup: &Setup<2>, state: &Equilibrium<2>, exact: impl Fn([f64; 2]) -> Pile<f64>) -> [f64; 4] {
    let mut e = [0.0_f64; 4];
    let cell = setup.size[0] * setup.size[1];
    for node in Setup::<2>::indices(setup.table.nodes()) {
        if setup.table.touches(node) {
            let at = [0, 1].map(|k| node[k] as f64 * setup.size[k]);
            let error = (state.u[setup.node(node)] - exact(at).u).abs();
            e[0] = e[0].max(error);
            e[1] += error * setup.table.weight(node) * cell;
        }
    }
    for index in setup.inside() {
        let error = (state.v[setup.cell(index)] - exact(setup.centre(index)).v).abs();
        e[2] += error * cell;
        e[3] = e[3].max(error);
    }
    e
}

/// The split of eqs. 48, 49: along the normal of the nearest side.
fn nearest_side(n: usize) -> Vec<[f64; 2]> {
    let split = |[i, j]: [usize; 2]| match i.min(n - 1 - i).cmp(&j.min(n - 1 - j)) {
        std::cmp::Ordering::Less => [F, 0.0],
        std::cmp::Ordering::Greater => [0.0, F],
        std::cmp::Ordering::Equal => [F / 2.0; 2],
    };
    Setup::<2>::indices([n; 2]).map(split).collect()
}

#[test]
fn squares_converge() {
    let flat = |x: [f64; 2]| exact::rectangle([1.0; 2], ALL, F, x).unwrap();
    let (mut marched, mut paper) = (Vec::new(), Vec::new());
    for n in [20, 40, 80] {
        let setup = square(n);
        marched.push(errors(&setup, &setup.solve(), flat));
        let state = equilibrium_along(&setup.table, setup.size, &setup.bed, &nearest_side(n)).unwrap();
        paper.push(errors(&setup, &state, flat));

        // Straight rays are exact.
        let open = [[true, false], [false; 2]];
        let straight = Setup::new("straight", Table::rectangle([n; 2], open), [1.0 / n as f64; 2]);
        let exact = |x: [f64; 2]| exact::rectangle([1.0; 2], open, F, x).unwrap();
        assert!(errors(&straight, &straight.solve(), exact).iter().all(|e| *e < 1e-13));
    }
    println!("marched {marched:?}, nearest side {paper:?}");
    for found in [&marched, &paper] {
        for pair in found.windows(2) {
            // Largest errors of first order at the ridges, where the exact solution has a kink; L1 of almost second.
            let rate = std::array::from_fn::<f64, 4, _>(|k| (pair[0][k] / pair[1][k]).log2());
            assert!(rate[0] > 0.95 && rate[1] > 1.85 && rate[2] > 1.8 && rate[3] > 0.95, "{rate:?}");
        }
    }
    for (marched, paper) in marched.iter().zip(&paper) {
        assert!(marched[2] < 1.25 * paper[2], "{marched:?} {paper:?}");
    }
}

#[test]
fn the_height_of_the_rim_makes_a_disc_round() {
    let round = |[x, y]: [f64; 2]| exact::disc(0.5, F, (x - 0.5).hypot(y - 0.5));
    let volume = F * std::f64::consts::PI * 0.5_f64.powi(3) / 3.0;
    let mut found = Vec::new();
    for n in [20, 40, 80, 160] {
        let stairs = disc(n);
        let mut rim = disc(n);
        for node in Setup::<2>::indices([n + 1; 2]) {
            let [x, y] = [0, 1].map(|k| node[k] as f64 * rim.size[k] - 0.5);
            if rim.table.touches(node) && rim.table.weight(node) == 0.0 {
                let number = rim.node(node);
                rim.bed[number] = 0.5 - x.hypot(y);
            }
        }
        found.push([errors(&stairs, &stairs.solve(), round), errors(&rim, &rim.solve(), round)]);
        assert!(rim.one_step().iter().all(|change| *change < 1e-13));
    }
    println!("{found:?}");
    for pair in found.windows(2) {
        // u is of first order on stairs too, the distance to them being within a cell of the distance to the circle.
        let rate = |way: usize, k: usize| (pair[0][way][k] / pair[1][way][k]).log2();
        assert!(rate(0, 1) > 0.6 && rate(1, 1) > 0.9 && rate(1, 2) > 0.15, "{found:?}");
        // v is not: the corners of the stairs gather the sand.
        assert!(pair[1][0][2] > 0.15 * volume && pair[1][1][2] < 0.025 * volume, "{found:?}");
    }
}

#[test]
fn the_distance_goes_round_corners_and_islands() {
    let mut sup = [[0.0_f64; 2]; 2];
    for (k, n) in [40, 80].into_iter().enumerate() {
        let setup = corner(n, |edge| edge.middle()[1] != n as f64);
        let s = surface(&setup.table, setup.size, &setup.bed);
        for node in Setup::<2>::indices([n + 1; 2]).filter(|node| setup.table.touches(*node)) {
            let [x, y] = [0, 1].map(|k| node[k] as f64 * setup.size[k]);
            let d = if x <= 0.5 { 1.0 - y } else { 0.5 + (x - 0.5).hypot(0.5 - y) };
            sup[k][0] = sup[k][0].max((s[setup.node(node)] - d).abs());
        }
        let setup = with_hole(n, on_the_left);
        let s = surface(&setup.table, setup.size, &setup.bed);
        for node in Setup::<2>::indices([n + 1; 2]).filter(|node| setup.table.touches(*node)) {
            let [x, y] = [0, 1].map(|k| node[k] as f64 * setup.size[k]);
            let round = (x - 0.6).hypot((0.6 - y).min(y - 0.4));
            let d = if x > 0.6 && y > 0.4 && y < 0.6 { 0.6 + round } else { x };
            sup[k][1] = sup[k][1].max((s[setup.node(node)] - d).abs());
        }
    }
    for (coarse, fine) in sup[0].iter().zip(sup[1]) {
        assert!(fine < 1.5 / 80.0 && coarse / fine > 1.5, "{coarse} {fine}");
    }
}
