//! One small run on a mountain and one on a chute: every kind of file opens and holds what the run left.

use granflow::Case;
use granflow::case::{FileAccess, FileKind};
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
    let options =
        Options { directory: out.to_owned(), threads: 2, resume, command: "test".to_owned(), notice: |_| () };
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

#[test]
fn every_file_of_a_mountain_opens_and_holds_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let run = avalanche(folder.path());
    assert_eq!(run.summary.stop_reason, StopReason::AtRest);
    let written = run.write_files().unwrap();
    assert!(written.iter().all(|path| path.exists()), "{written:?}");
    let out = |name: &str| folder.path().join("out").join(name);

    for name in ["peak_thickness", "deposit", "peak_speed", "arrival_time", "section", "history"] {
        let (width, height, pictures) = picture(&out(&format!("figures/{name}.png")));
        assert!(width > 500 && height > 500 && pictures == 1, "{name}");
    }
    assert_eq!(picture(&out("animation.png")).2 as usize, run.frames.times().len());

    let raster = |name: &str| Raster::read(&out(&format!("rasters/{name}.tif"))).unwrap();
    let deposit = raster("deposit");
    assert_eq!((deposit.columns, deposit.rows, deposit.west, deposit.south), (30, 60, 1000.0, 2000.0));
    assert_eq!(deposit.crs.as_ref().and_then(|crs| crs.epsg), Some(31287));
    assert!(deposit.at(0, 0).is_nan() && deposit.at(5, 0).is_nan() && deposit.range().unwrap().0 > 0.01);
    for (there, here) in deposit.values.iter().zip(run.map("deposit").unwrap()) {
        assert!(there.is_nan() == here.is_nan() && (there.is_nan() || (there - here).abs() < 1e-6));
    }
    let (arrival, stopping) = (raster("arrival_time"), raster("stopping_time"));
    assert!(arrival.at(0, 59).is_nan(), "nothing arrived in the corner");
    assert!(stopping.range().unwrap().1 <= run.summary.time);

    let outlines: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(out("outlines.geojson")).unwrap()).unwrap();
    let names: Vec<&str> = outlines["features"]
        .as_array()
        .unwrap()
        .iter()
        .map(|f| f["properties"]["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["release", "deposit", "peak_thickness"]);
    let area = |k: usize| outlines["features"][k]["properties"]["area"].as_f64().unwrap();
    assert!(area(0) > 1000.0 && area(2) > area(0) && area(2) > area(1));
    for (k, name) in ["deposit", "peak_thickness"].into_iter().enumerate() {
        let counted = 25.0 * run.map(name).unwrap().iter().filter(|h| h.is_finite()).count() as f64;
        assert!((area(k + 1) / counted - 1.0).abs() < 0.1, "{name}: {} of {counted}", area(k + 1));
    }

    let report = fs::read_to_string(out("report.html")).unwrap();
    let runout = run.summary.runout.unwrap().floor().to_string();
    for part in
        ["A small slide", "Counted above", "0.01 m", "at rest", "friction.coulomb", "Arrival time", &runout]
    {
        assert!(report.contains(part), "{part}");
    }
    assert_eq!(report.matches("data:image/png;base64,").count(), 7);
    assert_eq!(fs::read_to_string(out("maps.csv")).unwrap().lines().count(), 1 + 30 * 60);
    let collection = fs::read_to_string(out("result.pvd")).unwrap();
    assert_eq!(collection.matches(".vti").count(), run.frames.times().len());
}

#[test]
fn a_result_is_drawn_again_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let run = avalanche(folder.path());
    let again = folder.path().join("again");
    let figures = Story::read(&run.result()).unwrap().draw(&again).unwrap();
    assert_eq!(figures.len(), 7);
    for figure in figures {
        let name = figure.path.file_name().unwrap();
        let first = fs::read(run.figures().join(name)).unwrap();
        assert!(fs::read(&figure.path).unwrap() == first, "{name:?}");
    }
}

/// The disk fills up while the run goes on, written to by another thread: it ends soon, says which file and what helps, and
/// goes on from its checkpoint to the bits of the unbroken run.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_ends_the_run_and_nothing_complete_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let case = slope(folder.path(), r#"["netcdf"]"#);
    let [whole, parts] = ["whole", "parts"].map(|name| folder.path().join(name));
    let unbroken = begin(&case, &whole, false, &mut |_| false).unwrap().summary;
    let half = unbroken.steps / 2;
    let interrupted = begin(&case, &parts, false, &mut |status| status.steps() == half / 2).unwrap().summary;
    assert_eq!(interrupted.stop_reason, StopReason::Interrupted);

    let (ledger, aside) = (parts.join("mass.csv"), parts.join("aside.csv"));
    let mut last = 0;
    let failed = begin(&case, &parts, true, &mut |status| {
        if status.steps() == half {
            // In one go, for the writer may open it at any instant.
            let full = parts.join("full");
            fs::hard_link(&ledger, &aside).unwrap();
            std::os::unix::fs::symlink("/dev/full", &full).unwrap();
            fs::rename(&full, &ledger).unwrap();
        } else if status.steps() > half {
            // These steps take microseconds: leave the thread that writes the time to come upon it.
            std::thread::sleep(Duration::from_millis(100));
        }
        last = status.steps();
        false
    });
    let message = failed.unwrap_err().to_string();
    for part in ["mass.csv", "cannot write", "--resume"] {
        assert!(message.contains(part), "{message}");
    }
    assert!(last < unbroken.steps, "the run went on to its end, step {last}");

    fs::rename(&aside, &ledger).unwrap();
    let resumed = begin(&case, &parts, true, &mut |_| false).unwrap().summary;
    assert_eq!((resumed.stop_reason, resumed.steps), (StopReason::AtRest, unbroken.steps));
    for file in ["mass.csv", "checkpoint/frames.bin"] {
        assert!(fs::read(whole.join(file)).unwrap() == fs::read(parts.join(file)).unwrap(), "{file} differs");
    }
}

/// A small slide, its maps with this threshold, and its last states, all as bits.
fn with_threshold(folder: &Path, threshold: f64) -> (Finished, Vec<u64>) {
    let files =
        format!("[\"netcdf\", \"geotiff\", \"vector\", \"figures\", \"report\"]\nthreshold = {threshold}");
    let out = folder.join(format!("out_{threshold}"));
    let run = begin(&slope(folder, &files), &out, false, &mut |_| false).unwrap();
    run.write_files().unwrap();
    let mut frames = run.frames.again().unwrap();
    let last = frames.times().len() - 1;
    let fields = (0..frames.fields().len()).flat_map(|field| frames.read(last, field).unwrap());
    let state = fields.map(f64::to_bits).chain([run.summary.time.to_bits(), run.summary.steps]).collect();
    (run, state)
}

#[test]
fn what_was_never_thicker_than_the_threshold_has_no_value() {
    let folder = tempfile::tempdir().unwrap();
    let thresholds = [0.0, 0.01, 0.3, 100.0];
    let runs = thresholds.map(|threshold| with_threshold(folder.path(), threshold));
    let mut counted = Vec::new();
    for (threshold, (run, state)) in thresholds.iter().zip(&runs) {
        assert!(state == &runs[0].1, "{threshold}: what is computed does not depend on the threshold");
        let map = |name: &str| run.map(name).unwrap();
        let (peak, thickness) = (map("peak_thickness"), map("deposit"));
        assert!(peak.iter().all(|h| h.is_nan() || *h >= f64::from(*threshold as f32)), "{threshold}");
        assert!(thickness.iter().all(|h| h.is_nan() || h > threshold), "{threshold}");
        counted.push(peak.iter().filter(|h| h.is_finite()).count());

        let file = NcFile::open(run.result()).unwrap();
        let text = file.global_attribute("threshold").unwrap().value.as_string().unwrap();
        assert_eq!(text, format!("{threshold} m"));
        for name in
            ["peak_thickness", "peak_speed", "peak_pressure", "arrival_time", "stopping_time", "deposit"]
        {
            let stored = file.read_variable::<f64>(name).unwrap();
            // A raster of nodata alone is written, and refused where it is read as an elevation.
            let raster = match Raster::read(&run.directory.join(format!("rasters/{name}.tif"))) {
                Err(RasterError::Empty { .. }) if counted.last() == Some(&0) => vec![f64::NAN; peak.len()],
                read => read.unwrap().values,
            };
            let whole = ["peak_thickness", "peak_speed", "peak_pressure", "arrival_time"].contains(&name);
            for (k, value) in map(name).iter().enumerate() {
                let nowhere = [value, &stored.as_slice().unwrap()[k], &raster[k]].map(|v| v.is_nan());
                assert_eq!(nowhere, [value.is_nan(); 3], "{threshold}: {name}, cell {k}");
                assert!(value.is_nan() == peak[k].is_nan() || (!whole && value.is_nan()), "{name}, cell {k}");
            }
        }
        let largest = |name: &str| map(name).iter().copied().fold(f64::NAN, f64::max);
        let summary = &run.summary;
        assert_eq!(summary.threshold, Some(*threshold));
        assert_eq!(summary.max_speed, largest("peak_speed").max(0.0));
        let moved = Some(largest("stopping_time")).filter(|time| time.is_finite());
        assert_eq!((summary.stopping_time, summary.stop_reason), (moved, StopReason::AtRest));
        assert!(moved.is_none_or(|time| time <= f64::from(summary.time as f32)));
    }
    assert!(counted.is_sorted_by(|more, fewer| more > fewer) && counted[3] == 0, "{counted:?}");
    let [_, (usual, _), _, (none, _)] = &runs;
    assert!(usual.summary.runout.is_some() && usual.summary.stopping_time < Some(usual.summary.time));
    assert_eq!((none.summary.runout, none.summary.stopping_time, none.summary.max_speed), (None, None, 0.0));
}

#[test]
fn a_chute_leaves_profiles_and_a_film() {
    let folder = tempfile::tempdir().unwrap();
    let case = r#"
title = "A heap"
model = "savage_hutter"
[grid]
x = { from = -3.0, to = 3.0, cells = 60 }
boundary = "open"
[material]
epsilon = 0.4
slope = "0 deg"
friction.coulomb = { angle = "18 deg" }
[initial]
thickness.steps = { at = [-1.0, 1.0], values = [0.3, 1.3, 0.3] }
[time]
end = 1.0
[output]
every = 0.25
files = ["netcdf", "csv", "figures", "animation"]
"#;
    let run = computed(case, folder.path());
    run.write_files().unwrap();
    for name in ["profile", "velocity", "space_time_thickness", "space_time_velocity", "surface", "history"] {
        picture(&run.figures().join(format!("{name}.png")));
    }
    assert_eq!(picture(&run.directory.join("animation.png")).2, 5);
    let table = fs::read_to_string(run.directory.join("profiles.csv")).unwrap();
    assert_eq!(
        (table.lines().count(), table.lines().next()),
        (1 + 5 * 60, Some("time,x,thickness,velocity_x"))
    );
}

#[test]
fn a_missing_and_a_foreign_result_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path: PathBuf = folder.path().join("result.nc");
    let missing = Story::read(&path).unwrap_err();
    assert!(matches!(missing, FilesError::Missing { .. }) && missing.to_string().contains("granflow run"));
    fs::write(&path, "no NetCDF").unwrap();
    let foreign = Story::read(&path).unwrap_err();
    assert!(matches!(foreign, FilesError::Foreign { .. }) && foreign.to_string().contains("result.nc"));
}

/// What rests needs no further step; what is begun anew does not go on from an older run.
#[test]
fn a_run_that_rests_is_resumed_as_it_is_and_an_older_checkpoint_is_none() {
    let folder = tempfile::tempdir().unwrap();
    let case = slope(folder.path(), r#"["netcdf"]"#);
    let out = folder.path().join("out");
    let first = begin(&case, &out, false, &mut |_| false).unwrap().summary;
    assert_eq!(first.stop_reason, StopReason::AtRest);
    let ledger = fs::read(out.join("mass.csv")).unwrap();
    let again = begin(&case, &out, true, &mut |_| false).unwrap().summary;
    assert_eq!((again.stop_reason, again.steps, again.time), (first.stop_reason, first.steps, first.time));
    assert!(fs::read(out.join("mass.csv")).unwrap() == ledger);

    let state = out.join("checkpoint/state.bin");
    let older = fs::read(&state).unwrap();
    begin(&case, &out, false, &mut |_| true).unwrap();
    assert!(fs::read(&state).unwrap() != older, "the checkpoint of the run before");
    assert!(fs::read(out.join("previous/checkpoint/state.bin")).unwrap() == older);
    assert!(fs::read(out.join("previous/mass.csv")).unwrap() == ledger);
}

/// A run whose frames are given back has ended, and says so; what it left stays.
#[test]
fn a_run_that_has_ended_keeps_no_second_copy_and_is_not_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let case = slope(folder.path(), r#"["netcdf"]"#);
    let out = folder.path().join("out");
    let summary = begin(&case, &out, false, &mut |_| false).unwrap().close().unwrap();
    assert!(!out.join("checkpoint/frames.bin").exists());
    let result = fs::read(out.join("result.nc")).unwrap();
    match begin(&case, &out, true, &mut |_| false) {
        Err(RunError::Begin(BeginError::Ended { summary: again, .. })) => {
            assert_eq!((again.stop_reason, again.steps), (summary.stop_reason, summary.steps));
        }
        other => panic!("{other:?}"),
    }
    assert!(fs::read(out.join("result.nc")).unwrap() == result);
    fs::remove_file(out.join("result.nc")).unwrap();
    let lost = begin(&case, &out, true, &mut |_| false).unwrap_err().to_string();
    assert!(lost.contains("frames.bin is gone") && lost.contains("without --resume"), "{lost}");

    let part = begin(&case, &out, false, &mut |run| run.steps() == 3).unwrap().close().unwrap();
    assert_eq!(part.stop_reason, StopReason::Interrupted);
    assert!(out.join("checkpoint/frames.bin").exists(), "an interrupted run goes on from its frames");
}

/// What a run goes on from must be what it left: elevation, frames and ledger.
#[test]
fn what_was_changed_after_an_interruption_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let case = slope(folder.path(), r#"["netcdf"]"#);
    let out = folder.path().join("out");
    begin(&case, &out, false, &mut |run| run.time() > 9.0).unwrap();
    let refused = |file: &Path, change: &dyn Fn(&mut Vec<u8>), words: &str| {
        let sound = fs::read(file).unwrap();
        let mut bytes = sound.clone();
        change(&mut bytes);
        fs::write(file, bytes).unwrap();
        let message = begin(&case, &out, true, &mut |_| false).unwrap_err().to_string();
        let name = file.file_name().unwrap().to_str().unwrap();
        for part in [name, words, "--resume"] {
            assert!(message.contains(part), "{message}");
        }
        fs::write(file, sound).unwrap();
    };
    let [dem, frames, ledger] =
        [folder.path().join("slope.asc"), out.join("checkpoint/frames.bin"), out.join("mass.csv")];
    refused(&dem, &|bytes| *bytes.last_mut().unwrap() = b' ', "not what the run began with");
    refused(&frames, &|bytes| bytes.truncate(bytes.len() / 2), "sound frames");
    refused(&frames, &|bytes| bytes[3000] ^= 1, "checksum");
    let swapped = |bytes: &mut Vec<u8>| {
        let text = String::from_utf8(bytes.clone()).unwrap();
        let mut lines: Vec<&str> = text.lines().collect();
        lines.swap(2, 3);
        *bytes = (lines.join("\n") + "\n").into_bytes();
    };
    refused(&ledger, &swapped, "not those");
    refused(&ledger, &|bytes| bytes.truncate(300), "lines below its header");
    begin(&case, &out, true, &mut |_| false).unwrap();
}

#[test]
fn nothing_to_go_on_from_is_said_and_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let case = slope(folder.path(), r#"["netcdf"]"#);
    let message = begin(&case, &folder.path().join("none"), true, &mut |_| false).unwrap_err().to_string();
    assert!(message.contains("no checkpoint") && message.contains("without --resume"), "{message}");
    assert!(!folder.path().join("none").exists());
}

/// Two runs at once would mix their files.
#[test]
fn a_second_run_in_the_folder_of_the_first_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let case = slope(folder.path(), r#"["netcdf"]"#);
    let out = folder.path().join("out");
    let mut tried = None;
    begin(&case, &out, false, &mut |run| {
        if run.steps() == 2 {
            tried = Some(begin(&case, &out, false, &mut |_| false).unwrap_err().to_string());
        }
        false
    })
    .unwrap();
    let message = tried.unwrap();
    assert!(message.contains("another run") && message.contains("--out"), "{message}");
    begin(&case, &out, false, &mut |_| false).unwrap();
}

/// Very many instants in one step: the end is asked for between them, and the run goes on from before that step.
#[test]
fn a_run_ends_within_a_step_of_many_frames_and_goes_on_to_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"
        grid.x = { from = -6.0, to = 6.0, cells = 60 }
        material.friction.coulomb = { angle = "18 deg" }
        initial.thickness.cap = { height = 1.0, radius = 2.0 }
        time = { end = 1.0 }
        output = { every = 1e-3, files = ["netcdf"] }
        "#;
    let case = case(text, folder.path());
    let [whole, parts] = ["whole", "parts"].map(|name| folder.path().join(name));
    begin(&case, &whole, false, &mut |_| false).unwrap();
    let mut run = case.check().unwrap().start().unwrap();
    let plan = case.check().unwrap().plan().clone();
    let stop = AtomicBool::new(false);
    let lock = Folder::take(&parts).unwrap();
    let mut files = Files::begin(lock, &plan, origin(&plan).unwrap(), "test", &mut *run).unwrap();
    let mut counted = Counted { stop: &stop, instants: 0, every: 1e-3 };
    let sinks: &mut [&mut dyn Sink] = &mut [&mut Stop(&stop), &mut files, &mut counted];
    let reason = drive(&mut *run, &plan.ends, sinks).unwrap();
    assert_eq!((reason, counted.instants), (StopReason::Interrupted, 25));
    let left = files.finish(run, reason).unwrap();
    assert_eq!(left.frames.times().len(), 26);
    drop(left);
    begin(&case, &parts, true, &mut |_| false).unwrap();
    for file in ["mass.csv", "checkpoint/frames.bin"] {
        assert!(fs::read(whole.join(file)).unwrap() == fs::read(parts.join(file)).unwrap(), "{file} differs");
    }
}

/// Asks for the end at the 25th instant.
struct Counted<'a> {
    stop: &'a AtomicBool,
    instants: u64,
    every: f64,
}

impl Sink for Counted<'_> {
    fn next_instant(&self) -> f64 {
        (self.instants + 1) as f64 * self.every
    }
    fn at_instant(&mut self, _run: &mut dyn Run) -> Result<(), SinkError> {
        self.instants += 1;
        self.stop.store(self.instants == 25, Ordering::Relaxed);
        Ok(())
    }
    fn after_step(&mut self, _run: &mut dyn Run) -> Result<(), SinkError> {
        Ok(())
    }
}

/// A computation that fails says so in its summary.
#[test]
fn a_run_that_fails_leaves_a_summary_that_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"
        grid.x = { from = -6.0, to = 6.0, cells = 60 }
        material.friction.coulomb = { angle = "18 deg" }
        initial.thickness.cap = { height = 1.0, radius = 2.0 }
        scheme = { name = "balanced", step = 0.5 }
        time = { steps = 100 }
        output.files = ["netcdf"]
        "#;
    let failed = begin(&case(text, folder.path()), &folder.path().join("out"), false, &mut |_| false);
    let RunError::Computation { failure, .. } = failed.unwrap_err() else { panic!("it failed otherwise") };
    let summary = Summary::read(&folder.path().join("out/summary.json")).unwrap();
    assert_eq!(summary.stop_reason, StopReason::Failed);
    assert_eq!(summary.extra.get("failure").unwrap().as_str().unwrap(), failure.to_string());
}

/// The energy that a run ends by is that of the state taken up, not of the start.
#[test]
fn an_end_by_energy_is_found_by_a_resumed_run_at_the_same_step() {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"
        grid.x = { from = -6.0, to = 6.0, cells = 60 }
        material.friction.coulomb = { angle = "18 deg" }
        initial.thickness.cap = { height = 1.0, radius = 2.0 }
        time = { until = "rest", end = 50.0, stop.kinetic_energy = 0.05 }
        output.files = ["netcdf"]
        "#;
    let case = case(text, folder.path());
    let whole = begin(&case, &folder.path().join("whole"), false, &mut |_| false).unwrap().summary;
    assert_eq!(whole.stop_reason, StopReason::KineticEnergy);
    let parts = folder.path().join("parts");
    let broken = begin(&case, &parts, false, &mut |run| run.steps() >= whole.steps / 2).unwrap().summary;
    assert_eq!(broken.stop_reason, StopReason::Interrupted);
    let resumed = begin(&case, &parts, true, &mut |_| false).unwrap().summary;
    assert_eq!((resumed.stop_reason, resumed.steps), (whole.stop_reason, whole.steps));
    assert_eq!(resumed.time.to_bits(), whole.time.to_bits());
}

/// A sink in memory and the files of a run share one piece of code: the same bytes come out.
#[test]
fn series_in_memory_make_the_file_that_series_on_disk_make() {
    let folder = tempfile::tempdir().unwrap();
    let run =
        begin(&slope(folder.path(), r#"["netcdf"]"#), &folder.path().join("out"), false, &mut |_| false);
    let run = run.unwrap();
    let mut frames = run.frames.again().unwrap();
    let about = About { title: "A small slide".to_owned(), case: run.case.clone(), ..About::default() };
    let of = |series| {
        dataset(&run.plane, Precision::F64, frames.times().to_vec(), series, &run.maps, about.clone())
            .unwrap()
    };
    let names: Vec<String> = frames.fields().iter().map(|field| field.name.clone()).collect();
    let on_disk = of(names.iter().map(|name| (name.as_str(), Values::Stored(name.clone()))).collect());
    let mut again = run.frames.again().unwrap();
    let count = frames.times().len();
    let mut read = |field| (0..count).map(|k| again.read(k, field).unwrap()).collect::<Vec<_>>();
    let all: Vec<Vec<Vec<f64>>> = (0..names.len()).map(&mut read).collect();
    let series = names.iter().zip(&all);
    let in_memory = of(series.map(|(name, maps)| (name.as_str(), Values::Series(maps.into()))).collect());
    let path = folder.path().join("again.nc");
    on_disk.write(&path, Some(&mut frames)).unwrap();
    assert!(fs::read(&path).unwrap() == in_memory.to_bytes().unwrap());
    assert!(on_disk.to_bytes().unwrap_err().to_string().contains("needs the store of frames"));
}

/// Kinds of files by their names.
fn kinds(names: &[&str]) -> Vec<FileKind> {
    granflow::Disk.kinds().iter().filter(|kind| names.contains(&kind.name)).copied().collect()
}

/// A model from outside: water on a plane, its bed known at the nodes.
static WATER: Model = Model {
    name: "water",
    quantities: &[
        Quantity::series("depth", "depth of the water", ["1", "m"]),
        Quantity::fixed("corners", "elevation of the nodes", ["1", "m"]).at(At::Nodes).exact(),
        Quantity::map("flood", "largest depth", ["1", "m"]).with_maximum(),
    ],
    ..Model::PLAIN
};

#[derive(Debug)]
struct Pond([f64; 3]);

impl Domain for Pond {
    fn model(&self) -> &'static Model {
        &WATER
    }
    fn nodes(&self) -> Option<[&[f64]; 2]> {
        Some([&self.0, &[]])
    }
    fn fixed(&self) -> Vec<(&'static str, std::borrow::Cow<'_, [f64]>)> {
        vec![("corners", vec![1.0, 0.0, 1.0].into())]
    }
}

#[test]
fn a_model_from_outside_writes_its_result_by_its_table_of_quantities() {
    let plane = Plane { x: vec![0.5, 1.5], y: Vec::new(), domain: Arc::new(Pond([0.0, 1.0, 2.0])) };
    assert_eq!(
        plane.series().iter().map(|f| (f.name.as_str(), f.length)).collect::<Vec<_>>(),
        [("depth", 2)]
    );
    let made = |name: &'static str| -> Result<Dataset<'static>, String> {
        let plane: &'static Plane = Box::leak(Box::new(plane.clone()));
        let series = vec![(name, Values::Series(vec![vec![0.1, 0.2], vec![0.3, 0.4]].into()))];
        dataset(plane, Precision::F32, vec![0.0, 1.0], series, &[], About::default())
    };
    assert_eq!(made("height").unwrap_err(), "the model water has no quantity height");
    let file = NcFile::from_bytes(&made("depth").unwrap().to_bytes().unwrap()).unwrap();
    assert_eq!(file.read_variable::<f32>("depth").unwrap().shape(), [2, 2]);
    assert_eq!(file.read_variable::<f64>("corners").unwrap().as_slice().unwrap(), [1.0, 0.0, 1.0]);
    assert_eq!(file.global_attribute("model").unwrap().value.as_string().unwrap(), "water");
    let refused = check_kinds(&kinds(&["netcdf", "figures"]), &plane).unwrap_err().to_string();
    assert!(refused.contains("figures") && refused.contains("water") && refused.contains("out of the list"));
    assert!(check_kinds(&kinds(&["netcdf", "csv", "vtk"]), &plane).is_ok());
}
