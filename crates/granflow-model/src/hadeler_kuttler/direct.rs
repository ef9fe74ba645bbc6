//! The equilibrium of a growing pile at once, without time steps.
//!
//! -div(v grad u) = f, |grad u| = 1 where v > 0, |grad u| <= 1 elsewhere, u = 0 where sand falls off and v du/dn = 0 at walls
//! (Aggarwal, Veerappa Gowda & Sudarshan Kumar 2023, eq. 5). The surface is the distance d to the open edges inside the table,
//! by fast marching; the rolling layer follows by transport down the surface. Both in the discrete form of the
//! first-order scheme, so that where the source covers the table they are its fixed point, to rounding.
//!
//! On a slanted or round table the open edges are stairs, and their corners gather the sand that falls: v does not converge
//! in L1 (on the disc 20 % off from 20 to 160 cells across). With the true distance to the edge as height b of the nodes on the edge, where u = 0,
//! the stairs vanish from the surface (2 % off at 40 cells across, 1 % at 160).
//!
//! A source on a part of the table fixes u only where its sand rolls. Elsewhere the equilibrium is not unique:
//! max over the places y where sand rolls of (d(y) - |x - y|)+ <= u <= d(x), and what a run comes to depends on how it began.

mod march;
mod transport;
mod unsteady;

use super::table::{Edge, Table};
use alloc::vec;
use alloc::vec::Vec;
use march::march;
use transport::Slope;
pub use unsteady::Unsteady;

/// An equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium<const D: usize> {
    /// Standing layer u at the nodes, x fastest: where it is not determined the least that carries the rolling sand, the
    /// pile that the source builds on an empty table; 0 beside the table.
    pub u: Vec<f64>,
    /// The most that can lie there: d less the table's height; infinite where no way leads to an open edge.
    pub most: Vec<f64>,
    /// Rolling layer v in the cells, x fastest.
    pub v: Vec<f64>,
    /// Does sand roll at the node, so that u is determined?
    pub determined: Vec<bool>,
    /// Volume per time (in one dimension per width) that falls over each open edge.
    pub outflow: Vec<(Edge<D>, f64)>,
    /// Cells of a crest one cell wide along which sand rolls towards more level ground: here it leaves across the crest,
    /// in the scheme it is dammed up, without end where the crest is level. Mostly none.
    pub crests: Vec<[usize; D]>,
}

/// A cell carries sand where v exceeds this share of the largest: less is the upwind transport's numerical width, and
/// would take as many times longer to build the pile up.
const CARRIES: f64 = 1e-6;

/// The equilibrium for a `source` f (cells, x fastest) on a table with cells of `size` and height `bed` (nodes), the source
/// split by [`rays`].
pub fn equilibrium<const D: usize>(
    table: &Table<D>,
    size: [f64; D],
    bed: &[f64],
    source: &[f64],
) -> Result<Equilibrium<D>, Unsteady<D>> {
    let split = rays(table, size, &surface(table, size, bed));
    let poured: Vec<[f64; D]> = split.iter().zip(source).map(|(shares, f)| shares.map(|c| f * c)).collect();
    equilibrium_along(table, size, bed, &poured)
}

/// The equilibrium for a source that is split along the axes already (cells, x fastest), as [`super::Ground::source`] is.
pub fn equilibrium_along<const D: usize>(
    table: &Table<D>,
    size: [f64; D],
    bed: &[f64],
    source: &[[f64; D]],
) -> Result<Equilibrium<D>, Unsteady<D>> {
    let fed = |place: usize| source[table.cell(place)].iter().sum::<f64>() > 0.0;
    check(table, size, bed, fed)?;
    let highest = surface(table, size, bed);
    let reached: Vec<f64> =
        highest.iter().zip(bed).map(|(s, b)| if s.is_finite() { *s } else { *b }).collect();
    let mut poured = vec![[0.0; D]; table.size()];
    for place in table.places() {
        poured[place] = source[table.cell(place)];
    }
    let slope = Slope { table, size, surface: &reached, source: &poured };
    let rolling = slope.carry()?;

    let fastest = rolling.v.iter().copied().fold(0.0, f64::max);
    let carries = |place: usize| rolling.v[place] > CARRIES * fastest || fed(place);
    let mut determined = vec![false; table.size()];
    for place in table.places().filter(|place| carries(*place)) {
        for node in table.corners(place) {
            determined[node] = true;
        }
    }
    // The least surface falls away from the sand with slope one, down to the table.
    let fall = march(table, size, |node| determined[node].then(|| -reached[node]));
    let least = |node: usize| (-fall[node] - bed[node]).max(0.0);
    let touched = |node: usize| table.around(node).next().is_some();
    let area: f64 = size.iter().product();
    let outflow = table.open_edges().into_iter().map(|edge| {
        let flux = rolling.flux[table.place(edge.index)][edge.axis] * area / size[edge.axis];
        (edge, if edge.faces == crate::scheme::Side::Left { flux } else { -flux })
    });
    let mut v = vec![0.0; source.len()];
    for place in table.places() {
        v[table.cell(place)] = rolling.v[place];
    }
    Ok(Equilibrium {
        u: (0..table.size()).map(|node| if touched(node) { least(node) } else { 0.0 }).collect(),
        most: (0..table.size())
            .map(|node| if touched(node) { (highest[node] - bed[node]).max(0.0) } else { 0.0 })
            .collect(),
        v,
        determined,
        outflow: outflow.collect(),
        crests: rolling.crests.iter().map(|place| table.index(*place)).collect(),
    })
}

/// What stands against an equilibrium before any work is done.
fn check<const D: usize>(
    table: &Table<D>,
    size: [f64; D],
    bed: &[f64],
    fed: impl Fn(usize) -> bool,
) -> Result<(), Unsteady<D>> {
    for piece in table.pieces().iter().filter(|piece| piece.open_edges == 0) {
        if let Some(&cell) = piece.cells.iter().find(|cell| fed(table.place(**cell))) {
            return Err(Unsteady::Enclosed { cell });
        }
    }
    let (node, slope) = steepest(table, size, bed);
    if slope > 1.0 + 1e-9 { Err(Unsteady::Steep { node, slope }) } else { Ok(()) }
}

/// The highest surface that sand can lie in, s = b at open edges and |grad s| = 1 elsewhere (nodes, x fastest); infinite
/// beside the table and where no way leads to an open edge. On a level table s - b is the distance to the open edges.
pub fn surface<const D: usize>(table: &Table<D>, size: [f64; D], bed: &[f64]) -> Vec<f64> {
    march(table, size, |node| table.pinned(node).then(|| bed[node]))
}

/// Shares cos^2(theta), sin^2(theta) of the source along the axes (eq. 47), theta the direction of the transport ray, in
/// the cells, x fastest.
///
/// tan(theta) is the ratio of the mean upwind slopes of the `surface` at the cell's nodes, without their sign.
/// On the open square with f = 1/2 and 20, 40, 80 cells v then differs in L1 from the exact one by 5.4e-3, 1.5e-3, 3.8e-4, against
/// 4.4e-3, 1.2e-3, 3.1e-4 by the nearest side (eqs. 48, 49), which only a square has, and 4.6e-3, 1.3e-3, 3.3e-4 by the signed
/// slopes of the cell, which cancel on a ridge and send its sand along it instead of across.
pub fn rays<const D: usize>(table: &Table<D>, size: [f64; D], surface: &[f64]) -> Vec<[f64; D]> {
    let mut shares = vec![[1.0 / D as f64; D]; table.cells().iter().product()];
    let falls: Vec<[f64; D]> = (0..table.size())
        .map(|node| {
            let known = surface[node].is_finite() && !table.pinned(node);
            if known { upwind(table, size, surface, node) } else { [0.0; D] }
        })
        .collect();
    for place in table.places() {
        let squares: [f64; D] = core::array::from_fn(|axis| {
            let corner = |number: usize| falls[place + table.span(number)][axis];
            let sum = if D == 1 {
                corner(0) + corner(1)
            } else {
                (corner(0) + corner(3)) + (corner(1) + corner(2))
            };
            sum * sum
        });
        let whole: f64 = squares.iter().sum();
        if whole > 0.0 {
            shares[table.cell(place)] = squares.map(|part| part / whole);
        }
    }
    shares
}

/// The steepest rise of a height to a node where u is not given, and where.
pub fn steepest<const D: usize>(table: &Table<D>, size: [f64; D], height: &[f64]) -> ([usize; D], f64) {
    let mut most = (0, 0.0);
    for node in (0..table.size()).filter(|node| !table.pinned(*node)) {
        let slope = table.around(node).map(|(cell, corner)| {
            let fall = falls(table, size, height, cell, corner);
            fall.iter().map(|f| f * f).sum::<f64>().sqrt()
        });
        let slope = slope.fold(0.0, f64::max);
        if slope > most.1 {
            most = (node, slope);
        }
    }
    (table.index(most.0), most.1)
}

/// How a height falls from a node, the corner numbered `corner` of a cell, along the edges of the cell, 0 where it rises.
fn falls<const D: usize>(
    table: &Table<D>,
    size: [f64; D],
    height: &[f64],
    cell: usize,
    corner: usize,
) -> [f64; D] {
    let here = height[cell + table.span(corner)];
    core::array::from_fn(|k| ((here - height[cell + table.span(corner ^ (1 << k))]) / size[k]).max(0.0))
}

/// The steepest fall from a node along each axis.
fn upwind<const D: usize>(table: &Table<D>, size: [f64; D], height: &[f64], node: usize) -> [f64; D] {
    let mut most = [0.0_f64; D];
    for (cell, corner) in table.around(node) {
        let fall = falls(table, size, height, cell, corner);
        for axis in 0..D {
            most[axis] = most[axis].max(fall[axis]);
        }
    }
    most
}
