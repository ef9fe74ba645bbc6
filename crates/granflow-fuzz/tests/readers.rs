//! So many inputs for each reader, the same in every run.

use granflow_fuzz::readers::READERS;
use granflow_fuzz::{Until, campaign};

#[test]
fn no_input_panics_hangs_or_fills_the_memory() {
    for reader in &READERS {
        let outcome = campaign(reader, Until::Inputs(20_000), 7).unwrap();
        assert_eq!(outcome.failures, [], "{}", reader.name);
        println!("{}: {} inputs", reader.name, outcome.inputs);
    }
}
