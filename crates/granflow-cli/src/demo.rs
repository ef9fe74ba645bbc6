//! `granflow demo`: a mountain avalanche to its rest, without any file.

use std::fs;
use std::path::Path;

use granflow::Case;
use granflow::session::RunError;

use crate::failure::{Failure, print};
use crate::run::{RESUME, RunOptions, compute};
use crate::{mountain, new};

/// Writes the built-in mountain, its release and its case into `out`, and computes them there.
pub fn demo(out: &Path) -> Result<(), Failure> {
    let file = out.join("case.toml");
    fs::create_dir_all(out).map_err(|error| Failure::file("make", out, &error))?;
    for (path, text) in [
        (file.clone(), new::AVALANCHE.to_owned()),
        (out.join("mountain.asc"), mountain::elevation()),
        (out.join("release.geojson"), mountain::release()),
    ] {
        fs::write(&path, text).map_err(|error| Failure::file("write", &path, &error))?;
    }
    let case = Case::read(&file)?.check()?;
    let finished = compute(case, &RunOptions { out: Some(out.to_owned()), ..RunOptions::default() })
        .map_err(|failure| match failure {
            Failure::Interrupted(said) => {
                let again =
                    format!("granflow run {} --out {} --resume goes on", file.display(), out.display());
                Failure::Interrupted(said.replace(RESUME, &again))
            }
            other => other,
        })?;
    let summary = finished.close().map_err(RunError::from)?;
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.1}"));
    let place = |name: &str| out.join(name).display().to_string();
    print(&format!(
        "{}: {} after {:.1} s, computed in {:.1} s\n\
         \n\
         volume            {:.0} m3 (relative error {:.1e})\n\
         largest speed     {:.1} m/s\n\
         largest thickness {} m, in the deposit {} m\n\
         runout            {} m, reach angle {} deg\n\
         \n\
         look at           {}\n\
         \x20                 {}\n\
         all in one page   {}\n\
         run it again      granflow run {}\n",
        summary.title,
        summary.stop_reason,
        summary.time,
        summary.wall_seconds,
        summary.mass_final,
        summary.mass_error,
        summary.max_speed,
        number(summary.extra("peak_thickness_max")),
        number(summary.extra("deposit_max")),
        number(summary.runout),
        number(summary.reach_angle),
        place("figures/peak_thickness.png"),
        place("figures/deposit.png"),
        place("report.html"),
        file.display(),
    ))
}
