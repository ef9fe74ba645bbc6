//! A step asks for no memory once the first one is done.

mod support;

use granflow::observe::Maps;
use granflow::savage_hutter::Flow;
use granflow::scheme::Boundary;
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::Barrier;
use std::sync::atomic::{AtomicU64, Ordering};
use support::{ORDERS, grid, on_plane, plane, steps};

struct Counting;

static BYTES: AtomicU64 = AtomicU64::new(0);

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        BYTES.fetch_add(layout.size() as u64, Ordering::Relaxed);
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
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        for order in ORDERS {
            let bytes = pool.install(|| {
                if threads == 2 {
                    // A thread sets up its own tools when it first takes work from another: let both do so.
                    let (one, two) = (Barrier::new(2), Barrier::new(2));
                    let back = || {
                        one.wait();
                        rayon::join(|| two.wait(), || two.wait());
                    };
                    rayon::join(|| one.wait(), back);
                }
                let sheet = grid([120, 90], [0.0; 2], 0.1, Boundary::Open);
                let pile = |[x, y]: [f64; 2]| Flow::still((1.0 - (x - 6.0).hypot(y - 4.0)).max(0.0));
                let mut run =
                    on_plane(order, (0.3, 1e-6), order.courant(), sheet, plane([0.2, 0.1], 0.4), pile);
                run.maps = Some(Maps::new(run.layout()));
                steps(&mut run, 1);
                let before = BYTES.load(Ordering::Relaxed);
                steps(&mut run, 200);
                BYTES.load(Ordering::Relaxed) - before
            });
            assert_eq!(bytes, 0, "{order:?} on {threads} threads");
        }
    }
}
