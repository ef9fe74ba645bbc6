use super::*;

fn read(text: &str) -> Result<Raster, RasterError> {
    parse(Path::new("dem.asc"), text.as_bytes(), &Declared::default(), &mut Vec::new())
}

fn refused(text: &str) -> String {
    read(text).unwrap_err().to_string()
}

const HEADER: &str = "ncols 3\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 2\nNODATA_value -1\n";

#[test]
fn rows_are_turned_south_first_and_nodata_becomes_nan() {
    let raster = read(&format!("{HEADER}1 2 3\n4 nan -1\n")).unwrap();
    assert_eq!((raster.columns, raster.rows, raster.cell), (3, 2, 2.0));
    assert_eq!((raster.west, raster.south), (10.0, 20.0));
    assert_eq!((raster.at(0, 0), raster.at(0, 1), raster.at(2, 1)), (4.0, 1.0, 3.0));
    assert!(raster.at(1, 0).is_nan() && raster.at(2, 0).is_nan());
}

#[test]
fn bytes_are_read_as_the_file_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dem.asc");
    let text = format!("{HEADER}1 2 3\n4 5 6\n");
    std::fs::write(&path, &text).unwrap();
    let crs = Crs::parse("EPSG:31287").unwrap();
    let file = Raster::read_in(&path, Some(&crs)).unwrap();
    assert_eq!(Raster::from_bytes(Path::new("dem.asc"), text.into_bytes(), Some(&crs)).unwrap(), file);
    let message = Raster::from_bytes(Path::new("a.asc"), b"hello".to_vec(), None).unwrap_err().to_string();
    assert!(message.contains("a.asc is neither a GeoTIFF nor"), "{message}");
}

#[test]
fn a_key_stands_once() {
    for (more, text) in [
        ("CellSize 20\n", "dem.asc, line 7: cellsize stands on line 5 already"),
        ("cellsize 2\n", "dem.asc, line 7: cellsize stands on line 5 already"),
        ("ncols 3 nrows 2\n", "line 7: ncols stands on line 1 already"),
        ("xllcenter 11\n", "line 7: xllcenter says again what xllcorner says on line 3"),
        ("dx 4\n", "line 7: dx says again what cellsize says on line 5"),
        ("nodata_value -9999\n", "line 7: nodata_value stands on line 6 already"),
    ] {
        let message = refused(&format!("{HEADER}{more}1 2 3\n4 5 6\n"));
        assert!(message.contains(text), "{message}");
    }
    assert!(read(&format!("{}1 2 3\n4 5 6\n", HEADER.replace("cellsize 2", "dx 2\ndy 2"))).is_ok());
}

#[test]
fn cells_that_are_infinite_are_noted_unless_that_is_nodata() {
    let noted = |header: &str| {
        let (text, mut notes) = (format!("{header}1 2 inf\n1e400 nan -9999\n"), Vec::new());
        let raster = parse(Path::new("dem.asc"), text.as_bytes(), &Declared::default(), &mut notes);
        assert_eq!(raster.unwrap().values.iter().filter(|value| value.is_nan()).count(), 4);
        notes
    };
    let notes = noted(&HEADER.replace("-1", "-9999"));
    assert!(
        matches!(&*notes, [Remark::Note(text)] if text.contains("dem.asc: 2 cells are infinite (the first on line 7)")),
        "{notes:?}"
    );
    assert_eq!(noted(&HEADER.replace("NODATA_value -1", "NODATA_value inf")).len(), 0);
}

#[test]
fn odd_but_clear_files_are_read() {
    let raster = read(
        "\u{feff}NROWS 2\r\nNCOLS 2\r\nXLLCENTER 1e1\r\nYllCenter 20\r\nCELLSIZE 2.\r\n1\r\n2 3 4\r\n\r\n",
    );
    let raster = raster.unwrap();
    assert_eq!((raster.west, raster.south, raster.values), (9.0, 19.0, vec![3.0, 4.0, 1.0, 2.0]));
    let nan =
        read(&HEADER.replace("-1", "nan").replace("nrows 2", "nrows 1").replace("cellsize", "dx")).err();
    assert!(nan.is_some_and(|e| e.to_string().contains("0 values follow")));
    let raster = read(&format!("{}nan 1 -9999", HEADER.replace("-1", "nan").replace("nrows 2", "nrows 1")));
    assert_eq!(raster.unwrap().values.iter().filter(|v| v.is_nan()).count(), 2);
}

#[test]
fn headers_in_other_orders_and_commas_are_read() {
    let expected = read(&format!("{HEADER}1.5 2 3\n4 5 -1\n")).unwrap();
    for header in [
        "3 ncols\n2 nrows\n10 xllcorner\n20 yllcorner\n2 cellsize\n-1 NODATA_value\n".to_string(),
        "ncols 3 nrows 2 xllcorner 10 yllcorner 20 cellsize 2 NODATA_value -1\n".to_string(),
        HEADER.replace(' ', " = "),
        HEADER.replace("corner 10", "corner 10,0"),
    ] {
        let found = read(&format!("{header}1,5 2 3\n4 5 -1\n")).unwrap();
        assert_eq!(format!("{found:?}"), format!("{expected:?}"), "{header}");
    }
}

#[test]
fn nodata_that_is_no_number_or_stands_beside_the_file_is_nodata() {
    let grid = |nodata: &str, values: &str| HEADER.replace("NODATA_value -1\n", nodata) + values;
    let missing = |text: &str, beside: Option<f64>| {
        let beside = Declared { nodata: beside, ..Declared::default() };
        let raster = parse(Path::new("dem.asc"), text.as_bytes(), &beside, &mut Vec::new()).unwrap();
        raster.values.iter().map(|v| u8::from(v.is_nan())).collect::<Vec<_>>()
    };
    let body = "1 -9999 -3.4028234663852886e+38\n0 5 6\n";
    assert_eq!(missing(&grid("NODATA_value null\n", body), None), [0, 0, 0, 0, 1, 1]);
    assert_eq!(missing(&grid("NODATA_value\n", body), None), [0, 0, 0, 0, 1, 0]);
    assert_eq!(missing(&grid("", body), Some(0.0)), [1, 0, 0, 0, 0, 0]);
    assert_eq!(missing(&grid("NODATA_value 5\n", body), Some(0.0)), [0, 1, 0, 0, 0, 0], "the header first");
}

#[test]
fn refusals_name_line_key_and_cure() {
    let body = "1 2 3 4 5 6";
    let without =
        |key: &str| HEADER.lines().filter(|l| !l.starts_with(key)).fold(String::new(), |a, l| a + l + "\n");
    assert!(
        refused(&format!("{}{body}", without("ncols"))).contains("line 5: the header ends without ncols")
    );
    assert!(refused(&format!("{}{body}", without("xll"))).contains("xllcorner or xllcenter"));
    let odd = HEADER.replace("nrows 2", "nrows two");
    assert!(refused(&format!("{odd}{body}")).contains("line 2: nrows is a whole number above 0, found two"));
    assert!(
        refused(&format!("{HEADER}skew 2\n{body}")).contains("line 7: unknown key `skew`; allowed are ncols")
    );
    let count = refused(&format!("{HEADER}1 2 3\n4 5"));
    assert!(count.contains("2 rows of 3 values = 6, but 5 values") && count.contains("line 8"), "{count}");
    assert!(refused(&format!("{HEADER}1 2 3 4 5 6 7")).contains("but 7 values"));
    assert!(
        refused(&format!("{HEADER}1;2;3;4;5;6"))
            .contains("line 7: `1;2;3;4;5;6` is not a number; values are separated")
    );
    assert!(refused(&format!("{HEADER}1 2 3\n4 x 6")).contains("line 8: `x` is not a number"));
    let tall = HEADER.replace("cellsize 2", "dx 2\ndy 3");
    assert!(refused(&format!("{tall}{body}")).contains("gdalwarp -tr 2 2 -r bilinear dem.asc"));
    assert!(refused(&format!("{}{body}", HEADER.replace("size 2", "size -2"))).contains("above 0, found -2"));
    assert!(refused("hello world").contains("neither a GeoTIFF nor an ESRI ASCII grid"));
    assert!(refused("1 2 3").contains("it begins with `1`"));
    assert!(refused("ncols 3 nrows\n1 2").contains("line 1: a header line holds keys, each with a value"));
    assert!(refused("").contains("gdal_translate"));
}

#[test]
fn the_system_comes_from_the_prj_beside_the_grid() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dem.asc");
    std::fs::write(&path, format!("{HEADER}1 2 3\n4 5 6\n")).unwrap();
    assert_eq!(Raster::read(&path).unwrap().crs, None);
    std::fs::write(path.with_extension("prj"), "PROJCS[\"Here\",GEOGCS[\"G\"],UNIT[\"Meter\",1.0]]").unwrap();
    assert_eq!(Raster::read(&path).unwrap().crs.map(|crs| crs.to_string()), Some("Here".into()));
    std::fs::write(path.with_extension("prj"), "Projection UTM").unwrap();
    let message = Raster::read(&path).unwrap_err().to_string();
    assert!(message.contains("dem.prj") && message.contains("crs = \"EPSG:xxxx\""), "{message}");
    let given = Crs { epsg: Some(31287), wkt: None };
    assert_eq!(Raster::read_in(&path, Some(&given)).unwrap().crs, Some(given));
}
