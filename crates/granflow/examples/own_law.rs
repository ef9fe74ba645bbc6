//! A friction law of one's own, from outside: the mu(Fr) law of Pouliquen & Forterre (J. Fluid Mech. 453, 2002) in the smooth
//! form mu = mu_1 + (mu_2 - mu_1) Fr^2/(Fr^2 + Fr_0^2), Fr^2 = |V|^2/(N h). A slab on a slope between the two angles comes to
//! the one speed at which friction balances gravity; a thin one on a gentle slope stays at rest bit for bit.
//!
//! `cargo run --release -p granflow --example own_law`

use granflow::build::Grid;
use granflow::model::Plane;
use granflow::models::savage_hutter::ChuteDomain;
use granflow::models::savage_hutter::run::flowing::Flowing;
use granflow::real::Real;
use granflow::run::{Run, Simulated};
use granflow::savage_hutter::Flow;
use granflow::savage_hutter::balanced::Balanced;
use granflow::savage_hutter::friction::{Friction, Resistance};
use granflow::savage_hutter::ground::Chute;
use granflow::scheme::Boundary;
use granflow::simulation::{Simulation, StepSize};
use std::sync::Arc;

/// Gravity \[m/s^2\].
const GRAVITY: f64 = 9.81;

/// mu between `low` at rest and `high` in fast flow; at the Froude number `froude` it is half way.
#[derive(Clone, Copy, Debug)]
struct Pouliquen {
    low: f64,
    high: f64,
    froude: f64,
}

impl Friction for Pouliquen {
    #[inline(always)]
    fn resistance<R: Real>(&self, thickness: R, speed_squared: R, load: R, weight: R) -> Resistance<R> {
        // Fr^2/(Fr^2 + Fr_0^2), multiplied through by N h: no division by a vanishing load.
        let still = R::splat(self.froude * self.froude) * load * thickness;
        let sum = still + speed_squared;
        let none = sum.le(R::zero());
        let share = R::select(none, R::zero(), speed_squared / R::select(none, R::splat(1.0), sum));
        let low = R::splat(self.low);
        Resistance {
            dry: (low + R::splat(self.high - self.low) * share) * load,
            viscous: R::zero(),
            drag: R::zero(),
            holding: low * weight,
        }
    }
}

/// The default scheme with the law, on a plane, in one dimension.
type Scheme = Balanced<Pouliquen, Chute<1, f64>>;

granflow::kernel!(pouliquen: const LOOPS = Scheme, 1);

const LAW: Pouliquen = Pouliquen { low: 0.36, high: 0.6, froude: 2.0 };

/// A slab of this thickness \[m\] on an endless plane.
fn slab(thickness: f64, angle: f64) -> Result<Box<dyn Run>, Box<dyn std::error::Error>> {
    let grid = Grid { boundary: [[Boundary::Periodic; 2]], ..Grid::line([0.0, 10.0], 50) };
    let cos = GRAVITY * angle.cos();
    let plane = Chute { tilt: [GRAVITY * angle.sin()], beta: cos, cos, curvature: 0.0 };
    let scheme = Scheme::first(LAW, 1e-6);
    let start = |_| Flow::still(thickness);
    let simulation = Simulation::with_loops(LOOPS, scheme, grid, StepSize::Courant(0.9), |_| plane, start)?;
    let shown = Flowing::<1, Scheme>::new("balanced", 1e-6, false);
    Ok(Box::new(Simulated::new(simulation, shown, Plane::of(&grid, Arc::new(ChuteDomain::default())))))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (thickness, angle) = (0.5, 25_f64.to_radians());
    let mut run = slab(thickness, angle)?;
    run.until(60.0)?;
    // tan(angle) = mu(Fr): Fr^2 = Fr_0^2 (tan - mu_1)/(mu_2 - tan).
    let tan = angle.tan();
    let froude = LAW.froude * ((tan - LAW.low) / (LAW.high - tan)).sqrt();
    let exact = froude * (GRAVITY * angle.cos() * thickness).sqrt();
    let speed = run.stepper().speed();
    println!("a slab on 25 degrees: {speed:.6} m/s, exact {exact:.6} m/s");
    assert!((speed / exact - 1.0).abs() < 1e-6);

    let mut run = slab(0.01, 18_f64.to_radians())?;
    run.until(10.0)?;
    assert!(run.at_rest() && run.field("thickness").expect("it has one").iter().all(|h| h == 0.01));
    println!("a slab on 18 degrees: at rest");
    Ok(())
}
