//! A dam that stops, and a jump that stays a jump. Errors and orders: `granflow verify`.
#![allow(clippy::duplicate_mod, reason = "the same tests for each scheme")]

#[path = "../oracle/mod.rs"]
mod oracle;

#[path = "."]
mod energy_stable {
    #[path = "stopping.rs"]
    mod stopping;
    #[path = "../support/mod.rs"]
    mod support;
    #[path = "../support/energy_stable.rs"]
    mod tried;
}

#[path = "."]
mod balanced {
    #[path = "stopping.rs"]
    mod stopping;
    #[path = "../support/mod.rs"]
    mod support;
    #[path = "../support/balanced.rs"]
    mod tried;
}
