//! Nothing is lost: runs that are killed at any instant go on to the bits of an unbroken run, signals end a run with
//! everything valid, and no strange surrounding makes the program panic.

#![cfg(unix)]

mod support;

use netcdf_reader::NcFile;
use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use support::{PROGRAM, granflow, shell, signal, told};

/// A run of about a second: a case, by its kind and changes of it.
struct Long {
    name: &'static str,
    text: &'static str,
    sets: &'static [&'static str],
}

const CHUTE: &str = r#"
grid.x = { from = -6.0, to = 6.0, cells = 200 }
grid.y = { from = -4.0, to = 4.0, cells = 140 }
material = { slope = "10 deg", friction.coulomb = { angle = "22 deg" } }
initial.thickness.cap = { height = 1.0, radius = 2.0 }
time = { until = "rest", end = 40.0 }
output = { every = 0.25, files = ["netcdf", "csv"], durations = { thickness = 0.1, speed = 0.5 } }
gauge = [{ name = "foot", at = [2.5, 0.1] }, { name = "side", at = [0.5, 1.0] }]
section = [{ name = "weir", line = [[1.5, -4.0], [1.5, 4.0]] }]
"#;

const PILE: &str = r#"
model = "hadeler_kuttler"
grid = { x = { from = 0.0, to = 1.0, cells = 60 }, y = { from = 0.0, to = 1.0, cells = 60 } }
source = [{ rate = 0.5, to = 0.7 }, { rate = 0.3, from = 0.4, to = 1.3 }]
time = { until = "steady", end = 4.0 }
output = { every = 0.05, files = ["netcdf"] }
"#;

const MOVING: &str = r#"
model = "hadeler_kuttler"
grid = { x = { from = 0.0, to = 1.0, cells = 48 }, y = { from = 0.0, to = 1.0, cells = 48 } }
source = [{ rate = { formula = "max(0, 1 - 20*((x - 0.5 - 0.2*cos(t))^2 + (y - 0.5 - 0.2*sin(t))^2))" } }]
time = { end = 4.0 }
output = { every = 0.05, files = ["netcdf"] }
"#;

/// All that acts between the steps and all that looks at them, on the mountain that the program brings along.
const MOUNTAIN: &str = r#"
terrain = { dem = "mountain.asc", crs = "EPSG:31287", cell = 10.0 }
material = { density = 300.0, friction.coulomb.mu = 0.3, forest = 0.02, forest_breaks_at = 40.0 }
release = [
    { polygons = "release.geojson", thickness = 1.0 },
    { cap = { height = 2.0, centre = [250540.0, 350300.0], radius = 30.0 }, at = 6.3 },
]
inflow = [{ line = [[250480.0, 350250.0], [250600.0, 350250.0]], hydrograph = "q.csv" }]
entrainment = { layer = 0.3, law.speed = { coefficient = 0.002 }, lower_bed = true }
gauge = [{ name = "gully", at = [250540.0, 350500.0] }]
section = [{ name = "weir", line = [[250200.0, 350600.0], [250800.0, 350600.0]] }]
time = { until = "rest", end = 40.0 }
output = { every = 0.7, files = ["netcdf"], durations = { thickness = 0.1, speed = 5.0 } }
"#;
const HYDROGRAPH: &str = "time, discharge, speed\n2, 0, 3\n5.5, 40, 3\n17, 0, 1\n";

/// All models, orders and ways of stepping.
const RUNS: &[Long] = &[
    Long { name: "chute", text: CHUTE, sets: &[] },
    Long { name: "chute, second order", text: CHUTE, sets: &["scheme.name=\"energy_stable_2\""] },
    Long {
        name: "balanced, by energy",
        text: CHUTE,
        sets: &["scheme.name=\"balanced\"", "time.stop.kinetic_energy=0.01"],
    },
    Long {
        name: "balanced_2, by speed",
        text: CHUTE,
        sets: &["scheme.name=\"balanced_2\"", "time.rest_speed=0.01"],
    },
    Long {
        name: "verfahren_1",
        text: CHUTE,
        sets: &["scheme={name=\"verfahren_1\",step=0.002}", "time={end=3.0}", "material.slope=\"0 deg\""],
    },
    Long { name: "mountain", text: "", sets: &["terrain.cell=3", "output.every=0.5"] },
    Long {
        name: "mountain, second order",
        text: "",
        sets: &["terrain.cell=3", "output.every=0.5", "scheme.name=\"energy_stable_2\""],
    },
    Long {
        name: "mountain, all between the steps",
        text: MOUNTAIN,
        sets: &["scheme.name=\"energy_stable\"", "terrain.cell=7"],
    },
    Long {
        name: "mountain, all between the steps, second order",
        text: MOUNTAIN,
        sets: &["entrainment.law=\"plough\"", "terrain.cell=8"],
    },
    Long {
        name: "mountain, active and passive",
        text: MOUNTAIN,
        sets: &["material.earth_pressure={active_passive={internal=\"35 deg\"}}"],
    },
    Long { name: "pile", text: PILE, sets: &[] },
    Long { name: "pile, first order", text: PILE, sets: &["scheme.name=\"first_order\""] },
    Long { name: "pile, second order", text: PILE, sets: &["scheme.name=\"second_order\""] },
    Long { name: "pile, moving source", text: MOVING, sets: &[] },
];

impl Long {
    /// Writes the case into a folder; one without a text is the mountain that the program brings along.
    fn write(&self, folder: &Path) {
        assert!(granflow(folder, &["new", "avalanche", "case.toml"]).status.success());
        fs::write(folder.join("q.csv"), HYDROGRAPH).unwrap();
        if !self.text.is_empty() {
            fs::write(folder.join("case.toml"), self.text).unwrap();
        }
    }

    fn command(&self, folder: &Path, out: &str, threads: u64, resume: bool) -> Command {
        let mut command = Command::new(PROGRAM);
        command.current_dir(folder).args(["run", "case.toml", "--quiet", "--out", out]);
        command
            .args(["--threads", &threads.to_string()])
            .args(self.sets.iter().flat_map(|set| ["--set", set]));
        if self.text.is_empty() {
            command.args(["--set", "output.files=[\"netcdf\",\"geotiff\"]"]);
        }
        command.args(resume.then_some("--resume")).stdout(Stdio::null()).stderr(Stdio::piped());
        command
    }
}

/// All that a run leaves and that does not tell the time of day.
struct Left {
    ledger: Vec<u8>,
    /// gauges.csv and sections.csv, where they are.
    series: Vec<Vec<u8>>,
    /// The bytes of every variable of `result.nc`, by name.
    variables: Vec<(String, Vec<u8>)>,
    summary: serde_json::Value,
}

impl Left {
    fn by(out: &Path) -> Left {
        let file = NcFile::open(out.join("result.nc")).unwrap();
        let names = file.variables().unwrap().iter().map(|variable| variable.name.clone());
        let variables =
            names.map(|name| (name.clone(), file.read_variable_raw_bytes(&name).unwrap())).collect();
        let mut summary: serde_json::Value =
            serde_json::from_str(&fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
        for clock in ["wall_seconds", "stepping_seconds", "cell_updates_per_second", "threads"] {
            summary.as_object_mut().unwrap().remove(clock);
        }
        let series = ["gauges.csv", "sections.csv"].map(|name| fs::read(out.join(name)).unwrap_or_default());
        Left { ledger: fs::read(out.join("mass.csv")).unwrap(), series: series.into(), variables, summary }
    }

    fn must_be(&self, other: &Left, what: &str) {
        assert!(self.ledger == other.ledger, "{what}: mass.csv differs");
        assert!(self.series == other.series, "{what}: gauges.csv or sections.csv differs");
        assert_eq!(self.variables.len(), other.variables.len(), "{what}");
        for (one, two) in self.variables.iter().zip(&other.variables) {
            assert!(one == two, "{what}: {} differs", one.0);
        }
        assert_eq!(self.summary, other.summary, "{what}");
    }
}

/// Numbers that look random, the same in every run of the test.
struct Random(u64);

impl Random {
    fn below(&mut self, most: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % most
    }
}

/// Waits for the end of a process, or kills it; was it killed?
fn kill_after(mut child: Child, time: Duration) -> bool {
    let begun = Instant::now();
    while begun.elapsed() < time {
        if child.try_wait().unwrap().is_some() {
            break;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    let over = child.try_wait().unwrap().is_some();
    child.kill().unwrap_or_default();
    let output = child.wait_with_output().unwrap();
    assert!(!over || output.status.success(), "{}", told(&output));
    !over
}

/// Kills a run at a random instant, again and again, a few times before it may end; compares it with the unbroken one.
/// Returns how many kills there were.
fn killed_and_resumed(long: &Long, random: &mut Random, rounds: u64) -> u64 {
    let folder = tempfile::tempdir().unwrap();
    long.write(folder.path());
    let begun = Instant::now();
    let unbroken = long.command(folder.path(), "whole", 2, false).output().unwrap();
    assert!(unbroken.status.success(), "{}: {}", long.name, told(&unbroken));
    let whole = Left::by(&folder.path().join("whole"));
    let duration = begun.elapsed().as_millis() as u64 + 1;
    let mut kills = 0;
    for round in 0..rounds {
        let out = format!("parts_{round}");
        for _ in 0..1 + random.below(3) {
            let resume = folder.path().join(&out).join("checkpoint/state.bin").exists();
            let child = long.command(folder.path(), &out, 1 + random.below(3), resume).spawn().unwrap();
            kills += u64::from(kill_after(child, Duration::from_millis(random.below(duration))));
        }
        let resume = folder.path().join(&out).join("checkpoint/state.bin").exists();
        let end = long.command(folder.path(), &out, 1 + random.below(3), resume).output().unwrap();
        assert!(end.status.success(), "{}, round {round}: {}", long.name, told(&end));
        Left::by(&folder.path().join(&out)).must_be(&whole, &format!("{}, round {round}", long.name));
        fs::remove_dir_all(folder.path().join(&out)).unwrap();
    }
    kills
}

/// A few kills; as many as `GRANFLOW_KILLS` says where that is set (200 take some minutes).
#[test]
fn runs_that_are_killed_at_any_instant_go_on_to_the_same_bits() {
    let asked = std::env::var("GRANFLOW_KILLS").ok().and_then(|count| count.parse().ok());
    let most: u64 = asked.unwrap_or(RUNS.len() as u64);
    let mut random = Random(most);
    let mut kills = 0;
    while kills < most {
        for long in RUNS {
            kills += killed_and_resumed(long, &mut random, if asked.is_some() { 4 } else { 1 });
            if kills >= most {
                break;
            }
        }
    }
    println!("{kills} kills, all resumed to the same bits");
}

/// A run that goes on until it is ended.
fn endless(folder: &Path) -> Long {
    let long = Long {
        name: "endless",
        text: CHUTE,
        sets: &["time={end=1e6}", "output.every=100", "grid.x.cells=400"],
    };
    long.write(folder);
    long
}

/// Waits until a run has begun, and a little longer.
fn wait_for(file: &Path) {
    let begun = Instant::now();
    while !file.exists() {
        assert!(begun.elapsed() < Duration::from_secs(60), "{} does not come", file.display());
        std::thread::sleep(Duration::from_millis(5));
    }
    std::thread::sleep(Duration::from_millis(300));
}

#[test]
fn signals_end_a_run_with_a_checkpoint_and_hangup_only_where_it_is_heard() {
    let folder = tempfile::tempdir().unwrap();
    let long = endless(folder.path());
    for (round, name) in ["INT", "TERM", "HUP"].into_iter().enumerate() {
        let child = long.command(folder.path(), name, 1, false).spawn().unwrap();
        let state = folder.path().join(name).join("checkpoint/state.bin");
        wait_for(&state);
        signal(name, child.id());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130), "{round}: {}", told(&output));
        assert!(told(&output).contains("--resume goes on"), "{}", told(&output));
        assert!(folder.path().join(name).join("result.nc").exists() && state.exists());
    }
    let run = "nohup $GRANFLOW run case.toml -q --threads 1 --set time.end=1e6 --set output.every=100 --out nohup & echo $!";
    let process: u32 =
        String::from_utf8(shell(folder.path(), &format!("{run}\n")).stdout).unwrap().trim().parse().unwrap();
    wait_for(&folder.path().join("nohup/checkpoint/state.bin"));
    signal("HUP", process);
    std::thread::sleep(Duration::from_millis(500));
    signal("TERM", process); // still there
}

#[test]
fn a_limit_on_the_size_of_files_is_a_full_disk() {
    let folder = tempfile::tempdir().unwrap();
    endless(folder.path());
    let output = shell(
        folder.path(),
        "ulimit -f 2000; exec $GRANFLOW run case.toml -q --set time.end=1e6 --set output.every=1e-2 --set time={end=900} --out out",
    );
    assert_eq!(output.status.code(), Some(4), "{}", told(&output));
    assert!(
        told(&output).contains("cannot write") && told(&output).contains("make room"),
        "{}",
        told(&output)
    );
}

#[test]
fn no_strange_surrounding_makes_it_panic() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("case.toml"), CHUTE).unwrap();
    let short = "--set time={steps=3} --set grid.x.cells=20 --set grid.y.cells=20";
    for (line, status) in [
        ("check case.toml >&-", 0),
        ("check case.toml | true", 0),
        (&*format!("run case.toml {short} >&- 2>&-"), 0),
        (&format!("run case.toml {short} <&- 2>/dev/full"), 0),
        (&format!("run case.toml {short} --out case.toml"), 4),
        (&format!("run case.toml {short} --out /dev/null/x"), 4),
    ] {
        let output = shell(folder.path(), &format!("$GRANFLOW {line}"));
        let text = told(&output);
        assert!(!text.contains("panicked"), "{line}: {text}");
        assert_eq!(output.status.code(), Some(status), "{line}: {text}");
    }
    assert_eq!(fs::read_to_string(folder.path().join("case.toml")).unwrap(), CHUTE);

    let strange = PathBuf::from(OsStr::from_bytes(b"a\xff b"));
    fs::create_dir(folder.path().join(&strange)).unwrap();
    let inside = strange.join("c.toml").into_os_string();
    fs::write(folder.path().join(&inside), CHUTE).unwrap();
    let output = Command::new(PROGRAM)
        .current_dir(folder.path())
        .arg("run")
        .arg(&inside)
        .args(short.split(' '))
        .arg("--out")
        .arg(strange.join("out"))
        .output()
        .unwrap();
    assert!(!told(&output).contains("panicked") && output.status.success(), "{}", told(&output));
    assert!(folder.path().join(&strange).join("out/result.nc").exists());
}

/// The largest memory of a process so far, and then of its whole life, in bytes: what Linux says of it.
#[cfg(target_os = "linux")]
fn peak_of(mut child: Child) -> f64 {
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0.0_f64;
    while child.try_wait().unwrap().is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kilo = line.and_then(|rest| rest.trim().strip_suffix("kB")?.trim().parse::<f64>().ok());
        peak = peak.max(1024.0 * kilo.unwrap_or(0.0));
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(child.wait().unwrap().success());
    peak
}

/// What `check` says of the memory is what the process takes, for every model and for files that need much.
#[test]
#[cfg(target_os = "linux")]
fn the_memory_that_check_says_is_the_peak_of_the_run() {
    let plane = &["grid.x.cells=1000", "grid.y.cells=1000", "time={steps=4}"][..];
    for (text, sets) in [
        (CHUTE, [plane, &["output={steps=2,files=[\"netcdf\"]}"]].concat()),
        (PILE, [plane, &["output={steps=2,files=[\"netcdf\",\"csv\"]}"]].concat()),
        ("", vec!["terrain.cell=1", "time={steps=4}", "output={steps=2,files=[\"netcdf\"]}"]),
        ("", vec!["terrain.cell=1", "time={steps=4}", "output={steps=2,files=[\"netcdf\",\"csv\",\"vtk\"]}"]),
    ] {
        let folder = tempfile::tempdir().unwrap();
        Long { name: "large", text, sets: &[] }.write(folder.path());
        let sets: Vec<&str> = sets.iter().flat_map(|set| ["--set", set]).collect();
        let checked = granflow(folder.path(), &[&["check", "case.toml"], &*sets].concat());
        let lines = String::from_utf8(checked.stdout).unwrap();
        let said = lines.lines().find_map(|line| line.strip_prefix("memory")).unwrap().trim();
        let number =
            said.strip_prefix("about ").and_then(|said| said.strip_suffix(" MB at its peak")).unwrap();
        let said = 1e6 * number.parse::<f64>().unwrap();
        let mut command = Command::new(PROGRAM);
        command.current_dir(folder.path()).args(["run", "case.toml", "-q", "--threads", "2"]).args(&sets);
        let peak = peak_of(command.spawn().unwrap());
        // 15 % where nothing else is at work; the pieces that wait to be written depend on the disk.
        assert!((said / peak - 1.0).abs() < 0.2, "{sets:?}: said {said}, took {peak}");
    }
}

#[test]
fn what_cannot_fit_is_refused_before_it_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("case.toml"), CHUTE).unwrap();
    if cfg!(target_os = "linux") {
        let output = granflow(
            folder.path(),
            &["run", "case.toml", "--set", "grid.x.cells=200000", "--set", "grid.y.cells=300000"],
        );
        assert_eq!(output.status.code(), Some(2), "{}", told(&output));
        assert!(told(&output).contains("1.4 TB") && told(&output).contains("are free"), "{}", told(&output));
        assert!(!folder.path().join("case").exists());
    }
}
