//! Ctrl-C: the first ends the run at its next step, the second ends the program at once.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::Failure;

static ASKED: AtomicBool = AtomicBool::new(false);

/// Starts to listen; the flag is true once the user asked for the end.
pub fn listen() -> Result<&'static AtomicBool, Failure> {
    ctrlc::set_handler(|| {
        if ASKED.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
        eprintln!("\ninterrupted: ending at the next step; press Ctrl-C again to end at once");
    })
    .map_err(|error| {
        Failure::usage(format!("cannot listen for Ctrl-C: {error}"), "start granflow from a shell")
    })?;
    Ok(&ASKED)
}
