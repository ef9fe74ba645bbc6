//! `[ensemble]`: many runs of one case, with some of its values drawn at random.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

mod distribution;
mod normal;
mod parameter;
mod points;
mod vary;

pub use parameter::{Column, Drawn};

use crate::fault::CaseError;
use crate::look::Look;
use parameter::Parameter;
use points::Points;
use vary::Vary;

/// More members than this are refused.
pub const MOST_MEMBERS: u32 = 1_000_000;

/// How the values of the members are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Sampling {
    /// A Sobol sequence, scrambled by the seed: the members fill the space of values evenly.
    #[default]
    Sobol,
    /// A Latin hypercube: of each value every part of equal probability comes once.
    LatinHypercube,
    /// Independently of each other.
    Random,
    /// Every combination of `levels` values of each key.
    Grid,
}

/// Many runs of this case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Ensemble")]
pub(crate) struct Words {
    /// Number of runs; a grid has as many as there are combinations.
    #[serde(skip_serializing_if = "Option::is_none")]
    members: Option<u32>,
    /// Another seed draws other values (default 0).
    #[serde(default)]
    seed: u64,
    /// How the values are drawn (default "sobol").
    #[serde(default)]
    sampling: Sampling,
    /// What differs between the runs: a key of the case in quotes, and how its value is distributed.
    vary: BTreeMap<String, Vary>,
    /// Thresholds of which maps say how probable it is that they are exceeded.
    #[serde(default)]
    exceed: Exceed,
    /// Percentiles of the peaks, in percent (default 5, 50, 95); an empty list for none.
    #[serde(default = "usual_percentiles")]
    percentiles: Vec<f64>,
    /// Classes that a doubling of a value is divided into for the percentiles: 4, 8, 16, 32 or 64 (default 16).
    #[serde(skip_serializing_if = "Option::is_none")]
    classes: Option<u32>,
}

fn usual_percentiles() -> Vec<f64> {
    vec![5.0, 50.0, 95.0]
}

/// Thresholds of peaks, each under the name of its map.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Exceed {
    /// Of the peak thickness normal to the bed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub peak_thickness: Vec<f64>,
    /// Of the peak speed along the bed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub peak_speed: Vec<f64>,
    /// Of the peak dynamic pressure in kPa (terrain).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub peak_pressure: Vec<f64>,
}

/// An ensemble that was checked: how many runs, what each of them changes, and what is asked of all.
#[derive(Debug, Clone, PartialEq)]
pub struct Ensemble {
    /// Number of runs.
    pub members: u32,
    /// The seed.
    pub seed: u64,
    /// How the values are drawn.
    pub sampling: Sampling,
    /// Thresholds of peaks.
    pub exceed: Exceed,
    /// Percentiles of the peaks, in percent.
    pub percentiles: Vec<f64>,
    /// Classes that a doubling of a value is divided into for the percentiles.
    pub classes: u32,
    parameters: Vec<Parameter>,
    points: Points,
}

/// A member of an ensemble: what it changes in the case.
#[derive(Debug, Clone, PartialEq)]
pub struct Member {
    /// Its number, from 0.
    pub number: u32,
    /// Its values, in the order of [`Ensemble::columns`].
    pub values: Vec<Drawn>,
    /// The overrides `key.path=value` that make its case.
    pub overrides: Vec<String>,
}

impl fmt::Display for Ensemble {
    fn fmt(&self, to: &mut fmt::Formatter) -> fmt::Result {
        let sampling = match self.sampling {
            Sampling::Sobol => "a Sobol sequence",
            Sampling::LatinHypercube => "a Latin hypercube",
            Sampling::Random => "drawn independently",
            Sampling::Grid => "all combinations",
        };
        let (members, seed) = (self.members, self.seed);
        let keys: Vec<&str> = self.parameters.iter().map(|parameter| parameter.key.as_str()).collect();
        write!(to, "{members} members, {sampling}, seed {seed}: {}", keys.join(", "))
    }
}

impl Ensemble {
    /// The columns of a table of the members: key of the case, and number of the feature where there are several.
    #[must_use]
    pub fn columns(&self) -> Vec<Column> {
        self.parameters.iter().flat_map(Parameter::columns).collect()
    }

    /// What member `number` changes in the case: a pure function of the case and the number, so that any member can be computed
    /// anywhere, alone and again.
    ///
    /// # Panics
    /// If there is no such member.
    #[must_use]
    pub fn sample(&self, number: u32) -> Member {
        assert!(number < self.members, "member {number} of an ensemble of {}", self.members);
        let (mut values, mut overrides, mut dimension) = (Vec::new(), Vec::new(), 0);
        for parameter in &self.parameters {
            let count = parameter.dimensions();
            let places: Vec<f64> = (0..count).map(|k| self.points.at(number, dimension + k)).collect();
            let (drawn, change) = parameter.draw(&places);
            values.extend(drawn);
            overrides.push(change);
            dimension += count;
        }
        Member { number, values, overrides }
    }

    /// Overrides of one key each, with the value at each end of its distribution or each of its choices, and the key of the case that
    /// is to blame where the case does not take one.
    pub(crate) fn trials(&self) -> Vec<(String, String)> {
        let of = |parameter: &Parameter| {
            let place = format!("ensemble.vary.{}", parameter.key);
            parameter.trials().into_iter().map(move |change| (place.clone(), change)).collect::<Vec<_>>()
        };
        self.parameters.iter().flat_map(of).collect()
    }
}

impl Words {
    /// Checks what can be said without trying a member.
    pub fn check(&self, look: &Look, pressure: bool) -> Result<Ensemble, CaseError> {
        let Self { members, seed, sampling, vary, exceed, percentiles, classes } = self;
        exceed.check(look, pressure)?;
        for (k, percent) in percentiles.iter().enumerate() {
            let key = format!("ensemble.percentiles[{k}]");
            let fits = |v: f64| (0.01..=99.99).contains(&v);
            look.number(&key, *percent, fits, "percent, from 0.01 to 99.99")?;
            once(look, &key, &percentiles[..k], *percent)?;
        }
        let classes = classes.unwrap_or(16);
        if !(classes.is_power_of_two() && (4..=64).contains(&classes)) {
            let message = format!("found {classes}, which is not one of the choices");
            return Err(look.fault("ensemble.classes", message, "allowed: 4, 8, 16, 32, 64"));
        }
        if vary.is_empty() {
            let message = "nothing differs between the members";
            let cure = "add a key of the case, as in vary.\"material.friction.coulomb.mu\" = { uniform = [0.25, 0.45] }";
            return Err(look.fault("ensemble.vary", message, cure));
        }
        disjoint(look, vary)?;
        let of = |(key, vary): (&String, &Vary)| vary.check(look, key, *sampling);
        let parameters: Vec<Parameter> = vary.iter().map(of).collect::<Result<_, _>>()?;
        let levels: Vec<u32> = parameters.iter().flat_map(Parameter::levels).collect();
        let members = counted(look, *members, *sampling, &levels)?;
        let points = Points { sampling: *sampling, seed: *seed, members, levels };
        let (exceed, percentiles) = (exceed.clone(), percentiles.clone());
        Ok(Ensemble {
            members,
            seed: *seed,
            sampling: *sampling,
            exceed,
            percentiles,
            classes,
            parameters,
            points,
        })
    }
}

impl Exceed {
    fn check(&self, look: &Look, pressure: bool) -> Result<(), CaseError> {
        if !pressure && !self.peak_pressure.is_empty() {
            let message = "there is no pressure on a chute, only on [terrain]";
            return Err(look.fault(
                "ensemble.exceed.peak_pressure",
                message,
                "write thresholds of the speed instead",
            ));
        }
        for (name, list) in [
            ("peak_thickness", &self.peak_thickness),
            ("peak_speed", &self.peak_speed),
            ("peak_pressure", &self.peak_pressure),
        ] {
            for (k, threshold) in list.iter().enumerate() {
                let key = format!("ensemble.exceed.{name}[{k}]");
                let fits = |v: f64| (1e-9..=1e12).contains(&v);
                look.number(&key, *threshold, fits, "a number from 1e-9 to 1e12")?;
                once(look, &key, &list[..k], *threshold)?;
            }
        }
        Ok(())
    }
}

/// Maps are named by their value, which none `before` may be.
fn once(look: &Look, key: &str, before: &[f64], value: f64) -> Result<(), CaseError> {
    if before.contains(&value) {
        return Err(look.fault(key, format!("{value} stands here twice"), "remove one of them"));
    }
    Ok(())
}

/// How many members there are.
fn counted(look: &Look, members: Option<u32>, sampling: Sampling, levels: &[u32]) -> Result<u32, CaseError> {
    let key = "ensemble.members";
    if sampling == Sampling::Grid {
        let product = levels.iter().map(|count| u64::from(*count)).product::<u64>();
        let most = u64::from(MOST_MEMBERS);
        if product > most {
            let message = format!("the grid has {product} combinations, more than {most}");
            return Err(look.fault(
                "ensemble.sampling",
                message,
                "take fewer levels, or sampling = \"sobol\"",
            ));
        }
        let product = product as u32;
        return match members.filter(|members| *members != product) {
            None => Ok(product),
            Some(other) => {
                let message = format!("found {other}, and the grid has {product} combinations");
                Err(look.fault(key, message, "leave members out: a grid has all combinations"))
            }
        };
    }
    let Some(members) = members else {
        return Err(look.fault(
            key,
            "the key `members` is missing",
            "say how many runs, for instance members = 256",
        ));
    };
    let most = if sampling == Sampling::Sobol { points::SOBOL[0] } else { MOST_MEMBERS };
    if members == 0 || members > most {
        let message = format!("found {members}, expected 1 to {most}");
        return Err(look.fault(
            key,
            message,
            "sampling = \"latin_hypercube\" or \"random\" take up to 1000000",
        ));
    }
    if sampling == Sampling::Sobol && levels.len() > points::SOBOL[1] as usize {
        let message = format!("{} values differ, a Sobol sequence has {}", levels.len(), points::SOBOL[1]);
        return Err(look.fault("ensemble.sampling", message, "take sampling = \"latin_hypercube\""));
    }
    Ok(members)
}

/// No key lies within another one.
fn disjoint(look: &Look, vary: &BTreeMap<String, Vary>) -> Result<(), CaseError> {
    let within = |inner: &str, outer: &str| {
        inner.strip_prefix(outer).is_some_and(|rest| rest.starts_with('.') && inner != outer)
    };
    for inner in vary.keys() {
        if let Some(outer) = vary.keys().find(|outer| within(inner, outer)) {
            let message = format!("`{inner}` is a part of `{outer}`, which differs too");
            return Err(look.fault(&format!("ensemble.vary.{inner}"), message, "keep one of the two"));
        }
    }
    Ok(())
}
