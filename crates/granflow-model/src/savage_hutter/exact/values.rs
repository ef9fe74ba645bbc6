//! What the exact solutions share: their values, and what they refuse.

/// Depth and velocity of a flow in one dimension (m and m/s, or both scaled).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flow1 {
    /// Depth h >= 0, normal to the bed.
    pub h: f64,
    /// Velocity along the bed; 0 where h = 0.
    pub u: f64,
}

impl Flow1 {
    /// No material.
    pub const DRY: Self = Self { h: 0.0, u: 0.0 };

    /// Discharge q = h u.
    pub fn q(self) -> f64 {
        self.h * self.u
    }
}

/// Depth and velocity of a flow in two dimensions (m and m/s, or both scaled).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flow2 {
    /// Depth h >= 0, normal to the bed.
    pub h: f64,
    /// Velocity along x; 0 where h = 0.
    pub u: f64,
    /// Velocity along y; 0 where h = 0.
    pub v: f64,
}

impl Flow2 {
    /// No material.
    pub const DRY: Self = Self { h: 0.0, u: 0.0, v: 0.0 };
}

/// Why a solution cannot be set up.
#[derive(Debug, Clone, PartialEq)]
pub enum ExactError {
    /// One parameter is outside the range where it has a meaning.
    OutOfRange {
        /// The parameter.
        name: &'static str,
        /// Its value.
        found: f64,
        /// The values that are allowed.
        allowed: &'static str,
    },
    /// The parameters are fine one by one, but the formula does not solve the equations for them together.
    NotValid {
        /// The solution asked for.
        solution: &'static str,
        /// The condition that is broken.
        requirement: &'static str,
        /// Its left-hand side.
        left: f64,
        /// Its right-hand side.
        right: f64,
    },
}

impl core::fmt::Display for ExactError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::OutOfRange { name, found, allowed } => {
                write!(f, "{name} = {found}, but it must be {allowed}")
            }
            Self::NotValid { solution, requirement, left, right } => write!(
                f,
                "{solution} does not hold here: {requirement} is needed, but {left} against {right} was given"
            ),
        }
    }
}

impl core::error::Error for ExactError {}

pub(super) fn positive(name: &'static str, found: f64) -> Result<f64, ExactError> {
    if found > 0.0 && found.is_finite() {
        Ok(found)
    } else {
        Err(ExactError::OutOfRange { name, found, allowed: "positive and finite" })
    }
}

pub(super) fn not_negative(name: &'static str, found: f64) -> Result<f64, ExactError> {
    if found >= 0.0 && found.is_finite() {
        Ok(found)
    } else {
        Err(ExactError::OutOfRange { name, found, allowed: "0 or positive, and finite" })
    }
}

pub(super) fn finite(name: &'static str, found: f64) -> Result<f64, ExactError> {
    if found.is_finite() { Ok(found) } else { Err(ExactError::OutOfRange { name, found, allowed: "finite" }) }
}

/// An angle of a bed or of friction.
pub(super) fn angle(name: &'static str, found: f64) -> Result<f64, ExactError> {
    if (0.0..core::f64::consts::FRAC_PI_2).contains(&found) {
        Ok(found)
    } else {
        Err(ExactError::OutOfRange { name, found, allowed: "from 0 to below pi/2 (radians)" })
    }
}
