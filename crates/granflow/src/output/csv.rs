//! Profiles of a one-dimensional run as one tidy table: a line per instant and place, a column per quantity.
//!
//! `pandas.read_csv("profiles.csv").pivot(index="x", columns="time", values="thickness")` gives the wide form.

use super::frames::Frames;
use super::{Error, whole_file};
use std::fmt::Write as _;
use std::path::Path;

/// Writes `time,x,<field>,...` for every frame of the store; all fields lie on the same `x`. NaN stands as an empty cell.
///
/// # Errors
/// [`Error::Invalid`] if a field has another length than `x`; [`Error::Io`].
pub fn write(path: &Path, x: &[f64], frames: &mut Frames) -> Result<(), Error> {
    if let Some(field) = frames.fields().iter().find(|field| field.length != x.len()) {
        let problem = format!("field {} has {} values for {} places x", field.name, field.length, x.len());
        return Err(Error::invalid(path, problem));
    }
    whole_file(path, |out| {
        let names: Vec<_> = frames.fields().iter().map(|field| field.name.as_str()).collect();
        writeln!(out, "time,x,{}", names.join(","))?;
        let mut line = String::new();
        for frame in 0..frames.times().len() {
            let time = frames.times()[frame];
            let columns: Vec<_> = (0..frames.fields().len())
                .map(|field| frames.read(frame, field))
                .collect::<Result<_, _>>()
                .map_err(std::io::Error::other)?;
            for (row, x) in x.iter().enumerate() {
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
        let fields = ["thickness", "velocity_x"].map(|name| Field { name: name.into(), length: 2 });
        let mut frames =
            Frames::create(&folder.path().join("frames"), Precision::F64, fields.into()).unwrap();
        frames.append(0.0, &[&[1.0, 0.1 + 0.2], &[0.0, f64::NAN]]).unwrap();
        frames.append(0.5, &[&[1e-7, 2.0], &[-0.5, 3.0]]).unwrap();
        let path = folder.path().join("profiles.csv");
        write(&path, &[-1.0, 1.0], &mut frames).unwrap();
        assert_eq!(
            std::fs::read_to_string(&path).unwrap(),
            "time,x,thickness,velocity_x\n0.0,-1.0,1.0,0.0\n0.0,1.0,0.30000000000000004,\n\
             0.5,-1.0,1e-7,-0.5\n0.5,1.0,2.0,3.0\n"
        );
        assert!(write(&path, &[0.0], &mut frames).is_err());
    }
}
