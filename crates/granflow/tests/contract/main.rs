//! What every scheme owes: consistency, symmetry, positivity, mass, and one result whatever computes it.
#![allow(clippy::duplicate_mod, reason = "the same tests for each scheme")]

#[path = "."]
mod energy_stable {
    #[path = "schemes.rs"]
    mod schemes;
    #[path = "../support/mod.rs"]
    mod support;
    #[path = "../support/energy_stable.rs"]
    mod tried;
}

#[path = "."]
mod balanced {
    #[path = "schemes.rs"]
    mod schemes;
    #[path = "../support/mod.rs"]
    mod support;
    #[path = "../support/balanced.rs"]
    mod tried;
}
