//! What is kept of a run while it goes: the summary maps.

use crate::disjoint::DisjointSlice;
use crate::field::zeros;
use crate::grid::Layout;
use granflow_model::scheme::Diagnostics;

/// Maps over the cells, in the padded layout of the state, in single precision.
#[derive(Clone, Debug)]
pub struct Maps {
    /// Largest thickness normal to the bed so far.
    peak_thickness: Vec<f32>,
    /// Largest speed along the bed so far.
    peak_speed: Vec<f32>,
    /// Time at which the cell was first thicker than a film; NaN before.
    arrival_time: Vec<f32>,
    /// Time at which the cell last moved; NaN where it never did.
    stopping_time: Vec<f32>,
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
    /// As [`Maps::named`], for good.
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
    pub fn named_mut(&mut self) -> impl Iterator<Item = (&'static str, &mut [f32])> {
        [
            ("peak_thickness", self.peak_thickness.as_mut_slice()),
            ("peak_speed", &mut self.peak_speed),
            ("arrival_time", &mut self.arrival_time),
            ("stopping_time", &mut self.stopping_time),
        ]
        .into_iter()
    }
    /// Has every map a number in every place of the layout?
    pub(crate) fn holds(&self, layout: &Layout) -> bool {
        self.named().all(|(_, map)| map.len() == layout.len())
    }
    /// Take the first state of a run into account.
    pub(crate) fn begin(&mut self, place: usize, watch: &Diagnostics<f64>, time: f64) {
        self.peak_thickness[place] = watch.thickness as f32;
        self.peak_speed[place] = watch.speed_squared.sqrt() as f32;
        if watch.volume > 0.0 && watch.film == 0.0 {
            self.arrival_time[place] = time as f32;
        }
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
