//! A few seconds for each reader; the time decides how many inputs, the seed which.

use granflow_fuzz::readers::READERS;
use granflow_fuzz::{Until, campaign};
use std::time::Duration;

#[test]
fn no_input_panics_hangs_or_fills_the_memory() {
    for reader in &READERS {
        let outcome = campaign(reader, Until::Time(Duration::from_secs(5)), 7).unwrap();
        assert_eq!(outcome.failures, [], "{}", reader.name);
        println!("{}: {} inputs", reader.name, outcome.inputs);
    }
}
