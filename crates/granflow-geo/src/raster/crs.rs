//! Coordinate reference systems, as far as a raster must know its own: an EPSG code, a WKT text, or both.

use super::scale::Scale;
use super::system::{Comparison, HORIZONTAL, Heights, Kind, System};
use super::wkt::Node;
use thiserror::Error;

/// A coordinate reference system (CRS) as it was given, carried through to every output.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Crs {
    /// The EPSG code, where one is known.
    pub epsg: Option<u32>,
    /// The definition in well-known text (WKT 1 of OGC or ESRI, or WKT 2), where one was given.
    pub wkt: Option<String>,
}

/// A text that names no coordinate reference system.
#[derive(Debug, Error, PartialEq, Eq)]
#[error(
    "`{found}` is not a coordinate reference system; allowed are \"EPSG:31287\" (a code from 1024 to 32767, \
     see epsg.io), with heights \"EPSG:2264+6360\", and a WKT definition such as the text of a .prj file (PROJCS[...])"
)]
pub struct CrsError {
    /// What was found, shortened.
    pub found: String,
}

impl Crs {
    /// Reads `EPSG:31287` (any case, also `urn:ogc:def:crs:EPSG::31287`), `EPSG:2264+6360` with the code of a vertical
    /// system, or a WKT definition.
    ///
    /// # Errors
    /// [`CrsError`] when the text is none of them.
    pub fn parse(text: &str) -> Result<Crs, CrsError> {
        let text = text.trim().trim_start_matches('\u{feff}');
        let error = || CrsError { found: text.chars().take(60).collect() };
        if let Some((authority, codes)) = text.rsplit_once(':').filter(|_| !text.contains('[')) {
            let named = authority.trim().to_ascii_uppercase();
            if !named.trim_end_matches(':').split(':').any(|part| part == "EPSG") {
                return Err(error());
            }
            let code = |text: &str| text.trim().parse().ok().filter(|code| (1024..=32767).contains(code));
            let (horizontal, vertical) = match codes.split_once('+') {
                Some((horizontal, vertical)) => (horizontal, Some(code(vertical).ok_or_else(error)?)),
                None => (codes, None),
            };
            return Crs::coded(code(horizontal).ok_or_else(error)?, vertical).ok_or_else(error);
        }
        let root = Node::parse(text).ok_or_else(error)?;
        System::of(&root).ok_or_else(error)?;
        Ok(Crs { epsg: horizontal_code(&root), wkt: Some(text.to_string()) })
    }

    /// The system of a code, and the heights of another; `None` for heights over a system that is not in the register.
    pub(super) fn coded(code: u32, vertical: Option<u32>) -> Option<Crs> {
        if let Some(wkt) = super::register::world_map(code) {
            return Some(Crs { epsg: None, wkt: Some(wkt) });
        }
        let known = well_known_text(code);
        if let Some(vertical) = vertical {
            let unit = match Heights::coded(vertical) {
                Heights::Unit(unit) => format!(
                    ",UNIT[\"unit of heights\",{}]{}",
                    unit.abs(),
                    if unit < 0.0 { ",AXIS[\"Depth\",DOWN]" } else { "" }
                ),
                Heights::Unknown => String::new(),
            };
            let heights = format!(
                "VERT_CS[\"EPSG:{vertical}\",VERT_DATUM[\"EPSG:{vertical}\",2005]{unit},AUTHORITY[\"EPSG\",\"{vertical}\"]]"
            );
            return Some(Crs {
                epsg: Some(code),
                wkt: Some(format!("COMPD_CS[\"EPSG:{code}+{vertical}\",{},{heights}]", known?)),
            });
        }
        match known.as_deref().and_then(Node::parse) {
            // Outputs take the code of the horizontal part.
            Some(root) if root.is("COMPD_CS") => Some(Crs { epsg: horizontal_code(&root), wkt: known }),
            _ => Some(Crs { epsg: Some(code), wkt: None }),
        }
    }

    /// Whether positions are longitudes and latitudes, as far as the code or the WKT tells.
    pub fn is_geographic(&self) -> bool {
        self.system().is_some_and(|system| system.kind == Kind::Geographic)
    }

    /// Length of one unit of the coordinates in metres, where a projected system says it.
    pub fn metres_per_unit(&self) -> Option<f64> {
        self.system()?.unit
    }

    /// The scale of the map at a place in its coordinates; `None` where nothing is known against it.
    pub(super) fn scale(&self, place: [f64; 2]) -> Option<Scale> {
        self.system()?.scale(place)
    }

    /// Metres on the map of a metre on the ground at a place in its coordinates, the largest and the smallest of all directions;
    /// `None` where they are not computed.
    pub fn factors(&self, place: [f64; 2]) -> Option<[f64; 2]> {
        match self.scale(place)? {
            Scale::At { factors: [a, b], .. } => Some([a.max(b), a.min(b)]),
            Scale::World => None,
        }
    }

    /// What the system says of heights.
    pub(super) fn heights(&self) -> Option<Heights> {
        self.system()?.heights
    }

    /// Whether two systems are one: datum, projection, parameters and unit agree, whoever wrote them; heights are left out.
    pub fn compare(&self, other: &Crs) -> Comparison {
        let codes = [self.epsg, other.epsg];
        if let [Some(a), Some(b)] = codes
            && a == b
            && (self.wkt.is_none() || other.wkt.is_none())
        {
            return Comparison::Same;
        }
        if self.wkt.is_some() && self.wkt == other.wkt {
            return Comparison::Same;
        }
        let (Some(own), Some(others)) = (self.system(), other.system()) else {
            return match codes {
                [Some(a), Some(b)] if a == b => Comparison::Same,
                [Some(a), Some(b)] => Comparison::Different(format!("EPSG:{a} against EPSG:{b}")),
                _ => Comparison::Unknown(format!("{self} or {other} is not in the register")),
            };
        };
        match (own.compare(&others), codes) {
            (Comparison::Unknown(_), [Some(a), Some(b)]) if a == b => Comparison::Same,
            (comparison, _) => comparison,
        }
    }

    /// The code and the name, as far as they are known.
    pub fn describe(&self) -> String {
        let name = self.system().map(|system| system.name).unwrap_or_default();
        match self.epsg {
            Some(code) if name.is_empty() => format!("EPSG:{code}"),
            Some(code) => format!("EPSG:{code} ({name})"),
            None => self.to_string(),
        }
    }

    /// What GDAL's programs take to reproject to the system of a terrain, and what to know about that.
    pub(crate) fn target(terrain: Option<&Crs>) -> [String; 2] {
        match terrain.and_then(|crs| crs.epsg) {
            Some(code) => [format!("EPSG:{code}"), String::new()],
            None => [
                "terrain.prj".to_owned(),
                "\n(terrain.prj holds the system of the terrain: gdalsrsinfo -o wkt1_esri DEM > terrain.prj)"
                    .to_owned(),
            ],
        }
    }

    /// The system by its definition, or by its code.
    fn system(&self) -> Option<System> {
        match &self.wkt {
            Some(text) => System::of(&Node::parse(text)?),
            None => System::of(&Node::parse(&well_known_text(self.epsg?)?)?),
        }
    }
}

impl std::fmt::Display for Crs {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.epsg, self.system()) {
            (Some(code), _) => write!(f, "EPSG:{code}"),
            (None, Some(system)) if !system.name.is_empty() => f.write_str(&system.name),
            _ => f.write_str("a system without a name"),
        }
    }
}

/// The code of the horizontal system of a definition.
fn horizontal_code(root: &Node) -> Option<u32> {
    root.find(&HORIZONTAL)?.code()
}

/// The well-known text of an EPSG code, where it is known.
///
/// The shift to WGS 84 that such texts carry is left out: it belongs to a transformation, not to the system, and with it
/// readers would take the system for another than the EPSG's.
pub fn well_known_text(epsg: u32) -> Option<String> {
    let known = crs_definitions::from_code(u16::try_from(epsg).ok()?)?;
    let text = match known.wkt.split_once(",TOWGS84[") {
        Some((before, shift)) => format!("{before}{}", shift.split_once(']').map_or("", |(_, after)| after)),
        None => known.wkt.into(),
    };
    (!text.is_empty()).then_some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAMBERT: &str = r#"PROJCS["MGI_Austria_Lambert",GEOGCS["GCS_MGI",DATUM["D_MGI",SPHEROID["Bessel_1841",6377397.155,299.1528128]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Lambert_Conformal_Conic"],PARAMETER["False_Easting",400000.0],PARAMETER["False_Northing",400000.0],PARAMETER["Central_Meridian",13.33333333333333],PARAMETER["Standard_Parallel_1",46.0],PARAMETER["Standard_Parallel_2",49.0],PARAMETER["Latitude_Of_Origin",47.5],UNIT["Meter",1.0]]"#;

    fn crs(text: &str) -> Crs {
        Crs::parse(text).unwrap()
    }

    /// What differs.
    fn different(a: &Crs, b: &Crs) -> String {
        match (a.compare(b), b.compare(a)) {
            (Comparison::Different(what), Comparison::Different(_)) => what,
            other => panic!("{a} and {b}: {other:?}"),
        }
    }

    #[test]
    fn codes_and_definitions_are_understood() {
        assert_eq!(Crs::parse(" epsg:31287 "), Ok(Crs { epsg: Some(31287), wkt: None }));
        assert_eq!(Crs::parse("urn:ogc:def:crs:EPSG::32632").map(|c| c.epsg), Ok(Some(32632)));
        let lambert = crs(LAMBERT);
        assert_eq!(
            (lambert.epsg, lambert.metres_per_unit(), lambert.is_geographic()),
            (None, Some(1.0), false)
        );
        assert_eq!(lambert.to_string(), "MGI_Austria_Lambert");
        assert_eq!(crs("EPSG:31287").describe(), "EPSG:31287 (MGI / Austria Lambert)");
        let coded =
            LAMBERT.replace("UNIT[\"Meter\",1.0]]", "UNIT[\"ft\",0.3048],AUTHORITY[\"EPSG\",\"31287\"]]");
        let coded = crs(&coded);
        assert_eq!((coded.epsg, coded.metres_per_unit()), (Some(31287), Some(0.3048)));
        assert!(crs(r#"GEOGCRS["WGS 84",ID["EPSG",4326]]"#).is_geographic());
        assert!([4326, 4267, 4979, 4937].iter().all(|code| crs(&format!("EPSG:{code}")).is_geographic()));
    }

    #[test]
    fn units_and_heights_come_from_code_and_text_alike() {
        assert_eq!(crs("EPSG:2264").metres_per_unit().map(|m| (m * 1e7).round()), Some(3_048_006.0));
        let with = |text: &str| (crs(text).epsg, crs(text).heights());
        let survey = Heights::Unit(0.304_800_609_601_219_24);
        assert_eq!(with("EPSG:2264+6360"), (Some(2264), Some(survey)));
        assert_eq!(with("EPSG:26910+5703"), (Some(26910), Some(Heights::Unit(1.0))));
        assert_eq!(with("EPSG:32632"), (Some(32632), None));
        let arc = |unit: &str| {
            format!("{LAMBERT},VERTCS[\"NAVD\",VDATUM[\"N\"],PARAMETER[\"Direction\",1.0],UNIT[{unit}]]")
        };
        assert_eq!(with(&arc("\"Foot\",0.3048")), (None, Some(Heights::Unit(0.3048))));
        let depth = arc("\"Foot\",0.3048").replace("\"Direction\",1.0", "\"Direction\",-1.0");
        assert_eq!(with(&depth).1, Some(Heights::Unit(-0.3048)));
        let two = r#"COMPOUNDCRS["x",PROJCRS["y",BASEGEOGCRS["z"],ID["EPSG",25832]],VERTCRS["h",VDATUM["h"],CS[vertical,1],AXIS["up",up,LENGTHUNIT["foot",0.3048]]]]"#;
        assert_eq!(with(two), (Some(25832), Some(Heights::Unit(0.3048))));
    }

    #[test]
    fn nonsense_is_refused_with_what_is_allowed() {
        for text in
            ["EPSG:abc", "31287", "", "PROJCS[", "UTM zone 32", "IAU:49910", "EPSG:99999999", "EPSG:2264+x"]
        {
            let message = Crs::parse(text).unwrap_err().to_string();
            assert!(message.contains("EPSG:31287") && message.contains(text), "{message}");
        }
    }

    #[test]
    fn one_system_is_one_whoever_writes_it() {
        let esri = crs(LAMBERT);
        assert_eq!(esri.compare(&crs("EPSG:31287")), Comparison::Same);
        assert_eq!(crs("EPSG:31287").compare(&esri), Comparison::Same);
        let utm = r#"PROJCRS["UTM",BASEGEOGCRS["E",ENSEMBLE["European Terrestrial Reference System 1989 ensemble",MEMBER["x"],ELLIPSOID["GRS 1980",6378137,298.257222101,LENGTHUNIT["metre",1]]],PRIMEM["Greenwich",0,ANGLEUNIT["degree",0.0174532925199433]]],CONVERSION["UTM zone 32N",METHOD["Transverse Mercator",ID["EPSG",9807]],PARAMETER["Latitude of natural origin",0,ANGLEUNIT["degree",0.0174532925199433]],PARAMETER["Longitude of natural origin",9,ANGLEUNIT["degree",0.0174532925199433]],PARAMETER["Scale factor at natural origin",0.9996,SCALEUNIT["unity",1]],PARAMETER["False easting",500000,LENGTHUNIT["metre",1]],PARAMETER["False northing",0,LENGTHUNIT["metre",1]]],CS[Cartesian,2],AXIS["(E)",east],AXIS["(N)",north],LENGTHUNIT["metre",1]]"#;
        assert_eq!(crs(utm).compare(&crs("EPSG:25832")), Comparison::Same);
        assert!(different(&crs(utm), &crs("EPSG:25833")).contains("longitude of origin 9 against 15"));
        assert!(different(&crs(utm), &crs("EPSG:23032")).contains("datum"));
    }

    #[test]
    fn what_differs_is_named_and_what_is_not_known_is_no_difference() {
        for (a, b, what) in [
            (
                "EPSG:25831",
                "EPSG:23031",
                "datum European_Terrestrial_Reference_System_1989 against European_Datum_1950",
            ),
            ("EPSG:31287", "EPSG:3416", "datum"),
            ("EPSG:26910", "EPSG:26710", "datum"),
            ("EPSG:31287", "EPSG:32632", "datum"),
            ("EPSG:2056", "EPSG:21781", "datum"),
            ("EPSG:2264", "EPSG:32119", "unit"),
            ("EPSG:27572", "EPSG:27562", "false northing 2200000 against 200000"),
            ("EPSG:4807", "EPSG:4275", "prime meridian 2.33722917 against 0 degrees"),
            ("EPSG:4258", "EPSG:25832", "degrees against a map projection"),
            ("EPSG:32767", "EPSG:32632", "EPSG:32767 against EPSG:32632"),
        ] {
            let found = different(&crs(a), &crs(b));
            assert!(found.starts_with(what) || found.contains(what), "{a} {b}: {found}");
        }
        let shifted = crs(&LAMBERT.replace("[\"False_Easting\",400000.0]", "[\"false_easting\",0]"));
        assert_eq!(different(&crs(LAMBERT), &shifted), "false easting 400000 against 0");
        let own = crs(&LAMBERT.replace("D_MGI", "D_Mine"));
        assert!(matches!(own.compare(&crs(LAMBERT)), Comparison::Unknown(what) if what.contains("D_Mine")));
        let bare = crs(r#"PROJCS["Here",GEOGCS["G"],UNIT["Meter",1.0]]"#);
        assert!(matches!(bare.compare(&crs(LAMBERT)), Comparison::Unknown(_)));
    }
}
