//! Inputs that nobody wrote, for every reader of granflow: none may panic, hang or fill the memory.

mod campaign;
mod mutate;
pub mod readers;
mod results;

pub use campaign::{Outcome, Until, campaign, once};

/// Counts what is allocated.
#[global_allocator]
pub static MEMORY: cap::Cap<std::alloc::System> = cap::Cap::new(std::alloc::System, usize::MAX);
