//! `[initial]` on a chute: what lies there and moves at time 0.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::fault::CaseError;
use crate::grid::{Grid, Points};
use crate::look::{Look, result_of};
use crate::quantity::{Quantity, Values};

/// The state at time 0 at the centres of the cells, x fastest.
#[derive(Debug, Clone)]
pub struct InitialState {
    /// Thickness h, not negative.
    pub thickness: Values,
    /// Velocity along x.
    pub velocity_x: Values,
    /// Velocity along y, 0 in one dimension.
    pub velocity_y: Values,
    /// The `result.nc` of another run: what lay there at its end lies at rest under `thickness`.
    pub result: Option<PathBuf>,
}

/// The state at time 0 at the centres of the cells: `thickness`, `result` or both.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "ChuteInitial")]
pub(super) struct Initial {
    /// Thickness h, not negative.
    #[serde(skip_serializing_if = "Option::is_none")]
    thickness: Option<Quantity>,
    /// Velocity of `thickness` along x (default 0).
    #[serde(skip_serializing_if = "Option::is_none")]
    velocity_x: Option<Quantity>,
    /// Velocity of `thickness` along y (default 0).
    #[serde(skip_serializing_if = "Option::is_none")]
    velocity_y: Option<Quantity>,
    /// What lay on the chute at the end of another run, at rest under `thickness`: its folder, or its result.nc.
    #[serde(skip_serializing_if = "Option::is_none")]
    result: Option<PathBuf>,
}

impl Initial {
    pub(super) fn check(&self, look: &Look, grid: &Grid) -> Result<InitialState, CaseError> {
        let quantities = [
            ("initial.thickness", self.thickness.as_ref()),
            ("initial.velocity_x", self.velocity_x.as_ref()),
            ("initial.velocity_y", self.velocity_y.as_ref()),
        ];
        for (key, quantity) in quantities {
            if let Some(path) = quantity.and_then(Quantity::needs_file) {
                look.file(&format!("{key}.file"), path)?;
            }
        }
        let result = self.result.as_deref().map(result_of);
        if let Some(path) = &result {
            look.file("initial.result", path)?;
        }
        let [(h, thickness), (u, along), (v, across)] = quantities;
        if thickness.is_none() {
            self.check_without_thickness(look)?;
        }
        if across.is_some() && grid.y.is_none() {
            return Err(look.fault(v, "the grid has no y", "remove velocity_y, or add grid.y"));
        }
        let points: Points = grid.centres();
        Ok(InitialState {
            thickness: look.layer(&points, h, thickness)?,
            velocity_x: look.evaluate(&points, u, along)?,
            velocity_y: look.evaluate(&points, v, across)?,
            result: result.map(|path| look.locate(&path)),
        })
    }

    /// Without a layer of its own the run needs what another one left, and that is at rest.
    fn check_without_thickness(&self, look: &Look) -> Result<(), CaseError> {
        if self.result.is_none() {
            let cure =
                "add for instance initial.thickness = 1.0, or initial.result = \"FOLDER\" of another run";
            return Err(look.fault("initial", "the key `thickness` is missing", cure));
        }
        let moving = [("velocity_x", &self.velocity_x), ("velocity_y", &self.velocity_y)];
        match moving.into_iter().find(|(_, velocity)| velocity.is_some()) {
            None => Ok(()),
            Some((name, _)) => {
                let message = format!("{name} is that of `thickness`, and there is none");
                let cure = "remove it: what another run left starts at rest; or add initial.thickness";
                Err(look.fault(&format!("initial.{name}"), message, cure))
            }
        }
    }
}
