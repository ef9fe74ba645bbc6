//! Time stepping as a table of Shu-Osher weights over one forward-Euler map.
//!
//! Stage k: W_k = keep_k U^n + (1 - keep_k) E_dt(W_{k-1}), W_0 = U^n (Shu & Osher, J. Comput. Phys. 77, 1988).

/// One weight `keep` a stage.
pub type Stages = &'static [f64];

/// Forward Euler, as the published schemes step.
pub const EULER: Stages = &[0.0];

/// Heun's method, strong-stability preserving, second order.
pub const SSP_RK2: Stages = &[0.0, 0.5];
