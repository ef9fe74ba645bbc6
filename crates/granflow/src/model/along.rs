//! What passed along the path of a mass: over time and the distance along it.

use crate::output::frames::Frames;
use crate::output::{Error, whole_file};
use std::collections::BTreeMap;
use std::path::Path;

/// The largest thickness and speed near each place of a path at each instant.
#[derive(Debug, Clone, PartialEq)]
pub struct Along {
    /// What counts lies within half of this from the path; the table that [`Along::write`] writes does not say it.
    pub width: Option<f64>,
    /// The places: distances along the path, and where they are.
    pub distance: Vec<f64>,
    /// Coordinates of the places.
    pub places: Vec<[f64; 2]>,
    /// The instants.
    pub times: Vec<f64>,
    /// The largest thickness, a row of instants for each place; NaN where nothing is thicker than the threshold.
    pub thickness: Vec<f64>,
    /// The largest speed of layers thicker than the threshold, as the thickness.
    pub speed: Vec<f64>,
}

impl Along {
    /// Along the line through `points`, from the frames of a run whose cells have these centres; none of a line shorter than two cells.
    ///
    /// # Errors
    /// [`Error`] of a frame that cannot be read.
    pub fn of(
        (points, width): (&[[f64; 2]], f64),
        [x, y]: [&[f64]; 2],
        threshold: f64,
        frames: &mut Frames,
    ) -> Result<Option<Along>, Error> {
        let (Some(thickness), Some(speed)) = (frames.position("thickness"), frames.position("speed")) else {
            return Ok(None);
        };
        let length: f64 = points.windows(2).map(|pair| apart(pair[0], pair[1])).sum();
        let [Some(cell), Some(_)] = [x, y].map(|c| c.get(1).map(|second| second - c[0])) else {
            return Ok(None);
        };
        let count = (length / cell).round() as usize;
        if count < 2 {
            return Ok(None);
        }
        let (step, times) = (length / count as f64, frames.times().to_vec());
        let distance: Vec<f64> = (0..count).map(|k| (k as f64 + 0.5) * step).collect();
        let places = distance.iter().map(|distance| at(points, *distance)).collect();
        let nothing = vec![f64::NAN; count * times.len()];
        let mut along =
            Along { width: Some(width), distance, places, times, thickness: nothing.clone(), speed: nothing };
        let near = near(points, 0.5 * width, [x, y]);
        for instant in 0..along.times.len() {
            let (h, u) = (frames.read(instant, thickness)?, frames.read(instant, speed)?);
            for (&cell, &(_, distance)) in near.iter().filter(|(cell, _)| h[**cell] > threshold) {
                let place = ((distance / step) as usize).min(count - 1) * along.times.len() + instant;
                // `max` takes the number of the two.
                along.thickness[place] = along.thickness[place].max(h[cell]);
                along.speed[place] = along.speed[place].max(u[cell]);
            }
        }
        Ok(Some(along))
    }

    /// Writes it as a table, a line for each place at each instant; what has no value is an empty cell.
    ///
    /// # Errors
    /// [`Error`] if the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let cell = |value: f64| if value.is_nan() { String::new() } else { format!("{value:?}") };
        whole_file(path, |out| {
            writeln!(out, "{HEADER}")?;
            for (instant, time) in self.times.iter().enumerate() {
                for (k, (distance, [x, y])) in self.distance.iter().zip(&self.places).enumerate() {
                    let [h, u] =
                        [&self.thickness, &self.speed].map(|map| cell(map[k * self.times.len() + instant]));
                    writeln!(out, "{time:?},{distance:?},{x:?},{y:?},{h},{u}")?;
                }
            }
            Ok(())
        })
    }
}

/// The first line of the table.
const HEADER: &str = "time,distance,x,y,thickness,speed";

impl Along {
    /// Reads back what [`Along::write`] wrote.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Damaged`] naming the first line that does not fit.
    pub fn read(path: &Path) -> Result<Along, Error> {
        let text = std::fs::read_to_string(path).map_err(Error::io(path, "read"))?;
        let wrong = |number: usize, line: &str| {
            Error::damaged(path, format!("line {number} does not fit the lines before: {line:?}"))
        };
        let mut lines = text.lines().zip(1..);
        let header = lines.next().map_or("", |(line, _)| line);
        if header != HEADER {
            return Err(wrong(1, header));
        }
        let rows: Vec<[f64; 6]> = lines
            .map(|(line, number)| row(line).ok_or_else(|| wrong(number, line)))
            .collect::<Result<_, _>>()?;
        let count = rows.iter().take_while(|row| row[0] == rows[0][0]).count();
        for (number, one) in rows.iter().enumerate() {
            if one[1..4] != rows[number % count][1..4] || one[0] != rows[number - number % count][0] {
                return Err(wrong(number + 2, text.lines().nth(number + 1).unwrap_or_default()));
            }
        }
        if count == 0 || !rows.len().is_multiple_of(count) {
            return Err(Error::damaged(path, "its last instant is not whole".to_owned()));
        }
        let of = |column: usize| -> Vec<f64> {
            (0..count)
                .flat_map(|place| rows[place..].iter().step_by(count).map(move |row| row[column]))
                .collect()
        };
        Ok(Along {
            width: None,
            distance: rows[..count].iter().map(|row| row[1]).collect(),
            places: rows[..count].iter().map(|row| [row[2], row[3]]).collect(),
            times: rows.iter().step_by(count).map(|row| row[0]).collect(),
            thickness: of(4),
            speed: of(5),
        })
    }
}

/// The numbers of a line of the table; an empty cell is none.
fn row(line: &str) -> Option<[f64; 6]> {
    let number = |cell: &str| if cell.is_empty() { Some(f64::NAN) } else { cell.parse().ok() };
    line.split(',').map(number).collect::<Option<Vec<f64>>>()?.try_into().ok()
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

/// The point of a line at a distance from its begin.
fn at(points: &[[f64; 2]], mut distance: f64) -> [f64; 2] {
    for pair in points.windows(2) {
        let length = apart(pair[0], pair[1]);
        if distance <= length && length > 0.0 {
            return [0, 1].map(|k| pair[0][k] + (pair[1][k] - pair[0][k]) * distance / length);
        }
        distance -= length;
    }
    points[points.len() - 1]
}

/// The cells whose centres lie within `reach` of a line, each with its distance from the line and that of the nearest point along it.
fn near(points: &[[f64; 2]], reach: f64, [x, y]: [&[f64]; 2]) -> BTreeMap<usize, (f64, f64)> {
    let mut cells: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
    let mut begin = 0.0;
    for pair in points.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let length = apart(from, to);
        let within = |centres: &[f64], k: usize| {
            let low = from[k].min(to[k]) - reach;
            let high = from[k].max(to[k]) + reach;
            centres.partition_point(|c| *c < low)..centres.partition_point(|c| *c <= high)
        };
        for row in within(y, 1) {
            for column in within(x, 0) {
                let beyond = [x[column] - from[0], y[row] - from[1]];
                let along = (beyond[0] * (to[0] - from[0]) + beyond[1] * (to[1] - from[1])) / length;
                let along = if length > 0.0 { along.clamp(0.0, length) } else { 0.0 };
                let foot = at(&[from, to], along);
                let off = apart(foot, [x[column], y[row]]);
                let held = cells.entry(row * x.len() + column).or_insert((f64::INFINITY, 0.0));
                if off < held.0 {
                    *held = (off, begin + along);
                }
            }
        }
        begin += length;
    }
    cells.retain(|_, (off, _)| *off <= reach);
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::Precision;
    use crate::output::frames::Field;

    /// A layer of which the numbers are known: around a bend each place has the largest of its own cells.
    #[test]
    fn each_place_has_the_largest_of_the_cells_near_it() {
        let folder = tempfile::tempdir().unwrap();
        let centres: Vec<f64> = (0..20).map(|k| f64::from(k) + 0.5).collect();
        let field = |name: &str| Field { name: name.to_owned(), length: 400 };
        let fields = vec![field("thickness"), field("speed")];
        let mut frames = Frames::create(&folder.path().join("frames.bin"), Precision::F64, fields).unwrap();
        let thickness: Vec<f64> =
            (0..400).map(|k| f64::from(k % 20 + 1) + 0.01 * f64::from(k / 20)).collect();
        let speed: Vec<f64> = thickness.iter().map(|h| 2.0 * h).collect();
        frames.append(0.0, &[&thickness, &speed]).unwrap();
        frames.append(1.0, &[&vec![0.0; 400], &speed]).unwrap();
        let points = [[2.0, 10.0], [12.0, 10.0], [12.0, 16.0]];
        let along = Along::of((&points, 4.0), [&centres, &centres], 0.5, &mut frames).unwrap().unwrap();
        assert_eq!((along.distance.len(), along.distance[0], along.distance[15]), (16, 0.5, 15.5));
        assert_eq!((along.places[3], along.places[12]), ([5.5, 10.0], [12.0, 12.5]));
        // Column 5 (of 6 thick), rows 8 to 11; beside the second part columns 10 to 13.
        assert!((along.thickness[2 * 3] - 6.11).abs() < 1e-12, "{}", along.thickness[6]);
        assert!((along.thickness[2 * 12] - 14.12).abs() < 1e-12, "{}", along.thickness[24]);
        assert!((along.speed[2 * 12] - 28.24).abs() < 1e-12);
        assert!(along.thickness.iter().skip(1).step_by(2).all(|h| h.is_nan()), "nothing is left");
        let path = folder.path().join("range_time.csv");
        along.write(&path).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let read = Along::read(&path).unwrap();
        assert_eq!(
            (read.width, &read.distance, &read.places, &read.times),
            (None, &along.distance, &along.places, &along.times)
        );
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&read.thickness), bits(&along.thickness));
        assert_eq!(bits(&read.speed), bits(&along.speed));
        std::fs::write(&path, &text[..text.len() - 12]).unwrap();
        assert!(Along::read(&path).unwrap_err().to_string().contains("line 33 does not fit"));
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            (lines.len(), lines[4], lines[20]),
            (33, "0.0,3.5,5.5,10.0,6.11,12.22", "1.0,3.5,5.5,10.0,,")
        );
        assert_eq!(Along::of((&points[..1], 4.0), [&centres, &centres], 0.5, &mut frames).unwrap(), None);
    }
}
