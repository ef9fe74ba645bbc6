//! Logarithm and power of `f64` from + - * / and [`mul_add`] alone, so that every machine gives the same bits.
//!
//! For machines without the standard library. Series with exact coefficients; the leading terms carry a second `f64` with
//! what rounding drops. Errors are in units in the last place (ulp) of the exact result, the largest of 5 10^5 random
//! arguments against 66 digits.

use super::rounded::{mul_add, parts};
use core::f64::consts::{LN_2, SQRT_2};

/// The first 42 bits of ln 2: a product with an exponent (11 bits) is exact.
const LN_2_HIGH: f64 = 0.693_147_180_559_890_3;
/// ln 2 - LN_2_HIGH.
const LN_2_LOW: f64 = 5.497_923_018_708_371e-14;

/// ln x, for every x. Largest error measured: 0.547 ulp.
pub fn ln(x: f64) -> f64 {
    if x.is_nan() || x == f64::INFINITY {
        x
    } else if x == 0.0 {
        f64::NEG_INFINITY
    } else if x < 0.0 {
        f64::NAN
    } else {
        ln_in_two(x)[0]
    }
}

/// ln x as a rounded sum and what it drops, for 0 < x < infinity.
///
/// x = 2^k m with 1/sqrt 2 <= m < sqrt 2, and with s = (m - 1)/(m + 1) and z = s^2 <= 0.0295
/// ln x = k ln 2 + 2 artanh s = k ln 2 + 2 s + s z (2/3 + 2/5 z + 2/7 z^2 + ..), cut off below 2^-60.
fn ln_in_two(x: f64) -> [f64; 2] {
    let (bits, e) = parts(x);
    let m = bits as f64 / (1_u64 << 52) as f64;
    let (m, k) = if m < SQRT_2 { (m, e + 52) } else { (m / 2.0, e + 53) };
    let k = f64::from(k);
    let f = m - 1.0;
    let below = 2.0 + f;
    let below_low = f - (below - 2.0);
    let s = f / below;
    let s_low = (mul_add(-s, below, f) - s * below_low) / below;
    let z = s * s;
    let series = (0..10).rev().fold(0.0, |sum, j| sum * z + 2.0 / f64::from(2 * j + 3));
    let (first, second) = (k * LN_2_HIGH, s + s);
    let high = first + second;
    let low = (second - (high - first)) + ((s_low + s_low) + s * z * series + k * LN_2_LOW);
    in_two(high, low)
}

/// high + low rounded, and what it drops; |high| >= |low|.
fn in_two(high: f64, low: f64) -> [f64; 2] {
    let sum = high + low;
    [sum, low - (sum - high)]
}

/// base^exponent = exp(exponent ln base), for base >= 0 and every exponent; NaN for base < 0.
///
/// Errors measured are below 0.65 ulp for |exponent| <= 8 and below 1 + |exponent|/60 ulp beyond: the exponent enlarges
/// the error of ln base.
pub fn power(base: f64, exponent: f64) -> f64 {
    if exponent == 0.0 || base == 1.0 {
        return 1.0;
    }
    let log = if base > 0.0 && base < f64::INFINITY { ln_in_two(base) } else { [ln(base), 0.0] };
    let high = exponent * log[0];
    if !high.is_finite() {
        return if high == f64::NEG_INFINITY { 0.0 } else { high };
    }
    exp(high, mul_add(exponent, log[0], -high) + exponent * log[1])
}

/// exp(high + low), |low| below the spacing of high.
///
/// With k the integer next to high / ln 2 and r = high + low - k ln 2, |r| <= 0.35: 2^k (1 + r + r^2/2 + .. + r^14/14!),
/// cut off below 2^-62.
fn exp(high: f64, low: f64) -> f64 {
    if high > 710.0 {
        return f64::INFINITY;
    }
    if high < -746.0 {
        return 0.0;
    }
    let k = (high / LN_2 + 0.5_f64.copysign(high)) as i32;
    let [r, r_low] = in_two(high - f64::from(k) * LN_2_HIGH, low - f64::from(k) * LN_2_LOW);
    // 1/2 + r/3! + .. + r^12/14!, from 1/2 (1 + r/3 (1 + r/4 (..)))
    let series = (3..=14).rev().fold(1.0, |sum, n| 1.0 + r * sum / f64::from(n)) / 2.0;
    let [sum, rest] = in_two(1.0, r);
    let value = sum + (rest + (r * r * series + r_low));
    // 2^k in two factors: the result may be subnormal.
    let half = k / 2;
    value * power_of_two(half) * power_of_two(k - half)
}

/// 2^k for -1022 <= k <= 1023.
fn power_of_two(k: i32) -> f64 {
    f64::from_bits(((k + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::super::rounded::tests::Random;
    use super::*;
    use std::prelude::v1::*;

    /// How many numbers apart: 0 for the same bits.
    fn apart(ours: f64, theirs: f64) -> u64 {
        if ours.is_nan() && theirs.is_nan() { 0 } else { ours.to_bits().abs_diff(theirs.to_bits()) }
    }

    fn check_ln(x: f64) {
        assert!(apart(ln(x), x.ln()) <= 1, "ln({x:e}) = {:e}, not {:e}", ln(x), x.ln());
    }

    fn check_power(base: f64, exponent: f64, steps: u64) {
        let (ours, theirs) = (power(base, exponent), base.powf(exponent));
        assert!(apart(ours, theirs) <= steps, "{base:e}^{exponent:e} = {ours:e}, not {theirs:e}");
    }

    const EDGES: [f64; 12] =
        [0.0, 5e-324, f64::MIN_POSITIVE, 0.5, 1.0, 1.5, 2.0, 3.0, 1e300, f64::MAX, f64::INFINITY, f64::NAN];

    #[test]
    fn logarithms_are_those_of_the_standard_library_or_their_neighbours() {
        for x in EDGES {
            [x, -x, x.next_up(), x.next_down()].into_iter().for_each(check_ln);
        }
        let mut random = Random(4);
        for _ in 0..1_000_000 {
            check_ln(random.any());
            check_ln(random.near(-1..1, 0).abs());
            check_ln(1.0 + random.near(-52..-1, 0));
        }
        assert_eq!(ln(1.0).to_bits(), 0);
    }

    #[test]
    fn powers_are_those_of_the_standard_library_or_their_neighbours() {
        for base in EDGES {
            for exponent in EDGES {
                check_power(base, exponent, 1);
                check_power(base, -exponent, 1);
            }
        }
        assert!(power(-2.0, 3.0).is_nan());
        let mut random = Random(5);
        for _ in 0..1_000_000 {
            check_power(random.near(-12..4, 0).abs(), random.near(-3..3, 0), 1);
            check_power(random.near(-1022..1023, 0).abs(), random.near(-3..3, 0), 1);
            let exponent = random.near(3..12, 0);
            check_power(random.near(-1..1, 0).abs(), exponent, 2 + (exponent.abs() / 30.0) as u64);
        }
    }
}
