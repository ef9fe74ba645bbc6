//! The ledger `mass.csv`: where the mass is at every output instant, and the sums it rests on.

use super::mark::{CURE, Mark};
use super::{Error, whole_file};
pub use crate::entry::Entry;
use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

/// The columns of the file, in order; the model names the five after `mass_out_`.
pub const COLUMNS: [&str; 15] = [
    "time",
    "step",
    "mass",
    "mass_in",
    "mass_out",
    "mass_out_left",
    "mass_out_right",
    "mass_out_bottom",
    "mass_out_top",
    "mass_out_nodata",
    "mass_error",
    "wet_cells",
    "moving_cells",
    "max_speed",
    "kinetic_energy",
];

/// The columns `mass_out_left`, ... among [`COLUMNS`].
const OUTLETS: std::ops::Range<usize> = 5..10;

/// The header with these names of the five outlets.
fn header(exits: [&str; 5]) -> String {
    let named = exits.map(|exit| format!("mass_out_{exit}"));
    let named = named.iter().map(String::as_str);
    let columns: Vec<&str> = COLUMNS[..OUTLETS.start]
        .iter()
        .copied()
        .chain(named)
        .chain(COLUMNS[OUTLETS.end..].iter().copied())
        .collect();
    columns.join(",")
}

/// Is it a header, whatever its outlets are called?
fn is_header(line: &str) -> bool {
    let columns: Vec<&str> = line.split(',').collect();
    let fits = |(k, column): (usize, &&str)| {
        if OUTLETS.contains(&k) { column.starts_with("mass_out_") } else { *column == COLUMNS[k] }
    };
    columns.len() == COLUMNS.len() && columns.iter().enumerate().all(fits)
}

/// A number of the file; NaN, what does not apply, is an empty cell.
fn cell(value: f64) -> String {
    if value.is_nan() { String::new() } else { format!("{value:?}") }
}

/// The checksum of a line without its end.
fn crc(line: &str) -> u32 {
    crc32fast::hash(line.as_bytes())
}

impl Entry {
    fn line(&self) -> String {
        let numbers = |values: &[f64]| values.iter().map(|&v| cell(v)).collect::<Vec<_>>().join(",");
        format!(
            "{},{},{},{},{},{},{},{}\n",
            cell(self.time),
            self.step,
            numbers(&[self.mass, self.mass_in, self.mass_out()]),
            numbers(&self.out),
            cell(self.mass_error),
            self.wet_cells,
            self.moving_cells,
            numbers(&[self.max_speed, self.kinetic_energy]),
        )
    }

    fn parse(line: &str) -> Option<Self> {
        let cells: Vec<_> = line.split(',').collect();
        if cells.len() != COLUMNS.len() {
            return None;
        }
        let number = |column: usize| match cells[column] {
            "" => Some(f64::NAN),
            cell => cell.parse::<f64>().ok(),
        };
        let count = |column: usize| cells[column].parse::<u64>().ok();
        Some(Self {
            time: number(0)?,
            step: count(1)?,
            mass: number(2)?,
            mass_in: number(3)?,
            out: [number(5)?, number(6)?, number(7)?, number(8)?, number(9)?],
            mass_error: number(10)?,
            wet_cells: count(11)?,
            moving_cells: count(12)?,
            max_speed: number(13)?,
            kinetic_energy: number(14)?,
        })
    }
}

/// The ledger on disk and in memory; a line is appended by one write, so the file is readable at every instant.
#[derive(Debug)]
pub struct Ledger {
    path: PathBuf,
    header: String,
    entries: Vec<Entry>,
    /// Checksums of the header and of the lines.
    crcs: Vec<u32>,
    /// The file ends with a line that a crash had torn.
    torn: bool,
}

impl Ledger {
    /// Starts a ledger with no lines at `path`, over an older one; `exits` names what [`Entry::out`] counts.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be written.
    pub fn create(path: &Path, exits: [&str; 5]) -> Result<Self, Error> {
        let header = header(exits);
        let crcs = vec![crc(&header)];
        let ledger = Self { path: path.to_owned(), header, entries: Vec::new(), crcs, torn: false };
        ledger.rewrite()?;
        Ok(ledger)
    }

    /// Reads a ledger back to go on with it; a torn last line is left out, and cut off before the file changes.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Damaged`] naming the first line that cannot be read.
    pub fn open(path: &Path) -> Result<Self, Error> {
        let bytes = fs::read(path).map_err(Error::io(path, "read"))?;
        // A byte that is no text makes a line that is none.
        let text = String::from_utf8_lossy(&bytes);
        let mut lines = text.split_inclusive('\n').enumerate();
        let header = lines.next().map_or("", |(_, line)| line.trim_end());
        if !is_header(header) {
            let problem = format!("line 1 should be the header {}; {CURE}", COLUMNS.join(","));
            return Err(Error::damaged(path, problem));
        }
        let (mut entries, mut crcs) = (Vec::new(), vec![crc(header)]);
        let mut torn = false;
        for (number, line) in lines {
            match line.strip_suffix('\n').map(|line| line.trim_end_matches('\r')) {
                None => torn = true, // only the last line can lack its end
                Some(line) => {
                    entries.push(Entry::parse(line).ok_or_else(|| {
                        let problem = format!("line {} is no line of a ledger: {line:?}; {CURE}", number + 1);
                        Error::damaged(path, problem)
                    })?);
                    crcs.push(crc(line));
                }
            }
        }
        Ok(Self { path: path.to_owned(), header: header.to_owned(), entries, crcs, torn })
    }

    /// Appends a line.
    ///
    /// # Errors
    /// [`Error::Io`]; on a full disk the file keeps the lines it had.
    pub fn append(&mut self, entry: Entry) -> Result<(), Error> {
        if std::mem::take(&mut self.torn) {
            self.rewrite()?;
        }
        let mut file =
            OpenOptions::new().append(true).open(&self.path).map_err(Error::io(&self.path, "open"))?;
        let before = file.metadata().map_err(Error::io(&self.path, "read"))?.len();
        let line = entry.line();
        if let Err(refused) = file.write_all(line.as_bytes()) {
            let _ = file.set_len(before); // if this fails too, `open` drops the torn line
            return Err(Error::io(&self.path, "write")(refused));
        }
        self.crcs.push(crc(line.trim_end()));
        self.entries.push(entry);
        Ok(())
    }

    /// Syncs the lines to disk, before a checkpoint counts on them.
    ///
    /// # Errors
    /// [`Error::Io`] if the disk refuses.
    pub fn sync(&self) -> Result<(), Error> {
        let file = OpenOptions::new().append(true).open(&self.path).map_err(Error::io(&self.path, "open"))?;
        file.sync_data().map_err(Error::io(&self.path, "write"))
    }

    /// How far the ledger has come: the lines, and a checksum of the header and of all of them.
    #[must_use]
    pub fn mark(&self) -> Mark {
        self.mark_at(self.entries.len())
    }

    fn mark_at(&self, count: usize) -> Mark {
        let mut crc = crc32fast::Hasher::new();
        self.crcs[..=count].iter().for_each(|line| crc.update(&line.to_le_bytes()));
        Mark { count: count as u64, crc: crc.finalize() }
    }

    /// Are the lines up to `mark` those of then?
    ///
    /// # Errors
    /// [`Error::Mismatch`] if they are not.
    pub fn fits(&self, mark: Mark) -> Result<(), Error> {
        let (before, count) = (self.entries.len(), mark.count as usize);
        if count > before || self.mark_at(count) != mark {
            let what = if count > before {
                format!("it holds {before} lines below its header, the checkpoint goes on from {count}")
            } else {
                format!("its first {count} lines are not those that the checkpoint goes on from")
            };
            return Err(Error::mismatch(&self.path, format!("{what}; {CURE}")));
        }
        Ok(())
    }

    /// Drops the lines after `mark`, where the checkpoint was written that a run goes on from; returns how many.
    ///
    /// # Errors
    /// As [`Ledger::fits`]; [`Error::Io`], the file then keeps all its lines.
    pub fn truncate_to(&mut self, mark: Mark) -> Result<usize, Error> {
        self.fits(mark)?;
        let (before, count) = (self.entries.len(), mark.count as usize);
        self.entries.truncate(count);
        self.crcs.truncate(count + 1);
        self.torn = false;
        self.rewrite()?;
        Ok(before - count)
    }

    /// The lines, in the order they were written.
    #[must_use]
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// [`Ledger::entries`], to keep.
    #[must_use]
    pub fn into_entries(self) -> Vec<Entry> {
        self.entries
    }

    fn rewrite(&self) -> Result<(), Error> {
        whole_file(&self.path, |out| {
            writeln!(out, "{}", self.header)?;
            self.entries.iter().try_for_each(|entry| out.write_all(entry.line().as_bytes()))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDES: [&str; 5] = ["left", "right", "bottom", "top", "nodata"];

    fn entry(step: u64) -> Entry {
        Entry {
            time: step as f64 / 3.0,
            step,
            mass: 0.1,
            mass_in: 1e300,
            out: [1e-17, 2.0, 0.0, f64::NAN, -0.0],
            wet_cells: 12,
            max_speed: f64::INFINITY,
            ..Entry::default()
        }
    }

    #[test]
    fn lines_come_back_and_a_torn_one_is_dropped() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mass.csv");
        let mut ledger = Ledger::create(&path, SIDES).unwrap();
        (0..4).for_each(|step| ledger.append(entry(step)).unwrap());
        let read = Ledger::open(&path).unwrap();
        assert_eq!(format!("{:?}", read.entries()), format!("{:?}", ledger.entries()));
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("time,step,mass,mass_in,mass_out,") && text.lines().count() == 5);
        fs::write(&path, &text[..text.len() - 5]).unwrap();
        let mut read = Ledger::open(&path).unwrap();
        assert_eq!(read.entries().len(), 3);
        read.append(entry(3)).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), text);
    }

    #[test]
    fn truncating_goes_back_to_the_checkpoint() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mass.csv");
        let mut ledger = Ledger::create(&path, SIDES).unwrap();
        (0..4).for_each(|step| ledger.append(entry(step)).unwrap());
        let (four, two) = (ledger.mark(), ledger.mark_at(2));
        let whole = fs::read_to_string(&path).unwrap();
        assert_eq!(ledger.truncate_to(two).unwrap(), 2);
        let mut ledger = Ledger::open(&path).unwrap();
        assert_eq!((ledger.entries().last().unwrap().step, ledger.mark()), (1, two));
        let lost = ledger.truncate_to(four).unwrap_err().to_string();
        assert!(lost.contains("2 lines below its header") && lost.contains("from 4"), "{lost}");
        fs::write(&path, whole.replacen("0.1", "0.2", 1)).unwrap();
        let other = Ledger::open(&path).unwrap().truncate_to(four).unwrap_err().to_string();
        assert!(other.contains("first 4 lines are not those"), "{other}");
        fs::write(&path, whole).unwrap();
        assert_eq!(Ledger::open(&path).unwrap().truncate_to(four).unwrap(), 0);
    }

    #[test]
    fn the_outlets_are_named_and_what_does_not_apply_is_left_out() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mass.csv");
        let mut ledger = Ledger::create(&path, ["left", "right", "bottom", "top", "hole"]).unwrap();
        let entry = Entry { out: [0.5; 5], max_speed: f64::NAN, kinetic_energy: f64::NAN, ..entry(1) };
        ledger.append(entry).unwrap();
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.lines().next().unwrap().contains("mass_out_top,mass_out_hole,mass_error"), "{text}");
        assert!(text.ends_with(",12,0,,\n"), "{text}");
        let read = Ledger::open(&path).unwrap();
        assert_eq!((read.entries()[0].out[4], read.entries()[0].max_speed.is_nan()), (0.5, true));
        let mut read = Ledger::open(&path).unwrap();
        assert_eq!(read.truncate_to(read.mark()).unwrap(), 0);
        assert_eq!(fs::read_to_string(&path).unwrap(), text);
    }

    #[test]
    fn a_foreign_line_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mass.csv");
        fs::write(&path, format!("{}\n1,2,3\n", COLUMNS.join(","))).unwrap();
        assert!(Ledger::open(&path).unwrap_err().to_string().contains("line 2"));
        fs::write(&path, "a,b\n").unwrap();
        assert!(Ledger::open(&path).unwrap_err().to_string().contains("line 1"));
    }
}
