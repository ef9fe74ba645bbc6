//! A layer that a flow picks up, and a forest that breaks under it.

use super::valley::{
    CELL, FIRST, field, map, number, start, steps, thickness, try_start, valley, write_grid,
};
use granflow::run::{Ends, Run, Until, drive};
use std::fs;
use std::path::Path;

/// A plane of slope 0.5 that falls along x, and a slab on all of it but the margin.
fn plane(cells: [usize; 2]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    write_grid(&folder.path().join("dem.asc"), cells, |x, _| 500.0 - 0.5 * x);
    write_grid(&folder.path().join("slab.asc"), cells, |_, _| 1.0);
    folder
}

const SLAB: &str = "[[release]]\nraster = \"slab.asc\"\n";

/// Rates of erosion by a constant speed of the bed: h' = r e, (h u)' = h a with a = g sin z (1 - mu/tan z) along the bed, so that
/// h = h0 + r e t and u = a (h0 t + r e t^2/2)/h.
#[test]
fn a_slab_that_takes_up_a_layer_at_a_constant_rate_has_its_exact_speed() {
    let folder = plane([120, 9]);
    let (rate, ratio, time): (f64, f64, f64) = (0.2, 0.5, 2.0);
    let layer = format!(
        "[entrainment]\nlayer = 5.0\ndensity = {}\nlaw.shear = {{ threshold = 0.0, depth_by_stress = 1.0, rate = {rate} }}\n",
        200.0 * ratio
    );
    let slope = 0.5_f64.atan();
    let pull = 9.81 * (slope.sin() - 0.3 * slope.cos());
    let grows = rate * ratio;
    let depth = 1.0 + grows * time;
    let exact = [depth, pull * (time + 0.5 * grows * time * time) / depth];
    for scheme in ["energy_stable", "energy_stable_2"] {
        let errors = [0.02, 0.01, 0.005].map(|step| {
            let parts = format!("{SLAB}{layer}[scheme]\nname = \"{scheme}\"\nstep = {step}\n");
            let mut run = start(folder.path(), &parts, &format!("end = {time}"));
            run.until(time).unwrap();
            // In the middle, which nothing from the edges has reached.
            let at = |name: &str| run.field(name).unwrap().iter().nth(4 * 120 + 60).unwrap();
            [at("thickness"), at("speed")]
                .iter()
                .zip(exact)
                .map(|(found, exact)| found / exact - 1.0)
                .collect()
        });
        let errors: [Vec<f64>; 3] = errors;
        for [thickness, speed] in errors.iter().map(|error| [error[0], error[1]]) {
            // A bed keeps its cosine in single precision.
            assert!(thickness.abs() < 1e-7, "{scheme}: thickness {thickness:e}");
            assert!(speed.abs() < 2e-3, "{scheme}: speed {speed:e}");
        }
        // First order in the step, as what is picked up in it is at its end.
        for pair in errors.windows(2) {
            let order = (pair[0][1] / pair[1][1]).log2();
            assert!((order - 1.0).abs() < 0.1, "{scheme}: order {order}, {errors:?}");
        }
    }
}

fn rest(run: &mut dyn Run) {
    let until = Some(Until::Rest { speed: None, trickle: Some(0.01) });
    let ends = Ends { steps: None, time: Some(400.0), until, kinetic_energy: None };
    drive(run, &ends, &mut []).unwrap();
}

const LAWS: [&str; 4] = [
    "law.speed = { coefficient = 0.01 }",
    "law.shear = { threshold = 500.0, depth_by_stress = 1e-4, rate = 0.025 }",
    "law.energy = { specific = 5000.0 }",
    "law = \"plough\"",
];

#[test]
fn what_is_picked_up_is_what_the_layer_lost_and_never_more_than_there_was() {
    let folder = valley();
    for law in LAWS {
        for more in ["", "lower_bed = true\n", "density = 150.0\n"] {
            let parts = format!("{FIRST}[entrainment]\nlayer = 0.4\n{law}\n{more}");
            let mut run = start(folder.path(), &parts, "until = \"rest\"\nend = 400.0");
            rest(&mut *run);
            assert!(run.at_rest() || run.time() < 400.0, "{law}: still moves");
            let eroded = map(&mut *run, "eroded_depth");
            let most = eroded.iter().copied().fold(0.0, f64::max);
            assert!(most > 0.0 && most <= 0.4, "{law} {more}: {most}");
            if law.contains("plough") {
                assert!(
                    eroded.iter().filter(|depth| **depth == 0.4).count() > 100,
                    "the front leaves nothing"
                );
            }
            let (totals, record) = (run.totals(), *run.record());
            let came = totals.volume + run.stepper().outflow().iter().sum::<f64>() - record.initial;
            let mass = number(&*run, "eroded_mass").unwrap();
            let error = came * 200.0 / mass - 1.0;
            assert!(error.abs() < 1e-12, "{law} {more}: {error:e}");
        }
    }
}

#[test]
fn the_bed_sinks_by_what_was_taken() {
    let folder = valley();
    let parts = format!(
        "{FIRST}[entrainment]\nlayer = 0.4\nlower_bed = true\nlaw.speed = {{ coefficient = 0.01 }}\n"
    );
    let mut run = start(folder.path(), &parts, "end = 6.0");
    let bed = |run: &dyn Run| run.place().domain.elevation().unwrap().to_vec();
    let before = bed(&*run);
    steps(&mut *run, 60);
    let (after, eroded) = (bed(&*run), map(&mut *run, "eroded_depth"));
    let mut lowered = 0;
    for ((before, after), depth) in before.iter().zip(&after).zip(&eroded) {
        if depth.is_nan() {
            assert_eq!(before.to_bits(), after.to_bits());
        } else {
            // Normal to a bed of slope up to 0.7.
            let fall = before - after;
            assert!(fall >= *depth && fall < 1.3 * depth + 1e-9, "{fall} {depth}");
            lowered += 1;
        }
    }
    assert!(lowered > 100, "{lowered}");
}

/// Steps of a run taken up half-way end with the bits of one that went through.
fn resumes(folder: &Path, parts: &str) {
    let mut whole = start(folder, parts, "end = 60.0");
    steps(&mut *whole, 50);
    let mut part = start(folder, parts, "end = 60.0");
    // One that has gone further takes the state up as well as one that has just begun.
    steps(&mut *part, 80);
    part.restore(whole.save().into_owned()).unwrap();
    steps(&mut *whole, 60);
    steps(&mut *part, 60);
    for name in ["thickness", "velocity_x", "velocity_y", "surface"] {
        assert_eq!(field(&*whole, name), field(&*part, name), "{parts}: {name}");
    }
    let maps = |run: &mut dyn Run| -> Vec<u64> {
        run.maps().iter().flat_map(|(_, values)| values.iter().map(|value| value.to_bits())).collect()
    };
    assert_eq!(maps(&mut *whole), maps(&mut *part), "{parts}");
}

#[test]
fn what_was_taken_and_broken_is_kept_by_a_checkpoint() {
    let folder = valley();
    for law in LAWS {
        resumes(folder.path(), &format!("{FIRST}[entrainment]\nlayer = 0.4\nlower_bed = true\n{law}\n"));
    }
    let forest = format!("forest = 0.05\nforest_breaks_at = 20.0\n{FIRST}");
    resumes(folder.path(), &forest);
    resumes(folder.path(), &format!("{forest}[entrainment]\nlayer = 0.4\nlaw = \"plough\"\n"));
}

#[test]
fn a_layer_of_no_depth_changes_no_bit_and_threads_do_not_either() {
    let folder = valley();
    let run = |parts: &str, threads: usize| {
        let mut run = start(folder.path(), parts, "end = 60.0");
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| steps(&mut *run, 120));
        [thickness(&*run), field(&*run, "velocity_x")]
    };
    let without = run(FIRST, 2);
    for law in LAWS {
        assert_eq!(run(&format!("{FIRST}[entrainment]\nlayer = 0.0\n{law}\n"), 2), without, "{law}");
        let with = format!("{FIRST}[entrainment]\nlayer = 0.4\nlower_bed = true\n{law}\n");
        assert_eq!(run(&with, 1), run(&with, 3), "{law}");
        assert_ne!(run(&with, 1), without, "{law}");
    }
}

#[test]
fn a_layer_may_differ_from_place_to_place() {
    let folder = valley();
    let zone = r#"{"type":"Feature","properties":{"depth":0.3},"geometry":{"type":"Polygon",
        "coordinates":[[[100,0],[200,0],[200,120],[100,120],[100,0]]]}}"#;
    fs::write(folder.path().join("snow.geojson"), zone).unwrap();
    let parts = format!(
        "{FIRST}[entrainment]\nlayer = {{ polygons = \"snow.geojson\", attribute = \"depth\", elsewhere = 0.0 }}\nlaw = \"plough\"\n"
    );
    let mut run = start(folder.path(), &parts, "end = 60.0");
    steps(&mut *run, 200);
    for (cell, depth) in map(&mut *run, "eroded_depth").into_iter().enumerate() {
        let x = ((cell % 70) as f64 + 0.5) * CELL;
        assert!(depth.is_nan() || ((100.0..200.0).contains(&x) && depth <= 0.3), "{x}: {depth}");
    }
    assert!(number(&*run, "eroded_volume").unwrap() > 100.0);
}

#[test]
fn a_forest_breaks_where_the_pressure_exceeds_its_strength_and_only_there() {
    let folder = valley();
    let run = |forest: &str| {
        let mut run = start(folder.path(), &format!("{forest}{FIRST}"), "end = 60.0");
        steps(&mut *run, 250);
        run
    };
    // One that never breaks is one that stands.
    let standing = run("forest = 0.02\n");
    let strong = run("forest = 0.02\nforest_breaks_at = 1e6\n");
    assert_eq!(thickness(&*standing), thickness(&*strong));
    assert_eq!(number(&*strong, "forest_broken_area"), Some(0.0));
    let mut weak = run("forest = 0.02\nforest_breaks_at = 20.0\n");
    let broken = map(&mut *weak, "forest_broken");
    let speeds = weak.peaks().into_iter().find(|(name, _)| *name == "peak_speed").unwrap().1;
    let strength = (20e3_f64 / 200.0).sqrt();
    let mut count = 0;
    for (time, speed) in broken.iter().zip(&speeds) {
        // A pressure of a layer thinner than the threshold is in no map.
        let exceeded = *speed > strength * (1.0 + 1e-6);
        assert!(!exceeded || !time.is_nan(), "{speed} m/s did not break it");
        assert!(time.is_nan() || *speed > strength * (1.0 - 1e-6), "{speed} m/s broke it at {time}");
        count += usize::from(!time.is_nan());
    }
    assert!(count > 20, "{count}");
    assert_eq!(number(&*weak, "forest_broken_area"), Some(count as f64 * CELL * CELL));
    let farthest = |run: &dyn Run| {
        run.field("thickness")
            .unwrap()
            .iter()
            .enumerate()
            .filter(|(_, h)| *h > 0.01)
            .map(|(k, _)| k % 70)
            .max()
    };
    assert!(farthest(&*weak) > farthest(&*standing));
}

#[test]
fn what_cannot_be_picked_up_is_refused() {
    let folder = valley();
    for (parts, words) in [
        ("[entrainment]\nlayer = -0.1\nlaw = \"plough\"\n", "a number >= 0"),
        ("[entrainment]\nlayer = 1e30\nlaw = \"plough\"\n", "at most 1000 m"),
        ("[entrainment]\nlayer = 0.1\nlaw = \"plow\"\n", "plow"),
        ("[entrainment]\nlayer = 0.1\n", "law"),
        ("[entrainment]\nlayer = 0.1\nlaw.speed = { coefficient = 0.0 }\n", "a number > 0"),
        ("[entrainment]\nlayer = 0.1\ndensity = -5.0\nlaw = \"plough\"\n", "a number > 0"),
        ("[entrainment]\nlayer = { raster = \"none.tif\" }\nlaw = \"plough\"\n", "none.tif"),
    ] {
        let error =
            try_start(folder.path(), &format!("{FIRST}{parts}"), "end = 1.0").err().unwrap_or_default();
        assert!(error.contains(words), "{parts}: {error}");
    }
    let error = try_start(folder.path(), &format!("forest_breaks_at = 10.0\n{FIRST}"), "end = 1.0");
    assert!(error.err().unwrap_or_default().contains("no forest"));
}

/// A pile at rest loses nothing of its layer, whatever moves beside it.
#[test]
fn nothing_is_picked_up_under_what_stands() {
    let folder = tempfile::tempdir().unwrap();
    write_grid(&folder.path().join("dem.asc"), [90, 24], |_, _| 100.0);
    // One pile holds, its steepest slope being 0.24, and one collapses.
    let parts = "[[release]]\ncap = { height = 3.0, centre = [60.0, 60.0], radius = 25.0 }\n\
                 [[release]]\ncap = { height = 20.0, centre = [150.0, 60.0], radius = 20.0 }\n\
                 [entrainment]\nlayer = 0.5\nlaw.shear = { threshold = 0.0, depth_by_stress = 1.0, rate = 10.0 }\n";
    let mut run = start(folder.path(), parts, "end = 60.0");
    rest(&mut *run);
    let speeds = run.peaks().into_iter().find(|(name, _)| *name == "peak_speed").unwrap().1;
    let eroded = map(&mut *run, "eroded_depth");
    let mut stood = 0;
    for (cell, (speed, depth)) in speeds.iter().zip(&eroded).enumerate() {
        if cell % 90 < 18 {
            assert!(speed.is_nan() || *speed == 0.0, "the pile moves at {speed}");
            assert!(depth.is_nan(), "{depth} m at rest");
            stood += usize::from(*speed == 0.0);
        }
    }
    assert!(stood > 20, "{stood}");
    assert!(number(&*run, "eroded_volume").unwrap() > 100.0);
}
