//! A field as rows and columns of numbers, without a copy where the engine holds it.

use std::borrow::Cow;

/// The numbers of a field: row `j`, column `i` is `values[start + j * row + i]`; rows from south to north.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldView<'a> {
    /// All numbers, those of the field among them: borrowed from the engine, or computed for this view.
    pub values: Cow<'a, [f64]>,
    /// The first number.
    pub start: usize,
    /// Rows (1 in one dimension) and columns.
    pub shape: [usize; 2],
    /// Numbers from a row to the next.
    pub row: usize,
}

impl FieldView<'_> {
    /// The number in column `i`, row `j`.
    ///
    /// # Panics
    /// Beyond the shape.
    #[must_use]
    pub fn at(&self, i: usize, j: usize) -> f64 {
        assert!(j < self.shape[0] && i < self.shape[1], "a place beyond the field");
        self.values[self.start + j * self.row + i]
    }
    /// The rows from south to north.
    pub fn rows(&self) -> impl Iterator<Item = &[f64]> {
        (0..self.shape[0]).map(|j| &self.values[self.start + j * self.row..][..self.shape[1]])
    }
    /// All numbers of the field, x fastest.
    pub fn iter(&self) -> impl Iterator<Item = f64> + '_ {
        self.rows().flatten().copied()
    }
    /// The numbers belong to the engine: nothing was copied.
    #[must_use]
    pub fn is_borrowed(&self) -> bool {
        matches!(self.values, Cow::Borrowed(_))
    }
}
