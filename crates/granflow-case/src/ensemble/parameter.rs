//! A key of a case that differs between the members: what a member takes.

use super::distribution::Distribution;

/// A key that differs between the members, checked.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Parameter {
    /// The key of the case, its parts divided by dots.
    pub key: String,
    /// What is drawn.
    pub draw: Draw,
    /// Values on a grid.
    pub levels: u32,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Draw {
    /// A number, with the unit that is written after it.
    Number(Distribution, Option<String>),
    /// A factor of a number.
    Times(Distribution, f64, Option<String>),
    /// A factor of the thickness that an attribute holds.
    TimesAttribute(Distribution, String),
    /// One of these values, as TOML.
    Choice(Vec<String>),
    /// A thickness for each feature: mean and standard deviation.
    Features(Vec<Distribution>),
}

/// A column of a table of the members.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// The key, with the number of the feature or `factor` where it is one.
    pub name: String,
    /// What may be chosen, as TOML, where it is a choice.
    pub choices: Option<Vec<String>>,
}

/// What was drawn for a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drawn {
    /// A number.
    Number(f64),
    /// The number of a choice, from 0.
    Choice(usize),
}

impl Drawn {
    /// The number, or that of the choice.
    #[must_use]
    pub fn value(self) -> f64 {
        match self {
            Self::Number(value) => value,
            Self::Choice(index) => index as f64,
        }
    }
}

impl Parameter {
    pub fn columns(&self) -> Vec<Column> {
        let one = |name: String, choices| vec![Column { name, choices }];
        match &self.draw {
            Draw::Number(..) | Draw::Times(..) => one(self.key.clone(), None),
            Draw::TimesAttribute(..) => one(format!("{}.factor", self.key), None),
            Draw::Choice(choices) => one(self.key.clone(), Some(choices.clone())),
            Draw::Features(features) => {
                let name = |k| format!("{}.{k}", self.key);
                (0..features.len()).map(|k| Column { name: name(k), choices: None }).collect()
            }
        }
    }

    /// How many places of a point it takes.
    pub fn dimensions(&self) -> usize {
        match &self.draw {
            Draw::Features(features) => features.len(),
            _ => 1,
        }
    }

    /// Levels of each dimension.
    pub fn levels(&self) -> Vec<u32> {
        vec![self.levels; self.dimensions()]
    }

    /// The values at places in (0, 1), one each dimension, and the override that sets them.
    pub fn draw(&self, places: &[f64]) -> (Vec<Drawn>, String) {
        match &self.draw {
            Draw::Choice(choices) => {
                let index = ((places[0] * choices.len() as f64) as usize).min(choices.len() - 1);
                (vec![Drawn::Choice(index)], format!("{}={}", self.key, choices[index]))
            }
            Draw::Number(distribution, _)
            | Draw::Times(distribution, ..)
            | Draw::TimesAttribute(distribution, _) => {
                let (value, change) = self.change(distribution.quantile(places[0]));
                (vec![Drawn::Number(value)], change)
            }
            Draw::Features(features) => {
                let values = features.iter().zip(places).map(|(one, place)| one.quantile(*place));
                let values: Vec<f64> = values.collect();
                let change = self.each(&values);
                (values.into_iter().map(Drawn::Number).collect(), change)
            }
        }
    }

    /// The number for the table of members, and the override, of a value that was drawn.
    fn change(&self, drawn: f64) -> (f64, String) {
        let key = &self.key;
        match &self.draw {
            Draw::TimesAttribute(_, attribute) => {
                (drawn, format!("{key}={{attribute={}, factor={drawn:?}}}", quoted(attribute)))
            }
            Draw::Times(_, base, unit) => {
                let value = drawn * base;
                (value, format!("{key}={}", with_unit(value, unit.as_deref())))
            }
            Draw::Number(_, unit) => (drawn, format!("{key}={}", with_unit(drawn, unit.as_deref()))),
            Draw::Choice(_) | Draw::Features(_) => unreachable!("they are no single number"),
        }
    }

    fn each(&self, values: &[f64]) -> String {
        format!("{}={{features={values:?}}}", self.key)
    }

    /// Overrides with the ends of the values, or every choice.
    pub fn trials(&self) -> Vec<String> {
        match &self.draw {
            Draw::Choice(choices) => choices.iter().map(|one| format!("{}={one}", self.key)).collect(),
            Draw::Number(distribution, _)
            | Draw::Times(distribution, ..)
            | Draw::TimesAttribute(distribution, _) => {
                distribution.tried().map(|value| self.change(value).1).to_vec()
            }
            Draw::Features(features) => {
                let end = |k: usize| features.iter().map(|one| one.tried()[k]).collect::<Vec<f64>>();
                [0, 1].map(|k| self.each(&end(k))).to_vec()
            }
        }
    }
}

pub(super) fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// A number as TOML writes it, all its digits; in quotes with a unit.
fn with_unit(value: f64, unit: Option<&str>) -> String {
    match unit {
        None => format!("{value:?}"),
        Some(unit) => quoted(&format!("{value} {unit}")),
    }
}
