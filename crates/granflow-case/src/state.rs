//! The quantities of a case at its points, in plain numbers.

use super::fault::{CaseError, PartFault};
use super::grid::Points;
use super::{Case, Quantity};

/// The state at time 0 at the centres of the cells, x fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct InitialState {
    /// Thickness h, not negative.
    pub thickness: Vec<f64>,
    /// Velocity along x.
    pub velocity_x: Vec<f64>,
    /// Velocity along y, 0 in one dimension.
    pub velocity_y: Vec<f64>,
}

impl Case {
    /// Thickness and velocity at the centres of the cells of a case with a grid.
    ///
    /// # Errors
    /// [`CaseError`] for a quantity that cannot be evaluated, a negative thickness or a number that is not finite.
    pub fn initial_state(&self) -> Result<InitialState, CaseError> {
        let (Some(grid), Some(initial)) = (&self.grid, &self.initial) else {
            return Err(self.source.fault("initial", "the case has no [grid] with an [initial] state"));
        };
        let points = grid.centres();
        Ok(InitialState {
            thickness: self.layer(&points, "initial.thickness", initial.thickness.as_ref())?,
            velocity_x: self.evaluate(&points, "initial.velocity_x", initial.velocity_x.as_ref())?,
            velocity_y: self.evaluate(&points, "initial.velocity_y", initial.velocity_y.as_ref())?,
        })
    }

    /// A quantity that is never negative.
    pub(super) fn layer(
        &self,
        points: &Points,
        key: &str,
        quantity: Option<&Quantity>,
    ) -> Result<Vec<f64>, CaseError> {
        let values = self.evaluate(points, key, quantity)?;
        match values.iter().position(|value| *value < 0.0) {
            None => Ok(values),
            Some(index) => {
                let name = key.rsplit('.').next().unwrap_or(key).replace('_', " ");
                let message = format!("the {name} is {} at {}", values[index], points.place(index));
                let cure = format!("a {name} is never negative; max(..., 0) cuts a formula off");
                Err(self.fault(key, message, &cure))
            }
        }
    }

    /// A quantity at all points, 0 where the case does not say.
    pub(super) fn evaluate(
        &self,
        points: &Points,
        key: &str,
        quantity: Option<&Quantity>,
    ) -> Result<Vec<f64>, CaseError> {
        let quantity = quantity.unwrap_or(&Quantity::Constant(0.0));
        let values = quantity.on(points, &self.folder()).map_err(|fault| self.part_fault(key, fault))?;
        match values.iter().position(|value| !value.is_finite()) {
            None => Ok(values),
            Some(index) => Err(self
                .source
                .fault(key, format!("the value is {} at {}", values[index], points.place(index)))
                .help("every cell needs a finite number")),
        }
    }

    /// An error in a part of what stands at `key`.
    pub(super) fn part_fault(&self, key: &str, fault: PartFault) -> CaseError {
        let error = self.source.fault_in(&format!("{key}.{}", fault.key), fault.part, fault.message);
        if fault.file { error.file() } else { error }
    }
}
