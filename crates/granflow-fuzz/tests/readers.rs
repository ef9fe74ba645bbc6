//! So many inputs for each reader, the same in every run.

use granflow_fuzz::readers::READERS;
use granflow_fuzz::{Until, campaign};

#[test]
fn no_input_panics_hangs_or_fills_the_memory() {
    for reader in &READERS {
        let inputs = if reader.on_disk() { 2_000 } else { 20_000 };
        let outcome = campaign(reader, Until::Inputs(inputs), 7).unwrap();
        assert_eq!(outcome.failures, [], "{}", reader.name);
        println!("{}: {} inputs", reader.name, outcome.inputs);
    }
}
