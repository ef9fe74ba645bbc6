//! `granflow compare`: how well a run meets another one, or what was mapped.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use granflow::compare::{By, Comparison, Measured};

use crate::failure::{Failure, print, tell};
use crate::interrupt;

/// What the command line says about a comparison.
#[derive(Debug, Args)]
pub struct Options {
    /// The side that is judged: the folder or the result.nc of a run, a raster of thickness, or an outline (GeoJSON, shapefile)
    a: PathBuf,
    /// The side that it is held against: the same choice
    b: PathBuf,
    /// Thickness that a layer must exceed (default: 0.1, or what the maps of a result begin at where that is more)
    #[arg(long, value_name = "THICKNESS", allow_negative_numbers = true)]
    threshold: Option<f64>,
    /// What of a result is compared: all that was reached, or what lies at the end
    #[arg(long, value_enum, default_value = "footprint")]
    by: What,
    /// How the thickness of a raster is measured
    #[arg(long, value_enum, default_value = "normal")]
    measured: Direction,
    /// Where compare.json and compare.png go
    #[arg(long, value_name = "DIR", default_value = "compare")]
    out: PathBuf,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum What {
    /// Where the peak thickness exceeds the threshold
    Footprint,
    /// Where the thickness at the end exceeds the threshold
    Deposit,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Direction {
    /// Normal to the bed, as granflow's own rasters
    Normal,
    /// Along the vertical, as a difference of two elevation models
    Vertical,
}

/// Compares, writes what was found and prints it.
pub fn compare(options: &Options) -> Result<(), Failure> {
    let how = granflow::compare::Options {
        threshold: options.threshold,
        by: match options.by {
            What::Footprint => By::Footprint,
            What::Deposit => By::Deposit,
        },
        vertical: matches!(options.measured, Direction::Vertical),
    };
    interrupt::listen()?;
    let (a, b) = (options.a.clone(), options.b.clone());
    let Some(comparison) = interrupt::unless_asked(move || granflow::compare::compare(&a, &b, &how)) else {
        let message =
            format!("nothing was written into {}; the same command starts again", options.out.display());
        return Err(Failure::Interrupted(message));
    };
    let comparison = comparison?;
    comparison.notes.iter().for_each(|note| tell(&format!("note: {note}\n")));
    let files = comparison.write(&options.out)?;
    let files: String = files.iter().map(|file| format!("{}\n", file.display())).collect();
    print(&format!("{}{files}", table(&comparison)))
}

/// The numbers, a line each.
fn table(comparison: &Comparison) -> String {
    let Comparison { a, b, .. } = comparison;
    let shown = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.6}"));
    let pair = |name: &str, of: fn(&Measured) -> Option<f64>, difference: Option<f64>| {
        format!("{name:22} {:>16} {:>16} {:>16}\n", shown(of(a)), shown(of(b)), shown(difference))
    };
    let one = |name: &str, value: Option<f64>| format!("{name:22} {:>16}\n", shown(value));
    let what = comparison.by.word();
    [
        format!(
            "A: {}\nB: {}\n{what} thicker than {}\n\n",
            a.path.display(),
            b.path.display(),
            comparison.threshold
        ),
        one("critical success index", Some(comparison.csi)),
        one("area hit", Some(comparison.hit_area)),
        one("area missed", Some(comparison.miss_area)),
        one("area false", Some(comparison.false_area)),
        one(&format!("centroids ({})", comparison.centroid_of), comparison.centroid_distance),
        format!("\n{:22} {:>16} {:>16} {:>16}\n", "", "A", "B", "A - B"),
        pair("area", |side| Some(side.area), Some(a.area - b.area)),
        pair("runout along the path", |side| side.runout, comparison.runout_difference),
        pair("straight reach", |side| side.reach, comparison.reach_difference),
        pair("volume", |side| side.volume, comparison.volume_difference),
        pair("peak thickness", |side| side.peak_thickness, comparison.peak_thickness_difference),
        pair("peak speed", |side| side.peak_speed, comparison.peak_speed_difference),
    ]
    .concat()
}
