//! The sandpiles in `cases/`, computed by the program on coarse grids: what their comments promise comes out.

mod support;

use granflow::Case;
use granflow::output::ledger::Ledger;
use granflow::output::summary::{StopReason, Summary};
use granflow::run::Run;
use granflow::session::Options;
use ndarray::Axis;
use netcdf_reader::NcFile;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use support::{granflow, told};

/// Books close to this share of what was poured and what lay there at the start.
const ROUNDING: f64 = 1e-14;

/// The file of a case that `granflow new` writes.
fn case_file(name: &str) -> String {
    format!("{}/../../cases/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}

/// A finished run of a case.
struct Done {
    folder: tempfile::TempDir,
    summary: serde_json::Value,
    cells: usize,
}

/// Runs a case by the first-order scheme on `cells` along each axis, with further changes.
fn run(name: &str, cells: usize, changes: &[&str]) -> Done {
    let folder = tempfile::tempdir().unwrap();
    let case = case_file(name);
    let mut sets = vec![
        "scheme={name=\"first_order\"}".to_owned(),
        format!("grid.x.cells={cells}"),
        "output.files=[\"netcdf\"]".to_owned(),
    ];
    if name != "sandpile_1d" {
        sets.push(format!("grid.y.cells={cells}"));
    }
    sets.extend(changes.iter().map(|change| (*change).to_owned()));
    let mut arguments = vec!["run", &case, "--out", "out", "--quiet", "--threads", "1"];
    arguments.extend(sets.iter().flat_map(|set| ["--set", set.as_str()]));
    let output = granflow(folder.path(), &arguments);
    assert!(output.status.success(), "{name}: {}", told(&output));
    let text = std::fs::read_to_string(folder.path().join("out/summary.json")).unwrap();
    let done = Done { summary: serde_json::from_str(&text).unwrap(), folder, cells };
    done.books_close(name);
    done
}

impl Done {
    fn number(&self, key: &str) -> f64 {
        self.summary[key].as_f64().unwrap_or_else(|| panic!("no number `{key}` in {}", self.summary))
    }
    fn outflow(&self) -> [f64; 5] {
        ["left", "right", "bottom", "top", "hole"].map(|side| self.number(&format!("mass_out_{side}")))
    }
    /// In the summary and in every line of the ledger: on the table + fallen = at the start + poured.
    fn books_close(&self, name: &str) {
        assert!(self.number("mass_error").abs() <= ROUNDING, "{name}: {}", self.number("mass_error"));
        let ledger = Ledger::open(&self.folder.path().join("out/mass.csv")).unwrap();
        assert!(ledger.entries().len() > 5, "{name}: {} lines", ledger.entries().len());
        for line in ledger.entries() {
            let gone: f64 = line.out.iter().sum();
            let there = self.number("mass_initial") + line.mass_in;
            let error = (line.mass + gone - there).abs();
            assert!(error <= ROUNDING * there, "{name}: {error} of {there} at time {}", line.time);
        }
    }
    /// A layer in the frame `back` from the last.
    fn layer(&self, name: &str, back: usize) -> Vec<f64> {
        let file = NcFile::open(self.folder.path().join("out/result.nc")).unwrap();
        let series = file.read_variable::<f64>(name).unwrap();
        let frame = series.index_axis(Axis(0), series.shape()[0] - 1 - back);
        frame.iter().copied().collect()
    }
    /// The steepest slope of the standing layer along the edges of cells.
    fn steepest(&self) -> f64 {
        let (u, row) = (self.layer("standing_layer", 0), self.cells + 1);
        let pairs = (0..u.len()).flat_map(|k| [(k, k + 1), (k, k + row)]);
        let within = |(a, b): &(usize, usize)| *b < u.len() && (b - a > 1 || b % row > 0);
        let slopes = pairs.filter(within).map(|(a, b)| (u[a] - u[b]).abs() * self.cells as f64);
        slopes.filter(|slope| slope.is_finite()).fold(0.0, f64::max)
    }
    fn steady(&self) -> bool {
        self.summary["stop_reason"] == "steady"
    }
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().filter(|value| value.is_finite()).fold(0.0, f64::max)
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    largest(a.iter().zip(b).map(|(a, b)| (a - b).abs()))
}

#[test]
fn between_two_edges_the_roof_is_exact() {
    let line = run("sandpile_1d", 20, &[]);
    assert!(line.steady());
    let (u, v) = (line.layer("standing_layer", 0), line.layer("rolling_layer", 0));
    let roof: Vec<f64> = (0..=20).map(|i| f64::from(i.min(20 - i)) / 20.0).collect();
    let rolling: Vec<f64> = (0..20).map(|i| 0.5 * (0.5 - (f64::from(i) + 0.5) / 20.0).abs()).collect();
    assert!(difference(&u, &roof) < 1e-7, "{u:?}");
    assert!(difference(&v, &rolling) < 1e-8, "{v:?}");
    assert_eq!(line.number("mass_out_left"), line.number("mass_out_right"));
}

#[test]
fn what_grows_in_time_is_what_is_computed_at_once() {
    let (flat, slope) = ("table.height=0.0", "table.height.formula=0.5*hypot(x-0.5, y-0.5)");
    let tables = [
        ("sandpile", 16, flat),
        ("sandpile", 16, slope),
        ("sandpile_disc", 16, flat),
        ("sandpile_l", 16, flat),
    ];
    for (name, cells, height) in tables.into_iter().chain([("sandpile_walls", 10, flat)]) {
        let grown = run(name, cells, &[height]);
        assert!(grown.steady(), "{name}: {}", grown.summary["stop_reason"]);
        let folder = tempfile::tempdir().unwrap();
        let case = case_file(name);
        let sets = [format!("grid.x.cells={cells}"), format!("grid.y.cells={cells}")];
        let output = granflow(
            folder.path(),
            &[
                "run",
                &case,
                "--out",
                "out",
                "--quiet",
                "--set",
                height,
                "--set",
                &sets[0],
                "--set",
                &sets[1],
                "--set",
                "scheme={name=\"first_order\"}",
                "--set",
                "time={until=\"steady\",method=\"direct\"}",
                "--set",
                "output={files=[\"netcdf\"]}",
            ],
        );
        assert!(output.status.success(), "{name}: {}", told(&output));
        let text = std::fs::read_to_string(folder.path().join("out/summary.json")).unwrap();
        let direct = Done { summary: serde_json::from_str(&text).unwrap(), folder, cells };
        for layer in ["standing_layer", "rolling_layer"] {
            let apart = difference(&grown.layer(layer, 0), &direct.layer(layer, 0));
            // steady to 1e-8 a time, and the slowest part of a pile dies out over some ten times
            assert!(apart < 1e-6, "{name}: {layer} differs by {apart}");
        }
        let sides = ["left", "right", "bottom", "top", "hole"];
        let rates: f64 = sides.iter().map(|side| direct.number(&format!("outflow_rate_{side}"))).sum();
        let poured = direct.number("source_rate_final");
        assert!((rates - poured).abs() < 1e-13 * poured, "{name}: {rates} falls, {poured} is poured");
    }
}

#[test]
fn alike_sides_get_alike() {
    for name in ["sandpile", "sandpile_disc", "sandpile_source"] {
        let [left, right, bottom, top, hole] = run(name, 16, &["time.end=5"]).outflow();
        // Columns and rows are summed in different pieces: rounding of the sums, not of the piles.
        let alike = |side: f64| (side - left).abs() < 1e-14 * left;
        assert!(left > 0.0 && [right, bottom, top].into_iter().all(alike) && hole == 0.0, "{name}");
    }
    let [left, right, bottom, top, _] = run("sandpile_walls", 10, &["time.end=10"]).outflow();
    assert!(left > 0.0 && bottom > left && [right, top] == [0.0; 2], "no sand passes a wall");
}

#[test]
fn once_nothing_is_poured_the_pile_stands_still() {
    let pile = run("sandpile_switched", 20, &[]);
    assert!(pile.steady() && pile.number("stopping_time") > 1.5, "{}", pile.summary);
    assert!(pile.number("rolling_layer_max_final") < 1e-7 && pile.number("source_rate_final") == 0.0);
    assert!(difference(&pile.layer("standing_layer", 0), &pile.layer("standing_layer", 1)) < 1e-8);
    assert!(pile.steepest() <= 1.0 + 1e-12, "{}", pile.steepest());
    let disc = (0..400).filter(|k| {
        let at = |i: usize| (i as f64 + 0.5) / 20.0 - 0.5;
        at(k % 20).hypot(at(k / 20)) <= 0.3
    });
    let poured = 0.5 + 0.25 * disc.count() as f64 / 400.0 + 0.01;
    assert!((pile.number("mass_in") - poured).abs() < 1e-13, "{poured}");
}

#[test]
fn a_silo_empties_down_to_its_funnel() {
    let silo = run("silo_hole", 20, &[]);
    assert!(silo.steady() && silo.number("rolling_layer_max_final") < 1e-8);
    let out = silo.outflow();
    assert_eq!(out[..4], [0.0; 4], "nothing passes the walls of the silo");
    assert!(out[4] > 0.97 * 0.048 && out[4] <= 0.048, "all that rolls but what settles: {}", out[4]);
    // the funnel beside the middle of a side of the hole has slope 1, and nowhere is it steeper
    let u = silo.layer("standing_layer", 0);
    for i in 12..20 {
        let slope = (u[21 * 10 + i + 1] - u[21 * 10 + i]) * 20.0;
        assert!((slope - 1.0).abs() < 1e-9, "{slope} at node {i}");
    }
    assert!(silo.steepest() <= 1.0 + 1e-9);
}

#[test]
fn a_source_that_goes_round_leaves_a_hill_with_a_bowl() {
    let hill = run("sandpile_moving", 24, &[]);
    assert!((hill.number("time") - 4.0 * std::f64::consts::PI).abs() < 1e-12);
    assert!(hill.steepest() <= 1.0 + 1e-9, "{}", hill.steepest());
    let u = hill.layer("standing_layer", 0);
    let at = |x: f64, y: f64| u[(y * 24.0).round() as usize * 25 + (x * 24.0).round() as usize];
    for (x, y) in [(0.75, 0.5), (0.25, 0.5), (0.5, 0.75), (0.5, 0.25)] {
        assert!(at(x, y) > 0.5 * at(0.5, 0.5) && at(x, y) > 0.1, "{} at {x}, {y}", at(x, y));
    }
}

/// Computes a case by the library into `directory`, interrupted after step `stop` if there is one.
fn compute(case: &Case, directory: &Path, resume: bool, stop: Option<u64>) -> granflow::results::Finished {
    let options =
        Options { directory: directory.into(), threads: 1, resume, command: "test".into(), notice: &|_| () };
    let interrupt = AtomicBool::new(false);
    let mut report = |run: &dyn Run| {
        if Some(run.steps()) == stop {
            interrupt.store(true, Ordering::Relaxed);
        }
    };
    case.check().unwrap().compute(&options, &interrupt, &mut report).unwrap()
}

#[test]
fn an_interrupted_pile_goes_on_as_if_it_had_not_been() {
    for (name, stops) in [("sandpile_switched", [37, 150, 151]), ("sandpile_moving", [1, 120, 250])] {
        let changes = ["scheme={name=\"first_order\"}", "grid.x.cells=16", "grid.y.cells=16", "time={end=4}"];
        let path = format!("{}/../../cases/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let case = Case::read_with(Path::new(&path), &changes.map(str::to_owned)).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let [whole, parts] = ["whole", "parts"].map(|name| folder.path().join(name));
        let unbroken = compute(&case, &whole, false, None).summary;
        for (k, stop) in stops.into_iter().enumerate() {
            let part = compute(&case, &parts, k > 0, Some(stop)).summary;
            assert_eq!((part.stop_reason, part.steps), (StopReason::Interrupted, stop), "{name}");
        }
        let resumed = compute(&case, &parts, true, None).summary;
        for file in ["mass.csv", "checkpoint/frames.bin"] {
            let same = std::fs::read(whole.join(file)).unwrap() == std::fs::read(parts.join(file)).unwrap();
            assert!(same, "{name}: {file} differs");
        }
        let figures = |summary: &Summary| {
            let mut figures = serde_json::to_value(summary).unwrap();
            for clock in ["wall_seconds", "stepping_seconds", "cell_updates_per_second"] {
                assert!(figures.as_object_mut().unwrap().remove(clock).is_some());
            }
            figures
        };
        assert_eq!(figures(&resumed), figures(&unbroken), "{name}");
    }
}

/// What decides that a pile is steady, and since when its sources flow, is in the checkpoint: a pile that is taken up at its end
/// takes no step more and says the same of itself.
#[test]
fn a_pile_taken_up_at_its_end_is_at_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("pile.toml");
    let text = r#"
        model = "hadeler_kuttler"
        grid.x = { from = 0.0, to = 1.0, cells = 10 }
        source = [{ rate = 0.5 }, { rate = 0.25, from = 0.5, to = 1.25 }]
        output.files = ["netcdf"]
        "#;
    for time in ["time = { until = \"steady\", end = 100 }", "time = { end = 1.0 }", "time = { end = 0.5 }"] {
        std::fs::write(&file, format!("{time}\n{text}")).unwrap();
        let (case, out) = (Case::read(&file).unwrap(), folder.path().join("out"));
        let figures =
            |summary: Summary| (summary.stop_reason, summary.steps, summary.time.to_bits(), summary.extra);
        let first = figures(compute(&case, &out, false, None).summary);
        let frames = std::fs::read(out.join("checkpoint/frames.bin")).unwrap();
        for _ in 0..2 {
            assert_eq!(figures(compute(&case, &out, true, None).summary), first, "{time}");
            assert!(std::fs::read(out.join("checkpoint/frames.bin")).unwrap() == frames, "{time}");
        }
    }
}
