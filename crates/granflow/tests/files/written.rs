//! What a run leaves: every kind of file opens and holds it.

use super::*;

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
    assert_eq!(report.matches("data:image/png;base64,").count(), 9);
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
    assert_eq!(figures.len(), 9);
    for figure in figures {
        let name = figure.path.file_name().unwrap();
        let first = fs::read(run.figures().join(name)).unwrap();
        // The table of the path over time does not hold the width of the strip, which the figure names.
        if !name.to_string_lossy().starts_with("range_time") {
            assert!(fs::read(&figure.path).unwrap() == first, "{name:?}");
        }
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
    granflow::file_kinds().iter().filter(|kind| names.contains(&kind.name)).copied().collect()
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
