//! A flow on finer and finer grids against its exact solution.

use granflow::output::figures::Style;

use super::benchmark::{Check, Errors, Finding, Line, Piece, Size};
use super::scheme::Scheme;
use crate::failure::Failure;

/// A run at its end beside the exact solution there.
pub struct Solved {
    /// The error.
    pub error: f64,
    /// The error that the exact profile has if it is displaced by one cell.
    pub one_cell: f64,
    /// Cell size.
    pub size: f64,
    /// A section of it: places and depths.
    pub section: [Vec<f64>; 2],
    /// The exact one.
    pub exact: [Vec<f64>; 2],
}

impl Solved {
    /// L1 error of a profile, the sum of |h - exact mean over the cell| dx. A displacement by dx changes the profile by dx times
    /// its total variation.
    pub fn profile(x: Vec<f64>, h: Vec<f64>, exact: impl Fn(f64) -> f64, dx: f64) -> Self {
        let exact: Vec<f64> = x.iter().map(|x| mean(&exact, *x, dx)).collect();
        let error = dx * h.iter().zip(&exact).map(|(h, exact)| (h - exact).abs()).sum::<f64>();
        let one_cell = dx * exact.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum::<f64>();
        Solved { error, one_cell, size: dx, section: [x.clone(), h], exact: [x, exact] }
    }

    /// The same error as a share of `volume`.
    pub fn relative_to(self, volume: f64) -> Self {
        Solved { error: self.error / volume, one_cell: self.one_cell / volume, ..self }
    }
}

/// Mean of `f` over the cell of size `dx` around `x`, by the midpoint rule: a jump within a cell counts where it is.
pub fn mean(f: impl Fn(f64) -> f64, x: f64, dx: f64) -> f64 {
    const POINTS: u32 = 64;
    let at = |k: u32| f(x + dx * ((f64::from(k) + 0.5) / f64::from(POINTS) - 0.5));
    (0..POINTS).map(at).sum::<f64>() / f64::from(POINTS)
}

/// What the error on the third grid may be at most.
#[derive(Clone, Copy, Debug)]
pub enum Most {
    /// The error of the exact profile displaced by so many cells.
    Cells(f64),
    /// A number with its reason.
    Fixed(f64, &'static str),
}

/// What is asked of a scheme.
#[derive(Clone, Copy, Debug)]
pub struct Bound {
    pub scheme: Scheme,
    pub most: Most,
    /// The least observed order, if one is asked for.
    pub order: Option<f64>,
}

impl Bound {
    /// The largest error on the finest of so many grids where one cell makes an error of `one_cell`, and why.
    fn most(&self, one_cell: f64, grids: u32) -> (f64, String) {
        let (finer, order) = (grids - 3, self.order.unwrap_or(0.0));
        let (most, why) = match self.most {
            Most::Cells(cells) => {
                let coarser = one_cell * f64::from(1 << finer);
                (cells * coarser, format!("the error of the exact profile {cells} cells off its place"))
            }
            Most::Fixed(most, why) => (most, why.to_owned()),
        };
        if finer == 0 {
            return (most, why);
        }
        (most * (-order * f64::from(finer)).exp2(), format!("{why} on the grid before, and the least order"))
    }
}

/// A bound in cells.
pub const fn cells(scheme: Scheme, cells: f64, order: f64) -> Bound {
    Bound { scheme, most: Most::Cells(cells), order: Some(order) }
}

/// The grids over which an order is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// The finest two.
    Finest,
    /// All, by the line through the logarithms.
    All,
}

/// A flow with an exact solution.
#[derive(Clone, Copy)]
pub struct Flow {
    /// Cells of the coarsest grid; each of the next has twice as many along an axis.
    pub coarsest: usize,
    /// Grids of `granflow verify`; the tests have three.
    pub grids: u32,
    /// What the error is of, as "L1(h)".
    pub quantity: &'static str,
    /// The order of a scheme of first and of second order on this flow, and why.
    pub formal: ([f64; 2], &'static str),
    /// Which grids the order is taken over: where a front or a jump lies in its cell differs from grid to grid, so that the
    /// finest two may say little.
    pub over: Over,
    pub bounds: &'static [Bound],
    /// Computes it on so many cells.
    pub solve: fn(Scheme, usize) -> Result<Solved, Failure>,
}

impl Flow {
    /// One piece of work for each scheme.
    pub fn pieces(self, size: Size) -> Vec<Piece> {
        let piece = |bound: &'static Bound| Piece::new(bound.scheme.name(), move || self.by(bound, size));
        self.bounds.iter().map(piece).collect()
    }

    fn by(&self, bound: &Bound, size: Size) -> Result<Finding, Failure> {
        let (scheme, grids) = (bound.scheme, if size == Size::Full { self.grids } else { 3 });
        let mut errors = Errors::default();
        let mut last = None;
        for k in 0..grids {
            let cells = self.coarsest << k;
            let solved = (self.solve)(scheme, cells)?;
            errors.cells.push(cells);
            errors.sizes.push(solved.size);
            errors.errors.push(solved.error);
            last = Some((cells, solved));
        }
        let Some((finest, solved)) = last else { return Ok(Finding::default()) };
        let (most, reason) = bound.most(solved.one_cell, grids);
        let what = format!("{} on {finest} cells", self.quantity);
        let mut checks = vec![Check::error(what, solved.error, most, reason)];
        if let Some(least) = bound.order {
            let formal = self.formal.0[usize::from(scheme.is_second_order())];
            let (from, order) = match self.over {
                Over::Finest => (finest / 2, errors.last_order()),
                Over::All => (self.coarsest, errors.order()),
            };
            let what = format!("order over the grids from {from} to {finest} cells");
            checks.push(Check::at_least(what, order, [formal, formal - least], self.formal.1));
        }
        let line = |name: &str, [x, y]: [Vec<f64>; 2], style| Line { name: name.into(), x, y, style };
        Ok(Finding {
            scheme: scheme.name(),
            checks,
            errors: Some(errors),
            curves: vec![line(scheme.name(), solved.section, Style::Solid)],
            exact: Some(line("exact", solved.exact, Style::Dashed)),
        })
    }
}
