//! Avalanches after Savage & Hutter, as the files show them: on a chute in the papers' scaling, on terrain in SI.

#[cfg(feature = "figures")]
mod chute;
#[cfg(all(feature = "figures", feature = "geo"))]
mod maps;
#[cfg(all(feature = "figures", feature = "geo"))]
mod path;
#[cfg(feature = "figures")]
mod pictures;
pub mod run;
#[cfg(feature = "geo")]
mod terrain;

#[cfg(feature = "geo")]
pub use terrain::TerrainDomain;

use crate::model::{Domain, Model, Quantity, Words};
use crate::output::report::{Findings, KeyFigure};
use crate::output::summary::{FILM_SHARE, StopReason, Summary};

/// The model.
pub static MODEL: Model = Model {
    name: "savage_hutter",
    quantities: &[
        Quantity::series("thickness", "thickness normal to the bed", ["1", "m"]).as_thickness(),
        Quantity::series("velocity_x", "velocity along x", ["1", "m s-1"]),
        Quantity::series("velocity_y", "velocity along y", ["1", "m s-1"]),
        Quantity::series("surface", "elevation of the free surface", ["1", "m"]),
        Quantity::series("speed", "speed along the bed", ["1", "m s-1"]),
        Quantity::fixed("bed", "elevation of the bed", ["1", "m"]).exact(),
        Quantity::map("peak_thickness", "largest thickness normal to the bed", ["1", "m"])
            .as_thickness()
            .with_maximum(),
        Quantity::map("peak_speed", "largest speed along the bed", ["1", "m s-1"]).with_maximum(),
        Quantity::map("peak_pressure", "largest dynamic pressure, density times speed squared", ["1", "kPa"])
            .with_maximum(),
        Quantity::map("arrival_time", "time at which the mass arrived", ["1", "s"]),
        Quantity::map("stopping_time", "time at which the cell last moved", ["1", "s"]),
        Quantity::map("deposit", "thickness normal to the bed at the end", ["1", "m"])
            .as_thickness()
            .with_maximum(),
        Quantity::map(
            "yield_margin",
            "pull at the end as a share of the largest that friction holds",
            ["1", "1"],
        )
        .with_maximum(),
    ],
    words: Words { wet: "wet cells", fastest: "speed" },
    scheme_title: |scheme| scheme.replace("verfahren_", "Verfahren "),
    findings,
    #[cfg(feature = "figures")]
    pictures: Some(&pictures::Avalanche),
    ..Model::PLAIN
};

/// A chute in the papers' scaling, in one or two dimensions.
#[derive(Debug, Clone, Copy, Default)]
pub struct ChuteDomain;

impl Domain for ChuteDomain {
    fn model(&self) -> &'static Model {
        &MODEL
    }

    fn keeps(&self, series: &Quantity, dimensions: usize) -> bool {
        match series.name {
            "velocity_y" => dimensions > 1,
            "surface" | "speed" => false,
            _ => true,
        }
    }
}

/// The key figures of a run on terrain and what to know before trusting them.
fn findings(summary: &Summary, film: f64) -> Findings {
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
