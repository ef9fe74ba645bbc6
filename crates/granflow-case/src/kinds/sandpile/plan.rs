//! The table of a case: its cells and edges, its height and what lies on it at the start.

use super::{Edge, TableWords, Words};
use crate::fault::CaseError;
use crate::grid::{Axis, Grid, Points};
use crate::look::Look;
use crate::region::{Area, Region};
use granflow_model::hadeler_kuttler::table::{self as library, Table};

/// The table of a sandpile; cells and nodes are numbered x fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct TablePlan<const D: usize> {
    /// The centres of the cells of the grid.
    pub centres: Points,
    /// The corners of the cells of the grid, one more along each axis.
    pub nodes: Points,
    /// The cells and edges.
    pub table: Table<D>,
    /// Height b of the table at the nodes. Where a flat table of any shape ends at steps of cells, nodes of open edges stand
    /// as high as they lie within its true edge, or as low as they lie beyond: at slope 1 sand passes the true edge at 0.
    pub height: Vec<f64>,
    /// Standing layer u at the nodes at the start: 0 at open edges and where no cell of the table touches the node.
    pub standing: Vec<f64>,
    /// Rolling layer v in the cells at the start, 0 off the table.
    pub rolling: Vec<f64>,
    /// Largest standing layer that the case writes at a node of an open edge, where u = 0.
    pub clipped: f64,
    /// How far rounding may move a place: 1e-9 of a cell.
    pub(super) slack: f64,
    /// Low and high ends of the grid along x and y; infinite along an axis that it has not.
    extent: [[f64; 2]; 2],
}

impl<const D: usize> TablePlan<D> {
    /// Whether a cell of the grid belongs to the table.
    #[must_use]
    pub fn inside(&self, cell: usize) -> bool {
        self.table.inside(self.index(cell))
    }

    /// The index of a cell of the grid.
    pub(super) fn index(&self, cell: usize) -> [usize; D] {
        let counts = self.centres.counts();
        std::array::from_fn(|k| if k == 0 { cell % counts[0] } else { cell / counts[0] })
    }

    /// Whether bounds along x and y reach beyond the grid; an end at infinity means the grid's own.
    pub(super) fn reaches_beyond(&self, bounds: [[f64; 2]; 2]) -> bool {
        let over = |at: f64, [low, high]: [f64; 2]| {
            at.is_finite() && !(low - self.slack..=high + self.slack).contains(&at)
        };
        (0..D).any(|k| bounds[k].into_iter().any(|at| over(at, self.extent[k])))
    }
}

/// The regions that shape a table, with their files read.
struct Shape {
    mask: Option<Area>,
    cuts: Vec<Area>,
    walls: Vec<Area>,
    slack: f64,
}

impl Shape {
    fn read(look: &Look, table: &TableWords, grid: &Grid, centres: &Points) -> Result<Self, CaseError> {
        let area = |key: &str, region: &Region| {
            region.area(centres, look).map_err(|fault| look.part_fault(key, fault))
        };
        let mask = table.mask.as_ref().map(|mask| area("table.mask", mask)).transpose()?;
        let cuts = table.cut.iter().enumerate();
        let cuts =
            cuts.map(|(index, cut)| area(&format!("table.cut[{index}]"), cut)).collect::<Result<_, _>>()?;
        check_open(look, grid, table)?;
        let walls = table.wall.iter().enumerate();
        let walls = walls
            .map(|(index, wall)| area(&format!("table.wall[{index}].on"), &wall.on))
            .collect::<Result<_, _>>()?;
        let width = grid.axes().map(Axis::width).fold(f64::INFINITY, f64::min);
        Ok(Self { mask, cuts, walls, slack: 1e-9 * width })
    }

    /// Whether the table has a cell with this centre.
    fn holds(&self, centre: [f64; 2]) -> bool {
        self.mask.as_ref().is_none_or(|mask| mask.holds(centre, self.slack))
            && !self.cuts.iter().any(|cut| cut.holds(centre, self.slack))
    }

    /// Distance of a place from the true edge of the table, positive within, at most a cell.
    fn depth(&self, at: [f64; 2], extent: [[f64; 2]; 2], width: f64) -> f64 {
        let mask = self.mask.as_ref().map_or(f64::INFINITY, |mask| mask.depth(at));
        let depth = self.cuts.iter().fold(mask, |least, cut| least.min(-cut.depth(at)));
        let depth = depth.min(Area::Box(extent[0], extent[1]).depth(at));
        if depth.abs() > self.slack { depth.clamp(-width, width) } else { 0.0 }
    }
}

/// Place of the midpoint of an edge.
fn midpoint<const D: usize>(grid: &Grid, edge: &library::Edge<D>) -> [f64; 2] {
    let mut place = [0.0; 2];
    for (k, axis) in grid.axes().enumerate().take(D) {
        place[k] = (if k == edge.axis { Axis::face } else { Axis::centre })(axis, edge.index[k]);
    }
    place
}

impl Words {
    /// The table with its height and the layers at the start.
    ///
    /// # Errors
    /// [`CaseError`] for a table without cells, a wall without an edge, a file that cannot be used, a table or a pile
    /// steeper than 1, a negative layer.
    pub(super) fn table<const D: usize>(&self, look: &Look) -> Result<TablePlan<D>, CaseError> {
        let table = self.table.clone().unwrap_or_default();
        let mut plan = shape(look, &self.grid, &table)?;
        self.lay(look, &table, &mut plan)?;
        Ok(plan)
    }
}

/// Cells and edges.
fn shape<const D: usize>(look: &Look, grid: &Grid, table: &TableWords) -> Result<TablePlan<D>, CaseError> {
    let (centres, nodes) = (grid.centres(), grid.nodes());
    let shape = Shape::read(look, table, grid, &centres)?;
    let cells = grid.cells();
    let belongs = |index: [usize; D]| {
        let number = index.iter().rev().fold(0, |row, k| row * cells[0] + k);
        shape.holds(centres.at(number))
    };
    let is_wall = |edge: &library::Edge<D>| {
        let open = table.open.as_ref().is_none_or(|open| open.contains(&Edge::of(edge)));
        !open || shape.walls.iter().any(|wall| wall.holds(midpoint(grid, edge), shape.slack))
    };
    let built = Table::masked(std::array::from_fn(|k| cells[k]), belongs, is_wall);
    if built.count() == 0 {
        return Err(no_cells(look, table, cells, built.dropped()));
    }
    for (index, wall) in shape.walls.iter().enumerate() {
        if !built.edges().any(|(edge, _)| wall.holds(midpoint(grid, &edge), shape.slack)) {
            return Err(look.fault(
                &format!("table.wall[{index}].on"),
                "no edge of the table has its midpoint there",
                "a wall takes the edges of the table in a region: widen it by a cell, for instance on.box = [x0, x1, y0, y1]",
            ));
        }
    }
    let mut extent = [[f64::NEG_INFINITY, f64::INFINITY]; 2];
    grid.axes().zip(&mut extent).for_each(|(axis, ends)| *ends = [axis.from, axis.to]);
    let width = grid.axes().map(Axis::width).fold(f64::INFINITY, f64::min);
    let flat = shape.mask.is_none() && shape.cuts.is_empty();
    let rim = |node| {
        if flat || !built.pinned(node) { 0.0 } else { shape.depth(nodes.at(node), extent, width) }
    };
    Ok(TablePlan {
        height: (0..nodes.counts().iter().product()).map(rim).collect(),
        extent,
        standing: Vec::new(),
        rolling: Vec::new(),
        clipped: 0.0,
        table: built,
        centres,
        nodes,
        slack: shape.slack,
    })
}

/// Nothing is left of the table: its shape misses the cells, or each of them, `dropped`, ends at open edges all round.
fn no_cells(look: &Look, table: &TableWords, cells: [usize; 2], dropped: usize) -> CaseError {
    if dropped > 0 {
        let message =
            format!("the table is one cell wide everywhere: sand can stand on none of its {dropped} cells");
        return look.fault(
            "grid",
            message,
            "take more cells, grid.x.cells and grid.y.cells, or widen the table",
        );
    }
    let key = if table.mask.is_some() { "table.mask" } else { "table.cut" };
    look.fault(
        key,
        format!("none of the {} x {} cells belongs to the table", cells[0], cells[1]),
        "a cell belongs if its centre lies in the mask and in no cut; compare them with grid.x and grid.y",
    )
}

fn check_open(look: &Look, grid: &Grid, table: &TableWords) -> Result<(), CaseError> {
    for (index, edge) in table.open.iter().flatten().enumerate() {
        if grid.y.is_none() && matches!(edge, Edge::Bottom | Edge::Top) {
            return Err(look.fault(
                &format!("table.open[{index}]"),
                format!("the grid has no y, so the table has no edge `{}`", edge.as_str()),
                "allowed in one dimension: left, right, hole; or add grid.y",
            ));
        }
    }
    Ok(())
}
