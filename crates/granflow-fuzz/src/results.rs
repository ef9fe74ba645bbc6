//! What `plot` and `--resume` read again: files that a run left, changed since.

use granflow::Case;
use granflow::output::checkpoint::{Checkpoint, Origin};
use granflow::output::frames::Frames;
use granflow::output::ledger::Ledger;
use granflow::output::summary::Summary;
use granflow::results::Story;
use granflow::session::{Options, origin};
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;

const CHUTE: &str = "grid.x = { from = 0, to = 1, cells = 6 }\nmaterial.friction.coulomb.mu = 0.3\n\
                     initial.thickness.cap = { height = 1, centre = 0.5, radius = 0.3 }\ntime.steps = 3\noutput.steps = 2\n";
const TABLE: &str = "model = \"hadeler_kuttler\"\n[grid]\nx = { from = 0, to = 1, cells = 4 }\ny = { from = 0, to = 1, cells = 3 }\n\
                     [[source]]\nrate = 1\n[time]\nsteps = 2\n[output]\nsteps = 2\n";

/// What a small run left, by the names of the files in its folder.
struct Left {
    origin: Origin,
    folder: tempfile::TempDir,
}

/// A run on a chute and one on a table, computed once.
fn left() -> &'static [Left; 2] {
    static LEFT: OnceLock<[Left; 2]> = OnceLock::new();
    LEFT.get_or_init(|| [CHUTE, TABLE].map(compute))
}

fn compute(text: &str) -> Left {
    let folder = tempfile::tempdir().expect("a folder for the seeds");
    let checked = Case::parse(text, "case.toml").and_then(|case| case.check()).expect("the case is in order");
    let origin = origin(checked.plan(), &granflow::Inputs::default()).expect("it names no files");
    let options = Options {
        directory: folder.path().to_owned(),
        threads: 1,
        resume: false,
        command: String::new(),
        notice: |_| (),
    };
    checked.compute(&options, &AtomicBool::new(false), &mut |_| ()).expect("it is computed");
    Left { origin, folder }
}

/// A file that both runs left.
fn seeds(name: &str) -> Vec<Vec<u8>> {
    let read = |left: &Left| std::fs::read(left.folder.path().join(name)).expect("the run left it");
    left().iter().map(read).collect()
}

pub fn checkpoints() -> Vec<Vec<u8>> {
    seeds("checkpoint/state.bin")
}
pub fn frames() -> Vec<Vec<u8>> {
    seeds("checkpoint/frames.bin")
}
pub fn ledgers() -> Vec<Vec<u8>> {
    seeds("mass.csv")
}
pub fn summaries() -> Vec<Vec<u8>> {
    seeds("summary.json")
}
pub fn results() -> Vec<Vec<u8>> {
    seeds("result.nc")
}

/// Shows a reader a file with these bytes.
fn on_disk(name: &str, bytes: &[u8], read: impl FnOnce(&Path)) {
    static FOLDER: OnceLock<tempfile::TempDir> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| tempfile::tempdir().expect("a folder for the inputs"));
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).expect("the folder takes a file");
    read(&path);
}

/// With a checksum that fits, or nothing behind it would ever be read.
pub fn checkpoint(bytes: &[u8]) {
    let body = &bytes[..bytes.len().saturating_sub(4)];
    let sealed = [body, &crc32fast::hash(body).to_le_bytes()].concat();
    for bytes in [bytes, &sealed] {
        on_disk("state.bin", bytes, |path| {
            for left in left() {
                let Ok((mut saved, _)) = Checkpoint::read(path, &left.origin) else { continue };
                drop((saved.take("state_0"), saved.scalar("clock_0")));
            }
        });
    }
}

pub fn stored(bytes: &[u8]) {
    on_disk("frames.bin", bytes, |path| {
        let Ok((mut frames, _)) = Frames::open(path) else { return };
        let mark = frames.mark();
        for frame in 0..frames.times().len().min(3) {
            for field in 0..frames.fields().len().min(3) {
                drop(frames.read(frame, field));
            }
        }
        drop(frames.truncate_to(mark));
    });
}

pub fn ledger(bytes: &[u8]) {
    on_disk("mass.csv", bytes, |path| {
        let Ok(mut ledger) = Ledger::open(path) else { return };
        let mark = ledger.mark();
        drop(ledger.truncate_to(mark));
    });
}

pub fn summary(bytes: &[u8]) {
    on_disk("summary.json", bytes, |path| drop(Summary::read(path)));
}

pub fn result(bytes: &[u8]) {
    on_disk("result.nc", bytes, |path| drop(Story::read(path)));
}
