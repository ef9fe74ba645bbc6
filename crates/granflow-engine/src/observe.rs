//! What is kept of a run while it goes: the summary maps.

use crate::disjoint::DisjointSlice;
use crate::field::zeros;
use crate::grid::Layout;
use granflow_model::scheme::Diagnostics;

/// Maps over the cells, in the padded layout of the state, in single precision.
///
/// A cell counts in the states in which its layer is thicker than a threshold: a film that runs ahead of the
/// mass, a thousandth of a millimetre thick, would else set peaks and times. All are NaN where no layer ever
/// was thicker.
#[derive(Clone, Debug)]
pub struct Maps {
    /// Thickness normal to the bed that a layer must exceed to count.
    threshold: f64,
    /// Largest thickness normal to the bed so far.
    peak_thickness: Vec<f32>,
    /// Largest speed along the bed so far, while thicker than the threshold.
    peak_speed: Vec<f32>,
    /// Time at which the cell was first thicker than the threshold.
    arrival_time: Vec<f32>,
    /// Time at which the cell last moved while thicker than the threshold; NaN where it never did.
    stopping_time: Vec<f32>,
}

/// The maps as the inner loops write them.
pub(crate) struct Marks<'a> {
    /// See [`Maps`].
    pub threshold: f64,
    pub peak_thickness: DisjointSlice<'a, f32>,
    pub peak_speed: DisjointSlice<'a, f32>,
    pub arrival_time: DisjointSlice<'a, f32>,
    pub stopping_time: DisjointSlice<'a, f32>,
}

impl Maps {
    /// Of all of them.
    pub(crate) const BYTES_PER_CELL: usize = 4 * size_of::<f32>();
    /// Nothing seen yet; counted will be what is thicker than `threshold` (units of the thickness).
    pub fn new(layout: &Layout, threshold: f64) -> Maps {
        let [peak_thickness, peak_speed, arrival_time, stopping_time] = std::array::from_fn(|_| {
            let mut map = zeros(layout.len());
            map.fill(f32::NAN);
            map
        });
        Maps { threshold, peak_thickness, peak_speed, arrival_time, stopping_time }
    }
    /// Thickness normal to the bed that a layer must exceed to count.
    pub fn threshold(&self) -> f64 {
        self.threshold
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
        if self.threshold < watch.thickness {
            self.peak_thickness[place] = watch.thickness as f32;
            self.peak_speed[place] = watch.speed_squared.sqrt() as f32;
            self.arrival_time[place] = time as f32;
        }
    }
    pub(crate) fn marks(&mut self) -> Marks<'_> {
        Marks {
            threshold: self.threshold,
            peak_thickness: DisjointSlice::new(&mut self.peak_thickness),
            peak_speed: DisjointSlice::new(&mut self.peak_speed),
            arrival_time: DisjointSlice::new(&mut self.arrival_time),
            stopping_time: DisjointSlice::new(&mut self.stopping_time),
        }
    }
}
