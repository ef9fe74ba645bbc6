//! Which cells of a simulation are above thresholds, and for how long they were.

use super::{Physics, Simulated};
use crate::run::Maps;
use crate::run::durations::{AT_ONCE, Exceeded, What};

impl<const D: usize, P: Physics<D>> Simulated<D, P> {
    /// Take the state as it stands into the maps of durations.
    pub(super) fn note_durations(&mut self) {
        let time = self.simulation.time();
        let mut durations = std::mem::take(&mut self.durations);
        for duration in &mut durations {
            let exceeded = duration.exceeded;
            duration.take(time, |from, above| self.exceeds(exceeded, from, above));
        }
        self.durations = durations;
    }

    /// Which cells from one on, at most [`AT_ONCE`], are above a threshold.
    fn exceeds(&self, Exceeded { what, threshold }: Exceeded, from: usize, above: &mut [bool]) {
        let mut numbers = [[0.0; AT_ONCE]; 3];
        let mut read = |name: &str, into: usize| match self.fields.iter().find(|field| field.name == name) {
            Some(field) => {
                self.value(field, from, &mut numbers[into][..above.len()]);
                true
            }
            None => false,
        };
        let (_, along) = (read("thickness", 0), read("speed", 1));
        let components = !along && (read("velocity_x", 1), read("velocity_y", 2)).0;
        let [thickness, u, v] = &numbers;
        let least = self.physics.threshold();
        for (k, above) in above.iter_mut().enumerate() {
            let speed = if components { u[k].hypot(v[k]) } else { u[k] };
            *above = match what {
                What::Thickness => thickness[k] > threshold,
                What::Speed => thickness[k] > least && speed > threshold,
                What::Pressure => thickness[k] > least && self.plane.domain.pressure(speed) > threshold,
            };
        }
    }

    /// The maps of durations up to the present time.
    pub(super) fn exceedances(&self) -> Maps {
        let time = self.simulation.time();
        self.durations.iter().map(|duration| (duration.exceeded.what.map(), duration.map(time))).collect()
    }
}
