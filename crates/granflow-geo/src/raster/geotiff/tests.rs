//! Reading and writing GeoTIFF, and what a file says is absent.

use super::super::tests::sampled;
use super::keys;
use crate::Remark;
use crate::raster::{Crs, Raster, RasterError, Reading};
use geotiff_writer::{Compression, GeoKeyValue, GeoTiffBuilder, GeoTransform, WriteSample};
use ndarray::Array2;
use std::path::Path;

fn hill() -> Raster {
    let hill = sampled(7, 5, |x, y| if x > 6.0 && y < 1.0 { f64::NAN } else { 100.0 + x * x - 3.0 * y });
    Raster { west: 176_973.437_998_359_2, south: 376_237.836, cell: 4.997_688_906_601, ..hill }
}

fn written<T: WriteSample + geotiff_writer::NumericSample>(
    build: impl Fn(GeoTiffBuilder) -> GeoTiffBuilder,
    sample: impl Fn(f64) -> T,
) -> Result<Raster, RasterError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dem.tif");
    let image = Array2::from_shape_fn((2, 3), |(row, column)| sample((10 * row + column) as f64));
    let place = GeoTransform::from_origin_and_pixel_size(500.0, 900.0, 2.0, -2.0);
    build(GeoTiffBuilder::new(3, 2).transform(place)).write_2d(&path, image.view()).unwrap();
    Raster::read(&path)
}

fn refused(build: impl Fn(GeoTiffBuilder) -> GeoTiffBuilder) -> String {
    written(build, |v| v as f32).unwrap_err().to_string()
}

#[test]
fn what_is_written_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hill.tif");
    let definition = "PROJCS[\"Höhe | Lambert\",GEOGCS[\"G\"],UNIT[\"Meter\",1.0]]";
    for text in [None, Some("EPSG:31287"), Some(definition)] {
        let raster = Raster { crs: text.map(|text| Crs::parse(text).unwrap()), ..hill() };
        raster.write_geotiff(&path).unwrap();
        let back = Raster::read(&path).unwrap();
        assert_eq!((back.columns, back.rows, back.cell, back.west), (7, 5, raster.cell, raster.west));
        assert!((back.south - raster.south).abs() < 1e-9);
        for (a, b) in raster.values.iter().zip(&back.values) {
            assert!(*b == f64::from(*a as f32) || a.is_nan() && b.is_nan(), "{a} {b}");
        }
        assert_eq!(back.crs.as_ref().and_then(|c| c.epsg), raster.crs.as_ref().and_then(|c| c.epsg));
        assert_eq!(back.crs.is_some(), raster.crs.is_some());
    }
    assert_eq!(Raster::read(&path).unwrap().crs.unwrap().to_string(), "H_he _ Lambert");
    let bytes = Raster::from_bytes(&path, std::fs::read(&path).unwrap(), None).unwrap();
    assert_eq!(format!("{bytes:?}"), format!("{:?}", Raster::read(&path).unwrap()), "NaN is not NaN");
    let nowhere = hill().write_geotiff(&folder.path().join("no/such/folder.tif")).unwrap_err().to_string();
    assert!(nowhere.contains("folder.tif cannot be written"), "{nowhere}");
}

#[test]
fn every_sample_type_and_compression_is_read() {
    let expected = vec![10.0, 11.0, f64::NAN, 0.0, 1.0, 2.0];
    let check = |raster: Result<Raster, RasterError>| {
        let raster = raster.unwrap();
        assert_eq!((raster.west, raster.south, raster.cell), (500.0, 896.0, 2.0));
        let same = raster.values.iter().zip(&expected).all(|(a, b)| a == b || a.is_nan() && b.is_nan());
        assert!(same, "{:?}", raster.values);
    };
    let nodata = |builder: GeoTiffBuilder| builder.nodata("12");
    check(written(nodata, |v| v as u8));
    check(written(nodata, |v| v as i8));
    check(written(nodata, |v| v as u16));
    check(written(nodata, |v| v as i16));
    check(written(nodata, |v| v as u32));
    check(written(nodata, |v| v as i32));
    check(written(nodata, |v| v as u64));
    check(written(nodata, |v| v as i64));
    check(written(nodata, |v| v));
    for compression in [Compression::Lzw, Compression::Deflate, Compression::Zstd] {
        check(written(|b| nodata(b).compression(compression).tile_size(16, 16), |v| v as f32));
    }
    check(written(|b| nodata(b).tiff_variant(geotiff_writer::TiffVariant::BigTiff), |v| v as f32));
    let south_up = GeoTransform::from_origin_and_pixel_size(500.0, 896.0, 2.0, 2.0);
    let raster = written(|b| nodata(b).transform(south_up), |v| v as f32).unwrap();
    assert_eq!((raster.south, raster.at(1, 0), raster.at(1, 1)), (896.0, 1.0, 11.0));
}

#[test]
fn refusals_name_the_cure() {
    let degrees = GeoTransform::from_origin_and_pixel_size(11.5, 47.5, 1e-4, -1e-4);
    let message = refused(|b| b.geographic_epsg(4258).transform(degrees));
    assert!(message.contains("EPSG:4258") && message.contains("gdalwarp -t_srs EPSG:32632"), "{message}");
    let tall = GeoTransform::from_origin_and_pixel_size(500.0, 900.0, 2.0, -3.0);
    assert!(refused(|b| b.transform(tall)).contains("gdalwarp -tr 2 2"));
    let turned = GeoTransform { skew_x: 0.5, ..tall };
    assert!(refused(|b| b.transform(turned)).contains("rotated or mirrored"));
    let feet = refused(|b| b.projected_epsg(2264).geokey(keys::LINEAR_UNIT, GeoKeyValue::Short(9003)));
    assert!(feet.contains("0.3048006") && feet.contains("-tr 0.61 0.61"), "{feet}");
    let unnamed = refused(|b| b.projected_epsg(keys::USER_DEFINED));
    assert!(unnamed.contains("gdal_edit.py -a_srs EPSG:xxxx"), "{unnamed}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.tif");
    std::fs::write(&path, b"II*\0\x08\0").unwrap();
    assert!(Raster::read(&path).unwrap_err().to_string().contains("cut.tif: the GeoTIFF cannot be read"));
    assert!(Raster::read(&folder.path().join("none.tif")).unwrap_err().to_string().contains("none.tif"));
}

/// The bytes of a TIFF of 4 x 2 cells with the values 1 to 8.
fn small(build: impl Fn(GeoTiffBuilder) -> GeoTiffBuilder) -> Vec<u8> {
    written_as([4, 2], build, |column, row| (4 * row + column + 1) as f32)
}

fn written_as(
    [columns, rows]: [usize; 2],
    build: impl Fn(GeoTiffBuilder) -> GeoTiffBuilder,
    value: impl Fn(usize, usize) -> f32,
) -> Vec<u8> {
    let mut file = std::io::Cursor::new(Vec::new());
    let place = GeoTransform::from_origin_and_pixel_size(500.0, 900.0, 2.0, -2.0);
    let image = Array2::from_shape_fn((rows, columns), |(row, column)| value(column, row));
    let builder = build(GeoTiffBuilder::new(columns as u32, rows as u32).transform(place));
    builder.write_2d_to(&mut file, image.view()).unwrap();
    file.into_inner()
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

/// Appends a mask of 4 x 2 cells as an image of its own.
fn masked(mut bytes: Vec<u8>, mask: [u8; 8]) -> Vec<u8> {
    let data = bytes.len() as u32;
    bytes.extend(mask);
    let directory = bytes.len() as u32;
    let entries = [
        (254, 4),
        (256, 4),
        (257, 2),
        (258, 8),
        (259, 1),
        (262, 4),
        (273, data),
        (277, 1),
        (278, 2),
        (279, 8),
    ];
    bytes.extend((entries.len() as u16).to_le_bytes());
    for (tag, value) in entries {
        bytes.extend((tag as u16).to_le_bytes());
        bytes.extend(4u16.to_le_bytes());
        bytes.extend(1u32.to_le_bytes());
        bytes.extend(value.to_le_bytes());
    }
    bytes.extend(0u32.to_le_bytes());
    let first = word(&bytes, 4) as usize;
    let count = u16::from_le_bytes([bytes[first], bytes[first + 1]]) as usize;
    bytes[first + 2 + 12 * count..][..4].copy_from_slice(&directory.to_le_bytes());
    bytes
}

fn read(bytes: Vec<u8>) -> Raster {
    Raster::from_bytes(Path::new("dem.tif"), bytes, None).unwrap()
}

/// Which values are absent, the first row of the file first.
fn absent(raster: &Raster) -> Vec<bool> {
    let row = |row: usize| (0..raster.columns).map(move |column| raster.at(column, row).is_nan());
    (0..raster.rows).rev().flat_map(row).collect()
}

#[test]
fn blocks_that_are_not_stored_are_nodata_or_without_nodata_zero() {
    // The second tile holds zeros only and is left out.
    let ground = |column: usize, _| if column < 16 { 7.0 } else { 0.0 };
    let tiles = |nodata: Option<&str>| {
        let tiled = |builder: GeoTiffBuilder| builder.tile_size(16, 16).sparse(true);
        read(written_as([32, 16], |b| nodata.iter().fold(tiled(b), |b, value| b.nodata(value)), ground))
    };
    assert_eq!(absent(&tiles(Some("-9999"))), (0..512).map(|k| k % 32 >= 16).collect::<Vec<_>>());
    let zero = tiles(None);
    assert!((0..32).all(|column| zero.at(column, 1) == f64::from(ground(column, 0))));
}

#[test]
fn masks_inside_and_beside_hide_values() {
    let mask = [0, 255, 255, 255, 255, 255, 255, 0];
    let expected = mask.map(|opaque| opaque == 0);
    let bytes = small(|b| b);
    assert_eq!(absent(&read(masked(bytes.clone(), mask))), expected);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dem.tif");
    std::fs::write(&path, &bytes).unwrap();
    let beside = Array2::from_shape_vec((2, 4), mask.to_vec()).unwrap();
    GeoTiffBuilder::new(4, 2).write_2d(folder.path().join("dem.tif.msk"), beside.view()).unwrap();
    assert_eq!(absent(&Raster::read(&path).unwrap()), expected);
    let grid = "ncols 4\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3 4\n5 6 7 8\n";
    let path = folder.path().join("dem.asc");
    std::fs::write(&path, grid).unwrap();
    std::fs::rename(folder.path().join("dem.tif.msk"), folder.path().join("dem.asc.msk")).unwrap();
    assert_eq!(absent(&Raster::read(&path).unwrap()), expected);
}

#[test]
fn the_sidecar_comes_before_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dem.tif");
    std::fs::write(&path, small(|b| b.projected_epsg(25832).nodata("8"))).unwrap();
    let sidecar = "<PAMDataset><SRS>EPSG:31287</SRS><GeoTransform>10,5,0,90,0,-5</GeoTransform>\
        <PAMRasterBand band=\"1\"><NoDataValue>1</NoDataValue><UnitType>ft</UnitType><Scale>10</Scale></PAMRasterBand></PAMDataset>";
    std::fs::write(folder.path().join("dem.tif.aux.xml"), sidecar).unwrap();
    let Reading { raster, notes, .. } = Reading::of(&path, None).unwrap();
    assert_eq!((raster.west, raster.south, raster.cell), (10.0, 80.0, 5.0));
    assert_eq!(raster.crs.as_ref().and_then(|crs| crs.epsg), Some(31287));
    assert_eq!(absent(&raster), [true, false, false, false, false, false, false, false]);
    assert!((raster.at(3, 0) - 24.384).abs() < 1e-12, "{}", raster.at(3, 0));
    assert_eq!(notes.len(), 2, "{notes:?}");
}

#[test]
fn heights_in_feet_become_metres_wherever_it_is_said() {
    let metres = |build: fn(GeoTiffBuilder) -> GeoTiffBuilder, crs: Option<&str>| {
        let crs = crs.map(|text| Crs::parse(text).unwrap());
        let bytes = small(|b| build(b.projected_epsg(26910)));
        Raster::from_bytes(Path::new("dem.tif"), bytes, crs.as_ref()).unwrap().at(0, 1)
    };
    assert!((metres(|b| b.geokey(4099, GeoKeyValue::Short(9002)), None) - 0.3048).abs() < 1e-15);
    let survey = 1200.0 / 3937.0;
    assert!((metres(|b| b.geokey(4096, GeoKeyValue::Short(6360)), None) - survey).abs() < 1e-15);
    assert!((metres(|b| b, Some("EPSG:26910+6360")) - survey).abs() < 1e-15);
    assert_eq!(metres(|b| b.geokey(4096, GeoKeyValue::Short(5703)), None), 1.0);
}

#[test]
fn a_system_by_parameters_is_the_one_with_the_code() {
    let utm = |meridian: f64| {
        let double = |value: f64| GeoKeyValue::Double(vec![value]);
        let keys = [(3080, meridian), (3081, 0.0), (3082, 500_000.0), (3083, 0.0), (3092, 0.9996)];
        let bytes = small(|builder| {
            let builder = builder.projected_epsg(keys::USER_DEFINED).geokey(2048, GeoKeyValue::Short(4258));
            let builder = builder.geokey(3075, GeoKeyValue::Short(1)).geokey(3076, GeoKeyValue::Short(9001));
            keys.iter().fold(builder, |builder, (key, value)| builder.geokey(*key, double(*value)))
        });
        Raster::from_bytes(Path::new("dem.tif"), bytes, Some(&Crs::parse("EPSG:25832").unwrap()))
    };
    assert_eq!(utm(9.0).unwrap().crs.and_then(|crs| crs.epsg), Some(25832));
    assert!(utm(15.0).unwrap_err().to_string().contains("longitude of origin 15 against 9"));
}

#[test]
fn an_image_that_its_file_cannot_hold_is_refused_before_room_is_made() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dem.tif");
    hill().write_geotiff(&path).unwrap();
    let whole = std::fs::read(&path).unwrap();
    // The first two entries of the first directory are the columns and the rows.
    let first = u32::from_le_bytes(whole[4..8].try_into().unwrap()) as usize + 2 + 8;
    for (columns, found) in [(u32::MAX, "5 rows of 4294967295 cells"), (0, "5 rows of 0 cells")] {
        let mut bytes = whole.clone();
        bytes[first..first + 4].copy_from_slice(&columns.to_le_bytes());
        let message = Raster::from_bytes(&path, bytes, None).unwrap_err().to_string();
        assert!(message.contains(found) && message.contains("fetch it again"), "{message}");
    }
}

#[test]
fn cells_that_are_infinite_are_noted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dem.tif");
    let ground = sampled(4, 3, |x, _| if x < 1.0 { f64::INFINITY } else { 900.0 + x });
    ground.write_geotiff(&path).unwrap();
    let reading = crate::raster::Reading::of(&path, None).unwrap();
    assert!(reading.raster.at(0, 0).is_nan() && reading.raster.at(1, 0) == 901.5);
    assert!(
        matches!(&*reading.notes, [Remark::Note(text)] if text.contains("dem.tif: 3 cells are infinite")),
        "{:?}",
        reading.notes
    );
}
