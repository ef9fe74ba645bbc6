//! The signals that end a command: the first as soon as everything is whole, the second the program at once.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use crate::failure::{Failure, tell};

static ASKED: AtomicBool = AtomicBool::new(false);
/// Between two looks at [`ASKED`] while somebody waits.
pub const LOOK: Duration = Duration::from_millis(20);

/// Starts to listen to Ctrl-C, SIGTERM and SIGHUP; the flag is true once one of them came.
pub fn listen() -> Result<&'static AtomicBool, Failure> {
    system::listen().map_err(|error| {
        Failure::usage(format!("cannot listen for Ctrl-C: {error}"), "start granflow from a shell")
    })?;
    Ok(&ASKED)
}

/// A limit on the size of files (SIGXFSZ) is from now on an error of the write, which names the file, and not the end of the
/// program.
pub fn outlive_limits() {
    system::outlive_limits();
}

/// Did a signal ask for the end?
pub fn is_asked() -> bool {
    ASKED.load(Ordering::SeqCst)
}

/// Does `work` on a thread of its own and gives what it came to; `None` once a signal asks for the end. The work is then
/// abandoned where it is: it must not write.
pub fn unless_asked<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Option<T> {
    let (done, waiting) = channel();
    // Whoever abandoned the work does not wait for it.
    let worker = thread::spawn(move || drop(done.send(work())));
    loop {
        match waiting.recv_timeout(LOOK) {
            Ok(result) => return Some(result),
            Err(RecvTimeoutError::Timeout) if is_asked() => return None,
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                // Nothing was sent: the work panicked.
                let panic = worker.join().err()?;
                std::panic::resume_unwind(panic);
            }
        }
    }
}

fn asked() {
    if ASKED.swap(true, Ordering::SeqCst) {
        std::process::exit(130);
    }
    tell("\ninterrupted: ending with all files whole; a second Ctrl-C or signal ends at once\n");
}

#[cfg(unix)]
mod system {
    use std::io;
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;
    use std::thread;

    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::iterator::Signals;

    pub fn listen() -> io::Result<()> {
        let mut signals = Signals::new([SIGINT, SIGTERM])?;
        if !hangup_is_ignored() {
            signals.add_signal(SIGHUP)?;
        }
        thread::Builder::new().name("granflow-signals".to_owned()).spawn(move || {
            for _ in signals.forever() {
                super::asked();
            }
        })?;
        Ok(())
    }

    pub fn outlive_limits() {
        // Without a handler the limit ends the program, as it did before; nothing else is lost.
        let _ = signal_hook::flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)));
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

    pub fn outlive_limits() {}
}
