//! A mountain made from a formula, for `granflow new avalanche` and `granflow demo`.
//!
//! With s the distance from the top (south) and d = x - 80 sin(s/230) that from the valley's line, in metres,
//! z = 900 + 600 exp(-s/600) + D(s) (1 - exp(-(d/w(s))^2)) + side ridges: a bowl, a gully that winds down an
//! exponential slope, and a fan. Its inclination falls from 45 deg at the top below atan(0.4) = 22 deg at s = 550 m.

use std::fmt::Write;

/// Size of a cell in metres.
const CELL: f64 = 5.0;
/// Cells along x.
const COLUMNS: usize = 200;
/// Cells along y, and of the mountain with a long foot, for laws of little friction.
const ROWS: usize = 300;
const LONG: usize = 600;
/// Low corner in the coordinates of Austria Lambert (EPSG:31287).
const CORNER: [f64; 2] = [250_000.0, 350_000.0];
/// The outline of the release: distance to the gully's line and from the top, in metres.
const OUTLINE: [[f64; 2]; 8] = [
    [-62.0, 92.0],
    [-24.0, 62.0],
    [30.0, 58.0],
    [74.0, 96.0],
    [66.0, 150.0],
    [24.0, 196.0],
    [-20.0, 200.0],
    [-58.0, 158.0],
];

/// Where the gully runs, seen from the middle of the raster.
fn line(s: f64) -> f64 {
    80.0 * (s / 230.0).sin()
}

/// Elevation in metres at x from the middle and s from the top.
fn height(x: f64, s: f64) -> f64 {
    let d = x - line(s);
    // The gully is deepest half way down, wide and shallow on the fan.
    let depth = (45.0 + 75.0 * (-((s - 520.0) / 330.0).powi(2)).exp()) * (1.0 - 0.6 * (-s / 120.0).exp());
    let width = 75.0 + 130.0 / (1.0 + (-(s - 900.0) / 90.0).exp());
    let valley = depth * (1.0 - (-(d / width).powi(2)).exp());
    // Ridges come down from both sides and end before the valley's floor.
    let beside = 1.0 - (-(d / (1.6 * width)).powi(4)).exp();
    let ridges = 18.0 * (std::f64::consts::TAU * (s - 0.7 * d.abs()) / 230.0 + d.signum()).sin();
    let rough = 2.5 * (x / 19.0 + s / 47.0).sin() * (s / 27.0 - x / 61.0).sin();
    900.0 + 600.0 * (-s / 600.0).exp() + valley + beside * (ridges + rough)
}

/// The elevation as an ESRI ASCII grid, its first row in the north.
pub fn elevation() -> String {
    of_rows(ROWS)
}

/// The same mountain with twice as long a foot.
pub fn long_elevation() -> String {
    of_rows(LONG)
}

fn of_rows(rows: usize) -> String {
    let mut text = format!(
        "ncols {COLUMNS}\nnrows {rows}\nxllcorner {}\nyllcorner {}\ncellsize {CELL}\nNODATA_value -9999\n",
        CORNER[0], CORNER[1]
    );
    let centre = |index: usize| (index as f64 + 0.5) * CELL;
    for row in (0..rows).rev() {
        for column in 0..COLUMNS {
            let x = centre(column) - 0.5 * COLUMNS as f64 * CELL;
            let end = if column + 1 == COLUMNS { '\n' } else { ' ' };
            // writing to a String does not fail
            let _ = write!(text, "{:.2}{end}", height(x, centre(row)));
        }
    }
    text
}

/// The release as GeoJSON, in the coordinates of the raster.
pub fn release() -> String {
    let middle = CORNER[0] + 0.5 * COLUMNS as f64 * CELL;
    let points: Vec<String> = OUTLINE
        .iter()
        .chain(&OUTLINE[..1])
        .map(|[x, s]| format!("[{:.2}, {:.2}]", middle + line(*s) + x, CORNER[1] + s))
        .collect();
    format!(
        "{{ \"type\": \"FeatureCollection\",\n  \"crs\": {{ \"type\": \"name\", \"properties\": {{ \"name\": \"urn:ogc:def:crs:EPSG::31287\" }} }},\n  \"features\": [\n    {{ \"type\": \"Feature\", \"properties\": {{ \"thickness\": 1.0 }},\n      \"geometry\": {{ \"type\": \"Polygon\", \"coordinates\": [[{}]] }} }}\n  ]\n}}\n",
        points.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_raster_is_whole_and_falls_northwards() {
        let text = elevation();
        let rows: Vec<Vec<f64>> =
            text.lines().skip(6).map(|row| row.split(' ').map(|z| z.parse().unwrap()).collect()).collect();
        assert_eq!((rows.len(), rows[0].len()), (ROWS, COLUMNS));
        let lowest = |row: &Vec<f64>| row.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(rows.windows(2).all(|pair| lowest(&pair[0]) < lowest(&pair[1])));
        assert!(serde_json::from_str::<serde_json::Value>(&release()).is_ok());
    }
}
