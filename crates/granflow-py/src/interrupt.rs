//! Work without Python's lock that Ctrl-C ends.

use pyo3::prelude::*;
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::time::Duration;

/// Between two looks at Ctrl-C and the progress.
pub const PAUSE: Duration = Duration::from_millis(100);

/// Does `work` on a thread of its own while this one, which alone hears of signals, looks at Ctrl-C and calls `look` now and then;
/// `stop` is called once at the first exception of either, which is returned beside what the work gave.
pub fn watched<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send,
    stop: impl Fn() + Sync,
    look: impl Fn(Python<'_>) -> PyResult<()> + Sync,
) -> (T, Option<PyErr>) {
    py.detach(|| {
        std::thread::scope(|scope| {
            let (done, wait) = sync_channel::<()>(1);
            let worker = scope.spawn(move || {
                let _done = done; // dropped at the end, also by a panic
                work()
            });
            let mut interrupt = None;
            while let Err(RecvTimeoutError::Timeout) = wait.recv_timeout(PAUSE) {
                if interrupt.is_none() {
                    interrupt = Python::attach(|py| py.check_signals().and_then(|()| look(py))).err();
                    if interrupt.is_some() {
                        stop();
                    }
                }
            }
            let result = worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            (result, interrupt)
        })
    })
}
