//! What the files that a case names hold, so that a run does not go on with others than it began with.

use super::Error;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// A file that a run was made of, or that it left.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Input {
    /// Its name, as the case writes it.
    pub name: String,
    /// Its length.
    pub bytes: u64,
    /// The CRC-32 of its content.
    pub crc: u32,
}

/// Endings that a name gets: what GDAL writes of a raster's values, and its mask.
const BEHIND: [&str; 2] = [".aux.xml", ".msk"];
/// Endings of the files that are read with another of the same name: projection, attributes, index, code page, place.
const BESIDE: [&str; 10] = ["prj", "PRJ", "dbf", "DBF", "shx", "SHX", "cpg", "CPG", "tfw", "TFW"];

/// The files at `paths` and those that are read with them; `name` says how the case writes a path.
///
/// # Errors
/// [`Error::Io`] naming the file that cannot be read.
pub fn inputs(paths: &[PathBuf], name: impl Fn(&Path) -> PathBuf) -> Result<Vec<Input>, Error> {
    let beside = |path: &PathBuf| BESIDE.map(|ending| path.with_extension(ending));
    let behind = |path: &PathBuf| {
        BEHIND.map(|ending| {
            let mut name = path.clone().into_os_string();
            name.push(ending);
            PathBuf::from(name)
        })
    };
    let others = paths.iter().flat_map(beside).chain(paths.iter().flat_map(behind));
    let mut all: Vec<PathBuf> = others.filter(|path| path.is_file()).collect();
    all.extend_from_slice(paths);
    all.sort();
    all.dedup();
    all.iter().map(|path| Input::of(path, &name(path))).collect()
}

impl Input {
    /// A file that a run left, called `name`. A file that ends with its own CRC-32, as a checkpoint does, has the same CRC-32
    /// whatever it holds: its last bytes are taken twice.
    pub(super) fn left(path: &Path, name: &Path) -> Result<Input, Error> {
        let mut input = Self::of(path, name)?;
        let mut file = File::open(path).map_err(Error::io(path, "read"))?;
        let mut end = Vec::new();
        file.seek(SeekFrom::Start(input.bytes.saturating_sub(4)))
            .and_then(|_| file.read_to_end(&mut end))
            .map_err(Error::io(path, "read"))?;
        let mut twice = crc32fast::Hasher::new_with_initial_len(input.crc, input.bytes);
        twice.update(&end);
        input.crc = twice.finalize();
        Ok(input)
    }

    /// The CRC-32 over a list of files.
    pub(super) fn checksum(files: &[Input]) -> u32 {
        let mut crc = crc32fast::Hasher::new();
        crc.update(&(files.len() as u64).to_le_bytes());
        for Input { name, bytes, crc: own } in files {
            // A zero ends the name.
            crc.update(name.as_bytes());
            crc.update(&[0]);
            crc.update(&bytes.to_le_bytes());
            crc.update(&own.to_le_bytes());
        }
        crc.finalize()
    }

    /// The file at `path`, called `name`.
    pub(super) fn of(path: &Path, name: &Path) -> Result<Input, Error> {
        let mut file = File::open(path).map_err(Error::io(path, "read"))?;
        let (mut crc, mut bytes, mut part) = (crc32fast::Hasher::new(), 0, vec![0; 1 << 18]);
        loop {
            let read = file.read(&mut part).map_err(Error::io(path, "read"))?;
            if read == 0 {
                return Ok(Input { name: name.to_string_lossy().into_owned(), bytes, crc: crc.finalize() });
            }
            crc.update(&part[..read]);
            bytes += read as u64;
        }
    }
}

/// The first difference between the inputs of a checkpoint and those of now, in words.
pub(super) fn difference(then: &[Input], now: &[Input]) -> Option<String> {
    let find = |list: &[Input], name: &str| list.iter().find(|one| one.name == name).cloned();
    let changed = then.iter().find_map(|old| match find(now, &old.name) {
        None => Some(format!("the run began with {}, which is not there any more", old.name)),
        Some(new) if new != *old => {
            let Input { name, bytes, .. } = old;
            Some(format!("{name} is not what the run began with ({bytes} bytes then, {} now)", new.bytes))
        }
        Some(_) => None,
    });
    let added = || {
        let new = now.iter().find(|new| find(then, &new.name).is_none())?;
        Some(format!("{} was not there when the run began", new.name))
    };
    changed.or_else(added)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn files_that_end_with_their_checksum_are_told_apart() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("state.bin");
        let of = |text: &[u8]| {
            fs::write(&path, [text, &crc32fast::hash(text).to_le_bytes()].concat()).unwrap();
            [Input::of(&path, &path).unwrap().crc, Input::left(&path, &path).unwrap().crc]
        };
        let [[one, left_one], [two, left_two]] = [of(b"one"), of(b"two")];
        assert!(one == two && left_one != left_two);
        fs::write(&path, "x").unwrap();
        assert_eq!(Input::left(&path, &path).unwrap().crc, crc32fast::hash(b"xx"));
    }

    #[test]
    fn a_change_of_one_byte_a_lost_and_a_new_file_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let [area, index] = ["area.shp", "area.dbf"].map(|name| folder.path().join(name));
        fs::write(&area, "polygons").unwrap();
        fs::write(&index, "thickness 1.0").unwrap();
        let now = || {
            let strip = |path: &Path| path.strip_prefix(folder.path()).unwrap().to_owned();
            inputs(&[area.clone(), area.clone()], strip).unwrap()
        };
        let then = now();
        assert_eq!(then.iter().map(|one| one.name.as_str()).collect::<Vec<_>>(), ["area.dbf", "area.shp"]);
        assert_eq!(difference(&then, &now()), None);
        fs::write(&index, "thickness 2.0").unwrap();
        let changed = difference(&then, &now()).unwrap();
        assert!(changed.starts_with("area.dbf is not what the run began with"), "{changed}");
        fs::remove_file(&index).unwrap();
        assert!(difference(&then, &now()).unwrap().contains("not there any more"));
        let without = now();
        fs::write(folder.path().join("area.prj"), "").unwrap();
        assert_eq!(difference(&without, &now()).unwrap(), "area.prj was not there when the run began");
        let without = now();
        fs::write(folder.path().join("area.shp.aux.xml"), "").unwrap();
        assert_eq!(
            difference(&without, &now()).unwrap(),
            "area.shp.aux.xml was not there when the run began"
        );
        assert!(
            inputs(&[folder.path().join("none")], Path::to_owned).unwrap_err().to_string().contains("none")
        );
    }
}
