//! What is said of an avalanche: key figures and warnings.

use crate::model::Model;
use crate::output::report::KeyFigure;
use crate::output::summary::{StopReason, Summary};

/// A larger share of the volume in films, or gone from the grid, is worth a warning.
const SHARE: f64 = 0.005;

/// A larger mass error is none of rounding.
const ROUNDING: f64 = 1e-12;

/// What to know before the numbers of a run are trusted.
pub(super) fn warnings(model: &Model, summary: &Summary) -> Vec<String> {
    let mut warnings: Vec<String> = unfinished(summary).into_iter().collect();
    let percent = |volume: f64| 100.0 * summary.share(volume);
    for outlet in model.outlets {
        let gone = summary.extra(&format!("mass_out_{outlet}")).unwrap_or(0.0);
        if summary.share(gone) > SHARE {
            let over = match outlet {
                "nodata" => "over cells without elevation".to_owned(),
                side => format!("over the {side} edge of the grid"),
            };
            warnings.push(format!("{:.4} % of the volume ({gone:.6e}) left {over}", percent(gone)));
        }
    }
    if summary.share(summary.film_volume) > SHARE {
        warnings.push(format!(
            "{:.2} % of the volume is held in films thinner than {:e}; a smaller scheme.film moves them",
            percent(summary.film_volume),
            summary.extra("film").unwrap_or(f64::NAN)
        ));
    }
    if summary.mass_error.abs() > ROUNDING {
        warnings.push(format!(
            "the mass changed by {:.3} % of its own accord: {} does not conserve it; balanced and energy_stable do",
            100.0 * summary.mass_error,
            summary.scheme
        ));
    }
    warnings
}

/// Why what is called deposit is none, or not all.
fn unfinished(summary: &Summary) -> Option<String> {
    let moving = summary.extra("moving_volume_final").unwrap_or(0.0);
    let cells = summary.extra("moving_cells_final").unwrap_or(0.0);
    let share = 100.0 * summary.share(moving);
    match summary.stop_reason {
        StopReason::AtRest | StopReason::Steady => None,
        StopReason::Failed => {
            Some("the run failed: what it shows after the last frame is worth nothing".to_owned())
        }
        StopReason::Trickle => Some(format!(
            "a trickle still moves, thin or slow, through {cells} cells that hold {share:.2} % of the volume; nothing else has moved since \
             {:.6}. time.trickle = 0 waits until it rests",
            summary.extra("flowed_until").unwrap_or(f64::NAN)
        )),
        reason => Some(format!(
            "the run ended before the mass was at rest ({reason}): {cells} cells with {share:.2} % of the volume still move, and what \
             is called deposit is the thickness at the end"
        )),
    }
}

/// The key figures of a run on terrain.
pub(super) fn key_figures(summary: &Summary) -> Vec<KeyFigure> {
    let figure = KeyFigure::number;
    vec![
        figure("Volume at the start", Some(summary.mass_initial), " m³"),
        figure("Volume at the end", Some(summary.mass_final), " m³"),
        figure("Runout", summary.runout, " m"),
        figure("Reach angle", summary.reach_angle, "°"),
        KeyFigure { name: "Ended because".into(), value: summary.stop_reason.to_string() },
        figure("Counted above", summary.threshold, " m"),
        figure("Stopping time", summary.stopping_time, " s"),
        figure("95 % of the deposit stopped after", summary.extra("stopping_time_95"), " s"),
        figure("Simulated time", Some(summary.time), " s"),
        figure("Largest speed", Some(summary.max_speed), " m/s"),
        figure("Largest peak pressure", summary.extra("peak_pressure_max"), " kPa"),
        figure("Share of films", Some(100.0 * summary.share(summary.film_volume)), " %"),
        figure("Left over the edges", Some(summary.mass_out), " m³"),
        figure("Mass error (relative)", Some(summary.mass_error), ""),
    ]
}
