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

/// Keys for one thing.
const SAME: [[&str; 2]; 3] = [["xllcorner", "xllcenter"], ["yllcorner", "yllcenter"], ["cellsize", "dx"]];

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
    let raster = parse(name, bytes, &sidecar, notes)?;
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
    /// Nodata is declared as a number that is not finite.
    endless: bool,
    /// What was set so far, and on which lines.
    seen: Vec<(String, usize)>,
}

fn parse(
    path: &Path,
    bytes: &[u8],
    beside: &Declared,
    notes: &mut Vec<Remark>,
) -> Result<Raster, RasterError> {
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
    let (mut infinite, mut first) = (0, 0);
    let mut values = Vec::with_capacity((columns * rows).min(bytes.len() / 2 + 1));
    for (content, line) in lines {
        for word in content.split_ascii_whitespace() {
            let found = || RasterError::Value { path: path.into(), line, found: word.to_string() };
            let value = number(word).ok_or_else(found)?;
            let near = |nodata: f64| (value - nodata).abs() <= 1e-7 * nodata.abs();
            let missing = !value.is_finite() || near(nodata) || header.null && near(NULL);
            if value.is_infinite() && !header.endless {
                (infinite, first) = (infinite + 1, if infinite == 0 { line } else { first });
            }
            values.push(if missing { f64::NAN } else { value });
            last = line;
        }
    }
    if values.len() != columns * rows {
        return Err(RasterError::Count { path: path.into(), rows, columns, found: values.len(), line: last });
    }
    if infinite > 0 {
        let place = format!(" (the first on line {first})");
        notes.push(super::infinite(path, infinite, &place));
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
        let lower = key.to_ascii_lowercase();
        self.once(path, line, &lower)?;
        match lower.as_str() {
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
                (self.nodata, self.endless) = (Some(NODATA), true);
            }
            "nodata_value" => self.nodata = Some(number()?),
            _ => {
                let problem = format!("unknown key `{key}`; allowed are {}", KEYS.join(", "));
                return Err(RasterError::header(path, line, problem));
            }
        }
        Ok(())
    }

    /// Refuses a key that was there before, by its own name or by another for the same.
    fn once(&mut self, path: &Path, line: usize, key: &str) -> Result<(), RasterError> {
        let same = |other: &str| {
            other == key || SAME.iter().any(|names| names.contains(&other) && names.contains(&key))
        };
        if let Some((other, first)) = self.seen.iter().find(|(other, _)| same(other)) {
            let problem = match other == key {
                true => format!("{key} stands on line {first} already; leave one of the two out"),
                false => {
                    format!("{key} says again what {other} says on line {first}; leave one of the two out")
                }
            };
            return Err(RasterError::header(path, line, problem));
        }
        self.seen.push((key.to_owned(), line));
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
mod tests;
