//! The signals that end a run: the first at its next step, the second the program at once.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::{Failure, tell};

static ASKED: AtomicBool = AtomicBool::new(false);

/// Starts to listen to Ctrl-C, SIGTERM and SIGHUP; the flag is true once one of them came.
pub fn listen() -> Result<&'static AtomicBool, Failure> {
    system::listen().map_err(|error| {
        Failure::usage(format!("cannot listen for Ctrl-C: {error}"), "start granflow from a shell")
    })?;
    Ok(&ASKED)
}

fn asked() {
    if ASKED.swap(true, Ordering::SeqCst) {
        std::process::exit(130);
    }
    tell("\ninterrupted: ending at the next step; a second Ctrl-C or signal ends at once\n");
}

#[cfg(unix)]
mod system {
    use std::io;
    use std::thread;

    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::iterator::Signals;

    pub fn listen() -> io::Result<()> {
        // A limit on the size of files is then an error of the write, which names the file, and not the end of the program.
        let mut signals = Signals::new([SIGINT, SIGTERM, SIGXFSZ])?;
        if !hangup_is_ignored() {
            signals.add_signal(SIGHUP)?;
        }
        thread::Builder::new().name("granflow-signals".to_owned()).spawn(move || {
            for signal in signals.forever() {
                if signal != SIGXFSZ {
                    super::asked();
                }
            }
        })?;
        Ok(())
    }

    /// `nohup` starts a program so that it outlives its terminal.
    fn hangup_is_ignored() -> bool {
        let mut now = std::mem::MaybeUninit::<libc::sigaction>::zeroed();
        // SAFETY: nothing is set, and what the call fills is a plain struct of which zeros are a value.
        unsafe {
            libc::sigaction(SIGHUP, std::ptr::null(), now.as_mut_ptr()) == 0
                && now.assume_init().sa_sigaction == libc::SIG_IGN
        }
    }
}

#[cfg(not(unix))]
mod system {
    pub fn listen() -> Result<(), ctrlc::Error> {
        ctrlc::set_handler(super::asked)
    }
}
