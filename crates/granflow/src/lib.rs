//! x

pub mod savage_hutter;
