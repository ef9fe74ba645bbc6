//! Checksums of what a run holds, by which two machines tell each other that they computed the same bits.

use super::Run;

/// The 64-bit FNV-1a hash of the bits of numbers, little endian, in their order; all NaN count as one.
fn hash(numbers: impl Iterator<Item = f64>) -> u64 {
    const OFFSET: u64 = 0xcbf2_9ce4_8422_2325;
    const PRIME: u64 = 0x0000_0100_0000_01b3;
    numbers.fold(OFFSET, |hash, number| {
        let bits = if number.is_nan() { f64::NAN.to_bits() } else { number.to_bits() };
        bits.to_le_bytes().into_iter().fold(hash, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(PRIME))
    })
}

/// The name and checksum of every field of the run as it stands, of its maps of peaks and times, and of the maps of the state.
pub fn checksums(run: &mut dyn Run) -> Vec<(String, u64)> {
    let series = run.plane().series();
    let fields = series.into_iter().filter_map(|field| {
        let sum = hash(run.field(&field.name)?.iter());
        Some((field.name, sum))
    });
    let mut sums: Vec<(String, u64)> = fields.collect();
    let maps = run.peaks().into_iter().chain(run.maps());
    sums.extend(maps.map(|(name, values)| (name.to_owned(), hash(values.into_iter()))));
    sums
}

#[cfg(test)]
mod tests {
    use super::hash;

    #[test]
    fn one_bit_and_the_order_count_and_the_kind_of_nan_does_not() {
        let sum = |numbers: &[f64]| hash(numbers.iter().copied());
        assert_eq!(sum(&[]), 0xcbf2_9ce4_8422_2325);
        assert_ne!(sum(&[0.0]), sum(&[-0.0]));
        assert_ne!(sum(&[1.0]), sum(&[1.0_f64.next_up()]));
        assert_ne!(sum(&[1.0, 2.0]), sum(&[2.0, 1.0]));
        assert_eq!(sum(&[f64::NAN]), sum(&[f64::from_bits(f64::NAN.to_bits() | 1)]));
    }
}
