//! What a builder is given must be in its range.

use granflow_engine::simulation::BuildError;

/// An error unless `value` is finite and `fits`.
pub(crate) fn check_value(
    name: &'static str,
    value: f64,
    allowed: &'static str,
    fits: impl Fn(f64) -> bool,
) -> Result<(), BuildError> {
    if value.is_finite() && fits(value) { Ok(()) } else { Err(BuildError::Value { name, value, allowed }) }
}
