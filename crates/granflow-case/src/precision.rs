//! How many bits a number of a result file keeps.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How many bits a number of a result file keeps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// 32 bits, about 7 digits.
    F32,
    /// 64 bits, every bit of the computation (maps of peaks and times are kept in 32).
    #[default]
    F64,
}

impl Precision {
    /// Bytes of one number.
    #[must_use]
    pub const fn width(self) -> usize {
        match self {
            Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Appends `values` to `bytes`, little endian, rounded to this precision.
    pub fn encode(self, values: &[f64], bytes: &mut Vec<u8>) {
        let start = bytes.len();
        bytes.resize(start + values.len() * self.width(), 0);
        let room = &mut bytes[start..];
        match self {
            #[expect(clippy::cast_possible_truncation, reason = "rounding to f32 is what was asked for")]
            Self::F32 => {
                room.as_chunks_mut()
                    .0
                    .iter_mut()
                    .zip(values)
                    .for_each(|(b, &v)| *b = (v as f32).to_le_bytes());
            }
            Self::F64 => {
                room.as_chunks_mut().0.iter_mut().zip(values).for_each(|(b, v)| *b = v.to_le_bytes());
            }
        }
    }

    /// The numbers that [`Precision::encode`] wrote.
    #[must_use]
    pub fn decode(self, bytes: &[u8]) -> Vec<f64> {
        match self {
            Self::F32 => bytes.as_chunks().0.iter().map(|&b| f32::from_le_bytes(b).into()).collect(),
            Self::F64 => bytes.as_chunks().0.iter().map(|&b| f64::from_le_bytes(b)).collect(),
        }
    }
}
