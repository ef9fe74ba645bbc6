//! Angles and lengths: the one place where a unit becomes a number.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::choice::{Plain, plain};
use super::formula::Formula;

/// An angle, held in radians; a case writes `"18 deg"`, `"pi/10 rad"` or a number in radians.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Angle(f64);

impl Angle {
    /// An angle of that many radians.
    #[must_use]
    pub const fn from_radians(radians: f64) -> Self {
        Self(radians)
    }

    /// The angle in radians.
    #[must_use]
    pub const fn radians(self) -> f64 {
        self.0
    }
}

/// A length in metres on terrain, in the case's unit on a grid; a case writes `"20 m"` or a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Length(pub f64);

/// Reads `"12.5 deg"`: a number (or a formula without variables, such as `pi/10`), then one of the units.
fn measured(text: &str, what: &str, units: &[(&str, f64)], examples: &str) -> Result<f64, String> {
    let not = |why: String| format!("`{text}` is not {what}{why}; write {examples}");
    let trimmed = text.trim();
    let (number, factor) = units
        .iter()
        .find_map(|(unit, factor)| trimmed.strip_suffix(unit).map(|number| (number, *factor)))
        .ok_or_else(|| not(String::new()))?;
    let value = Formula::parse(number, &[]).map_err(|error| not(format!(" ({error})")))?.at(&[]);
    Ok(value * factor)
}

/// What to do about an angle that is too large.
pub(crate) const RADIANS: &str = "a plain number is in radians: write \"18 deg\" for degrees";

const ANGLE: &str = "\"18 deg\", \"0.3 rad\" or a number in radians";
const LENGTH: &str = "\"20 m\" or a number";

impl std::str::FromStr for Angle {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        // one multiplication, as `f64::to_radians` does it, so that both ways agree to the last bit
        let degree = std::f64::consts::PI / 180.0;
        let units = [("degrees", degree), ("deg", degree), ("°", degree), ("rad", 1.0)];
        measured(text, "an angle", &units, ANGLE).map(Self)
    }
}

impl std::str::FromStr for Length {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        measured(text, "a length", &[("km", 1000.0), ("m", 1.0)], LENGTH).map(Self)
    }
}

impl<'de> Deserialize<'de> for Angle {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        plain(from, ANGLE, |value| match value {
            Plain::Number(radians) => Ok(Self(radians)),
            Plain::Text(text) => text.parse(),
        })
    }
}

impl<'de> Deserialize<'de> for Length {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        plain(from, LENGTH, |value| match value {
            Plain::Number(length) => Ok(Self(length)),
            Plain::Text(text) => text.parse(),
        })
    }
}

impl Serialize for Angle {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_f64(self.0)
    }
}

impl Serialize for Length {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_f64(self.0)
    }
}

impl JsonSchema for Angle {
    fn schema_name() -> Cow<'static, str> {
        "Angle".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "An angle: \"18 deg\", \"0.3 rad\" or a number in radians.",
            "anyOf": [{ "type": "number" }, { "type": "string", "pattern": "(deg|degrees|°|rad)\\s*$" }],
        })
    }
}

impl JsonSchema for Length {
    fn schema_name() -> Cow<'static, str> {
        "Length".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "A length: \"20 m\", \"0.1 km\" or a number in metres.",
            "anyOf": [{ "type": "number" }, { "type": "string", "pattern": "k?m\\s*$" }],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles() {
        let radians = |text: &str| text.parse::<Angle>().map(Angle::radians);
        assert_eq!(radians("18 deg"), Ok(18f64.to_radians()));
        assert_eq!(radians(" 18° "), Ok(18f64.to_radians()));
        assert_eq!(radians("-0.3rad"), Ok(-0.3));
        assert_eq!(radians("pi/10 rad"), Ok(std::f64::consts::PI / 10.0));
        assert!(radians("18").is_err_and(|error| error.contains("\"18 deg\"")));
        assert!(radians("18 grad").is_err());
        assert!(radians("deg").is_err());
        assert_eq!("0.02 km".parse::<Length>(), Ok(Length(20.0)));
        assert!("20 ft".parse::<Length>().is_err());
    }
}
