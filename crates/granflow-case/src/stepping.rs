//! The time step of a scheme.

use super::fault::CaseError;
use super::look::Look;
use super::plan::Stepping;
use granflow_model::scheme::Scheme;

/// What a scheme says about its time step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StepLimits {
    /// Name of the scheme.
    pub scheme: &'static str,
    /// Largest Courant number.
    pub max_courant: f64,
    /// Courant number where the case does not say.
    pub suggested: f64,
}

impl StepLimits {
    /// The limits that the scheme of this name states itself.
    pub fn of<S: Scheme<1, f64>>(name: &'static str, scheme: &S) -> Self {
        Self { scheme: name, max_courant: scheme.max_courant(), suggested: scheme.suggested_courant() }
    }
}

impl Look<'_> {
    /// The time step of `[scheme]`: a fixed one, or a Courant number within the limits of the scheme.
    pub fn stepping(
        &self,
        step: Option<f64>,
        courant: Option<f64>,
        limits: StepLimits,
    ) -> Result<Stepping, CaseError> {
        let StepLimits { scheme, max_courant, suggested } = limits;
        self.positive("scheme.step", step)?;
        match (step, courant) {
            (Some(_), Some(_)) => Err(self.fault(
                "scheme.courant",
                "both `step` and `courant` are given",
                "keep step for a fixed step, courant for an adaptive one",
            )),
            (Some(step), None) => Ok(Stepping::Fixed(step)),
            (None, Some(courant)) => {
                let allowed = format!("a number > 0 and <= {max_courant} for {scheme}");
                self.number("scheme.courant", courant, |v| v > 0.0 && v <= max_courant, &allowed)?;
                Ok(Stepping::Courant(courant))
            }
            (None, None) => Ok(Stepping::Courant(suggested)),
        }
    }
}
