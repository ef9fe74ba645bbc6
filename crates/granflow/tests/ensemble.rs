//! Ensembles: a known answer, the same bits however they are computed, members that fail, release thicknesses by feature.
#![cfg(all(feature = "figures", feature = "geo"))]

use granflow::Case;
use granflow::ensemble::{Ensemble, EnsembleError, Options, Outcome, Progress, Reduced};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// A slab on a level floor, so flat that its pressure moves nothing: with speed 1 it slides 1/(2 mu) and stops.
const SLAB: &str = r#"
title = "A slab slides to its stop"
[grid]
x = { from = -1.0, to = 6.0, cells = 350 }
[material]
epsilon = 1e-4
friction.coulomb = { mu = 0.2 }
[initial]
thickness.steps = { at = [-0.5, 0.0], values = [0.0, 1.0, 0.0] }
velocity_x = 1.0
[time]
until = "rest"
end = 12.0
[output]
files = ["netcdf"]
threshold = 0.001
[ensemble]
members = 200
sampling = "random"
seed = 3
vary."material.friction.coulomb.mu" = { uniform = [0.1, 0.4] }
exceed.peak_thickness = [0.5]
exceed.peak_speed = [0.5]
percentiles = [50, 90]
"#;

fn of(text: &str) -> Ensemble {
    Ensemble::of(&Case::parse(text, "case.toml").unwrap()).unwrap()
}

fn never() -> AtomicBool {
    AtomicBool::new(false)
}

fn nothing(_: Progress, _: Option<&Outcome>) {}

/// Some members, on so many workers.
fn computed(ensemble: &Ensemble, members: std::ops::Range<u32>, workers: usize) -> Reduced {
    let keep = |_: &Reduced| Ok(());
    ensemble.run(members, ensemble.empty(), workers, &never(), &keep, &mut nothing).unwrap()
}

/// All maps, by their names and bits.
fn bits(ensemble: &Ensemble, reduced: &Reduced) -> Vec<(String, Vec<u64>)> {
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect();
    ensemble.maps(reduced).iter().map(|map| (map.name.clone(), bits(&map.values))).collect()
}

/// Every bit of what was added up, as a file has it.
fn bytes(ensemble: &Ensemble, reduced: &Reduced) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part");
    ensemble.write(reduced, &path).unwrap();
    fs::read(path).unwrap()
}

/// Are they the same in every bit?
#[track_caller]
fn same(ensemble: &Ensemble, one: &Reduced, other: &Reduced) {
    assert!(bits(ensemble, one) == bits(ensemble, other), "the maps differ");
    assert!(bytes(ensemble, one) == bytes(ensemble, other), "what was added up differs");
}

fn options(folder: &Path, members: std::ops::Range<u32>) -> Options {
    let (directory, command) = (folder.to_owned(), "test".to_owned());
    Options { directory, members, workers: 2, resume: false, keep_members: false, command, notice: |_| () }
}

#[test]
fn the_probability_of_a_run_out_is_that_of_its_friction() {
    let ensemble = of(SLAB);
    let reduced = computed(&ensemble, 0..200, 2);
    assert_eq!((reduced.computed(), reduced.failures().count()), (200, 0));
    let maps = ensemble.maps(&reduced);
    let map =
        |name: &str| &maps.iter().find(|map| map.name == name).unwrap_or_else(|| panic!("{name}")).values;
    let (exceedance, largest) = (map("exceedance_peak_thickness_0_5"), map("max_peak_thickness"));
    let mut between = 0;
    for (cell, x) in ensemble.plane().x.iter().enumerate().filter(|(_, x)| **x > 0.2) {
        // The front is at x or beyond where mu < 1/(2 x); a cell of 0.02 is the least that a front can be told by.
        let share = |x: f64| ((0.5 / x - 0.1) / 0.3).clamp(0.0, 1.0);
        let found = if exceedance[cell].is_nan() { 0.0 } else { exceedance[cell] };
        let bound = 4.0 * (share(*x) * (1.0 - share(*x)) / 200.0).sqrt();
        let [low, high] = [share(x + 0.04) - bound, share(x - 0.04) + bound];
        assert!(found >= low && found <= high, "x = {x}: {found}, not {low} to {high}");
        between += usize::from((0.1..0.9).contains(&found));
        assert!(largest[cell].is_nan() || largest[cell] > 0.001);
    }
    assert!(between > 100, "{between} cells are neither always nor never reached");
    let (mean, median) = (map("mean_peak_thickness"), map("p50_peak_thickness"));
    let start = ensemble.plane().x.iter().position(|x| *x > -0.25).unwrap();
    assert!((mean[start] - 1.0).abs() < 1e-9 && (median[start] - 1.0).abs() < 1.0 / 16.0);
    assert_eq!(map("count")[start], 200.0);
}

#[test]
fn workers_order_and_parts_leave_every_bit_of_the_maps() {
    let short = SLAB.replace("members = 200", "members = 48").replace("\"random\"", "\"sobol\"");
    let ensemble = of(&short);
    let whole = computed(&ensemble, 0..48, 1);
    assert_eq!(ensemble.maps(&whole).len(), 1 + 2 * 5);
    for workers in [2, 3] {
        same(&ensemble, &computed(&of(&short), 0..48, workers), &whole);
    }
    let mut parts: Vec<Reduced> =
        (1..=16).map(|part| computed(&ensemble, ensemble.members_of_part([part, 16]), 2)).collect();
    // backwards, and every third before
    parts.reverse();
    for k in (0..16).step_by(3) {
        let part = parts.remove(k);
        parts.insert(0, part);
    }
    let mut merged = ensemble.empty();
    parts.into_iter().for_each(|part| merged.merge(part).unwrap());
    same(&ensemble, &merged, &whole);
    // alone and again: one member that is computed by itself is the one of all
    let outcome = ensemble.compute(17, &never()).unwrap();
    let mut one = ensemble.empty();
    one.add(outcome);
    let mut others = computed(&ensemble, 0..17, 2);
    others.merge(computed(&ensemble, 18..48, 2)).unwrap();
    others.merge(one.clone()).unwrap();
    same(&ensemble, &others, &whole);
    assert_eq!(others.merge(one), Err(17));
    same(&ensemble, &others, &whole); // a merge that is refused adds nothing
}

#[test]
fn parts_as_files_are_one_ensemble_or_refused_with_the_reason() {
    let short = SLAB.replace("members = 200", "members = 12");
    let ensemble = of(&short);
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let part = |number: u32| {
        let made = ensemble.into_part([number, 3], &options(&at("parts"), 0..0), &never(), &mut |_| ());
        made.unwrap().unwrap()
    };
    let parts: Vec<PathBuf> = [3, 1, 2].map(part).into();
    let merged = ensemble.merge(&parts, &options(&at("merged"), 0..0)).unwrap();
    let whole = ensemble.into_folder(&options(&at("whole"), 0..12), &never(), &mut |_| ()).unwrap();
    same(&ensemble, &merged.reduced, &whole.reduced);
    for name in ["members.csv", "ensemble.json", "checkpoint/ensemble.bin"] {
        assert_eq!(
            fs::read(at("merged").join(name)).unwrap(),
            fs::read(at("whole").join(name)).unwrap(),
            "{name}"
        );
    }
    let refused = |parts: &[&PathBuf], part: &str| {
        let parts: Vec<PathBuf> = parts.iter().map(|path| (*path).clone()).collect();
        let message = ensemble.merge(&parts, &options(&at("refused"), 0..0)).unwrap_err().to_string();
        assert!(message.contains(part), "{message}");
        assert!(!at("refused").exists(), "nothing is made of it");
    };
    refused(&[&parts[0], &parts[1], &parts[0], &parts[2]], "member 8 is in");
    refused(&[&parts[0], &parts[1]], "4 members are in no part: 4..8");
    let other = of(&short.replace("mu = 0.2", "mu = 0.21"));
    let foreign = other.into_part([2, 3], &options(&at("other"), 0..0), &never(), &mut |_| ());
    refused(&[&parts[0], &parts[1], &foreign.unwrap().unwrap()], "it is of another case");
    let mut bytes = fs::read(&parts[2]).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(at("bad.bin"), &bytes).unwrap();
    refused(&[&parts[0], &parts[1], &at("bad.bin")], "truncated or altered");
    fs::write(at("none.bin"), "title").unwrap();
    refused(&[&parts[0], &parts[1], &at("none.bin")], "no part of an ensemble");
}

#[test]
fn an_ensemble_does_not_go_on_from_a_run() {
    let folder = tempfile::tempdir().unwrap();
    let ensemble = of(SLAB);
    std::fs::write(folder.path().join("summary.json"), "of a run").unwrap();
    let resume = Options { resume: true, ..options(folder.path(), 0..2) };
    let refused = ensemble.into_folder(&resume, &never(), &mut |_| ()).unwrap_err().to_string();
    assert!(
        refused.contains("the files of a run") && folder.path().join("summary.json").exists(),
        "{refused}"
    );
    ensemble.into_folder(&options(folder.path(), 0..2), &never(), &mut |_| ()).unwrap();
    assert!(folder.path().join("previous/summary.json").exists());
}

#[test]
fn an_interrupted_ensemble_goes_on_and_ends_with_the_same_bits() {
    let short = SLAB.replace("members = 200", "members = 20");
    let ensemble = of(&short);
    let folder = tempfile::tempdir().unwrap();
    let stop = never();
    let done = ensemble.into_folder(&options(folder.path(), 0..20), &stop, &mut |progress| {
        stop.store(progress.done >= 7, Ordering::Relaxed);
    });
    let done = done.unwrap();
    assert!(done.missing > 0 && done.missing <= 13 && done.files.is_empty(), "{}", done.missing);
    drop(done);
    let mut first = None;
    let done = ensemble.into_folder(&options(folder.path(), 0..20), &never(), &mut |progress| {
        first.get_or_insert(progress.done);
    });
    assert!(first.unwrap() >= 7, "what was done is not done again");
    same(&ensemble, &done.unwrap().reduced, &computed(&ensemble, 0..20, 1));
    // Of another case nothing is taken: its files are moved aside, or, where it should go on, it is refused.
    let other = of(&short.replace("seed = 3", "seed = 4"));
    let resume = Options { resume: true, ..options(folder.path(), 0..20) };
    let message = other.into_folder(&resume, &never(), &mut |_| ()).unwrap_err().to_string();
    assert!(message.contains("another case"), "{message}");
    let done = other.into_folder(&options(folder.path(), 0..20), &never(), &mut |_| ()).unwrap();
    same(&other, &done.reduced, &computed(&other, 0..20, 2));
    assert!(folder.path().join("previous/members.csv").exists());
}

/// A published scheme takes no longer step than its own.
const FRAGILE: &str = r#"
[grid]
x = { from = -6.0, to = 6.0, cells = 120 }
[material]
epsilon = 0.4
friction.coulomb = { mu = 0.3 }
[initial]
thickness.steps = { at = [-1.0, 1.0], values = [0.3, 2.3, 0.3] }
[scheme]
name = "verfahren_1"
step = 0.001
[time]
end = 0.5
[output]
files = ["netcdf"]
[ensemble]
sampling = "grid"
vary."scheme.step" = { choice = [0.001, 0.2, 0.002] }
vary."material.friction.coulomb.mu" = { uniform = [0.2, 0.3], levels = 2 }
"#;

#[test]
fn a_member_that_fails_is_booked_and_the_rest_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let ensemble = of(FRAGILE);
    let done = ensemble.into_folder(&options(folder.path(), 0..6), &never(), &mut |_| ()).unwrap();
    let failed: Vec<u32> = done.reduced.failures().map(|(number, _)| number).collect();
    assert_eq!(done.reduced.computed() as usize + failed.len(), 6);
    for number in &failed {
        assert!(ensemble.sample(*number).overrides.contains(&"scheme.step=0.2".to_owned()));
    }
    assert_eq!(failed.len(), 2);
    let table = fs::read_to_string(folder.path().join("members.csv")).unwrap();
    assert_eq!(
        table
            .lines()
            .filter(|line| line.contains(",failed,0.2") || line.contains(",failed,") && line.contains("0.2,"))
            .count(),
        2,
        "{table}"
    );
    let json: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("ensemble.json")).unwrap()).unwrap();
    assert_eq!((&json["computed"], &json["failed"]), (&4.into(), &2.into()));
    assert!(json["failures"][0]["failure"].as_str().unwrap().contains("step"), "{json}");
    // Failed members are no part of shares and means.
    let reached = &ensemble.maps(&done.reduced)[0];
    assert_eq!(reached.values.iter().copied().fold(0.0, f64::max), 4.0);
    let all = FRAGILE.replace("[0.001, 0.2, 0.002]", "[0.2, 0.3]");
    let outside = tempfile::tempdir().unwrap();
    let error = of(&all).into_folder(&options(outside.path(), 0..4), &never(), &mut |_| ()).unwrap_err();
    assert!(matches!(error, EnsembleError::AllFailed { count: 4, number: 0, .. }), "{error}");
    assert!(outside.path().join("members.csv").exists());
}

/// A plane of 30 by 20 cells of 10 m that falls towards the east, and two squares on it.
fn mountain(folder: &Path) -> String {
    let rows = (0..20).map(|_| (0..30).map(|i| format!("{}", 500 - 4 * i)).collect::<Vec<_>>().join(" "));
    let dem = format!(
        "ncols 30\nnrows 20\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n{}\n",
        rows.collect::<Vec<_>>().join("\n")
    );
    fs::write(folder.join("dem.asc"), dem).unwrap();
    fs::write(
        folder.join("steep.asc"),
        fs::read_to_string(folder.join("dem.asc")).unwrap().replace("500", "540"),
    )
    .unwrap();
    let square = |x: f64, y: f64, thickness: f64, ci95: f64| {
        let ring = format!(
            "[[{x},{y}],[{},{y}],[{},{}],[{x},{}],[{x},{y}]]",
            x + 30.0,
            x + 30.0,
            y + 30.0,
            y + 30.0
        );
        format!(
            "{{\"type\":\"Feature\",\"properties\":{{\"thickness\":{thickness},\"ci95\":{ci95}}},\
             \"geometry\":{{\"type\":\"Polygon\",\"coordinates\":[{ring}]}}}}"
        )
    };
    let file = |squares: &[String]| {
        format!("{{\"type\":\"FeatureCollection\",\"features\":[{}]}}", squares.join(","))
    };
    let [one, two] = [square(40.0, 40.0, 1.0, 0.2), square(40.0, 120.0, 2.0, 0.0)];
    fs::write(folder.join("both.geojson"), file(&[one.clone(), two])).unwrap();
    fs::write(folder.join("one.geojson"), file(&[one])).unwrap();
    "[terrain]\ndem = \"dem.asc\"\n[material]\ndensity = 200\nfriction.coulomb = { mu = 0.3 }\n\
     [[release]]\npolygons = \"both.geojson\"\nthickness = { attribute = \"thickness\" }\nmeasured = \"vertical\"\n\
     [time]\nsteps = 3\n[ensemble]\nmembers = 64\n"
        .to_owned()
}

fn on_mountain(folder: &Path, vary: &str) -> Ensemble {
    let path = folder.join("case.toml");
    fs::write(&path, mountain(folder) + vary).unwrap();
    Ensemble::of(&Case::read(&path).unwrap()).unwrap()
}

/// Volume at the start of each member.
fn volumes(ensemble: &Ensemble, folder: &Path) -> Vec<f64> {
    let members = ensemble.plan().members;
    let out = folder.join("out");
    let done = ensemble.into_folder(&options(&out, 0..members), &never(), &mut |_| ()).unwrap();
    assert_eq!(done.reduced.failures().next(), None);
    let table = fs::read_to_string(out.join("members.csv")).unwrap();
    let column = table.lines().next().unwrap().split(',').position(|name| name == "mass_initial").unwrap();
    // (no field of these cases has a comma before that column but choices, which stand in quotes without commas)
    table.lines().skip(1).map(|line| line.split(',').nth(column).unwrap().parse().unwrap()).collect()
}

#[test]
fn each_feature_has_a_thickness_of_its_own_by_its_interval() {
    let folder = tempfile::tempdir().unwrap();
    let ensemble = on_mountain(folder.path(), "vary.\"release.0.thickness\" = { ci95 = \"ci95\" }\n");
    let names: Vec<String> = ensemble.plan().columns().into_iter().map(|column| column.name).collect();
    assert_eq!(names, ["release.0.thickness.0", "release.0.thickness.1"]);
    let drawn: Vec<[f64; 2]> = (0..64)
        .map(|number| ensemble.sample(number).values.iter().map(|v| v.value()).collect::<Vec<_>>())
        .map(|values| [values[0], values[1]])
        .collect();
    assert!(drawn.iter().all(|[_, second]| *second == 2.0), "an interval of no width");
    let mean = drawn.iter().map(|[first, _]| first).sum::<f64>() / 64.0;
    let within = drawn.iter().filter(|[first, _]| (first - 1.0).abs() < 0.2).count();
    assert!((mean - 1.0).abs() < 0.01 && (59..=63).contains(&within), "{mean} {within}");
    for (volume, [first, second]) in volumes(&ensemble, folder.path()).iter().zip(&drawn) {
        assert!((volume / (900.0 * (first + second)) - 1.0).abs() < 1e-6, "{volume} {first} {second}");
    }
}

#[test]
fn attributes_take_a_factor_and_files_are_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let vary = "vary.\"release.0.thickness\" = { factor = { uniform = [0.5, 1.5] } }\n\
                vary.\"release.0.polygons\" = { choice = [\"both.geojson\", \"one.geojson\"] }\n\
                vary.\"terrain.dem\" = { choice = [\"dem.asc\", \"steep.asc\"] }\nexceed.peak_pressure = [0.01]\n";
    let ensemble = on_mountain(folder.path(), vary);
    let found = volumes(&ensemble, folder.path());
    let (mut both, mut steep) = (0, 0);
    for (number, volume) in found.iter().enumerate() {
        let values: Vec<f64> = ensemble.sample(number as u32).values.iter().map(|v| v.value()).collect();
        let [polygons, factor, dem] = values[..] else { panic!("{values:?}") };
        let whole = if polygons == 0.0 { 2700.0 } else { 900.0 };
        assert!((volume / (whole * factor) - 1.0).abs() < 1e-6, "{volume} {values:?}");
        both += usize::from(polygons == 0.0);
        steep += usize::from(dem == 1.0);
    }
    assert_eq!((both, steep), (32, 32));
    for name in ["exceedance_peak_pressure_0_01", "count", "max_peak_thickness"] {
        let raster = folder.path().join(format!("out/rasters/{name}.tif"));
        assert!(raster.exists() && raster.with_extension("qml").exists(), "{name}");
    }
    assert!(folder.path().join("out/report.html").exists());
    // A file that a member could choose and that is not there, or other cells: said before, or booked.
    let absent = mountain(folder.path()) + "vary.\"release.0.polygons\" = { choice = [\"none.geojson\"] }\n";
    fs::write(folder.path().join("absent.toml"), absent).unwrap();
    let error = Case::read(folder.path().join("absent.toml")).unwrap().check().unwrap_err();
    assert!(error.to_string().contains("none.geojson") && error.key().contains("vary"), "{error}");
    let coarse =
        fs::read_to_string(folder.path().join("dem.asc")).unwrap().replace("cellsize 10", "cellsize 20");
    fs::write(folder.path().join("coarse.asc"), coarse).unwrap();
    let text =
        mountain(folder.path()) + "vary.\"terrain.dem\" = { choice = [\"dem.asc\", \"coarse.asc\"] }\n";
    let path = folder.path().join("coarse.toml");
    fs::write(&path, text.replace("members = 64", "members = 2")).unwrap();
    let ensemble = Ensemble::of(&Case::read(&path).unwrap()).unwrap();
    let reduced = computed(&ensemble, 0..2, 1);
    assert_eq!(reduced.computed(), 1);
    assert!(reduced.failures().next().unwrap().1.contains("same place, size"));
}
