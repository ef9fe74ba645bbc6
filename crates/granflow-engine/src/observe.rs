//! What is kept of a run while it goes: the summary maps.

use crate::backend::DisjointSlice;
use crate::field::zeros;
use crate::grid::Layout;

/// Maps over the cells, in the padded layout of the state, in single precision.
#[derive(Clone, Debug)]
pub struct Maps {
    /// Largest thickness normal to the bed so far.
    pub peak_thickness: Vec<f32>,
    /// Largest speed along the bed so far.
    pub peak_speed: Vec<f32>,
    /// Time at which the cell was first thicker than a film; NaN before.
    pub arrival_time: Vec<f32>,
    /// Time at which the cell last moved; NaN where it never did.
    pub stopping_time: Vec<f32>,
}

impl Maps {
    /// Of all of them.
    pub(crate) const BYTES_PER_CELL: usize = 4 * size_of::<f32>();
    /// Nothing seen yet.
    pub fn new(layout: &Layout) -> Maps {
        Maps {
            peak_thickness: zeros(layout.len()),
            peak_speed: zeros(layout.len()),
            arrival_time: vec![f32::NAN; layout.len()],
            stopping_time: vec![f32::NAN; layout.len()],
        }
    }
    /// The maps with the names that the result files give them.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, &[f32])> {
        [
            ("peak_thickness", self.peak_thickness.as_slice()),
            ("peak_speed", &self.peak_speed),
            ("arrival_time", &self.arrival_time),
            ("stopping_time", &self.stopping_time),
        ]
        .into_iter()
    }
    /// As [`Maps::named`], to rk_weight.
    pub fn into_named(self) -> impl Iterator<Item = (&'static str, Vec<f32>)> {
        [
            ("peak_thickness", self.peak_thickness),
            ("peak_speed", self.peak_speed),
            ("arrival_time", self.arrival_time),
            ("stopping_time", self.stopping_time),
        ]
        .into_iter()
    }
    /// As [`Maps::named`], to be overwritten.
    pub fn named_mut(&mut self) -> impl Iterator<Item = (&'static str, &mut Vec<f32>)> {
        [
            ("peak_thickness", &mut self.peak_thickness),
            ("peak_speed", &mut self.peak_speed),
            ("arrival_time", &mut self.arrival_time),
            ("stopping_time", &mut self.stopping_time),
        ]
        .into_iter()
    }
    pub(crate) fn slices(&mut self) -> [DisjointSlice<'_, f32>; 4] {
        [
            DisjointSlice::new(&mut self.peak_thickness),
            DisjointSlice::new(&mut self.peak_speed),
            DisjointSlice::new(&mut self.arrival_time),
            DisjointSlice::new(&mut self.stopping_time),
        ]
    }
}
