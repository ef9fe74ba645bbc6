//! One number a cell from a file: NumPy's .npy, or .csv.

use std::path::Path;

use super::files::FileAccess;
use super::npy;

/// Reads `[nx, ny]` cells, x fastest, from .npy (shape (nx) or (ny, nx)) or .csv (ny rows of nx numbers; one column will do if ny = 1).
pub(crate) fn read(files: &dyn FileAccess, path: &Path, [nx, ny]: [usize; 2]) -> Result<Vec<f64>, String> {
    let name = path.display();
    let bytes = files.bytes(path).map_err(|error| format!("cannot read {name}: {error}"))?;
    let (shape, values) =
        match path.extension().and_then(|end| end.to_str()).map(str::to_lowercase).as_deref() {
            Some("npy") => npy::read(&bytes),
            Some("csv" | "txt" | "dat") => read_text(&bytes),
            _ => Err("its name must end in .npy, .csv, .txt or .dat".to_owned()),
        }
        .map_err(|error| format!("cannot use {name}: {error}"))?;
    let fits = shape == [ny, nx] || (ny == 1 && values.len() == nx && shape.contains(&nx));
    if fits {
        return Ok(values);
    }
    let wanted = if ny == 1 { format!("({nx})") } else { format!("({ny}, {nx}), rows along y") };
    let found = shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
    Err(format!("{name} has shape ({found}), the grid needs {wanted}"))
}

/// The numbers of a text table, with its rows and columns; `#` begins a comment.
pub(crate) fn read_text(bytes: &[u8]) -> Result<(Vec<usize>, Vec<f64>), String> {
    let text = std::str::from_utf8(bytes).map_err(|_| "it is not text".to_owned())?;
    let text = text.trim_start_matches('\u{feff}');
    let text = if has_decimal_commas(text) { text.replace(',', ".") } else { text.to_owned() };
    let mut values = Vec::new();
    let (mut rows, mut columns) = (0, None);
    for (number, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or("").trim();
        if line.is_empty() {
            continue;
        }
        let before = values.len();
        for word in line.split([',', ';', ' ', '\t']).filter(|word| !word.is_empty()) {
            let value: f64 =
                word.parse().map_err(|_| format!("line {}: `{word}` is not a number", number + 1))?;
            values.push(value);
        }
        let found = values.len() - before;
        if *columns.get_or_insert(found) != found {
            return Err(format!(
                "line {} has {found} numbers, the lines before have {}",
                number + 1,
                columns.unwrap_or(0)
            ));
        }
        rows += 1;
    }
    Ok((vec![rows, columns.unwrap_or(0)], values))
}

/// Is a comma a decimal point here? Where something else parts the numbers: a semicolon, a tab, or blanks, no comma having one beside it.
fn has_decimal_commas(text: &str) -> bool {
    if text.contains([';', '\t']) {
        return true;
    }
    let lines = || text.lines().map(|line| line.split('#').next().unwrap_or("").trim());
    let parted = |line: &str| line.split_whitespace().count() > 1;
    let free = |line: &str| !line.contains(", ") && !line.contains(" ,");
    lines().any(|line| line.contains(',') && parted(line)) && lines().all(free)
}

#[cfg(test)]
mod tests {
    use super::super::files::Outline;
    use super::*;

    /// A folder with one file.
    struct One<'a>(&'a [u8]);

    impl FileAccess for One<'_> {
        fn outlines(&self, _path: &Path) -> Result<Box<dyn Outline>, String> {
            Err("it holds no polygon".to_owned())
        }
        fn bytes(&self, _path: &Path) -> std::io::Result<Vec<u8>> {
            Ok(self.0.to_vec())
        }
    }

    fn csv(text: &str, cells: [usize; 2]) -> Result<Vec<f64>, String> {
        read(&One(text.as_bytes()), Path::new("h.csv"), cells)
    }

    #[test]
    fn a_comma_is_a_decimal_point_where_something_else_parts_the_numbers() {
        for text in ["1,5;2,5\n3;4\n", "1,5\t2,5\n3\t4\n", "1,5 2,5\n3 4\n", "\u{feff}1,5;2,5\n3;4\n"] {
            assert_eq!(csv(text, [2, 2]), Ok(vec![1.5, 2.5, 3.0, 4.0]), "{text}");
        }
        assert_eq!(csv("1,5\n2,5\n", [2, 2]), Ok(vec![1.0, 5.0, 2.0, 5.0]));
        assert_eq!(csv("1, 5\n2, 5\n", [2, 2]), Ok(vec![1.0, 5.0, 2.0, 5.0]));
    }

    #[test]
    fn csv_rows_and_columns() {
        let six = "# thickness\n1, 2, 3\n4, 5, 6\n";
        assert_eq!(csv(six, [3, 2]), Ok(vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
        assert!(csv(six, [2, 3]).unwrap_err().contains("shape (2, 3), the grid needs (3, 2)"));
        assert_eq!(csv("1\n2\n3\n", [3, 1]), Ok(vec![1.0, 2.0, 3.0]));
        assert!(csv("1,2\n3,x\n", [2, 2]).unwrap_err().contains("line 2: `x` is not a number"));
        assert!(csv("1,2\n3\n", [2, 2]).unwrap_err().contains("line 2 has 1 numbers"));
    }

    #[test]
    fn npy_has_the_shape_of_the_grid() {
        let mut bytes =
            b"\x93NUMPY\x01\x00\x39\x00{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3)}".to_vec();
        [0.5f32, 1.5, 2.5, 3.5, 4.5, 5.5].iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        let npy = |bytes: &[u8], cells| read(&One(bytes), Path::new("h.npy"), cells);
        assert_eq!(npy(&bytes, [3, 2]), Ok(vec![0.5, 1.5, 2.5, 3.5, 4.5, 5.5]));
        assert!(npy(&bytes, [3, 3]).unwrap_err().contains("shape (2, 3), the grid needs (3, 3)"));
        assert!(npy(b"not numpy", [3, 2]).unwrap_err().contains("cannot use h.npy"));
    }
}
