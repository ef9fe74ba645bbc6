//! For how long each cell was above thresholds.

#[cfg(feature = "threads")]
use rayon::prelude::*;

/// Cells that are looked at in one go.
pub(super) const AT_ONCE: usize = 1 << 13;

/// A quantity with a threshold, of which a map says how long it was exceeded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exceeded {
    /// The quantity.
    pub what: What,
    /// Its threshold, in the unit of the quantity.
    pub threshold: f64,
}

/// What may have a threshold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum What {
    /// Thickness normal to the bed.
    Thickness,
    /// Speed along the bed, while the layer counts in the maps of peaks.
    Speed,
    /// Dynamic pressure, while the layer counts in the maps of peaks.
    Pressure,
}

impl What {
    /// Name of the map.
    pub(super) const fn map(self) -> &'static str {
        match self {
            Self::Thickness => "duration_thickness",
            Self::Speed => "duration_speed",
            Self::Pressure => "duration_pressure",
        }
    }
}

/// One of the maps under way.
#[derive(Debug)]
pub(super) struct Duration {
    pub exceeded: Exceeded,
    /// Time in all until the last state that was not above; NaN where none was above yet.
    ended: Vec<f64>,
    /// Since when it is above; NaN where it is not.
    since: Vec<f64>,
}

impl Duration {
    /// Nothing was above it yet.
    pub fn new(exceeded: Exceeded, cells: usize) -> Duration {
        Duration { exceeded, ended: vec![f64::NAN; cells], since: vec![f64::NAN; cells] }
    }

    /// Take the state at `time` into account; `above` says which of the cells from one on are above the threshold.
    pub fn take(&mut self, time: f64, above: impl Fn(usize, &mut [bool]) + Sync) {
        #[cfg(feature = "threads")]
        let parts = self.ended.par_chunks_mut(AT_ONCE).zip(self.since.par_chunks_mut(AT_ONCE)).enumerate();
        #[cfg(not(feature = "threads"))]
        let parts = self.ended.chunks_mut(AT_ONCE).zip(self.since.chunks_mut(AT_ONCE)).enumerate();
        parts.for_each(|(part, (ended, since))| {
            let mut is_above = [false; AT_ONCE];
            let is_above = &mut is_above[..ended.len()];
            above(part * AT_ONCE, is_above);
            for ((above, ended), since) in is_above.iter().zip(ended).zip(since) {
                match (*above, since.is_nan()) {
                    (true, true) => *since = time,
                    (false, false) => {
                        *ended = ended.max(0.0) + (time - *since);
                        *since = f64::NAN;
                    }
                    _ => {}
                }
            }
        });
    }

    /// The time in all up to `time`, NaN where it was never above.
    pub fn map(&self, time: f64) -> Vec<f64> {
        let whole = |(ended, since): (&f64, &f64)| match since.is_nan() {
            true => *ended,
            false => ended.max(0.0) + (time - since),
        };
        self.ended.iter().zip(&self.since).map(whole).collect()
    }

    /// Its arrays, for a checkpoint.
    pub fn arrays(&self) -> [&[f64]; 2] {
        [&self.ended, &self.since]
    }

    /// Go on from [`Duration::arrays`]; false where they have another length.
    pub fn restore(&mut self, [ended, since]: [Vec<f64>; 2]) -> bool {
        let fits = ended.len() == self.ended.len() && since.len() == self.since.len();
        if fits {
            (self.ended, self.since) = (ended, since);
        }
        fits
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_above_add_up_and_what_is_above_at_the_end_counts_to_it() {
        let mut duration = Duration::new(Exceeded { what: What::Thickness, threshold: 1.0 }, 3);
        let states =
            [(0.0, [2.0, 0.5, 0.5]), (1.0, [2.0, 1.5, 0.5]), (2.5, [0.0, 1.5, 1.0]), (3.0, [1.1, 0.0, 1.0])];
        for (time, state) in states {
            duration.take(time, |from, above| {
                above.iter_mut().zip(&state[from..]).for_each(|(above, h)| *above = *h > 1.0);
            });
        }
        let map = duration.map(5.0);
        assert_eq!(map[..2], [2.5 + 2.0, 2.0]);
        assert!(map[2].is_nan(), "never above");
        let mut other = Duration::new(duration.exceeded, 3);
        assert!(other.restore(duration.arrays().map(<[f64]>::to_vec)));
        assert_eq!(other.map(5.0)[..2], map[..2]);
        assert!(!other.restore([vec![0.0; 2], vec![0.0; 3]]));
    }
}
