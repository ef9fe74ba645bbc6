//! Several cells side by side: the same formulas on SIMD lanes, with the same bits.

mod level;
mod simd;
#[cfg(test)]
mod tests;
mod vector;

pub use level::{Contexts, SimdLevel};
pub(crate) use level::{SimdContext, SimdKernel};
pub use vector::SimdVector;
pub(crate) use vector::{MAX_LANES, prefetch};
