//! A table that grows: `gauges.csv`, `sections.csv`. Whole lines are appended, and a run that goes on cuts off those that its
//! checkpoint does not know.

use super::mark::{CURE, Mark};
use super::{Error, whole_file};
use std::fs::{self, File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};

/// A table on disk that lines are appended to.
#[derive(Debug)]
pub struct Lines {
    path: PathBuf,
    file: File,
    count: u64,
    crc: crc32fast::Hasher,
    /// Bytes up to the last line that is known.
    known: u64,
}

impl Lines {
    /// Begins a table with nothing but its header, over an older one.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be written.
    pub fn create(path: &Path, header: &str) -> Result<Lines, Error> {
        whole_file(path, |out| writeln!(out, "{header}"))?;
        let mut lines = Lines::over(path)?;
        lines.crc.update(header.as_bytes());
        Ok(lines)
    }

    fn over(path: &Path) -> Result<Lines, Error> {
        let file = OpenOptions::new().append(true).open(path).map_err(Error::io(path, "open"))?;
        Ok(Lines { path: path.to_owned(), file, count: 0, crc: crc32fast::Hasher::new(), known: 0 })
    }

    /// Takes a table up at a mark; [`Lines::cut`] cuts off what stands after it.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Mismatch`] where the header or the lines before the mark are not those of then.
    pub fn resume(path: &Path, header: &str, mark: Mark) -> Result<Lines, Error> {
        let mut from = BufReader::new(File::open(path).map_err(Error::io(path, "read"))?);
        let mut lines = Lines::over(path)?;
        let other = |what: String| Error::mismatch(path, format!("{what}; {CURE}"));
        let mut line = Vec::new();
        for number in 0..=mark.count {
            line.clear();
            lines.known += from.read_until(b'\n', &mut line).map_err(Error::io(path, "read"))? as u64;
            let Some(whole) = line.strip_suffix(b"\n") else {
                let lines = mark.count;
                return Err(other(format!(
                    "it holds {} whole lines below its header, the checkpoint goes on from {lines}",
                    number.saturating_sub(1)
                )));
            };
            if number == 0 && whole != header.as_bytes() {
                return Err(other(format!("line 1 should be the header {header}")));
            }
            lines.crc.update(whole);
        }
        lines.count = mark.count;
        if lines.mark() != mark {
            let count = mark.count;
            return Err(other(format!(
                "its first {count} lines are not those that the checkpoint goes on from"
            )));
        }
        Ok(lines)
    }

    /// Cuts off what stands after the mark at which the table was taken up.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn cut(&self) -> Result<(), Error> {
        self.file.set_len(self.known).map_err(Error::io(&self.path, "write"))
    }

    /// Appends whole lines, each with its end.
    ///
    /// # Errors
    /// [`Error::Io`]; on a full disk the file keeps the lines it had.
    pub fn append(&mut self, text: &str) -> Result<(), Error> {
        let before = self.file.metadata().map_err(Error::io(&self.path, "read"))?.len();
        if let Err(refused) = self.file.write_all(text.as_bytes()) {
            let _ = self.file.set_len(before); // if this fails too, a run that goes on cuts the torn line off
            return Err(Error::io(&self.path, "write")(refused));
        }
        for line in text.lines() {
            self.crc.update(line.as_bytes());
            self.count += 1;
        }
        Ok(())
    }

    /// Syncs the lines to disk, before a checkpoint counts on them.
    ///
    /// # Errors
    /// [`Error::Io`] if the disk refuses.
    pub fn sync(&self) -> Result<(), Error> {
        self.file.sync_data().map_err(Error::io(&self.path, "write"))
    }

    /// How far the table has come.
    #[must_use]
    pub fn mark(&self) -> Mark {
        Mark { count: self.count, crc: self.crc.clone().finalize() }
    }
}

/// A table of `name,time,...`: the same names at every instant.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// The columns after the first two.
    pub columns: Vec<String>,
    /// The names in their order.
    pub names: Vec<String>,
    /// The instants.
    pub times: Vec<f64>,
    /// The values of each column: those of all names at the first instant, then at the second, and so on; NaN is an empty
    /// cell.
    pub values: Vec<Vec<f64>>,
}

impl Table {
    /// Reads a table back.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Damaged`] naming the first line that does not fit.
    pub fn read(path: &Path) -> Result<Table, Error> {
        Self::parse(path, &fs::read_to_string(path).map_err(Error::io(path, "read"))?)
    }

    /// The table in a text; `path` is what messages call it.
    ///
    /// # Errors
    /// [`Error::Damaged`] naming the first line that does not fit.
    pub fn parse(path: &Path, text: &str) -> Result<Table, Error> {
        let mut lines = text.lines().zip(1..);
        let header = lines.next().map_or("", |(line, _)| line);
        let columns: Vec<String> = header.split(',').skip(2).map(str::to_owned).collect();
        let mut table = Table { values: vec![Vec::new(); columns.len()], columns, ..Table::default() };
        for (row, (line, number)) in lines.enumerate() {
            let wrong =
                || Error::damaged(path, format!("line {number} does not fit the lines before: {line:?}"));
            table.take(line, row).ok_or_else(wrong)?;
        }
        Ok(table)
    }

    /// Adds a line; `None` where it does not fit.
    fn take(&mut self, line: &str, row: usize) -> Option<()> {
        let cells: Vec<&str> = line.split(',').collect();
        if cells.len() != self.columns.len() + 2 {
            return None;
        }
        let number = |cell: &str| if cell.is_empty() { Some(f64::NAN) } else { cell.parse().ok() };
        let (name, time) = (cells[0], number(cells[1])?);
        if self.times.first().is_none_or(|first| *first == time) && !self.names.iter().any(|own| own == name)
        {
            self.names.push(name.to_owned());
        }
        if row.is_multiple_of(self.names.len()) {
            self.times.push(time);
        }
        if self.names[row % self.names.len()] != name || self.times.last() != Some(&time) {
            return None;
        }
        for (values, cell) in self.values.iter_mut().zip(&cells[2..]) {
            values.push(number(cell)?);
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "name,time,thickness";

    #[test]
    fn a_table_goes_on_from_its_mark_without_gap_or_double() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("gauges.csv");
        let mut lines = Lines::create(&path, HEADER).unwrap();
        lines.append("road,0.0,1.5\nhouse,0.0,\n").unwrap();
        let mark = lines.mark();
        lines.append("road,0.5,2.5\nhouse,0.5,0.25\n").unwrap();
        let whole = fs::read_to_string(&path).unwrap();
        fs::write(&path, format!("{whole}road,0.7")).unwrap();
        let mut again = Lines::resume(&path, HEADER, mark).unwrap();
        assert!(
            fs::read_to_string(&path).unwrap().ends_with("road,0.7"),
            "nothing is touched before it is to be"
        );
        again.cut().unwrap();
        again.append("road,0.5,2.5\nhouse,0.5,0.25\n").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), whole);
        assert_eq!(again.mark(), lines.mark());
        let table = Table::read(&path).unwrap();
        assert_eq!((table.names, table.times), (vec!["road".into(), "house".into()], vec![0.0, 0.5]));
        assert!(table.values[0][1].is_nan() && table.values[0][2..] == [2.5, 0.25]);
    }

    #[test]
    fn a_changed_or_short_table_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("gauges.csv");
        let mut lines = Lines::create(&path, HEADER).unwrap();
        lines.append("road,0.0,1.5\nroad,0.5,2.5\n").unwrap();
        let mark = lines.mark();
        let text = fs::read_to_string(&path).unwrap();
        let refused = |text: &str, part: &str| {
            fs::write(&path, text).unwrap();
            let message = Lines::resume(&path, HEADER, mark).unwrap_err().to_string();
            assert!(message.contains(part) && message.contains("gauges.csv"), "{message}");
        };
        refused(&text.replace("1.5", "1.6"), "first 2 lines are not those");
        refused(&text[..text.len() - 2], "1 whole lines below its header");
        refused(&text.replace("thickness", "depth"), "line 1 should be the header");
        fs::write(&path, "name,time,h\nroad,0.0,1.0\nroad,0.5\n").unwrap();
        assert!(Table::read(&path).unwrap_err().to_string().contains("line 3"));
    }
}
