//! One small run on a mountain and one on a chute: every kind of file opens and holds what the run left.

mod damaged;
mod going_on;
mod resumed;
mod state;
mod upon;
mod written;

use granflow::Case;
use granflow::case::FileKind;
use granflow::model::{At, Domain, Model, Plane, Quantity};
use granflow::output::Precision;
use granflow::output::folder::Folder;
use granflow::output::netcdf::{Dataset, Values};
use granflow::output::summary::{StopReason, Summary};
use granflow::raster::{Raster, RasterError};
use granflow::results::{About, FilesError, Finished, Story, check_kinds, dataset};
use granflow::run::{Run, drive};
use granflow::session::{Options, RunError, origin};
use granflow::sinks::{BeginError, Files, Sink, SinkError, Stop};
use netcdf_reader::NcFile;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

fn case(text: &str, folder: &Path) -> Case {
    let file = folder.join("case.toml");
    fs::write(&file, text).unwrap();
    Case::read(&file).unwrap()
}

/// Compute until `stop` says so.
fn begin(
    case: &Case,
    out: &Path,
    resume: bool,
    stop: &mut (dyn FnMut(&dyn Run) -> bool + Send),
) -> Result<Finished, RunError> {
    let options = Options {
        directory: out.to_owned(),
        threads: 2,
        resume,
        command: "test".to_owned(),
        notice: &|_| (),
    };
    let stopped = AtomicBool::new(false);
    case.check().unwrap().compute(&options, &stopped, &mut |status| {
        if stop(status) {
            stopped.store(true, Ordering::Relaxed);
        }
    })
}

fn computed(text: &str, folder: &Path) -> Finished {
    begin(&case(text, folder), &folder.join("out"), false, &mut |_| false).unwrap()
}

/// The case of a slope of 35 deg that ends on a plain, with a corner of nodata, and a heap upon it.
fn slope(folder: &Path, files: &str) -> Case {
    let mut text =
        "ncols 30\nnrows 60\nxllcorner 1000\nyllcorner 2000\ncellsize 5\nNODATA_value -9999\n".to_owned();
    for row in 0..60 {
        for column in 0..30 {
            let z = 0.7 * (5.0 * (59.0 - f64::from(row)) - 120.0).max(0.0);
            let z = if row > 55 && column < 3 { -9999.0 } else { z + 500.0 };
            let _ = write!(text, "{z} ");
        }
        text.push('\n');
    }
    fs::write(folder.join("slope.asc"), text).unwrap();
    let text = r#"
title = "A small slide"
[terrain]
dem = "slope.asc"
crs = "EPSG:31287"
curvature = "off"
[material]
density = 300.0
friction.coulomb = { mu = 0.4 }
[[release]]
cap = { height = 2.0, centre = [1075.0, 2230.0], radius = 25.0 }
[time]
until = "rest"
end = 200.0
[output]
every = 4.0
precision = "f64"
"#;
    case(&format!("{text}files = {files}\n"), folder)
}

fn with(case: &Path, overrides: &[&str]) -> Case {
    let overrides: Vec<String> = overrides.iter().map(|&change| change.to_owned()).collect();
    Case::read_with(case, &overrides).unwrap()
}

/// The case file of the slope.
fn file(folder: &Path) -> PathBuf {
    slope(folder, r#"["netcdf", "report"]"#);
    folder.join("case.toml")
}

fn avalanche(folder: &Path) -> Finished {
    let all = r#"["netcdf", "csv", "vtk", "geotiff", "vector", "figures", "animation", "report"]"#;
    begin(&slope(folder, all), &folder.join("out"), false, &mut |_| false).unwrap()
}

/// Width, height and number of pictures of a PNG whose pixels are not all alike.
fn picture(path: &Path) -> (u32, u32, u32) {
    let file = std::io::BufReader::new(fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut rgb).unwrap();
    let mut colours = rgb.as_chunks::<3>().0.to_vec();
    colours.sort_unstable();
    colours.dedup();
    assert!(colours.len() > 20, "{}: {} colours", path.display(), colours.len());
    let info = reader.info();
    (info.width, info.height, info.animation_control().map_or(1, |film| film.num_frames))
}
