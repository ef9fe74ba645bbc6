//! x

pub mod case;
