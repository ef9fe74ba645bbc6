//! What an avalanche on a real mountain takes, as a process and in steps: `cargo bench -p granflow-cli --bench mountain`,
//! with `-- FOLDER` for a folder that holds `dem.asc` and `release.shp` (attribute `thickness`). Coulomb friction 0.4, two
//! threads, medians of processes that are taken in turn, so that other work on the machine falls on all alike.
//!
//! `doubled` is the same avalanche where the raster is twice as long along both axes, by mirror images of itself that stay
//! dry: its steps must cost the same, and its result must be the same.

use granflow::output::summary::Summary;
use granflow::raster::{Crs, Raster};
use granflow::speed::median;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

const ROUNDS: usize = 5;
const SYSTEM: &str = "EPSG:31287";

/// A case: its name, its elevations, and what it writes.
struct Case {
    name: &'static str,
    file: PathBuf,
}

impl Case {
    fn write(name: &'static str, dem: &Path, release: &Path, output: &str, folder: &Path) -> Case {
        let text = format!(
            "title = \"{name}\"\n\
             terrain = {{ dem = {dem:?}, crs = \"{SYSTEM}\", curvature = {{ length = \"10 m\" }} }}\n\
             material = {{ density = 200.0, friction.coulomb = {{ mu = 0.4 }} }}\n\
             release = [{{ polygons = {release:?}, thickness = {{ attribute = \"thickness\" }} }}]\n\
             time.until = \"rest\"\n{output}\n"
        );
        let file = folder.join(format!("{}.toml", name.replace(' ', "_")));
        fs::write(&file, text).expect("the case is written");
        Case { name, file }
    }

    /// Seconds of the process, and what it says of the run.
    fn run(&self, out: &Path) -> (f64, Summary) {
        let clock = Instant::now();
        let status = Command::new(env!("CARGO_BIN_EXE_granflow"))
            .args(["run", "--quiet", "--threads", "2", "--out"])
            .args([out, &self.file])
            .status()
            .expect("the program starts");
        let seconds = clock.elapsed().as_secs_f64();
        assert!(status.success(), "{}: {status}", self.name);
        let summary = Summary::read(&out.join("summary.json")).expect("a summary");
        fs::remove_dir_all(out).expect("the results are removed");
        (seconds, summary)
    }
}

/// The raster with its mirror images in the east, in the north and in both, as an ESRI ASCII grid.
fn doubled(dem: &Raster) -> String {
    let mut text = format!(
        "ncols {}\nnrows {}\nxllcorner {:?}\nyllcorner {:?}\ncellsize {:?}\nNODATA_value -9999\n",
        2 * dem.columns,
        2 * dem.rows,
        dem.west,
        dem.south,
        dem.cell
    );
    let mirrored = |k: usize, count: usize| if k < count { k } else { 2 * count - 1 - k };
    for row in (0..2 * dem.rows).rev() {
        for column in 0..2 * dem.columns {
            let z = dem.at(mirrored(column, dem.columns), mirrored(row, dem.rows));
            let written = if z.is_nan() { write!(text, "-9999 ") } else { write!(text, "{z:?} ") };
            written.expect("a string takes everything");
        }
        text.push('\n');
    }
    text
}

fn main() {
    let given = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/avaKot");
    let data = given.map_or(data, PathBuf::from);
    let (dem, release) = (data.join("dem.asc"), data.join("release.shp"));
    if !(dem.exists() && release.exists()) {
        return println!("skipped: no dem.asc and release.shp in {}", data.display());
    }
    let [dem, release] = [dem, release].map(|path| path.canonicalize().expect("a path"));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let crs = Crs::parse(SYSTEM).expect("a known system");
    let raster = Raster::read_in(&dem, Some(&crs)).expect("a raster");
    let wide = folder.path().join("doubled.asc");
    fs::write(&wide, doubled(&raster)).expect("the raster is written");

    let cases = [
        Case::write("plain", &dem, &release, "", folder.path()),
        Case::write("doubled", &wide, &release, "", folder.path()),
        Case::write("a frame a second", &dem, &release, "output.every = 1.0", folder.path()),
    ];
    let out = folder.path().join("out");
    let rounds: Vec<Vec<(f64, Summary)>> =
        (0..ROUNDS).map(|_| cases.iter().map(|case| case.run(&out)).collect()).collect();
    println!("{:26} {:>9} {:>10} {:>8} {:>10}", "case", "cells", "process s", "steps", "in steps s");
    let mut stepping = Vec::new();
    for (k, case) in cases.iter().enumerate() {
        let summary = &rounds[0][k].1;
        stepping.push(median(rounds.iter().map(|round| round[k].1.stepping_seconds)));
        println!(
            "{:26} {:9} {:10.3} {:8} {:10.3}",
            case.name,
            summary.cells,
            median(rounds.iter().map(|round| round[k].0)),
            summary.steps,
            stepping[k]
        );
    }
    let [plain, wide] = [0, 1].map(|k| &rounds[0][k].1);
    let same = (wide.steps, wide.time, wide.max_speed, wide.runout)
        == (plain.steps, plain.time, plain.max_speed, plain.runout);
    assert!(same, "what lies beside the avalanche has changed it");
    println!("in steps, doubled by plain: {:.3}", stepping[1] / stepping[0]);
}
