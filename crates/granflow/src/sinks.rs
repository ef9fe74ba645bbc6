//! What is shown a run after every step: memory, files, a callback, a flag that ends it.

mod callback;
#[cfg(feature = "files")]
mod files;
#[cfg(feature = "files")]
mod keep;
mod memory;
mod schedule;
#[cfg(feature = "files")]
mod series;

pub use crate::run::{Sink, SinkError};
pub use callback::{Callback, Stop};
#[cfg(feature = "files")]
pub(crate) use files::checkpoints;
#[cfg(feature = "files")]
pub use files::{BeginError, Files};
#[cfg(feature = "files")]
pub use keep::{Keep, Kept};
pub use memory::{Memory, Recording};
pub use schedule::Schedule;
