//! How long a step is.

/// How long a step is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepSize {
    /// The same dt every step.
    Fixed(f64),
    /// dt = courant / max over cells of [`granflow_model::scheme::Scheme::rate`].
    Courant(f64),
}
