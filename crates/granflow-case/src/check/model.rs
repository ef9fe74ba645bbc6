//! What belongs to the other model is refused, never ignored.

use crate::fault::CaseError;
use crate::{Case, Model, SchemeName, Until};

/// Keys that only savage_hutter has, and what a sandpile has instead.
const AVALANCHE: &[(&str, &str)] = &[
    ("terrain", "write [grid], and [table] with mask.file for a table of any shape"),
    ("release", "write [[source]], or initial.standing_layer"),
    ("material", "remove it: slopes are in units of the angle of repose, nothing else is left to choose"),
    ("grid.boundary", "use [table] open = [\"left\", ...]: the other edges are walls"),
    ("initial.thickness", "write initial.standing_layer or initial.rolling_layer"),
    ("initial.velocity_x", "remove it: the rolling layer rolls down the slope"),
    ("initial.velocity_y", "remove it: the rolling layer rolls down the slope"),
    ("scheme.film", "remove it: there are no films"),
    ("time.rest_speed", "write until = \"steady\" and steady_rate"),
    ("time.stop", "write until = \"steady\" and steady_rate"),
];

/// Keys that only hadeler_kuttler has.
const SANDPILE: &[&str] = &[
    "table",
    "source",
    "initial.standing_layer",
    "initial.rolling_layer",
    "scheme.theta_exponent",
    "time.steady_rate",
    "time.method",
];

impl Case {
    /// Only keys, schemes and ends of the case's own model.
    pub(super) fn check_model(&self) -> Result<(), CaseError> {
        match self.model {
            Model::SavageHutter => {
                if let Some(key) = SANDPILE.iter().copied().find(|key| self.source.has(key)) {
                    let message = format!("`{key}` belongs to the model hadeler_kuttler");
                    return Err(self.fault(key, message, "remove it, or write model = \"hadeler_kuttler\""));
                }
                if self.material.is_none() {
                    return Err(self.fault(
                        "material",
                        "the key `material` is missing",
                        "add a table [material] with the friction law",
                    ));
                }
            }
            Model::HadelerKuttler => {
                if let Some((key, cure)) = AVALANCHE.iter().find(|(key, _)| self.source.has(key)) {
                    return Err(self.fault(key, format!("`{key}` has no meaning for hadeler_kuttler"), cure));
                }
            }
        }
        let (name, model) = (self.scheme.name, self.model);
        if name.model() != model {
            let own: Vec<&str> = SchemeName::ALL
                .iter()
                .filter(|name| name.model() == model)
                .map(|name| name.as_str())
                .collect();
            let message = format!("the scheme {} is not one of {}", name.as_str(), model.as_str());
            return Err(self.fault("scheme.name", message, &format!("allowed: {}", own.join(", "))));
        }
        let (until, other, cure) = match model {
            Model::SavageHutter => (Until::Steady, "steady", "rest"),
            Model::HadelerKuttler => (Until::Rest, "rest", "steady"),
        };
        if self.time.until == Some(until) {
            let message = format!("{} has no end \"{other}\"", model.as_str());
            return Err(self.fault("time.until", message, &format!("write until = \"{cure}\"")));
        }
        Ok(())
    }
}
