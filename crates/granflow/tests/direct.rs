//! The equilibrium without time steps: the fixed point of the first-order scheme, near the exact one, symmetric.

use granflow::hadeler_kuttler::Pile;
use granflow::hadeler_kuttler::direct::{
    Equilibrium, Unsteady, equilibrium, equilibrium_along, rays, surface,
};
use granflow::hadeler_kuttler::exact;
use granflow::hadeler_kuttler::scheme::FIRST_ORDER;
use granflow::hadeler_kuttler::table::{Edge, Table};
use granflow::scheme::Side;
use granflow::simulation::{Simulation, StepSize};
use granflow::time::EULER;

const F: f64 = 0.5;
const ALL: [[bool; 2]; 2] = [[true; 2]; 2];

/// A table with a source on each cell, cells of size 1/n along each axis unless said otherwise.
struct Setup<const D: usize> {
    name: &'static str,
    table: Table<D>,
    size: [f64; D],
    bed: Vec<f64>,
    source: Vec<f64>,
}

impl<const D: usize> Setup<D> {
    fn new(name: &'static str, table: Table<D>, size: [f64; D]) -> Self {
        let nodes: usize = table.nodes().iter().product();
        let cells: usize = table.cells().iter().product();
        Setup { name, table, size, bed: vec![0.0; nodes], source: vec![F; cells] }
    }
    fn solve(&self) -> Equilibrium<D> {
        equilibrium(&self.table, self.size, &self.bed, &self.source)
            .unwrap_or_else(|why| panic!("{}: {why}", self.name))
    }
    fn cell(&self, index: [usize; D]) -> usize {
        (0..D).rev().fold(0, |n, k| n * self.table.cells()[k] + index[k])
    }
    fn node(&self, index: [usize; D]) -> usize {
        (0..D).rev().fold(0, |n, k| n * self.table.nodes()[k] + index[k])
    }
    fn indices(counts: [usize; D]) -> impl Iterator<Item = [usize; D]> {
        (0..counts.iter().product()).map(move |mut n: usize| {
            std::array::from_fn(|k| {
                let i = n % counts[k];
                n /= counts[k];
                i
            })
        })
    }
    fn inside(&self) -> impl Iterator<Item = [usize; D]> {
        Self::indices(self.table.cells()).filter(|index| self.table.inside(*index))
    }
    fn centre(&self, index: [usize; D]) -> [f64; D] {
        std::array::from_fn(|k| (index[k] as f64 + 0.5) * self.size[k])
    }
    fn run(
        &self,
        state: &Equilibrium<D>,
    ) -> Simulation<D, granflow::hadeler_kuttler::scheme::HadelerKuttler> {
        let shares = rays(&self.table, self.size, &surface(&self.table, self.size, &self.bed));
        let cells = self.table.cells();
        let within = |index: [usize; D]| (0..D).all(|k| index[k] < cells[k]);
        let ground = |index: [usize; D]| {
            let source = if within(index) {
                let c = self.cell(index);
                shares[c].map(|share| self.source[c] * share)
            } else {
                [0.0; D]
            };
            self.table.ground(index, source, self.bed[self.node(index)])
        };
        let pile = |index: [usize; D]| Pile {
            u: state.u[self.node(index)],
            v: if within(index) { state.v[self.cell(index)] } else { 0.0 },
        };
        let step = StepSize::Courant(0.45);
        Simulation::new(FIRST_ORDER, self.table.grid([0.0; D], self.size), EULER, step, ground, pile)
    }
    /// Largest change of u and of v in one step.
    fn one_step(&self) -> [f64; 2] {
        let state = self.solve();
        let mut run = self.run(&state);
        run.advance(f64::INFINITY).unwrap();
        let mut most = [0.0_f64; 2];
        for index in Self::indices(self.table.nodes()) {
            most[0] = most[0].max((run.state(index).u - state.u[self.node(index)]).abs());
        }
        let beside = |a: [usize; D], b: [usize; D]| (0..D).map(|k| a[k].abs_diff(b[k])).sum::<usize>() < 2;
        for index in self.inside() {
            if state.crests.iter().any(|crest| beside(*crest, index)) {
                continue;
            }
            most[1] = most[1].max((run.state(index).v - state.v[self.cell(index)]).abs());
        }
        most
    }
}

fn square(n: usize) -> Setup<2> {
    Setup::new("square", Table::rectangle([n; 2], ALL), [1.0 / n as f64; 2])
}

fn disc(n: usize) -> Setup<2> {
    let far = |[i, j]: [usize; 2]| {
        let at = |k: usize| (2 * k + 1) as f64 - n as f64;
        at(i).hypot(at(j)) < n as f64
    };
    Setup::new("disc", Table::masked([n; 2], far, |_| false), [1.0 / n as f64; 2])
}

/// An L, its notch upper right, a wall on the left.
fn corner(n: usize, wall: impl Fn(&Edge<2>) -> bool) -> Setup<2> {
    let table = Table::masked([n; 2], |[i, j]| 2 * i < n || 2 * j < n, wall);
    Setup::new("L", table, [1.0 / n as f64; 2])
}

fn with_hole(n: usize, open: impl Fn(&Edge<2>) -> bool) -> Setup<2> {
    let hole = |k: usize| 5 * k >= 2 * n && 5 * k < 3 * n;
    let table = Table::masked([n; 2], |[i, j]| !(hole(i) && hole(j)), |edge| !open(edge));
    Setup::new("hole", table, [1.0 / n as f64; 2])
}

fn on_the_left(edge: &Edge<2>) -> bool {
    edge.axis == 0 && edge.faces == Side::Left && edge.index[0] == 0
}

fn tables(n: usize) -> Vec<Setup<2>> {
    let size = [1.0 / n as f64; 2];
    let mut bent = square(n);
    bent.name = "a table that is not flat";
    for [i, j] in Setup::indices([n + 1; 2]) {
        let [x, y] = [i as f64 * size[0], j as f64 * size[1]];
        bent.bed[j * (n + 1) + i] = 0.1 * (5.0 * x).sin() * (3.0 * y).cos() + 0.2 * x;
    }
    let island = Setup { name: "island", ..with_hole(n, |edge| !edge.hole) };
    let funnel = Setup { name: "funnel", ..with_hole(n, |edge| edge.hole) };
    let oblong = Table::rectangle([n, n / 2 + 1], ALL);
    vec![
        square(n),
        Setup {
            name: "one wall",
            ..Setup::new("", Table::rectangle([n; 2], [[true, false], [true; 2]]), size)
        },
        Setup {
            name: "two walls",
            ..Setup::new("", Table::rectangle([n; 2], [[true, false], [true, false]]), size)
        },
        Setup::new("oblong", oblong.clone(), size),
        Setup::new("oblong, oblong cells", oblong, [0.01, 0.023]),
        disc(n),
        corner(n, on_the_left),
        with_hole(n, |_| true),
        island,
        funnel,
        bent,
    ]
}

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
        println!("{}: u {u:e} v {v:e}", setup.name);
        assert!(u < 1e-9 && v < 1e-9, "{}: {u:e} {v:e}", setup.name);
    }
}

#[test]
fn all_that_is_poured_falls_off() {
    for setup in tables(40) {
        let state = setup.solve();
        let out: f64 = state.outflow.iter().map(|(_, flux)| flux).sum();
        let poured = F * setup.table.area(setup.size);
        println!("{}: {:e}", setup.name, out / poured - 1.0);
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
    println!("cones: {sup}, {} nodes", supports.len());
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

#[test]
fn squares_and_discs_converge() {
    let flat = |x: [f64; 2]| exact::rectangle([1.0; 2], ALL, F, x).unwrap();
    let round = |[x, y]: [f64; 2]| exact::disc(0.5, F, (x - 0.5).hypot(y - 0.5));
    for n in [20, 40, 80, 160] {
        let setup = square(n);
        println!("square {n}: marched {:?}", errors(&setup, &setup.solve(), flat));
        let s = surface(&setup.table, setup.size, &setup.bed);
        let node = |i: usize, j: usize| s[setup.node([i, j])];
        let slopes: Vec<[f64; 2]> = Setup::<2>::indices([n; 2])
            .map(|[i, j]| {
                let (a, b, c, d) = (node(i, j), node(i + 1, j), node(i, j + 1), node(i + 1, j + 1));
                let square = [(b - a) + (d - c), (c - a) + (d - b)].map(|g| g * g);
                let sum = square[0] + square[1];
                square.map(|q| if sum > 0.0 { F * q / sum } else { F / 2.0 })
            })
            .collect();
        let paper: Vec<[f64; 2]> = Setup::<2>::indices([n; 2])
            .map(|[i, j]| {
                let (x, y) = (i.min(n - 1 - i), j.min(n - 1 - j));
                match x.cmp(&y) {
                    std::cmp::Ordering::Less => [F, 0.0],
                    std::cmp::Ordering::Greater => [0.0, F],
                    std::cmp::Ordering::Equal => [F / 2.0; 2],
                }
            })
            .collect();
        for (name, split) in [("cell slopes", slopes), ("eqs. 48, 49", paper)] {
            match equilibrium_along(&setup.table, setup.size, &setup.bed, &split) {
                Ok(state) => println!("square {n}: {name} {:?}", errors(&setup, &state, flat)),
                Err(why) => println!("square {n}: {name} {why}"),
            }
        }
        let setup = disc(n);
        println!("disc {n}: {:?}", errors(&setup, &setup.solve(), round));
        let mut rim = disc(n);
        for node in Setup::<2>::indices([n + 1; 2]) {
            let [x, y] = [0, 1].map(|k| node[k] as f64 * rim.size[k] - 0.5);
            if rim.table.touches(node) && rim.table.weight(node) == 0.0 {
                let number = rim.node(node);
                rim.bed[number] = 0.5 - x.hypot(y);
            }
        }
        println!("rim {n}: {:?}", errors(&rim, &rim.solve(), round));
        println!("rim {n}: one step {:?}", rim.one_step());
        let straight =
            Setup::new("", Table::rectangle([n; 2], [[true, false], [false; 2]]), [1.0 / n as f64; 2]);
        let exact = |x: [f64; 2]| exact::rectangle([1.0; 2], [[true, false], [false; 2]], F, x).unwrap();
        assert!(errors(&straight, &straight.solve(), exact).iter().all(|e| *e < 1e-13));
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
    println!("{sup:?}");
    for (coarse, fine) in sup[0].iter().zip(sup[1]) {
        assert!(fine < 1.5 / 80.0 && coarse / fine > 1.5, "{coarse} {fine}");
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
