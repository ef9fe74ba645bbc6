//! ESRI ASCII grids: `ncols`, `nrows`, `xllcorner` or `xllcenter`, `yllcorner` or `yllcenter`, `cellsize`,
//! `NODATA_value` (any case, any order, also several to a line and the number first), then the values from the
//! north-west, row by row, lines of any length; decimals with a point or a comma.

use super::declared::{Declared, conceal};
use super::{Crs, Raster, RasterError, agreed, beside, turn};
use crate::Remark;
use std::path::Path;

/// The value that means nodata where the header names none.
const NODATA: f64 = -9999.0;
/// What GDAL takes `NODATA_value null` for.
const NULL: f64 = f32::MIN as f64;

/// The header's keys in lower case.
const KEYS: [&str; 10] = [
    "ncols",
    "nrows",
    "xllcorner",
    "xllcenter",
    "yllcorner",
    "yllcenter",
    "cellsize",
    "dx",
    "dy",
    "nodata_value",
];

/// Reads a file, and the `.prj` file beside it if there is one; `sidecar` is what the `.aux.xml` file says.
pub(super) fn read(
    path: &Path,
    sidecar: Declared,
    given: Option<&Crs>,
    notes: &mut Vec<Remark>,
) -> Result<(Raster, Declared), RasterError> {
    let bytes = std::fs::read(path).map_err(|source| RasterError::Io { path: path.into(), source })?;
    let prj = beside(path, "prj");
    let definition = std::fs::read(&prj).ok();
    let definition = definition.as_deref().map(|definition| (&*prj, definition));
    from_bytes(path, &bytes, (definition, sidecar), given, notes)
}

/// Reads what a file called `name` holds; `prj` is name and content of the file with its CRS.
pub(super) fn from_bytes(
    name: &Path,
    bytes: &[u8],
    (prj, sidecar): (Option<(&Path, &[u8])>, Declared),
    given: Option<&Crs>,
    notes: &mut Vec<Remark>,
) -> Result<(Raster, Declared), RasterError> {
    let raster = parse(name, bytes, &sidecar)?;
    let own = match prj.map(|(prj, definition)| (prj, Crs::parse(&String::from_utf8_lossy(definition)))) {
        None => match &sidecar.system {
            Some(text) => Some(Crs::parse(text).map_err(|e| {
                let path = super::declared::with_suffix(name, ".aux.xml");
                RasterError::Declared { path, problem: format!("its SRS is not understood: {e}") }
            })?),
            None => None,
        },
        Some((_, Ok(crs))) => Some(crs),
        Some((prj, Err(_))) if given.is_some() => {
            let text = format!("{}: it is not understood; crs of the case was taken", prj.display());
            notes.push(Remark::Warning(text));
            None
        }
        Some((prj, Err(error))) => {
            let cure = "; write that into it, or crs = \"EPSG:xxxx\" into the case";
            return Err(RasterError::header(prj, 1, format!("{error}{cure}")));
        }
    };
    let crs = agreed(name, own, given, notes)?;
    Ok((Raster { crs, ..raster }, sidecar))
}

/// Header entries with the lines that they stand on.
#[derive(Default)]
struct Header {
    columns: Option<usize>,
    rows: Option<usize>,
    west: Option<(f64, bool)>,
    south: Option<(f64, bool)>,
    cell: Option<f64>,
    height: Option<f64>,
    nodata: Option<f64>,
    /// Nodata is declared as a word that is no number.
    null: bool,
}

fn parse(path: &Path, bytes: &[u8], beside: &Declared) -> Result<Raster, RasterError> {
    let unknown = |found: String| RasterError::Format { path: path.into(), found };
    let text = std::str::from_utf8(bytes).map_err(|_| unknown("it is not text".into()))?;
    let text = text.trim_start_matches('\u{feff}');
    let mut lines = text.lines().zip(1..).peekable();
    let mut header = Header::default();
    let mut last = 0;
    while let Some((content, line)) = lines.next_if(|(content, _)| is_header(content)) {
        let words = words(content);
        if last == 0 && !words.iter().take(2).any(|word| is_key(word)) {
            break;
        }
        for pair in words.chunks(2) {
            match *pair {
                [value, key] if is_key(key) && !is_key(value) => header.set(path, line, key, value)?,
                [key, value] => header.set(path, line, key, value)?,
                // GDAL writes a header so that has no value for nodata.
                [key] if key.eq_ignore_ascii_case("nodata_value") => {}
                _ => {
                    let problem = format!("a header line holds keys, each with a value, found `{content}`");
                    return Err(RasterError::header(path, line, problem));
                }
            }
            last = line;
        }
    }
    if last == 0 {
        let first = text.split_whitespace().next().unwrap_or("nothing");
        return Err(unknown(format!("it begins with `{}`", first.chars().take(30).collect::<String>())));
    }
    let mut raster = header.raster(path, last)?;
    let nodata = header.nodata.or(beside.nodata).unwrap_or(NODATA);
    let (columns, rows) = (raster.columns, raster.rows);
    let mut values = Vec::with_capacity((columns * rows).min(bytes.len() / 2 + 1));
    for (content, line) in lines {
        for word in content.split_ascii_whitespace() {
            let found = || RasterError::Value { path: path.into(), line, found: word.to_string() };
            let value = number(word).ok_or_else(found)?;
            let near = |nodata: f64| (value - nodata).abs() <= 1e-7 * nodata.abs();
            let missing = !value.is_finite() || near(nodata) || header.null && near(NULL);
            values.push(if missing { f64::NAN } else { value });
            last = line;
        }
    }
    if values.len() != columns * rows {
        return Err(RasterError::Count { path: path.into(), rows, columns, found: values.len(), line: last });
    }
    if let Some(opaque) = &beside.mask {
        conceal(path, &mut values, opaque)?;
    }
    turn(&mut values, columns);
    raster.values = values;
    Ok(raster)
}

/// A number with a point or a comma for decimals.
fn number(word: &str) -> Option<f64> {
    word.parse().ok().or_else(|| word.replacen(',', ".", 1).parse().ok())
}

fn words(content: &str) -> Vec<&str> {
    let apart = |c: char| c.is_whitespace() || c == '=' || c == ':';
    content.split(apart).filter(|word| !word.is_empty()).collect()
}

fn is_key(word: &str) -> bool {
    KEYS.contains(&word.to_ascii_lowercase().as_str())
}

/// Blank, beginning with a word that is no number, or with a number before a key.
fn is_header(content: &str) -> bool {
    let mut words = content.split_whitespace();
    let Some(word) = words.next() else { return true };
    word.starts_with(char::is_alphabetic) && number(word).is_none() || words.next().is_some_and(is_key)
}

impl Header {
    fn set(&mut self, path: &Path, line: usize, key: &str, found: &str) -> Result<(), RasterError> {
        let count = || {
            let error = format!("{key} is a whole number above 0, found {found}");
            let count = found.parse().ok().filter(|&n: &usize| n > 0 && n < 1 << 31);
            count.ok_or_else(|| RasterError::header(path, line, error))
        };
        let number = || {
            let error = format!("{key} is a number, found {found}");
            let number = number(found).filter(|v: &f64| v.is_finite());
            number.ok_or_else(|| RasterError::header(path, line, error))
        };
        match key.to_ascii_lowercase().as_str() {
            "ncols" => self.columns = Some(count()?),
            "nrows" => self.rows = Some(count()?),
            "xllcorner" => self.west = Some((number()?, false)),
            "xllcenter" => self.west = Some((number()?, true)),
            "yllcorner" => self.south = Some((number()?, false)),
            "yllcenter" => self.south = Some((number()?, true)),
            "cellsize" | "dx" => self.cell = Some(number()?),
            "dy" => self.height = Some(number()?),
            "nodata_value" if ["null", "none", "na", "n/a"].contains(&&*found.to_ascii_lowercase()) => {
                self.null = true;
            }
            "nodata_value" if found.parse::<f64>().is_ok_and(|v| !v.is_finite()) => {
                self.nodata = Some(NODATA)
            }
            "nodata_value" => self.nodata = Some(number()?),
            _ => {
                let problem = format!("unknown key `{key}`; allowed are {}", KEYS.join(", "));
                return Err(RasterError::header(path, line, problem));
            }
        }
        Ok(())
    }

    /// The empty raster that the header describes; `line` is its last line.
    fn raster(&self, path: &Path, line: usize) -> Result<Raster, RasterError> {
        let missing = |key: &str| RasterError::header(path, line, format!("the header ends without {key}"));
        let columns = self.columns.ok_or_else(|| missing("ncols"))?;
        let rows = self.rows.ok_or_else(|| missing("nrows"))?;
        let cell = self.cell.ok_or_else(|| missing("cellsize"))?;
        let height = self.height.unwrap_or(cell);
        if !(cell > 0.0 && height > 0.0) {
            let error = format!("the cell size must be above 0, found {}", cell.min(height));
            return Err(RasterError::header(path, line, error));
        }
        if (cell - height).abs() > 1e-6 * cell {
            return Err(RasterError::NotSquare { path: path.into(), width: cell, height });
        }
        let corner = |(at, centre): (f64, bool)| if centre { at - 0.5 * cell } else { at };
        let west = corner(self.west.ok_or_else(|| missing("xllcorner or xllcenter"))?);
        let south = corner(self.south.ok_or_else(|| missing("yllcorner or yllcenter"))?);
        Ok(Raster { columns, rows, west, south, cell, values: Vec::new(), crs: None })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Raster, RasterError> {
        parse(Path::new("dem.asc"), text.as_bytes(), &Declared::default())
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
        let message =
            Raster::from_bytes(Path::new("a.asc"), b"hello".to_vec(), None).unwrap_err().to_string();
        assert!(message.contains("a.asc is neither a GeoTIFF nor"), "{message}");
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
        let raster =
            read(&format!("{}nan 1 -9999", HEADER.replace("-1", "nan").replace("nrows 2", "nrows 1")));
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
            let raster = parse(Path::new("dem.asc"), text.as_bytes(), &beside).unwrap();
            raster.values.iter().map(|v| u8::from(v.is_nan())).collect::<Vec<_>>()
        };
        let body = "1 -9999 -3.4028234663852886e+38\n0 5 6\n";
        assert_eq!(missing(&grid("NODATA_value null\n", body), None), [0, 0, 0, 0, 1, 1]);
        assert_eq!(missing(&grid("NODATA_value\n", body), None), [0, 0, 0, 0, 1, 0]);
        assert_eq!(missing(&grid("", body), Some(0.0)), [1, 0, 0, 0, 0, 0]);
        assert_eq!(
            missing(&grid("NODATA_value 5\n", body), Some(0.0)),
            [0, 1, 0, 0, 0, 0],
            "the header first"
        );
    }

    #[test]
    fn refusals_name_line_key_and_cure() {
        let body = "1 2 3 4 5 6";
        let without = |key: &str| {
            HEADER.lines().filter(|l| !l.starts_with(key)).fold(String::new(), |a, l| a + l + "\n")
        };
        assert!(
            refused(&format!("{}{body}", without("ncols"))).contains("line 5: the header ends without ncols")
        );
        assert!(refused(&format!("{}{body}", without("xll"))).contains("xllcorner or xllcenter"));
        let odd = HEADER.replace("nrows 2", "nrows two");
        assert!(
            refused(&format!("{odd}{body}")).contains("line 2: nrows is a whole number above 0, found two")
        );
        assert!(
            refused(&format!("{HEADER}skew 2\n{body}"))
                .contains("line 7: unknown key `skew`; allowed are ncols")
        );
        let count = refused(&format!("{HEADER}1 2 3\n4 5"));
        assert!(
            count.contains("2 rows of 3 values = 6, but 5 values") && count.contains("line 8"),
            "{count}"
        );
        assert!(refused(&format!("{HEADER}1 2 3 4 5 6 7")).contains("but 7 values"));
        assert!(
            refused(&format!("{HEADER}1;2;3;4;5;6"))
                .contains("line 7: `1;2;3;4;5;6` is not a number; values are separated")
        );
        assert!(refused(&format!("{HEADER}1 2 3\n4 x 6")).contains("line 8: `x` is not a number"));
        let tall = HEADER.replace("cellsize 2", "dx 2\ndy 3");
        assert!(refused(&format!("{tall}{body}")).contains("gdalwarp -tr 2 2 -r bilinear dem.asc"));
        assert!(
            refused(&format!("{}{body}", HEADER.replace("size 2", "size -2"))).contains("above 0, found -2")
        );
        assert!(refused("hello world").contains("neither a GeoTIFF nor an ESRI ASCII grid"));
        assert!(refused("1 2 3").contains("it begins with `1`"));
        assert!(
            refused("ncols 3 nrows\n1 2").contains("line 1: a header line holds keys, each with a value")
        );
        assert!(refused("").contains("gdal_translate"));
    }

    #[test]
    fn the_system_comes_from_the_prj_beside_the_grid() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("dem.asc");
        std::fs::write(&path, format!("{HEADER}1 2 3\n4 5 6\n")).unwrap();
        assert_eq!(Raster::read(&path).unwrap().crs, None);
        std::fs::write(path.with_extension("prj"), "PROJCS[\"Here\",GEOGCS[\"G\"],UNIT[\"Meter\",1.0]]")
            .unwrap();
        assert_eq!(Raster::read(&path).unwrap().crs.map(|crs| crs.to_string()), Some("Here".into()));
        std::fs::write(path.with_extension("prj"), "Projection UTM").unwrap();
        let message = Raster::read(&path).unwrap_err().to_string();
        assert!(message.contains("dem.prj") && message.contains("crs = \"EPSG:xxxx\""), "{message}");
        let given = Crs { epsg: Some(31287), wkt: None };
        assert_eq!(Raster::read_in(&path, Some(&given)).unwrap().crs, Some(given));
    }
}
