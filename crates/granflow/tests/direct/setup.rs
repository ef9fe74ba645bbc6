//! Tables to solve on.

use granflow::grid::Grid;
use granflow::hadeler_kuttler::Pile;
use granflow::hadeler_kuttler::direct::{Equilibrium, equilibrium, rays, surface};
use granflow::hadeler_kuttler::scheme::{FIRST_ORDER, HadelerKuttler};
use granflow::hadeler_kuttler::table::{Edge, Table};
use granflow::scheme::{Boundary, Side};
use granflow::simulation::{Simulation, StepSize};

pub const F: f64 = 0.5;
pub const ALL: [[bool; 2]; 2] = [[true; 2]; 2];

/// A table with a source on each cell, cells of size 1/n along each axis unless said otherwise.
pub struct Setup<const D: usize> {
    pub name: &'static str,
    pub table: Table<D>,
    pub size: [f64; D],
    pub bed: Vec<f64>,
    pub source: Vec<f64>,
}

impl<const D: usize> Setup<D> {
    pub fn new(name: &'static str, table: Table<D>, size: [f64; D]) -> Self {
        let nodes: usize = table.nodes().iter().product();
        let cells: usize = table.cells().iter().product();
        Setup { name, table, size, bed: vec![0.0; nodes], source: vec![F; cells] }
    }
    pub fn solve(&self) -> Equilibrium<D> {
        equilibrium(&self.table, self.size, &self.bed, &self.source)
            .unwrap_or_else(|why| panic!("{}: {why}", self.name))
    }
    pub fn cell(&self, index: [usize; D]) -> usize {
        (0..D).rev().fold(0, |n, k| n * self.table.cells()[k] + index[k])
    }
    pub fn node(&self, index: [usize; D]) -> usize {
        (0..D).rev().fold(0, |n, k| n * self.table.nodes()[k] + index[k])
    }
    pub fn indices(counts: [usize; D]) -> impl Iterator<Item = [usize; D]> {
        (0..counts.iter().product()).map(move |mut n: usize| {
            std::array::from_fn(|k| {
                let i = n % counts[k];
                n /= counts[k];
                i
            })
        })
    }
    pub fn inside(&self) -> impl Iterator<Item = [usize; D]> {
        Self::indices(self.table.cells()).filter(|index| self.table.inside(*index))
    }
    pub fn centre(&self, index: [usize; D]) -> [f64; D] {
        std::array::from_fn(|k| (index[k] as f64 + 0.5) * self.size[k])
    }
    pub fn run(&self, state: &Equilibrium<D>) -> Simulation<D, HadelerKuttler> {
        let shares = rays(&self.table, self.size, &surface(&self.table, self.size, &self.bed));
        let cells = self.table.cells();
        let within = |index: [usize; D]| (0..D).all(|k| index[k] < cells[k]);
        let ground = |index: [usize; D]| self.table.ground(index, self.bed[self.node(index)]);
        let source = |index: [usize; D], _| {
            let split = if within(index) {
                let c = self.cell(index);
                shares[c].map(|share| self.source[c] * share)
            } else {
                [0.0; D]
            };
            self.table.source(index, split)
        };
        let pile = |index: [usize; D]| Pile {
            u: state.u[self.node(index)],
            v: if within(index) { state.v[self.cell(index)] } else { 0.0 },
        };
        let step = StepSize::Courant(0.45);
        let run = Simulation::new(
            FIRST_ORDER,
            Grid {
                cells: self.table.nodes(),
                origin: [0.0; D],
                size: self.size,
                boundary: [[Boundary::Absorbing; 2]; D],
            },
            step,
            ground,
            pile,
        );
        let mut run = run.unwrap();
        run.apply(source);
        run
    }
    /// Largest change of u and of v in one step.
    pub fn one_step(&self) -> [f64; 2] {
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

pub fn square(n: usize) -> Setup<2> {
    Setup::new("square", Table::rectangle([n; 2], ALL), [1.0 / n as f64; 2])
}

pub fn disc(n: usize) -> Setup<2> {
    let far = |[i, j]: [usize; 2]| {
        let at = |k: usize| (2 * k + 1) as f64 - n as f64;
        at(i).hypot(at(j)) < n as f64
    };
    Setup::new("disc", Table::masked([n; 2], far, |_| false), [1.0 / n as f64; 2])
}

/// An L, its notch upper right, a wall on the left.
pub fn corner(n: usize, wall: impl Fn(&Edge<2>) -> bool) -> Setup<2> {
    let table = Table::masked([n; 2], |[i, j]| 2 * i < n || 2 * j < n, wall);
    Setup::new("L", table, [1.0 / n as f64; 2])
}

pub fn with_hole(n: usize, open: impl Fn(&Edge<2>) -> bool) -> Setup<2> {
    let hole = |k: usize| 5 * k >= 2 * n && 5 * k < 3 * n;
    let table = Table::masked([n; 2], |[i, j]| !(hole(i) && hole(j)), |edge| !open(edge));
    Setup::new("hole", table, [1.0 / n as f64; 2])
}

pub fn on_the_left(edge: &Edge<2>) -> bool {
    edge.axis == 0 && edge.faces == Side::Left && edge.index[0] == 0
}

pub fn tables(n: usize) -> Vec<Setup<2>> {
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
