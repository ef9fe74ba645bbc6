//! What reads files of others, and valid files for it to begin with.

use crate::results;
use granflow_case::{Case, FileAccess, Formula, Outline};
use granflow_geo::raster::Raster;
use granflow_geo::release::{Layer, Thickness};
use std::path::Path;

/// A reader under test.
#[derive(Debug)]
pub struct Reader {
    /// Its name.
    pub name: &'static str,
    /// Valid inputs.
    pub seeds: fn() -> Vec<Vec<u8>>,
    /// Reads an input; an error is as good as a result.
    pub read: fn(&[u8]),
}

impl Reader {
    /// It reads a file, which takes a hundred times as long as bytes in memory.
    pub fn on_disk(&self) -> bool {
        ["checkpoint", "frames", "ledger", "summary", "result", "compared"].contains(&self.name)
    }
}

/// All readers.
pub const READERS: [Reader; 18] = [
    Reader { name: "formula", seeds: formulas, read: formula },
    Reader { name: "case", seeds: cases, read: case },
    Reader { name: "npy", seeds: arrays, read: |bytes| with_thickness("h.npy", bytes) },
    Reader { name: "csv", seeds: tables, read: |bytes| with_thickness("h.csv", bytes) },
    Reader { name: "hydrograph", seeds: hydrographs, read: hydrograph },
    Reader { name: "asc", seeds: grids, read: raster },
    Reader { name: "tif", seeds: images, read: raster },
    Reader { name: "geojson", seeds: geojson, read: |bytes| layer(bytes, None) },
    Reader { name: "shapefile", seeds: shapes, read: |bytes| layer(bytes, None) },
    Reader { name: "dbf", seeds: attributes, read: |bytes| layer(&shapes()[0], Some(bytes)) },
    Reader { name: "checkpoint", seeds: results::checkpoints, read: results::checkpoint },
    Reader { name: "frames", seeds: results::frames, read: results::stored },
    Reader { name: "ledger", seeds: results::ledgers, read: results::ledger },
    Reader { name: "series", seeds: results::series, read: results::table },
    Reader { name: "summary", seeds: results::summaries, read: results::summary },
    Reader { name: "result", seeds: results::results, read: results::result },
    Reader { name: "part", seeds: results::parts, read: results::part },
    Reader { name: "compared", seeds: compared, read: results::compared },
];

fn texts(texts: &[&str]) -> Vec<Vec<u8>> {
    texts.iter().map(|text| text.as_bytes().to_vec()).collect()
}

fn formulas() -> Vec<Vec<u8>> {
    texts(&["max(1 - x^2, 0) + exp(-y)", "if(x < 1, -sin(pi*x)**2, 3e-2)", "((x))+--1^-2^y/atan2(x, y)"])
}

fn formula(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    match Formula::parse(&text, &["x", "y"]) {
        Ok(formula) => drop(formula.at(&[0.5, -2.0])),
        Err(error) => assert!(text.get(error.at..error.at + error.length).is_some(), "{error:?}"),
    }
}

/// One file beside the case, whatever it is called.
#[derive(Debug)]
struct Beside<'a>(&'a [u8]);

impl FileAccess for Beside<'_> {
    fn outlines(&self, _path: &Path) -> Result<Box<dyn Outline>, String> {
        Err("no polygons here".to_owned())
    }
    fn find(&self, _path: &Path) -> std::io::Result<()> {
        Ok(())
    }
    fn bytes(&self, _path: &Path) -> std::io::Result<Vec<u8>> {
        Ok(self.0.to_vec())
    }
    fn names(&self, _folder: &Path) -> Option<Vec<String>> {
        Some(Vec::new())
    }
}

fn cases() -> Vec<Vec<u8>> {
    texts(&[
        include_str!("../../../cases/silo.toml"),
        include_str!("../../../cases/avalanche.toml"),
        include_str!("../../../cases/plane.toml"),
        include_str!("../../../cases/sandpile.toml"),
        include_str!("../../../cases/sandpile_walls.toml"),
        include_str!("../../../cases/silo_hole.toml"),
        include_str!("../../../cases/debris_flow.toml"),
        include_str!("../../../cases/rock_avalanche.toml"),
        include_str!("../../../cases/snow_avalanche.toml"),
        PICKED_UP,
        DRAWN,
        "model = \"savage_hutter\"\ngrid.x = { from = 0, to = 1, cells = 9 }\n\
         material.friction.coulomb.mu = 0.3\ninitial.thickness.formula = \"x\"\n[time]\nuntil = \"rest\"\n",
    ])
}

/// What acts between the steps, and what is looked at.
const PICKED_UP: &str = "model = \"savage_hutter\"\n[terrain]\ndem = \"a.asc\"\n[[release]]\nraster = \"h.asc\"\n[[release]]\n\
    result = \"earlier/result.nc\"\n[[release]]\ncap = { height = 2, centre = [5, 5], radius = 3 }\nat = 8\n\
    [[inflow]]\nline = [[1, 1], [2, 2]]\nhydrograph = { time = [0, 9], discharge = [3, 0], speed = [1, 2] }\n\
    [material]\ndensity = 300\nfriction.coulomb.mu = 0.3\nforest = 0.02\nforest_breaks_at = 90\n\
    earth_pressure.active_passive = { internal = \"35 deg\" }\n[entrainment]\nlayer = 0.3\nlaw.shear = { threshold = 1000, depth_by_stress = 1e-4, rate = 0.025 }\n\
    lower_bed = true\n[[gauge]]\nname = \"road\"\nat = [3, 4]\n[[section]]\nname = \"fan\"\nline = [[0, 1], [9, 1]]\n\
    [time]\nuntil = \"rest\"\ntrickle = 0.1\n[output]\nevery = 5\ndurations = { thickness = 0.5 }\n";
/// Many runs.
const DRAWN: &str = "grid.x = { from = 0, to = 9, cells = 9 }\nmaterial.friction.coulomb.mu = 0.3\n\
    initial.thickness.cap = { height = 1, centre = 4, radius = 3 }\ntime.end = 1\n[ensemble]\nmembers = 64\nseed = 7\n\
    sampling = \"latin_hypercube\"\nvary.\"material.friction.coulomb.mu\" = { normal = { mean = 0.3, sd = 0.05, min = 0.1, max = 0.6 } }\n\
    vary.\"initial.thickness.cap.height\" = { factor = { lognormal = { median = 1, sigma = 0.2 } } }\n\
    vary.\"material.slope\" = { uniform = [20, 30], unit = \"deg\" }\nvary.\"time.end\" = { choice = [1, 2] }\n\
    exceed = { peak_thickness = [0.5], peak_speed = [1] }\npercentiles = [5, 50, 95]\nclasses = 16\n";

fn case(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    // A case may ask for as many cells as the memory holds; what cannot fit is refused by a run, not by the reader.
    let long = |word: &str| word.len() > 3;
    if text.contains("cells") && text.split(|sign: char| !sign.is_ascii_digit()).any(long) {
        drop(Case::parse(&text, "a.toml").map(|case| (case.to_toml(), case.resolved())));
    } else {
        check(&text, &[]);
    }
}

fn check(text: &str, beside: &[u8]) {
    let checked = Case::parse(text, "a.toml").and_then(|case| {
        drop((case.to_toml(), case.resolved(), case.text()));
        case.check(&Beside(beside)).map(drop)
    });
    let Err(error) = checked else { return };
    assert!(!error.to_string().is_empty());
    if let Some(span) = error.span() {
        assert!(error.text().get(span.clone()).is_some(), "{span:?} of {} bytes", error.text().len());
    }
}

fn with_thickness(name: &str, bytes: &[u8]) {
    let text = format!(
        "model = \"savage_hutter\"\ntime.until = \"rest\"\nmaterial.friction.coulomb.mu = 0.3\n\
         grid.x = {{ from = 0, to = 3, cells = 3 }}\ngrid.y = {{ from = 0, to = 2, cells = 2 }}\n\
         initial.thickness.file = \"{name}\"\n"
    );
    check(&text, bytes);
}

fn arrays() -> Vec<Vec<u8>> {
    ["<f8", ">f4"]
        .map(|kind| {
            let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': (2, 3), }}   \n");
            let length = (header.len() as u16).to_le_bytes();
            let numbers = if kind == "<f8" { vec![0; 48] } else { vec![0; 24] };
            [b"\x93NUMPY\x01\0", &length[..], header.as_bytes(), &numbers].concat()
        })
        .to_vec()
}

fn tables() -> Vec<Vec<u8>> {
    texts(&["# thickness\n1, 2, 3\n4, 5, 6\n", "1;2;3\n\n4\t5 6e-3"])
}

fn hydrographs() -> Vec<Vec<u8>> {
    texts(&[
        "time [s], discharge [m3/s], speed [m/s]\n0, 0, 0\n5, 178, 2.5\n112.4, 0, 0\n",
        "\u{feff}Zeit;Abfluss\n0;1,5\n60;0\n",
        "0 2\n# a pause\n1e1\t4\n",
    ])
}

fn hydrograph(bytes: &[u8]) {
    let text = "model = \"savage_hutter\"\ntime.end = 9\nmaterial.friction.coulomb.mu = 0.3\nterrain.dem = \"a.asc\"\n\
                inflow = [{ line = [[0, 0], [1, 1]], hydrograph = \"q.csv\" }]\n";
    check(text, bytes);
}

/// What `granflow compare` takes beside the result of a run.
fn compared() -> Vec<Vec<u8>> {
    let ours = r#"{"type":"FeatureCollection","features":[
        {"type":"Feature","properties":{"name":"release"},"geometry":{"type":"Polygon","coordinates":
        [[[0.1,0.1],[0.3,0.1],[0.3,0.3],[0.1,0.1]]]}},
        {"type":"Feature","properties":{"name":"deposit"},"geometry":{"type":"Polygon","coordinates":
        [[[0.2,0.2],[0.9,0.2],[0.9,0.8],[0.2,0.2]]]}},
        {"type":"Feature","properties":{"name":"peak_thickness"},"geometry":{"type":"MultiPolygon","coordinates":
        [[[[0.1,0.1],[0.9,0.2],[0.9,0.8],[0.1,0.1]]]]}}]}"#;
    let thickness =
        "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 0.4\nNODATA_value -1\n1 2 0\n0.4 nan -1\n";
    [texts(&[ours, thickness]), geojson(), shapes(), images()].concat()
}

fn raster(bytes: &[u8]) {
    if let Ok(raster) = Raster::from_bytes(Path::new("a.tif"), bytes.to_vec(), None) {
        assert_eq!(raster.values.len(), raster.columns * raster.rows);
    }
}

fn grids() -> Vec<Vec<u8>> {
    texts(&[
        "ncols 3\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 2\nNODATA_value -1\n1 2 3\n4 nan -1\n",
        "3 ncols\n2 nrows\n10 xllcenter\n20 yllcenter\n2 dx\n2 dy\n1,5 2 3\n4 5 6\n",
        "ncols 1 nrows 1 xllcorner 0 yllcorner 0 cellsize 1e-3 nodata_value null\n1000\n",
    ])
}

fn images() -> Vec<Vec<u8>> {
    let folder = tempfile::tempdir().expect("a folder for the seeds");
    let path = folder.path().join("a.tif");
    let crs = granflow_geo::raster::Crs::parse("EPSG:31287").ok();
    let write = |columns: usize, rows: usize, crs| {
        let values = (0..columns * rows).map(|k| if k == 3 { f64::NAN } else { k as f64 }).collect();
        let raster = Raster { columns, rows, west: 4e5, south: 3e5, cell: 5.0, values, crs };
        raster.write_geotiff(&path).expect("the seed is valid");
        std::fs::read(&path).expect("it was just written")
    };
    vec![write(5, 4, None), write(70, 3, crs)]
}

fn layer(bytes: &[u8], table: Option<&[u8]>) {
    let Ok(layer) = Layer::from_bytes(Path::new("a.shp"), bytes, table, None) else { return };
    let values = vec![0.0; 80];
    let ground = Raster { columns: 10, rows: 8, west: 0.0, south: 0.0, cell: 1.0, values, crs: None };
    drop(layer.notes(&ground));
    drop(layer.clone().outlines());
    drop(layer.clone().thickness(&Thickness::Attribute("d".into()), &ground));
    drop(layer.thickness(&Thickness::Value(1.0), &ground));
}

fn geojson() -> Vec<Vec<u8>> {
    texts(&[
        r#"{"type":"Polygon","coordinates":[[[1,1],[7,1],[7,6],[1,6],[1,1]],[[2,2],[3,2],[3,3],[2,2]]]}"#,
        r#"{"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::31287"}},
         "features":[{"type":"Feature","properties":{"d":1.5},"geometry":{"type":"MultiPolygon","coordinates":
         [[[[0.5,0.5],[4,1],[3,5.5],[0.5,0.5]]],[[[5,5],[6,5],[6,6],[5,5]]]]}},
         {"type":"Feature","properties":{"d":2},"geometry":{"type":"GeometryCollection","geometries":
         [{"type":"Polygon","coordinates":[[[2,1],[5,1],[5,4],[2,1]]]}]}}]}"#,
    ])
}

/// Two triangles that overlap, as polygons of a shapefile (ESRI 1998).
fn shapes() -> Vec<Vec<u8>> {
    let corners = [[1.0, 1.0], [2.0, 7.0], [8.0, 1.0], [1.0, 1.0]];
    let shape = |number: i32, shift: f64| {
        let mut shape = 5i32.to_le_bytes().to_vec();
        let bounds = [1.0, 1.0, 8.0, 7.0].map(|v: f64| v + shift);
        bounds.iter().for_each(|v| shape.extend(v.to_le_bytes()));
        [1i32, 4, 0].iter().for_each(|v| shape.extend(v.to_le_bytes()));
        corners.iter().flatten().for_each(|v| shape.extend((v + shift).to_le_bytes()));
        let head = [number, shape.len() as i32 / 2].map(i32::to_be_bytes).concat();
        [head, shape].concat()
    };
    let body = [shape(1, 0.0), shape(2, 0.75)].concat();
    let mut file = [0x0000_270a, 0, 0, 0, 0, 0, (100 + body.len() as i32) / 2].map(i32::to_be_bytes).concat();
    [1000i32, 5].iter().for_each(|v| file.extend(v.to_le_bytes()));
    [1.0, 1.0, 8.75, 7.75, 0.0, 0.0, 0.0, 0.0f64].iter().for_each(|v| file.extend(v.to_le_bytes()));
    vec![[file, body].concat()]
}

fn attributes() -> Vec<Vec<u8>> {
    let mut table = vec![3, 126, 1, 1, 2, 0, 0, 0, 65, 0, 9, 0];
    table.resize(32, 0);
    table.push(b'd');
    table.resize(43, 0);
    table.push(b'N');
    table.resize(48, 0);
    table.push(8);
    table.resize(64, 0);
    vec![[&table[..], b"\r 1.5     *2,5     \x1a"].concat()]
}
