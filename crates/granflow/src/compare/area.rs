//! A part of the plane: cells of a grid, or polygons.

use super::grid::CellGrid;
use crate::raster::Raster;
use crate::release::covered_shares;
use geo::{Area as _, BooleanOps, BoundingRect, Centroid, Contains, Coord, MapCoords, MultiPolygon, Point};

/// A part of the plane.
#[derive(Debug, Clone)]
pub(super) enum Area {
    /// The cells that are marked.
    Cells { grid: CellGrid, marked: Vec<bool> },
    /// The inside of polygons that do not overlap.
    Polygons(MultiPolygon),
}

impl Area {
    /// How large it is.
    pub fn size(&self) -> f64 {
        match self {
            Area::Cells { grid, .. } => self.cells().count() as f64 * grid.cell_area(),
            Area::Polygons(polygons) => polygons.unsigned_area(),
        }
    }

    /// The numbers of the marked cells.
    fn cells(&self) -> impl Iterator<Item = usize> + '_ {
        let marked: &[bool] = match self {
            Area::Cells { marked, .. } => marked,
            Area::Polygons(_) => &[],
        };
        marked.iter().enumerate().filter(|(_, marked)| **marked).map(|(cell, _)| cell)
    }

    /// The size of the part that both have, exact but for rounding.
    pub fn common(&self, other: &Area) -> f64 {
        match (self, other) {
            (Area::Cells { grid, marked }, Area::Cells { grid: its, marked: others }) if grid == its => {
                let both = marked.iter().zip(others).filter(|(a, b)| **a && **b).count();
                both as f64 * grid.cell_area()
            }
            (Area::Cells { grid, .. }, Area::Cells { grid: its, marked: others }) => {
                let [across, along] = [grid.shares(its, 0), grid.shares(its, 1)];
                let of_cell = |cell: usize| -> f64 {
                    let (column, row) = (cell % grid.count[0], cell / grid.count[0]);
                    let of_row = |&(j, height): &(usize, f64)| -> f64 {
                        let marked = across[column].iter().filter(|(i, _)| others[j * its.count[0] + i]);
                        height * marked.map(|(_, width)| width).sum::<f64>()
                    };
                    along[row].iter().map(of_row).sum()
                };
                self.cells().map(of_cell).sum()
            }
            (Area::Cells { grid, marked }, Area::Polygons(polygons))
            | (Area::Polygons(polygons), Area::Cells { grid, marked }) => covered(polygons, grid, marked),
            (Area::Polygons(a), Area::Polygons(b)) if a == b => a.unsigned_area(),
            (Area::Polygons(a), Area::Polygons(b)) => a.intersection(b).unsigned_area(),
        }
    }

    /// Whether a place belongs to it.
    pub fn holds(&self, place: [f64; 2]) -> bool {
        match self {
            Area::Cells { grid, marked } => grid.at(place).is_some_and(|cell| marked[cell]),
            Area::Polygons(polygons) => polygons.contains(&Point::from(place)),
        }
    }

    /// Its centroid; none of nothing.
    pub fn centroid(&self) -> Option<[f64; 2]> {
        match self {
            Area::Cells { grid, .. } => {
                let mut sum = [0.0; 2];
                for cell in self.cells() {
                    let centre = grid.centre(cell);
                    sum = [0, 1].map(|axis| sum[axis] + centre[axis]);
                }
                let count = self.cells().count() as f64;
                (count > 0.0).then(|| sum.map(|sum| sum / count))
            }
            Area::Polygons(polygons) => polygons.centroid().map(|place| [place.x(), place.y()]),
        }
    }

    /// The corners of its rim.
    pub fn rim(&self) -> Vec<[f64; 2]> {
        match self {
            Area::Cells { grid, marked } => {
                let [columns, rows] = grid.count;
                let outside = |cell: &usize| {
                    let (i, j) = (cell % columns, cell / columns);
                    let bounded = i == 0 || j == 0 || i + 1 == columns || j + 1 == rows;
                    bounded
                        || [cell - 1, cell + 1, cell - columns, cell + columns].iter().any(|&k| !marked[k])
                };
                self.cells().filter(outside).flat_map(|cell| grid.corners(cell)).collect()
            }
            Area::Polygons(polygons) => polygons
                .iter()
                .flat_map(|polygon| polygon.exterior().coords())
                .map(|corner| [corner.x, corner.y])
                .collect(),
        }
    }

    /// The ends [low, high] along x and y; none of nothing.
    pub fn bounds(&self) -> Option<[[f64; 2]; 2]> {
        if let Area::Polygons(polygons) = self {
            let rect = polygons.bounding_rect()?;
            return Some([[rect.min().x, rect.max().x], [rect.min().y, rect.max().y]]);
        }
        let rim = self.rim();
        let first = rim.first()?;
        let ends = [0, 1].map(|axis| [first[axis]; 2]);
        Some(rim.iter().fold(ends, |ends, place| {
            [0, 1].map(|axis| [ends[axis][0].min(place[axis]), ends[axis][1].max(place[axis])])
        }))
    }
}

/// The area of polygons within the marked cells. Cells need not be square: both are stretched along y until they are.
fn covered(polygons: &MultiPolygon, grid: &CellGrid, marked: &[bool]) -> f64 {
    let stretch = grid.size[0] / grid.size[1];
    let raster = Raster {
        columns: grid.count[0],
        rows: grid.count[1],
        west: grid.low[0],
        south: grid.low[1] * stretch,
        cell: grid.size[0],
        values: Vec::new(),
        crs: None,
    };
    let stretched = polygons.map_coords(|place: Coord| Coord { x: place.x, y: place.y * stretch });
    let of_polygon = |polygon| {
        let shares = covered_shares(polygon, &raster).into_iter();
        shares.filter(|(cell, _)| marked[*cell]).map(|(_, share)| share).sum::<f64>()
    };
    stretched.iter().map(of_polygon).sum::<f64>() * grid.cell_area()
}

#[cfg(test)]
mod tests {
    use super::*;
    use geo::{LineString, Polygon};

    fn grid(low: [f64; 2], size: [f64; 2], count: [usize; 2]) -> CellGrid {
        CellGrid { low, size, count }
    }

    fn square(low: [f64; 2], high: [f64; 2]) -> Area {
        let corners = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]];
        let ring: LineString = corners.map(|[x, y]| (x, y)).to_vec().into();
        Area::Polygons(MultiPolygon::new(vec![Polygon::new(ring, Vec::new())]))
    }

    /// The cells of a grid whose centres lie in a box.
    fn boxed(grid: CellGrid, low: [f64; 2], high: [f64; 2]) -> Area {
        let within = |place: [f64; 2]| (0..2).all(|axis| place[axis] > low[axis] && place[axis] < high[axis]);
        Area::Cells { grid, marked: (0..grid.cells()).map(|cell| within(grid.centre(cell))).collect() }
    }

    #[test]
    fn all_pairs_of_kinds_agree_on_the_common_part_of_two_boxes() {
        // [2, 8] x [1, 5] and [4, 10] x [2, 9] have [4, 8] x [2, 5]: cells of 1 x 0.5, of 2 x 1, and polygons.
        let fine = grid([0.0, 0.0], [1.0, 0.5], [12, 20]);
        let coarse = grid([-2.0, -1.0], [2.0, 1.0], [8, 12]);
        let one = |cells: CellGrid| boxed(cells, [2.0, 1.0], [8.0, 5.0]);
        let other = |cells: CellGrid| boxed(cells, [4.0, 2.0], [10.0, 9.0]);
        for a in [one(fine), one(coarse), square([2.0, 1.0], [8.0, 5.0])] {
            assert!((a.size() - 24.0).abs() < 1e-12);
            assert_eq!(a.centroid(), Some([5.0, 3.0]));
            assert_eq!(a.bounds(), Some([[2.0, 8.0], [1.0, 5.0]]));
            for b in [other(fine), other(coarse), square([4.0, 2.0], [10.0, 9.0])] {
                assert!((a.common(&b) - 12.0).abs() < 1e-9, "{a:?} {b:?}");
                assert!((b.common(&a) - 12.0).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn grids_that_are_shifted_by_part_of_a_cell_are_cut() {
        let whole = |low: f64| {
            let grid = grid([low, 0.0], [1.0, 1.0], [10, 1]);
            Area::Cells { grid, marked: vec![true; 10] }
        };
        assert!((whole(0.0).common(&whole(0.3)) - 9.7).abs() < 1e-12);
        assert_eq!(whole(0.0).common(&whole(0.0)), 10.0);
        assert_eq!(whole(0.0).common(&whole(20.0)), 0.0);
    }

    #[test]
    fn what_is_empty_has_no_centre() {
        let grid = grid([0.0; 2], [1.0; 2], [3, 3]);
        let nothing = Area::Cells { grid, marked: vec![false; 9] };
        assert_eq!((nothing.size(), nothing.centroid(), nothing.bounds()), (0.0, None, None));
    }
}
