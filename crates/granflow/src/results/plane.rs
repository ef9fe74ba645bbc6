//! Where a run took place: its cells, and what lies under them.

use crate::grid::Grid;
use crate::output::frames::Field;
use crate::raster::Raster;
use crate::release::Sparse;
use std::sync::Arc;

/// Where the cells lie, and what lies under them.
#[derive(Debug, Clone)]
pub struct Plane {
    /// Cell centres along x.
    pub x: Vec<f64>,
    /// Cell centres along y; empty in one dimension.
    pub y: Vec<f64>,
    /// What lies under the cells, and with it the model.
    pub under: Under,
    /// Released thickness normal to the bed on a mountain, thickness at the start on a chute; empty on a table.
    pub release: Sparse,
}

/// What lies under the cells.
#[derive(Debug, Clone)]
pub enum Under {
    /// A chute in the papers' scaling.
    Chute,
    /// A mountain; lengths are metres, times seconds. While a run computes, its grounds hold the elevation and the raster has no
    /// values: see [`Plane::with_bed`].
    Mountain(Arc<Raster>),
    /// The table of a growing sandpile, in the papers' scaling.
    Table(Table),
}

/// The table of a growing sandpile: the standing layer lies on the nodes, the rolling layer in the cells.
///
/// One dimension has no `y_node` and no `wall_y`; x runs fastest everywhere.
#[derive(Debug, Clone, Default)]
pub struct Table {
    /// Nodes along x, one more than cells.
    pub x_node: Vec<f64>,
    /// Nodes along y, one more than cells; empty in one dimension.
    pub y_node: Vec<f64>,
    /// Which cells belong to the table.
    pub inside: Vec<bool>,
    /// Height b of the table at its nodes; empty where it is flat.
    pub height: Vec<f64>,
    /// Walls among the faces across x: as many as nodes along x, in rows of cells; empty where there is none.
    pub wall_x: Vec<bool>,
    /// Walls among the faces across y: as many as cells along x, in rows of nodes; empty where there is none.
    pub wall_y: Vec<bool>,
}

impl Plane {
    /// The cells of a grid, with what lies under them and what was released.
    #[must_use]
    pub fn of<const D: usize>(grid: &Grid<D>, under: Under, release: Sparse) -> Plane {
        let centres = |axis: usize| {
            let along = |i: usize| grid.centre([i; D])[axis];
            (0..grid.cells[axis]).map(along).collect::<Vec<f64>>()
        };
        Plane { x: centres(0), y: if D > 1 { centres(1) } else { Vec::new() }, under, release }
    }

    /// A table with these cell centres.
    #[must_use]
    pub fn table(x: Vec<f64>, y: Vec<f64>, table: Table) -> Plane {
        debug_assert!(table.fits(&x, &y), "the parts of the table differ in length");
        Plane { x, y, under: Under::Table(table), release: Sparse::default() }
    }

    /// The same plane with the elevation of its cells, if it is a mountain.
    #[must_use]
    pub fn with_bed(mut self, elevation: impl FnOnce() -> Vec<f64>) -> Plane {
        if let Under::Mountain(bed) = &mut self.under {
            *bed = Arc::new(bed.with_values(elevation()));
        }
        self
    }

    /// The elevation model, on a mountain.
    #[must_use]
    pub fn mountain(&self) -> Option<&Raster> {
        match &self.under {
            Under::Mountain(bed) => Some(bed),
            _ => None,
        }
    }

    /// The table, if it is one.
    #[must_use]
    pub fn as_table(&self) -> Option<&Table> {
        match &self.under {
            Under::Table(table) => Some(table),
            _ => None,
        }
    }

    /// Is it a mountain?
    #[must_use]
    pub fn is_terrain(&self) -> bool {
        self.mountain().is_some()
    }

    /// Bed elevation of every cell \[m\], on a mountain.
    #[must_use]
    pub fn bed(&self) -> Option<&[f64]> {
        self.mountain().map(|raster| raster.values.as_slice())
    }

    /// The quantities that are kept as series, in the order of the frames.
    #[must_use]
    pub fn series(&self) -> Vec<Field> {
        let cells = self.x.len() * self.y.len().max(1);
        let field = |name: &str, length| Field { name: name.to_owned(), length };
        if let Some(table) = self.as_table() {
            return vec![field("standing_layer", table.nodes()), field("rolling_layer", cells)];
        }
        let mut names = vec!["thickness", "velocity_x"];
        if !self.y.is_empty() {
            names.push("velocity_y");
        }
        if self.is_terrain() {
            names.extend(["surface", "speed"]);
        }
        names.into_iter().map(|name| field(name, cells)).collect()
    }

    /// Where mass can leave, in the order of the books: over the four sides, and inside them.
    #[must_use]
    pub fn outlets(&self) -> [&'static str; 5] {
        let within = if self.as_table().is_some() { "hole" } else { "nodata" };
        ["left", "right", "bottom", "top", within]
    }
}

impl Table {
    /// Number of nodes.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.x_node.len() * self.y_node.len().max(1)
    }

    /// Cells along x and y; 1 along y in one dimension.
    fn cells(&self) -> [usize; 2] {
        [self.x_node.len() - 1, self.y_node.len().max(2) - 1]
    }

    /// Do all parts fit each other and the cells with these centres?
    pub(super) fn fits(&self, x: &[f64], y: &[f64]) -> bool {
        let rows = y.len().max(1);
        let optional = |length: usize, expected: usize| length == 0 || length == expected;
        self.x_node.len() == x.len() + 1
            && self.y_node.len() == if y.is_empty() { 0 } else { y.len() + 1 }
            && self.inside.len() == x.len() * rows
            && optional(self.height.len(), self.nodes())
            && optional(self.wall_x.len(), self.x_node.len() * rows)
            && optional(self.wall_y.len(), x.len() * self.y_node.len())
    }

    /// Does the cell belong to the table? Those beyond its grid do not.
    fn holds(&self, column: Option<usize>, row: Option<usize>) -> bool {
        let [columns, rows] = self.cells();
        matches!((column, row), (Some(i), Some(j)) if i < columns && j < rows && self.inside[j * columns + i])
    }

    /// NaN stands in cells beside the table and at nodes that touch none of its cells.
    pub fn blank(&self, field: &mut [f64]) {
        self.blank_part(field.len(), 0, field);
    }

    /// [`Table::blank`] of a part of a field of `length` numbers that begins with number `from`.
    pub(crate) fn blank_part(&self, length: usize, from: usize, part: &mut [f64]) {
        let [columns, rows] = self.cells();
        if length == columns * rows {
            let beside = part.iter_mut().zip(&self.inside[from..]).filter(|(_, inside)| !**inside);
            return beside.for_each(|(value, _)| *value = f64::NAN);
        }
        let wide = self.x_node.len();
        for (k, value) in (from..).zip(part) {
            let (i, j) = (k % wide, k / wide);
            let below = if self.y_node.is_empty() { Some(0) } else { j.checked_sub(1) };
            let touches = [
                (i.checked_sub(1), below),
                (Some(i), below),
                (i.checked_sub(1), Some(j)),
                (Some(i), Some(j)),
            ];
            if !touches.into_iter().any(|(i, j)| self.holds(i, j)) {
                *value = f64::NAN;
            }
        }
    }

    /// The surface u + b.
    #[must_use]
    pub fn surface(&self, standing: &[f64]) -> Vec<f64> {
        if self.height.is_empty() {
            return standing.to_vec();
        }
        standing.iter().zip(&self.height).map(|(u, b)| u + b).collect()
    }

    /// The edges of the table in two dimensions, those with a wall or those without, as lines as long as they are straight.
    #[must_use]
    pub fn edges(&self, walls: bool) -> Vec<[[f64; 2]; 2]> {
        if self.y_node.is_empty() {
            return Vec::new();
        }
        let [columns, rows] = self.cells();
        let wall = |faces: &[bool], k: usize| faces.get(k).copied().unwrap_or(false) == walls;
        let across_x = |i: usize, j: usize| {
            self.holds(i.checked_sub(1), Some(j)) != self.holds(Some(i), Some(j))
                && wall(&self.wall_x, j * (columns + 1) + i)
        };
        let across_y = |i: usize, j: usize| {
            self.holds(Some(i), j.checked_sub(1)) != self.holds(Some(i), Some(j))
                && wall(&self.wall_y, j * columns + i)
        };
        let mut lines = Vec::new();
        for (i, &x) in self.x_node.iter().enumerate() {
            let run = runs(rows, |j| across_x(i, j));
            lines.extend(run.map(|[from, to]| [[x, self.y_node[from]], [x, self.y_node[to]]]));
        }
        for (j, &y) in self.y_node.iter().enumerate() {
            let run = runs(columns, |i| across_y(i, j));
            lines.extend(run.map(|[from, to]| [[self.x_node[from], y], [self.x_node[to], y]]));
        }
        lines
    }
}

/// The longest stretches of `0..count` in which `holds`, as [first, one past the last].
fn runs(count: usize, holds: impl Fn(usize) -> bool) -> impl Iterator<Item = [usize; 2]> {
    let mut stretches: Vec<[usize; 2]> = Vec::new();
    for k in (0..count).filter(|&k| holds(k)) {
        match stretches.last_mut() {
            Some(last) if last[1] == k => last[1] = k + 1,
            _ => stretches.push([k, k + 1]),
        }
    }
    stretches.into_iter()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three by two cells, the one in the upper right corner beside the table, a wall at the left.
    fn table() -> Table {
        let mut wall_x = vec![false; 8];
        (wall_x[0], wall_x[4]) = (true, true);
        Table {
            x_node: vec![0.0, 1.0, 2.0, 3.0],
            y_node: vec![0.0, 1.0, 2.0],
            inside: vec![true, true, true, true, true, false],
            wall_x,
            ..Table::default()
        }
    }

    #[test]
    fn cells_and_nodes_beside_the_table_are_blank() {
        let (mut cells, mut nodes) = ([1.0; 6], [1.0; 12]);
        table().blank(&mut cells);
        table().blank(&mut nodes);
        let blank = |field: &[f64]| (0..field.len()).filter(|&k| field[k].is_nan()).collect::<Vec<_>>();
        assert_eq!((blank(&cells), blank(&nodes)), (vec![5], vec![11]));
        let line = Table { x_node: vec![0.0, 1.0, 2.0], inside: vec![true, false], ..Table::default() };
        let mut nodes = [1.0; 3];
        line.blank(&mut nodes);
        assert_eq!(blank(&nodes), [2]);
    }

    #[test]
    fn edges_are_walls_or_open_and_go_once_around() {
        let (walls, open) = (table().edges(true), table().edges(false));
        assert_eq!(walls, [[[0.0, 0.0], [0.0, 2.0]]]);
        let length = |lines: &[[[f64; 2]; 2]]| -> f64 {
            lines.iter().map(|[a, b]| (a[0] - b[0]).abs() + (a[1] - b[1]).abs()).sum()
        };
        assert_eq!((length(&open), open.len()), (8.0, 5));
    }
}
