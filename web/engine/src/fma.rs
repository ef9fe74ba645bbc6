//! Fused multiply-add for WebAssembly, which has no such instruction: the bits of the hardware at a tenth of the time that
//! the usual software takes.

/// Beyond 2^+-400 the product's error may not be a number any more; such values go the slow way.
const RANGE: std::ops::RangeInclusive<f64> = 3.872_591_914_849_318e-121..=2.582_249_878_086_908_6e120;
/// Half of a mantissa: 2^27 + 1 (Veltkamp).
const SPLIT: f64 = 134_217_729.0;

/// a + b as the rounded sum and its error (Knuth).
#[inline(always)]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let kept = sum - a;
    (sum, (a - (sum - kept)) + (b - kept))
}

/// a b as the rounded product and its error (Dekker).
#[inline(always)]
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let halves = |x: f64| {
        let shifted = SPLIT * x;
        let high = shifted - (shifted - x);
        (high, x - high)
    };
    let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
    let product = a * b;
    let error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    (product, error)
}

/// a + b rounded to odd: where it is not exact, to the neighbour whose last bit is 1.
#[inline(always)]
fn odd_sum(a: f64, b: f64) -> f64 {
    let (sum, error) = two_sum(a, b);
    let bits = sum.to_bits();
    if error == 0.0 || bits & 1 == 1 {
        return sum;
    }
    // One unit away from zero where the error has the sign of the sum, else towards it.
    let away = (bits ^ error.to_bits()) >> 63 == 0;
    f64::from_bits(if away { bits + 1 } else { bits - 1 })
}

/// a b + c, rounded once.
///
/// S. Boldo and G. Melquiond, Emulation of a FMA and correctly rounded sums: proved algorithms using rounding to odd, IEEE
/// Trans. Computers 57 (2008), algorithm 5.
pub fn fused(a: f64, b: f64, c: f64) -> f64 {
    if !(RANGE.contains(&a.abs()) && RANGE.contains(&b.abs()) && c.abs() <= 1e300) {
        if a == 0.0 || b == 0.0 {
            return a * b + c; // exact, or decided by infinities and NaN
        }
        return libm::fma(a, b, c);
    }
    let (product, error) = two_product(a, b);
    let (low, rest) = two_sum(c, error);
    let (high, part) = two_sum(product, low);
    high + odd_sum(rest, part)
}

/// What the compiler calls for `f64::mul_add`.
#[cfg(target_family = "wasm")]
#[unsafe(no_mangle)]
extern "C" fn fma(a: f64, b: f64, c: f64) -> f64 {
    fused(a, b, c)
}

#[cfg(test)]
mod tests {
    use super::fused;

    /// Random bits (Weyl sequence, mixed by multiplications).
    struct Random(u64);

    impl Random {
        fn bits(&mut self) -> u64 {
            self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = self.0;
            for factor in [0xbf58_476d_1ce4_e5b9, 0x94d0_49bb_1331_11eb] {
                z = (z ^ (z >> 29)).wrapping_mul(factor);
            }
            z ^ (z >> 32)
        }
        /// +-m 2^e, -span <= e <= span, its last `zeros` bits 0.
        fn near(&mut self, span: u64, zeros: u64) -> f64 {
            let exponent = 1023 - span + self.bits() % (2 * span + 1);
            f64::from_bits(self.bits() & 1 << 63 | exponent << 52 | (self.bits() >> 12) >> zeros << zeros)
        }
    }

    fn check(a: f64, b: f64, c: f64) {
        let (ours, exact) = (fused(a, b, c), a.mul_add(b, c));
        let same = ours.to_bits() == exact.to_bits() || (ours.is_nan() && exact.is_nan());
        assert!(same, "{a:e} * {b:e} + {c:e} = {ours:e}, not {exact:e}");
    }

    #[test]
    fn it_has_the_bits_of_the_hardware() {
        let mut random = Random(1);
        for _ in 0..300_000 {
            check(
                f64::from_bits(random.bits()),
                f64::from_bits(random.bits()),
                f64::from_bits(random.bits()),
            );
            let zeros = random.bits() % 53;
            let (a, b, c) = (random.near(2, zeros), random.near(2, zeros), random.near(120, zeros));
            check(a, b, c);
            check(random.near(420, 0), random.near(420, 0), random.near(1000, 0));
            // The product cancelled down to its error, and beside it.
            for c in [a * b, (a * b).next_up(), (a * b).next_down()] {
                check(a, b, -c);
            }
            // Halfway between two numbers, and just beside.
            for factor in [1.0, -1.0, 1.0 + f64::EPSILON, 1.0 - f64::EPSILON, 3.0, 0.5] {
                check(c.abs() * f64::EPSILON / 4.0, factor, c);
                check(2.0_f64.powi(-53), factor, a.abs().clamp(1.0, 1.999));
            }
        }
    }

    #[test]
    fn zeros_ends_and_what_is_no_number_are_as_the_hardware_has_them() {
        let mut edges = vec![0.0, 1.0, f64::MIN_POSITIVE, 5e-324, f64::MAX, f64::INFINITY, f64::NAN];
        edges.extend([-401, -400, -399, 399, 400, 401, -538, 512].map(|power| 2.0_f64.powi(power)));
        edges.extend(edges.clone().into_iter().map(|edge: f64| -edge));
        for a in &edges {
            for b in &edges {
                edges.iter().for_each(|c| check(*a, *b, *c));
            }
        }
    }
}
