//! What is said of values beside the values: nodata, scale, offset, unit, in GDAL's metadata of a TIFF and in the
//! `.aux.xml` file beside any raster.

use super::system::Heights;
use super::{RasterError, register};
use crate::Remark;
use std::path::{Path, PathBuf};
use tiff_reader::TiffFile;

/// What a file or its sidecar declares; nothing where it says nothing.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Declared {
    pub nodata: Option<f64>,
    pub scale: Option<f64>,
    pub offset: Option<f64>,
    /// Name of the unit of the values.
    pub unit: Option<String>,
    /// What the vertical coordinate system says.
    pub heights: Option<Heights>,
    /// Definition of the coordinate reference system.
    pub system: Option<String>,
    /// x of the north-western corner, width of a column, shift of x per row, the same for y.
    pub place: Option<[f64; 6]>,
    /// The `.msk` file: a value for each cell, the first row of the file first, 0 where there is none.
    pub mask: Option<Vec<f64>>,
}

impl Declared {
    /// The `.aux.xml` and `.msk` files beside a raster; nothing where there are none.
    pub fn beside(path: &Path) -> Result<Declared, RasterError> {
        Ok(Declared { mask: mask(&with_suffix(path, ".msk"))?, ..Declared::sidecar(path)? })
    }

    fn sidecar(path: &Path) -> Result<Declared, RasterError> {
        let sidecar = with_suffix(path, ".aux.xml");
        let text = match std::fs::read_to_string(&sidecar) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Declared::default()),
            Err(source) => return Err(RasterError::Io { path: sidecar, source }),
        };
        let error = |problem: String| RasterError::Declared { path: sidecar.clone(), problem };
        let document = roxmltree::Document::parse(&text).map_err(|e| {
            error(format!("it is no XML ({e}); delete it if what it says of nodata and units is not needed"))
        })?;
        let mut found = Declared::default();
        for node in document.root_element().children() {
            let text = node.text().map(str::trim).unwrap_or_default();
            match node.tag_name().name() {
                "SRS" => found.system = Some(text.to_string()).filter(|text| !text.is_empty()),
                "GeoTransform" => {
                    let numbers: Vec<f64> =
                        text.split(',').filter_map(|word| word.trim().parse().ok()).collect();
                    found.place = numbers.try_into().ok();
                }
                "PAMRasterBand" if matches!(node.attribute("band"), None | Some("1")) => {
                    for entry in node.children().filter(|entry| entry.is_element()) {
                        let text = entry.text().map(str::trim).unwrap_or_default();
                        found.take(entry.tag_name().name(), text).map_err(&error)?;
                    }
                }
                _ => {}
            }
        }
        Ok(found)
    }

    /// The metadata that GDAL keeps in a TIFF.
    pub fn inside(path: &Path, metadata: &str) -> Result<Declared, RasterError> {
        let mut found = Declared::default();
        let error = |problem: String| RasterError::Declared { path: path.into(), problem };
        let metadata = metadata.trim_matches(['\0', ' ', '\n']);
        if metadata.is_empty() {
            return Ok(found);
        }
        let document = roxmltree::Document::parse(metadata).map_err(|e| {
            let cure = format!("gdal_translate {} plain.tif", path.display());
            error(format!("its metadata is no XML ({e}); write it again with\n  {cure}"))
        })?;
        let of_band = |item: &roxmltree::Node| matches!(item.attribute("sample"), None | Some("0"));
        for item in document.descendants().filter(|node| node.has_tag_name("Item")).filter(of_band) {
            let key = match item.attribute("role") {
                Some("scale") => "Scale",
                Some("offset") => "Offset",
                Some("unittype") => "UnitType",
                _ => continue,
            };
            found.take(key, item.text().map(str::trim).unwrap_or_default()).map_err(&error)?;
        }
        Ok(found)
    }

    fn take(&mut self, key: &str, text: &str) -> Result<(), String> {
        let number = || match text.parse::<f64>() {
            Ok(number) => Ok(Some(number)),
            Err(_) => Err(format!("{key} is a number, found `{text}`")),
        };
        match key {
            "NoDataValue" => self.nodata = number()?,
            "Scale" => self.scale = number()?,
            "Offset" => self.offset = number()?,
            "UnitType" => self.unit = Some(text.to_string()).filter(|text| !text.is_empty()),
            _ => {}
        }
        Ok(())
    }

    /// What this says, and where it says nothing, what `other` says.
    pub fn or(self, other: Declared) -> Declared {
        Declared {
            nodata: self.nodata.or(other.nodata),
            scale: self.scale.or(other.scale),
            offset: self.offset.or(other.offset),
            unit: self.unit.or(other.unit),
            heights: self.heights.or(other.heights),
            system: self.system.or(other.system),
            place: self.place.or(other.place),
            mask: self.mask.or(other.mask),
        }
    }

    /// Whether a stored value stands for none.
    pub fn is_missing(&self, value: f64) -> bool {
        !value.is_finite() || self.nodata.is_some_and(|nodata| (value - nodata).abs() <= 1e-7 * nodata.abs())
    }

    /// Factor and offset that make metres of stored values, with notes on what is not 1 and 0.
    pub fn to_metres(&self, path: &Path, notes: &mut Vec<Remark>) -> Result<[f64; 2], RasterError> {
        let metres = self.unit_in_metres(path, notes)?;
        let [scale, offset] = [self.scale.unwrap_or(1.0), self.offset.unwrap_or(0.0)];
        if !(scale.is_finite() && scale != 0.0 && offset.is_finite()) {
            let problem = format!(
                "scale {scale} and offset {offset} make no values; write others with\n  gdal_edit.py -scale 1 -offset 0 {}",
                path.display()
            );
            return Err(RasterError::Declared { path: path.into(), problem });
        }
        if scale != 1.0 || offset != 0.0 {
            notes.push(Remark::Note(format!(
                "{}: stored values times {scale} plus {offset}, as it says",
                path.display()
            )));
        }
        if metres != 1.0 {
            notes.push(Remark::Note(format!(
                "{}: its unit of {metres} m was converted to metres",
                path.display()
            )));
        }
        Ok([scale * metres, offset * metres])
    }

    fn unit_in_metres(&self, path: &Path, notes: &mut Vec<Remark>) -> Result<f64, RasterError> {
        let error = |problem: String| RasterError::Declared { path: path.into(), problem };
        let cure = format!("gdal_edit.py -units m {}", path.display());
        let named = match &self.unit {
            Some(unit) => Some(register::length_named(unit).ok_or_else(|| {
                error(format!("its values are in `{unit}`, which is no unit of length that is known; if they are metres, say so with\n  {cure}"))
            })?),
            None => None,
        };
        match (named, self.heights) {
            (Some(named), Some(Heights::Unit(unit))) if (named - unit.abs()).abs() > 1e-9 => {
                Err(error(format!(
                    "its values are in units of {named} m, but its vertical coordinate system counts {unit} m; if they are metres, say so with\n  {cure}\nand name a system with that unit by gdal_edit.py -a_srs EPSG:xxxx"
                )))
            }
            (_, Some(Heights::Unit(unit))) => Ok(unit),
            (Some(named), _) => Ok(named),
            (None, Some(Heights::Unknown)) => {
                let text = "the unit of its heights is not known; metres were assumed";
                notes.push(Remark::Warning(format!("{}: {text}", path.display())));
                Ok(1.0)
            }
            (None, None) => Ok(1.0),
        }
    }
}

/// A mask file: a TIFF without position.
fn mask(path: &Path) -> Result<Option<Vec<f64>>, RasterError> {
    if !path.exists() {
        return Ok(None);
    }
    let unread =
        |e: &dyn std::fmt::Display| RasterError::geotiff(path, format!("the mask cannot be read: {e}"));
    let size = std::fs::metadata(path).map_err(|source| RasterError::Io { path: path.into(), source })?.len();
    let file = TiffFile::open(path).map_err(|e| unread(&e))?;
    super::room::plausible(path, &file, size)?;
    let opaque = file.read_band::<u8>(0, 0).map_err(|e| unread(&e))?;
    Ok(Some(opaque.into_iter().map(f64::from).collect()))
}

/// Makes values absent where a mask is 0.
pub(super) fn conceal(path: &Path, values: &mut [f64], opaque: &[f64]) -> Result<(), RasterError> {
    if values.len() != opaque.len() {
        let problem = format!("a mask of {} values for {} values", opaque.len(), values.len());
        return Err(RasterError::geotiff(path, problem));
    }
    for (value, _) in values.iter_mut().zip(opaque).filter(|(_, opaque)| **opaque == 0.0) {
        *value = f64::NAN;
    }
    Ok(())
}

/// The path with letters after its whole name.
pub(super) fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(suffix);
    name.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Declared, RasterError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("dem.tif");
        std::fs::write(folder.path().join("dem.tif.aux.xml"), text).unwrap();
        Declared::beside(&path)
    }

    #[test]
    fn a_sidecar_says_nodata_scale_unit_place_and_system() {
        let text = r#"<PAMDataset><SRS dataAxisToSRSAxisMapping="1,2">EPSG:31287</SRS>
            <GeoTransform>1.0, 5, 0, 6, 0, -5</GeoTransform>
            <PAMRasterBand band="1"><Description>z</Description><NoDataValue>-1e4</NoDataValue><UnitType>ft</UnitType>
            <Offset>3</Offset><Scale>2</Scale></PAMRasterBand><PAMRasterBand band="2"><Scale>9</Scale></PAMRasterBand>
            </PAMDataset>"#;
        let found = read(text).unwrap();
        assert_eq!((found.nodata, found.scale, found.offset), (Some(-1e4), Some(2.0), Some(3.0)));
        assert_eq!((found.unit.as_deref(), found.system.as_deref()), (Some("ft"), Some("EPSG:31287")));
        assert_eq!(found.place, Some([1.0, 5.0, 0.0, 6.0, 0.0, -5.0]));
        assert!(found.is_missing(-10_000.0) && found.is_missing(f64::NAN) && !found.is_missing(0.0));
        let mut notes = Vec::new();
        let [factor, offset] = found.to_metres(Path::new("dem.tif"), &mut notes).unwrap();
        assert!((factor - 0.6096).abs() < 1e-15 && (offset - 0.9144).abs() < 1e-15);
        assert!(
            notes[0].text().contains("times 2 plus 3") && notes[1].text().contains("0.3048 m was converted"),
            "{notes:?}"
        );
    }

    #[test]
    fn what_is_no_xml_no_number_and_no_unit_is_refused() {
        assert!(read("hello").unwrap_err().to_string().contains("dem.tif.aux.xml: it is no XML"));
        let error =
            read("<PAMDataset><PAMRasterBand band=\"1\"><Scale>1,5</Scale></PAMRasterBand></PAMDataset>");
        assert!(error.unwrap_err().to_string().contains("Scale is a number, found `1,5`"));
        let refused = |declared: Declared| {
            declared.to_metres(Path::new("dem.tif"), &mut Vec::new()).unwrap_err().to_string()
        };
        let ells = Declared { unit: Some("ells".into()), ..Declared::default() };
        assert!(refused(ells).contains("gdal_edit.py -units m dem.tif"));
        let both =
            Declared { unit: Some("m".into()), heights: Some(Heights::Unit(0.3048)), ..Declared::default() };
        assert!(refused(both).contains("counts 0.3048 m"));
        assert!(refused(Declared { scale: Some(0.0), ..Declared::default() }).contains("-scale 1 -offset 0"));
    }
}
