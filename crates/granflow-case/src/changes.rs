//! What differs between two cases, and with what of it a run may go on.

use std::fmt;

use toml::{Table, Value};

/// A key that two cases have differently.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// The key, as in `material.friction.coulomb.mu`.
    pub key: String,
    /// What the first case has there, as TOML.
    pub before: Option<String>,
    /// What the second case has there, as TOML.
    pub after: Option<String>,
    /// The texts in both values: file names may be among them.
    pub texts: Vec<String>,
}

/// What a change means for a run that goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Concerns {
    /// When it ends and what is written: nothing of what is computed.
    Course,
    /// What holds the mass back, from now on.
    Parameters,
    /// What the state stands on, or what its files and maps count on: it cannot go on.
    State,
}

/// Keys, with all below them, that say when a run ends and what is written.
const COURSE: [&str; 3] = ["title", "time", "output"];
/// Keys that hold the mass back.
const PARAMETERS: [&str; 3] = ["material.friction", "material.forest", "material.earth_pressure"];
/// A passive earth pressure acts between two steps, from the start of a run or never.
const PASSIVE: [&str; 2] = ["material.earth_pressure", "active_passive"];
/// Keys below these that files and maps of the run count on.
const COUNTED_ON: [&str; 4] = ["output.threshold", "output.durations", "output.precision", "time.method"];

impl Change {
    /// What it means for a run that goes on.
    #[must_use]
    pub fn concerns(&self) -> Concerns {
        let below = |outer: &&str| {
            self.key.strip_prefix(*outer).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
        };
        if COUNTED_ON.iter().any(below) || self.turns_passive() {
            Concerns::State
        } else if COURSE.iter().any(below) {
            Concerns::Course
        } else if PARAMETERS.iter().any(below) {
            Concerns::Parameters
        } else {
            Concerns::State
        }
    }
}

impl Change {
    /// A passive earth pressure comes or goes.
    fn turns_passive(&self) -> bool {
        let [pressure, passive] = PASSIVE;
        let Some(below) = self.key.strip_prefix(pressure) else { return false };
        let has = |value: &Option<String>| {
            value.as_ref().is_some_and(|value| below.contains(passive) || value.contains(passive))
        };
        has(&self.before) != has(&self.after)
    }
}

impl fmt::Display for Change {
    fn fmt(&self, to: &mut fmt::Formatter) -> fmt::Result {
        let Change { key, before, after, .. } = self;
        match (before, after) {
            (Some(before), Some(after)) => write!(to, "{key} = {after} instead of {before}"),
            (None, Some(after)) => write!(to, "{key} = {after}, which was not there"),
            (Some(before), None) => write!(to, "without {key} = {before}"),
            (None, None) => write!(to, "{key}"),
        }
    }
}

/// The keys in which the second of two cases differs from the first; both are TOML, as
/// [`RunPlan::resolved`](super::RunPlan::resolved) gives it. `None` where one is not.
#[must_use]
pub fn changes(before: &str, after: &str) -> Option<Vec<Change>> {
    let [before, after] = [before, after].map(|text| text.parse::<Table>().ok());
    let mut all = Vec::new();
    compare("", Some(&Value::Table(before?)), Some(&Value::Table(after?)), &mut all);
    Some(all)
}

fn compare(key: &str, before: Option<&Value>, after: Option<&Value>, all: &mut Vec<Change>) {
    let empty = Value::Table(Table::new());
    let tables = match (before, after) {
        (None, Some(Value::Table(_))) => (Some(&empty), after),
        (Some(Value::Table(_)), None) => (before, Some(&empty)),
        _ => (before, after),
    };
    match tables {
        (Some(Value::Table(old)), Some(Value::Table(new))) => {
            let added = new.keys().filter(|name| !old.contains_key(*name));
            for name in old.keys().chain(added) {
                let inner = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
                compare(&inner, old.get(name), new.get(name), all);
            }
        }
        (Some(Value::Array(old)), Some(Value::Array(new))) if old.len() == new.len() => {
            for (index, (old, new)) in old.iter().zip(new).enumerate() {
                compare(&format!("{key}[{index}]"), Some(old), Some(new), all);
            }
        }
        (Some(old), Some(new)) if alike(old, new) => {}
        _ => {
            let mut texts = Vec::new();
            before.into_iter().chain(after).for_each(|value| collect(value, &mut texts));
            let [before, after] = [before, after].map(|value| value.map(written));
            all.push(Change { key: key.to_owned(), before, after, texts });
        }
    }
}

/// A value in one line of TOML.
fn written(value: &Value) -> String {
    match value {
        Value::Table(table) => {
            let inner: Vec<String> =
                table.iter().map(|(key, value)| format!("{key} = {}", written(value))).collect();
            format!("{{ {} }}", inner.join(", "))
        }
        Value::Array(list) => {
            format!("[{}]", list.iter().map(written).collect::<Vec<_>>().join(", "))
        }
        other => other.to_string(),
    }
}

/// 5 and 5.0 are one number.
fn alike(old: &Value, new: &Value) -> bool {
    let number = |value: &Value| value.as_float().or(value.as_integer().map(|whole| whole as f64));
    match (number(old), number(new)) {
        (Some(old), Some(new)) => old == new,
        _ => old == new,
    }
}

fn collect(value: &Value, texts: &mut Vec<String>) {
    match value {
        Value::String(text) => texts.push(text.clone()),
        Value::Array(list) => list.iter().for_each(|inner| collect(inner, texts)),
        Value::Table(table) => table.values().for_each(|inner| collect(inner, texts)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CASE: &str = "title = \"a\"\n[time]\nend = 5\n[material]\nfriction.coulomb = { mu = 0.4 }\n\
                        [[release]]\nraster = \"h.tif\"\n";

    fn told(after: &str) -> Vec<(String, Concerns)> {
        let all = changes(CASE, after).unwrap();
        all.iter().map(|change| (change.to_string(), change.concerns())).collect()
    }

    #[test]
    fn comments_order_and_the_spelling_of_numbers_change_nothing() {
        let other = "# a remark\n[time]\nend = 5.0\n[[release]]\nraster = \"h.tif\"\n[material]\n\
                     friction = { coulomb = { mu = 4e-1 } }\n";
        assert_eq!(told(&format!("title = \"a\"\n{other}")), []);
        assert_eq!(changes(CASE, "no case"), None);
    }

    #[test]
    fn a_change_says_what_it_concerns() {
        let one = |from: &str, to: &str| {
            let all = told(&CASE.replace(from, to));
            assert_eq!(all.len(), 1, "{all:?}");
            (all[0].0.clone(), all[0].1)
        };
        assert_eq!(one("end = 5", "end = 9.5"), ("time.end = 9.5 instead of 5".into(), Concerns::Course));
        assert_eq!(
            one("mu = 0.4", "mu = 0.3"),
            ("material.friction.coulomb.mu = 0.3 instead of 0.4".into(), Concerns::Parameters)
        );
        assert_eq!(
            one("h.tif", "g.tif"),
            ("release[0].raster = \"g.tif\" instead of \"h.tif\"".into(), Concerns::State)
        );
        assert_eq!(one("[time]", "[time]\nuntil = \"rest\"").1, Concerns::Course);
        assert_eq!(one("[time]", "output.every = 2\n[time]").1, Concerns::Course);
        assert_eq!(one("[time]", "output.threshold = 2\n[time]").1, Concerns::State);
        assert_eq!(one("[material]", "[material]\ndensity = 3").1, Concerns::State);
        assert_eq!(one("[material]", "[material]\nforest = 0.02").1, Concerns::Parameters);
        assert_eq!(one("[material]", "[material]\nforest_breaks_at = 100").1, Concerns::State);
        assert_eq!(one("[time]", "entrainment.layer = 0.5\n[time]").1, Concerns::State);
        let law = told(&CASE.replace("coulomb = { mu = 0.4 }", "voellmy = { mu = { raster = \"mu.tif\" } }"));
        assert_eq!(law.len(), 2);
        assert!(law.iter().all(|(_, concerns)| *concerns == Concerns::Parameters), "{law:?}");
        let files = changes(CASE, &CASE.replace("mu = 0.4", "mu = { raster = \"mu.tif\" }")).unwrap();
        assert_eq!(files[0].texts, ["mu.tif"]);
    }

    #[test]
    fn a_passive_earth_pressure_is_there_from_the_start_or_never() {
        let with = |pressure: &str| CASE.replace("[material]", &format!("[material]\n{pressure}"));
        let kaland = with("earth_pressure = \"kaland\"");
        let [steep, flat] = [40, 30]
            .map(|internal| with(&format!("earth_pressure.active_passive.internal = \"{internal} deg\"")));
        let concerns = |before: &str, after: &str| {
            let all = changes(before, after).unwrap();
            assert_eq!(all.len(), 1, "{all:?}");
            all[0].concerns()
        };
        assert_eq!(concerns(CASE, &kaland), Concerns::Parameters);
        assert_eq!(concerns(&steep, &flat), Concerns::Parameters);
        for (before, after) in [(CASE, steep.as_str()), (&kaland, &steep), (&steep, &kaland), (&steep, CASE)]
        {
            assert_eq!(concerns(before, after), Concerns::State);
        }
    }
}
