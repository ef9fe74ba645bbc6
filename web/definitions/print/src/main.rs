//! Prints the definitions of all coordinate systems, a line each of code and well-known text.

use std::io::{BufWriter, Write, stdout};

fn main() -> std::io::Result<()> {
    let mut out = BufWriter::new(stdout().lock());
    for definition in (0..=u16::MAX).filter_map(crs_definitions::from_code) {
        writeln!(out, "{}\t{}", definition.code, definition.wkt)?;
    }
    out.flush()
}
