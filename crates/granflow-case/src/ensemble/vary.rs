//! What a case writes of a key that differs between the members.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Sampling;
use super::distribution::{Distribution, Lognormal, Normal};
use super::parameter::{Draw, Parameter, quoted};
use crate::fault::CaseError;
use crate::look::Look;

/// Half the width of a 95 % interval of a normal distribution, in standard deviations.
const CI95: f64 = 1.959_963_984_540_054;
/// Levels of a key on a grid at most.
const MOST_LEVELS: u32 = 10_000;

/// How the value of a key is distributed: exactly one of uniform, normal, lognormal, choice, factor, ci95.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Vary {
    /// Every value between two numbers is as probable as any other.
    #[serde(skip_serializing_if = "Option::is_none")]
    uniform: Option<[f64; 2]>,
    /// A normal distribution.
    #[serde(skip_serializing_if = "Option::is_none")]
    normal: Option<Normal>,
    /// A lognormal distribution.
    #[serde(skip_serializing_if = "Option::is_none")]
    lognormal: Option<Lognormal>,
    /// One of these values, each as probable as the others: numbers, words, files, tables.
    #[serde(skip_serializing_if = "Option::is_none")]
    choice: Option<Vec<serde_json::Value>>,
    /// The value of the case times a number that is distributed.
    #[serde(skip_serializing_if = "Option::is_none")]
    factor: Option<Factor>,
    /// Of release.N.thickness by an attribute: the attribute with half the width of the 95 % interval of each feature's thickness;
    /// each feature has a value of its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    ci95: Option<String>,
    /// The unit of the values, for a key that is written with one: "deg".
    #[serde(skip_serializing_if = "Option::is_none")]
    unit: Option<String>,
    /// How many values a grid takes, in the middle of parts of equal probability.
    #[serde(skip_serializing_if = "Option::is_none")]
    levels: Option<u32>,
}

/// How a factor is distributed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum Factor {
    /// Every value between two numbers is as probable as any other.
    Uniform([f64; 2]),
    /// A normal distribution.
    Normal(Normal),
    /// A lognormal distribution.
    Lognormal(Lognormal),
}

/// Keys that no member may change: the maps of the members could not be added, or nothing would change.
const FIXED: [&str; 9] =
    ["ensemble", "gauge", "grid", "model", "output", "section", "terrain.cell", "terrain.region", "title"];

impl Vary {
    pub fn check(&self, look: &Look, key: &str, sampling: Sampling) -> Result<Parameter, CaseError> {
        let place = format!("ensemble.vary.{key}");
        let within = |fixed: &&&str| {
            key.strip_prefix(**fixed).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        if let Some(fixed) = FIXED.iter().find(within) {
            let message = format!("`{fixed}` cannot differ between the members of an ensemble");
            return Err(look.fault(
                &place,
                message,
                "their maps have the same cells; vary material, release, initial or scheme",
            ));
        }
        let draw = self.draw(look, key, &place)?;
        let levels = self.on_grid(look, &place, &draw, sampling)?;
        Ok(Parameter { key: key.to_owned(), draw, levels })
    }

    fn draw(&self, look: &Look, key: &str, place: &str) -> Result<Draw, CaseError> {
        let Self { uniform, normal, lognormal, choice, factor, ci95, unit, .. } = self;
        let unit = unit.clone();
        match (uniform, normal, lognormal, choice, factor, ci95) {
            (Some(ends), None, None, None, None, None) => {
                Ok(Draw::Number(Distribution::uniform(look, &format!("{place}.uniform"), *ends)?, unit))
            }
            (None, Some(normal), None, None, None, None) => {
                Ok(Draw::Number(Distribution::normal(look, &format!("{place}.normal"), normal)?, unit))
            }
            (None, None, Some(lognormal), None, None, None) => Ok(Draw::Number(
                Distribution::lognormal(look, &format!("{place}.lognormal"), lognormal)?,
                unit,
            )),
            (None, None, None, Some(choices), None, None) if unit.is_none() => {
                chosen(look, &format!("{place}.choice"), choices)
            }
            (None, None, None, None, Some(factor), None) if unit.is_none() => {
                multiplied(look, key, &format!("{place}.factor"), factor)
            }
            (None, None, None, None, None, Some(attribute)) if unit.is_none() => {
                each_feature(look, key, &format!("{place}.ci95"), attribute)
            }
            _ if unit.is_some() => {
                let message = "`unit` belongs to uniform, normal or lognormal";
                Err(look.fault(
                    &format!("{place}.unit"),
                    message,
                    "remove it, and keep one of these three beside it",
                ))
            }
            _ => {
                let message = "a key has exactly one of uniform, normal, lognormal, choice, factor, ci95";
                Err(look.fault(
                    place,
                    message,
                    "write for instance { uniform = [0.25, 0.45] }; a key with dots stands in quotes",
                ))
            }
        }
    }

    fn on_grid(&self, look: &Look, place: &str, draw: &Draw, sampling: Sampling) -> Result<u32, CaseError> {
        let key = format!("{place}.levels");
        match (sampling, draw, self.levels) {
            (Sampling::Grid, Draw::Choice(choices), None) => Ok(choices.len() as u32),
            (_, Draw::Choice(_), Some(_)) => {
                Err(look.fault(&key, "a choice has its own values", "remove levels"))
            }
            (Sampling::Grid, _, Some(levels)) if (1..=MOST_LEVELS).contains(&levels) => Ok(levels),
            (Sampling::Grid, _, Some(levels)) => Err(look.fault(
                &key,
                format!("found {levels}, expected 1 to {MOST_LEVELS}"),
                "for instance levels = 5",
            )),
            (Sampling::Grid, _, None) => {
                Err(look.fault(place, "a grid needs the number of values of each key", "add levels = 5"))
            }
            (_, _, Some(_)) => Err(look.fault(
                &key,
                "`levels` belongs to sampling = \"grid\"",
                "remove it, or write sampling = \"grid\"",
            )),
            (_, _, None) => Ok(1),
        }
    }
}

/// The values of a choice, as TOML.
fn chosen(look: &Look, place: &str, choices: &[serde_json::Value]) -> Result<Draw, CaseError> {
    if choices.is_empty() {
        return Err(look.fault(place, "there is nothing to choose from", "give at least one value"));
    }
    let written = |one: &serde_json::Value| {
        toml::Value::try_from(one).map(|value| inline(&value)).map_err(|_| {
            look.fault(place, format!("{one} is no value of a case"), "give numbers, words, lists or tables")
        })
    };
    Ok(Draw::Choice(choices.iter().map(written).collect::<Result<_, _>>()?))
}

/// A value on one line.
fn inline(value: &toml::Value) -> String {
    let list = |parts: Vec<String>| parts.join(", ");
    match value {
        toml::Value::Table(table) => {
            let entry =
                |(key, value): (&String, &toml::Value)| format!("{} = {}", quoted(key), inline(value));
            format!("{{ {} }}", list(table.iter().map(entry).collect()))
        }
        toml::Value::Array(values) => format!("[{}]", list(values.iter().map(inline).collect())),
        other => other.to_string(),
    }
}

/// A factor of what the case writes under the key.
fn multiplied(look: &Look, key: &str, place: &str, factor: &Factor) -> Result<Draw, CaseError> {
    let distribution = match factor {
        Factor::Uniform(ends) => Distribution::uniform(look, &format!("{place}.uniform"), *ends)?,
        Factor::Normal(normal) => Distribution::normal(look, &format!("{place}.normal"), normal)?,
        Factor::Lognormal(lognormal) => {
            Distribution::lognormal(look, &format!("{place}.lognormal"), lognormal)?
        }
    };
    let refused = |found: &str| {
        let message = format!("a factor needs a number under `{key}`, {found}");
        look.fault(
            place,
            message,
            "write the number there, or give the values themselves, as in { uniform = [0.2, 0.4] }",
        )
    };
    match look.source.value(key) {
        Some(toml::Value::Float(base)) => Ok(Draw::Times(distribution, base, None)),
        Some(toml::Value::Integer(base)) => Ok(Draw::Times(distribution, base as f64, None)),
        Some(toml::Value::String(text)) => {
            let number = text.split_once(' ').and_then(|(number, unit)| {
                Some((number.parse::<f64>().ok().filter(|base| base.is_finite())?, unit.trim()))
            });
            let (base, unit) = number.ok_or_else(|| refused(&format!("found the text \"{text}\"")))?;
            Ok(Draw::Times(distribution, base, Some(unit.to_owned())))
        }
        Some(toml::Value::Table(table)) => match attribute_of(&table) {
            Some(name) => Ok(Draw::TimesAttribute(distribution, name.to_owned())),
            None => Err(refused("found a table")),
        },
        Some(_) => Err(refused("found something else")),
        None => Err(refused("and the case says nothing there")),
    }
}

/// The name in { attribute = "name" }.
fn attribute_of(table: &toml::Table) -> Option<&str> {
    if table.len() == 1 { table.get("attribute")?.as_str() } else { None }
}

/// A thickness for each feature of the polygons of a release, normally distributed about its attribute.
fn each_feature(look: &Look, key: &str, place: &str, interval: &str) -> Result<Draw, CaseError> {
    let of = |name: &str| look.source.value(&format!("{}.{name}", key.strip_suffix(".thickness")?));
    let (Some(toml::Value::String(path)), Some(toml::Value::Table(thickness))) =
        (of("polygons"), of("thickness"))
    else {
        let message = format!("`{key}` is no thickness by an attribute of polygons");
        return Err(look.fault(
            place,
            message,
            "it belongs to release.N.thickness = { attribute = \"thickness\" }, N from 0",
        ));
    };
    let Some(attribute) = attribute_of(&thickness) else {
        let message = format!("`{key}` names no attribute alone");
        return Err(look.fault(place, message, "write thickness = { attribute = \"thickness\" }"));
    };
    let path = look.locate(path.as_ref());
    let numbers = |name: &str| {
        look.files.numbers(&path, name).map_err(|message| {
            look.fault(place, message, "the attribute holds half the width of the interval, in metres").file()
        })
    };
    let (means, widths) = (numbers(attribute)?, numbers(interval)?);
    let of = |(mean, width): (&f64, &f64)| {
        let ends = [0.0, f64::INFINITY];
        match *width > 0.0 {
            true => Distribution::Normal { mean: *mean, sd: width / CI95, ends },
            false => Distribution::Uniform([*mean; 2]),
        }
    };
    Ok(Draw::Features(means.iter().zip(&widths).map(of).collect()))
}
