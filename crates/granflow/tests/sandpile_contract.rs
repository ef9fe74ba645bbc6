//! What the sandpile schemes keep at every step, on any table and under any source.

use granflow::grid::Grid;
use granflow::hadeler_kuttler::direct::{Equilibrium, equilibrium, rays, surface};
use granflow::hadeler_kuttler::scheme::{ADAPTIVE, FIRST_ORDER, HadelerKuttler, SECOND_ORDER, Slopes};
use granflow::hadeler_kuttler::table::Table;
use granflow::hadeler_kuttler::{Ground, Pile, Source};
use granflow::scheme::Boundary;
use granflow::simulation::{Failure, Simulation, StepSize};
use proptest::prelude::*;

const SCHEMES: [(&str, HadelerKuttler); 3] =
    [("first order", FIRST_ORDER), ("second order", SECOND_ORDER), ("adaptive", ADAPTIVE)];

type Run<const D: usize> = Simulation<D, HadelerKuttler>;

/// A table of cells of one size, its transport rays, and the rate of the source in each of its cells.
struct Setting<const D: usize> {
    table: Table<D>,
    size: [f64; D],
    bed: Vec<f64>,
    shares: Vec<[f64; D]>,
    rates: Vec<f64>,
}

impl<const D: usize> Setting<D> {
    fn new(table: Table<D>, size: [f64; D], rate: impl Fn([f64; D]) -> f64) -> Self {
        let cells = table.cells();
        let rates = (0..cells.iter().product()).map(|mut n: usize| {
            rate(std::array::from_fn(|k| {
                let i = n % cells[k];
                n /= cells[k];
                (i as f64 + 0.5) * size[k]
            }))
        });
        let (rates, bed) = (rates.collect(), vec![0.0; table.nodes().iter().product()]);
        let shares = rays(&table, size, &surface(&table, size, &bed));
        Setting { table, size, bed, shares, rates }
    }
    fn cell(&self, index: [usize; D]) -> Option<usize> {
        let cells = self.table.cells();
        (0..D).all(|k| index[k] < cells[k]).then(|| (0..D).rev().fold(0, |n, k| n * cells[k] + index[k]))
    }
    fn node(&self, index: [usize; D]) -> usize {
        (0..D).rev().fold(0, |n, k| n * self.table.nodes()[k] + index[k])
    }
    fn ground(&self, index: [usize; D]) -> Ground<D, f64> {
        self.table.ground(index, self.bed[self.node(index)])
    }
    fn source(&self, index: [usize; D]) -> Source<D, f64> {
        let split = self.cell(index).map_or([0.0; D], |cell| self.shares[cell].map(|s| s * self.rates[cell]));
        self.table.source(index, split)
    }
    fn run(&self, scheme: HadelerKuttler, step: StepSize, start: Option<&Equilibrium<D>>) -> Run<D> {
        let state = |index| match start {
            Some(found) => {
                Pile { u: found.u[self.node(index)], v: self.cell(index).map_or(0.0, |cell| found.v[cell]) }
            }
            None => Pile { u: 0.0, v: 0.0 },
        };
        let grid = Grid {
            cells: self.table.nodes(),
            origin: [0.0; D],
            size: self.size,
            boundary: [[Boundary::Absorbing; 2]; D],
        };
        let mut run = Simulation::new(scheme, grid, step, |index| self.ground(index), state).unwrap();
        run.apply(|index, _| self.source(index));
        run
    }
    fn courant(scheme: HadelerKuttler) -> StepSize {
        StepSize::Courant(if scheme.slopes == Slopes::None { 0.45 } else { 0.225 })
    }
    fn equilibrium(&self) -> Equilibrium<D> {
        equilibrium(&self.table, self.size, &self.bed, &self.rates).unwrap()
    }
}

/// Smallest v, and largest slope along an edge of the table.
fn extremes<const D: usize>(setting: &Setting<D>, run: &Run<D>) -> [f64; 2] {
    let (mut low, mut steep) = (f64::INFINITY, 0.0_f64);
    for number in 0..run.grid().count() {
        let index = run.grid().index(number);
        if setting.cell(index).is_none() || !setting.table.inside(index) {
            continue;
        }
        low = low.min(run.state(index).v);
        let corners: Vec<[usize; D]> =
            (0..1 << D).map(|corner: usize| std::array::from_fn(|k| index[k] + (corner >> k & 1))).collect();
        for (corner, node) in corners.iter().enumerate() {
            for axis in (0..D).filter(|axis| corner >> axis & 1 == 0) {
                let rise = run.state(corners[corner | 1 << axis]).u - run.state(*node).u;
                steep = steep.max(rise.abs() / setting.size[axis]);
            }
        }
    }
    [low, steep]
}

/// (on the table + fallen off - poured) / poured.
fn books<const D: usize>(run: &Run<D>) -> f64 {
    let out: f64 = run.out().iter().sum();
    (run.totals().volume + out - run.poured()) / run.poured()
}

/// Steps and asserts at each of them what every pile keeps.
fn keeps<const D: usize>(name: &str, setting: &Setting<D>, scheme: HadelerKuttler, steps: usize) {
    let mut run = setting.run(scheme, Setting::<D>::courant(scheme), None);
    // The printed G bounds slopes along a line. In the plane no scheme with slopes has such a theorem, and on ragged tables single
    // edges reach 1 + 1.5e-2 for a while (docs/decisions/0008-sandpiles.md): there it is only asserted that they stay near 1.
    let over = if D > 1 && scheme.slopes != Slopes::None { 0.1 } else { 1e-14 };
    for step in 0..steps {
        run.advance(f64::INFINITY).unwrap();
        let [low, steep] = extremes(setting, &run);
        assert!(low >= -1e-14, "{name}: v = {low:e} at step {step}");
        assert!(steep <= 1.0 + over, "{name}: slope 1 + {:e} at step {step}", steep - 1.0);
        let error = books(&run);
        assert!(error.abs() <= 1e-14, "{name}: books off by {error:e} at step {step}");
    }
}

/// A random mask of 9 x 8 cells with a random part of its edges walls.
fn table(mask: u128, walls: u128) -> Table<2> {
    let bit = |bits: u128, n: usize| bits >> (n % 128) & 1 == 1;
    Table::masked(
        [9, 8],
        |[i, j]| bit(mask, j * 9 + i) || (i > 2 && j > 2),
        |edge| bit(walls, edge.index[1] * 10 + edge.index[0] + 61 * edge.axis),
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn piles_stay_piles_on_any_table(
        mask in any::<u128>(), walls in any::<u128>(), centre in [0.0..0.9_f64, 0.0..0.8], radius in 0.1..0.7_f64,
        rate in 0.1..3.0_f64,
    ) {
        let on = |[x, y]: [f64; 2]| (x - centre[0]).hypot(y - centre[1]) < radius;
        let setting = Setting::new(table(mask, walls), [0.1, 0.08], |place| if on(place) { rate } else { 0.0 });
        prop_assume!(setting.rates.iter().zip(0..).any(|(f, n)| *f > 0.0 && setting.table.inside([n % 9, n / 9])));
        for (name, scheme) in SCHEMES {
            keeps(name, &setting, scheme, 120);
        }
    }

    #[test]
    fn piles_stay_piles_on_a_line(cells in 3..40_usize, wall in any::<bool>(), from in 0.0..0.8_f64, rate in 0.1..3.0_f64) {
        let table = Table::rectangle([cells], [[true, !wall]]);
        let on = |[x]: [f64; 1]| if x > from && x < from + 0.3 { rate } else { 0.05 };
        let setting = Setting::new(table, [1.0 / cells as f64], on);
        for (name, scheme) in SCHEMES {
            keeps(name, &setting, scheme, 300);
        }
    }
}

#[test]
fn a_plane_without_variation_across_is_a_line() {
    for (name, scheme) in SCHEMES {
        for axis in 0..2 {
            let (n, m) = (24, 6);
            let h = 1.0 / n as f64;
            let rate = |x: f64| 0.5 + x;
            let line = Setting::new(Table::rectangle([n], [[true, false]]), [h], |[x]| rate(x));
            let mut cells = [m; 2];
            cells[axis] = n;
            let mut open = [[false; 2]; 2];
            open[axis] = [true, false];
            let plane = Setting::new(Table::rectangle(cells, open), [h; 2], |place| rate(place[axis]));
            let step = StepSize::Fixed(0.1 * h);
            let (mut line, mut plane) = (line.run(scheme, step, None), plane.run(scheme, step, None));
            for _ in 0..1200 {
                line.advance(f64::INFINITY).unwrap();
                plane.advance(f64::INFINITY).unwrap();
            }
            for number in 0..plane.grid().count() {
                let index = plane.grid().index(number);
                let (one, two) = (line.state([index[axis]]), plane.state(index));
                let off =
                    (one.u - two.u).abs().max(if index[1 - axis] < m { (one.v - two.v).abs() } else { 0.0 });
                assert!(off <= 1e-13, "{name}, axis {axis}: {off:e} at {index:?}");
            }
        }
    }
}

#[test]
fn the_squares_pile_has_its_eight_symmetries_bit_for_bit() {
    for n in [11, 12] {
        for (name, scheme) in SCHEMES {
            let setting =
                Setting::new(Table::rectangle([n; 2], [[true; 2]; 2]), [1.0 / n as f64; 2], |_| 0.5);
            let mut run = setting.run(scheme, Setting::<2>::courant(scheme), None);
            for _ in 0..500 {
                run.advance(f64::INFINITY).unwrap();
            }
            for j in 0..=n {
                for i in 0..=n {
                    let (node, cell) =
                        (|i: usize, j: usize| run.state([i, j]).u, |i: usize, j: usize| run.state([i, j]).v);
                    for [a, b] in [[j, i], [n - i, j], [i, n - j], [n - j, n - i]] {
                        assert_eq!(node(i, j), node(a, b), "{name}, n = {n}: u at {i}, {j}");
                    }
                    if i < n && j < n {
                        let m = n - 1;
                        for [a, b] in [[j, i], [m - i, j], [i, m - j], [m - j, m - i]] {
                            assert_eq!(cell(i, j), cell(a, b), "{name}, n = {n}: v at {i}, {j}");
                        }
                    }
                }
            }
        }
    }
}

/// Square, square with a wall, disc.
fn tables(n: usize) -> [(&'static str, Table<2>); 3] {
    let disc = |[i, j]: [usize; 2]| {
        let off = |k: usize| k as f64 + 0.5 - 0.5 * n as f64;
        off(i).hypot(off(j)) < 0.5 * n as f64
    };
    [
        ("square", Table::rectangle([n; 2], [[true; 2]; 2])),
        ("square with walls", Table::rectangle([n; 2], [[true, false], [true; 2]])),
        ("disc", Table::masked([n; 2], disc, |_| false)),
    ]
}

#[test]
fn the_adaptive_scheme_stays_at_the_steady_state_of_first_order() {
    for (name, table) in tables(20) {
        let setting = Setting::new(table, [0.05; 2], |_| 0.5);
        let found = setting.equilibrium();
        for (order, scheme) in [("first order", FIRST_ORDER), ("adaptive", ADAPTIVE)] {
            let mut run = setting.run(scheme, Setting::<2>::courant(scheme), Some(&found));
            let start: Vec<Pile<f64>> = run.collect(|cell| cell.state);
            for _ in 0..200 {
                run.advance(f64::INFINITY).unwrap();
            }
            let off = run.collect(|cell| cell.state).into_iter().zip(start);
            let off = off.fold(0.0_f64, |m, (a, b)| m.max((a.u - b.u).abs()).max((a.v - b.v).abs()));
            assert!(off <= 1e-13, "{name}, {order}: {off:e}");
        }
    }
}

#[test]
fn time_stepping_ends_where_the_direct_equilibrium_is() {
    for (name, table) in tables(12) {
        let setting = Setting::new(table, [1.0 / 12.0; 2], |_| 2.0);
        let found = setting.equilibrium();
        let mut run = setting.run(FIRST_ORDER, Setting::<2>::courant(FIRST_ORDER), None);
        while run.time() < 150.0 {
            run.advance(f64::INFINITY).unwrap();
        }
        let (mut u, mut v) = (0.0_f64, 0.0_f64);
        for number in 0..run.grid().count() {
            let index = run.grid().index(number);
            let state = run.state(index);
            u = u.max((state.u - found.u[setting.node(index)]).abs());
            v = v.max(setting.cell(index).map_or(0.0, |cell| (state.v - found.v[cell]).abs()));
        }
        assert!(u < 1e-9 && v < 1e-9, "{name}: u {u:e}, v {v:e}");
    }
}

#[test]
fn sleeping_tiles_change_no_bit() {
    for (name, scheme) in SCHEMES {
        // One corner of a wide table, so that most of it sleeps for long.
        let on = |[x, y]: [f64; 2]| if x < 0.2 && y < 0.2 { 1.0 } else { 0.0 };
        let setting = Setting::new(Table::rectangle([50, 30], [[true, false], [true; 2]]), [0.02; 2], on);
        let step = Setting::<2>::courant(scheme);
        let (mut lazy, mut busy) = (setting.run(scheme, step, None), setting.run(scheme, step, None));
        for _ in 0..150 {
            busy.wake_all();
            assert_eq!(lazy.advance(f64::INFINITY), busy.advance(f64::INFINITY), "{name}");
        }
        assert!(lazy.updates() < busy.updates(), "{name}: nothing slept");
        assert_eq!(lazy.collect(|cell| cell.state), busy.collect(|cell| cell.state), "{name}");
        assert_eq!(lazy.out(), busy.out(), "{name}");
    }
}

#[test]
fn without_a_source_the_rolling_layer_dies_out_and_the_pile_stands() {
    let setting = Setting::new(Table::rectangle([20; 2], [[true; 2]; 2]), [0.05; 2], |_| 0.5);
    let mut run = setting.run(FIRST_ORDER, Setting::<2>::courant(FIRST_ORDER), None);
    while run.time() < 0.6 {
        run.advance(0.6).unwrap();
    }
    let poured = run.poured();
    run.apply(|_, _| Source::none());
    while run.time() < 60.0 {
        run.advance(60.0).unwrap();
    }
    let before: Vec<Pile<f64>> = run.collect(|cell| cell.state);
    for _ in 0..1000 {
        run.advance(f64::INFINITY).unwrap();
    }
    let after = run.collect(|cell| cell.state);
    assert_eq!(run.poured(), poured);
    assert!(books(&run).abs() <= 1e-14);
    assert!(before.iter().zip(&after).all(|(a, b)| a.u == b.u), "the pile still grows");
    assert!(after.iter().all(|cell| cell.v < 1e-12), "sand still rolls");
}

#[test]
fn a_fixed_step_beyond_the_bound_is_refused_when_v_has_grown() {
    let setting = Setting::new(Table::rectangle([80], [[true; 2]]), [1.0 / 80.0], |_| 50.0);
    let mut run = setting.run(FIRST_ORDER, StepSize::Fixed(0.45 / 80.0), None);
    let failure = (0..10_000).find_map(|_| run.advance(f64::INFINITY).err());
    let Some(Failure::TooLong { step, courant, max, .. }) = failure else { panic!("{failure:?}") };
    assert!(step > 0 && courant > max && max == 1.0, "{failure:?}");
    let [low, steep] = extremes(&setting, &run);
    assert!(low >= 0.0 && steep <= 1.0 + 1e-14, "what was computed before the refusal is sound");
}
