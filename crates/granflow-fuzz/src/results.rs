//! What `plot` and `--resume` read again: files that a run left, changed since.

use granflow::Case;
use granflow::Inputs;
use granflow::compare::{By, compare};
use granflow::ensemble::Ensemble;
use granflow::output::checkpoint::{Checkpoint, Origin};
use granflow::output::frames::Frames;
use granflow::output::ledger::Ledger;
use granflow::output::lines::Table;
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

const PLANE: &str = "grid.x = { from = 0, to = 1, cells = 6 }\ngrid.y = { from = 0, to = 1, cells = 5 }\n\
                     material.friction.coulomb.mu = 0.3\n\
                     initial.thickness.cap = { height = 1, centre = [0.5, 0.5], radius = 0.3 }\ntime.steps = 3\n";
const MANY: &str = "[ensemble]\nmembers = 3\nexceed.peak_speed = [0.1]\n\
                    vary.\"material.friction.coulomb.mu\" = { uniform = [0.2, 0.4] }\n";

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
    let origin = origin(checked.plan(), &Inputs::default()).expect("it names no files");
    let options = Options {
        directory: folder.path().to_owned(),
        threads: 1,
        resume: false,
        command: String::new(),
        notice: &|_| (),
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
                let Ok((mut saved, ..)) = Checkpoint::read(path, &left.origin) else { continue };
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

pub fn series() -> Vec<Vec<u8>> {
    [
        "name,time,thickness,speed\nroad,0.0,1.5,\nhouse,0.0,,0.25\nroad,0.5,2.5,1e-3\nhouse,0.5,0.25,-0.0\n",
        "name,time,discharge\nweir,0,1\n",
    ]
    .map(|text| text.as_bytes().to_vec())
    .into()
}

pub fn table(bytes: &[u8]) {
    let Ok(table) = Table::parse(Path::new("gauges.csv"), &String::from_utf8_lossy(bytes)) else { return };
    let cells = table.names.len() * table.times.len();
    assert!(table.values.iter().all(|column| column.len() <= cells), "{table:?}");
}

pub fn summary(bytes: &[u8]) {
    on_disk("summary.json", bytes, |path| drop(Summary::read(path)));
}

pub fn result(bytes: &[u8]) {
    on_disk("result.nc", bytes, |path| drop(Story::read(path)));
}

/// An ensemble of three members.
fn many() -> &'static Ensemble {
    static MANY_RUNS: OnceLock<Ensemble> = OnceLock::new();
    MANY_RUNS.get_or_init(|| {
        let case = Case::parse(&[CHUTE, MANY].concat(), "case.toml").expect("the case is in order");
        Ensemble::of(&case).expect("the case is in order")
    })
}

/// A part of one member and one of two.
pub fn parts() -> Vec<Vec<u8>> {
    let part = |members: std::ops::Range<u32>| {
        let mut reduced = many().empty();
        let stop = AtomicBool::new(false);
        members.for_each(|number| reduced.add(many().compute(number, &stop).expect("nobody stops it")));
        many().to_bytes(&reduced)
    };
    vec![part(0..1), part(1..3)]
}

/// With a checksum that fits, as [`checkpoint`].
pub fn part(bytes: &[u8]) {
    let body = &bytes[..bytes.len().saturating_sub(4)];
    let sealed = [body, &crc32fast::hash(body).to_le_bytes()].concat();
    for bytes in [bytes, &sealed] {
        let Ok(reduced) = many().from_bytes(bytes, Path::new("part.bin")) else { continue };
        let mut all = many().empty();
        if all.merge(reduced).is_ok() && all.computed() > 0 {
            drop(many().maps(&all));
        }
        drop(many().to_bytes(&all));
    }
}

/// Beside the result of a run on a plane: the numbers of a comparison are numbers.
pub fn compared(bytes: &[u8]) {
    static RUN: OnceLock<Left> = OnceLock::new();
    let run = RUN.get_or_init(|| compute(PLANE)).folder.path();
    on_disk("mapped", bytes, |path| {
        for by in [By::Footprint, By::Deposit] {
            let options = granflow::compare::Options { by, ..Default::default() };
            let Ok(found) = compare(run, path, &options) else { continue };
            assert!((0.0..=1.0).contains(&found.csi), "{found:?}");
            assert!(found.miss_area >= 0.0 && found.false_area >= 0.0, "{found:?}");
        }
    });
}
