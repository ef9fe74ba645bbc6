//! The scheme `energy_stable`.
#![allow(dead_code)]

use granflow::savage_hutter::energy_stable::EnergyStable;
use granflow::savage_hutter::friction::{Coulomb, Law};
use granflow::simulation::StepSize;

/// The scheme over the bed `B`.
pub type Tried<B> = EnergyStable<Law, B>;

/// Its two orders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// `energy_stable`.
    EnergyStable,
    /// `energy_stable_2`.
    EnergyStable2,
}

pub const ORDERS: [Order; 2] = [Order::EnergyStable, Order::EnergyStable2];

impl Order {
    pub fn scheme<B>(self, mu: f64, film: f64) -> Tried<B> {
        let law = Law::Coulomb(Coulomb { mu });
        match self {
            Order::EnergyStable => EnergyStable::first(law, film),
            Order::EnergyStable2 => EnergyStable::second(law, film),
        }
    }
    /// Its name in a case.
    pub fn name(self) -> &'static str {
        match self {
            Order::EnergyStable => "energy_stable",
            Order::EnergyStable2 => "energy_stable_2",
        }
    }
    /// What passes a face is the flux of the equation; else the pressure of a level surface is in the force on a cell.
    pub fn pressure_is_in_the_flux(self) -> bool {
        false
    }
    /// How far a flow along one axis may differ between one dimension and two, where what a cell can pay for is shared by twice as
    /// many faces.
    pub fn off_in_two_dimensions(self) -> f64 {
        0.02
    }
    /// The share of the static bound beyond which a cone of a radius of a few cells starts: what the grid does not resolve of its
    /// surface holds too (`docs/rest.md`).
    pub fn cone_starts(self) -> f64 {
        1.05
    }
    /// It takes steps beyond its largest Courant number.
    pub fn takes_long_steps(self) -> bool {
        false
    }
    /// A two-stage step whose last stage stops is at rest at its end.
    pub fn ends_early(self) -> bool {
        false
    }
    /// The largest total variation of the published Riemann problem (exact 0.5): the force is central, so that a
    /// shock overshoots by 1 %.
    pub fn variation(self) -> f64 {
        match self {
            Order::EnergyStable => 0.502,
            Order::EnergyStable2 => 0.507,
        }
    }
    /// The step of an ordinary run.
    pub fn courant(self) -> StepSize {
        match self {
            Order::EnergyStable => StepSize::Courant(0.9),
            Order::EnergyStable2 => StepSize::Courant(0.7),
        }
    }
    /// The largest step the scheme allows.
    pub fn limit(self) -> StepSize {
        StepSize::Courant(1.0)
    }
}
