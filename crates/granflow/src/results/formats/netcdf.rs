//! `result.nc`, which every run leaves.

use crate::results::format::Format;
use granflow_case::FileKind;

/// Written in any case: nothing more to do.
pub(super) static NETCDF: Format = Format::of(
    FileKind { name: "netcdf", about: "The fields over time: result.nc.", needs_terrain: false },
    |_| Ok(Vec::new()),
);
