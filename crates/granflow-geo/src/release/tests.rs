use super::*;
use crate::raster::Crs;
use crate::raster::tests::sampled;
use crate::terrain::Curvature;
use shapefile::dbase::{FieldValue, Record, TableWriterBuilder};
use shapefile::{Point, PolygonRing};
use std::path::PathBuf;

fn ground() -> Raster {
    sampled(10, 8, |x, y| if x > 9.0 && y > 7.0 { f64::NAN } else { 100.0 + x })
}

fn ring(west: f64, south: f64, east: f64, north: f64) -> String {
    format!("[[{west},{south}],[{east},{south}],[{east},{north}],[{west},{north}],[{west},{south}]]")
}

fn feature(rings: &[String], properties: &str) -> String {
    let rings = rings.join(",");
    format!(
        r#"{{"type":"Feature","properties":{properties},"geometry":{{"type":"Polygon","coordinates":[{rings}]}}}}"#
    )
}

fn collection(features: &[String], more: &str) -> String {
    format!(r#"{{"type":"FeatureCollection",{more}"features":[{}]}}"#, features.join(","))
}

fn released(json: &str, thickness: &Thickness, terrain: &Raster) -> Result<Vec<f64>, ReleaseError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("release.geojson");
    std::fs::write(&path, json).unwrap();
    Ok(polygons(&path, thickness, terrain)?.dense(terrain.values.len()))
}

fn refused(json: &str, thickness: &Thickness) -> String {
    released(json, thickness, &ground()).unwrap_err().to_string()
}

const ONE: Thickness = Thickness::Value(1.0);

#[test]
fn geojson_in_its_forms_with_holes_and_partial_cells() {
    let rings = [ring(1.0, 1.0, 5.5, 5.0), ring(2.0, 2.0, 3.0, 3.25)];
    let bare = format!(r#"{{"type":"MultiPolygon","coordinates":[[{}]]}}"#, rings.join(","));
    let single = feature(&rings, "null");
    let several = collection(std::slice::from_ref(&single), "");
    for json in [&bare, &single, &several] {
        let height = released(json, &Thickness::Value(0.5), &ground()).unwrap();
        assert!((height.iter().sum::<f64>() - 0.5 * (18.0 - 1.25)).abs() < 1e-12);
        assert_eq!((height[10 + 1], height[20 + 2], height[30 + 2], height[20 + 5]), (0.5, 0.0, 0.375, 0.25));
        let layer = Layer::from_bytes(Path::new("a.geojson"), json.as_bytes(), None, None).unwrap();
        let by_bytes = layer.thickness(&Thickness::Value(0.5), &ground()).unwrap();
        assert_eq!(by_bytes.dense(80), height);
    }
}

#[test]
fn the_thickest_counts_where_polygons_overlap() {
    let (thin, thick) = (
        feature(&[ring(1.0, 1.0, 4.0, 4.0)], r#"{"D":1}"#),
        feature(&[ring(2.5, 2.0, 6.0, 6.0)], r#"{"D":"2.5"}"#),
    );
    let attribute = Thickness::Attribute("d".into());
    for order in [[thin.clone(), thick.clone()], [thick.clone(), thin.clone()]] {
        let height = released(&collection(&order, ""), &attribute, &ground()).unwrap();
        let volume = 2.5 * 14.0 + 1.0 * (9.0 - 1.5 * 2.0);
        assert!((height.iter().sum::<f64>() - volume).abs() < 1e-7, "{}", height.iter().sum::<f64>());
        assert!((height[30 + 3] - 2.5).abs() < 1e-7 && (height[30 + 2] - 1.75).abs() < 1e-7);
    }
    let twice = released(&collection(&[thin.clone(), thin], ""), &attribute, &ground()).unwrap();
    assert!((twice.iter().sum::<f64>() - 9.0).abs() < 1e-7 && twice.iter().all(|h| *h <= 1.0));
}

fn shapefile_of(folder: &Path, rings: Vec<PolygonRing<Point>>, thickness: Option<f64>) -> PathBuf {
    let path = folder.join("release.shp");
    let name = |name: &str| name.try_into().unwrap();
    let table = TableWriterBuilder::new().add_character_field(name("Name"), 20).add_numeric_field(
        name("thickness"),
        10,
        3,
    );
    let mut writer = shapefile::Writer::from_path(&path, table).unwrap();
    let mut record = Record::default();
    record.insert("Name".into(), FieldValue::Character(Some("Lahn".into())));
    record.insert("thickness".into(), FieldValue::Numeric(thickness));
    writer.write_shape_and_record(&shapefile::Polygon::with_rings(rings), &record).unwrap();
    path
}

fn corners(west: f64, south: f64, east: f64, north: f64) -> Vec<Point> {
    [(west, south), (west, north), (east, north), (east, south), (west, south)]
        .map(|(x, y)| Point::new(x, y))
        .to_vec()
}

#[test]
fn shapefiles_with_islands_in_holes_and_attributes() {
    let folder = tempfile::tempdir().unwrap();
    let rings = vec![
        PolygonRing::Inner(corners(2.0, 2.0, 5.0, 5.0)),
        PolygonRing::Outer(corners(1.0, 1.0, 7.0, 6.0)),
        PolygonRing::Outer(corners(3.0, 3.0, 4.0, 4.0)),
    ];
    let path = shapefile_of(folder.path(), rings, Some(1.25));
    let height = polygons(&path, &Thickness::Attribute("Thickness".into()), &ground()).unwrap().dense(80);
    assert!((height.iter().sum::<f64>() - 1.25 * (30.0 - 9.0 + 1.0)).abs() < 1e-12);
    assert_eq!((height[33], height[22], height[11]), (1.25, 0.0, 1.25));

    let [shapes, table] = ["shp", "dbf"].map(|kind| std::fs::read(path.with_extension(kind)).unwrap());
    let layer = |table| Layer::from_bytes(Path::new("a.shp"), &shapes, table, None);
    let attribute = Thickness::Attribute("Thickness".into());
    let by_bytes = layer(Some(&table)).unwrap().thickness(&attribute, &ground()).unwrap().dense(80);
    assert_eq!(by_bytes, height);
    assert_eq!(layer(None).unwrap().outlines().unwrap(), Layer::read(&path).unwrap().outlines().unwrap());
    let message = layer(None).unwrap().thickness(&attribute, &ground()).unwrap_err().to_string();
    assert!(message.contains("a.shp has no attribute `Thickness`") && message.contains(".dbf"), "{message}");

    let message =
        polygons(&path, &Thickness::Attribute("thicknes".into()), &ground()).unwrap_err().to_string();
    assert!(message.contains("`thicknes`, did you mean `thickness`?; it has Name, thickness"), "{message}");
    let message = polygons(&path, &Thickness::Attribute("Name".into()), &ground()).unwrap_err().to_string();
    assert!(message.contains("feature 1: Name = `Lahn` is not a thickness"), "{message}");

    std::fs::remove_file(path.with_extension("dbf")).unwrap();
    assert!(polygons(&path, &ONE, &ground()).is_ok());
    let message = polygons(&path, &Thickness::Attribute("d".into()), &ground()).unwrap_err().to_string();
    assert!(message.contains(".dbf file missing"), "{message}");
}

#[test]
fn refusals_of_geojson_name_the_feature_and_the_cure() {
    let square = feature(&[ring(1.0, 1.0, 4.0, 4.0)], r#"{"depth":-2}"#);
    let attribute = |name: &str| Thickness::Attribute(name.into());
    assert!(refused(&square, &attribute("depth")).contains("feature 1: depth = `-2` is not a thickness"));
    assert!(refused(&square, &Thickness::Value(f64::NAN)).contains("thickness = `NaN`"));
    assert!(refused(&square, &Thickness::Value(0.0)).contains("releases nothing"));
    assert!(refused(&square, &attribute("dept")).contains("did you mean `depth`?"));
    assert!(refused(&collection(&[], ""), &ONE).contains("no polygon"));
    assert!(refused(r#"{"type":"Point","coordinates":[1,2]}"#, &ONE).contains("feature 1: it is a point"));
    assert!(
        refused("x,y\n1,2", &ONE).contains("neither a shapefile (.shp) nor GeoJSON, it begins with `x,y")
    );
    assert!(refused(r#"{"type":"Polygon","coordinates":"#, &ONE).contains("cannot be read"));
    let short = refused(&feature(&["[[1,1],[5],[5,1],[1,1]]".to_string()], "{}"), &ONE);
    assert!(short.contains("feature 1: a corner is [x, y], found [5.0]"), "{short}");
    let far = refused(&feature(&["[[1,1],[1e300,5],[5,1],[1,1]]".to_string()], "{}"), &ONE);
    assert!(far.contains("feature 1: a corner of it lies at (1000") && far.contains("no place"), "{far}");
    let bow = feature(&["[[1,1],[5,5],[5,1],[1,4],[1,1]]".to_string()], "{}");
    let message = refused(&bow, &ONE);
    assert!(
        message.contains("feature 1")
            && message.contains("self-intersection")
            && message.contains("-makevalid")
    );
    let crs = r#""crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::32632"}},"#;
    let terrain = Raster { crs: Some(Crs::parse("EPSG:31287").unwrap()), ..ground() };
    let message =
        released(&collection(std::slice::from_ref(&square), crs), &ONE, &terrain).unwrap_err().to_string();
    assert!(message.contains("EPSG:32632 (WGS 84 / UTM zone 32N)") && message.contains("datum"), "{message}");
    assert!(
        message.contains("ogr2ogr -t_srs EPSG:31287") && message.contains("_reprojected.shp "),
        "{message}"
    );
    assert!(!message.contains(" release_reprojected"), "what is made is called after the file: {message}");
    let unknown = collection(&[square], r#""crs":{"type":"name","properties":{"name":"ESRI:102100"}},"#);
    assert!(refused(&unknown, &ONE).contains("ogr2ogr -a_srs EPSG:xxxx"), "its system is not dropped");
}

/// UTM zone 33 on ETRS89 as ArcGIS writes it.
const ZONE_33: &str = r#"PROJCS["ETRS_1989_UTM_Zone_33N",GEOGCS["GCS_ETRS_1989",DATUM["D_ETRS_1989",SPHEROID["GRS_1980",6378137.0,298.257222101]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["False_Easting",500000.0],PARAMETER["False_Northing",0.0],PARAMETER["Central_Meridian",15.0],PARAMETER["Scale_Factor",0.9996],PARAMETER["Latitude_Of_Origin",0.0],UNIT["Meter",1.0]]"#;

#[test]
fn the_prj_of_a_shapefile_is_compared_and_never_dropped() {
    let folder = tempfile::tempdir().unwrap();
    let path = shapefile_of(folder.path(), vec![PolygonRing::Outer(corners(1.0, 1.0, 7.0, 6.0))], None);
    let on = |prj: &str, terrain: Option<&str>| {
        std::fs::write(path.with_extension("prj"), prj).unwrap();
        let crs = terrain.map(|text| Crs::parse(text).unwrap());
        let template = Raster { crs, ..ground() };
        let layer = Layer::read(&path).map_err(|error| error.to_string())?;
        let notes = layer.notes(&template);
        layer.thickness(&ONE, &template).map(|_| notes).map_err(|error| error.to_string())
    };
    let vertical =
        format!("{ZONE_33},VERTCS[\"EVRF\",VDATUM[\"E\"],PARAMETER[\"Direction\",1.0],UNIT[\"Meter\",1.0]]");
    for prj in [ZONE_33, &vertical] {
        assert_eq!(on(prj, Some("EPSG:25833")), Ok(Vec::new()));
        let message = on(prj, Some("EPSG:25832")).unwrap_err();
        assert!(
            message.contains("15 against 9") && message.contains("ogr2ogr -t_srs EPSG:25832"),
            "{message}"
        );
        assert!(on(prj, Some("EPSG:32633")).unwrap_err().contains("datum D_ETRS_1989 against WGS_1984"));
        assert!(on(prj, None).unwrap()[0].text().contains("the terrain says no system"));
    }
    let message = on("+proj=utm +zone=33 +ellps=GRS80", Some("EPSG:25832")).unwrap_err();
    assert!(message.contains("gdalsrsinfo -o wkt1_esri \"+proj=utm +zone=33 +ellps=GRS80\" >"), "{message}");
    let own = ZONE_33.replace("D_ETRS_1989", "D_Mine");
    let notes = on(&own, Some("EPSG:25833")).unwrap();
    assert!(notes[0].text().contains("could not be decided (datum D_Mine against"), "{notes:?}");
    assert!(on("", Some("EPSG:25833")).unwrap()[0].text().contains("says no coordinate reference system"));
    let feet = ZONE_33.replace("UNIT[\"Meter\",1.0]", "UNIT[\"Foot\",0.3048]");
    assert!(on(&feet, None).unwrap_err().contains("which is not in metres"));
}

#[test]
fn what_a_thicker_polygon_holds_adds_nothing_and_its_hole_is_no_part_of_it() {
    let around = feature(&[ring(0.0, 0.0, 8.0, 7.0), ring(3.0, 3.0, 6.0, 6.0)], r#"{"d":2}"#);
    let squares = [(1.0, 1.0), (4.0, 4.0), (8.5, 1.0)];
    let small = squares.map(|(x, y)| feature(&[ring(x, y, x + 1.0, y + 1.0)], r#"{"d":1}"#));
    let all = collection(&[&[around], &small[..]].concat(), "");
    let height = released(&all, &Thickness::Attribute("d".into()), &ground()).unwrap();
    assert_eq!((height[11], height[44], height[33]), (2.0, 1.0, 0.0));
    assert!((height.iter().sum::<f64>() - (2.0 * (56.0 - 9.0) + 1.0 + 1.0)).abs() < 1e-12);
}

#[test]
fn a_bow_tie_without_area_is_refused_beside_sound_polygons() {
    let folder = tempfile::tempdir().unwrap();
    let bow =
        [(1.0, 1.0), (3.0, 3.0), (3.0, 1.0), (1.0, 3.0), (1.0, 1.0)].map(|(x, y)| Point::new(x, y)).to_vec();
    let rings = vec![PolygonRing::Outer(corners(4.0, 4.0, 7.0, 6.0)), PolygonRing::Outer(bow)];
    let message =
        polygons(&shapefile_of(folder.path(), rings, None), &ONE, &ground()).unwrap_err().to_string();
    assert!(message.contains("feature 1") && message.contains("-makevalid"), "{message}");
    let mut odd = corners(1.0, 1.0, 3.0, 3.0);
    odd[1].x = f64::NAN;
    let path = shapefile_of(folder.path(), vec![PolygonRing::Outer(odd)], None);
    let message = polygons(&path, &ONE, &ground()).unwrap_err().to_string();
    assert!(message.contains("a corner of it is not a number"), "{message}");
}

#[test]
fn deleted_rows_and_shapes_that_are_null_are_left_out_and_counted() {
    use super::table::tests::table;
    let folder = tempfile::tempdir().unwrap();
    let squares = [1.0, 3.0, 5.0].map(|west| corners(west, 1.0, west + 1.0, 2.0));
    let path = folder.path().join("release.shp");
    let mut writer = shapefile::ShapeWriter::from_path(&path).unwrap();
    for square in squares {
        writer.write_shape(&shapefile::Polygon::new(PolygonRing::Outer(square))).unwrap();
    }
    drop(writer);
    let with = |rows: &[&str]| {
        std::fs::write(path.with_extension("dbf"), table("thick", 'N', rows)).unwrap();
        let layer = Layer::read(&path).unwrap();
        let notes = layer.notes(&ground());
        let height = layer.thickness(&Thickness::Attribute("thick".into()), &ground());
        height.map(|height| (height.dense(80), notes)).map_err(|error| error.to_string())
    };
    let (height, notes) = with(&[" 1,5", "*2", " 3"]).unwrap();
    assert_eq!((height[11], height[13], height[15]), (1.5, 0.0, 3.0));
    assert!(notes[0].text().contains("left out 1 of its features"), "{notes:?}");
    assert!(with(&["*1", " 2", " "]).unwrap_err().contains("feature 3: thick is not given (NULL)"));
    assert!(with(&[" 1", " **", " 2"]).unwrap_err().contains("feature 2: thick is not given (NULL)"));
    assert!(with(&[" 1", " x", " 2"]).unwrap_err().contains("feature 2: thick = `x` is not a thickness"));
    let null = r#"{"type":"Feature","geometry":null,"properties":{}}"#.to_string();
    let square = feature(&[ring(1.0, 1.0, 4.0, 4.0)], r#"{"d":2}"#);
    assert!(released(&collection(&[null, square], ""), &Thickness::Attribute("d".into()), &ground()).is_ok());
}

#[test]
fn a_ring_that_touches_itself_is_no_fault() {
    let touching = feature(&["[[1,1],[3,3],[5,1],[5,5],[3,3],[1,5],[1,1]]".to_string()], "{}");
    let height = released(&touching, &ONE, &ground()).unwrap();
    assert!((height.iter().sum::<f64>() - 8.0).abs() < 1e-12);
}

#[test]
fn releases_beyond_the_terrain_show_both_boxes() {
    let far = refused(&feature(&[ring(500.0, 500.0, 510.0, 505.0)], "{}"), &ONE);
    assert!(
        far.contains("all of the release") && far.contains("release x 500 to 510, y 500 to 505"),
        "{far}"
    );
    assert!(far.contains("terrain x 0 to 10, y 0 to 8") && far.contains("ogr2ogr -t_srs"), "{far}");
    let terrain = Raster { west: 4e5, south: 3e5, crs: Some(Crs::parse("EPSG:31287").unwrap()), ..ground() };
    let degrees =
        released(&feature(&[ring(11.5, 47.0, 11.6, 47.1)], "{}"), &ONE, &terrain).unwrap_err().to_string();
    assert!(degrees.contains("looks like degrees") && degrees.contains("-t_srs EPSG:31287"), "{degrees}");
    let edge = refused(&feature(&[ring(-1.0, 1.0, 3.0, 2.0)], "{}"), &ONE);
    assert!(edge.contains("25.00 % of the release lies beyond the terrain's edge"), "{edge}");
    let gap = refused(&feature(&[ring(8.0, 6.0, 10.0, 8.0)], "{}"), &ONE);
    assert!(
        gap.contains("25.00 % of the release lies on cells without a value")
            && gap.contains("gdal_fillnodata")
    );
}

#[test]
fn thickness_rasters_keep_their_volume() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("thickness.tif");
    let heap = Raster {
        west: 2.25,
        south: 1.5,
        cell: 0.75,
        ..sampled(4, 3, |x, y| if x < 1.0 { f64::NAN } else { x * y })
    };
    heap.write_geotiff(&path).unwrap();
    let height = raster(&path, &ground()).unwrap().dense(80);
    let volume = 0.5625 * heap.values.iter().filter(|v| !v.is_nan()).sum::<f64>();
    assert!((height.iter().sum::<f64>() - volume).abs() < 1e-12);
    let same = Raster { values: ground().values.iter().map(|b| 0.01 * b).collect(), ..ground() };
    same.write_geotiff(&path).unwrap();
    assert_eq!(raster(&path, &ground()).unwrap().get(13), f64::from((0.01f64 * 103.5) as f32));

    Raster { values: heap.values.iter().map(|v| v - 1.0).collect(), ..heap.clone() }
        .write_geotiff(&path)
        .unwrap();
    let message = raster(&path, &ground()).unwrap_err().to_string();
    assert!(message.contains("the thickness at (3.375, 1.875) is -0.25 m"), "{message}");
    Raster { west: 9.0, ..heap.clone() }.write_geotiff(&path).unwrap();
    assert!(raster(&path, &ground()).unwrap_err().to_string().contains("beyond the terrain's edge"));
    let far = Raster { west: 6.5e5, south: 5.2e6, ..heap.clone() };
    far.write_geotiff(&path).unwrap();
    let terrain = Raster { crs: Some(Crs::parse("EPSG:31287").unwrap()), ..ground() };
    let message = raster(&path, &terrain).unwrap_err().to_string();
    assert!(message.contains("gdalwarp -t_srs EPSG:31287 -s_srs EPSG:xxxx"), "{message}");
    assert!(message.contains("thickness.tif") && !message.contains("ogr2ogr"), "{message}");
    let north = Raster { west: 4e5, south: 3e5, ..terrain };
    Raster { west: 11.0, south: 47.0, ..heap.clone() }.write_geotiff(&path).unwrap();
    let message = raster(&path, &north).unwrap_err().to_string();
    assert!(message.contains("looks like degrees") && message.contains("gdalwarp"), "{message}");
    Raster { values: vec![0.0; 12], ..heap }.write_geotiff(&path).unwrap();
    assert!(raster(&path, &ground()).unwrap_err().to_string().contains("releases nothing"));
}

#[test]
fn caps_are_parabolic_and_lie_on_the_terrain() {
    let height = cap(2.0, [4.5, 3.5], 2.0, &ground()).unwrap();
    assert_eq!([34, 35, 36, 45].map(|cell| height.get(cell)), [2.0, 1.5, 0.0, 1.0]);
    let away = cap(2.0, [40.0, 3.5], 2.0, &ground()).unwrap_err().to_string();
    assert!(away.contains("within 2 m of its centre (40, 3.5)") && away.contains("x 0 to 10"), "{away}");
    assert!(
        cap(-1.0, [4.5, 3.5], 2.0, &ground())
            .unwrap_err()
            .to_string()
            .contains("height must be above 0, found -1")
    );
}

#[test]
fn a_cap_that_the_terrain_does_not_hold_is_refused() {
    let cut = |centre, radius| cap(2.0, centre, radius, &ground()).unwrap_err().to_string();
    // The centre is on the western edge: half of the volume lies beyond it.
    let half = cut([0.0, 3.5], 2.0);
    assert!(half.contains("the cap loses 50.00 % of its volume beyond the terrain's edge"), "{half}");
    assert!(half.contains("cap x -2 to 2, y 1.5 to 5.5\n  terrain x 0 to 10, y 0 to 8"), "{half}");
    // The circle reaches the centre of the cell in the corner, (9.5, 7.5), and none beyond the edge.
    let gap = cut([8.5, 6.5], 1.45);
    assert!(
        gap.contains("of its volume on cells without a value") && gap.contains("gdal_fillnodata"),
        "{gap}"
    );
    for radius in [1e3, 1e12, 1e300] {
        assert!(cut([4.5, 3.5], radius).contains("terrain x 0 to 10"), "{radius}");
    }
    // Circles that no centre of a cell beyond the edge lies in lose nothing.
    for (centre, radius) in [([0.5, 3.5], 1.0), ([5.0, 4.0], 4.2), ([4.3, 3.9], 3.0)] {
        assert!(cap(2.0, centre, radius, &ground()).is_ok(), "{centre:?} {radius}");
    }
}

#[test]
fn a_normal_thickness_holds_more_than_a_vertical_one() {
    let terrain = Terrain::new(sampled(6, 6, |x, _| 0.75 * x), Curvature::Off);
    let one = Sparse::of([1.0; 36]);
    let normal = per_plan_area(one.clone(), &terrain, Measured::Normal).dense(36);
    assert!(normal.iter().all(|h| (h - 1.25).abs() < 1e-12));
    assert_eq!(per_plan_area(one.clone(), &terrain, Measured::Vertical), one);
}

#[test]
fn a_real_mountain() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/avaKot");
    if !data.join("dem.asc").exists() {
        return println!("skipped: no {}", data.display());
    }
    let crs = Crs::parse("EPSG:31287").unwrap();
    let dem = Raster::read_in(&data.join("dem.asc"), Some(&crs)).unwrap();
    assert_eq!((dem.columns, dem.rows), (439, 517));
    let height =
        polygons(&data.join("release.shp"), &Thickness::Attribute("thickness".into()), &dem).unwrap();
    let area = height.iter().map(|(_, h)| h).sum::<f64>() * dem.cell * dem.cell;
    let layer = Layer::read(&data.join("release.shp")).unwrap();
    let exact: f64 = layer.features.iter().flat_map(|f| &f.polygons).map(Polygon::unsigned_area).sum();
    assert!((area / exact - 1.0).abs() < 1e-9, "{area} {exact}");
    assert!((area - 15_188.0).abs() < 1.0, "{area}");
    let terrain = Terrain::new(dem, Curvature::Length(20.0));
    let steep = terrain.steepness(60f64.to_radians());
    assert!(steep.steeper > 700 && steep.max_slope < 89f64.to_radians(), "{steep:?}");
}
