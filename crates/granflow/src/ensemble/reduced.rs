//! Members added up, so that neither their order nor how they were divided shows in a bit of the result.
//!
//! Counts are whole numbers, least and largest values know no order, and sums are whole multiples of 2^-40: no sum is rounded.

use super::classes::Classes;
use super::member::{Computed, Outcome, Row, SCALARS};
use std::collections::BTreeMap;

/// A unit of the sums: about 10^-12.
const UNIT: f64 = (1_u64 << 40) as f64;
/// A larger value cannot be added: a million of them times 2^40 must fit 127 bits.
const LARGEST: f64 = 1e18;

/// What is kept of the peaks of one quantity.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Peaks {
    /// Name of the map that is added up.
    pub name: String,
    /// Thresholds of which it is counted how many members exceeded them.
    pub thresholds: Vec<f64>,
    /// The sum in each cell, in units of 2^-40.
    pub sums: Vec<i128>,
    /// The largest value in each cell, 0 where no member came.
    pub largest: Vec<f64>,
    /// How many members exceeded each threshold, in each cell.
    pub above: Vec<Vec<u32>>,
    /// Counts by classes in each cell; none without percentiles.
    pub classes: Vec<Classes>,
}

/// Members added up: cell by cell, and a row each.
#[derive(Debug, Clone, PartialEq)]
pub struct Reduced {
    /// How many members reached each cell.
    pub(super) reached: Vec<u32>,
    pub(super) peaks: Vec<Peaks>,
    /// Classes of a doubling, as a power of two; none without percentiles.
    pub(super) bits: Option<u32>,
    /// Names of the numbers that members have beyond [`SCALARS`], in the order of the alphabet.
    pub(super) further: Vec<String>,
    /// What is known of each member that was added, by its number.
    pub(super) rows: BTreeMap<u32, Row>,
}

impl Reduced {
    /// Of no member yet: on so many cells, with these maps and their thresholds.
    pub(super) fn empty(cells: usize, maps: &[(&str, &[f64])], classes: Option<u32>) -> Reduced {
        let peaks = |(name, thresholds): &(&str, &[f64])| Peaks {
            name: (*name).to_owned(),
            thresholds: thresholds.to_vec(),
            sums: vec![0; cells],
            largest: vec![0.0; cells],
            above: vec![vec![0; cells]; thresholds.len()],
            classes: if classes.is_some() { vec![Classes::default(); cells] } else { Vec::new() },
        };
        Reduced {
            reached: vec![0; cells],
            peaks: maps.iter().map(peaks).collect(),
            bits: classes.map(u32::ilog2),
            further: Vec::new(),
            rows: BTreeMap::new(),
        }
    }

    /// Whether member `number` is among those that were added.
    #[must_use]
    pub fn has(&self, number: u32) -> bool {
        self.rows.contains_key(&number)
    }

    /// The numbers of the members that were added, those that failed too.
    pub fn members(&self) -> impl Iterator<Item = u32> + '_ {
        self.rows.keys().copied()
    }

    /// How many members were computed to their end.
    #[must_use]
    pub fn computed(&self) -> u32 {
        self.rows.values().filter(|row| row.failure().is_none()).count() as u32
    }

    /// The members that failed, and why.
    pub fn failures(&self) -> impl Iterator<Item = (u32, &str)> + '_ {
        self.rows.iter().filter_map(|(number, row)| Some((*number, row.failure()?)))
    }

    /// Adds a member.
    ///
    /// # Panics
    /// If it was added before.
    pub fn add(&mut self, outcome: Outcome) {
        let Outcome { member, result } = outcome;
        let number = member.number;
        let values = member.values.iter().map(|drawn| drawn.value()).collect();
        let row = match result.and_then(|computed| self.fits(&computed).map(|()| computed)) {
            Ok(computed) => {
                self.add_maps(&computed);
                let Computed { reason, mut scalars, further, .. } = computed;
                self.widen(further.keys());
                let number = |name| further.get(name).copied().unwrap_or(f64::NAN);
                scalars.extend(self.further.iter().map(number));
                Row { values, ended: Ok((reason, scalars)) }
            }
            Err(failure) => Row { values, ended: Err(failure) },
        };
        assert!(self.rows.insert(number, row).is_none(), "member {number} is added twice");
    }

    /// Gives every row a place for these further numbers too, not a number where it has none.
    fn widen<'a>(&mut self, names: impl Iterator<Item = &'a String>) {
        let mut all = self.further.clone();
        all.extend(names.filter(|name| !self.further.contains(name)).cloned());
        if all.len() == self.further.len() {
            return;
        }
        all.sort();
        let places: Vec<_> = all.iter().map(|name| self.further.iter().position(|own| own == name)).collect();
        for (_, scalars) in self.rows.values_mut().filter_map(|row| row.ended.as_mut().ok()) {
            let own = scalars.split_off(SCALARS.len());
            scalars.extend(places.iter().map(|place| place.map_or(f64::NAN, |place| own[place])));
        }
        self.further = all;
    }

    /// Can these maps be added?
    fn fits(&self, computed: &Computed) -> Result<(), String> {
        for (peaks, map) in self.peaks.iter().zip(&computed.maps) {
            if let Some(largest) = map.iter().find(|value| **value > LARGEST) {
                return Err(format!("{} is {largest:e}, too large to be added up", peaks.name));
            }
        }
        Ok(())
    }

    fn add_maps(&mut self, computed: &Computed) {
        let bits = self.bits;
        for (reached, value) in self.reached.iter_mut().zip(&computed.maps[0]) {
            *reached += u32::from(*value > 0.0);
        }
        for (peaks, map) in self.peaks.iter_mut().zip(&computed.maps) {
            // Not a number stands where the member did not come.
            for (cell, value) in map.iter().enumerate().filter(|(_, value)| **value > 0.0) {
                peaks.sums[cell] += (value * UNIT).round_ties_even() as i128;
                peaks.largest[cell] = peaks.largest[cell].max(*value);
                for (threshold, above) in peaks.thresholds.iter().zip(&mut peaks.above) {
                    above[cell] += u32::from(value > threshold);
                }
                if let Some(bits) = bits {
                    peaks.classes[cell].add(*value, bits);
                }
            }
        }
    }

    /// Could members have added up to this? What is read from a file may be anything, and a class far from the others would take 16 GiB.
    pub(super) fn is_possible(&self) -> bool {
        let most = self.computed();
        self.reached.iter().all(|count| *count <= most)
            && self.peaks.iter().all(|peaks| {
                peaks.above.iter().flatten().all(|count| *count <= most)
                    && (0..self.reached.len()).all(|cell| peaks.is_possible(cell, most, self.bits))
            })
    }

    /// Adds the members of another one; both must be of one ensemble.
    ///
    /// # Errors
    /// The first member that is in both; then nothing is added.
    pub fn merge(&mut self, mut other: Reduced) -> Result<(), u32> {
        if let Some(twice) = other.rows.keys().find(|number| self.rows.contains_key(number)) {
            return Err(*twice);
        }
        self.widen(other.further.iter());
        other.widen(self.further.iter());
        self.rows.extend(other.rows);
        add(&mut self.reached, &other.reached);
        for (own, other) in self.peaks.iter_mut().zip(&other.peaks) {
            own.sums.iter_mut().zip(&other.sums).for_each(|(own, other)| *own += other);
            own.largest.iter_mut().zip(&other.largest).for_each(|(own, other)| *own = own.max(*other));
            own.above.iter_mut().zip(&other.above).for_each(|(own, other)| add(own, other));
            own.classes.iter_mut().zip(&other.classes).for_each(|(own, other)| own.merge(other));
        }
        Ok(())
    }
}

impl Peaks {
    fn is_possible(&self, cell: usize, most: u32, bits: Option<u32>) -> bool {
        let (sum, largest) = (self.sums[cell], self.largest[cell]);
        let counted = bits.is_none_or(|bits| self.classes[cell].is_possible(largest, most, bits));
        (0..=i128::from(most) * (LARGEST * UNIT) as i128).contains(&sum)
            && (0.0..=LARGEST).contains(&largest)
            && counted
    }

    /// The mean of `count` members in a cell, 0 for those that did not come.
    pub fn mean(&self, cell: usize, count: u32) -> f64 {
        self.sums[cell] as f64 / UNIT / f64::from(count)
    }
}

fn add(own: &mut [u32], other: &[u32]) {
    own.iter_mut().zip(other).for_each(|(own, other)| *own += other);
}
