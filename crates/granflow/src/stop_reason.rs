//! Why a run ended.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Why a run ended; `summary.json` holds it in snake case, as in "at_rest".
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StopReason {
    /// Every cell is at rest and admissible: the mass has come to rest.
    AtRest,
    /// At rest but for a trickle, which has long been all that moved: `time.trickle`.
    Trickle,
    /// Nothing changes any more.
    Steady,
    /// The end time of the case was reached.
    EndTime,
    /// The number of steps of the case was done.
    Steps,
    /// The kinetic energy fell below the share of its peak that the case names.
    KineticEnergy,
    /// The largest speed fell below the case's `rest_speed`.
    BelowSpeed,
    /// The user interrupted it; `--resume` goes on.
    Interrupted,
    /// A step could not be taken; `failure` in `summary.json` says why.
    Failed,
}

impl StopReason {
    /// The mass has come to rest, or nothing changes any more; but for a trickle.
    #[must_use]
    pub fn is_rest(self) -> bool {
        matches!(self, Self::AtRest | Self::Trickle | Self::Steady)
    }
}

impl fmt::Display for StopReason {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::AtRest => "at rest",
            Self::Trickle => "at rest but for a trickle",
            Self::Steady => "steady",
            Self::EndTime => "end time reached",
            Self::Steps => "number of steps done",
            Self::KineticEnergy => "kinetic energy below its limit",
            Self::BelowSpeed => "speed below its limit",
            Self::Interrupted => "interrupted",
            Self::Failed => "failed",
        })
    }
}
