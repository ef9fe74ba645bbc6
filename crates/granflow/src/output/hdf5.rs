//! Gives datasets of a finished HDF5 skeleton their place behind it, so that data can be streamed to the end of
//! the file.
//!
//! A dataset that was written without data has a contiguous layout message whose address is undefined (HDF5 File
//! Format Specification 3.0, IV.A.2.i); here each gets address and size, and the checksums of its header
//! (IV.A.1.b) and of the superblock (II.A), which holds the end of the file, are computed again.

use hdf5_core::jenkins_lookup3;

/// Where the data of one dataset go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Block {
    /// First byte in the file.
    pub address: u64,
    /// How many bytes.
    pub size: u64,
}

const LAYOUT_MESSAGE: u8 = 8;
/// Version 3, class contiguous, address undefined.
const UNPLACED: [u8; 10] = [3, 1, 255, 255, 255, 255, 255, 255, 255, 255];

/// Places the datasets without data, in the order of their headers, behind `skeleton`; `sizes` are theirs in
/// bytes.
///
/// The error says what about the skeleton is not as expected; it is then to be thrown away.
pub(super) fn allocate(skeleton: &mut [u8], sizes: &[u64]) -> Result<Vec<Block>, String> {
    let strange = |what: &str| format!("the HDF5 skeleton is not as expected: {what}");
    if skeleton.get(..9) != Some(b"\x89HDF\r\n\x1a\n\x02") || skeleton.len() < 48 {
        return Err(strange("no superblock of version 2"));
    }
    let mut headers = Vec::new();
    let mut at = 48;
    while let Some(found) = skeleton[at..].windows(4).position(|window| window == b"OHDR") {
        at += found;
        match Header::parse(skeleton, at) {
            Some(header) => {
                at = header.end;
                headers.extend(header.unplaced.map(|layout| (header.start, layout, header.end)));
            }
            None => at += 4, // the letters stand in a text
        }
    }
    if headers.len() != sizes.len() {
        return Err(strange(&format!("{} datasets without data instead of {}", headers.len(), sizes.len())));
    }
    let mut end = skeleton.len() as u64;
    let mut blocks = Vec::with_capacity(sizes.len());
    for (&(start, layout, stop), &size) in headers.iter().zip(sizes) {
        let address = end.next_multiple_of(8);
        skeleton[layout + 2..layout + 10].copy_from_slice(&address.to_le_bytes());
        skeleton[layout + 10..layout + 18].copy_from_slice(&size.to_le_bytes());
        let checksum = jenkins_lookup3(&skeleton[start..stop - 4]);
        skeleton[stop - 4..stop].copy_from_slice(&checksum.to_le_bytes());
        blocks.push(Block { address, size });
        end = address + size;
    }
    skeleton[28..36].copy_from_slice(&end.to_le_bytes());
    let checksum = jenkins_lookup3(&skeleton[..44]);
    skeleton[44..48].copy_from_slice(&checksum.to_le_bytes());
    Ok(blocks)
}

/// An object header of version 2 without times and phase changes: "OHDR", version, flags, length, messages,
/// checksum.
struct Header {
    start: usize,
    /// One past the checksum.
    end: usize,
    /// Where the payload of an unplaced layout message begins.
    unplaced: Option<usize>,
}

impl Header {
    fn parse(bytes: &[u8], start: usize) -> Option<Self> {
        let flags = *bytes.get(start + 5)?;
        if bytes[start + 4] != 2 || flags > 3 {
            return None;
        }
        let width = 1 << flags;
        let length = bytes.get(start + 6..start + 6 + width)?;
        let length = length.iter().rev().fold(0, |sum, &byte| sum << 8 | usize::from(byte));
        let (mut at, stop) = (start + 6 + width, (start + 6 + width).checked_add(length)?);
        let checksum = bytes.get(stop..stop.checked_add(4)?)?;
        if checksum != jenkins_lookup3(&bytes[start..stop]).to_le_bytes() {
            return None;
        }
        let mut unplaced = None;
        while at + 4 <= stop {
            let length = usize::from(u16::from_le_bytes([bytes[at + 1], bytes[at + 2]]));
            if bytes[at] == LAYOUT_MESSAGE && length >= 18 && bytes[at + 4..at + 14] == UNPLACED {
                unplaced = Some(at + 4);
            }
            at += 4 + length;
        }
        Some(Self { start, end: stop + 4, unplaced })
    }
}
