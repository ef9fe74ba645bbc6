//! What is fixed in a cell: the papers' chute, or a piece of a mountain.

mod bed;
mod chute;
mod terrain;

pub use bed::{Bed, Towards};
pub use chute::{Chute, Layer};
pub use terrain::{Tangent, Terrain};
