//! The table of a case in plain numbers: its cells, holes and edges, its height and what lies on it at the start.

use super::Case;
use super::fault::CaseError;
use super::grid::{Grid, Points};
use super::region::{Area, Region};
use super::table::{Edge, Table};

mod layers;
mod pieces;

use pieces::pieces;

/// The table of a case of the model hadeler_kuttler; cells and nodes are numbered x fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct TablePlan {
    /// The centres of the cells of the grid.
    pub centres: Points,
    /// The corners of the cells of the grid, one more along each axis.
    pub nodes: Points,
    /// Whether a cell belongs to the table.
    pub inside: Vec<bool>,
    /// Whether a cell lies in a hole: not of the table, and enclosed by it.
    pub hole: Vec<bool>,
    /// Every edge of the table.
    pub edges: Vec<TableEdge>,
    /// Number of pieces: cells of the table that share a face are of one piece.
    pub pieces: usize,
    /// Height b of the table at the nodes.
    pub height: Vec<f64>,
    /// Standing layer u at the nodes at the start: 0 at open edges and where no cell of the table touches the node.
    pub standing: Vec<f64>,
    /// Rolling layer v in the cells at the start, 0 off the table.
    pub rolling: Vec<f64>,
    /// Largest standing layer that the case writes at a node of an open edge, where u = 0.
    pub clipped: f64,
    /// Piece of each cell, from 0.
    pub(super) piece: Vec<Option<usize>>,
    /// How far rounding may move a place: 1e-9 of a cell.
    pub(super) slack: f64,
    /// Low and high ends of the grid along x and y.
    extent: [[f64; 2]; 2],
    /// The kinds of edges that are open; all if `None`.
    open: Option<Vec<Edge>>,
    /// Where open edges are walls all the same.
    walls: Vec<Area>,
}

/// A face of the grid with the table on one side only.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TableEdge {
    /// The axis it is normal to, 0 for x.
    pub axis: usize,
    /// Its face: along `axis` the number of the face, from 0 to the number of cells; along the other that of the cell.
    pub face: [usize; 2],
    /// The cell of the table beside it.
    pub cell: usize,
    /// The side it faces, or that it is of a hole.
    pub kind: Edge,
    /// Its midpoint.
    pub midpoint: [f64; 2],
    /// Whether it is a wall; else it is open.
    pub wall: bool,
}

impl TableEdge {
    /// Index of its two ends (twice the same in one dimension) among nodes of which a row holds `row`.
    pub(super) fn nodes(&self, row: usize, plane: bool) -> [usize; 2] {
        let low = self.face[1] * row + self.face[0];
        let along = if self.axis == 0 { row } else { 1 };
        [low, if plane { low + along } else { low }]
    }
}

impl TablePlan {
    /// Whether an edge of this kind with this midpoint is a wall.
    #[must_use]
    pub fn wall(&self, kind: Edge, midpoint: [f64; 2]) -> bool {
        let open = self.open.as_ref().is_none_or(|open| open.contains(&kind));
        !open || self.walls.iter().any(|wall| wall.holds(midpoint, self.slack))
    }

    /// Whether a node ends an open edge: u = 0 there.
    #[must_use]
    pub fn open_nodes(&self) -> Vec<bool> {
        let [row, _] = self.nodes.counts();
        let mut open = vec![false; row * self.nodes.counts()[1]];
        for edge in self.edges.iter().filter(|edge| !edge.wall) {
            edge.nodes(row, self.nodes.y.is_some()).into_iter().for_each(|node| open[node] = true);
        }
        open
    }

    /// Whether no edge of a piece is open, for each piece.
    pub(super) fn walled_in(&self) -> Vec<bool> {
        let mut walled = vec![true; self.pieces];
        for edge in self.edges.iter().filter(|edge| !edge.wall) {
            if let Some(piece) = self.piece[edge.cell] {
                walled[piece] = false;
            }
        }
        walled
    }

    /// Whether bounds along x and y reach beyond the grid; an end at infinity means the grid's own.
    pub(super) fn reaches_beyond(&self, bounds: [[f64; 2]; 2]) -> bool {
        let axes = if self.centres.y.is_some() { 2 } else { 1 };
        let over = |at: f64, [low, high]: [f64; 2]| {
            at.is_finite() && !(low - self.slack..=high + self.slack).contains(&at)
        };
        (0..axes).any(|k| bounds[k].into_iter().any(|at| over(at, self.extent[k])))
    }
}

impl Case {
    /// The table of a case of the model hadeler_kuttler, with its height and the layers at the start.
    ///
    /// # Errors
    /// [`CaseError`] for a table without cells, a wall without an edge, a file that cannot be used, a table or a pile
    /// steeper than 1, a negative layer.
    pub fn table(&self) -> Result<TablePlan, CaseError> {
        let Some(grid) = &self.grid else {
            return Err(self.fault(
                "grid",
                "the case has no [grid]",
                "add grid.x, and grid.y for two dimensions",
            ));
        };
        let table = self.table.clone().unwrap_or_default();
        let mut plan = self.shape(grid, &table)?;
        plan.edges = edges(grid, &plan);
        for (index, wall) in plan.walls.iter().enumerate() {
            if !plan.edges.iter().any(|edge| wall.holds(edge.midpoint, plan.slack)) {
                return Err(self.fault(
                    &format!("table.wall[{index}].on"),
                    "no edge of the table has its midpoint there",
                    "a wall takes the edges of the table in a region: widen it by a cell, for instance on.box = [x0, x1, y0, y1]",
                ));
            }
        }
        self.lay(&table, &mut plan)?;
        Ok(plan)
    }

    /// Cells, holes and pieces.
    fn shape(&self, grid: &Grid, table: &Table) -> Result<TablePlan, CaseError> {
        let (centres, nodes) = (grid.centres(), grid.nodes());
        let width = grid.y.as_ref().map_or(f64::INFINITY, super::Axis::width).min(grid.x.width());
        let slack = 1e-9 * width;
        let mask = table.mask.as_ref().map(|mask| self.area("table.mask", mask, &centres)).transpose()?;
        let cuts = table.cut.iter().enumerate();
        let cuts: Vec<Area> = cuts
            .map(|(index, cut)| self.area(&format!("table.cut[{index}]"), cut, &centres))
            .collect::<Result<_, _>>()?;
        let belongs = |place| {
            mask.as_ref().is_none_or(|mask| mask.holds(place, slack))
                && !cuts.iter().any(|cut| cut.holds(place, slack))
        };
        let inside: Vec<bool> = centres.iter().map(belongs).collect();
        if !inside.contains(&true) {
            let key = if mask.is_some() { "table.mask" } else { "table.cut" };
            let cells = grid.cells();
            return Err(self.fault(
                key,
                format!("none of the {} x {} cells belongs to the table", cells[0], cells[1]),
                "a cell belongs if its centre lies in the mask and in no cut; compare them with grid.x and grid.y",
            ));
        }
        let cells = grid.cells();
        let (piece, count) = pieces(cells, |cell| inside[cell], false);
        let (gap, gaps) = pieces(cells, |cell| !inside[cell], true);
        let mut enclosed = vec![true; gaps];
        for (cell, gap) in gap.iter().enumerate() {
            let [i, j] = [cell % cells[0], cell / cells[0]];
            let rim = i == 0 || i + 1 == cells[0] || (cells[1] > 1 && (j == 0 || j + 1 == cells[1]));
            if let Some(gap) = gap
                && rim
            {
                enclosed[*gap] = false;
            }
        }
        self.check_open(grid, table)?;
        let walls = table.wall.iter().enumerate();
        let walls = walls
            .map(|(index, wall)| self.area(&format!("table.wall[{index}].on"), &wall.on, &centres))
            .collect::<Result<_, _>>()?;
        let ends = |axis: &super::Axis| [axis.from, axis.to];
        Ok(TablePlan {
            hole: gap.iter().map(|gap| gap.is_some_and(|gap| enclosed[gap])).collect(),
            extent: [ends(&grid.x), grid.y.as_ref().map_or([0.0; 2], ends)],
            height: Vec::new(),
            standing: Vec::new(),
            rolling: Vec::new(),
            edges: Vec::new(),
            clipped: 0.0,
            open: table.open.clone(),
            walls,
            pieces: count,
            centres,
            nodes,
            inside,
            piece,
            slack,
        })
    }

    fn area(&self, key: &str, region: &Region, points: &Points) -> Result<Area, CaseError> {
        region.area(points, &self.folder()).map_err(|fault| self.part_fault(key, fault))
    }

    fn check_open(&self, grid: &Grid, table: &Table) -> Result<(), CaseError> {
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

/// The faces with the table on one side only.
fn edges(grid: &Grid, plan: &TablePlan) -> Vec<TableEdge> {
    let cells = grid.cells();
    let axes = [Some(&grid.x), grid.y.as_ref()];
    let belongs = |at: [Option<usize>; 2]| match at {
        [Some(i), Some(j)] if i < cells[0] && j < cells[1] => Some(j * cells[0] + i),
        _ => None,
    };
    let mut edges = Vec::new();
    for (axis, along) in axes.iter().enumerate().filter_map(|(axis, along)| along.map(|along| (axis, along)))
    {
        let counts = [cells[0] + usize::from(axis == 0), cells[1] + usize::from(axis == 1)];
        for face in (0..counts[1]).flat_map(|j| (0..counts[0]).map(move |i| [i, j])) {
            let mut below = face.map(Some);
            below[axis] = face[axis].checked_sub(1);
            let sides = [belongs(below), belongs(face.map(Some))];
            let table = sides.map(|side| side.filter(|cell| plan.inside[*cell]));
            // the table lies below the face or above it, which then faces up or down
            let (cell, other, up) = match table {
                [Some(cell), None] => (cell, sides[1], true),
                [None, Some(cell)] => (cell, sides[0], false),
                _ => continue,
            };
            let kind = Edge::facing(axis, up, other.is_some_and(|other| plan.hole[other]));
            let mut midpoint = plan.centres.at(cell);
            midpoint[axis] = along.face(face[axis]);
            edges.push(TableEdge { axis, face, cell, kind, midpoint, wall: plan.wall(kind, midpoint) });
        }
    }
    edges
}
