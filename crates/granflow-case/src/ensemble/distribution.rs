//! How a number of a case is distributed: what a case writes, checked, and its quantiles.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::normal::{quantile, quantile_between};
use crate::fault::CaseError;
use crate::look::Look;

/// Shares at which an end is tried that has no bound.
const TRIED: f64 = 1e-4;

/// A normal distribution, cut off below `min` and above `max`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Normal {
    /// Its mean where nothing is cut off.
    mean: f64,
    /// Its standard deviation where nothing is cut off.
    sd: f64,
    /// No value is smaller.
    #[serde(skip_serializing_if = "Option::is_none")]
    min: Option<f64>,
    /// No value is larger.
    #[serde(skip_serializing_if = "Option::is_none")]
    max: Option<f64>,
}

/// A value whose logarithm is normally distributed, cut off below `min` and above `max`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Lognormal {
    /// The value with half of the others below, where nothing is cut off.
    median: f64,
    /// The standard deviation of its natural logarithm.
    sigma: f64,
    /// No value is smaller.
    #[serde(skip_serializing_if = "Option::is_none")]
    min: Option<f64>,
    /// No value is larger.
    #[serde(skip_serializing_if = "Option::is_none")]
    max: Option<f64>,
}

/// How a number is distributed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Distribution {
    Uniform([f64; 2]),
    Normal { mean: f64, sd: f64, ends: [f64; 2] },
    Lognormal { median: f64, sigma: f64, ends: [f64; 2] },
}

impl Distribution {
    pub fn uniform(look: &Look, key: &str, [low, high]: [f64; 2]) -> Result<Self, CaseError> {
        if low.is_finite() && high.is_finite() && low < high {
            return Ok(Self::Uniform([low, high]));
        }
        let message = format!("found [{low}, {high}], expected a lower and a larger number");
        Err(look.fault(key, message, "write it as uniform = [0.2, 0.4]"))
    }

    pub fn normal(look: &Look, key: &str, Normal { mean, sd, min, max }: &Normal) -> Result<Self, CaseError> {
        look.number(&format!("{key}.mean"), *mean, |_| true, "a finite number")?;
        look.positive(&format!("{key}.sd"), Some(*sd))?;
        let ends = ends(look, key, [*min, *max], [f64::NEG_INFINITY, f64::INFINITY])?;
        // Beyond 30 deviations there is no share left that a number could hold.
        if (ends[0] - mean) / sd > 30.0 || (mean - ends[1]) / sd > 30.0 {
            let message = "nothing of the distribution is left between min and max";
            return Err(look.fault(
                key,
                message,
                "move min and max to where the values are, or leave them out",
            ));
        }
        Ok(Self::Normal { mean: *mean, sd: *sd, ends })
    }

    pub fn lognormal(
        look: &Look,
        key: &str,
        Lognormal { median, sigma, min, max }: &Lognormal,
    ) -> Result<Self, CaseError> {
        look.positive(&format!("{key}.median"), Some(*median))?;
        look.number(&format!("{key}.sigma"), *sigma, |v| v > 0.0 && v <= 10.0, "a number > 0, at most 10")?;
        let ends = ends(look, key, [*min, *max], [0.0, f64::INFINITY])?;
        let log = |end: f64| libm::log(end / median) / sigma;
        if log(ends[0]) > 30.0 || log(ends[1]) < -30.0 {
            let message = "nothing of the distribution is left between min and max";
            return Err(look.fault(
                key,
                message,
                "move min and max to where the values are, or leave them out",
            ));
        }
        Ok(Self::Lognormal { median: *median, sigma: *sigma, ends })
    }

    /// The value that a share `p` of the members is below, 0 < p < 1.
    pub fn quantile(&self, p: f64) -> f64 {
        match *self {
            Self::Uniform([low, high]) => (low + p * (high - low)).clamp(low, high),
            Self::Normal { mean, sd, ends } => {
                let z = standard(p, ends.map(|end| (end - mean) / sd));
                (mean + sd * z).clamp(ends[0], ends[1])
            }
            Self::Lognormal { median, sigma, ends } => {
                let z = standard(p, ends.map(|end| libm::log(end / median) / sigma));
                (median * libm::exp(sigma * z)).clamp(ends[0], ends[1])
            }
        }
    }

    /// The values at which it is tried whether the case takes them: its ends, where it has none those that one member in 10000
    /// goes beyond.
    pub fn tried(&self) -> [f64; 2] {
        match *self {
            Self::Uniform(ends) => ends,
            Self::Normal { ends, .. } | Self::Lognormal { ends, .. } => {
                let tried = [self.quantile(TRIED), self.quantile(1.0 - TRIED)];
                let written = |k: usize| ends[k].is_finite() && (ends[k] != 0.0 || tried[k] == 0.0);
                [0, 1].map(|k| if written(k) { ends[k] } else { tried[k] })
            }
        }
    }
}

/// A standard normal quantile, between ends where there are some.
fn standard(p: f64, ends: [f64; 2]) -> f64 {
    if ends == [f64::NEG_INFINITY, f64::INFINITY] { quantile(p) } else { quantile_between(p, ends) }
}

/// The ends of a distribution, those of `whole` where none are written.
fn ends(
    look: &Look,
    key: &str,
    [min, max]: [Option<f64>; 2],
    whole: [f64; 2],
) -> Result<[f64; 2], CaseError> {
    for (name, end) in [("min", min), ("max", max)] {
        if let Some(end) = end {
            look.number(&format!("{key}.{name}"), end, |v| v >= whole[0], "a finite number in its range")?;
        }
    }
    let ends = [min.unwrap_or(whole[0]), max.unwrap_or(whole[1])];
    if ends[0] < ends[1] {
        return Ok(ends);
    }
    let message = format!("min = {} is not below max = {}", ends[0], ends[1]);
    Err(look.fault(&format!("{key}.min"), message, "exchange the two, or leave one out"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean and standard deviation of many quantiles.
    fn moments(distribution: &Distribution) -> [f64; 2] {
        let values: Vec<f64> =
            (0..100_000).map(|k| distribution.quantile((f64::from(k) + 0.5) / 1e5)).collect();
        let mean = values.iter().sum::<f64>() / 1e5;
        [mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 1e5).sqrt()]
    }

    #[test]
    fn the_moments_are_those_of_the_distributions() {
        let near = |found: f64, wanted: f64| assert!((found / wanted - 1.0).abs() < 2e-3, "{found} {wanted}");
        let [mean, sd] = moments(&Distribution::Uniform([2.0, 6.0]));
        near(mean, 4.0);
        near(sd, 4.0 / 12_f64.sqrt());
        let ends = [f64::NEG_INFINITY, f64::INFINITY];
        let [mean, sd] = moments(&Distribution::Normal { mean: 3.0, sd: 0.5, ends });
        near(mean, 3.0);
        near(sd, 0.5);
        // cut off at one deviation on both sides: the variance is 1 - 2 phi(1) / (2 Phi(1) - 1) = 0.29112
        let [mean, sd] = moments(&Distribution::Normal { mean: 3.0, sd: 0.5, ends: [2.5, 3.5] });
        near(mean, 3.0);
        near(sd, 0.5 * 0.291_12_f64.sqrt());
        let [mean, sd] = moments(&Distribution::Lognormal { median: 2.0, sigma: 0.3, ends: [0.0, 1e300] });
        near(mean, 2.0 * 0.045_f64.exp());
        near(sd, 2.0 * 0.045_f64.exp() * (0.09_f64.exp() - 1.0).sqrt());
    }

    #[test]
    fn values_stay_between_their_ends() {
        let cut = Distribution::Lognormal { median: 2.0, sigma: 0.3, ends: [1.9, 2.2] };
        assert!((1..1000).all(|k| (1.9..=2.2).contains(&cut.quantile(f64::from(k) / 1000.0))));
        assert_eq!(cut.tried(), [1.9, 2.2]);
        let open = Distribution::Lognormal { median: 2.0, sigma: 0.3, ends: [0.0, f64::INFINITY] };
        assert!(open.tried()[0] > 0.6 && open.tried()[1] < 6.2);
    }
}
