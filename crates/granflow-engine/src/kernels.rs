//! The schemes of this project, each with its inner loops compiled once. Where a scheme is generic, the list says over which friction
//! law and bed.

pub use crate::kernel::Kernel;
use granflow_model::hadeler_kuttler::scheme::HadelerKuttler;
use granflow_model::savage_hutter::balanced::Balanced;
use granflow_model::savage_hutter::energy_stable::EnergyStable;
use granflow_model::savage_hutter::friction::{AnyLaw, Law};
use granflow_model::savage_hutter::ground::{Chute, Terrain};
use granflow_model::savage_hutter::kinetic::Kinetic;

crate::kernel!(kinetic: Kinetic);
crate::kernel!(balanced_chute: Balanced<Law, Chute<D, f64>>, Balanced<Law, Chute<1, f64>>, Balanced<Law, Chute<2, f64>>, over);
// A terrain in one dimension is for tests: no run of a case has one.
crate::kernel!(
    balanced_terrain: Balanced<Law, Terrain<D, f64>>, Balanced<Law, Terrain<1, f64>>, Balanced<Law, Terrain<2, f64>>, over, scalar
);
crate::kernel!(
    energy_stable_chute: EnergyStable<Law, Chute<D, f64>>, EnergyStable<Law, Chute<1, f64>>, EnergyStable<Law, Chute<2, f64>>, over
);
crate::kernel!(
    energy_stable_terrain: EnergyStable<Law, Terrain<D, f64>>, EnergyStable<Law, Terrain<1, f64>>, EnergyStable<Law, Terrain<2, f64>>,
    over, scalar
);
// Laws with powers and iterations, and parameters that differ from cell to cell.
crate::kernel!(
    energy_stable_chute_any: EnergyStable<AnyLaw, Chute<D, f64>>, EnergyStable<AnyLaw, Chute<1, f64>>,
    EnergyStable<AnyLaw, Chute<2, f64>>, over, scalar; scalar
);
crate::kernel!(
    energy_stable_terrain_any: EnergyStable<AnyLaw, Terrain<D, f64>>, EnergyStable<AnyLaw, Terrain<1, f64>>,
    EnergyStable<AnyLaw, Terrain<2, f64>>, over, scalar; scalar
);
crate::kernel!(hadeler_kuttler: HadelerKuttler);
