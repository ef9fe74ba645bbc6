//! The normal distribution, with the same bits on every machine.
//!
//! Logarithm, exponential and error function are those of `libm`, which computes them from + - * / alone: the system's differ
//! from one platform to the next in the last bit.

use std::f64::consts::FRAC_1_SQRT_2;

/// The share of a standard normal distribution below `x`.
pub(super) fn share_below(x: f64) -> f64 {
    0.5 * libm::erfc(-x * FRAC_1_SQRT_2)
}

/// x of which a standard normal distribution has the share `p` below, 0 < p < 1; relative error about 1e-16.
///
/// Source: M. J. Wichura, Algorithm AS 241, PPND16, Applied Statistics 37 (1988) 477-484.
pub(super) fn quantile(p: f64) -> f64 {
    let q = p - 0.5;
    if q.abs() <= 0.425 {
        let r = 0.180_625 - q * q;
        return q * ratio(&CENTRE, r);
    }
    let tail = if q < 0.0 { p } else { 1.0 - p };
    let r = (-libm::log(tail)).sqrt();
    let x = if r <= 5.0 { ratio(&MIDDLE, r - 1.6) } else { ratio(&FAR, r - 5.0) };
    if q < 0.0 { -x } else { x }
}

/// The standard normal distribution between `low` and `high` alone: x of which it has the share `p` below.
pub(super) fn quantile_between(p: f64, [low, high]: [f64; 2]) -> f64 {
    if low > 0.0 {
        // Shares near 1 have no digits left: taken in the other tail.
        return -quantile_between(1.0 - p, [-high, -low]);
    }
    let (below, above) = (share_below(low), share_below(high));
    quantile((below + p * (above - below)).clamp(f64::MIN_POSITIVE, 1.0 - f64::EPSILON)).clamp(low, high)
}

/// Numerator and denominator of a rational function, the constant terms first.
type Rational = [[f64; 8]; 2];

fn ratio([above, below]: &Rational, x: f64) -> f64 {
    let value = |terms: &[f64; 8]| terms.iter().rev().fold(0.0, |sum, term| sum * x + term);
    value(above) / value(below)
}

#[rustfmt::skip]
const CENTRE: Rational = [
    [3.387_132_872_796_366_5, 133.141_667_891_784_38, 1_971.590_950_306_551_3, 13_731.693_765_509_46,
     45_921.953_931_549_87, 67_265.770_927_008_7, 33_430.575_583_588_13, 2_509.080_928_730_122_7],
    [1.0, 42.313_330_701_600_91, 687.187_007_492_057_9, 5_394.196_021_424_751,
     21_213.794_301_586_597, 39_307.895_800_092_71, 28_729.085_735_721_943, 5_226.495_278_852_854],
];

#[rustfmt::skip]
const MIDDLE: Rational = [
    [1.423_437_110_749_683_5, 4.630_337_846_156_546, 5.769_497_221_460_691, 3.647_848_324_763_204_5,
     1.270_458_252_452_368_4, 0.241_780_725_177_450_6, 0.022_723_844_989_269_184, 7.745_450_142_783_414e-4],
    [1.0, 2.053_191_626_637_759, 1.676_384_830_183_803_8, 0.689_767_334_985_1,
     0.148_103_976_427_480_08, 0.015_198_666_563_616_457, 5.475_938_084_995_345e-4, 1.050_750_071_644_416_9e-9],
];

#[rustfmt::skip]
const FAR: Rational = [
    [6.657_904_643_501_103, 5.463_784_911_164_114, 1.784_826_539_917_291_3, 0.296_560_571_828_504_87,
     0.026_532_189_526_576_124, 0.001_242_660_947_388_078_4, 2.711_555_568_743_487_6e-5, 2.010_334_399_292_288_1e-7],
    [1.0, 0.599_832_206_555_888, 0.136_929_880_922_735_8, 0.014_875_361_290_850_615,
     7.868_691_311_456_133e-4, 1.846_318_317_510_054_8e-5, 1.421_511_758_316_446e-7, 2.044_263_103_389_939_8e-15],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quantile_is_the_inverse_of_the_share() {
        for k in 1..20_000 {
            let p = f64::from(k) / 20_000.0;
            assert!((share_below(quantile(p)) / p - 1.0).abs() < 1e-14, "{p}");
        }
        for exponent in 5..300 {
            let p = 10_f64.powi(-exponent);
            let back = share_below(quantile(p));
            assert!((back / p - 1.0).abs() < 1e-12, "{p}: {back}");
        }
        // Abramowitz & Stegun, table 26.5: the bound of a 95 % interval
        assert!((quantile(0.975) - 1.959_963_984_540_054).abs() < 1e-15);
        assert_eq!(quantile(0.5), 0.0);
    }

    #[test]
    fn between_bounds_no_value_leaves_them_and_the_shares_are_kept() {
        for bounds in [[-1.0, 2.0], [3.0, 4.0], [-9.0, -8.0], [f64::NEG_INFINITY, 0.0], [8.0, f64::INFINITY]]
        {
            let mut last = f64::NEG_INFINITY;
            for k in 1..1000 {
                let x = quantile_between(f64::from(k) / 1000.0, bounds);
                assert!(x >= bounds[0] && x <= bounds[1] && x > last, "{bounds:?} {k} {x}");
                last = x;
            }
        }
        let median = quantile_between(0.5, [-1.0, 2.0]);
        let half = share_below(median) - share_below(-1.0);
        assert!((half / (share_below(2.0) - share_below(-1.0)) - 0.5).abs() < 1e-14);
    }
}
