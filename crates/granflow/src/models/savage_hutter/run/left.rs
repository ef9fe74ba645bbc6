//! What another run left, as a release.

#[cfg(feature = "files")]
use super::super::{ended, stored};
use crate::StartError;
use crate::inputs::Inputs;
use granflow_geo::Remark;
use granflow_geo::raster::{Crs, Raster};
#[cfg(feature = "files")]
use granflow_geo::release;
use granflow_geo::release::Sparse;
use std::path::Path;

/// The volume per plan area that lies at the end of another run, on the cells of `bed`, and the system of that run.
#[cfg(feature = "files")]
pub(super) fn left_by(
    path: &Path,
    inputs: &Inputs,
    bed: &Raster,
    remarks: &mut Vec<Remark>,
) -> Result<(Sparse, Option<Crs>), StartError> {
    let unusable =
        |problem: String| StartError::Result { path: path.to_owned(), place: "a terrain", problem };
    if inputs.holds(path) {
        return Err(unusable("it is in memory, and what a run left is read from the disk".to_owned()));
    }
    let last = stored::last(path).map_err(unusable)?;
    let (rests, text) = ended::remark(path, &format!("{} s", last.time), last.rests);
    remarks.push(if rests { Remark::Note(text) } else { Remark::Warning(text) });
    Ok((release::carried(release::Form::Result, path, &last.volume, bed)?, last.volume.crs))
}

#[cfg(not(feature = "files"))]
pub(super) fn left_by(
    _: &Path,
    _: &Inputs,
    _: &Raster,
    _: &mut Vec<Remark>,
) -> Result<(Sparse, Option<Crs>), StartError> {
    Err(StartError::Feature { feature: "files" })
}
