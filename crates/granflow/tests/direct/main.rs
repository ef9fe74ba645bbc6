//! The equilibrium without time steps: the fixed point of the first-order scheme, near the exact one, symmetric.

mod exact;
mod setup;

use granflow::hadeler_kuttler::direct::{Equilibrium, Unsteady, equilibrium, surface};
use granflow::hadeler_kuttler::table::{Edge, Table};
use setup::{F, Setup, corner, disc, on_the_left, square, tables};

#[test]
fn one_step_leaves_it() {
    for n in [20, 21, 50, 75] {
        for setup in tables(n) {
            let [u, v] = setup.one_step();
            assert!(u < 1e-13 && v < 1e-13, "{} {n}: {u:e} {v:e}", setup.name);
        }
    }
}

#[test]
fn the_scheme_comes_to_it_from_an_empty_table() {
    for setup in [square(8), square(9), corner(8, on_the_left)] {
        let state = setup.solve();
        let nothing = |state: &Equilibrium<2>| Equilibrium {
            u: vec![0.0; state.u.len()],
            v: vec![0.0; state.v.len()],
            ..state.clone()
        };
        let mut run = setup.run(&nothing(&state));
        while run.time() < 300.0 {
            run.advance(300.0).unwrap();
        }
        let u = Setup::<2>::indices(setup.table.nodes())
            .map(|node| (run.state(node).u - state.u[setup.node(node)]).abs())
            .fold(0.0, f64::max);
        // On a level summit the scheme keeps what v it has: for an odd number of cells that of the cell in the middle.
        let summit =
            |c: &[usize; 2]| setup.name == "square" && c.iter().all(|k| 2 * k + 1 == setup.table.cells()[0]);
        let v = setup
            .inside()
            .filter(|c| !summit(c))
            .map(|c| (run.state(c).v - state.v[setup.cell(c)]).abs())
            .fold(0.0, f64::max);
        assert!(u < 1e-9 && v < 1e-9, "{}: {u:e} {v:e}", setup.name);
    }
}

#[test]
fn all_that_is_poured_falls_off() {
    for setup in tables(40) {
        let state = setup.solve();
        let out: f64 = state.outflow.iter().map(|(_, flux)| flux).sum();
        let poured = F * setup.table.area(setup.size);
        assert!((out / poured - 1.0).abs() < 1e-14, "{}: {:e}", setup.name, out / poured - 1.0);
        assert!(state.v.iter().all(|v| *v >= 0.0));
    }
}

/// The eight symmetries of the square, on points of \[0, n\]^2.
fn turned(way: usize, n: f64, [x, y]: [f64; 2]) -> [f64; 2] {
    let x = if way & 1 == 1 { n - x } else { x };
    let y = if way & 2 == 2 { n - y } else { y };
    if way & 4 == 4 { [y, x] } else { [x, y] }
}

#[test]
fn turned_and_mirrored_tables_give_the_same_bits() {
    let n = 31;
    let whole = n as f64;
    let back = |way: usize, [x, y]: [f64; 2]| {
        let [x, y] = if way & 4 == 4 { [y, x] } else { [x, y] };
        turned(way & 3, whole, [x, y])
    };
    let build = |way: usize, partial: bool| {
        let mask = move |cell: [usize; 2]| {
            let [x, y] = back(way, cell.map(|k| k as f64 + 0.5));
            !(x > 14.0 && y > 17.0) && (x - 8.0).hypot(y - 9.0) > 3.0
        };
        let wall = move |edge: &Edge<2>| back(way, edge.middle())[0] == 0.0;
        let size = if way & 4 == 4 { [0.05, 0.04] } else { [0.04, 0.05] };
        let mut setup = Setup::new("turned", Table::masked([n; 2], mask, wall), size);
        for node in Setup::<2>::indices([n + 1; 2]) {
            let [x, y] = back(way, node.map(|k| k as f64));
            setup.bed[node[1] * (n + 1) + node[0]] = 0.05 * (x * 0.2).sin() * (y * 0.13).cos();
        }
        for cell in Setup::<2>::indices([n; 2]) {
            let [x, y] = back(way, cell.map(|k| k as f64 + 0.5));
            let on = !partial || (x - 20.0).hypot(y - 9.0) < 5.0;
            setup.source[cell[1] * n + cell[0]] = if on { 1.0 + x / 64.0 } else { 0.0 };
        }
        setup
    };
    for partial in [false, true] {
        let first = build(0, partial);
        let state = first.solve();
        for way in 1..8 {
            let setup = build(way, partial);
            let other = setup.solve();
            let to = |point: [f64; 2]| turned(way, whole, point).map(|k| k as usize);
            for node in Setup::<2>::indices([n + 1; 2]) {
                let (a, b) = (first.node(node), setup.node(to(node.map(|k| k as f64))));
                assert_eq!(state.u[a], other.u[b], "u {way} {node:?}");
                assert_eq!(state.most[a], other.most[b], "most {way} {node:?}");
                assert_eq!(state.determined[a], other.determined[b], "determined {way} {node:?}");
            }
            for cell in Setup::<2>::indices([n; 2]) {
                let (a, b) = (first.cell(cell), setup.cell(to(cell.map(|k| k as f64 + 0.5))));
                assert_eq!(state.v[a], other.v[b], "v {way} {cell:?}");
            }
        }
    }
}

#[test]
fn without_a_way_out_there_is_no_equilibrium() {
    let closed = Setup::new("closed", Table::rectangle([6; 2], [[false; 2]; 2]), [0.1; 2]);
    let solve = |setup: &Setup<2>| equilibrium(&setup.table, setup.size, &setup.bed, &setup.source);
    let Err(why) = solve(&closed) else { panic!("an equilibrium") };
    assert_eq!(why, Unsteady::Enclosed { cell: [0, 0] });
    assert!(why.to_string().contains("open one"), "{why}");
    let nothing = Setup { source: vec![0.0; 36], ..closed };
    let state = solve(&nothing).unwrap();
    assert!(state.u.iter().chain(&state.v).all(|x| *x == 0.0) && state.most[20] == f64::INFINITY);

    let mut steep = square(10);
    for [i, j] in Setup::<2>::indices([11; 2]) {
        steep.bed[j * 11 + i] = 0.09 * i as f64 + 0.08 * j as f64;
    }
    let Err(Unsteady::Steep { slope, .. }) = solve(&steep) else { panic!("an equilibrium") };
    assert!((slope - 0.9_f64.hypot(0.8)).abs() < 1e-12);
}

#[test]
fn whatever_edges_are_open_all_leaves_or_it_is_said_why() {
    let closed = Table::masked([3, 2], |cell| cell != [0, 0], |_| true);
    let edges: Vec<Edge<2>> = closed.edges().map(|(edge, _)| edge).collect();
    let (mut found, mut trapped) = (0, 0);
    for open in 0..1 << edges.len() {
        let wall = |edge: &Edge<2>| {
            // Beside a cell that no sand stays on there are others, open ones.
            let number = edges.iter().position(|one| one.middle() == edge.middle());
            number.is_some_and(|number| open & (1 << number) == 0)
        };
        let setup = Setup::new("corner", Table::masked([3, 2], |cell| cell != [0, 0], wall), [0.1; 2]);
        match equilibrium(&setup.table, setup.size, &setup.bed, &setup.source) {
            Ok(state) => {
                let out: f64 = state.outflow.iter().map(|(_, flux)| flux).sum();
                let poured = F * setup.table.area(setup.size);
                assert!((out - poured).abs() <= 1e-12 * poured, "{open:b}: {out} of {poured}");
                found += 1;
            }
            Err(why @ Unsteady::Trapped { .. }) => {
                assert!(why.to_string().contains("one cell wide"), "{why}");
                trapped += 1;
            }
            Err(why) => assert!(open == 0 && matches!(why, Unsteady::Enclosed { .. }), "{open:b}: {why}"),
        }
    }
    assert!(
        found > trapped && trapped > 0,
        "{found} tables with an equilibrium, {trapped} with a level cell"
    );
}

#[test]
#[ignore = "prints the time that a million cells take"]
fn a_million_cells() {
    for setup in [square(1000), disc(1000), corner(1000, on_the_left)] {
        let start = std::time::Instant::now();
        let state = setup.solve();
        println!("{}: {:?}, {} crests", setup.name, start.elapsed(), state.crests.len());
        let start = std::time::Instant::now();
        surface(&setup.table, setup.size, &setup.bed);
        println!("of it the surface: {:?}", start.elapsed());
    }
}
