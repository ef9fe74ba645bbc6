//! `granflow compare`: a run with itself, with what it wrote, with shifted outlines, with another run, and what is refused.

use std::fmt::Write;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// A block of 1 m on a level floor with friction so large that nothing moves: its footprint is known.
const CASE: &str = r#"title = "block"
[terrain]
dem = "dem.asc"
crs = "EPSG:31287"
[material]
density = 200.0
friction.coulomb = { mu = 5.0 }
[[release]]
polygons = "block.geojson"
thickness = 1.0
[time]
steps = 1
[output]
files = ["netcdf", "vector", "geotiff"]
precision = "f64"
"#;

fn granflow(folder: &Path, arguments: &[&str]) -> Output {
    let mut program = Command::new(env!("CARGO_BIN_EXE_granflow"));
    program.current_dir(folder).args(arguments).output().expect("the program runs")
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

/// A box as GeoJSON, with a system or without.
fn polygon([west, east]: [f64; 2], [south, north]: [f64; 2], system: Option<u32>) -> String {
    let crs = system.map_or(String::new(), |code| {
        format!(r#""crs":{{"type":"name","properties":{{"name":"urn:ogc:def:crs:EPSG::{code}"}}}},"#)
    });
    format!(
        r#"{{"type":"FeatureCollection",{crs}"features":[{{"type":"Feature","properties":{{}},"geometry":{{"type":"Polygon",
        "coordinates":[[[{west},{south}],[{east},{south}],[{east},{north}],[{west},{north}],[{west},{south}]]]}}}}]}}"#
    )
}

/// A plane of 60 x 40 cells of 5 m that rises by `slope` to the west, and the block on [100, 150] x [80, 120]; the run is in
/// `run/`.
fn block(slope: f64) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let mut grid = String::from("ncols 60\nnrows 40\nxllcorner 0\nyllcorner 0\ncellsize 5\n");
    for _ in 0..40 {
        (0..60).for_each(|column| {
            write!(grid, "{} ", 1000.0 - slope * 5.0 * f64::from(column)).expect("a text")
        });
        grid.push('\n');
    }
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("a file");
    write("dem.asc", &grid);
    write("block.geojson", &polygon([100.0, 150.0], [80.0, 120.0], None));
    write("case.toml", CASE);
    let output = granflow(folder.path(), &["run", "case.toml", "--out", "run", "--quiet"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    folder
}

/// compare.json of a comparison that must succeed, and what was said.
fn compared(folder: &Path, arguments: &[&str]) -> (Value, String) {
    let output = granflow(folder, &[&["compare"], arguments].concat());
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let out = arguments.iter().position(|word| *word == "--out").map_or("compare", |k| arguments[k + 1]);
    let figure = std::fs::read(folder.join(out).join("compare.png")).expect("a figure");
    assert!(figure.starts_with(b"\x89PNG") && figure.len() > 3000);
    let text = std::fs::read_to_string(folder.join(out).join("compare.json")).expect("numbers");
    (serde_json::from_str(&text).expect("JSON"), said(&output))
}

fn refused(folder: &Path, status: i32, arguments: &[&str], parts: &[&str]) {
    let output = granflow(folder, &[&["compare"], arguments].concat());
    let text = said(&output);
    assert_eq!(output.status.code(), Some(status), "{text}");
    assert!(parts.iter().all(|part| text.contains(part)), "{text}");
    assert!(!folder.join("compare").exists(), "nothing is written");
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} in {value}"))
}

const DIFFERENCES: [&str; 5] = [
    "runout_difference",
    "volume_difference",
    "centroid_distance",
    "peak_thickness_difference",
    "peak_speed_difference",
];

#[test]
fn a_run_with_itself_is_one_and_all_differences_are_zero() {
    let folder = block(0.3);
    for by in ["footprint", "deposit"] {
        let (found, _) = compared(folder.path(), &["run", "run/result.nc", "--by", by]);
        assert_eq!(found["csi"], 1.0);
        assert_eq!((number(&found, "miss_area"), number(&found, "false_area")), (0.0, 0.0));
        assert_eq!(number(&found, "hit_area"), 50.0 * 40.0);
        for key in DIFFERENCES {
            assert_eq!(number(&found, key), 0.0, "{key}");
        }
        assert_eq!(found["by"], by);
    }
}

#[test]
fn a_shifted_outline_has_the_analytic_values() {
    let folder = block(0.3);
    // By 12.5 m of 50 m along x, which is half a cell off, and by 4 m of 40 m along y.
    let text = polygon([112.5, 162.5], [84.0, 124.0], Some(31287));
    std::fs::write(folder.path().join("mapped.geojson"), text).expect("a file");
    let (found, _) = compared(folder.path(), &["run", "mapped.geojson"]);
    let hit = 37.5 * 36.0;
    let near = |key: &str, value: f64| {
        assert!((number(&found, key) - value).abs() < 1e-6 * value.abs().max(1.0), "{key}: {found}");
    };
    near("hit_area", hit);
    near("miss_area", 2000.0 - hit);
    near("false_area", 2000.0 - hit);
    near("csi", hit / (4000.0 - hit));
    // The path runs down to the east: the outline is farther by 12.5 m along x, and by at most 13.2 m in any direction.
    let farther = -number(&found, "runout_difference");
    assert!((5.0..13.2).contains(&farther), "{found}");
    near("centroid_distance", 12.5_f64.hypot(4.0));
    assert_eq!(found["centroid_of"], "area");
    assert!(found["volume_difference"].is_null() && found["peak_speed_difference"].is_null());
    let (turned, _) = compared(folder.path(), &["mapped.geojson", "run"]);
    assert_eq!(turned["csi"], found["csi"]);
    assert!((number(&turned, "runout_difference") - farther).abs() < 1e-6);
}

#[test]
fn a_run_is_its_own_raster_and_outline() {
    let folder = block(0.3);
    let (found, _) = compared(folder.path(), &["run", "run/rasters/deposit.tif", "--by", "deposit"]);
    assert_eq!(found["csi"], 1.0);
    assert!(
        number(&found, "volume_difference").abs() < 1e-6 * 2000.0
            && number(&found, "centroid_distance") < 1e-6
    );
    // A layer of 1 m normal to a slope of 0.3: 2000 m2 of the map are 2000 sqrt(1.09) m2 of the bed.
    let volume = number(&found["a"], "volume");
    assert!(
        (volume / (2000.0 * 1.09_f64.sqrt()) - 1.0).abs() < 1e-7,
        "maps are in single precision: {volume}"
    );
    let vertical = ["run", "run/rasters/deposit.tif", "--by", "deposit", "--measured", "vertical"];
    let (found, _) = compared(folder.path(), &vertical);
    assert!((number(&found["b"], "volume") - 2000.0).abs() < 1e-3);
    let (found, said) = compared(folder.path(), &["run", "run/outlines.geojson"]);
    assert!(said.contains("that of peak_thickness was taken"), "{said}");
    assert!(number(&found, "csi") > 0.9 && number(&found, "runout_difference").abs() < 5.0);
}

#[test]
fn grids_that_differ_are_cut_with_each_other() {
    let folder = block(0.3);
    let output = granflow(
        folder.path(),
        &["run", "case.toml", "--out", "coarse", "--quiet", "--set", "terrain.cell=10.0"],
    );
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let (found, said) = compared(folder.path(), &["run", "coarse"]);
    assert_eq!(found["csi"], 1.0, "both are [100, 150] x [80, 120] on their own cells");
    assert!(said.contains("cells of 5 and of 10: they were cut with each other"), "{said}");
}

/// A block of thickness 1 on [from, from + 2] x [-1, 1] of a level chute that does not move.
fn chute_block(folder: &Path, from: f64, out: &str) {
    let case = format!(
        r#"[grid]
x = {{ from = 0.0, to = 10.0, cells = 40 }}
y = {{ from = -2.0, to = 2.0, cells = 20 }}
[material]
epsilon = 1.0
friction.coulomb = {{ mu = 50.0 }}
[initial]
thickness.formula = "if(x > {from}, if(x < {from} + 2, if(abs(y) < 1, 1, 0), 0), 0)"
[time]
steps = 1
[output]
files = ["netcdf"]
"#
    );
    std::fs::write(folder.join("chute.toml"), case).expect("a file");
    let output = granflow(folder, &["run", "chute.toml", "--out", out, "--quiet"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
}

#[test]
fn blocks_on_a_chute_have_all_differences_as_they_follow_from_their_shift() {
    let folder = tempfile::tempdir().expect("a folder");
    chute_block(folder.path(), 2.0, "here");
    chute_block(folder.path(), 2.5, "farther");
    let text = polygon([2.6, 4.6], [-1.0, 1.0], None);
    std::fs::write(folder.path().join("mapped.geojson"), text).expect("a file");
    for (other, shift, volume) in [("farther", 0.5, Some(0.0)), ("mapped.geojson", 0.6, None)] {
        let (found, _) = compared(folder.path(), &["here", other]);
        let near =
            |key: &str, value: f64| assert!((number(&found, key) - value).abs() < 1e-9, "{key}: {found}");
        near("hit_area", 2.0 * (2.0 - shift));
        near("miss_area", 2.0 * shift);
        near("false_area", 2.0 * shift);
        near("csi", (2.0 - shift) / (2.0 + shift));
        near("runout_difference", -shift);
        near("centroid_distance", shift);
        assert_eq!(found["volume_difference"].as_f64(), volume);
    }
}

#[test]
fn chutes_are_compared_in_one_and_two_dimensions() {
    let folder = tempfile::tempdir().expect("a folder");
    for kind in ["silo", "plane"] {
        let text = granflow(folder.path(), &["new", kind]);
        assert_eq!(text.status.code(), Some(0), "{}", said(&text));
        let case = format!("{kind}.toml");
        for (out, end) in [("short", "time.end=0.5"), ("long", "time.end=1.0")] {
            let set =
                ["run", &case, "--out", out, "--quiet", "--set", end, "--set", "output.files=[\"netcdf\"]"];
            let output = granflow(folder.path(), &set);
            assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        }
        let (found, _) = compared(folder.path(), &["short", "short", "--threshold", "0.01"]);
        assert_eq!((&found["csi"], number(&found, "runout_difference")), (&1.0.into(), 0.0));
        let thick = if kind == "silo" { "1.0" } else { "0.01" };
        let (found, _) = compared(folder.path(), &["short", "long", "--threshold", thick]);
        assert_eq!(number(&found, "false_area"), 0.0, "a footprint only grows");
        assert!(number(&found, "runout_difference") < 0.0 && number(&found, "csi") < 1.0, "{found}");
        for name in ["short", "long"] {
            std::fs::remove_dir_all(folder.path().join(name)).expect("a folder");
        }
    }
}

#[test]
fn what_cannot_be_compared_is_refused_with_the_cure() {
    let folder = block(0.0);
    let path = folder.path();
    let write = |name: &str, text: &str| std::fs::write(path.join(name), text).expect("a file");
    write("other.geojson", &polygon([0.0, 10.0], [0.0, 10.0], Some(32632)));
    refused(path, 4, &["run", "other.geojson"], &["EPSG:32632", "EPSG:31287", "ogr2ogr -t_srs EPSG:31287"]);
    write("text.geojson", "[1, 2]");
    refused(
        path,
        4,
        &["run", "text.geojson"],
        &["text.geojson", "no result of a run, no raster and no outline"],
    );
    refused(path, 4, &["run", "nothing.tif"], &["nothing.tif", "cannot read"]);
    refused(path, 4, &["nowhere.nc", "run"], &["nowhere.nc", "granflow run CASE.toml"]);
    refused(path, 2, &["run", "run", "--threshold", "0.001"], &["--threshold 0.01", "output.threshold"]);
    refused(path, 2, &["run", "run", "--threshold", "50"], &["thicker than 50", "smaller --threshold"]);
    refused(path, 2, &["run", "run", "--threshold", "-1"], &["--threshold -1", "from 0 on"]);
    // A difference of elevation models: what was taken up counts as bare.
    write("change.asc", "ncols 2\nnrows 2\nxllcorner 100\nyllcorner 80\ncellsize 5\n1 1\n1 -2\n");
    let (_, said) = compared(path, &["run", "change.asc", "--out", "fine"]);
    assert!(said.contains("1 cells are below 0, 50.0 m3"), "{said}");
    assert!(said.contains("says no coordinate system"), "{said}");
    for case in ["silo", "sandpile_1d"] {
        granflow(path, &["new", case]);
        let case = format!("{case}.toml");
        let run = ["run", &case, "--quiet", "--set", "time={steps=2}", "--set", "output.files=[\"netcdf\"]"];
        let output = granflow(path, &run);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    }
    refused(path, 2, &["silo", "run"], &["one is in one dimension"]);
    refused(
        path,
        2,
        &["silo", "change.asc"],
        &["a run in one dimension is compared with another such run only"],
    );
    refused(path, 2, &["sandpile_1d", "silo"], &["it has no map `peak_thickness`"]);
}

#[test]
fn what_lies_beyond_the_cells_of_a_run_is_missed_and_said() {
    let folder = block(0.3);
    let text = polygon([100.0, 350.0], [80.0, 120.0], Some(31287));
    std::fs::write(folder.path().join("far.geojson"), text).expect("a file");
    let (found, said) = compared(folder.path(), &["run", "far.geojson"]);
    assert!(
        said.contains("20.00 % of the area of far.geojson lies where run/result.nc has no cells"),
        "{said}"
    );
    assert!((number(&found, "csi") - 0.2).abs() < 1e-9, "{found}");
}
