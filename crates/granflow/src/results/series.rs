//! The numbers of a series over time.

use crate::output::Precision;

/// The numbers of a series in the precision that the case asks for.
#[derive(Debug, Clone, PartialEq)]
pub enum Numbers {
    /// 32 bits.
    F32(Vec<f32>),
    /// 64 bits.
    F64(Vec<f64>),
}

impl Numbers {
    pub(crate) fn none(precision: Precision) -> Numbers {
        match precision {
            Precision::F32 => Numbers::F32(Vec::new()),
            Precision::F64 => Numbers::F64(Vec::new()),
        }
    }

    /// Adds `length` numbers that `fill` puts, given the number of the first.
    pub(crate) fn extend(&mut self, length: usize, fill: impl Fn(usize, &mut [f64])) {
        const PART: usize = 1 << 15;
        let values = match self {
            Numbers::F64(values) => {
                let start = values.len();
                values.resize(start + length, 0.0);
                return fill(0, &mut values[start..]);
            }
            Numbers::F32(values) => values,
        };
        values.reserve(length);
        let mut part = vec![0.0; PART.min(length)];
        for from in (0..length).step_by(PART) {
            let part = &mut part[..PART.min(length - from)];
            fill(from, part);
            #[expect(clippy::cast_possible_truncation, reason = "rounding to f32 is what was asked for")]
            values.extend(part.iter().map(|value| *value as f32));
        }
    }
}
