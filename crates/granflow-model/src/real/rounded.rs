//! Square root and fused multiply-add of `f64` by integers, for machines without the standard library.
//!
//! Both are the exact result rounded once, to nearest and ties to even, as IEEE 754 asks: the bits are those of the hardware.
//! A finite number is m 2^e with an integer m; the exact result is formed as such a pair, with what does not fit 128 bits
//! kept as one *sticky* last bit that says whether anything was dropped.

/// Bits of the fraction that an `f64` stores.
const FRACTION: u32 = 52;
/// The smallest positive `f64` is 2^LOWEST.
const LOWEST: i32 = -1074;
/// The spacing of the largest `f64` is 2^HIGHEST.
const HIGHEST: i32 = 971;

/// |x| = m 2^e with 2^52 <= m < 2^53, for x finite and not 0.
pub(super) fn parts(x: f64) -> (u64, i32) {
    let bits = x.abs().to_bits();
    let biased = (bits >> FRACTION) as i32;
    let fraction = bits & ((1 << FRACTION) - 1);
    let (m, e) =
        if biased == 0 { (fraction, LOWEST) } else { (fraction | 1 << FRACTION, biased - 1 + LOWEST) };
    let shift = m.leading_zeros() - (u64::BITS - 1 - FRACTION);
    (m << shift, e - shift as i32)
}

/// The `f64` nearest to m 2^e, ties to even, for 0 < m < 2^127.
fn nearest(m: u128, e: i32) -> f64 {
    let length = (u128::BITS - m.leading_zeros()) as i32;
    // The spacing of the result is 2^unit: 53 bits, or fewer where it is subnormal.
    let unit = (e + length - 1 - FRACTION as i32).max(LOWEST);
    let dropped = unit - e;
    if unit > HIGHEST {
        return f64::INFINITY;
    }
    if dropped > length {
        return 0.0; // below half the smallest number
    }
    let kept = if dropped <= 0 {
        m << -dropped
    } else {
        let (kept, rest, half) = (m >> dropped, m & ((1 << dropped) - 1), 1 << (dropped - 1));
        kept + u128::from(rest > half || (rest == half && kept & 1 == 1))
    };
    // The leading bit of `kept`, where there is one, adds 1 to the stored exponent; so does a carry out of the fraction,
    // and from the largest number it makes infinity.
    f64::from_bits((((unit - LOWEST) as u64) << FRACTION) + kept as u64)
}

/// sqrt(x), rounded once.
///
/// With x = r 2^(2k) and 2^106 <= r < 2^108, the integer root of r has 54 bits: one more than the result, and the sticky bit
/// says whether it is exact.
pub fn sqrt(x: f64) -> f64 {
    if x.is_nan() || x == 0.0 || x == f64::INFINITY {
        return x;
    }
    if x < 0.0 {
        return f64::NAN;
    }
    let (m, e) = parts(x);
    let shift = 54 + e.rem_euclid(2);
    let r = u128::from(m) << shift;
    let root = r.isqrt();
    nearest(root << 1 | u128::from(root * root != r), (e - shift) / 2 - 1)
}

/// +-size 2^exponent with 2^125 <= size < 2^126: room for a sum.
#[derive(Clone, Copy)]
struct Wide {
    exponent: i32,
    size: u128,
    negative: bool,
}

impl Wide {
    fn new(size: u128, exponent: i32, negative: bool) -> Wide {
        let shift = size.leading_zeros() - 2;
        Wide { exponent: exponent - shift as i32, size: size << shift, negative }
    }
}

/// factor other + term, rounded once.
///
/// The product of two 53-bit integers is exact. The smaller summand is shifted to the exponent of the larger one; it loses
/// bits only when the shift is above 20, where the sum has at least 124 bits, so that the sticky bit decides every tie.
pub fn mul_add(factor: f64, other: f64, term: f64) -> f64 {
    if !(factor.is_finite() && other.is_finite()) || factor == 0.0 || other == 0.0 {
        return factor * other + term; // exact, or decided by the infinities and NaN
    }
    if !term.is_finite() {
        return term; // the product is finite, though it may overflow
    }
    if term == 0.0 {
        return factor * other; // a product that underflows keeps its sign
    }
    let ((a, p), (b, q), (c, r)) = (parts(factor), parts(other), parts(term));
    let product = Wide::new(
        u128::from(a) * u128::from(b),
        p + q,
        factor.is_sign_negative() != other.is_sign_negative(),
    );
    let term = Wide::new(u128::from(c), r, term.is_sign_negative());
    let (large, small) = if (product.exponent, product.size) < (term.exponent, term.size) {
        (term, product)
    } else {
        (product, term)
    };
    let shift = large.exponent - small.exponent;
    let moved =
        if shift > 126 { 1 } else { small.size >> shift | u128::from(small.size & ((1 << shift) - 1) != 0) };
    let size = if large.negative == small.negative { large.size + moved } else { large.size - moved };
    if size == 0 {
        return 0.0;
    }
    let sum = nearest(size, large.exponent);
    if large.negative { -sum } else { sum }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::prelude::v1::*;

    /// Random bits (Weyl sequence, mixed by multiplications).
    pub struct Random(pub u64);

    impl Random {
        pub fn bits(&mut self) -> u64 {
            self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = self.0;
            for factor in [0xbf58_476d_1ce4_e5b9, 0x94d0_49bb_1331_11eb] {
                z = (z ^ (z >> 29)).wrapping_mul(factor);
            }
            z ^ (z >> 32)
        }
        /// Any of the numbers, NaN and infinities among them.
        pub fn any(&mut self) -> f64 {
            f64::from_bits(self.bits())
        }
        /// +-m 2^e, e an integer in a range and 1 <= m < 2 with its last `zeros` bits 0.
        pub fn near(&mut self, exponents: core::ops::Range<i64>, zeros: u32) -> f64 {
            let span = (exponents.end - exponents.start) as u64;
            let e = exponents.start + (self.bits() % span) as i64;
            let fraction = (self.bits() >> 12) >> zeros << zeros;
            f64::from_bits(self.bits() & (1 << 63) | (((e + 1023) as u64) << 52) | fraction)
        }
    }

    /// Zeros, ends of the ranges, powers of two with their neighbours, infinity and NaN, with both signs.
    fn edges() -> Vec<f64> {
        let largest_subnormal = f64::from_bits((1 << 52) - 1);
        let mut edges = vec![0.0, largest_subnormal, f64::MAX, f64::INFINITY, f64::NAN];
        for power in [-1074, -1073, -1023, -1022, -1021, -538, -537, -53, -1, 0, 1, 52, 53, 511, 512, 1023] {
            let x = 2.0_f64.powi(power / 2) * 2.0_f64.powi(power - power / 2);
            edges.extend([x.next_down(), x, x.next_up(), 1.5 * x, 3.0 * x]);
        }
        let opposite: Vec<f64> = edges.iter().map(|x| -x).collect();
        edges.extend(opposite);
        edges
    }

    /// The same bits, or both not a number.
    fn same(ours: f64, exact: f64) -> bool {
        ours.to_bits() == exact.to_bits() || (ours.is_nan() && exact.is_nan())
    }

    fn check_root(x: f64) {
        assert!(same(sqrt(x), x.sqrt()), "sqrt({x:e}) = {:e}, not {:e}", sqrt(x), x.sqrt());
    }

    fn check_sum(a: f64, b: f64, c: f64) {
        let (ours, exact) = (mul_add(a, b, c), a.mul_add(b, c));
        assert!(same(ours, exact), "{a:e} * {b:e} + {c:e} = {ours:e}, not {exact:e}");
    }

    #[test]
    fn roots_have_the_bits_of_the_hardware() {
        edges().into_iter().for_each(check_root);
        let mut random = Random(1);
        for _ in 0..1_000_000 {
            let x = random.any();
            check_root(x);
            check_root(f64::from_bits(x.abs().to_bits() >> 12)); // subnormal
            // Squares and their neighbours, and squares of the middle between two numbers.
            let y = random.near(-500..500, 26);
            let square = y * y;
            let between = y.abs() + y.abs() * 2.0_f64.powi(-53);
            [square, square.next_up(), square.next_down(), between * between]
                .into_iter()
                .for_each(check_root);
        }
    }

    #[test]
    fn products_and_sums_of_edges_have_the_bits_of_the_hardware() {
        let edges = edges();
        for a in &edges {
            for b in &edges {
                edges.iter().for_each(|c| check_sum(*a, *b, *c));
            }
        }
    }

    #[test]
    fn random_products_and_sums_have_the_bits_of_the_hardware() {
        let mut random = Random(2);
        for _ in 0..1_000_000 {
            check_sum(random.any(), random.any(), random.any());
            // The summands meet: every shift, both signs, products with many zeros at the end.
            let zeros = (random.bits() % 53) as u32;
            let [a, b, c] = [-2..2, -2..2, -120..120].map(|range| random.near(range, zeros));
            check_sum(a, b, c);
            // Cancellation down to the rounding error of the product, and about it.
            for c in [a * b, (a * b).next_up(), (a * b).next_down()] {
                check_sum(a, b, -c);
            }
            // Subnormal results, and results about the largest number.
            let tiny = 2.0_f64.powi(-540);
            let c = random.near(-1022..-1000, zeros) * random.near(-60..1, 0);
            check_sum(a * tiny, b * tiny, c);
            check_sum(a * tiny, b * 2.0_f64.powi(-500), c);
            check_sum(a * 2.0_f64.powi(500), b * 2.0_f64.powi(522), random.near(965..1024, zeros));
        }
    }

    #[test]
    fn sums_halfway_between_two_numbers_and_just_beside_have_the_bits_of_the_hardware() {
        let mut random = Random(3);
        for _ in 0..1_000_000 {
            // c and half its spacing, as a product, and products a little beside it.
            let c = random.near(-1000..1000, 0);
            let e = parts(c).1;
            let half = 2.0_f64.powi(e.max(LOWEST + 60) - 1);
            for factor in [1.0, -1.0, 1.0 + f64::EPSILON, 1.0 - f64::EPSILON, 3.0, -3.0, 0.5] {
                check_sum(half, factor, c);
                check_sum(half * factor, 1.0 + f64::EPSILON, c);
            }
            // A product halfway between two numbers: the term decides, however small.
            let (a, b) = (random.near(0..1, 52 - 26), random.near(0..1, 52 - 27));
            let unit = 2.0_f64.powi((random.bits() % 200) as i32 - 200);
            [unit, -unit, 0.0].into_iter().for_each(|c| check_sum(a, b, c));
        }
    }
}
