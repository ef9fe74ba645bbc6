//! The definitions of coordinate systems of the crate `crs-definitions`, 4 MB of text, as 0.2 MB that are unpacked when the first code
//! is asked for. It bears that crate's name, so that the page's engine takes `granflow-geo` as it is.

use flate2::read::GzDecoder;
use std::collections::HashMap;
use std::io::Read;
use std::sync::LazyLock;

/// What `print` writes, as gzip: `web/build` makes it.
const PACKED: &[u8] = include_bytes!("../../target/definitions.gz");

static TEXT: LazyLock<String> = LazyLock::new(|| {
    let mut text = String::new();
    GzDecoder::new(PACKED).read_to_string(&mut text).expect("what the build packed is unpacked");
    text
});

static BY_CODE: LazyLock<HashMap<u16, &'static str>> = LazyLock::new(|| {
    let entry =
        |line: &'static str| line.split_once('\t').and_then(|(code, wkt)| Some((code.parse().ok()?, wkt)));
    TEXT.lines().filter_map(entry).collect()
});

/// A definition, as far as the page needs it.
#[derive(Debug, Clone, Copy)]
pub struct Def {
    /// Code of the EPSG.
    pub code: u16,
    /// Well-known text.
    pub wkt: &'static str,
}

/// The definition of a code, where there is one.
pub fn from_code(code: u16) -> Option<Def> {
    BY_CODE.get(&code).map(|wkt| Def { code, wkt })
}
