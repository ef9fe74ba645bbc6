//! What a report says of an avalanche.

use crate::output::report::{Findings, KeyFigure};
use crate::output::summary::{FILM_SHARE, StopReason, Summary};

/// The key figures of a run on terrain and what to know before trusting them.
pub(super) fn findings(summary: &Summary, film: f64) -> Findings {
    let figure = KeyFigure::number;
    let mut warnings = Vec::new();
    if !matches!(summary.stop_reason, StopReason::AtRest | StopReason::Steady) {
        warnings.push(format!(
            "the run ended before the mass was at rest ({}); what is called deposit is the thickness at the end.",
            summary.stop_reason
        ));
    }
    if summary.film_share() > FILM_SHARE {
        let share = 100.0 * summary.film_share();
        warnings.push(format!("{share:.2} % of the mass is held in films thinner than {film:e} m."));
    }
    Findings {
        key_figures: vec![
            figure("Volume at the start", Some(summary.mass_initial), " m³"),
            figure("Volume at the end", Some(summary.mass_final), " m³"),
            figure("Runout", summary.runout, " m"),
            figure("Reach angle", summary.reach_angle, "°"),
            KeyFigure { name: "Ended because".into(), value: summary.stop_reason.to_string() },
            figure("Counted above", summary.threshold, " m"),
            figure("Stopping time", summary.stopping_time, " s"),
            figure("Simulated time", Some(summary.time), " s"),
            figure("Largest speed", Some(summary.max_speed), " m/s"),
            figure("Largest peak pressure", summary.extra("peak_pressure_max"), " kPa"),
            figure("Share of films", Some(summary.film_share() * 100.0), " %"),
            figure("Left over the edges", Some(summary.mass_out), " m³"),
            figure("Mass error (relative)", Some(summary.mass_error), ""),
        ],
        warnings,
    }
}
