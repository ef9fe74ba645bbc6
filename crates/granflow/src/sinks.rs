//! What is shown a run after every step: memory, files, a callback, a flag that ends it.

mod callback;
#[cfg(feature = "files")]
mod files;
mod memory;
mod schedule;

pub use crate::run::{Sink, SinkError};
pub use callback::{Callback, Stop};
#[cfg(feature = "files")]
pub use files::{BeginError, Files};
pub use memory::{Memory, Recording};
pub use schedule::Schedule;
