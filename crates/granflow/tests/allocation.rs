//! A step asks for no memory once the first one is done.

mod support;
#[path = "support/energy_stable.rs"]
mod tried;

use granflow::savage_hutter::Flow;
use granflow::scheme::Boundary;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering};
use support::{ORDERS, grid, on_plane, plane, steps};

struct Counting;

static BYTES: AtomicU64 = AtomicU64::new(0);
thread_local! {
    /// Of the pool: what the test harness asks for beside it does not count.
    static COMPUTES: Cell<bool> = const { Cell::new(false) };
}

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if COMPUTES.get() {
            BYTES.fetch_add(layout.size() as u64, Ordering::Relaxed);
        }
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, start: *mut u8, layout: Layout) {
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(start, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// One test in this file: the allocator counts for the whole process.
#[test]
fn steps_allocate_nothing_after_the_first() {
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).start_handler(|_| COMPUTES.set(true));
        let pool = pool.build().expect("threads");
        for order in ORDERS {
            let bytes = pool.install(|| {
                let sheet = grid([120, 90], [0.0; 2], 0.1, Boundary::Open);
                let pile = |[x, y]: [f64; 2]| Flow::still((1.0 - (x - 6.0).hypot(y - 4.0)).max(0.0));
                let mut run =
                    on_plane(order, (0.3, 1e-6), order.courant(), sheet, plane([0.2, 0.1], 0.4), pile);
                run.keep_maps(1e-3);
                steps(&mut run, 1);
                // A thread of the pool sets up its own tools when it first takes work from another, once in its
                // life and whenever the system lets it: at most one of these spells may see that for each thread.
                let mut spell = || {
                    let before = BYTES.load(Ordering::Relaxed);
                    steps(&mut run, 60);
                    BYTES.load(Ordering::Relaxed) - before
                };
                (0..=threads).map(|_| spell()).collect::<Vec<_>>()
            });
            assert!(BYTES.load(Ordering::Relaxed) > 0, "the set-up asks for memory");
            let spoilt = bytes.iter().filter(|bytes| **bytes > 0).count();
            assert!(spoilt < threads + usize::from(threads > 1), "{order:?} on {threads} threads: {bytes:?}");
        }
    }
}
