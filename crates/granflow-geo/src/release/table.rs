//! The attributes of a shapefile: a dBASE table, every field as the text it is stored as.
//!
//! Numbers are left to the one who asks for them: a field that is no number, or is one with a decimal comma, must not make the
//! rest unreadable, and rows that are marked deleted must stay beside their shapes.

/// Attributes of a row as name and text; `None` for a row that is marked deleted.
pub(super) type Row = Option<Vec<(String, String)>>;

/// Length of the head of a table and of the description of a field.
const ENTRY: usize = 32;

/// All rows of a table.
pub(super) fn rows(bytes: &[u8]) -> Result<Vec<Row>, String> {
    let cut = || format!("the table ends after {} bytes, in the middle; fetch it again", bytes.len());
    let short = |at: usize| Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?) as usize);
    let head = bytes.get(..ENTRY).ok_or_else(cut)?;
    let count = u32::from_le_bytes([head[4], head[5], head[6], head[7]]) as usize;
    let (start, length) = (short(8).ok_or_else(cut)?, short(10).ok_or_else(cut)?);
    let fields = fields(bytes.get(ENTRY..start).ok_or_else(cut)?);
    if length == 0 || fields.iter().map(|(_, _, width)| width).sum::<usize>() >= length.max(1) {
        return Err(format!("its fields do not fit its rows of {length} bytes"));
    }
    let row = |k: usize| {
        let row = bytes.get(start + k * length..).filter(|rest| rest.len() + 1 >= length).ok_or_else(cut)?;
        let (mark, row) = row.split_first().ok_or_else(cut)?;
        Ok(match mark {
            b'*' => None,
            _ => Some(texts(&row[..(length - 1).min(row.len())], &fields)),
        })
    };
    (0..count).map(row).collect()
}

/// Name, type and width of the fields. Those without a width hold nothing and are left out: a small file may declare
/// thousands of them, for every row again.
fn fields(entries: &[u8]) -> Vec<(String, u8, usize)> {
    let described = entries.chunks_exact(ENTRY).take_while(|entry| entry[0] != b'\r');
    let field = |entry: &[u8]| {
        let name = entry[..11].split(|byte| *byte == 0).next().unwrap_or_default();
        // A text may be longer than 255 letters.
        let more = if entry[11] == b'C' { 256 * entry[17] as usize } else { 0 };
        (String::from_utf8_lossy(name).trim().to_string(), entry[11], entry[16] as usize + more)
    };
    described.map(field).filter(|(_, _, width)| *width > 0).collect()
}

/// The fields of a row; empty where nothing is stored, which is blanks or stars.
fn texts(row: &[u8], fields: &[(String, u8, usize)]) -> Vec<(String, String)> {
    let mut rest = row;
    let text = |(name, kind, width): &(String, u8, usize)| {
        let own;
        (own, rest) = rest.split_at((*width).min(rest.len()));
        let text = match (kind, own.len()) {
            (b'I', 4) => i32::from_le_bytes([own[0], own[1], own[2], own[3]]).to_string(),
            (b'B' | b'O', 8) => own.try_into().map(f64::from_le_bytes).unwrap_or(f64::NAN).to_string(),
            _ => String::from_utf8_lossy(own).trim_matches(['\0', ' ']).to_string(),
        };
        let none = text.chars().all(|c| c == '*');
        (name.clone(), if none { String::new() } else { text })
    };
    fields.iter().map(text).collect()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A table with one field of 8 bytes and these rows, the first letter of each the mark of deletion.
    pub(crate) fn table(name: &str, kind: char, rows: &[&str]) -> Vec<u8> {
        let mut bytes = vec![3, 126, 1, 1];
        bytes.extend((rows.len() as u32).to_le_bytes());
        bytes.extend(65u16.to_le_bytes());
        bytes.extend(9u16.to_le_bytes());
        bytes.resize(32, 0);
        bytes.extend(name.bytes());
        bytes.resize(43, 0);
        bytes.push(kind as u8);
        bytes.resize(48, 0);
        bytes.push(8);
        bytes.resize(64, 0);
        bytes.push(b'\r');
        for row in rows {
            bytes.extend(format!("{row:<9}").bytes());
        }
        bytes.push(0x1a);
        bytes
    }

    #[test]
    fn texts_blanks_stars_and_deleted_rows() {
        let rows = rows(&table("THICK", 'N', &[" 1.5", "*2", "  ", " ********", " 1,5"])).unwrap();
        let text = |row: &Row| row.as_ref().map(|row| row[0].1.clone());
        let texts: Vec<_> = rows.iter().map(text).collect();
        assert_eq!(texts, [Some("1.5"), None, Some(""), Some(""), Some("1,5")].map(|t| t.map(String::from)));
        assert_eq!(rows[0].as_ref().unwrap()[0].0, "THICK");
    }

    #[test]
    fn a_cut_table_is_refused() {
        let whole = table("T", 'N', &[" 1", " 2"]);
        for length in [0, 20, 40, 70, 80] {
            assert!(super::rows(&whole[..length]).is_err(), "{length}");
        }
        assert_eq!(
            super::rows(&whole[..whole.len() - 1]).unwrap().len(),
            2,
            "the mark of its end may be missing"
        );
    }

    #[test]
    fn rows_without_a_byte_are_no_rows_and_fields_without_width_no_fields() {
        let mut bytes = table("T", 'N', &[]);
        bytes[4..8].copy_from_slice(&u32::MAX.to_le_bytes());
        bytes[10] = 1;
        bytes[48] = 0;
        assert!(super::rows(&bytes).unwrap_err().contains("ends after"), "it says 2^32 rows");
        bytes[4..8].copy_from_slice(&1u32.to_le_bytes());
        assert_eq!(super::rows(&bytes).unwrap(), [Some(Vec::new())]);
    }
}
