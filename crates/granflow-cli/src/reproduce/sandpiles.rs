//! The schemes for growing sandpiles (Aggarwal, Veerappa Gowda & Sudarshan Kumar 2023).

use granflow::hadeler_kuttler::scheme::{FIRST_ORDER, HadelerKuttler, SECOND_ORDER, Slopes};

use crate::failure::Failure;

mod draw;
mod line;
mod numbers;
mod page;
pub mod plane;
mod printed;

pub use numbers::rows;
pub use page::chapters;

/// The paper's name on the command line, and a shorter one.
pub const NAMES: [&str; 2] = ["aggarwal_2023", "sandpiles"];

/// f: the paper's number is lost; 1/2 with λ = 0.45 gives the v of its Table 2 to all digits.
const SOURCE: f64 = 0.5;
/// λ = Δt/h of the paper's examples with a larger step.
const LAMBDA: f64 = 0.45;

/// The adaptive scheme with Θ = E²/(E² + h^m).
const fn adaptive(exponent: f64) -> HadelerKuttler {
    HadelerKuttler { slopes: Slopes::Adaptive { exponent } }
}

/// The three schemes, m = 3 in Θ: the choice that fits Table 1.
pub const SCHEMES: [(&str, HadelerKuttler); 3] =
    [("first order", FIRST_ORDER), ("second order", SECOND_ORDER), ("adaptive, m = 3", adaptive(3.0))];

/// All that is computed for the paper.
pub struct Runs {
    line: line::Runs,
    plane: plane::Runs,
}

impl Runs {
    /// Computes the interval beside the square, on all cores.
    pub fn compute() -> Result<Self, Failure> {
        std::thread::scope(|scope| {
            let plane = scope.spawn(plane::Runs::compute);
            let line = line::Runs::compute()?;
            let plane = plane.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
            Ok(Runs { line, plane })
        })
    }
}

fn failed(error: impl std::fmt::Display) -> Failure {
    Failure::Computation(error.to_string())
}
