//! One number a cell from a file: NumPy's .npy, or .csv.

use std::fs;
use std::path::Path;

/// Reads `[nx, ny]` cells, x fastest, from .npy (shape (nx) or (ny, nx)) or .csv (ny rows of nx numbers; one column will do if ny = 1).
pub(super) fn read_array(path: &Path, [nx, ny]: [usize; 2]) -> Result<Vec<f64>, String> {
    let name = path.display();
    let bytes = fs::read(path).map_err(|error| format!("cannot read {name}: {error}"))?;
    let (shape, values) =
        match path.extension().and_then(|end| end.to_str()).map(str::to_lowercase).as_deref() {
            Some("npy") => read_npy(&bytes),
            Some("csv" | "txt" | "dat") => read_text(&bytes),
            _ => Err("its name must end in .npy, .csv, .txt or .dat".to_owned()),
        }
        .map_err(|error| format!("cannot use {name}: {error}"))?;
    let fits =
        shape == [ny as u64, nx as u64] || (ny == 1 && values.len() == nx && shape.contains(&(nx as u64)));
    if fits {
        return Ok(values);
    }
    let wanted = if ny == 1 { format!("({nx})") } else { format!("({ny}, {nx}), rows along y") };
    let found = shape.iter().map(u64::to_string).collect::<Vec<_>>().join(", ");
    Err(format!("{name} has shape ({found}), the grid needs {wanted}"))
}

fn read_npy(bytes: &[u8]) -> Result<(Vec<u64>, Vec<f64>), String> {
    let open = || npyz::NpyFile::new(bytes).map_err(|error| error.to_string());
    let file = open()?;
    let shape = file.shape().to_vec();
    if file.order() == npyz::Order::Fortran && shape.len() > 1 {
        return Err("it is stored column by column; save numpy.ascontiguousarray(h)".to_owned());
    }
    if let Ok(values) = file.into_vec::<f64>() {
        return Ok((shape, values));
    }
    let values: Vec<f32> = open()?
        .into_vec()
        .map_err(|error| format!("{error}; save it as float64 or float32: h.astype(\"f8\")"))?;
    Ok((shape, values.into_iter().map(f64::from).collect()))
}

fn read_text(bytes: &[u8]) -> Result<(Vec<u64>, Vec<f64>), String> {
    let text = std::str::from_utf8(bytes).map_err(|_| "it is not text".to_owned())?;
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
    Ok((vec![rows, columns.unwrap_or(0) as u64], values))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn csv_rows_and_columns() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("h.csv");
        fs::write(&path, "# thickness\n1, 2, 3\n4, 5, 6\n").unwrap();
        assert_eq!(read_array(&path, [3, 2]), Ok(vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
        assert!(read_array(&path, [2, 3]).unwrap_err().contains("shape (2, 3), the grid needs (3, 2)"));
        fs::write(&path, "1\n2\n3\n").unwrap();
        assert_eq!(read_array(&path, [3, 1]), Ok(vec![1.0, 2.0, 3.0]));
        fs::write(&path, "1,2\n3,x\n").unwrap();
        assert!(read_array(&path, [2, 2]).unwrap_err().contains("line 2: `x` is not a number"));
        fs::write(&path, "1,2\n3\n").unwrap();
        assert!(read_array(&path, [2, 2]).unwrap_err().contains("line 2 has 1 numbers"));
    }

    #[test]
    fn npy_in_both_precisions() {
        use npyz::WriterBuilder;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("h.npy");
        let mut buffer = Vec::new();
        let mut writer =
            npyz::WriteOptions::new().default_dtype().shape(&[2, 3]).writer(&mut buffer).begin_nd().unwrap();
        writer.extend([0.5f32, 1.5, 2.5, 3.5, 4.5, 5.5]).unwrap();
        writer.finish().unwrap();
        fs::write(&path, buffer).unwrap();
        assert_eq!(read_array(&path, [3, 2]), Ok(vec![0.5, 1.5, 2.5, 3.5, 4.5, 5.5]));
        assert!(read_array(&path, [3, 3]).is_err());
        fs::write(&path, b"not numpy").unwrap();
        assert!(read_array(&path, [3, 2]).unwrap_err().contains("cannot use"));
    }
}
