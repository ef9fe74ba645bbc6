//! The paper's numbers, and those of an independent transcription of its schemes, beside ours.

use granflow::output::tables::{Expected, Measure, Row};

use super::{LAMBDA, Runs, SCHEMES, SOURCE, line, plane, printed};

use Expected::{Exact, Independent, Published};
use Measure::{Absolute, AtMost};

/// What the first-order scheme may be off in Table 1: its printed errors carry rounding noise of the paper's sums over the
/// table; and the second-order scheme, of which some details at the boundary are not known.
const TABLE_1_WITHIN: [f64; 2] = [0.10, 0.07];
/// Half a unit of the last printed digit in Table 1, and what rounding may add.
const DIGIT: f64 = 5e-5 + 1e-6;

/// Every number.
pub fn rows(runs: &Runs) -> Vec<Row> {
    let mut rows = Vec::new();
    table_1(&mut rows, &runs.line);
    table_2(&mut rows, &runs.line);
    histories(&mut rows, &runs.line);
    square(&mut rows, &runs.plane);
    piles(&mut rows, &runs.plane);
    rows
}

fn table_1(rows: &mut Vec<Row>, runs: &line::Runs) {
    for (scheme, (name, _)) in SCHEMES.iter().enumerate() {
        for (column, what) in ["sup |u - u_ref|", "L1 of v - v_ref"].into_iter().enumerate() {
            for (k, n) in line::TABLE_1.into_iter().enumerate() {
                let (published, _) = printed::TABLE_1[scheme][column][k];
                let computed = runs.table_1[scheme][k][column];
                let within = TABLE_1_WITHIN.get(scheme).map_or(0.0, |share| share * published) + DIGIT;
                let what = format!("{what}, {name}, h = 1/{n}");
                rows.push(Row::new(
                    "sandpiles: Table 1",
                    what,
                    Published(published),
                    computed,
                    Absolute,
                    within,
                ));
            }
        }
    }
}

/// What one second-order step adds to v at the steady state: its L1 norm is f h² (2 λ - λ²).
pub fn second_order_kick(n: usize) -> f64 {
    SOURCE / (n * n) as f64 * (2.0 * LAMBDA - LAMBDA * LAMBDA)
}

fn table_2(rows: &mut Vec<Row>, runs: &line::Runs) {
    for (scheme, (name, _)) in SCHEMES.iter().enumerate() {
        for (column, what) in ["sup |u - ū|", "L1 of v - v̄"].into_iter().enumerate() {
            for (k, n) in line::TABLE_2.into_iter().enumerate() {
                let published = printed::TABLE_2[scheme][column][k];
                let computed = runs.table_2[scheme][k][column];
                let what = format!("{what} after one step, {name}, h = 1/{n}");
                let mut row = |what: String, expected, measure, within| {
                    rows.push(Row::new("sandpiles: Table 2", what, expected, computed, measure, within));
                };
                if (scheme, column) == (1, 1) {
                    row(what.clone(), Published(published), Absolute, printed::TABLE_2_DIGIT[k]);
                    row(format!("{what}, f h² (2λ - λ²)"), Exact(second_order_kick(n)), Absolute, 1e-14);
                } else {
                    row(what, Published(published), AtMost, 1e-14);
                }
            }
        }
    }
}

/// Steps to sup |u - ū| < 1e-3 by the independent run: the scheme of [`line::history_schemes`], the steps.
const STEPS: [(usize, f64); 4] = [(0, 1832.0), (1, 1149.0), (2, 1783.0), (6, 1262.0)];

fn histories(rows: &mut Vec<Row>, runs: &line::Runs) {
    let name = "sandpiles: Fig. 5";
    let (schemes, histories) = (line::history_schemes(), &runs.histories[0]);
    for (scheme, steps) in STEPS {
        let what = format!("steps to sup |u - ū| < 1e-3, {}", schemes[scheme].0);
        let computed = histories[scheme].first_u(1e-3).map_or(f64::NAN, |step| step as f64);
        rows.push(Row::new(name, what, Independent(steps), computed, Absolute, 2.0));
    }
    for ((scheme, _), history) in schemes.iter().zip(histories) {
        let last = history.v.last().copied().unwrap_or(f64::NAN);
        let what = format!("L1 of v - v̄ at t = {}, {scheme}", line::HISTORY_END);
        if scheme == "second order" {
            let what = format!("{what}: it stalls");
            rows.push(Row::new(name, what, Independent(3.0e-4), last, Absolute, 5e-6));
        } else {
            rows.push(Row::new(name, what, Exact(0.0), last, AtMost, 1e-9));
        }
    }
}

/// log2 of the ratio of each error to the next.
pub fn orders(errors: &[f64]) -> Vec<f64> {
    errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect()
}

fn square(rows: &mut Vec<Row>, runs: &plane::Runs) {
    for (scheme, (name, _)) in SCHEMES.iter().enumerate() {
        let errors = &runs.table[scheme];
        let columns = [
            (
                "first column, ours of sup |v - v̄|",
                errors.iter().map(|errors| errors.v[0]).collect::<Vec<_>>(),
            ),
            (
                "second column, ours of the L1 norm of v - v̄",
                errors.iter().map(|errors| errors.v[1]).collect(),
            ),
        ];
        for (column, (what, errors)) in columns.iter().enumerate() {
            // What the paper's second-order scheme does in the second column is not known well enough.
            if (scheme, column) == (1, 1) {
                continue;
            }
            for (k, order) in orders(errors).into_iter().enumerate() {
                let published = printed::SQUARE[scheme][column][k + 1].1.unwrap_or(f64::NAN);
                let what =
                    format!("order, {what}, {name}, {} to {} cells", plane::GRIDS[k], plane::GRIDS[k + 1]);
                rows.push(Row::new(
                    "sandpiles: table in 2-D",
                    what,
                    Published(published),
                    order,
                    Absolute,
                    0.25,
                ));
            }
        }
    }
}

fn piles(rows: &mut Vec<Row>, runs: &plane::Runs) {
    for pile in runs.piles.iter().filter(|pile| pile.is_steady()) {
        let name = format!("sandpiles: {}", pile.example.title);
        let off = pile.off();
        let highest = pile.direct.v.iter().copied().fold(0.0, f64::max);
        let mut row = |what: &str, computed| {
            let what = format!("{what}, grown by first order against the equilibrium without time steps");
            rows.push(Row::new(&name, what, Exact(0.0), computed, AtMost, 1e-8));
        };
        row("sup of u", off.u[0]);
        row("L1 of u", off.u[1]);
        row("sup of v as a share of the largest", off.v[0] / highest);
        row("L1 of v", off.v[1]);
    }
}
