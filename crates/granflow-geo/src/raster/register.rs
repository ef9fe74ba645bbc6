//! The part of the EPSG register that well-known text does not carry: codes of datums by any of their names, units by
//! code and by name, heights of vertical systems by code.
//!
//! The tables are written by `validation/register.py`.

const DATUMS: &str = include_str!("register/datums.tsv");
const HEIGHTS: &str = include_str!("register/heights.tsv");
const LENGTHS: &str = include_str!("register/lengths.tsv");

/// Names of units that files write and the register does not.
const ALIASES: [(&str, u32); 23] = [
    ("m", 9001),
    ("meter", 9001),
    ("meters", 9001),
    ("metres", 9001),
    ("ft", 9002),
    ("feet", 9002),
    ("internationalfoot", 9002),
    ("internationalfeet", 9002),
    ("footintl", 9002),
    ("usft", 9003),
    ("ftus", 9003),
    ("sft", 9003),
    ("footus", 9003),
    ("ussurveyfeet", 9003),
    ("surveyfoot", 9003),
    ("ussft", 9003),
    ("cm", 1033),
    ("centimeter", 1033),
    ("mm", 1025),
    ("millimeter", 1025),
    ("km", 9036),
    ("kilometer", 9036),
    ("yd", 9096),
];

/// ESRI's maps of the world on WGS 84 by the last two digits of their codes, 540xx; 530xx are the same on a sphere.
const WORLD_MAPS: [(u32, &str, &str); 29] = [
    (1, "Plate_Carree", "Plate_Carree"),
    (2, "Equidistant_Cylindrical", "Equidistant_Cylindrical"),
    (3, "Miller_Cylindrical", "Miller_Cylindrical"),
    (4, "Mercator", "Mercator"),
    (8, "Sinusoidal", "Sinusoidal"),
    (9, "Mollweide", "Mollweide"),
    (10, "Eckert_VI", "Eckert_VI"),
    (11, "Eckert_V", "Eckert_V"),
    (12, "Eckert_IV", "Eckert_IV"),
    (13, "Eckert_III", "Eckert_III"),
    (14, "Eckert_II", "Eckert_II"),
    (15, "Eckert_I", "Eckert_I"),
    (16, "Gall_Stereographic", "Gall_Stereographic"),
    (17, "Behrmann", "Behrmann"),
    (18, "Winkel_I", "Winkel_I"),
    (19, "Winkel_II", "Winkel_II"),
    (22, "Quartic_Authalic", "Quartic_Authalic"),
    (23, "Loximuthal", "Loximuthal"),
    (29, "Van_der_Grinten_I", "Van_der_Grinten_I"),
    (30, "Robinson", "Robinson"),
    (34, "Cylindrical_Equal_Area", "Cylindrical_Equal_Area"),
    (42, "Winkel_Tripel_NGS", "Winkel_Tripel"),
    (43, "Aitoff", "Aitoff"),
    (44, "Hammer_Aitoff", "Hammer_Aitoff"),
    (45, "Flat_Polar_Quartic", "Flat_Polar_Quartic"),
    (46, "Craster_Parabolic", "Craster_Parabolic"),
    (48, "Times", "Times"),
    (52, "Goode_Homolosine_Land", "Goode_Homolosine"),
    (53, "Goode_Homolosine_Ocean", "Goode_Homolosine"),
];

/// The definition of a map of the world by its code at ESRI, 530xx or 540xx; GeoTIFFs carry such codes as those of the EPSG.
pub(super) fn world_map(code: u32) -> Option<String> {
    let (prefix, base) = match code / 100 {
        530 => ("Sphere", "GEOGCS[\"GCS_Sphere\",DATUM[\"D_Sphere\",SPHEROID[\"Sphere\",6371000.0,0.0]]"),
        540 => (
            "World",
            "GEOGCS[\"GCS_WGS_1984\",DATUM[\"D_WGS_1984\",SPHEROID[\"WGS_1984\",6378137.0,298.257223563]]",
        ),
        _ => return None,
    };
    let (_, name, method) = WORLD_MAPS.iter().find(|(last, ..)| *last == code % 100)?;
    // The map with a standard parallel other than the equator.
    let parallel = if code % 100 == 2 { "PARAMETER[\"Standard_Parallel_1\",60.0]," } else { "" };
    Some(format!(
        "PROJCS[\"{prefix}_{name}\",{base},PRIMEM[\"Greenwich\",0.0],UNIT[\"Degree\",0.0174532925199433]],\
         PROJECTION[\"{method}\"],{parallel}UNIT[\"Meter\",1.0],AUTHORITY[\"ESRI\",\"{code}\"]]"
    ))
}

/// A name without what writers differ in: case, blanks, underscores, ESRI's `D_`.
pub(super) fn plain(name: &str) -> String {
    let name = name.trim().to_lowercase();
    let name = name.strip_prefix("d_").unwrap_or(&name);
    name.chars().filter(|c| matches!(c, 'a'..='z' | '0'..='9' | '+')).collect()
}

/// The rows of a table, split into columns.
fn rows(table: &'static str) -> impl Iterator<Item = Vec<&'static str>> {
    table.lines().filter(|line| !line.starts_with('#')).map(|line| line.split('\t').collect())
}

/// EPSG codes of the datums that bear a name, none where no datum does.
pub(super) fn datums(name: &str) -> Vec<u32> {
    let name = plain(name);
    let name = name.strip_suffix("ensemble").unwrap_or(&name);
    let found = rows(DATUMS).find(|row| row[0] == name);
    found.map(|row| row[1].split(',').filter_map(|code| code.parse().ok()).collect()).unwrap_or_default()
}

/// Metres upward of one unit of the heights of a vertical system; negative for depths.
pub(super) fn heights(code: u32) -> Option<f64> {
    number(HEIGHTS, code)
}

/// Metres of a unit of length by its code.
pub(super) fn length(code: u32) -> Option<f64> {
    number(LENGTHS, code)
}

/// Metres of a unit of length by its name or symbol.
pub(super) fn length_named(name: &str) -> Option<f64> {
    let name = plain(name);
    if let Some((_, code)) = ALIASES.iter().find(|(alias, _)| *alias == name) {
        return length(*code);
    }
    rows(LENGTHS).find(|row| plain(row[2]) == name).and_then(|row| row[1].parse().ok())
}

fn number(table: &'static str, code: u32) -> Option<f64> {
    let code = code.to_string();
    rows(table).find(|row| row[0] == code).and_then(|row| row[1].parse().ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_datum_has_one_code_whoever_writes_its_name() {
        for names in [
            ["European_Terrestrial_Reference_System_1989", "D_ETRS_1989"],
            ["European Datum 1950", "D_European_1950"],
            ["World Geodetic System 1984 ensemble", "D_WGS_1984"],
            ["North_American_Datum_1927", "D_North_American_1927"],
            ["CH1903+", "D_CH1903+"],
        ] {
            let [a, b] = names.map(datums);
            assert!(!a.is_empty() && a == b, "{names:?}: {a:?} {b:?}");
        }
        assert_ne!(datums("CH1903"), datums("CH1903+"));
        assert!(datums("Nowhere 1900").is_empty());
    }

    #[test]
    fn every_alias_is_a_unit_and_feet_differ() {
        assert!(
            ALIASES.iter().all(|(name, code)| length(*code).is_some() && length_named(name) == length(*code))
        );
        assert_eq!((length_named("US survey foot"), length_named("Foot_US")), (length(9003), length(9003)));
        assert_eq!(
            (length(9002), length_named("ft"), length_named("ells")),
            (Some(0.3048), Some(0.3048), None)
        );
        assert_eq!((heights(5703), heights(8228), heights(8051)), (Some(1.0), Some(0.3048), Some(-0.3048)));
    }
}
