//! The table of a case: its cells and edges, its height and what lies on it at the start.

use super::fault::CaseError;
use super::grid::{Grid, Points};
use super::region::{Area, Region};
use super::{Axis, Case, Edge, table};
use granflow_model::hadeler_kuttler::table::{self as library, Table};

mod layers;

/// The table of a case of the model hadeler_kuttler; cells and nodes are numbered x fastest.
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

impl Case {
    /// The table of a case of the model hadeler_kuttler on a grid of dimension D, with its height and the layers at the
    /// start.
    ///
    /// # Errors
    /// [`CaseError`] for a grid of another dimension, a table without cells, a wall without an edge, a file that cannot be
    /// used, a table or a pile steeper than 1, a negative layer.
    pub fn table<const D: usize>(&self) -> Result<TablePlan<D>, CaseError> {
        let dimensions = |grid: &&Grid| if grid.y.is_some() { D == 2 } else { D == 1 };
        let Some(grid) = self.grid.as_ref().filter(dimensions) else {
            return Err(self.fault(
                "grid",
                format!("the case has no [grid] of {D} dimension{}", if D == 1 { "" } else { "s" }),
                "add grid.x, and grid.y for two dimensions",
            ));
        };
        let table = self.table.clone().unwrap_or_default();
        let mut plan = self.shape(grid, &table)?;
        self.lay(&table, &mut plan)?;
        Ok(plan)
    }

    /// Cells and edges.
    fn shape<const D: usize>(&self, grid: &Grid, table: &table::Table) -> Result<TablePlan<D>, CaseError> {
        let (centres, nodes) = (grid.centres(), grid.nodes());
        let width = grid.y.as_ref().map_or(f64::INFINITY, Axis::width).min(grid.x.width());
        let slack = 1e-9 * width;
        let mask = table.mask.as_ref().map(|mask| self.area("table.mask", mask, &centres)).transpose()?;
        let cuts = table.cut.iter().enumerate();
        let cuts: Vec<Area> = cuts
            .map(|(index, cut)| self.area(&format!("table.cut[{index}]"), cut, &centres))
            .collect::<Result<_, _>>()?;
        self.check_open(grid, table)?;
        let walls = table.wall.iter().enumerate();
        let walls: Vec<Area> = walls
            .map(|(index, wall)| self.area(&format!("table.wall[{index}].on"), &wall.on, &centres))
            .collect::<Result<_, _>>()?;

        let axes = [Some(&grid.x), grid.y.as_ref()];
        let place = |at: &dyn Fn(usize, &Axis) -> f64| {
            std::array::from_fn::<f64, 2, _>(|k| axes[k].map_or(0.0, |axis| at(k, axis)))
        };
        let belongs = |index: [usize; D]| {
            let centre = place(&|k, axis| axis.centre(index[k]));
            mask.as_ref().is_none_or(|mask| mask.holds(centre, slack))
                && !cuts.iter().any(|cut| cut.holds(centre, slack))
        };
        let midpoint = |edge: &library::Edge<D>| {
            let along = |k, axis: &Axis| {
                (if k == edge.axis { Axis::face } else { Axis::centre })(axis, edge.index[k])
            };
            place(&along)
        };
        let is_wall = |edge: &library::Edge<D>| {
            let open = table.open.as_ref().is_none_or(|open| open.contains(&Edge::of(edge)));
            !open || walls.iter().any(|wall| wall.holds(midpoint(edge), slack))
        };
        let cells = grid.cells();
        let built = Table::masked(std::array::from_fn(|k| cells[k]), belongs, is_wall);
        if built.count() == 0 {
            return Err(self.no_cells(table, cells, built.dropped()));
        }
        for (index, wall) in walls.iter().enumerate() {
            if !built.edges().any(|(edge, _)| wall.holds(midpoint(&edge), slack)) {
                return Err(self.fault(
                    &format!("table.wall[{index}].on"),
                    "no edge of the table has its midpoint there",
                    "a wall takes the edges of the table in a region: widen it by a cell, for instance on.box = [x0, x1, y0, y1]",
                ));
            }
        }
        let ends = |axis: &Axis| [axis.from, axis.to];
        let extent = [ends(&grid.x), grid.y.as_ref().map_or([f64::NEG_INFINITY, f64::INFINITY], ends)];
        let depth = |node: usize| {
            let at = nodes.at(node);
            let mask = mask.as_ref().map_or(f64::INFINITY, |mask| mask.depth(at));
            let depth = cuts.iter().fold(mask, |least, cut| least.min(-cut.depth(at)));
            let depth = depth.min(Area::Box(extent[0], extent[1]).depth(at));
            if depth.abs() > slack { depth.clamp(-width, width) } else { 0.0 }
        };
        let flat = mask.is_none() && cuts.is_empty();
        let rim = |node| if flat || !built.pinned(node) { 0.0 } else { depth(node) };
        Ok(TablePlan {
            height: (0..nodes.counts().iter().product()).map(rim).collect(),
            extent,
            standing: Vec::new(),
            rolling: Vec::new(),
            clipped: 0.0,
            table: built,
            centres,
            nodes,
            slack,
        })
    }

    /// Nothing is left of the table: its shape misses the cells, or each of them, `dropped`, ends at open edges all round.
    fn no_cells(&self, table: &table::Table, cells: [usize; 2], dropped: usize) -> CaseError {
        if dropped > 0 {
            let message = format!(
                "the table is one cell wide everywhere: on none of its {dropped} cells can sand stand"
            );
            return self.fault(
                "grid",
                message,
                "take more cells, grid.x.cells and grid.y.cells, or widen the table",
            );
        }
        let key = if table.mask.is_some() { "table.mask" } else { "table.cut" };
        self.fault(
            key,
            format!("none of the {} x {} cells belongs to the table", cells[0], cells[1]),
            "a cell belongs if its centre lies in the mask and in no cut; compare them with grid.x and grid.y",
        )
    }

    fn area(&self, key: &str, region: &Region, points: &Points) -> Result<Area, CaseError> {
        region.area(points, &self.folder()).map_err(|fault| self.part_fault(key, fault))
    }

    fn check_open(&self, grid: &Grid, table: &table::Table) -> Result<(), CaseError> {
        for (index, edge) in table.open.iter().flatten().enumerate() {
            if grid.y.is_none() && matches!(edge, Edge::Bottom | Edge::Top) {
                return Err(self.fault(
                    &format!("table.open[{index}]"),
                    format!("the grid has no y, so the table has no edge `{}`", edge.as_str()),
                    "allowed in one dimension: left, right, hole; or add grid.y",
                ));
            }
        }
        Ok(())
    }
}
