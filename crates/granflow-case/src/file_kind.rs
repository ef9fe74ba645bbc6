//! A kind of file that a case may ask for.

/// A kind of output file that a case may ask for, as the one who writes it describes it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FileKind {
    /// The name a case file writes.
    pub name: &'static str,
    /// What it is, for the schema.
    pub about: &'static str,
    /// It needs a raster with a place on the earth.
    pub needs_terrain: bool,
}
