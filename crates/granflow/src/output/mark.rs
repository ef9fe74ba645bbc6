//! How far a file that grows has come.

use serde::{Deserialize, Serialize};

/// What helps where a file of a run is not as the run left it and cannot be made again.
pub(super) const CURE: &str =
    "put the file back as the run left it, or compute the run anew, by the same command without --resume";

/// The first records of a file that grows: how many, and the CRC-32 of them all in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Mark {
    /// How many records.
    pub count: u64,
    /// Their checksum.
    pub crc: u32,
}

impl Mark {
    /// How many bytes [`Mark::to_bytes`] has.
    pub(super) const BYTES: usize = 12;

    /// Little endian.
    pub(super) fn to_bytes(self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        bytes[..8].copy_from_slice(&self.count.to_le_bytes());
        bytes[8..].copy_from_slice(&self.crc.to_le_bytes());
        bytes
    }

    /// What [`Mark::to_bytes`] gave.
    pub(super) fn from_bytes(bytes: [u8; Self::BYTES]) -> Self {
        let [a, b, c, d, e, f, g, h, i, j, k, l] = bytes;
        Mark { count: u64::from_le_bytes([a, b, c, d, e, f, g, h]), crc: u32::from_le_bytes([i, j, k, l]) }
    }
}
