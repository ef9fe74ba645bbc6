//! What became of the files of a run while nobody looked: lost, cut, altered, another run's. `--resume` names the file and what
//! helps, or makes it again.

use super::*;
use std::collections::BTreeMap;
use std::sync::Mutex;

/// The files of a folder by their names, without the lock.
type Contents = BTreeMap<String, Vec<u8>>;

fn contents(folder: &Path) -> Contents {
    let mut all = Contents::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(&next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if !path.ends_with("lock") {
                let name = path.strip_prefix(folder).unwrap().to_str().unwrap().to_owned();
                all.insert(name, fs::read(path).unwrap());
            }
        }
    }
    all
}

fn put_back(folder: &Path, all: &Contents) {
    let _ = fs::remove_dir_all(folder);
    for (name, bytes) in all {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
}

/// A list of files without its first entry, which is a list as well.
fn entry_less(list: &[u8]) -> Option<Vec<u8>> {
    let text = std::str::from_utf8(list).ok()?;
    let first = text.find(r#"{"name":"#)?;
    let second = first + text[first..].find("},{")? + 2;
    Some([&text[..first], &text[second..]].concat().into_bytes())
}

/// What may become of a file; `other` is the file of that name of another run. No bytes: it is gone.
fn damages(sound: &[u8], other: Option<&Vec<u8>>) -> Vec<(&'static str, Option<Vec<u8>>)> {
    let flipped = |at: usize| {
        let mut bytes = sound.to_vec();
        bytes[at] ^= 1;
        Some(bytes)
    };
    let last = sound.len() - 1;
    let mut all = vec![
        ("first bit", flipped(0)),
        ("a bit within", flipped(last / 2)),
        ("a bit at two thirds", flipped(2 * last / 3)),
        ("last bit", flipped(last)),
        ("half", Some(sound[..sound.len() / 2].to_vec())),
        ("nothing in it", Some(Vec::new())),
        ("gone", None),
        ("more", Some([sound, b"more"].concat())),
        ("a list of nothing", Some(b"[]".to_vec())),
    ];
    all.extend(entry_less(sound).map(|less| ("an entry less", Some(less))));
    all.extend(other.filter(|other| *other != sound).map(|other| ("another run's", Some(other.clone()))));
    all
}

/// A run of a folder, and of another mass in a folder beside.
struct Pair {
    own: Case,
    folder: tempfile::TempDir,
    /// What the run left, and what the other one did.
    sound: Contents,
    others: Contents,
    /// What the run leaves at its end.
    whole: Contents,
}

impl Pair {
    /// Runs until `stop` says so, with everything that grows beside the frames.
    fn of(stop: fn(&dyn Run) -> bool) -> Pair {
        let folder = tempfile::tempdir().unwrap();
        slope(folder.path(), r#"["netcdf", "csv", "geotiff"]"#);
        let case = |height: &str| {
            let changes = [
                r#"gauge=[{ name = "foot", at = [1075.0, 2110.0] }]"#,
                r#"section=[{ name = "toe", line = [[1000.0, 2110.0], [1150.0, 2110.0]] }]"#,
                "time.end=9.3",
                height,
            ];
            Case::read_with(folder.path().join("case.toml"), &changes.map(str::to_owned)).unwrap()
        };
        let [own, other] = [case("release.0.cap.height=2.0"), case("release.0.cap.height=2.1")];
        let left = |case: &Case, name: &str| {
            let out = folder.path().join(name);
            begin(case, &out, false, &mut |run| stop(run)).unwrap().close().unwrap();
            contents(&out)
        };
        let (sound, others) = (left(&own, "out"), left(&other, "beside"));
        begin(&own, &folder.path().join("whole"), false, &mut |_| false).unwrap().close().unwrap();
        let whole = contents(&folder.path().join("whole"));
        Pair { own, folder, sound, others, whole }
    }

    fn resumed(&self, notice: fn(&str)) -> Result<(), String> {
        let options = Options {
            directory: self.folder.path().join("out"),
            threads: 1,
            resume: true,
            command: "test".to_owned(),
            notice: &notice,
        };
        let done = self.own.check().unwrap().compute(&options, &AtomicBool::new(false), &mut |_| ());
        done.map_err(|error| error.to_string())?.close().map(drop).map_err(|error| error.to_string())
    }

    /// Damages each file in each way, and resumes: it is refused by the file's name, with what helps, and nothing else is
    /// touched; or what is left at the end is what an undisturbed run leaves, and `said` tells that it was made again. Returns how
    /// many were refused.
    fn damaged(&self, notice: fn(&str), said: impl Fn(&str) -> bool) -> usize {
        let out = self.folder.path().join("out");
        let mut refused = 0;
        for (name, bytes) in &self.sound {
            for (what, damaged) in damages(bytes, self.others.get(name)) {
                put_back(&out, &self.sound);
                match &damaged {
                    Some(bytes) => fs::write(out.join(name), bytes).unwrap(),
                    None => fs::remove_file(out.join(name)).unwrap(),
                }
                let before = contents(&out);
                match self.resumed(notice) {
                    Ok(()) => {
                        self.is_whole(&contents(&out), &format!("{name}, {what}"));
                        assert!(said(name), "{name}, {what}");
                    }
                    Err(message) => {
                        refused += 1;
                        assert!(message.contains(name), "{name}, {what}: {message}");
                        assert!(message.contains("without --resume"), "{name}, {what}: {message}");
                        assert!(contents(&out) == before, "{name}, {what}: the folder was touched");
                    }
                }
            }
        }
        put_back(&out, &self.sound);
        refused
    }

    fn is_whole(&self, now: &Contents, what: &str) {
        let left = |all: &Contents| -> Vec<String> {
            all.keys()
                .filter(|name| {
                    !what.starts_with("checkpoint/before") || !name.starts_with("checkpoint/before")
                })
                .cloned()
                .collect()
        };
        assert_eq!(left(now), left(&self.whole), "{what}");
        for (name, bytes) in &self.whole {
            // These tell the clock, or the commands.
            if [
                "summary.json",
                "checkpoint/state.bin",
                "checkpoint/before_end.bin",
                "checkpoint/files.json",
                "result.nc",
            ]
            .contains(&name.as_str())
            {
                continue;
            }
            assert!(now[name] == *bytes, "{what}: {name} differs");
        }
    }
}

#[test]
fn a_damaged_file_of_an_interrupted_run_is_named_or_made_again() {
    let pair = Pair::of(|run| run.time() > 6.0);
    assert!(pair.sound.contains_key("checkpoint/frames.bin"));
    let refused = pair.damaged(|_| (), |_| true);
    // The store of frames, the checkpoint, the ledger and two tables, in most ways.
    assert!(refused >= 30, "{refused}");
    pair.resumed(|_| ()).unwrap();
    pair.is_whole(&contents(&pair.folder.path().join("out")), "put back");
    fs::write(pair.folder.path().join("out/checkpoint/state.bin"), "x").unwrap();
    begin(&pair.own, &pair.folder.path().join("out"), false, &mut |_| false).unwrap().close().unwrap();
    let mut now = contents(&pair.folder.path().join("out"));
    now.retain(|name, _| !name.starts_with("previous/"));
    pair.is_whole(&now, "anew");
}

#[test]
fn a_damaged_file_of_a_finished_run_is_named_or_made_again() {
    let pair = Pair::of(|_| false);
    // What was said, once.
    static SAID: Mutex<String> = Mutex::new(String::new());
    let refused = pair.damaged(
        |text| SAID.lock().unwrap().push_str(text),
        |name| {
            let said = std::mem::take(&mut *SAID.lock().unwrap());
            // A list that can be read says that another file is not what it was; what cannot be made again is said too.
            let list = name == "checkpoint/files.json" && said.contains("made again");
            let before = name == "checkpoint/before_end.bin";
            (said.contains(name) || list) && before == said.contains("all files but the checkpoint")
        },
    );
    assert!(refused >= 20, "{refused}");
    let over = pair.resumed(|_| ()).unwrap_err();
    assert!(over.contains("are whole"), "{over}");
}
