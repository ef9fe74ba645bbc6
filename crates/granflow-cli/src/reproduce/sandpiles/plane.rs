//! The examples on the square [0, 1]².

use granflow::hadeler_kuttler::direct::Equilibrium;
use granflow::hadeler_kuttler::scheme::{FIRST_ORDER, HadelerKuttler};
use granflow::hadeler_kuttler::table::{Edge, Table};
use granflow::hadeler_kuttler::{Pile as State, exact};
use granflow::models::hadeler_kuttler::run::site::Site;
use granflow::scheme::Scheme;
use granflow::simulation::{Simulation, StepSize};

use super::{SCHEMES, SOURCE, failed};
use crate::failure::Failure;
use crate::page::parallel;

/// Nine tenths of the step that eqs. 26, 27 allow.
fn step(scheme: HadelerKuttler) -> StepSize {
    StepSize::Courant(0.9 * Scheme::<2, f64>::max_courant(&scheme))
}

/// Cells along a side in the table of errors; the paper's has a fourth, 160.
pub const GRIDS: [usize; 3] = [20, 40, 80];
/// The time of that table.
pub const END: f64 = 15.0;

/// Cells along a side in the figures.
pub const CELLS: usize = 30;
/// A pile is steady when neither layer changes faster.
const STEADY: f64 = 1e-9;
/// The time at which a run that is not steady is ended.
const LONGEST: f64 = 100.0;

/// sup and L1 norm of the differences of u (at the nodes) and of v (in the cells).
#[derive(Debug, Clone, Copy)]
pub struct Errors {
    /// u.
    pub u: [f64; 2],
    /// v.
    pub v: [f64; 2],
}

impl Errors {
    fn between(u: impl Iterator<Item = [f64; 2]>, v: impl Iterator<Item = [f64; 2]>, n: usize) -> Self {
        let norms = |pairs: &mut dyn Iterator<Item = [f64; 2]>| {
            let (sup, sum) = pairs.fold((0.0_f64, 0.0), |(sup, sum), [a, b]| {
                let off = (a - b).abs();
                (sup.max(off), sum + off)
            });
            [sup, sum / (n * n) as f64]
        };
        Errors { u: norms(&mut { u }), v: norms(&mut { v }) }
    }
}

/// All fields of a state: u at the nodes and v in the cells, x fastest.
fn layers(run: &Simulation<2, HadelerKuttler>) -> (Vec<f64>, Vec<f64>) {
    let [columns, rows] = run.grid().cells;
    let all = |columns: usize, rows: usize, value: fn(State<f64>) -> f64| -> Vec<f64> {
        (0..rows)
            .flat_map(|j| (0..columns).map(move |i| (i, j)))
            .map(|(i, j)| value(run.state([i, j])))
            .collect()
    };
    (all(columns, rows, |state| state.u), all(columns - 1, rows - 1, |state| state.v))
}

/// The open square of `n` x `n` cells, and the source that covers it.
fn open_square(n: usize) -> (Site<2>, Vec<f64>) {
    let site = Site::level(Table::rectangle([n; 2], [[true; 2]; 2]), [1.0 / n as f64; 2]);
    (site, vec![SOURCE; n * n])
}

/// Errors on the open square under a complete source, at [`END`].
pub fn square(n: usize, scheme: HadelerKuttler) -> Result<Errors, Failure> {
    let (site, source) = open_square(n);
    let empty = (vec![0.0; (n + 1) * (n + 1)], vec![0.0; n * n]);
    let mut run = site.simulation(scheme, step(scheme), &source, (&empty.0, &empty.1)).map_err(failed)?;
    while run.time() < END {
        run.advance(END).map_err(failed)?;
    }
    let (u, v) = layers(&run);
    Ok(off_the_exact(n, &u, &v))
}

/// Errors on the open square of the equilibrium that is computed without time steps.
pub fn square_at_once(n: usize) -> Result<Errors, Failure> {
    let (site, source) = open_square(n);
    let direct = site.equilibrium(&source).map_err(failed)?;
    Ok(off_the_exact(n, &direct.u, &direct.v))
}

/// Layers on the open square against its exact equilibrium.
fn off_the_exact(n: usize, u: &[f64], v: &[f64]) -> Errors {
    let exact = |x: f64, y: f64| {
        exact::rectangle([1.0; 2], [[true; 2]; 2], SOURCE, [x, y]).expect("an open square has an equilibrium")
    };
    let h = 1.0 / n as f64;
    let at = |k: usize, columns: usize, half: f64| {
        exact(((k % columns) as f64 + half) * h, ((k / columns) as f64 + half) * h)
    };
    let u = u.iter().enumerate().map(|(k, u)| [*u, at(k, n + 1, 0.0).u]);
    let v = v.iter().enumerate().map(|(k, v)| [*v, at(k, n, 0.5).v]);
    Errors::between(u, v, n)
}

/// A pile on the square.
pub struct Example {
    /// Its name in file names.
    pub name: &'static str,
    /// Its name in headings.
    pub title: &'static str,
    /// What the paper says and leaves open.
    pub about: &'static str,
    source: fn(x: f64, y: f64) -> bool,
    wall: fn(&Edge<2>) -> bool,
    /// Heights y of the two sections along x; a missing one is the diagonal.
    pub sections: [Option<f64>; 2],
}

fn on_the_middle(x: f64, y: f64) -> bool {
    let within = |c: f64| c > 0.2 && c < 0.8;
    within(x) && within(y)
}

/// All but the lower half of the left side.
fn but_half_a_side(edge: &Edge<2>) -> bool {
    let [x, y] = edge.middle();
    x > 0.0 || y > CELLS as f64 / 2.0
}

/// The three kinds of problem in the paper's section 7.2.
pub const EXAMPLES: [Example; 3] = [
    Example {
        name: "complete",
        title: "Complete source on an open table",
        about: "f = 0.5 on the whole square, all sides open (section 7.2). In the equilibrium u is the distance to the \
                nearest side and v = f times the way uphill to the ridge, the diagonals.",
        source: |_, _| true,
        wall: |_| false,
        sections: [Some(0.5), None],
    },
    Example {
        name: "discontinuous",
        title: "Discontinuous source on an open table",
        about: "f = 0.5 on [0.2, 0.8]² and 0 elsewhere, all sides open. The paper does not print where its source lies: \
                this square is assumed. The sand rolls straight to the sides; towards the four corners no ray of the source \
                leads. Only the numerical width of the rays lets a trace of sand in there: the corners fill so slowly that \
                the run is not steady at its end, and the line shows what they would fill to.",
        source: on_the_middle,
        wall: |_| false,
        sections: [Some(0.5), None],
    },
    Example {
        name: "partially_open",
        title: "Partially open table",
        about: "f = 0.5 on the whole square, open on the lower half of the left side (x = 0, y < 1/2), walls elsewhere. \
                The paper's walls are in a figure that is lost: these are assumed. Above y = 1/2 all rays end in the \
                point (0, 1/2), near which v grows like one over the distance to it. The cells beside the wall above it hold about twice the v of \
                the next ones, in the run and in the equilibrium without time steps alike: what the upwind transport spreads \
                towards the wall rolls down along it.",
        source: |_, _| true,
        wall: but_half_a_side,
        sections: [Some(0.3), Some(0.7)],
    },
];

/// A pile that has grown by the first-order scheme, and the equilibrium that is computed without time steps.
pub struct Pile {
    /// Which.
    pub example: &'static Example,
    /// Standing layer at the nodes.
    pub u: Vec<f64>,
    /// Rolling layer in the cells.
    pub v: Vec<f64>,
    /// The equilibrium.
    pub direct: Equilibrium<2>,
    /// The walls' ends.
    pub walls: Vec<[[f64; 2]; 2]>,
    /// When and after how many steps it was steady, or was ended.
    pub end: (f64, u64),
    /// max |u_t| and max |v_t| there.
    pub drift: [f64; 2],
}

impl Pile {
    fn grow(example: &'static Example) -> Result<Self, Failure> {
        let (n, h) = (CELLS, 1.0 / CELLS as f64);
        let site = Site::level(Table::masked([n; 2], |_| true, example.wall), [h; 2]);
        let centre = |k: usize| (k as f64 + 0.5) * h;
        let source: Vec<f64> = (0..n * n)
            .map(|k| if (example.source)(centre(k % n), centre(k / n)) { SOURCE } else { 0.0 })
            .collect();
        let direct = site.equilibrium(&source).map_err(failed)?;
        let empty = (vec![0.0; (n + 1) * (n + 1)], vec![0.0; n * n]);
        let mut run =
            site.simulation(FIRST_ORDER, step(FIRST_ORDER), &source, (&empty.0, &empty.1)).map_err(failed)?;
        let mut drift = [f64::INFINITY; 2];
        while run.time() < LONGEST && drift.iter().any(|rate| *rate > STEADY) {
            run.advance(LONGEST).map_err(failed)?;
            drift = [run.drift()[0], run.drift()[1]];
        }
        let walls = site.table.edges().filter(|(_, wall)| *wall).map(|(edge, _)| {
            let from = edge.index.map(|k| k as f64 * h);
            let mut to = from;
            to[1 - edge.axis] += h;
            [from, to]
        });
        let walls = walls.collect();
        let (u, v) = layers(&run);
        Ok(Pile { example, u, v, direct, walls, end: (run.time(), run.step()), drift })
    }

    /// Has it come to rest?
    pub fn is_steady(&self) -> bool {
        self.drift.iter().all(|rate| *rate <= STEADY)
    }

    /// What differs from the equilibrium.
    pub fn off(&self) -> Errors {
        let pairs =
            |a: &[f64], b: &[f64]| -> Vec<[f64; 2]> { a.iter().zip(b).map(|(a, b)| [*a, *b]).collect() };
        let (u, v) = (pairs(&self.u, &self.direct.u), pairs(&self.v, &self.direct.v));
        Errors::between(u.into_iter(), v.into_iter(), CELLS)
    }
}

/// All runs on the square.
pub struct Runs {
    /// Errors by scheme on each of [`GRIDS`].
    pub table: [Vec<Errors>; 3],
    /// The piles of [`EXAMPLES`].
    pub piles: Vec<Pile>,
}

impl Runs {
    /// Computes them, on all cores.
    pub fn compute() -> Result<Self, Failure> {
        let grids = GRIDS.len();
        // The finest grids take longest and come first.
        let errors = parallel(3 * grids, |k| square(GRIDS[grids - 1 - k / 3], SCHEMES[k % 3].1));
        let errors = errors.into_iter().collect::<Result<Vec<_>, _>>()?;
        let table = std::array::from_fn(|scheme| errors[scheme..].iter().step_by(3).rev().copied().collect());
        let piles = parallel(EXAMPLES.len(), |k| Pile::grow(&EXAMPLES[k]));
        Ok(Runs { table, piles: piles.into_iter().collect::<Result<_, _>>()? })
    }
}
