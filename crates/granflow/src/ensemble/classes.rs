//! Counts of values by classes, for percentiles: classes that grow with the value, so that no range must be known before.

/// Counts of the values of one cell, by class. A doubling of a value is divided into `2^bits` classes of equal width, so a class is
/// at most 2^-bits of its values wide. The class of a value is the head of its bits: no rounding, the same everywhere.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Classes {
    /// The lowest class that has a value.
    pub first: u32,
    /// How many values each class has, from the lowest.
    pub counts: Vec<u32>,
}

/// The class of a value > 0.
fn class(value: f64, bits: u32) -> u32 {
    (value.to_bits() >> (52 - bits)) as u32
}

/// The lower end of a class.
fn lower(class: u32, bits: u32) -> f64 {
    f64::from_bits(u64::from(class) << (52 - bits))
}

impl Classes {
    /// Counts a value > 0.
    pub fn add(&mut self, value: f64, bits: u32) {
        self.count(class(value, bits), 1);
    }

    /// Adds the counts of another one.
    pub fn merge(&mut self, other: &Classes) {
        for (k, count) in other.counts.iter().enumerate().filter(|(_, count)| **count > 0) {
            self.count(other.first + k as u32, *count);
        }
    }

    /// Could these be counts of so many values at most, of which `largest` is the largest, 0 of none?
    pub fn is_possible(&self, largest: f64, most: u32, bits: u32) -> bool {
        let Some(last) = self.counts.last() else { return largest == 0.0 };
        let counted: u64 = self.counts.iter().map(|count| u64::from(*count)).sum();
        let end = u64::from(self.first) + self.counts.len() as u64;
        *last > 0 && largest > 0.0 && end == u64::from(class(largest, bits)) + 1 && counted <= u64::from(most)
    }

    fn count(&mut self, class: u32, count: u32) {
        if self.counts.is_empty() {
            self.first = class;
        }
        if class < self.first {
            let more = (self.first - class) as usize;
            self.counts = std::iter::repeat_n(0, more).chain(self.counts.iter().copied()).collect();
            self.first = class;
        }
        let at = (class - self.first) as usize;
        if at >= self.counts.len() {
            // There are as many of these lists as cells: none has room to spare.
            self.counts.reserve_exact(at + 1 - self.counts.len());
            self.counts.resize(at + 1, 0);
        }
        self.counts[at] += count;
    }

    /// The value that a share `p` of `all` values does not exceed, of which those that were not counted are 0: within a class on
    /// the straight line between its ends.
    pub fn percentile(&self, p: f64, all: u32, bits: u32) -> f64 {
        let counted: u32 = self.counts.iter().sum();
        let mut left = p * f64::from(all) - f64::from(all.saturating_sub(counted));
        if left <= 0.0 {
            return 0.0;
        }
        for (k, count) in self.counts.iter().enumerate().filter(|(_, count)| **count > 0) {
            let (class, count) = (self.first + k as u32, f64::from(*count));
            if left <= count {
                let [low, high] = [class, class + 1].map(|class| lower(class, bits));
                return low + left / count * (high - low);
            }
            left -= count;
        }
        lower(self.first + self.counts.len() as u32, bits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_those_of_the_values_to_the_width_of_a_class() {
        let mut values: Vec<f64> =
            (0..1000_u32).map(|k| f64::from(k.wrapping_mul(2_654_435_761) % 1000) * 0.37).collect();
        for bits in [2, 4, 6] {
            let mut classes = Classes::default();
            values.iter().filter(|value| **value > 0.0).for_each(|value| classes.add(*value, bits));
            values.sort_by(f64::total_cmp);
            for percent in [1, 5, 50, 90, 95, 99] {
                let exact = values[percent * 10 - 1];
                let found = classes.percentile(percent as f64 / 100.0, 1000, bits);
                let width = 0.5_f64.powi(bits as i32);
                assert!((found / exact - 1.0).abs() < width + 0.01, "{bits} {percent}: {found} {exact}");
            }
            assert_eq!(classes.percentile(0.2, 2000, bits), 0.0, "half of them are 0");
        }
    }

    #[test]
    fn the_order_of_values_and_merges_does_not_matter() {
        let values: Vec<f64> =
            (0..300_u32).map(|k| 1e-3 * 1.05_f64.powi((k.wrapping_mul(97) % 300) as i32)).collect();
        let counted = |values: &[f64]| {
            let mut classes = Classes::default();
            values.iter().for_each(|value| classes.add(*value, 4));
            classes
        };
        let whole = counted(&values);
        let back: Vec<f64> = values.iter().rev().copied().collect();
        assert_eq!(whole, counted(&back));
        let largest = values.iter().copied().fold(0.0, f64::max);
        assert!(whole.is_possible(largest, 300, 4) && !whole.is_possible(largest, 299, 4));
        let moved = Classes { first: u32::MAX - 400, ..whole.clone() };
        assert!(!moved.is_possible(largest, 300, 4) && !whole.is_possible(2.0 * largest, 300, 4));
        assert!(Classes::default().is_possible(0.0, 300, 4) && !Classes::default().is_possible(1.0, 300, 4));
        let mut merged = counted(&values[200..]);
        merged.merge(&counted(&values[..120]));
        merged.merge(&Classes::default());
        merged.merge(&counted(&values[120..200]));
        assert_eq!(whole, merged);
    }
}
