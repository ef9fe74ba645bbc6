//! A small mountain made from a formula, for `granflow new avalanche` and `granflow demo`.
//!
//! A gully that winds down an exponential slope: with s the distance from the top, z = 900 + 900 exp(-s/900)
//! + (x - 60 sin(s/300))^2/2000. Its inclination falls from 45 deg at the top below atan(0.4) = 22 deg at s = 825 m.

use std::fmt::Write;

/// Size of a cell in metres.
const CELL: f64 = 10.0;
/// Cells along x and y.
const CELLS: [usize; 2] = [70, 220];
/// Low corner in the coordinates of Austria Lambert (EPSG:31287).
const CORNER: [f64; 2] = [250_000.0, 350_000.0];
/// The outline of the release: distance to the gully's line and from the top, in metres.
const OUTLINE: [[f64; 2]; 6] =
    [[-45.0, 150.0], [0.0, 130.0], [45.0, 150.0], [60.0, 230.0], [0.0, 290.0], [-60.0, 230.0]];

/// Length of the mountain in metres, from the top (north) to the foot (south).
fn length() -> f64 {
    CELLS[1] as f64 * CELL
}

/// Where the gully runs, seen from the middle of the raster.
fn line(s: f64) -> f64 {
    60.0 * (s / 300.0).sin()
}

/// Elevation in metres at x from the middle and s from the top.
fn height(x: f64, s: f64) -> f64 {
    900.0 + 900.0 * (-s / 900.0).exp() + (x - line(s)).powi(2) / 2000.0
}

/// The elevation as an ESRI ASCII grid, its first row in the north.
pub fn elevation() -> String {
    let mut text = format!(
        "ncols {}\nnrows {}\nxllcorner {}\nyllcorner {}\ncellsize {CELL}\nNODATA_value -9999\n",
        CELLS[0], CELLS[1], CORNER[0], CORNER[1]
    );
    let centre = |index: usize| (index as f64 + 0.5) * CELL;
    for row in 0..CELLS[1] {
        for column in 0..CELLS[0] {
            let x = centre(column) - 0.5 * CELLS[0] as f64 * CELL;
            let end = if column + 1 == CELLS[0] { '\n' } else { ' ' };
            // writing to a String does not fail
            let _ = write!(text, "{:.3}{end}", height(x, centre(row)));
        }
    }
    text
}

/// The release as GeoJSON, in the coordinates of the raster.
pub fn release() -> String {
    let middle = CORNER[0] + 0.5 * CELLS[0] as f64 * CELL;
    let points: Vec<String> = OUTLINE
        .iter()
        .chain(&OUTLINE[..1])
        .map(|[x, s]| format!("[{:.2}, {:.2}]", middle + line(*s) + x, CORNER[1] + length() - s))
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
    fn the_raster_is_whole_and_falls_southwards() {
        let text = elevation();
        let rows: Vec<Vec<f64>> =
            text.lines().skip(6).map(|row| row.split(' ').map(|z| z.parse().unwrap()).collect()).collect();
        assert_eq!((rows.len(), rows[0].len()), (CELLS[1], CELLS[0]));
        let lowest = |row: &Vec<f64>| row.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(rows.windows(2).all(|pair| lowest(&pair[0]) > lowest(&pair[1])));
        assert!(serde_json::from_str::<serde_json::Value>(&release()).is_ok());
    }
}
