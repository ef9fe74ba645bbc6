//! granflow for a web page: runs that are held here and are opened, stepped and looked into through plain functions.
//!
//! Texts come in as UTF-8 at an address that [`granflow_allocate`] gave. What is short goes out as JSON in the *answer*, what is long as
//! the *numbers*, `f64` in a row; both stay until the next call. A function that fails answers `{"error": {..}}` and
//! returns a negative number.

mod answer;
// The mountain of `granflow demo`, by the program's own source.
#[allow(dead_code)]
#[path = "../../../crates/granflow-cli/src/mountain.rs"]
mod demo;
mod fma;
mod held;

use held::Held;
use serde_json::{Value, json};
use std::cell::RefCell;

pub use fma::fused;

#[derive(Default)]
struct Page {
    held: Vec<Option<Held>>,
    answer: String,
    numbers: Vec<f64>,
}

thread_local! {
    static PAGE: RefCell<Page> = RefCell::default();
}

/// Calls `work` on the page; a JSON error becomes the answer, and -1.
fn page(work: impl FnOnce(&mut Page) -> Result<i32, Value>) -> i32 {
    PAGE.with_borrow_mut(|page| {
        work(page).unwrap_or_else(|error| {
            page.answer = json!({ "error": error }).to_string();
            -1
        })
    })
}

/// Calls `work` on the run that `handle` names.
fn with_run(
    handle: i32,
    work: impl FnOnce(&mut Held, &mut String, &mut Vec<f64>) -> Result<i32, Value>,
) -> i32 {
    page(|page| match page.held.get_mut(handle as usize) {
        Some(Some(held)) => work(held, &mut page.answer, &mut page.numbers),
        _ => Err(answer::plain(format!("there is no run {handle}"))),
    })
}

/// The text of `length` bytes at `start`.
///
/// # Safety
/// There are that many bytes.
unsafe fn text<'a>(start: *const u8, length: usize) -> Result<&'a str, Value> {
    // SAFETY: as the caller promises.
    let bytes = unsafe { std::slice::from_raw_parts(start, length) };
    std::str::from_utf8(bytes).map_err(|error| answer::plain(format!("the text is not UTF-8: {error}")))
}

/// Room for `length` bytes, given back by [`granflow_free`].
#[unsafe(no_mangle)]
pub extern "C" fn granflow_allocate(length: usize) -> *mut u8 {
    Box::into_raw(vec![0_u8; length].into_boxed_slice()).cast()
}

/// Gives back what [`granflow_allocate`] gave.
///
/// # Safety
/// `start` came from [`granflow_allocate`] with this `length`, and is not used any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn granflow_free(start: *mut u8, length: usize) {
    // SAFETY: as the caller promises.
    drop(unsafe { Box::from_raw(std::ptr::slice_from_raw_parts_mut(start, length)) });
}

/// Where the answer is.
#[unsafe(no_mangle)]
pub extern "C" fn granflow_answer_start() -> *const u8 {
    PAGE.with_borrow(|page| page.answer.as_ptr())
}
/// How many bytes it has.
#[unsafe(no_mangle)]
pub extern "C" fn granflow_answer_length() -> usize {
    PAGE.with_borrow(|page| page.answer.len())
}
/// Where the numbers are.
#[unsafe(no_mangle)]
pub extern "C" fn granflow_numbers_start() -> *const f64 {
    PAGE.with_borrow(|page| page.numbers.as_ptr())
}
/// How many there are.
#[unsafe(no_mangle)]
pub extern "C" fn granflow_numbers_length() -> usize {
    PAGE.with_borrow(|page| page.numbers.len())
}

/// Opens the run of a case text, with overrides `key.path=value` after it, each behind a NUL; its handle, and what it is as
/// the answer.
///
/// # Safety
/// There are `length` bytes at `start`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn granflow_open(start: *const u8, length: usize) -> i32 {
    page(|page| {
        // SAFETY: as the caller promises.
        let held = Held::open(unsafe { text(start, length) }?)?;
        page.answer = held.about().to_string();
        let free = page.held.iter().position(Option::is_none).unwrap_or(page.held.len());
        page.held.resize_with(page.held.len().max(free + 1), || None);
        page.held[free] = Some(held);
        Ok(free as i32)
    })
}

/// Lets the run of a handle go on as that of another case text with the same cells: other sources, another end.
///
/// # Safety
/// There are `length` bytes at `start`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn granflow_change(handle: i32, start: *const u8, length: usize) -> i32 {
    with_run(handle, |held, _, _| {
        // SAFETY: as the caller promises.
        held.change(unsafe { text(start, length) }?).map(|()| 0)
    })
}

/// Frees the run of a handle.
#[unsafe(no_mangle)]
pub extern "C" fn granflow_close(handle: i32) {
    PAGE.with_borrow_mut(|page| {
        if let Some(held) = page.held.get_mut(handle as usize) {
            *held = None;
        }
    });
}

/// Steps until time `time`, or `steps` steps were taken, or about so many milliseconds have passed; 1 where the run has ended.
/// The state is the answer.
#[unsafe(no_mangle)]
pub extern "C" fn granflow_advance(handle: i32, time: f64, steps: f64, milliseconds: f64) -> i32 {
    with_run(handle, |held, answer, _| {
        held.advance(time, steps, milliseconds)?;
        *answer = held.state().to_string();
        Ok(i32::from(held.has_ended()))
    })
}

/// The numbers of a field or map of the run by its name; how many there are, 0 where there is none.
///
/// # Safety
/// There are `length` bytes at `start`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn granflow_field(handle: i32, start: *const u8, length: usize) -> i32 {
    with_run(handle, |held, _, numbers| {
        // SAFETY: as the caller promises.
        held.fill(unsafe { text(start, length) }?, numbers);
        Ok(numbers.len() as i32)
    })
}

/// Writes a field or map of the run as the file `NAME.tif`, a GeoTIFF.
///
/// # Safety
/// There are `length` bytes at `start`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn granflow_write(handle: i32, start: *const u8, length: usize) -> i32 {
    with_run(handle, |held, _, _| {
        // SAFETY: as the caller promises.
        held.write(unsafe { text(start, length) }?).map(|()| 0)
    })
}

/// The summary and the checksums of all fields and maps as the answer.
#[unsafe(no_mangle)]
pub extern "C" fn granflow_checksums(handle: i32) -> i32 {
    with_run(handle, |held, answer, _| {
        *answer = held.checksums().to_string();
        Ok(0)
    })
}

/// Reads a raster file: its values as numbers, the first row in the south, and where it lies as the answer.
///
/// # Safety
/// There are `length` bytes at `start`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn granflow_raster(start: *const u8, length: usize) -> i32 {
    page(|page| {
        // SAFETY: as the caller promises.
        let (about, values) = answer::raster(unsafe { text(start, length) }?)?;
        (page.answer, page.numbers) = (about.to_string(), values);
        Ok(page.numbers.len() as i32)
    })
}

/// Writes the elevation and the release of `granflow demo` as files `mountain.asc` and `release.geojson`.
#[unsafe(no_mangle)]
pub extern "C" fn granflow_demo() -> i32 {
    page(|_| {
        for (name, text) in [("mountain.asc", demo::elevation()), ("release.geojson", demo::release())] {
            std::fs::write(name, text).map_err(answer::plain)?;
        }
        Ok(0)
    })
}

/// The exact thickness of a dam break (Stoker 1957), `left` and `right` deep, at the cell centres of the run at its time.
#[unsafe(no_mangle)]
pub extern "C" fn granflow_exact_dam_break(handle: i32, beta: f64, left: f64, right: f64) -> i32 {
    with_run(handle, |held, _, numbers| {
        *numbers = held.exact_dam_break(beta, left, right)?;
        Ok(numbers.len() as i32)
    })
}
