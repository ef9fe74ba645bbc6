//! What should start starts, what flows comes to rest by itself. What should rest: `granflow verify G`.
#![allow(clippy::duplicate_mod, reason = "the same tests for each scheme")]

#[path = "../oracle/mod.rs"]
mod oracle;

#[path = "."]
mod energy_stable {
    #[path = "piles.rs"]
    mod piles;
    #[path = "../support/mod.rs"]
    mod support;
    #[path = "../support/energy_stable.rs"]
    mod tried;
}

#[path = "."]
mod balanced {
    #[path = "piles.rs"]
    mod piles;
    #[path = "../support/mod.rs"]
    mod support;
    #[path = "../support/balanced.rs"]
    mod tried;
}
