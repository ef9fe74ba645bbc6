//! What a run on a mountain takes of the memory: the fields of its engine, from the first file that is read to the last that
//! is written, and little beside them.

use granflow::Case;
use granflow::raster::{Crs, Raster};
use granflow::session::Options;
use std::alloc::{GlobalAlloc, Layout, System};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// What is asked for and not given back, now and at most.
struct Counting;

static LIVE: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

fn taken(bytes: usize) {
    let live = LIVE.fetch_add(bytes, Ordering::Relaxed) + bytes;
    PEAK.fetch_max(live, Ordering::Relaxed);
}

fn given_back(bytes: usize) {
    LIVE.fetch_sub(bytes, Ordering::Relaxed);
}

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        taken(layout.size());
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        taken(layout.size());
        // SAFETY: as the caller promises.
        unsafe { System.alloc_zeroed(layout) }
    }
    unsafe fn realloc(&self, start: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        given_back(layout.size());
        taken(size);
        // SAFETY: as the caller promises.
        unsafe { System.realloc(start, layout, size) }
    }
    unsafe fn dealloc(&self, start: *mut u8, layout: Layout) {
        given_back(layout.size());
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(start, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Most bytes that `work` holds at once, beyond what is held before.
fn most<T>(work: impl FnOnce() -> T) -> (T, usize) {
    let before = LIVE.load(Ordering::Relaxed);
    PEAK.store(before, Ordering::Relaxed);
    let done = work();
    (done, PEAK.load(Ordering::Relaxed) - before)
}

/// Cells along each axis.
const CELLS: usize = 1500;

/// A valley of which a corner is unknown, and a heap on its slope.
fn mountain(folder: &Path) -> Case {
    let height = |k: usize| {
        let [x, y] = [k % CELLS, k / CELLS].map(|i| 5.0 * i as f64);
        let z = 500.0 + 0.5 * y + 40.0 * (0.002 * x).sin() + 3.0 * (0.03 * x).sin() * (0.02 * y).cos();
        if x + y < 200.0 { f64::NAN } else { z }
    };
    let values = (0..CELLS * CELLS).map(height).collect();
    let crs = Some(Crs::parse("EPSG:31287").unwrap());
    let dem = Raster { columns: CELLS, rows: CELLS, west: 4e5, south: 3e5, cell: 5.0, values, crs };
    dem.write_geotiff(&folder.join("dem.tif")).unwrap();
    let case = r#"
[terrain]
dem = "dem.tif"
curvature = { length = "20 m" }
[material]
density = 200.0
friction.coulomb = { mu = 0.3 }
[[release]]
cap = { height = 3.0, centre = [403000.0, 305000.0], radius = 300.0 }
[time]
steps = 2
[output]
steps = 100
files = ["netcdf"]
"#;
    let file = folder.join("case.toml");
    std::fs::write(&file, case).unwrap();
    Case::read(&file).unwrap()
}

/// One test in this file: the allocator counts for the whole process.
#[test]
fn a_run_on_a_mountain_takes_what_its_fields_take() {
    let folder = tempfile::tempdir().unwrap();
    let case = mountain(folder.path());
    let per_cell = |bytes: usize| bytes as f64 / (CELLS * CELLS) as f64;
    // The tiles and the ghosts of this grid, and what is released.
    const BESIDE: f64 = 3.0;
    const ELEVATION: f64 = 8.0;
    let checked = || case.check().unwrap();
    let (fields, bytes) = most(|| {
        let run = checked().start().unwrap();
        [false, true].map(|maps| run.stepper().bytes_per_cell(maps))
    });
    let most_of_all = (fields[0] as f64 + ELEVATION).max(fields[1] as f64) + BESIDE;
    assert!(per_cell(bytes) < most_of_all, "{} bytes a cell to set up {fields:?}", per_cell(bytes));

    let options = Options {
        directory: folder.path().join("out"),
        threads: 2,
        resume: false,
        command: "test".to_owned(),
        notice: &|_| (),
    };
    let (finished, bytes) =
        most(|| checked().compute(&options, &AtomicBool::new(false), &mut |_| ()).unwrap());
    assert_eq!(finished.summary.steps, 2);
    // What the writer may have in hand.
    let most_of_all = fields[1] as f64 + BESIDE + per_cell(32 << 20);
    assert!(per_cell(bytes) < most_of_all, "{} bytes a cell to run {}", per_cell(bytes), fields[1]);
}
