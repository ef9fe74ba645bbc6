//! The examples on [0, 1], open at both ends.

use granflow::hadeler_kuttler::exact;
use granflow::hadeler_kuttler::scheme::{FIRST_ORDER, HadelerKuttler, SECOND_ORDER};
use granflow::hadeler_kuttler::table::Table;
use granflow::models::hadeler_kuttler::run::site::Site;
use granflow::simulation::{Simulation, StepSize};

use super::{LAMBDA, SCHEMES, SOURCE, adaptive, failed};
use crate::failure::Failure;
use crate::page::parallel;

/// Standing layer at the nodes and rolling layer in the cells.
#[derive(Debug, Clone)]
pub struct Layers {
    /// u.
    pub u: Vec<f64>,
    /// v.
    pub v: Vec<f64>,
}

impl Layers {
    /// An empty table.
    fn empty(n: usize) -> Self {
        Layers { u: vec![0.0; n + 1], v: vec![0.0; n] }
    }

    /// The exact equilibrium (eq. 52).
    pub fn steady(n: usize) -> Self {
        let exact = |x| exact::open_line(1.0, x, |x| SOURCE * x);
        Layers {
            u: nodes(n).into_iter().map(|x| exact(x).u).collect(),
            v: centres(n).into_iter().map(|x| exact(x).v).collect(),
        }
    }

    fn of(run: &Simulation<1, HadelerKuttler>) -> Self {
        let n = run.grid().cells[0] - 1;
        Layers {
            u: (0..=n).map(|i| run.state([i]).u).collect(),
            v: (0..n).map(|i| run.state([i]).v).collect(),
        }
    }

    /// Cells.
    pub fn count(&self) -> usize {
        self.v.len()
    }

    /// On a coarser grid: u where nodes coincide, v averaged.
    fn coarser(&self, n: usize) -> Self {
        let per = self.count() / n;
        Layers {
            u: self.u.iter().copied().step_by(per).collect(),
            v: self.v.chunks(per).map(|part| part.iter().sum::<f64>() / per as f64).collect(),
        }
    }

    /// sup |u - u'| and the L1 norm of v - v'.
    fn off(&self, other: &Self) -> [f64; 2] {
        let differences =
            |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| (a - b).abs()).collect() };
        let u = differences(&self.u, &other.u).into_iter().fold(0.0, f64::max);
        [u, differences(&self.v, &other.v).iter().sum::<f64>() / self.count() as f64]
    }
}

/// Where the nodes of n cells lie.
pub fn nodes(n: usize) -> Vec<f64> {
    (0..=n).map(|i| i as f64 / n as f64).collect()
}

/// Where the centres of n cells lie.
pub fn centres(n: usize) -> Vec<f64> {
    (0..n).map(|i| (i as f64 + 0.5) / n as f64).collect()
}

fn simulation(scheme: HadelerKuttler, lambda: f64, start: &Layers) -> Simulation<1, HadelerKuttler> {
    let n = start.count();
    let h = 1.0 / n as f64;
    let site = Site::level(Table::rectangle([n], [[true; 2]]), [h]);
    site.simulation(scheme, StepSize::Fixed(lambda * h), &vec![SOURCE; n], (&start.u, &start.v))
        .expect("the scheme takes the paper's steps")
}

/// From an empty table to a time.
fn grow(n: usize, scheme: HadelerKuttler, lambda: f64, end: f64) -> Result<Layers, Failure> {
    let mut run = simulation(scheme, lambda, &Layers::empty(n));
    while run.time() < end {
        run.advance(end).map_err(failed)?;
    }
    Ok(Layers::of(&run))
}

/// Errors against the equilibrium, step by step.
#[derive(Debug)]
pub struct History {
    /// sup |u - ū| after 1, 2, ... steps.
    pub u: Vec<f64>,
    /// L1 norm of v - v̄.
    pub v: Vec<f64>,
}

impl History {
    fn compute(n: usize, scheme: HadelerKuttler) -> Result<Self, Failure> {
        let (steady, h) = (Layers::steady(n), 1.0 / n as f64);
        let mut run = simulation(scheme, LAMBDA, &Layers::empty(n));
        let mut history = History { u: Vec::new(), v: Vec::new() };
        while run.time() + LAMBDA * h <= HISTORY_END {
            run.advance(f64::INFINITY).map_err(failed)?;
            let [u, v] = Layers::of(&run).off(&steady);
            history.u.push(u);
            history.v.push(v);
        }
        Ok(history)
    }

    /// First step with sup |u - ū| < bound.
    pub fn first_u(&self, bound: f64) -> Option<usize> {
        self.u.iter().position(|&u| u < bound).map(|k| k + 1)
    }

    /// Step after which the error of v stays below a bound, if it does at the end.
    pub fn lasting_v(&self, bound: f64) -> Option<usize> {
        let above = self.v.iter().rposition(|&v| v >= bound).map_or(0, |k| k + 1);
        (above < self.v.len()).then_some(above + 1)
    }

    /// The most by which the error of v rises again once below 1e-3: largest ratio to what it was before. Errors below
    /// 1e-9 are rounding.
    pub fn rise(&self) -> f64 {
        let (mut least, mut rise) = (f64::INFINITY, 1.0_f64);
        for &v in self.v.iter().skip_while(|v| **v >= 1e-3).filter(|v| **v > 1e-9) {
            least = least.min(v);
            rise = rise.max(v / least);
        }
        rise
    }
}

/// Cells of Table 1 and of Table 2.
pub const TABLE_1: [usize; 5] = [40, 80, 160, 320, 640];
/// See [`TABLE_1`].
pub const TABLE_2: [usize; 4] = [50, 100, 200, 400];
/// Cells of the reference of Table 1.
pub const REFERENCE: usize = 10_240;
/// The time of Table 1 and Fig. 3.
pub const TRANSIENT: f64 = 1.2;
/// Cells of Fig. 3.
pub const FIGURE_3: usize = 80;
/// Cells of Fig. 4, and the time.
pub const FIGURE_4: (usize, f64) = (50, 20.0);
/// Exponents of Θ that are compared.
pub const EXPONENTS: [f64; 5] = [2.0, 2.25, 2.5, 2.75, 3.0];
/// Cells of the histories; those of Fig. 5 come first.
pub const HISTORIES: [usize; 2] = [50, 100];
/// The time to which they go.
pub const HISTORY_END: f64 = 60.0;

/// The schemes of the histories: first and second order, then the exponents.
pub fn history_schemes() -> Vec<(String, HadelerKuttler)> {
    let adaptive = EXPONENTS.map(|m| (format!("adaptive, m = {m}"), adaptive(m)));
    [("first order".into(), FIRST_ORDER), ("second order".into(), SECOND_ORDER)]
        .into_iter()
        .chain(adaptive)
        .collect()
}

/// All runs on the interval, by scheme.
pub struct Runs {
    /// The reference at the time of Table 1.
    pub reference: Layers,
    /// Table 1: errors [u, v] on each grid.
    pub table_1: [Vec<[f64; 2]>; 3],
    /// Table 2, likewise.
    pub table_2: [Vec<[f64; 2]>; 3],
    /// Fig. 3.
    pub figure_3: [Layers; 3],
    /// Fig. 4.
    pub figure_4: [Layers; 3],
    /// By grid of [`HISTORIES`] and scheme of [`history_schemes`].
    pub histories: Vec<Vec<History>>,
}

impl Runs {
    /// Computes them, on all cores.
    pub fn compute() -> Result<Self, Failure> {
        // The reference takes longest; the rest is done beside it.
        let small = [(FIGURE_3, LAMBDA, TRANSIENT), (FIGURE_4.0, LAMBDA, FIGURE_4.1)]
            .into_iter()
            .chain(TABLE_1.map(|n| (n, 0.1, TRANSIENT)));
        let small: Vec<_> = small.flat_map(|run| SCHEMES.map(|(_, scheme)| (run, scheme))).collect();
        let grown = parallel(small.len() + 1, |k| match k.checked_sub(1) {
            None => grow(REFERENCE, SECOND_ORDER, LAMBDA, TRANSIENT),
            Some(k) => {
                let ((n, lambda, end), scheme) = small[k];
                grow(n, scheme, lambda, end)
            }
        });
        let grown = grown.into_iter().collect::<Result<Vec<_>, _>>()?;
        let (reference, grown) = (grown[0].clone(), &grown[1..]);
        let each = |k: usize| -> [Layers; 3] { std::array::from_fn(|scheme| grown[3 * k + scheme].clone()) };
        let table_1 = std::array::from_fn(|scheme| {
            let off = |k: usize| {
                let run = &grown[3 * (k + 2) + scheme];
                run.off(&reference.coarser(run.count()))
            };
            (0..TABLE_1.len()).map(off).collect()
        });
        let mut table_2 = [const { Vec::new() }; 3];
        for (errors, (_, scheme)) in table_2.iter_mut().zip(SCHEMES) {
            for n in TABLE_2 {
                let steady = Layers::steady(n);
                let mut run = simulation(scheme, LAMBDA, &steady);
                run.advance(f64::INFINITY).map_err(failed)?;
                errors.push(Layers::of(&run).off(&steady));
            }
        }
        let schemes = history_schemes();
        let histories = parallel(HISTORIES.len() * schemes.len(), |k| {
            History::compute(HISTORIES[k / schemes.len()], schemes[k % schemes.len()].1)
        });
        let mut histories = histories.into_iter();
        let histories = HISTORIES
            .map(|_| histories.by_ref().take(schemes.len()).collect::<Result<Vec<_>, _>>())
            .into_iter()
            .collect::<Result<_, _>>()?;
        let (figure_3, figure_4) = (each(0), each(1));
        Ok(Runs { reference, table_1, table_2, figure_3, figure_4, histories })
    }
}
