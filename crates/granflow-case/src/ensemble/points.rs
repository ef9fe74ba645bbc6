//! The points of a sample in the unit cube: each a pure function of seed, member and dimension.

use super::Sampling;

/// How many members a Sobol sequence has points for, and how many dimensions.
pub(super) const SOBOL: [u32; 2] = [1 << 16, sobol_burley::NUM_DIMENSIONS];

/// 2^64 over the golden ratio: steps of it reach all numbers evenly.
const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

/// What a sample is drawn by.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Points {
    pub sampling: Sampling,
    pub seed: u64,
    pub members: u32,
    /// How many values each dimension has, where that is asked for: choices and the levels of a grid.
    pub levels: Vec<u32>,
}

impl Points {
    /// The place of a member along a dimension, in (0, 1).
    pub fn at(&self, member: u32, dimension: usize) -> f64 {
        let along = dimension as u64;
        match self.sampling {
            Sampling::Random => unit(hash([self.seed, 1, along, u64::from(member)])),
            Sampling::LatinHypercube => {
                let stratum = permuted(member, self.members, hash([self.seed, 2, along, 0]));
                let within = unit(hash([self.seed, 3, along, u64::from(member)]));
                ((f64::from(stratum) + within) / f64::from(self.members)).min(1.0 - f64::EPSILON)
            }
            Sampling::Sobol => {
                let seed = hash([self.seed, 4, 0, 0]) as u32;
                // Multiples of 2^-23: half of that keeps both ends away.
                f64::from(sobol_burley::sample(member, dimension as u32, seed)) + 0.5 / f64::from(1 << 23)
            }
            Sampling::Grid => {
                let inner: u32 = self.levels[dimension + 1..].iter().product();
                let levels = self.levels[dimension];
                (f64::from(member / inner % levels) + 0.5) / f64::from(levels)
            }
        }
    }
}

/// A number from four, every bit of each changing half of its bits: the finalizer of SplitMix64 (Steele, Lea & Flood 2014), taken once a number.
fn hash(numbers: [u64; 4]) -> u64 {
    numbers.into_iter().fold(0, |state, number| {
        let z = (state ^ number).wrapping_add(STEP);
        let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    })
}

/// A number in (0, 1) from random bits.
fn unit(bits: u64) -> f64 {
    ((bits >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
}

/// Number `index` of a random order of 0..count: a Feistel network on the next even power of two, walked until it comes back below
/// `count`. So any place of the order is found without the others.
fn permuted(index: u32, count: u32, key: u64) -> u32 {
    let half = (32 - (count - 1).leading_zeros()).div_ceil(2).max(1);
    let mask = (1_u32 << half) - 1;
    let mut at = index;
    loop {
        let (mut left, mut right) = (at >> half, at & mask);
        for round in 0..8 {
            (left, right) = (right, left ^ (hash([key, round, u64::from(right), 0]) as u32 & mask));
        }
        at = left << half | right;
        if at < count {
            return at;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(sampling: Sampling, seed: u64, members: u32) -> Points {
        Points { sampling, seed, members, levels: Vec::new() }
    }

    #[test]
    fn an_order_has_every_number_once() {
        for count in [1, 2, 3, 7, 64, 65, 1000, 4097] {
            let mut seen: Vec<u32> = (0..count).map(|index| permuted(index, count, 77)).collect();
            let moved = seen.iter().enumerate().filter(|(k, at)| *k as u32 != **at).count();
            assert!(count < 64 || moved > count as usize * 9 / 10);
            seen.sort_unstable();
            assert!(seen.iter().enumerate().all(|(k, at)| k as u32 == *at), "{count}");
        }
    }

    #[test]
    fn a_latin_hypercube_has_one_member_in_each_stratum_of_each_dimension() {
        let points = points(Sampling::LatinHypercube, 5, 100);
        for dimension in 0..7 {
            let mut strata: Vec<u32> =
                (0..100).map(|member| (points.at(member, dimension) * 100.0) as u32).collect();
            strata.sort_unstable();
            assert_eq!(strata, (0..100).collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_sobol_sequence_has_one_member_in_each_stratum_and_each_elementary_box() {
        let points = points(Sampling::Sobol, 3, 256);
        for dimension in 0..9 {
            let mut strata: Vec<u32> =
                (0..256).map(|member| (points.at(member, dimension) * 256.0) as u32).collect();
            strata.sort_unstable();
            assert_eq!(strata, (0..256).collect::<Vec<_>>(), "{dimension}");
        }
        // The first two dimensions are a (0, 8, 2)-net: every box of 2^-k by 2^-(8-k) holds one of 256 points.
        for k in 0..=8_u32 {
            let of = |member| {
                let [x, y] = [0, 1].map(|dimension| points.at(member, dimension));
                ((x * f64::from(1 << k)) as u32) << (8 - k) | (y * f64::from(1 << (8 - k))) as u32
            };
            let mut boxes: Vec<u32> = (0..256).map(of).collect();
            boxes.sort_unstable();
            assert_eq!(boxes, (0..256).collect::<Vec<_>>(), "{k}");
        }
    }

    /// The square of the centred L2 discrepancy (Hickernell 1998).
    fn discrepancy(points: &Points, dimensions: usize) -> f64 {
        let at = |member: u32, k: usize| points.at(member, k) - 0.5;
        let count = f64::from(points.members);
        let product = |of: &dyn Fn(usize) -> f64| (0..dimensions).map(of).product::<f64>();
        let single: f64 = (0..points.members)
            .map(|i| product(&|k| 1.0 + 0.5 * at(i, k).abs() - 0.5 * at(i, k) * at(i, k)))
            .sum();
        let pairs = (0..points.members).flat_map(|i| (0..points.members).map(move |j| (i, j)));
        let double: f64 = pairs
            .map(|(i, j)| {
                product(&|k| {
                    1.0 + 0.5 * at(i, k).abs() + 0.5 * at(j, k).abs() - 0.5 * (at(i, k) - at(j, k)).abs()
                })
            })
            .sum();
        (13.0_f64 / 12.0).powi(dimensions as i32) - 2.0 / count * single + double / (count * count)
    }

    #[test]
    fn the_discrepancy_of_sobol_is_below_that_of_a_latin_hypercube_and_that_below_random() {
        for seed in 0..10 {
            let [sobol, latin, random] = [Sampling::Sobol, Sampling::LatinHypercube, Sampling::Random]
                .map(|sampling| discrepancy(&points(sampling, seed, 256), 3));
            assert!(20.0 * sobol < random && sobol < latin && latin < random, "{sobol} {latin} {random}");
        }
    }

    #[test]
    fn seeds_give_other_points_and_a_member_always_the_same() {
        for sampling in [Sampling::Sobol, Sampling::LatinHypercube, Sampling::Random] {
            let [one, two] = [1, 2].map(|seed| points(sampling, seed, 500));
            let same = (0..500).filter(|member| one.at(*member, 0) == two.at(*member, 0)).count();
            assert!(same < 5, "{sampling:?} {same}");
            assert!((0..500).all(|member| one.at(member, 3) > 0.0 && one.at(member, 3) < 1.0));
        }
        // The bits of a point are a promise: parts of an ensemble are computed on different machines.
        let bits = |sampling| points(sampling, 1, 100).at(42, 1).to_bits();
        assert_eq!(bits(Sampling::Random), bits(Sampling::Random));
        let mean = (0..500).map(|member| points(Sampling::Random, 9, 500).at(member, 2)).sum::<f64>() / 500.0;
        assert!((mean - 0.5).abs() < 0.06, "{mean}");
    }

    #[test]
    fn a_grid_has_every_combination_once() {
        let grid = Points { sampling: Sampling::Grid, seed: 1, members: 24, levels: vec![2, 3, 4] };
        let mut all: Vec<[u32; 3]> = (0..24)
            .map(|member| [0, 1, 2].map(|k| (grid.at(member, k) * f64::from(grid.levels[k])) as u32))
            .collect();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 24);
        assert_eq!([0, 1].map(|member| grid.at(member, 0)), [0.25, 0.25]);
    }
}
