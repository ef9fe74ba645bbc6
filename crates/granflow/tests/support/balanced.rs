//! The scheme `balanced` and its second order.
#![allow(dead_code)]

use granflow::savage_hutter::balanced::Balanced;
use granflow::savage_hutter::friction::{Coulomb, Law};
use granflow::simulation::StepSize;

/// The scheme over the bed `B`.
pub type Tried<B> = Balanced<Law, B>;

/// Its two orders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// `balanced`.
    First,
    /// `balanced_2`.
    Second,
}

pub const ORDERS: [Order; 2] = [Order::First, Order::Second];

impl Order {
    pub fn scheme<B>(self, mu: f64, film: f64) -> Balanced<Law, B> {
        match self {
            Order::First => Balanced::first(Law::Coulomb(Coulomb { mu }), film),
            Order::Second => Balanced::second(Law::Coulomb(Coulomb { mu }), film),
        }
    }
    /// Its name in a case.
    pub fn name(self) -> &'static str {
        match self {
            Order::First => "balanced",
            Order::Second => "balanced_2",
        }
    }
    /// What passes a face is the flux of the equation; else the pressure of a level surface is in the force on a cell.
    pub fn pressure_is_in_the_flux(self) -> bool {
        true
    }
    /// How far a flow along one axis may differ between one dimension and two: not at all.
    pub fn off_in_two_dimensions(self) -> f64 {
        0.0
    }
    /// The share of the static bound beyond which a cone starts.
    pub fn cone_starts(self) -> f64 {
        1.0 + 1e-6
    }
    /// It takes steps beyond its largest Courant number.
    pub fn takes_long_steps(self) -> bool {
        true
    }
    /// A two-stage step whose last stage stops is at rest at its end.
    pub fn ends_early(self) -> bool {
        self == Order::Second
    }
    /// The largest total variation of the published Riemann problem (exact 0.5).
    pub fn variation(self) -> f64 {
        0.502
    }
    /// The step of an ordinary run.
    pub fn courant(self) -> StepSize {
        match self {
            Order::First => StepSize::Courant(0.9),
            Order::Second => StepSize::Courant(0.45),
        }
    }
    /// The largest step the scheme allows.
    pub fn limit(self) -> StepSize {
        match self {
            Order::First => StepSize::Courant(1.0),
            Order::Second => StepSize::Courant(0.5),
        }
    }
}
