//! The staircase of faces nearest to a line: what passes it is counted at faces, which a slanting line cuts.

use crate::model::Plane;
use crate::run::Face;

/// The corners of the cells; in one dimension the faces.
#[derive(Debug, Clone, Copy)]
pub(super) struct Nodes {
    low: [f64; 2],
    size: [f64; 2],
    /// Cells along each axis.
    count: [usize; 2],
    dimensions: usize,
}

impl Nodes {
    pub fn of(plane: &Plane) -> Nodes {
        let along = |centres: &[f64]| {
            let size = (centres[centres.len() - 1] - centres[0]) / (centres.len() - 1) as f64;
            (centres[0] - 0.5 * size, size)
        };
        let (x, y) = (along(&plane.x), if plane.y.is_empty() { (0.0, 1.0) } else { along(&plane.y) });
        Nodes {
            low: [x.0, y.0],
            size: [x.1, y.1],
            count: [plane.x.len(), plane.y.len().max(1)],
            dimensions: plane.dimensions(),
        }
    }

    /// The ends of the grid along x and y.
    pub fn ends(&self) -> [[f64; 2]; 2] {
        [0, 1].map(|k| [self.low[k], self.low[k] + self.count[k] as f64 * self.size[k]])
    }

    /// Where a place is, counted in cells from the lower ends.
    fn counted(&self, place: &[f64]) -> [f64; 2] {
        [0, 1].map(|k| place.get(k).map_or(0.0, |at| (at - self.low[k]) / self.size[k]))
    }

    /// The cell that a place lies in, one of two where it is on their face; the grid's outer edge belongs to it.
    pub fn cell(&self, place: &[f64]) -> Option<usize> {
        /// The ends follow from the centres of the cells, to rounding.
        const ROUNDING: f64 = 1e-9;
        let at = self.counted(place);
        let within = (0..2).all(|k| (-ROUNDING..=self.count[k] as f64 + ROUNDING).contains(&at[k]));
        let [i, j] = [0, 1].map(|k| (at[k] as usize).min(self.count[k] - 1));
        within.then_some(j * self.count[0] + i)
    }

    /// The corner nearest to a place.
    fn node(&self, place: &[f64]) -> [isize; 2] {
        let at = self.counted(place);
        [0, 1].map(|k| at[k].round().clamp(0.0, self.count[k] as f64) as isize)
    }

    /// The cells beside a face that are on the grid.
    pub fn beside(&self, face: Face) -> impl Iterator<Item = usize> + use<> {
        let Nodes { count, .. } = *self;
        let there = move |[i, j]: [isize; 2]| {
            let within = (0..count[0] as isize).contains(&i) && (0..count[1] as isize).contains(&j);
            within.then(|| j as usize * count[0] + i as usize)
        };
        let [i, j] = face.cell;
        let next = if face.axis == 0 { [i + 1, j] } else { [i, j + 1] };
        [[i, j], next].into_iter().filter_map(there)
    }
}

/// The faces of the staircase from the corner nearest to the first point to that nearest to the last, past those nearest to the
/// points between; each with 1 where what crosses the line from its left to its right goes towards larger coordinates, else
/// -1. What is walked there and back again is left out. In one dimension it is the face nearest to the point, and left is the
/// side of smaller coordinates.
pub(super) fn stairs(points: &[Vec<f64>], nodes: &Nodes) -> Vec<(Face, f64)> {
    if nodes.dimensions == 1 {
        let [i, _] = points.first().map_or([0; 2], |point| nodes.node(point));
        return vec![(Face { cell: [i - 1, 0], axis: 0 }, 1.0)];
    }
    let mut faces: Vec<(Face, f64)> = Vec::new();
    for pair in points.windows(2) {
        let ends = [nodes.node(&pair[0]), nodes.node(&pair[1])];
        for step in steps(ends, [nodes.counted(&pair[0]), nodes.counted(&pair[1])]) {
            match faces.iter().position(|(face, way)| *face == step.0 && *way == -step.1) {
                Some(back) => drop(faces.remove(back)),
                None => faces.push(step),
            }
        }
    }
    faces
}

/// The faces walked along from one corner to another, each step to the neighbour that stays nearer to the line.
fn steps([from, to]: [[isize; 2]; 2], line: [[f64; 2]; 2]) -> Vec<(Face, f64)> {
    let way = [0, 1].map(|k| (to[k] - from[k]).signum());
    let edge = [line[1][0] - line[0][0], line[1][1] - line[0][1]];
    let off = |node: [isize; 2]| {
        let at = [node[0] as f64 - line[0][0], node[1] as f64 - line[0][1]];
        (at[0] * edge[1] - at[1] * edge[0]).abs()
    };
    let (mut node, mut faces) = (from, Vec::new());
    while node != to {
        let along = |k: usize| {
            let mut next = node;
            next[k] += way[k];
            (node[k] != to[k]).then_some((k, next))
        };
        let (axis, next) = match (along(0), along(1)) {
            (Some(x), Some(y)) => {
                if off(x.1) <= off(y.1) {
                    x
                } else {
                    y
                }
            }
            (x, y) => match x.or(y) {
                Some(only) => only,
                None => break,
            },
        };
        let [i, j] = [node[0].min(next[0]), node[1].min(next[1])];
        // Eastward the left is in the north, and what goes to the right goes south; northward it is in the west.
        faces.push(match axis {
            0 => (Face { cell: [i, j - 1], axis: 1 }, if way[0] > 0 { -1.0 } else { 1.0 }),
            _ => (Face { cell: [i - 1, j], axis: 0 }, if way[1] > 0 { 1.0 } else { -1.0 }),
        });
        node = next;
    }
    faces
}

#[cfg(test)]
mod tests {
    use super::*;

    const NODES: Nodes = Nodes { low: [10.0, 20.0], size: [2.0, 1.0], count: [6, 8], dimensions: 2 };

    /// Net passage of a uniform flow (u, v) through faces of this length.
    fn passing(faces: &[(Face, f64)], flow: [f64; 2]) -> f64 {
        faces.iter().map(|(face, way)| way * flow[face.axis] * NODES.size[1 - face.axis]).sum()
    }

    #[test]
    fn a_uniform_flow_passes_stairs_as_it_passes_the_line_between_their_ends() {
        let line = |points: &[[f64; 2]]| points.iter().map(|point| point.to_vec()).collect::<Vec<_>>();
        for points in [
            line(&[[10.0, 20.0], [22.0, 28.0]]),
            line(&[[20.0, 21.0], [12.0, 27.0]]),
            line(&[[14.0, 22.0], [14.0, 26.0], [20.0, 23.0]]),
        ] {
            let (first, last) = (&points[0], &points[points.len() - 1]);
            let edge = [last[0] - first[0], last[1] - first[1]];
            for flow in [[1.0, 0.0], [0.3, -2.0]] {
                // The right of (a, b) is (b, -a).
                let exact = flow[0] * edge[1] - flow[1] * edge[0];
                let found = passing(&stairs(&points, &NODES), flow);
                assert!((found - exact).abs() < 1e-12, "{points:?} {flow:?}: {found} {exact}");
            }
        }
    }

    #[test]
    fn a_ring_to_the_left_counts_what_leaves_and_nothing_of_a_uniform_flow() {
        let ring = [[12.0, 21.0], [18.0, 21.0], [18.0, 25.0], [12.0, 25.0], [12.0, 21.0]].map(|p| p.to_vec());
        let faces = stairs(&ring, &NODES);
        assert_eq!(faces.len(), 2 * (3 + 4));
        assert!(passing(&faces, [0.7, -1.3]).abs() < 1e-12, "but for rounding");
        // The eastern face counts what goes east.
        assert!(faces.contains(&(Face { cell: [3, 2], axis: 0 }, 1.0)));
        let back = [[12.0, 21.0], [18.0, 21.0], [12.0, 21.0]].map(|p| p.to_vec());
        assert!(stairs(&back, &NODES).is_empty());
    }

    #[test]
    fn places_have_cells_and_the_edge_belongs_to_the_grid() {
        assert_eq!(NODES.cell(&[10.0, 20.0]), Some(0));
        assert_eq!(NODES.cell(&[22.0, 28.0]), Some(47));
        assert_eq!(NODES.cell(&[13.9, 21.0]), Some(7));
        assert_eq!(NODES.cell(&[22.1, 21.0]), None);
        let edge = stairs(&[vec![10.0, 20.0], vec![10.0, 28.0]], &NODES);
        assert_eq!(edge.len(), 8);
        assert_eq!(NODES.beside(edge[0].0).collect::<Vec<_>>(), [0]);
    }
}
