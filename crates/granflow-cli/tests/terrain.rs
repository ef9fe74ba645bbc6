//! What the program says of a terrain and of the files around it.

mod support;

use std::fmt::Write;
use std::path::Path;
use std::process::Output;
use support::{granflow, said, told};

const CASE: &str = r#"title = "test"
[terrain]
dem = "dem.asc"
crs = "EPSG:26910+6360"
[material]
density = 200.0
friction.coulomb = { mu = 0.2 }
[[release]]
polygons = "release.geojson"
thickness = 1.0
[time]
steps = 2
[output]
files = []
"#;

const RELEASE: &str = r#"{"type":"Feature","properties":null,"geometry":
    {"type":"Polygon","coordinates":[[[20,20],[40,20],[40,40],[20,40],[20,20]]]}}"#;

/// A slope of 20 x 16 cells of 5 m, falling to the east, with other heights at some cells (column and row from the north-west).
fn written(folder: &Path, odd: &[([usize; 2], f64)]) {
    let mut grid = String::from("ncols 20\nnrows 16\nxllcorner 0\nyllcorner 0\ncellsize 5\n");
    for row in 0..16 {
        for column in 0..20 {
            let other = odd.iter().find(|(cell, _)| *cell == [column, row]);
            let height = other.map_or(5000.0 - 10.0 * column as f64, |(_, height)| *height);
            write!(grid, "{height} ").expect("a text");
        }
        grid.push('\n');
    }
    for (name, text) in [("dem.asc", grid.as_str()), ("release.geojson", RELEASE), ("case.toml", CASE)] {
        std::fs::write(folder.join(name), text).expect("a file");
    }
}

fn all(output: &Output) -> String {
    said(output) + &told(output)
}

#[test]
fn check_shows_systems_heights_steps_volume_and_what_was_converted() {
    let folder = tempfile::tempdir().expect("a folder");
    // A pit of 4 ft on a slope of 10 ft a cell: 24 ft below its western neighbour.
    written(folder.path(), &[([9, 6], 4900.0 - 4.0)]);
    let output = granflow(folder.path(), &["check", "case.toml"]);
    let text = all(&output);
    assert_eq!(output.status.code(), Some(0), "{text}");
    for line in [
        "terrain          20 x 16 cells of 5 m, 0 without elevation (0.0 %)",
        "EPSG:26910 (NAD83 / UTM zone 10N)",
        "1466.1 to 1524.0 m, largest step between cells 7.3 m at (45.0, 47.5)",
        "steep            0 cells above 60 deg (0.0 %), steepest 3",
        "release          release.geojson, no coordinate reference system, 46",
        "pits             1 cell holds up to 30 m3",
        "note             dem.asc: its unit of 0.30480060960121924 m was converted to metres",
        "note             release.geojson: it says no coordinate reference system; that of the terrain was taken",
    ] {
        assert!(text.contains(line), "{line}\n{text}");
    }
    assert!(!text.contains("warning"), "{text}");
}

#[test]
fn beside_each_raster_with_a_figure_stands_its_style_for_qgis() {
    let folder = tempfile::tempdir().expect("a folder");
    written(folder.path(), &[]);
    let set = "output.files=[\"geotiff\"]";
    let output = granflow(folder.path(), &["run", "case.toml", "--set", set, "--set", "time.steps=40"]);
    assert_eq!(output.status.code(), Some(0), "{}", told(&output));
    for name in ["peak_thickness", "deposit", "peak_speed", "peak_pressure", "arrival_time"] {
        let raster = folder.path().join(format!("case/rasters/{name}.tif"));
        let style = std::fs::read_to_string(raster.with_extension("qml")).expect("a style");
        assert!(raster.exists() && style.contains("type=\"singlebandpseudocolor\""), "{name}");
        // thicknesses begin at the threshold that is drawn, other maps where anything came
        let above =
            if matches!(name, "peak_thickness" | "deposit") { "max=\"0.01\"" } else { "max=\"-0.5\"" };
        assert!(style.contains(above), "{name}: {style}");
    }
}

#[test]
fn check_and_run_warn_of_what_no_ground_has() {
    let folder = tempfile::tempdir().expect("a folder");
    written(folder.path(), &[([15, 3], 0.0)]);
    for command in [&["check", "case.toml"][..], &["run", "case.toml"]] {
        let text = all(&granflow(folder.path(), command));
        assert!(
            text.contains("warning") && text.contains("dem.asc: a cliff of 1481.3 m between two cells"),
            "{text}"
        );
        assert!(text.contains("0 m beside 1481.3 m"), "{text}");
    }
}
