//! `output.durations`: for how long a quantity was above a threshold.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Thresholds of which maps say for how long they were exceeded.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Durations {
    /// Of the thickness normal to the bed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thickness: Option<f64>,
    /// Of the speed along the bed, while the layer is thicker than the threshold.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed: Option<f64>,
    /// Of the dynamic pressure in kPa, while the layer is thicker than the threshold (terrain).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure: Option<f64>,
}
