//! The part of the EPSG register that well-known text does not carry: codes of datums by any of their names, units by
//! code and by name, heights of vertical systems by code; and ESRI's maps of the world by code.
//!
//! The tables are written by `validation/register.py`.

const DATUMS: &str = include_str!("register/datums.tsv");
const HEIGHTS: &str = include_str!("register/heights.tsv");
const LENGTHS: &str = include_str!("register/lengths.tsv");
const MAPS: &str = include_str!("register/maps.tsv");

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

/// The definition of a map of the world by its code at ESRI, 530xx or 540xx; GeoTIFFs carry such codes as those of the EPSG.
pub(super) fn world_map(code: u32) -> Option<String> {
    let code = code.to_string();
    rows(MAPS).find(|row| row[0] == code).map(|row| row[1].to_owned())
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
