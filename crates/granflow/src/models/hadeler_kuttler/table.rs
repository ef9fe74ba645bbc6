//! The table of a growing sandpile: its nodes, holes, height and walls.

use super::MODEL;
use crate::model::{Domain, Model, Plane};
use std::borrow::Cow;
use std::sync::Arc;

/// The table of a growing sandpile: the standing layer stands on the nodes, the rolling layer in the cells.
///
/// One dimension has no `y_node` and no `wall_y`; x runs fastest everywhere.
#[derive(Debug, Clone, Default)]
pub struct TableDomain {
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

impl Domain for TableDomain {
    fn model(&self) -> &'static Model {
        &MODEL
    }

    fn nodes(&self) -> Option<[&[f64]; 2]> {
        Some([&self.x_node, &self.y_node])
    }

    fn fixed(&self) -> Vec<(&'static str, Cow<'_, [f64]>)> {
        let faces = |walls: &[bool]| walls.iter().map(|&wall| f64::from(wall)).collect();
        vec![
            ("table_height", self.height.as_slice().into()),
            ("wall_x", faces(&self.wall_x)),
            ("wall_y", faces(&self.wall_y)),
        ]
    }
}

impl TableDomain {
    /// The plane of cells with these centres on the table.
    ///
    /// # Panics
    /// In a debug build, if the parts of the table differ in length.
    #[must_use]
    pub fn plane(self, x: Vec<f64>, y: Vec<f64>) -> Plane {
        debug_assert!(self.fits(&x, &y), "the parts of the table differ in length");
        Plane { x, y, domain: Arc::new(self) }
    }

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

    /// [`TableDomain::blank`] of a part of a field of `length` numbers that begins with number `from`.
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

    /// The edges of the table in two dimensions, those with a wall or those without, as lines as long as they are
    /// straight.
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
    fn table() -> TableDomain {
        let mut wall_x = vec![false; 8];
        (wall_x[0], wall_x[4]) = (true, true);
        TableDomain {
            x_node: vec![0.0, 1.0, 2.0, 3.0],
            y_node: vec![0.0, 1.0, 2.0],
            inside: vec![true, true, true, true, true, false],
            wall_x,
            ..TableDomain::default()
        }
    }

    #[test]
    fn cells_and_nodes_beside_the_table_are_blank() {
        let (mut cells, mut nodes) = ([1.0; 6], [1.0; 12]);
        table().blank(&mut cells);
        table().blank(&mut nodes);
        let blank = |field: &[f64]| (0..field.len()).filter(|&k| field[k].is_nan()).collect::<Vec<_>>();
        assert_eq!((blank(&cells), blank(&nodes)), (vec![5], vec![11]));
        let line =
            TableDomain { x_node: vec![0.0, 1.0, 2.0], inside: vec![true, false], ..TableDomain::default() };
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
