//! Finished runs that go on: to a later end, with other parameters, and not where the state stands on what differs.

use super::*;

fn bytes(folder: &Path, name: &str) -> Vec<u8> {
    fs::read(folder.join(name)).unwrap()
}

/// A run that its end cut goes on to a later one with the bits of the run to that.
#[test]
fn to_a_later_end_the_bits_are_those_of_the_unbroken_run() {
    let folder = tempfile::tempdir().unwrap();
    let case = file(folder.path());
    let [whole, parts] = ["whole", "parts"].map(|name| folder.path().join(name));
    let watch = r#"gauge=[{ name = "foot", at = [1075.0, 2110.0] }]"#;
    let section = r#"section=[{ name = "toe", line = [[1000.0, 2110.0], [1150.0, 2110.0]] }]"#;
    let ended = |end: &str| with(&case, &[end, "output.every=0.7", watch, section]);
    let unbroken = begin(&ended("time.end=9.3"), &whole, false, &mut |_| false).unwrap().summary;
    let first = begin(&ended("time.end=4.1"), &parts, false, &mut |_| false).unwrap().close().unwrap();
    assert_eq!((first.stop_reason, first.time), (StopReason::EndTime, 4.1));
    assert!(!parts.join("checkpoint/frames.bin").exists());

    let went = begin(&ended("time.end=9.3"), &parts, true, &mut |_| false).unwrap();
    assert_eq!((went.summary.steps, went.summary.time), (unbroken.steps, 9.3));
    for name in ["mass.csv", "checkpoint/frames.bin", "gauges.csv", "sections.csv"] {
        assert!(bytes(&whole, name) == bytes(&parts, name), "{name} differs");
    }
    let told: Vec<&str> = went.summary.texts("history").collect();
    assert_eq!(told.len(), 1);
    assert!(
        told[0].ends_with("before the step that its end had cut: time.end = 9.3 instead of 4.1"),
        "{told:?}"
    );
    assert!(!went.summary.warnings.iter().any(|warning| warning.contains("friction changed")));
    let history = NcFile::open(parts.join("result.nc")).unwrap().global_attribute("history").unwrap().clone();
    let history = history.value.as_string().unwrap();
    assert!(
        history.lines().filter(|line| line.ends_with("Z test")).count() == 2 && history.contains(told[0]),
        "{history}"
    );
    assert!(fs::read_to_string(parts.join("report.html")).unwrap().contains("This run went on at time"));
}

/// An end that is not later, and a mass at rest, leave nothing to do.
#[test]
fn what_rests_or_has_reached_its_end_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let case = file(folder.path());
    let out = folder.path().join("out");
    let again = |changes: &[&str]| match begin(&with(&case, changes), &out, true, &mut |_| false) {
        Err(RunError::Begin(error @ BeginError::Ended { .. })) => error.to_string(),
        other => panic!("{other:?}"),
    };
    begin(&with(&case, &["time.end=4.1"]), &out, false, &mut |_| false).unwrap().close().unwrap();
    let before = bytes(&out, "mass.csv");
    let earlier = again(&["time.end=4"]);
    assert!(earlier.contains("--set time.end=... goes on to a later end"), "{earlier}");
    assert!(bytes(&out, "mass.csv") == before);

    begin(&with(&case, &[]), &out, true, &mut |_| false).unwrap().close().unwrap();
    assert!(!out.join("checkpoint/before_end.bin").exists(), "no end has cut this run");
    let rests = again(&["time.end=900"]);
    assert!(
        rests.contains("at rest") && rests.contains("whatever the end nothing will move again"),
        "{rests}"
    );
}

/// With less friction a deposit starts again; the run says that its parts differ.
#[test]
fn other_parameters_wake_what_rests() {
    let folder = tempfile::tempdir().unwrap();
    let case = file(folder.path());
    let out = folder.path().join("out");
    let first = begin(&with(&case, &[]), &out, false, &mut |_| false).unwrap();
    let deposit = first.map("deposit").unwrap().to_vec();
    let first = first.close().unwrap();
    assert_eq!(first.stop_reason, StopReason::AtRest);

    let held =
        begin(&with(&case, &["material.friction.coulomb.mu=0.5"]), &out, true, &mut |_| false).unwrap();
    assert_eq!(held.summary.stop_reason, StopReason::AtRest);
    assert!(
        held.map("deposit").unwrap().iter().zip(&deposit).all(|(new, old)| new.to_bits() == old.to_bits())
    );
    held.close().unwrap();

    let less = ["material.friction.coulomb.mu=0.1", "time.end=400"];
    let went = begin(&with(&case, &less), &out, true, &mut |_| false).unwrap();
    let Summary { time, steps, ref warnings, .. } = went.summary;
    assert!(time > first.time + 1.0 && steps > first.steps + 10, "{time} {steps}");
    assert!(went.frames.times().contains(&first.time), "its state where it goes on is a frame");
    assert!(warnings.iter().any(|warning| warning.contains("the friction changed")), "{warnings:?}");
    let told: Vec<&str> = went.summary.texts("history").collect();
    assert_eq!(told.len(), 2);
    for part in
        ["where it had ended (at rest)", "coulomb.mu = 0.1 instead of 0.5", "time.end = 400 instead of 200"]
    {
        assert!(told[1].contains(part), "{told:?}");
    }
    assert!(went.summary.mass_error.abs() < 1e-13);
}

/// A run that was interrupted after it went on is taken up as any other.
#[test]
fn a_run_that_went_on_can_be_interrupted_and_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let case = file(folder.path());
    let [whole, parts] = ["whole", "parts"].map(|name| folder.path().join(name));
    let later = with(&case, &["time.end=30", "material.friction.coulomb.mu=0.3"]);
    for out in [&whole, &parts] {
        begin(&with(&case, &["time.end=4.1"]), out, false, &mut |_| false).unwrap().close().unwrap();
    }
    let unbroken = begin(&later, &whole, true, &mut |_| false).unwrap().summary;
    let broken = begin(&later, &parts, true, &mut |run| run.time() > 7.0).unwrap().summary;
    assert_eq!(broken.stop_reason, StopReason::Interrupted);
    let resumed = begin(&later, &parts, true, &mut |_| false).unwrap().summary;
    assert_eq!((resumed.steps, resumed.time), (unbroken.steps, unbroken.time));
    assert_eq!(resumed.extra.get("history"), unbroken.extra.get("history"));
    for name in ["mass.csv", "checkpoint/frames.bin"] {
        assert!(bytes(&whole, name) == bytes(&parts, name), "{name} differs");
    }
}

/// What the state stands on is named where it differs, and nothing is touched.
#[test]
fn what_a_run_stands_on_may_not_change() {
    let folder = tempfile::tempdir().unwrap();
    let case = file(folder.path());
    let out = folder.path().join("out");
    begin(&with(&case, &["time.end=4.1"]), &out, false, &mut |_| false).unwrap().close().unwrap();
    let kept = bytes(&out, "result.nc");
    for change in [
        "terrain.cell=10",
        "terrain.curvature={ length = 20.0 }",
        "release.0.cap.height=3",
        "release.0.measured=vertical",
        "scheme.name=energy_stable",
        "scheme.film=1e-3",
        "material.density=400",
        "material.gravity=9",
        "output.threshold=0.1",
        "output.durations={ thickness = 0.5 }",
        "output.precision=f32",
        r#"gauge=[{ name = "foot", at = [1075.0, 2110.0] }]"#,
        "entrainment={ layer = 0.3, law = \"plough\" }",
        "material.earth_pressure={ active_passive = { internal = \"35 deg\" } }",
    ] {
        let refused =
            begin(&with(&case, &[change, "time.end=9"]), &out, true, &mut |_| false).unwrap_err().to_string();
        let key = change.split('=').next().unwrap().replace(".0", "[0]");
        assert!(refused.contains(&format!("another case: {key}")), "{change}: {refused}");
        assert!(refused.contains("start again without --resume"), "{refused}");
    }
    let breaks = ["material.forest=0.02", "material.forest_breaks_at=100.0"];
    let refused = begin(&with(&case, &breaks), &out, true, &mut |_| false).unwrap_err().to_string();
    assert!(refused.contains("another case: material.forest_breaks_at"), "{refused}");
    assert!(bytes(&out, "result.nc") == kept && !out.join("checkpoint/frames.bin").exists());
}

/// What acts between the steps goes on where it was: eroded, broken, pressed.
#[test]
fn a_layer_a_forest_and_a_passive_pressure_go_on() {
    let folder = tempfile::tempdir().unwrap();
    let case = file(folder.path());
    let [whole, parts] = ["whole", "parts"].map(|name| folder.path().join(name));
    let all = |end: &str, forest: &str| {
        let changes = [
            end,
            forest,
            "entrainment={ layer = 0.3, law = \"plough\", lower_bed = true }",
            "material.forest_breaks_at=20.0",
            "material.earth_pressure={ active_passive = { internal = \"35 deg\" } }",
        ];
        with(&case, &changes)
    };
    let sparse = "material.forest=0.02";
    let unbroken = begin(&all("time.end=9.3", sparse), &whole, false, &mut |_| false).unwrap().summary;
    assert!(unbroken.extra("eroded_volume") > Some(0.0) && unbroken.extra("forest_broken_area") > Some(0.0));
    begin(&all("time.end=4.1", sparse), &parts, false, &mut |_| false).unwrap().close().unwrap();
    let went = begin(&all("time.end=9.3", sparse), &parts, true, &mut |_| false).unwrap();
    for name in ["eroded_volume", "forest_broken_area", "kinetic_energy_final"] {
        assert_eq!(went.summary.extra(name), unbroken.extra(name), "{name}");
    }
    assert!(bytes(&whole, "checkpoint/frames.bin") == bytes(&parts, "checkpoint/frames.bin"));
    went.close().unwrap();
    let dense = begin(&all("time.end=12", "material.forest=0.05"), &parts, true, &mut |_| false).unwrap();
    assert!(dense.summary.time > 9.3 && dense.summary.mass_error.abs() < 1e-12);
}

/// Lost files hinder no run from going on where its frames and tables are whole; where nothing is left to do they are named.
#[test]
fn a_run_of_which_files_are_lost_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let case = file(folder.path());
    let [whole, parts] = ["whole", "parts"].map(|name| folder.path().join(name));
    begin(&with(&case, &["time.end=9.3"]), &whole, false, &mut |_| false).unwrap();
    let close = |end: &str, resume: bool| {
        begin(&with(&case, &[end]), &parts, resume, &mut |_| false).unwrap().close().unwrap()
    };
    close("time.end=4.1", false);
    fs::remove_file(parts.join("report.html")).unwrap();
    let earlier = begin(&with(&case, &["time.end=4"]), &parts, true, &mut |_| false).unwrap_err().to_string();
    assert!(earlier.contains("report.html is gone") && earlier.contains("makes again"), "{earlier}");
    // Made again they are of the same end, and the step that it cut is still known.
    let before = bytes(&parts, "checkpoint/before_end.bin");
    close("time.end=4.1", true);
    assert!(parts.join("report.html").exists() && bytes(&parts, "checkpoint/before_end.bin") == before);
    fs::remove_file(parts.join("report.html")).unwrap();
    let went = begin(&with(&case, &["time.end=9.3"]), &parts, true, &mut |_| false).unwrap();
    assert_eq!(went.summary.texts("history").count(), 1);
    assert!(parts.join("report.html").exists());
    for name in ["mass.csv", "checkpoint/frames.bin"] {
        assert!(bytes(&whole, name) == bytes(&parts, name), "{name} differs");
    }
    went.close().unwrap();
    fs::remove_file(parts.join("result.nc")).unwrap();
    let lost = begin(&with(&case, &["time.end=12"]), &parts, true, &mut |_| false).unwrap_err().to_string();
    assert!(lost.contains("result.nc is gone") && lost.contains("without --resume"), "{lost}");
}

/// A path may be in memory; what a run left may not.
#[test]
fn a_path_in_memory_is_found_and_a_result_in_memory_refused() {
    let folder = tempfile::tempdir().unwrap();
    let case = file(folder.path());
    let line = r#"{"type":"LineString","coordinates":[[1075,2230],[1075,2110]]}"#;
    let inputs =
        granflow::Inputs::default().with_file("<path>", line.as_bytes()).with_file("result.nc", *b"x");
    let stop = AtomicBool::new(false);
    let path = with(&case, &["output.path=\"<path>\"", "time.end=1"]).check_with(&inputs).unwrap();
    let kept = path.compute_in_memory(1, &stop, &mut |_| ()).unwrap();
    assert_eq!(kept.summary.time, 1.0);
    let result = with(&case, &[r#"release=[{ result = "out" }]"#]).check_with(&inputs).unwrap();
    let refused = result.start().err().unwrap().to_string();
    assert!(refused.contains("in memory") && refused.contains("result.nc"), "{refused}");
}
