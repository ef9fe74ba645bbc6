//! The equilibrium of a growing sandpile (M).

use granflow::output::figures::Axis;

use super::benchmark::{Benchmark, Check, Errors, Finding, Piece, Size, View};
use crate::failure::Failure;
use crate::reproduce::sandpiles::SCHEMES;
use crate::reproduce::sandpiles::plane::{self, square, square_at_once};

/// The benchmark of this file.
pub const BENCHMARK: Benchmark = Benchmark {
    name: "M",
    title: "Sandpile on an open square",
    about: "f = 0.5 on [0, 1]², all sides open, grown from an empty table to t = 15, and the equilibrium at once (\"direct\"). Exact: \
            the standing layer u is the distance to the nearest side, the rolling layer v is f times the way uphill to the ridge. \
            `granflow reproduce sandpiles` has the tables of the paper.",
    pieces,
    curves: None,
    errors: Some(View {
        x: Axis::new("cell size h", ""),
        y: Axis::new("L1 error of the rolling layer v", ""),
        caption: "Error over cell size, both logarithmic; the grey lines have slope 1 and 2.",
    }),
};

type Solve = Box<dyn Fn(usize) -> Result<plane::Errors, Failure> + Send + Sync>;

fn pieces(size: Size) -> Vec<Piece> {
    let grids: &'static [usize] = if size == Size::Full { &plane::GRIDS } else { &plane::GRIDS[..2] };
    let schemes =
        SCHEMES.map(|(name, scheme)| -> (_, Solve) { (name, Box::new(move |n| square(n, scheme))) });
    let direct: (_, Solve) = ("direct", Box::new(square_at_once));
    let piece = |(name, solve): (&'static str, Solve)| Piece::new(name, move || converge(grids, &solve));
    schemes.into_iter().chain([direct]).map(piece).collect()
}

fn converge(grids: &[usize], solve: &Solve) -> Result<Finding, Failure> {
    let mut errors = Errors::default();
    let mut highest = [f64::NAN; 2];
    for &n in grids {
        let off = solve(n)?;
        errors.cells.push(n);
        errors.sizes.push(1.0 / n as f64);
        errors.errors.push(off.v[1]);
        highest = [off.u[0], off.v[0]];
    }
    let (n, size) = (grids[grids.len() - 1], errors.sizes[grids.len() - 1]);
    let checks = vec![
        Check::error(
            format!("largest |u - exact| on {n} x {n} cells"),
            highest[0],
            size,
            "one cell: the pile has slope 1, and its summit lies between nodes or is cut",
        ),
        Check::error(
            format!("largest |v - exact| on {n} x {n} cells"),
            highest[1],
            size,
            "one cell: v changes by f = 0.5 per length, from both sides of the ridge",
        ),
        Check::at_least(
            "order of L1(v) between the last two grids",
            errors.last_order(),
            [2.0, 0.3],
            "second order but for the ridges, where v has a kink: the paper prints 1.8 to 1.9",
        ),
    ];
    Ok(Finding { checks, errors: Some(errors), ..Finding::default() })
}
