//! What is kept of a run while it goes: the summary maps.

use crate::backend::Sheet;
use crate::grid::Layout;

/// Maps over the cells, in the padded layout of the state.
#[derive(Clone, Debug)]
pub struct Maps {
    /// Largest thickness normal to the bed so far.
    pub peak_thickness: Vec<f64>,
    /// Largest speed along the bed so far.
    pub peak_speed: Vec<f64>,
    /// Time at which the cell was first thicker than a film; NaN before.
    pub arrival_time: Vec<f64>,
    /// Time at which the cell last moved; NaN where it never did.
    pub stopping_time: Vec<f64>,
}

impl Maps {
    /// Nothing seen yet.
    pub fn new(layout: &Layout) -> Maps {
        Maps {
            peak_thickness: vec![0.0; layout.len()],
            peak_speed: vec![0.0; layout.len()],
            arrival_time: vec![f64::NAN; layout.len()],
            stopping_time: vec![f64::NAN; layout.len()],
        }
    }
    pub(crate) fn sheets(&mut self) -> [Sheet<'_>; 4] {
        [
            Sheet::new(&mut self.peak_thickness),
            Sheet::new(&mut self.peak_speed),
            Sheet::new(&mut self.arrival_time),
            Sheet::new(&mut self.stopping_time),
        ]
    }
}
