//! What is released: a number for the few cells of a raster where something lies.

/// Numbers of some cells of a raster, 0 in all others, ordered by the cell's place in [`Raster::values`].
///
/// [`Raster::values`]: crate::raster::Raster::values
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sparse {
    cells: Vec<(usize, f64)>,
}

impl Sparse {
    /// Those of the values, one for each cell, that are not 0.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Sparse {
        values.into_iter().enumerate().collect()
    }

    /// The number of a cell.
    pub fn get(&self, cell: usize) -> f64 {
        self.cells.binary_search_by_key(&cell, |(own, _)| *own).map_or(0.0, |place| self.cells[place].1)
    }

    /// Cells and numbers, ordered by cell.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = (usize, f64)> {
        self.cells.iter().copied()
    }

    /// The largest number; 0 where all are smaller.
    pub fn most(&self) -> f64 {
        self.iter().fold(0.0, |most, (_, value)| most.max(value))
    }

    /// The numbers that `change` makes of cell and number.
    #[must_use]
    pub fn map(&self, change: impl Fn(usize, f64) -> f64) -> Sparse {
        self.iter().map(|(cell, value)| (cell, change(cell, value))).collect()
    }

    /// The sums with those of another.
    #[must_use]
    pub fn plus(mut self, other: Sparse) -> Sparse {
        self.cells.extend(other.cells);
        self.cells.sort_by_key(|(cell, _)| *cell);
        self.cells.dedup_by(|next, kept| {
            let same = next.0 == kept.0;
            if same {
                kept.1 += next.1;
            }
            same
        });
        self
    }

    /// A number for each of `count` cells.
    pub fn dense(&self, count: usize) -> Vec<f64> {
        let mut values = vec![0.0; count];
        self.iter().for_each(|(cell, value)| values[cell] = value);
        values
    }
}

/// From cells that rise; numbers that are 0 are left out.
impl FromIterator<(usize, f64)> for Sparse {
    fn from_iter<I: IntoIterator<Item = (usize, f64)>>(cells: I) -> Sparse {
        let mut cells: Vec<_> = cells.into_iter().filter(|(_, value)| *value != 0.0).collect();
        debug_assert!(cells.is_sorted_by(|a, b| a.0 < b.0));
        cells.shrink_to_fit();
        Sparse { cells }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_keep_every_cell_once_and_in_order() {
        let (one, two) = (Sparse::of([0.0, 1.5, 0.0, 2.0]), Sparse::of([4.0, 0.25, 0.0, 0.0, 8.0]));
        let sum = one.plus(two);
        assert_eq!(sum.iter().collect::<Vec<_>>(), [(0, 4.0), (1, 1.75), (3, 2.0), (4, 8.0)]);
        assert_eq!([0, 1, 2, 3, 4, 5].map(|cell| sum.get(cell)), [4.0, 1.75, 0.0, 2.0, 8.0, 0.0]);
        assert_eq!(sum.dense(6), [4.0, 1.75, 0.0, 2.0, 8.0, 0.0]);
        assert_eq!((sum.most(), Sparse::default().most()), (8.0, 0.0));
        assert_eq!(sum.map(|cell, value| if cell == 1 { 0.0 } else { -value }).iter().count(), 3);
    }
}
