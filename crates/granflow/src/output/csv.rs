//! Profiles of a one-dimensional run as one tidy table: a line per instant and place, a column per quantity.
//!
//! `pandas.read_csv("profiles.csv").pivot(index="x", columns="time", values="thickness")` gives the wide form.

use super::frames::Frames;
use super::{Error, whole_file};
use std::fmt::Write as _;
use std::path::Path;

/// Writes `time,<axis>,<field>,...` for every frame of the store, with the fields that have a value for each place
/// of the axis. NaN stands as an empty cell.
///
/// # Errors
/// [`Error::Invalid`] if no field has the length of the axis; [`Error::Io`].
pub fn write(path: &Path, (axis, places): (&str, &[f64]), frames: &mut Frames) -> Result<(), Error> {
    let all = 0..frames.fields().len();
    let fields: Vec<usize> = all.filter(|&field| frames.fields()[field].length == places.len()).collect();
    if fields.is_empty() {
        return Err(Error::invalid(
            path,
            format!("no field has {} values, one for each {axis}", places.len()),
        ));
    }
    whole_file(path, |out| {
        let names: Vec<_> = fields.iter().map(|&field| frames.fields()[field].name.as_str()).collect();
        writeln!(out, "time,{axis},{}", names.join(","))?;
        let mut line = String::new();
        for frame in 0..frames.times().len() {
            let time = frames.times()[frame];
            let columns: Vec<_> = fields
                .iter()
                .map(|&field| frames.read(frame, field))
                .collect::<Result<_, _>>()
                .map_err(std::io::Error::other)?;
            for (row, x) in places.iter().enumerate() {
                line.clear();
                let _ = write!(line, "{time:?},{x:?}"); // a String takes everything
                for value in columns.iter().map(|column| column[row]) {
                    let _ = if value.is_nan() { write!(line, ",") } else { write!(line, ",{value:?}") };
                }
                line.push('\n');
                out.write_all(line.as_bytes())?;
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::Precision;
    use crate::output::frames::Field;

    #[test]
    fn one_line_per_instant_and_place() {
        let folder = tempfile::tempdir().unwrap();
        let fields = [("thickness", 2), ("velocity_x", 2), ("elsewhere", 1)];
        let fields = fields.map(|(name, length)| Field { name: name.into(), length });
        let mut frames =
            Frames::create(&folder.path().join("frames"), Precision::F64, fields.into()).unwrap();
        frames.append(0.0, &[&[1.0, 0.1 + 0.2], &[0.0, f64::NAN], &[9.0]]).unwrap();
        frames.append(0.5, &[&[1e-7, 2.0], &[-0.5, 3.0], &[9.0]]).unwrap();
        let path = folder.path().join("profiles.csv");
        write(&path, ("x", &[-1.0, 1.0]), &mut frames).unwrap();
        assert_eq!(
            std::fs::read_to_string(&path).unwrap(),
            "time,x,thickness,velocity_x\n0.0,-1.0,1.0,0.0\n0.0,1.0,0.30000000000000004,\n\
             0.5,-1.0,1e-7,-0.5\n0.5,1.0,2.0,3.0\n"
        );
        assert!(write(&path, ("x", &[0.0; 3]), &mut frames).is_err());
        write(&path, ("x_node", &[7.0]), &mut frames).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(text, "time,x_node,elsewhere\n0.0,7.0,9.0\n0.5,7.0,9.0\n");
    }
}
