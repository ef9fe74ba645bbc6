//! A run without a disk: what it is made of is in memory, and so is what it leaves, with the bits of files.

use granflow::output::netcdf::Values;
use granflow::raster::Raster;
use granflow::results::Numbers;
use granflow::session::Options;
use granflow::sinks::Kept;
use granflow::{Case, Inputs};
use netcdf_reader::NcFile;
use std::path::Path;
use std::sync::atomic::AtomicBool;

const CASE: &str = r#"
title = "A mountain"
terrain = { dem = "DEM", crs = "EPSG:31287" }
material = { density = 200.0, friction.coulomb.mu = { raster = "MU" } }
release = [{ polygons = "AREA", thickness = 1.0 }]
time.end = 8.0
output = { every = 2.0, files = ["netcdf"], durations = { thickness = 0.5 } }
gauge = [{ name = "road", at = [205.0, 105.0] }]
"#;
const AREA: &str = r#"{"type":"Polygon","coordinates":[[[40,60],[110,60],[110,140],[40,140],[40,60]]]}"#;

fn raster(value: impl Fn(f64, f64) -> f64) -> Raster {
    let (columns, rows, cell) = (40, 20, 10.0);
    let centre = |k: usize| (k as f64 + 0.5) * cell;
    let values = (0..columns * rows).map(|k| value(centre(k % columns), centre(k / columns))).collect();
    Raster { columns, rows, west: 0.0, south: 0.0, cell, values, crs: None }
}

fn bed() -> Raster {
    raster(|x, y| if x > 380.0 { f64::NAN } else { 300.0 - 0.7 * x + 1e-3 * (y - 100.0).powi(2) })
}

fn friction() -> Raster {
    raster(|x, _| if x < 200.0 { 0.25 } else { 0.5 })
}

/// As an ESRI ASCII grid, every bit of its values.
fn grid(raster: &Raster) -> String {
    let row = |row: usize| {
        let values = (0..raster.columns).map(|column| raster.at(column, row));
        let words =
            values.map(|value| if value.is_nan() { "-9999".to_owned() } else { format!("{value:?}") });
        words.collect::<Vec<_>>().join(" ") + "\n"
    };
    let head = "ncols 40\nnrows 20\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n";
    head.to_owned() + &(0..raster.rows).rev().map(row).collect::<String>()
}

fn named(dem: &str, mu: &str, area: &str) -> String {
    CASE.replace("DEM", dem).replace("MU", mu).replace("AREA", area)
}

fn in_memory() -> Kept {
    let inputs = Inputs::default()
        .with_raster("<dem>", bed())
        .with_raster("<mu>", friction())
        .with_file("<area>", AREA.as_bytes());
    let case = Case::parse(&named("<dem>", "<mu>", "<area>"), "<text>").unwrap();
    case.check_with(&inputs).unwrap().compute_in_memory(2, &AtomicBool::new(false), &mut |_| ()).unwrap()
}

fn on_disk(folder: &Path) -> NcFile {
    for (name, text) in [
        ("dem.asc", grid(&bed())),
        ("mu.asc", grid(&friction())),
        ("area.geojson", AREA.to_owned()),
        ("case.toml", named("dem.asc", "mu.asc", "area.geojson")),
    ] {
        std::fs::write(folder.join(name), text).unwrap();
    }
    let case = Case::read(folder.join("case.toml")).unwrap().check().unwrap();
    let (directory, command) = (folder.join("out"), "test".to_owned());
    let options = Options { directory, threads: 1, resume: false, command, notice: &|_| () };
    case.compute(&options, &AtomicBool::new(false), &mut |_| ()).unwrap();
    NcFile::open(folder.join("out/result.nc")).unwrap()
}

#[test]
fn what_is_kept_is_what_result_nc_holds() {
    let folder = tempfile::tempdir().unwrap();
    let (kept, file) = (in_memory(), on_disk(folder.path()));
    let dataset = kept.dataset("test").unwrap();
    let mut names: Vec<_> = dataset.variables.iter().map(|variable| variable.name.clone()).collect();
    names.extend(dataset.axes.iter().map(|axis| axis.name.clone()));
    for variable in file.variables().unwrap().iter().filter(|variable| variable.name != "crs") {
        assert!(names.contains(&variable.name), "{} is not kept", variable.name);
    }
    for variable in &dataset.variables {
        let name = &variable.name;
        let theirs: Vec<f64> = file.read_variable_as_f64(name).unwrap().iter().copied().collect();
        let series = |name: &str| &kept.series.iter().find(|(own, _)| own == name).unwrap().1;
        let (ours, timed): (Vec<f64>, bool) = match &variable.values {
            Values::Stored(name) => match series(name) {
                Numbers::F32(values) => (values.iter().map(|value| f64::from(*value)).collect(), true),
                Numbers::F64(values) => (values.clone(), true),
            },
            Values::Static(values) => {
                (variable.precision.decode(&encoded(variable.precision, values)), false)
            }
            Values::Series(_) => unreachable!("a run from a case has none"),
        };
        let length = if timed { ours.len() / dataset.axes[0].values.len() } else { ours.len() };
        let mask = dataset.mask(variable, length);
        for (k, (ours, theirs)) in ours.iter().zip(&theirs).enumerate() {
            let nothing = mask.is_some_and(|mask| mask[k % length].is_nan()) || ours.is_nan();
            assert!(if nothing { theirs.is_nan() } else { ours.to_bits() == theirs.to_bits() }, "{name} {k}");
        }
        assert_eq!(ours.len(), theirs.len(), "{name}");
    }
    assert!(names.iter().any(|name| name == "gauge_thickness"));
    assert!(kept.summary.extra("duration_thickness_threshold").is_some());
}

fn encoded(precision: granflow::output::Precision, values: &[f64]) -> Vec<u8> {
    let mut bytes = Vec::new();
    precision.encode(values, &mut bytes);
    bytes
}

#[test]
fn a_name_in_memory_is_held_to_what_a_file_is() {
    let refused = |inputs: Inputs, part: &str| {
        let case = Case::parse(&named("<dem>", "<mu>", "<area>"), "<text>").unwrap();
        let text = match case.check_with(&inputs) {
            Err(error) => error.to_string(),
            Ok(checked) => match checked.start() {
                Err(error) => error.to_string(),
                Ok(_) => panic!("it started, without {part:?}"),
            },
        };
        assert!(text.contains(part), "{text}");
    };
    let all = || {
        Inputs::default()
            .with_raster("<dem>", bed())
            .with_raster("<mu>", friction())
            .with_file("<area>", AREA.as_bytes())
    };
    refused(Inputs::default(), "cannot read <mu>");
    refused(all().with_file("<area>", &b"{}"[..]), "<area>");
    refused(all().with_raster("<mu>", raster(|_, _| -0.5)), "<mu>: found -0.5 at");
    let west = Raster { west: 5000.0, ..friction() };
    refused(all().with_raster("<mu>", west), "no value for any cell");
    let other = granflow::raster::Crs { epsg: Some(32632), wkt: None };
    refused(all().with_raster("<dem>", Raster { crs: Some(other), ..bed() }), "EPSG:32632");
}
