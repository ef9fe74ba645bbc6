//! Frames for ParaView: one `.vti` (image data) per instant and a `.pvd` that names their times.

use super::base64::base64;
use super::{Error, Precision, whole_file};
use std::path::Path;

/// The grid of a frame; for one dimension one row of height `spacing[0]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Image {
    /// Cells along x and y.
    pub cells: [usize; 2],
    /// The lower left corner.
    pub origin: [f64; 2],
    /// Size of a cell along x and y, positive.
    pub spacing: [f64; 2],
}

impl Image {
    /// Cells, the length of a field that lies in them.
    #[must_use]
    pub const fn cell_count(&self) -> usize {
        self.cells[0] * self.cells[1]
    }

    /// Nodes, the length of a field that lies on the cells' corners.
    #[must_use]
    pub const fn node_count(&self) -> usize {
        (self.cells[0] + 1) * (self.cells[1] + 1)
    }
}

/// Writes one frame; a field has [`Image::cell_count`] or [`Image::node_count`] values, its rows from low y to
/// high y.
///
/// # Errors
/// [`Error::Invalid`] if a field has another length; [`Error::Io`].
pub fn write_frame(
    path: &Path,
    image: Image,
    precision: Precision,
    fields: &[(&str, &[f64])],
) -> Result<(), Error> {
    let (cells, nodes) = (image.cell_count(), image.node_count());
    if let Some((name, values)) =
        fields.iter().find(|(_, values)| values.len() != cells && values.len() != nodes)
    {
        let problem =
            format!("field {name} has {} values, the grid {cells} cells and {nodes} nodes", values.len());
        return Err(Error::invalid(path, problem));
    }
    let ([nx, ny], [x, y], [dx, dy]) = (image.cells, image.origin, image.spacing);
    let kind = match precision {
        Precision::F32 => "Float32",
        Precision::F64 => "Float64",
    };
    whole_file(path, |out| {
        writeln!(out, r#"<?xml version="1.0"?>"#)?;
        writeln!(
            out,
            r#"<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64">"#
        )?;
        let extent = format!("0 {nx} 0 {ny} 0 0");
        writeln!(
            out,
            r#"<ImageData WholeExtent="{extent}" Origin="{x:?} {y:?} 0" Spacing="{dx:?} {dy:?} 1"><Piece Extent="{extent}">"#
        )?;
        for (part, length) in [("PointData", nodes), ("CellData", cells)] {
            writeln!(out, "<{part}>")?;
            for (name, values) in fields.iter().filter(|(_, values)| values.len() == length) {
                let name = escape(name);
                writeln!(out, r#"<DataArray type="{kind}" Name="{name}" format="binary">"#)?;
                let mut bytes = ((values.len() * precision.width()) as u64).to_le_bytes().to_vec();
                precision.encode(values, &mut bytes);
                writeln!(out, "{}\n</DataArray>", base64(&bytes))?;
            }
            writeln!(out, "</{part}>")?;
        }
        writeln!(out, "</Piece></ImageData></VTKFile>")
    })
}

/// Writes the collection that ParaView opens: times and the names of their frames, relative to its own folder.
///
/// # Errors
/// [`Error::Io`] if the file cannot be written.
pub fn write_collection(path: &Path, frames: &[(f64, String)]) -> Result<(), Error> {
    whole_file(path, |out| {
        writeln!(out, r#"<?xml version="1.0"?>"#)?;
        writeln!(out, r#"<VTKFile type="Collection" version="0.1" byte_order="LittleEndian"><Collection>"#)?;
        for (time, file) in frames {
            writeln!(out, r#"<DataSet timestep="{time:?}" group="" part="0" file="{}"/>"#, escape(file))?;
        }
        writeln!(out, "</Collection></VTKFile>")
    })
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn fields_go_to_cells_or_nodes_by_their_length() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("frame.vti");
        let image = Image { cells: [2, 1], origin: [0.5, -1.0], spacing: [0.25, 1.0] };
        write_frame(&path, image, Precision::F64, &[("v & w", &[1.0, 2.0]), ("u", &[0.0; 6])]).unwrap();
        let text = fs::read_to_string(&path).unwrap();
        assert!(
            text.contains(r#"WholeExtent="0 2 0 1 0 0" Origin="0.5 -1.0 0" Spacing="0.25 1.0 1""#),
            "{text}"
        );
        let (points, cells) = text.split_once("</PointData>").unwrap();
        assert!(points.contains("\"u\"") && cells.contains("\"v &amp; w\""));
        // 16 as u64, then 1.0 and 2.0 as f64, in base64.
        assert!(cells.contains("EAAAAAAAAAAAAAAAAADwPwAAAAAAAABA"), "{cells}");
        let wrong = write_frame(&path, image, Precision::F64, &[("v", &[1.0; 3])]).unwrap_err().to_string();
        assert!(wrong.contains("3 values") && wrong.contains("2 cells and 6 nodes"), "{wrong}");
    }

    #[test]
    fn the_collection_names_times_and_files() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result.pvd");
        write_collection(&path, &[(0.0, "a<0>.vti".into()), (0.1, "b.vti".into())]).unwrap();
        let text = fs::read_to_string(&path).unwrap();
        assert!(
            text.contains(r#"timestep="0.0" group="" part="0" file="a&lt;0&gt;.vti""#)
                && text.contains("\"0.1\"")
        );
    }
}
