//! Coordinate reference systems, as far as a raster must know its own: an EPSG code, a WKT text, or both.

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
     see epsg.io) and a WKT definition such as the text of a .prj file (PROJCS[...])"
)]
pub struct CrsError {
    /// What was found, shortened.
    pub found: String,
}

/// Geographic systems in wide use; others are known by their WKT, by the GeoTIFF model type or by their coordinates.
const GEOGRAPHIC: [u32; 22] = [
    4326, 4258, 4267, 4269, 4275, 4277, 4283, 4289, 4312, 4314, 4149, 4150, 4171, 4230, 4231, 4612, 4674,
    4937, 4979, 6318, 6668, 7844,
];

impl Crs {
    /// Reads `EPSG:31287` (any case, also `urn:ogc:def:crs:EPSG::31287`) or a WKT definition.
    ///
    /// # Errors
    /// [`CrsError`] when the text is neither.
    pub fn parse(text: &str) -> Result<Crs, CrsError> {
        let text = text.trim().trim_start_matches('\u{feff}');
        let error = || CrsError { found: text.chars().take(60).collect() };
        if let Some((authority, code)) = text.rsplit_once(':').filter(|_| !text.contains('[')) {
            let epsg = code.trim().parse().ok().filter(|code| (1024..=32767).contains(code));
            let named = authority.trim().to_ascii_uppercase();
            if epsg.is_some() && named.trim_end_matches(':').split(':').any(|part| part == "EPSG") {
                return Ok(Crs { epsg, wkt: None });
            }
            return Err(error());
        }
        let root = Node::parse(text).ok_or_else(error)?;
        let horizontal = horizontal(&root).ok_or_else(error)?;
        Ok(Crs { epsg: authority_code(horizontal), wkt: Some(text.to_string()) })
    }

    /// Whether positions are longitudes and latitudes, as far as the code or the WKT tells.
    pub fn is_geographic(&self) -> bool {
        match self.definition() {
            Some(root) => horizontal(&root).is_some_and(|crs| crs.keyword.starts_with("GEO")),
            None => self.epsg.is_some_and(|code| GEOGRAPHIC.contains(&code)),
        }
    }

    /// Length of one unit of the coordinates in metres, where the WKT of a projected system says it.
    pub fn metres_per_unit(&self) -> Option<f64> {
        let root = self.definition()?;
        let crs = horizontal(&root).filter(|crs| crs.keyword.starts_with("PROJ"))?;
        let unit = |node: &Node| node.children().find(|n| n.is("UNIT") || n.is("LENGTHUNIT"))?.number(1);
        unit(crs).or_else(|| crs.children().find(|n| n.is("AXIS")).and_then(unit))
    }

    /// What proves that `self` and `other` are different systems, or `None` where nothing does.
    ///
    /// Codes are compared with codes, definitions with definitions (kind of system and the projection parameters
    /// that both name); a code and a definition without a code cannot be compared without a register of systems.
    pub fn contradiction(&self, other: &Crs) -> Option<String> {
        if let (Some(a), Some(b)) = (self.epsg, other.epsg) {
            return (a != b).then(|| format!("EPSG:{a} against EPSG:{b}"));
        }
        if self.is_geographic() != other.is_geographic() {
            return Some("degrees against metres".to_string());
        }
        let (a, b) = (self.definition()?, other.definition()?);
        let (a, b) = (parameters(horizontal(&a)?), parameters(horizontal(&b)?));
        a.iter().find_map(|(name, value)| {
            let (_, counterpart) = b.iter().find(|(other, _)| other == name)?;
            let same = (value - counterpart).abs() <= 1e-6 * value.abs().max(1.0);
            (!same).then(|| format!("{name} {value} against {counterpart}"))
        })
    }

    fn definition(&self) -> Option<Node> {
        self.wkt.as_deref().and_then(Node::parse)
    }
}

impl std::fmt::Display for Crs {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.epsg, self.definition()) {
            (Some(code), _) => write!(f, "EPSG:{code}"),
            (None, Some(root)) => f.write_str(root.text(0).unwrap_or("a system without a name")),
            (None, None) => f.write_str("a system without a name"),
        }
    }
}

/// The horizontal system of a definition that may be compound or bound to a transformation.
fn horizontal(root: &Node) -> Option<&Node> {
    const KINDS: [&str; 8] =
        ["PROJCS", "PROJCRS", "PROJECTEDCRS", "GEOGCS", "GEOGCRS", "GEOGRAPHICCRS", "GEODCRS", "GEODETICCRS"];
    const LOCAL: [&str; 3] = ["LOCAL_CS", "ENGCRS", "ENGINEERINGCRS"];
    if KINDS.iter().chain(&LOCAL).any(|kind| root.is(kind)) {
        return Some(root);
    }
    root.children().find_map(horizontal)
}

fn authority_code(crs: &Node) -> Option<u32> {
    let id = crs.children().find(|n| (n.is("AUTHORITY") || n.is("ID")) && n.text(0) == Some("EPSG"))?;
    id.number(1).map(|code| code as u32)
}

/// Projection parameters by name in lower case; ESRI and OGC agree on the names but not on their case.
fn parameters(node: &Node) -> Vec<(String, f64)> {
    let own = node.is("PARAMETER").then(|| Some((node.text(0)?.to_ascii_lowercase(), node.number(1)?)));
    own.flatten().into_iter().chain(node.children().flat_map(parameters)).collect()
}

/// The well-known text of an EPSG code, where it is known.
///
/// The shift to WGS 84 that such texts carry is left out: it belongs to a transformation, not to the system, and with it
/// readers would take the system for another than the EPSG's.
pub fn well_known_text(epsg: u32) -> Option<String> {
    let known = crs_definitions::from_code(u16::try_from(epsg).ok()?)?;
    Some(match known.wkt.split_once(",TOWGS84[") {
        Some((before, shift)) => format!("{before}{}", shift.split_once(']').map_or("", |(_, after)| after)),
        None => known.wkt.into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAMBERT: &str = r#"PROJCS["MGI_Austria_Lambert",GEOGCS["GCS_MGI",DATUM["D_MGI",SPHEROID["Bessel_1841",6377397.155,299.1528128]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Lambert_Conformal_Conic"],PARAMETER["False_Easting",400000.0],PARAMETER["Standard_Parallel_1",49.0],UNIT["Meter",1.0]]"#;

    #[test]
    fn codes_and_definitions_are_understood() {
        assert_eq!(Crs::parse(" epsg:31287 "), Ok(Crs { epsg: Some(31287), wkt: None }));
        assert_eq!(Crs::parse("urn:ogc:def:crs:EPSG::32632").map(|c| c.epsg), Ok(Some(32632)));
        let crs = Crs::parse(LAMBERT).unwrap();
        assert_eq!((crs.epsg, crs.metres_per_unit(), crs.is_geographic()), (None, Some(1.0), false));
        assert_eq!(crs.to_string(), "MGI_Austria_Lambert");
        let coded =
            LAMBERT.replace("UNIT[\"Meter\",1.0]]", "UNIT[\"ft\",0.3048],AUTHORITY[\"EPSG\",\"31287\"]]");
        let coded = Crs::parse(&coded).unwrap();
        assert_eq!((coded.epsg, coded.metres_per_unit()), (Some(31287), Some(0.3048)));
        assert!(Crs::parse(r#"GEOGCRS["WGS 84",ID["EPSG",4326]]"#).unwrap().is_geographic());
        assert!(Crs::parse("EPSG:4326").unwrap().is_geographic());
    }

    #[test]
    fn nonsense_is_refused_with_what_is_allowed() {
        for text in ["EPSG:abc", "31287", "", "PROJCS[", "UTM zone 32", "IAU:49910", "EPSG:99999999"] {
            let message = Crs::parse(text).unwrap_err().to_string();
            assert!(message.contains("EPSG:31287") && message.contains(text), "{message}");
        }
    }

    #[test]
    fn only_proof_counts_as_contradiction() {
        let [a, b] = ["EPSG:31287", "EPSG:32632"].map(|text| Crs::parse(text).unwrap());
        assert_eq!(a.contradiction(&b).unwrap(), "EPSG:31287 against EPSG:32632");
        let wkt = Crs::parse(LAMBERT).unwrap();
        assert_eq!(a.contradiction(&wkt), None);
        assert_eq!(wkt.contradiction(&wkt), None);
        let shifted = Crs::parse(&LAMBERT.replace("400000.0", "0").replace("False_Easting", "false_easting"));
        assert_eq!(wkt.contradiction(&shifted.unwrap()).unwrap(), "false_easting 400000 against 0");
        let degrees = Crs::parse("EPSG:4326").unwrap();
        assert!(wkt.contradiction(&degrees).unwrap().contains("degrees"));
    }
}
