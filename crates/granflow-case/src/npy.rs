//! NumPy's .npy files, versions 1 to 3: one array of 4- or 8-byte floats, row by row.

/// What a header says.
struct Header {
    shape: Vec<usize>,
    width: usize,
    big_endian: bool,
}

const MAGIC: &[u8] = b"\x93NUMPY";

/// Shape and numbers of a .npy file.
pub(crate) fn read(bytes: &[u8]) -> Result<(Vec<usize>, Vec<f64>), String> {
    let (text, data) = split(bytes)?;
    let Header { shape, width, big_endian } = header(text)?;
    let size = shape.iter().try_fold(width, |size, side| size.checked_mul(*side));
    if size != Some(data.len()) {
        let sides = shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
        let expected = size.map_or("more than any machine holds".to_owned(), |size| size.to_string());
        let (found, bytes) = (data.len(), "bytes of numbers");
        return Err(format!("it holds {found} {bytes}, its shape ({sides}) needs {expected}; save it again"));
    }
    let values = match width {
        4 => data.as_chunks().0.iter().map(|&four| single(four, big_endian).into()).collect(),
        _ => data.as_chunks().0.iter().map(|&eight| double(eight, big_endian)).collect(),
    };
    Ok((shape, values))
}

fn single(bytes: [u8; 4], big_endian: bool) -> f32 {
    if big_endian { f32::from_be_bytes(bytes) } else { f32::from_le_bytes(bytes) }
}

fn double(bytes: [u8; 8], big_endian: bool) -> f64 {
    if big_endian { f64::from_be_bytes(bytes) } else { f64::from_le_bytes(bytes) }
}

/// The text of the header and the bytes after it.
fn split(bytes: &[u8]) -> Result<(&str, &[u8]), String> {
    let cut = || "its header is cut off".to_owned();
    let rest = bytes.strip_prefix(MAGIC).ok_or("it is no .npy file")?;
    let (&[major, _minor], rest) = rest.split_first_chunk().ok_or_else(cut)?;
    let (length, rest) = match major {
        1 => {
            let (length, rest) = rest.split_first_chunk().ok_or_else(cut)?;
            (usize::from(u16::from_le_bytes(*length)), rest)
        }
        2 | 3 => {
            let (length, rest) = rest.split_first_chunk().ok_or_else(cut)?;
            (usize::try_from(u32::from_le_bytes(*length)).map_err(|_| cut())?, rest)
        }
        _ => return Err(format!("its format has version {major}, known are 1 to 3")),
    };
    let (text, data) = rest.split_at_checked(length).ok_or_else(cut)?;
    Ok((std::str::from_utf8(text).map_err(|_| "its header is not text")?, data))
}

/// Reads `{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }`.
fn header(text: &str) -> Result<Header, String> {
    let value = |key: &str| {
        let after = text.split_once(&format!("'{key}'")).map(|(_, after)| after.trim_start());
        let value = after.and_then(|after| after.strip_prefix(':')).map(str::trim_start);
        value.ok_or_else(|| format!("its header does not say `{key}`"))
    };
    let inner = value("shape")?.strip_prefix('(').and_then(|list| list.split_once(')'));
    let sides = inner.ok_or("its header says no shape")?.0.split(',').map(str::trim);
    let shape = sides
        .filter(|side| !side.is_empty())
        .map(|side| side.trim_end_matches('L').parse().map_err(|_| format!("its shape has a side `{side}`")))
        .collect::<Result<Vec<usize>, String>>()?;
    let fortran = value("fortran_order")?.starts_with("True");
    if fortran && shape.len() > 1 {
        return Err("it is stored column by column; save numpy.ascontiguousarray(h)".to_owned());
    }
    let kind = value("descr")?;
    let kind = match kind.chars().next() {
        Some(quote @ ('\'' | '"')) => kind[1..].split(quote).next().unwrap_or(""),
        _ => "a table",
    };
    let (width, big_endian) = match kind {
        "<f4" => (4, false),
        ">f4" => (4, true),
        "<f8" => (8, false),
        ">f8" => (8, true),
        _ => {
            let advice = "save it as float64 or float32: h.astype(\"f8\")";
            return Err(format!("its numbers are `{kind}`; {advice}"));
        }
    };
    Ok(Header { shape, width, big_endian })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(version: u8, header: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = [MAGIC, &[version, 0]].concat();
        let length = header.len();
        match version {
            1 => bytes.extend(u16::try_from(length).unwrap().to_le_bytes()),
            _ => bytes.extend(u32::try_from(length).unwrap().to_le_bytes()),
        }
        [&bytes, header.as_bytes(), data].concat()
    }

    fn about(kind: &str, fortran: &str, shape: &str) -> String {
        format!("{{'descr': '{kind}', 'fortran_order': {fortran}, 'shape': {shape}, }}      \n")
    }

    const NUMBERS: [f64; 6] = [0.5, 1.5, 2.5, 3.5, 4.5, -0.25];

    #[test]
    fn all_versions_widths_and_byte_orders() {
        let narrow = NUMBERS.map(|v| v as f32);
        let kinds: [(&str, Vec<u8>); 4] = [
            ("<f8", NUMBERS.iter().flat_map(|v| v.to_le_bytes()).collect()),
            (">f8", NUMBERS.iter().flat_map(|v| v.to_be_bytes()).collect()),
            ("<f4", narrow.iter().flat_map(|v| v.to_le_bytes()).collect()),
            (">f4", narrow.iter().flat_map(|v| v.to_be_bytes()).collect()),
        ];
        for version in 1..=3 {
            for (kind, data) in &kinds {
                let read = |shape: &str| read(&file(version, &about(kind, "False", shape), data));
                assert_eq!(read("(2, 3)"), Ok((vec![2, 3], NUMBERS.to_vec())), "{version} {kind}");
                assert_eq!(read("(6,)"), Ok((vec![6], NUMBERS.to_vec())));
                assert_eq!(read("(6L,)"), Ok((vec![6], NUMBERS.to_vec())), "as Python 2 wrote it");
            }
        }
        let one = file(1, &about("<f8", "False", "()"), &2.0f64.to_le_bytes());
        assert_eq!(read(&one), Ok((vec![], vec![2.0])));
        let line = file(1, &about("<f8", "True", "(1,)"), &2.0f64.to_le_bytes());
        assert_eq!(read(&line), Ok((vec![1], vec![2.0])), "a single row has one order only");
    }

    #[test]
    fn what_is_refused() {
        let refused = |bytes: &[u8], part: &str| {
            let error = read(bytes).unwrap_err();
            assert!(error.contains(part), "{error}");
        };
        let eight = |kind: &str, fortran: &str, shape: &str| file(1, &about(kind, fortran, shape), &[0; 8]);
        refused(b"not numpy", "no .npy file");
        refused(b"", "no .npy file");
        refused(&eight("<f8", "True", "(1, 1)"), "numpy.ascontiguousarray(h)");
        for kind in ["<i8", "|b1", "<c16", "<f2", "|O", "f8", ""] {
            refused(&eight(kind, "False", "(1,)"), "h.astype(\"f8\")");
        }
        refused(
            &file(1, "{'descr': [('h', '<f8')], 'fortran_order': False, 'shape': (1,)}", &[0; 8]),
            "astype",
        );
        refused(&eight("<f8", "False", "(2,)"), "holds 8 bytes of numbers, its shape (2) needs 16");
        refused(&eight("<f4", "False", "(1,)"), "its shape (1) needs 4");
        refused(&eight("<f8", "False", "(9223372036854775807, 9)"), "more than any machine holds");
        refused(&eight("<f8", "False", "(-1,)"), "a side `-1`");
        refused(&file(1, "{'descr': '<f8', 'shape': (1,)}", &[0; 8]), "does not say `fortran_order`");
        refused(&file(1, "{'descr': '<f8', 'fortran_order': False, 'shape': 1}", &[0; 8]), "no shape");
        refused(&file(4, "", &[]), "version 4");
        let whole = eight("<f8", "False", "(1,)");
        for length in 0..whole.len() {
            assert!(read(&whole[..length]).is_err(), "the first {length} bytes");
        }
    }
}
