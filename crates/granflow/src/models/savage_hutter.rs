//! Avalanches after Savage & Hutter, as the files show them: on a chute in the papers' scaling, on terrain in SI.

#[cfg(feature = "figures")]
mod chute;
#[cfg(feature = "files")]
mod ended;
#[cfg(feature = "files")]
mod findings;
#[cfg(all(feature = "figures", feature = "geo"))]
mod maps;
#[cfg(all(feature = "figures", feature = "geo"))]
mod path;
#[cfg(feature = "figures")]
mod pictures;
pub mod run;
#[cfg(feature = "files")]
mod stopped;
#[cfg(all(feature = "files", feature = "geo"))]
mod stored;
#[cfg(feature = "geo")]
mod terrain;

#[cfg(feature = "geo")]
pub use terrain::TerrainDomain;

#[cfg(feature = "files")]
use crate::model::Maps;
use crate::model::{Domain, Model, Quantity, Words};
#[cfg(feature = "files")]
use crate::output::summary::Summary;

/// The model.
pub static MODEL: Model = Model {
    name: "savage_hutter",
    quantities: &[
        Quantity::series("thickness", "thickness normal to the bed", ["1", "m"]),
        Quantity::series("velocity_x", "velocity along x", ["1", "m s-1"]),
        Quantity::series("velocity_y", "velocity along y", ["1", "m s-1"]),
        Quantity::series("surface", "elevation of the free surface", ["1", "m"]),
        Quantity::series("speed", "speed along the bed", ["1", "m s-1"]),
        Quantity::fixed("bed", "elevation of the bed", ["1", "m"]).exact(),
        Quantity::map(
            "peak_thickness",
            "largest thickness normal to the bed, where thicker than the threshold",
            ["1", "m"],
        )
        .with_maximum(),
        Quantity::map(
            "peak_speed",
            "largest speed along the bed while thicker than the threshold",
            ["1", "m s-1"],
        )
        .with_maximum(),
        Quantity::map(
            "peak_pressure",
            "largest dynamic pressure, density times speed squared, while thicker than the threshold",
            ["1", "kPa"],
        )
        .with_maximum(),
        Quantity::map(
            "arrival_time",
            "time at which the cell was first thicker than the threshold",
            ["1", "s"],
        ),
        Quantity::map(
            "stopping_time",
            "time at which the cell last moved while thicker than the threshold",
            ["1", "s"],
        ),
        Quantity::map(
            "duration_thickness",
            "time during which the thickness exceeded output.durations.thickness",
            ["1", "s"],
        )
        .with_maximum()
        .on_demand(),
        Quantity::map(
            "duration_speed",
            "time during which the speed exceeded output.durations.speed, while thicker than the threshold",
            ["1", "s"],
        )
        .with_maximum()
        .on_demand(),
        Quantity::map(
            "duration_pressure",
            "time during which the pressure exceeded output.durations.pressure, while thicker than the threshold",
            ["1", "s"],
        )
        .with_maximum()
        .on_demand(),
        Quantity::map(
            "deposit",
            "thickness normal to the bed at the end, where thicker than the threshold",
            ["1", "m"],
        )
        .with_maximum(),
        Quantity::map(
            "yield_margin",
            "pull at the end as a share of the largest that friction holds, where there is a deposit",
            ["1", "1"],
        )
        .with_maximum(),
        Quantity::map("eroded_depth", "depth of the layer that was picked up, normal to the bed", ["1", "m"])
            .with_maximum()
        .on_demand(),
        Quantity::map("forest_broken", "time at which the forest broke", ["1", "s"]).on_demand(),
    ],
    words: Words { wet: "wet cells", fastest: "speed" },
    scheme_title: |scheme| scheme.replace("verfahren_", "Verfahren "),
    #[cfg(feature = "files")]
    key_figures: findings::key_figures,
    #[cfg(feature = "files")]
    warnings: findings::warnings,
    #[cfg(feature = "figures")]
    pictures: Some(&pictures::Avalanche),
    ..Model::PLAIN
};

/// A chute in the papers' scaling, in one or two dimensions.
#[derive(Debug, Clone, Default)]
pub struct ChuteDomain {
    /// What a user should know of the files that were read for it: [`Domain::remarks`].
    pub remarks: Vec<String>,
}

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

    /// When almost all had stopped.
    #[cfg(feature = "files")]
    fn derive(&self, _centres: [&[f64]; 2], maps: &mut Maps, summary: &mut Summary) {
        stopped::note(maps, |cells| self.per_plan_area(cells), summary);
    }

    fn remarks(&self) -> Vec<String> {
        self.remarks.clone()
    }
}
