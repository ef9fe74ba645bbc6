//! `granflow-fuzz READER|all INPUTS|FILE`: reads so many changed inputs, or one file.

use granflow_fuzz::readers::{READERS, Reader};
use granflow_fuzz::{Until, campaign, once};
use std::process::ExitCode;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let names = READERS.map(|reader| reader.name).join(", ");
    let [name, what] = words.as_slice() else {
        eprintln!("usage: granflow-fuzz READER|all INPUTS|FILE; readers: {names}");
        return ExitCode::from(2);
    };
    let chosen: Vec<&Reader> = READERS.iter().filter(|reader| name == "all" || reader.name == name).collect();
    if chosen.is_empty() {
        eprintln!("there is no reader `{name}`; there are {names}");
        return ExitCode::from(2);
    }
    let mut failed = false;
    for reader in chosen {
        let found = match what.parse() {
            Ok(inputs) => campaign(reader, Until::Inputs(inputs), 1).map(|outcome| {
                println!("{}: {} inputs, {} failed", reader.name, outcome.inputs, outcome.failures.len());
                let lines =
                    outcome.failures.iter().map(|(path, problem)| format!("{}: {problem}", path.display()));
                lines.collect::<Vec<_>>()
            }),
            Err(_) => std::fs::read(what).map(|bytes| once(reader, &bytes).err().into_iter().collect()),
        };
        let lines = found.unwrap_or_else(|error| vec![error.to_string()]);
        lines.iter().for_each(|line| println!("{line}"));
        failed |= !lines.is_empty();
    }
    ExitCode::from(u8::from(failed))
}
