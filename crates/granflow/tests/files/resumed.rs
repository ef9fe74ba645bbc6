//! Runs that end before their time: full disks, failures, interruptions, and what goes on from there.

use super::*;
use granflow::session::restore;

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

/// What is saved before the first step holds no numbers, for the case makes them again; a run that was killed right then goes on to the
/// bits of the unbroken one, with all that is kept beside the state.
#[test]
fn from_the_first_checkpoint_the_bits_are_those_of_the_unbroken_run() {
    let folder = tempfile::tempdir().unwrap();
    let beside = [
        "output.durations={ thickness = 0.1 }",
        r#"gauge=[{ name = "foot", at = [1075.0, 2110.0] }]"#,
        r#"entrainment={ layer = 0.3, law = "plough", lower_bed = true }"#,
    ];
    let case = with(&file(folder.path()), &beside);
    let [whole, killed] = ["whole", "killed"].map(|name| folder.path().join(name));
    let state = whole.join("checkpoint/state.bin");
    let mut copied = false;
    let unbroken = begin(&case, &whole, false, &mut |_| {
        if !copied {
            while !state.exists() {
                std::thread::sleep(Duration::from_millis(1));
            }
            assert!(fs::metadata(&state).unwrap().len() < 10_000);
            fs::create_dir_all(killed.join("checkpoint")).unwrap();
            for name in ["mass.csv", "gauges.csv", "checkpoint/frames.bin", "checkpoint/state.bin"] {
                fs::copy(whole.join(name), killed.join(name)).unwrap();
            }
            copied = true;
        }
        false
    });
    let first = folder.path().join("first.bin");
    fs::copy(killed.join("checkpoint/state.bin"), &first).unwrap();
    let resumed = begin(&case, &killed, true, &mut |_| false).unwrap().summary;
    assert_eq!(resumed.steps, unbroken.unwrap().summary.steps);
    for name in ["mass.csv", "gauges.csv", "checkpoint/frames.bin"] {
        assert!(
            fs::read(whole.join(name)).unwrap() == fs::read(killed.join(name)).unwrap(),
            "{name} differs"
        );
    }
    // A run that has gone on is not what its case makes.
    let checked = case.check().unwrap();
    let made_of = origin(checked.plan(), &granflow::Inputs::default()).unwrap();
    let mut run = checked.start().unwrap();
    assert_eq!(restore(&mut *run, &made_of, &first).unwrap().len(), 0);
    run.until(1.0).unwrap();
    let refused = restore(&mut *run, &made_of, &first).unwrap_err().to_string();
    assert!(refused.contains("first.bin") && refused.contains("before the first step"), "{refused}");
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
        Err(RunError::Begin(BeginError::Ended { summary: again, files, .. })) => {
            assert_eq!(files, 4, "checkpoint, ledger, result, summary");
            assert_eq!((again.stop_reason, again.steps), (summary.stop_reason, summary.steps));
        }
        other => panic!("{other:?}"),
    }
    assert!(fs::read(out.join("result.nc")).unwrap() == result);
    fs::remove_file(out.join("result.nc")).unwrap();
    let lost = begin(&case, &out, true, &mut |_| false).unwrap_err().to_string();
    assert!(lost.contains("result.nc is gone") && lost.contains("without --resume"), "{lost}");
    assert!(!out.join("checkpoint/frames.bin").exists());

    let part = begin(&case, &out, false, &mut |run| run.steps() == 3).unwrap().close().unwrap();
    assert_eq!(part.stop_reason, StopReason::Interrupted);
    assert!(out.join("checkpoint/frames.bin").exists(), "an interrupted run goes on from its frames");
}

/// Files of a finished run that are lost or changed are made again to the same bytes, from what `result.nc` holds.
#[test]
fn lost_files_of_a_finished_run_are_made_again() {
    let folder = tempfile::tempdir().unwrap();
    let case = slope(folder.path(), r#"["netcdf", "geotiff", "csv", "report"]"#);
    let out = folder.path().join("out");
    begin(&case, &out, false, &mut |_| false).unwrap().close().unwrap();
    let names =
        ["maps.csv", "rasters/deposit.tif", "figures/deposit.png", "mass.csv"].map(|name| out.join(name));
    let sound = names.clone().map(|name| fs::read(name).unwrap());
    let state = |out: &Path| -> Vec<Vec<u8>> {
        let file = NcFile::open(out.join("result.nc")).unwrap();
        let names: Vec<String> = file.variables().unwrap().iter().map(|one| one.name.clone()).collect();
        names.iter().map(|name| file.read_variable_raw_bytes(name).unwrap()).collect()
    };
    let result = state(&out);
    let append = |path: &Path| {
        let mut bytes = fs::read(path).unwrap();
        bytes.extend(b"more");
        fs::write(path, bytes).unwrap();
    };
    let losses: [&dyn Fn(); 6] = [
        &|| fs::remove_file(out.join("maps.csv")).unwrap(),
        &|| append(&out.join("rasters/deposit.tif")),
        &|| fs::remove_dir_all(out.join("figures")).unwrap(),
        &|| fs::remove_file(out.join("summary.json")).unwrap(),
        &|| append(&out.join("result.nc")),
        &|| fs::remove_file(out.join("checkpoint/files.json")).unwrap(),
    ];
    for (k, lose) in losses.iter().enumerate() {
        lose();
        let again = begin(&case, &out, true, &mut |_| false).unwrap_or_else(|error| panic!("{k}: {error}"));
        assert_eq!(again.close().unwrap().stop_reason, StopReason::AtRest);
        for (name, bytes) in names.iter().zip(&sound) {
            assert!(fs::read(name).unwrap() == *bytes, "{k}: {} differs", name.display());
        }
        assert!(state(&out) == result, "{k}: result.nc differs");
        let whole = begin(&case, &out, true, &mut |_| false).map(|_| ()).unwrap_err().to_string();
        assert!(whole.contains("files that it left are whole"), "{whole}");
    }
}

/// What cannot be made again is named, with what helps.
#[test]
fn what_a_finished_run_cannot_do_without_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let case = slope(folder.path(), r#"["netcdf"]"#);
    let out = folder.path().join("out");
    begin(&case, &out, false, &mut |_| false).unwrap().close().unwrap();
    let refused = |name: &str, change: &dyn Fn(&mut Vec<u8>), words: &[&str]| {
        let sound = fs::read(out.join(name)).unwrap();
        let mut bytes = sound.clone();
        change(&mut bytes);
        fs::write(out.join(name), bytes).unwrap();
        let message = begin(&case, &out, true, &mut |_| false).map(|_| ()).unwrap_err().to_string();
        for part in words.iter().chain(&[name, "without --resume"]) {
            assert!(message.contains(part), "{message}");
        }
        fs::write(out.join(name), sound).unwrap();
    };
    refused("result.nc", &|bytes| bytes.truncate(500), &["has 500 bytes"]);
    assert!(!out.join("checkpoint/frames.bin").exists());
    // One bit of the thickness where the release begins.
    let file = NcFile::open(out.join("result.nc")).unwrap();
    let thickness = file.read_variable_raw_bytes("thickness").unwrap();
    let release = thickness.chunks(64).find(|cells| cells.chunks(8).all(|cell| cell[7] != 0)).unwrap();
    let flip = |bytes: &mut Vec<u8>| {
        let place = bytes.windows(64).position(|window| window == release).unwrap();
        bytes[place + 5] ^= 1;
    };
    refused("result.nc", &flip, &["is altered", "not those of the run"]);
    refused("mass.csv", &|bytes| bytes.truncate(300), &["lines below its header"]);
    let whole = begin(&case, &out, true, &mut |_| false).map(|_| ()).unwrap_err().to_string();
    assert!(whole.contains("files that it left are whole"), "{whole}");
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
    let inputs = granflow::Inputs::default();
    let watch = granflow::watch::Watch::of(&plan, &inputs, &*run).unwrap();
    let lock = Folder::take(&parts).unwrap();
    let mut files =
        Files::begin(lock, &plan, origin(&plan, &inputs).unwrap(), "test", watch, &mut *run).unwrap();
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
