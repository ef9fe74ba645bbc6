use super::*;
use crate::output::checkpoint::{Origin, Past};
use crate::output::frames::Field;
use std::borrow::Cow;
use std::fs;
use std::path::Path;
use std::time::Duration;

const LENGTHS: [usize; 3] = [2 * NUMBERS + 700, 3, AT_ONCE + 1];
const OUTLETS: [&str; 5] = ["left", "right", "bottom", "top", "nodata"];

fn store(folder: &Path, precision: Precision) -> Frames {
    let field = |(k, length): (usize, usize)| Field { name: format!("field_{k}"), length };
    let fields = LENGTHS.into_iter().enumerate().map(field).collect();
    Frames::create(&folder.join("frames.bin"), precision, fields).unwrap()
}

fn writer(folder: &Path, frames: Frames) -> Writer {
    let ledger = Ledger::create(&folder.join("mass.csv"), OUTLETS).unwrap();
    Writer::start(frames, ledger, [None, None], folder.join("state.bin")).unwrap()
}

fn value(time: f64, field: usize, number: usize) -> f64 {
    (time + 1.0) / 3.0 + (field * 1_000_000 + number) as f64
}

/// Order the frame at `time`.
fn order(writer: &mut Writer, time: f64) -> Result<(), Error> {
    writer.frame(time, |field, from, values| {
        values.iter_mut().zip(from..).for_each(|(here, number)| *here = value(time, field, number));
    })
}

fn entry(step: u64) -> Entry {
    Entry { step, time: step as f64 / 3.0, ..Entry::default() }
}

fn saved<'a>(step: u64, state: &'a [f64]) -> Checkpoint<'a> {
    let numbers = Numbers::Double(state.into());
    let arrays = vec![
        ("state_0".to_owned(), numbers),
        ("map".to_owned(), Numbers::Single(Cow::Borrowed(&[0.1, 7.0]))),
    ];
    let scalars = vec![("peak".to_owned(), 0.1)];
    Checkpoint {
        origin: Origin::default(),
        past: Past::default(),
        ended: None,
        step,
        time: 0.5,
        scalars,
        arrays,
    }
}

#[test]
fn the_files_are_those_that_would_be_written_at_once() {
    for precision in [Precision::F32, Precision::F64] {
        let [at_once, beside] = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
        let state: Vec<f64> = (0..NUMBERS + 9).map(|k| (k as f64).sqrt()).collect();
        let mut writer = writer(beside.path(), store(beside.path(), precision));
        let mut frames = store(at_once.path(), precision);
        let mut ledger = Ledger::create(&at_once.path().join("mass.csv"), OUTLETS).unwrap();
        for step in 0..4 {
            let time = step as f64;
            order(&mut writer, time).unwrap();
            writer.line(entry(step)).unwrap();
            writer.checkpoint(&saved(step, &state)).unwrap();
            let fields: Vec<Vec<f64>> = (0..LENGTHS.len())
                .map(|field| (0..LENGTHS[field]).map(|number| value(time, field, number)).collect())
                .collect();
            frames.append(time, &fields.iter().map(Vec::as_slice).collect::<Vec<_>>()).unwrap();
            ledger.append(entry(step)).unwrap();
            let marks = Marks { frames: frames.mark(), ledger: ledger.mark(), ..Marks::default() };
            saved(step, &state).write(&at_once.path().join("state.bin"), marks).unwrap();
        }
        let (kept, lines) = writer.end().unwrap();
        assert_eq!((kept.times(), lines.entries()), (frames.times(), ledger.entries()));
        for file in ["frames.bin", "mass.csv", "state.bin"] {
            let [one, other] = [&at_once, &beside].map(|folder| fs::read(folder.path().join(file)).unwrap());
            assert!(one == other, "{file} differs");
        }
    }
}

#[test]
fn pieces_come_back_to_be_filled_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = writer(folder.path(), store(folder.path(), Precision::F32));
    let frames = 2 * PIECES / 5; // five pieces each
    (0..frames).for_each(|k| order(&mut writer, k as f64).unwrap());
    assert!(writer.made <= PIECES, "{}", writer.made);
    let (mut frames_kept, _) = writer.end().unwrap();
    assert_eq!(frames_kept.times().len(), frames);
    let last = (frames - 1) as f64;
    assert_eq!(frames_kept.read(frames - 1, 1).unwrap()[2], f64::from(value(last, 1, 2) as f32));
}

#[test]
fn a_refusing_disk_is_told_while_the_run_goes_on_and_earlier_orders_stand() {
    let folder = tempfile::tempdir().unwrap();
    let unwilling = store(folder.path(), Precision::F64).again().unwrap(); // opened to be read
    let mut writer = writer(folder.path(), unwilling);
    writer.line(entry(0)).unwrap();
    let mut told = order(&mut writer, 0.0);
    for _ in 0..1000 {
        if told.is_err() {
            break;
        }
        std::thread::sleep(Duration::from_millis(5));
        told = writer.check();
    }
    let message = told.unwrap_err().to_string();
    assert!(message.contains("frames.bin: cannot write"), "{message}");
    drop(writer);
    assert_eq!(Ledger::open(&folder.path().join("mass.csv")).unwrap().entries(), [entry(0)]);
    assert!(Frames::open(&folder.path().join("frames.bin")).unwrap().0.times().is_empty());
}

#[test]
fn a_run_that_fails_leaves_what_it_had_ordered() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = writer(folder.path(), store(folder.path(), Precision::F64));
    (0..9).for_each(|k| order(&mut writer, f64::from(k)).unwrap());
    drop(writer);
    let (frames, torn) = Frames::open(&folder.path().join("frames.bin")).unwrap();
    assert_eq!((frames.times().len(), torn), (9, None));
}
