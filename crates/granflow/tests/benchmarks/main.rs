//! The benchmarks with known answers: three resolutions each, errors and orders as rows of data with their bounds.
//! `cargo test --release --test benchmarks -- --nocapture` prints the verification table.
#![allow(clippy::duplicate_mod, reason = "the same tests for each scheme")]

#[path = "../oracle/mod.rs"]
mod oracle;

#[path = "."]
mod energy_stable {
    #[path = "../support/mod.rs"]
    mod support;
    #[path = "table.rs"]
    mod table;
    #[path = "../support/energy_stable.rs"]
    mod tried;
}

#[path = "."]
mod balanced {
    #[path = "../support/mod.rs"]
    mod support;
    #[path = "table.rs"]
    mod table;
    #[path = "../support/balanced.rs"]
    mod tried;
}
