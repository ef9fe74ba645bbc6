//! What tells one scheme from another: the slopes.

/// How a cell's values vary across it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Slopes {
    /// Not at all: first order.
    None,
    /// By the smaller of the two differences, minmod (eqs. 16-18, theta = 1/2): second order.
    Minmod,
    /// By Theta(E) times that, Theta = E^2/(E^2 + h^exponent) (eqs. 36-39), E the first-order residual of the cell: 0 at a
    /// steady state.
    Adaptive {
        /// m of h^m.
        exponent: f64,
    },
}

/// The scheme: what tells its variants apart are the slopes. Where it is known that there are none, `LIMITED` is false.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HadelerKuttler<const LIMITED: bool = true> {
    /// The slopes.
    pub slopes: Slopes,
}

/// First order (eqs. 8-10).
pub const FIRST_ORDER: HadelerKuttler = HadelerKuttler { slopes: Slopes::None };

/// Second order (eqs. 16-23); not well-balanced in v.
pub const SECOND_ORDER: HadelerKuttler = HadelerKuttler { slopes: Slopes::Minmod };

/// Second order away from steady states, first order and well-balanced at them (eqs. 36-40), with exponent 2.
pub const ADAPTIVE: HadelerKuttler = HadelerKuttler { slopes: Slopes::Adaptive { exponent: 2.0 } };
