//! Gauges and sections: what they say is what the frames, the change of volume and the ledger say.

use granflow::Case;
use granflow::output::lines::Table;
use granflow::session::Options;
use netcdf_reader::NcFile;
use std::fmt::Write as _;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Runs a case into `out/`.
fn run(folder: &Path, text: &str) -> NcFile {
    std::fs::write(folder.join("case.toml"), text).unwrap();
    let options = Options {
        directory: folder.join("out"),
        threads: 2,
        resume: false,
        command: "test".to_owned(),
        notice: &|_| (),
    };
    let case = Case::read(folder.join("case.toml")).unwrap().check().unwrap();
    case.compute(&options, &AtomicBool::new(false), &mut |_| ()).unwrap();
    NcFile::open(folder.join("out/result.nc")).unwrap()
}

fn table(folder: &Path, name: &str) -> Table {
    Table::read(&folder.join("out").join(name)).unwrap()
}

fn values(file: &NcFile, name: &str) -> Vec<f64> {
    file.read_variable_as_f64(name).unwrap().iter().copied().collect()
}

/// A column of one name.
fn of(table: &Table, name: &str, column: &str) -> Vec<f64> {
    let k = table.columns.iter().position(|own| own == column).unwrap();
    let n = table.names.iter().position(|own| own == name).unwrap();
    table.values[k].iter().skip(n).step_by(table.names.len()).copied().collect()
}

const PLANE: &str = r#"
grid.x = { from = -3.0, to = 6.0, cells = 90 }
grid.y = { from = -2.0, to = 2.0, cells = 40 }
material = { slope = "20 deg", friction.coulomb = { angle = "24 deg" } }
initial.thickness.cap = { height = 1.0, radius = 1.5 }
output = { every = 0.25, files = ["netcdf"] }
gauge = [{ name = "foot", at = [2.05, 0.05] }, { name = "far side", at = [0.53, 1.02] }]
[[section]]
name = "ring"
line = [[0.5, -1.0], [3.5, -1.0], [3.5, 1.0], [0.5, 1.0], [0.5, -1.0]]
[[section]]
name = "across"
line = [[1.0, 2.0], [1.6, -2.0]]
"#;

/// The row of a table at each frame's time.
fn rows(table: &Table, times: &[f64]) -> Vec<usize> {
    let row = |time: &f64| table.times.iter().position(|own| own.to_bits() == time.to_bits());
    times.iter().map(|time| row(time).unwrap_or_else(|| panic!("no line at {time}"))).collect()
}

#[test]
fn gauges_are_the_cells_of_the_frames_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    for every_step in [true, false] {
        let every = if every_step { "output = { every" } else { "output = { series_every = 0.1, every" };
        let text = PLANE.replace("output = { every", every);
        let file = run(folder.path(), &format!("time.end = 2.0\n{text}"));
        let gauges = table(folder.path(), "gauges.csv");
        assert_eq!(gauges.names, ["foot", "far side"]);
        assert!(gauges.times.windows(2).all(|pair| pair[0] < pair[1]));
        let times = values(&file, "time");
        assert_eq!(times.len(), 9);
        let rows = rows(&gauges, &times);
        // x = 2.05 lies in column 50, y = 0.05 in row 20.
        for (name, cell) in [("foot", 20 * 90 + 50), ("far side", 30 * 90 + 35)] {
            for field in ["thickness", "velocity_x", "velocity_y"] {
                let (own, frames) = (of(&gauges, name, field), values(&file, field));
                for (instant, row) in rows.iter().enumerate() {
                    assert_eq!(
                        own[*row].to_bits(),
                        frames[instant * 3600 + cell].to_bits(),
                        "{name} {field}"
                    );
                }
            }
            assert!(of(&gauges, name, "thickness").iter().any(|h| *h > 0.01), "{name} is reached");
        }
        assert_eq!(gauges.times.len() > 40, every_step, "else 0.1 and 0.25 in time");
        // The same in result.nc.
        let kept = values(&file, "gauge_thickness");
        assert_eq!(kept, gauges.values[0]);
        assert_eq!(values(&file, "series_time"), gauges.times);
        assert_eq!(values(&file, "section_volume"), table(folder.path(), "sections.csv").values[1]);
        let names = file.global_attribute("gauge_names").unwrap().value.as_string();
        assert_eq!(names.as_deref(), Some("foot, far side"));
    }
}

#[test]
fn what_passes_a_closed_line_is_the_change_inside_whatever_the_scheme() {
    let folder = tempfile::tempdir().unwrap();
    let schemes = ["energy_stable", "energy_stable_2", "balanced", "balanced_2", "verfahren_1"];
    for scheme in schemes {
        let text = format!("time.end = 2.0\nscheme.name = \"{scheme}\"\n{PLANE}");
        let text = text
            .replace("scheme.name = \"verfahren_1\"", "scheme = { name = \"verfahren_1\", step = 0.004 }");
        let file = run(folder.path(), &text);
        let sections = table(folder.path(), "sections.csv");
        let (times, h) = (values(&file, "time"), values(&file, "thickness"));
        let inside = |instant: usize| -> f64 {
            let cells = (10..30).flat_map(|j| (35..65).map(move |i| j * 90 + i));
            cells.map(|cell| h[instant * 3600 + cell]).sum::<f64>() * 0.1 * 0.1
        };
        let (ring, across) = (of(&sections, "ring", "volume"), of(&sections, "across", "volume"));
        let total: f64 = h[..3600].iter().sum::<f64>() * 0.01;
        let mut most = 0.0_f64;
        for (instant, row) in rows(&sections, &times).into_iter().enumerate() {
            let change = inside(0) - inside(instant);
            most = most.max(change.abs());
            // Left of the ring, which is walked counterclockwise, is its inside.
            assert!((ring[row] - change).abs() < 1e-12 * total, "{scheme}: {} {change}", ring[row]);
        }
        assert!(most > 0.05 * total, "{scheme}: much passes");
        // The line leads from the upper edge to the lower one: its left is downhill, so what flows down counts negative.
        assert!(*across.last().unwrap() < -0.1 * total, "{scheme}");
        // Discharges are the volumes of the steps.
        let (discharge, times) = (of(&sections, "ring", "discharge"), &sections.times);
        assert!(discharge[0].is_nan() && discharge[1..].iter().all(|q| q.is_finite()));
        let last = times.len() - 1;
        let rate = (ring[last] - ring[last - 1]) / (times[last] - times[last - 1]);
        assert!((rate - discharge[last]).abs() < 1e-9, "{scheme}: {rate} {}", discharge[last]);
    }
}

#[test]
fn in_one_dimension_a_section_is_what_was_gained_behind_it_and_left() {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"
grid.x = { from = -3.0, to = 3.0, cells = 60 }
material = { slope = "35 deg", friction.coulomb = { angle = "24 deg" } }
initial.thickness.cap = { height = 1.0, radius = 1.5 }
time.end = 4.0
output = { every = 0.5, files = ["netcdf"] }
gauge = [{ name = "g", at = [1.03] }]
section = [{ name = "s", line = [[1.0]] }, { name = "end", line = [[3.0]] }]
"#;
    let file = run(folder.path(), text);
    let sections = table(folder.path(), "sections.csv");
    let (times, h) = (values(&file, "time"), values(&file, "thickness"));
    let ledger = std::fs::read_to_string(folder.path().join("out/mass.csv")).unwrap();
    let last: Vec<&str> = ledger.lines().last().unwrap().split(',').collect();
    let left: f64 = last[6].parse().unwrap();
    let behind = |instant: usize| h[instant * 60 + 40..(instant + 1) * 60].iter().sum::<f64>() * 0.1;
    let (s, end) = (of(&sections, "s", "volume"), of(&sections, "end", "volume"));
    for (instant, row) in rows(&sections, &times).into_iter().enumerate() {
        let gained = behind(instant) - behind(0) + end[row];
        assert!((s[row] - gained).abs() < 1e-12, "{} {gained}", s[row]);
    }
    assert!((end.last().unwrap() - left).abs() < 1e-12 && left > 0.1, "the ledger says {left}");
    let largest = of(&sections, "s", "thickness").into_iter().fold(0.0, f64::max);
    assert!(largest > 0.1, "{largest}");
}

/// A slope of 35 deg that ends at the edge of a raster, with a corner of nodata.
fn mountain(folder: &Path) -> String {
    let mut text =
        "ncols 30\nnrows 60\nxllcorner 1000\nyllcorner 2000\ncellsize 5\nNODATA_value -9999\n".to_owned();
    for row in 0..60 {
        for column in 0..30 {
            let z = if row > 55 && column < 3 { -9999.0 } else { 500.0 + 3.5 * (59.0 - f64::from(row)) };
            let _ = write!(text, "{z} ");
        }
        text.push('\n');
    }
    std::fs::write(folder.join("slope.asc"), text).unwrap();
    let line = r#"{"type":"LineString","coordinates":[[1000,2100],[1150,2100]]}"#;
    std::fs::write(folder.join("road.geojson"), line).unwrap();
    r#"
[terrain]
dem = "slope.asc"
crs = "EPSG:31287"
[material]
density = 300.0
friction.coulomb = { mu = 0.3 }
[[release]]
cap = { height = 2.0, centre = [1075.0, 2230.0], radius = 25.0 }
[time]
end = 30.0
[output]
every = 2.0
precision = "f64"
files = ["netcdf"]
[[gauge]]
name = "road"
at = [1075.0, 2102.0]
[[section]]
name = "road"
file = "road.geojson"
[[section]]
name = "lower edge"
line = [[1000.0, 2000.0], [1150.0, 2000.0]]
"#
    .to_owned()
}

#[test]
fn on_terrain_the_edge_is_the_ledger_and_the_pressure_that_of_the_speed() {
    let folder = tempfile::tempdir().unwrap();
    let text = mountain(folder.path());
    let file = run(folder.path(), &text);
    let (gauges, sections) = (table(folder.path(), "gauges.csv"), table(folder.path(), "sections.csv"));
    let times = values(&file, "time");
    for (instant, row) in rows(&gauges, &times).into_iter().enumerate() {
        for field in ["thickness", "speed"] {
            let frame = values(&file, field)[instant * 1800 + 20 * 30 + 15];
            assert_eq!(of(&gauges, "road", field)[row].to_bits(), frame.to_bits());
        }
    }
    for (speed, pressure) in of(&gauges, "road", "speed").iter().zip(of(&gauges, "road", "pressure")) {
        assert_eq!(pressure, 300.0 * speed * speed / 1000.0);
    }
    let ledger = std::fs::read_to_string(folder.path().join("out/mass.csv")).unwrap();
    let last: Vec<f64> =
        ledger.lines().last().unwrap().split(',').map(|cell| cell.parse().unwrap()).collect();
    let (initial, bottom) =
        (ledger.lines().nth(1).unwrap().split(',').nth(2).unwrap().parse::<f64>().unwrap(), last[7]);
    // Walked eastward its right is below: what leaves counts positive.
    let lower = of(&sections, "lower edge", "volume");
    assert!((lower.last().unwrap() - bottom).abs() < 1e-12 * initial, "{lower:?} {bottom}");
    assert!(bottom > 0.3 * initial, "much leaves: {bottom}");
    let road = *of(&sections, "road", "volume").last().unwrap();
    assert!(road > bottom && road < initial, "{road}");
}

#[test]
fn places_that_are_not_there_are_refused_by_their_key() {
    let folder = tempfile::tempdir().unwrap();
    let text = mountain(folder.path());
    let refused = |from: &str, to: &str, parts: &[&str]| {
        assert!(text.contains(from));
        std::fs::write(folder.path().join("bad.toml"), text.replace(from, to)).unwrap();
        let case = Case::read(folder.path().join("bad.toml"));
        let message = match case.and_then(|case| case.check()) {
            Err(error) => format!("{error:?} {error}"),
            Ok(checked) => {
                let error = checked.describe().unwrap_err();
                format!("{error:?} {error}")
            }
        };
        assert!(parts.iter().all(|part| message.contains(part)), "{message}");
    };
    refused("[1075.0, 2102.0]", "[975.0, 2102.0]", &["gauge[0].at", "outside the grid", "x 1000 to 1150"]);
    refused("[1075.0, 2102.0]", "[1002.0, 2002.0]", &["gauge[0].at", "no elevation"]);
    refused("[1075.0, 2102.0]", "[1075.0]", &["gauge[0].at", "two numbers"]);
    refused("name = \"lower edge\"", "name = \"road\"", &["section[1].name", "section[0] too"]);
    refused("[1150.0, 2000.0]", "[1001.0, 2000.0]", &["section[1].line", "shorter than a cell"]);
    refused("file = \"road.geojson\"", "file = \"rod.geojson\"", &["section[0].file", "road.geojson"]);
    refused("file = \"road.geojson\"", "", &["section[0]", "exactly one of line, file"]);
    refused("every = 2.0", "every = 2.0\nseries_every = -1.0", &["output.series_every", "> 0"]);
}

#[test]
fn durations_are_the_times_between_the_steps_at_which_a_gauge_crosses() {
    let folder = tempfile::tempdir().unwrap();
    let text = mountain(folder.path()).replace(
        "every = 2.0",
        "every = 1000.0\ndurations = { thickness = 0.3, speed = 4.0, pressure = 10.0 }\nthreshold = 0.05",
    );
    let file = run(folder.path(), &text);
    let gauges = table(folder.path(), "gauges.csv");
    let (thickness, end) = (of(&gauges, "road", "thickness"), *gauges.times.last().unwrap());
    for (what, limit) in [("thickness", 0.3), ("speed", 4.0), ("pressure", 10.0)] {
        let (values_of, name) = (of(&gauges, "road", what), format!("duration_{what}"));
        let map = values(&file, &name)[20 * 30 + 15];
        // Without frames between them all lines are those of steps.
        let above = |k: usize| values_of[k] > limit && thickness[k] > 0.05;
        let mut exact = 0.0;
        for k in 0..gauges.times.len() {
            let next = gauges.times.get(k + 1).copied().unwrap_or(end);
            exact += if above(k) { next - gauges.times[k] } else { 0.0 };
        }
        assert!((map - exact).abs() < 1e-12 * end && map > 0.5, "{what}: {map} {exact}");
        let kept = file.global_attribute(&format!("{name}_threshold")).unwrap().value.as_string();
        assert_eq!(kept.and_then(|text| text.parse().ok()), Some(limit));
    }
}

#[test]
fn a_region_of_a_terrain_gives_the_cells_in_it() {
    let folder = tempfile::tempdir().unwrap();
    let text = mountain(folder.path());
    let text = text.split("[[gauge]]").next().unwrap().to_owned();
    let cut = |region: &str| {
        text.replace("crs = \"EPSG:31287\"", &format!("crs = \"EPSG:31287\"\nregion = {region}"))
    };
    let file = run(folder.path(), &cut("[1015.0, 1135.0, 2000.0, 2290.0]"));
    let (x, y, bed) = (values(&file, "x"), values(&file, "y"), values(&file, "bed"));
    assert_eq!((x.len(), y.len()), (24, 58));
    assert_eq!((x[0], y[0], bed[0]), (1017.5, 2002.5, 500.0));
    let refused = |region: &str, part: &str| {
        std::fs::write(folder.path().join("bad.toml"), cut(region)).unwrap();
        let checked = Case::read(folder.path().join("bad.toml")).and_then(|case| case.check());
        let message = match checked {
            Ok(checked) => format!("{:?}", checked.describe().unwrap_err()),
            Err(error) => format!("{error:?}"),
        };
        assert!(message.contains("terrain.region") && message.contains(part), "{message}");
    };
    refused("[1135.0, 1015.0, 2000.0, 2290.0]", "has no inside");
    refused("[0.0, 10.0, 2000.0, 2290.0]", "no cell of the raster lies in it");
    refused("[1060.0, 1069.0, 2000.0, 2290.0]", "at least 3 along each side");
    refused("[1000.0, 1015.0, 2000.0, 2015.0]", "none of its cells has an elevation");
}
