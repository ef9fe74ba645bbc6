//! Parameters of friction that differ from place to place on a mountain.

use crate::asc;
use granflow::Case;
use granflow::run::Run;
use std::fs;
use std::path::Path;

const COLUMNS: usize = 60;
const ROWS: usize = 30;
const CELL: f64 = 5.0;

/// A raster of the mountain's cells, by column and row from the south west.
fn write_grid(path: &Path, value: impl Fn(usize, usize) -> f64) {
    asc::write_grid(path, [COLUMNS, ROWS], [1000.0, 2000.0], CELL, value);
}

/// Rectangles [west, south, east, north] \[m\] with an attribute `mu`.
fn write_polygons(path: &Path, zones: &[([f64; 4], &str)]) {
    let features: Vec<String> = zones
        .iter()
        .map(|([west, south, east, north], mu)| {
            format!(
                r#"{{"type":"Feature","properties":{{"mu":{mu}}},"geometry":{{"type":"Polygon","coordinates":[[
                [{west},{south}],[{east},{south}],[{east},{north}],[{west},{north}],[{west},{south}]]]}}}}"#
            )
        })
        .collect();
    let text = format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(","));
    fs::write(path, text).unwrap();
}

/// A valley that falls to the east, steep above and gentle below, with a hole in the data.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    write_grid(&folder.path().join("dem.asc"), |i, j| {
        if i == 3 && j < 5 {
            return -9999.0;
        }
        let (x, y) = (i as f64 * CELL, (j as f64 - 14.5) * CELL);
        1000.0 - 0.6 * x.min(150.0) - 0.1 * (x - 150.0).max(0.0) + 0.004 * y * y
    });
    folder
}

fn text(friction: &str, scheme: &str) -> String {
    format!(
        "[terrain]\ndem = \"dem.asc\"\ncrs = \"EPSG:31287\"\n[material]\ndensity = 200.0\n\
         friction.{friction}\n[[release]]\ncap = {{ height = 3.0, centre = [1040.0, 2075.0], radius = 30.0 }}\n\
         [scheme]\n{scheme}\n[time]\nend = 12.0\n"
    )
}

fn start(folder: &Path, friction: &str, scheme: &str) -> Result<Box<dyn Run>, String> {
    let path = folder.join("case.toml");
    fs::write(&path, text(friction, scheme)).unwrap();
    let case = Case::read(&path).map_err(|error| error.to_string())?;
    let checked = case.check().map_err(|error| error.to_string())?;
    checked.start().map_err(|error| error.to_string())
}

/// The thickness after 12 s, as bits.
fn end(folder: &Path, friction: &str, scheme: &str) -> Vec<u64> {
    let mut run = start(folder, friction, scheme).unwrap();
    run.until(12.0).unwrap();
    run.field("thickness").unwrap().iter().map(f64::to_bits).collect()
}

#[test]
fn one_number_as_raster_polygons_and_classes_gives_the_bits_of_the_number() {
    let folder = folder();
    let folder = folder.path();
    write_grid(&folder.join("mu.asc"), |_, _| 0.31);
    write_grid(&folder.join("xi.asc"), |_, _| 1300.0);
    write_polygons(&folder.join("zones.geojson"), &[([900.0, 1900.0, 1400.0, 2300.0], "0.31")]);
    for scheme in ["name = \"energy_stable\"", "name = \"energy_stable_2\""] {
        let number = end(folder, "coulomb = { mu = 0.31 }", scheme);
        for mu in [
            "{ raster = \"mu.asc\" }",
            "{ polygons = \"zones.geojson\", attribute = \"mu\" }",
            "{ polygons = \"zones.geojson\", attribute = \"mu\", elsewhere = 9.0 }",
            "{ by_elevation = { at = [900, 950.5], values = [0.31, 0.31, 0.31] } }",
        ] {
            assert!(end(folder, &format!("coulomb = {{ mu = {mu} }}"), scheme) == number, "{mu}, {scheme}");
        }
        let number = end(folder, "voellmy = { mu = 0.31, xi = 1300.0 }", scheme);
        let both = "voellmy = { mu = { raster = \"mu.asc\" }, xi = { raster = \"xi.asc\" } }";
        assert!(end(folder, both, scheme) == number, "voellmy, {scheme}");
    }
}

/// A forest without drag is none; with some it brakes.
#[test]
fn a_forest_brakes_where_it_stands() {
    let folder = folder();
    let folder = folder.path();
    write_polygons(&folder.join("forest.geojson"), &[([1060.0, 1900.0, 1400.0, 2300.0], "0.05")]);
    let second = "name = \"energy_stable_2\"";
    let bare = end(folder, "coulomb = { mu = 0.31 }", second);
    assert!(bare == end(folder, "coulomb = { mu = 0.31 }\nforest = 0.0", second));
    let speed = |forest: &str| {
        let mut run = start(folder, &format!("coulomb = {{ mu = 0.31 }}{forest}"), second).unwrap();
        run.until(12.0).unwrap();
        run.record().peak_speed
    };
    let forest = "\nforest = { polygons = \"forest.geojson\", attribute = \"mu\", elsewhere = 0.0 }";
    let (free, braked) = (speed(""), speed(forest));
    assert!(braked < 0.8 * free, "{braked} m/s instead of {free}");
    let error = start(folder, "coulomb = { mu = 0.3 }\nforest = -1.0", second).err().unwrap();
    assert!(error.contains("material.forest") || error.contains("`forest`"), "{error}");
}

/// A zone that no mass reaches changes nothing; one on the way stops it there.
#[test]
fn a_rough_zone_stops_what_enters_it() {
    let folder = folder();
    let folder = folder.path();
    let zones = [([1200.0, 2000.0, 1300.0, 2150.0], "3.0"), ([1000.0, 2000.0, 1010.0, 2150.0], "0.0")];
    write_polygons(&folder.join("zones.geojson"), &zones);
    let mu = "coulomb = { mu = { polygons = \"zones.geojson\", attribute = \"mu\", elsewhere = 0.1 } }";
    let volume = |friction: &str, from: f64| {
        let mut run = start(folder, friction, "name = \"energy_stable_2\"").unwrap();
        run.until(60.0).unwrap();
        let (first, thickness) = ((from - 1000.0) / CELL, run.field("thickness").unwrap());
        let beyond = |k: &usize| (k % COLUMNS) as f64 >= first;
        let all: Vec<f64> = thickness.iter().collect();
        (0..all.len()).filter(beyond).map(|k| all[k]).sum::<f64>() / all.iter().sum::<f64>()
    };
    let (free, stopped) = (volume("coulomb = { mu = 0.1 }", 1225.0), volume(mu, 1225.0));
    assert!(free > 0.2, "without the zone {free} of the volume is beyond its first metres");
    assert!(stopped < 0.1 * free, "{stopped} of the volume passed 25 m of mu = 3, {free} without");
}

#[test]
fn what_is_wrong_with_a_field_is_named_with_its_place_and_a_cure() {
    let folder = folder();
    let folder = folder.path();
    write_grid(&folder.join("holes.asc"), |i, j| if i == 20 && j == 7 { -9999.0 } else { 0.3 });
    write_grid(&folder.join("low.asc"), |i, j| if i == 20 && j == 7 { -0.2 } else { 0.3 });
    write_polygons(&folder.join("west.geojson"), &[([900.0, 1900.0, 1100.0, 2300.0], "0.31")]);
    write_polygons(&folder.join("none.geojson"), &[([900.0, 1900.0, 1400.0, 2300.0], "null")]);
    let second = "name = \"energy_stable_2\"";
    for (friction, scheme, said) in [
        (
            "coulomb = { mu = { raster = \"holes.asc\" } }",
            second,
            vec!["holes.asc", "(1102.5, 2037.5)", "elsewhere"],
        ),
        (
            "coulomb = { mu = { raster = \"low.asc\" } }",
            second,
            vec!["low.asc", "-0.2", "(1102.5, 2037.5)", ">= 0"],
        ),
        (
            "coulomb = { mu = { polygons = \"west.geojson\", attribute = \"mu\" } }",
            second,
            vec!["west.geojson", "no value at", "elsewhere"],
        ),
        (
            "coulomb = { mu = { polygons = \"none.geojson\", attribute = \"mu\", elsewhere = 1 } }",
            second,
            vec!["none.geojson", "feature 1", "mu", "NULL"],
        ),
        ("coulomb = { mu = { polygons = \"west.geojson\" } }", second, vec!["attribute", "missing"]),
        (
            "coulomb = { mu = { polygons = \"west.geojson\", attribute = \"mv\" } }",
            second,
            vec!["`material.friction.coulomb.mu.attribute`", "west.geojson", "it has mu"],
        ),
        (
            "coulomb = { mu = { raster = \"low.asc\", attribute = \"mu\" } }",
            second,
            vec!["attribute", "belongs to polygons"],
        ),
        (
            "coulomb = { mu = { elsewhere = 0.3 } }",
            second,
            vec!["exactly one of raster, polygons, by_elevation"],
        ),
        ("coulomb = { mu = { raster = \"nothing.asc\" } }", second, vec!["cannot read", "nothing.asc"]),
        (
            "coulomb = { mu = { by_elevation = { at = [900, 800], values = [1, 2, 3] } } }",
            second,
            vec!["growing elevations"],
        ),
        (
            "coulomb = { mu = { by_elevation = { at = [900], values = [1, 2, 3] } } }",
            second,
            vec!["3 values for 1 elevations"],
        ),
        (
            "voellmy = { mu = 0.2, xi = { by_elevation = { at = [900], values = [0.0, 2] } } }",
            second,
            vec!["values[0]", "> 0"],
        ),
        (
            "coulomb = { mu = { raster = \"low.asc\" } }",
            "name = \"balanced\"",
            vec!["balanced", "energy_stable"],
        ),
        (
            "bingham = { yield = 10.0, viscosity = 1.0 }",
            "name = \"balanced_2\"",
            vec!["bingham", "energy_stable"],
        ),
    ] {
        let error = match start(folder, friction, scheme) {
            Ok(_) => panic!("{friction} with {scheme} passed"),
            Err(error) => error,
        };
        for part in said {
            assert!(error.contains(part), "{friction} with {scheme}: `{part}` is not in\n{error}");
        }
    }
}

#[test]
fn the_size_of_an_avalanche_chooses_mu() {
    let folder = folder();
    let folder = folder.path();
    let second = "name = \"energy_stable_2\"";
    // 4241 m3 lie under the cap.
    let auto = end(folder, "samosat = { size = \"auto\" }", second);
    assert!(auto == end(folder, "samosat = { mu = 0.22 }", second));
    assert!(auto == end(folder, "samosat = { size = \"small\" }", second));
    assert!(end(folder, "samosat = {}", second) == end(folder, "samosat = { size = \"large\" }", second));
    let run = start(folder, "samosat = { size = \"auto\" }", second).unwrap();
    assert!(run.numbers().iter().any(|(name, mu)| name == "friction_mu" && *mu == 0.22));
    let both = start(folder, "samosat = { size = \"small\", mu = 0.2 }", second).err().unwrap();
    assert!(both.contains("both `mu` and `size`"), "{both}");
}
