//! What lies on the table at the start, and how steep it may be.

use super::TablePlan;
use crate::case::Case;
use crate::case::fault::CaseError;
use crate::case::table::Table;

/// Slopes up to 1 + this are 1: rounding.
const ROUNDING: f64 = 1e-9;

impl Case {
    /// Evaluates the height of the table and the two layers.
    pub(super) fn lay(&self, table: &Table, plan: &mut TablePlan) -> Result<(), CaseError> {
        plan.height = self.evaluate(&plan.nodes, "table.height", table.height.as_ref())?;
        if let Some((slope, place)) = plan.steepest(&plan.height) {
            let message = format!("the table's slope is {slope} between {place}");
            let cure = "1 is the angle of repose: no slope of the table is above 1";
            return Err(self.fault("table.height", message, cure));
        }
        let initial = self.initial.clone().unwrap_or_default();
        let (open, touched) = (plan.open_nodes(), plan.touched());
        let key = "initial.standing_layer";
        plan.standing = self.layer(&plan.nodes, key, initial.standing_layer.as_ref())?;
        for ((u, open), touched) in plan.standing.iter_mut().zip(open).zip(touched) {
            if open {
                plan.clipped = plan.clipped.max(*u);
            }
            if open || !touched {
                *u = 0.0;
            }
        }
        let surface: Vec<f64> = plan.standing.iter().zip(&plan.height).map(|(u, b)| u + b).collect();
        if let Some((slope, place)) = plan.steepest(&surface) {
            let message = format!("the slope of the pile is {slope} between {place}");
            let cure = "a pile never stands steeper than 1, the angle of repose, and at an open edge it is 0; \
                        lower it: min(..., the distance to the open edge)";
            return Err(self.fault(key, message, cure));
        }
        plan.rolling = self.layer(&plan.centres, "initial.rolling_layer", initial.rolling_layer.as_ref())?;
        for (v, inside) in plan.rolling.iter_mut().zip(&plan.inside) {
            if !inside {
                *v = 0.0;
            }
        }
        Ok(())
    }
}

impl TablePlan {
    /// Whether a cell of the table touches a node.
    fn touched(&self) -> Vec<bool> {
        let mut touched = vec![false; self.height.len()];
        for (cell, _) in self.inside.iter().enumerate().filter(|(_, inside)| **inside) {
            self.corners(cell).into_iter().flatten().for_each(|node| touched[node] = true);
        }
        touched
    }

    /// The nodes of a cell: lower left and right, upper left and right; only the first two in one dimension.
    fn corners(&self, cell: usize) -> [Option<usize>; 4] {
        let ([nx, _], [row, _]) = (self.centres.counts(), self.nodes.counts());
        let low = cell / nx * row + cell % nx;
        let high = self.nodes.y.is_some().then_some(low + row);
        [Some(low), Some(low + 1), high, high.map(|high| high + 1)]
    }

    /// The steepest slope above 1, if there is one, along the sides and the diagonals of the table's cells, with its place.
    ///
    /// Every pile whose |grad| is at most 1 passes, since a slope along a line is never above it.
    fn steepest(&self, surface: &[f64]) -> Option<(f64, String)> {
        let pairs = [[0, 1], [0, 2], [1, 3], [2, 3], [0, 3], [1, 2]];
        let mut most = (1.0, None);
        for (cell, _) in self.inside.iter().enumerate().filter(|(_, inside)| **inside) {
            let corners = self.corners(cell);
            for [a, b] in pairs {
                let (Some(a), Some(b)) = (corners[a], corners[b]) else { continue };
                let ([ax, ay], [bx, by]) = (self.nodes.at(a), self.nodes.at(b));
                let slope = (surface[a] - surface[b]).abs() / (ax - bx).hypot(ay - by);
                // of slopes that are the same but for rounding the first is named
                if slope > most.0 * (1.0 + ROUNDING) {
                    most = (slope, Some([a, b]));
                }
            }
        }
        let (slope, [a, b]) = (most.0, most.1?);
        let slope = (slope * 1e9).round() / 1e9;
        Some((slope, format!("{} and {}", self.nodes.place(a), self.nodes.place(b))))
    }
}
