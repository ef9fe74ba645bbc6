//! What lies on the table at the start, and how steep it may be.

use super::{TablePlan, TableWords, Words};
use crate::fault::CaseError;
use crate::look::Look;

/// Slopes up to 1 + this are 1: rounding.
const ROUNDING: f64 = 1e-9;

impl Words {
    /// Evaluates the height of the table and the two layers.
    pub(super) fn lay<const D: usize>(
        &self,
        look: &Look,
        table: &TableWords,
        plan: &mut TablePlan<D>,
    ) -> Result<(), CaseError> {
        if table.height.is_some() {
            plan.height = look.evaluate(&plan.nodes, "table.height", table.height.as_ref())?.iter().collect();
        }
        if let Some((slope, place)) = plan.steepest(&plan.height) {
            let message = format!("the table's slope is {slope} between {place}");
            let cure = "1 is the angle of repose: no slope of the table is above 1";
            return Err(look.fault("table.height", message, cure));
        }
        let initial = self.initial.clone().unwrap_or_default();
        let key = "initial.standing_layer";
        plan.standing = look.layer(&plan.nodes, key, initial.standing_layer.as_ref())?.iter().collect();
        for (node, u) in plan.standing.iter_mut().enumerate() {
            if plan.table.pinned(node) {
                plan.clipped = plan.clipped.max(*u);
            }
            if plan.table.weight(plan.table.index(node)) == 0.0 {
                *u = 0.0;
            }
        }
        let surface: Vec<f64> = plan.standing.iter().zip(&plan.height).map(|(u, b)| u + b).collect();
        if let Some((slope, place)) = plan.steepest(&surface) {
            let message = format!("the slope of the pile is {slope} between {place}");
            let cure = "a pile never stands steeper than 1, the angle of repose, and at an open edge it is 0; \
                        lower it: min(..., the distance to the open edge)";
            return Err(look.fault(key, message, cure));
        }
        let rolling = look.layer(&plan.centres, "initial.rolling_layer", initial.rolling_layer.as_ref())?;
        let mut rolling: Vec<f64> = rolling.iter().collect();
        for (cell, v) in rolling.iter_mut().enumerate() {
            if !plan.inside(cell) {
                *v = 0.0;
            }
        }
        plan.rolling = rolling;
        Ok(())
    }
}

impl<const D: usize> TablePlan<D> {
    /// The steepest slope above 1, if there is one, along the sides and the diagonals of the table's cells, with its place.
    ///
    /// Every pile whose |grad| is at most 1 passes, since a slope along a line is never above it.
    fn steepest(&self, surface: &[f64]) -> Option<(f64, String)> {
        let pairs = [[0, 1], [0, 2], [1, 3], [2, 3], [0, 3], [1, 2]];
        let mut most = (1.0, None);
        for cell in self.table.places() {
            for [a, b] in pairs.into_iter().filter(|[_, b]| *b < 1 << D) {
                let [a, b] = [a, b].map(|corner| cell + self.table.span(corner));
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
