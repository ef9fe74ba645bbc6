use super::*;
use std::fs;

/// A raster of 10 by 10 cells of 1 m thickness.
fn grid(west: f64, south: f64, cell: f64) -> String {
    let row = "1 ".repeat(10) + "\n";
    format!("ncols 10\nnrows 10\nxllcorner {west}\nyllcorner {south}\ncellsize {cell}\n{}", row.repeat(10))
}

/// A box as GeoJSON.
fn outline([west, east]: [f64; 2], [south, north]: [f64; 2], crs: &str) -> String {
    format!(
        r#"{{"type":"FeatureCollection",{crs}"features":[{{"type":"Feature","properties":{{}},"geometry":{{"type":"Polygon",
        "coordinates":[[[{west},{south}],[{east},{south}],[{east},{north}],[{west},{north}],[{west},{south}]]]}}}}]}}"#
    )
}

const LAMBERT: &str = r#""crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::31287"}},"#;

#[test]
fn a_side_in_degrees_that_says_no_system_is_refused_with_the_cure() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: String| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        path
    };
    let of = |a: &Path, b: &Path| compare(a, b, &Options::default());
    let metres = file("metres.asc", grid(4e5, 3e5, 10.0));
    let mapped = file("mapped.geojson", outline([4e5, 400_050.0], [3e5, 300_100.0], LAMBERT));
    let degrees = file("degrees.geojson", outline([11.5, 11.6], [47.0, 47.1], ""));
    let raster = file("degrees.asc", grid(11.5, 47.0, 0.01));
    for (a, b) in [(&metres, &degrees), (&degrees, &metres)] {
        let error = of(a, b).unwrap_err();
        let text = error.to_string();
        assert!(matches!(error, CompareError::Apart { .. }), "{text}");
        assert!(
            text.contains("degrees.geojson looks like degrees; reproject it with\n  ogr2ogr -t_srs"),
            "{text}"
        );
    }
    let text = of(&mapped, &degrees).unwrap_err().to_string();
    assert!(text.contains("ogr2ogr -t_srs EPSG:31287 -s_srs EPSG:4326"), "{text}");
    let text = of(&raster, &mapped).unwrap_err().to_string();
    assert!(
        text.contains("degrees.asc looks like degrees") && text.contains("gdalwarp -t_srs EPSG:31287"),
        "{text}"
    );
    // What is near the origin in metres on both sides, or within the other side, is compared.
    let near = file("near.asc", grid(0.0, 0.0, 10.0));
    let within = file("within.geojson", outline([10.0, 60.0], [20.0, 70.0], ""));
    for [a, b] in [[&near, &within], [&within, &near], [&degrees, &raster], [&metres, &mapped]] {
        assert!(of(a, b).is_ok(), "{} {}", a.display(), b.display());
    }
}
