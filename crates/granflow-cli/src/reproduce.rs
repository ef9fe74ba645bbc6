//! `granflow reproduce`: the tables and figures of the papers, ours beside theirs.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use granflow::case::nearest;
use granflow::output::figures::FigureError;
use granflow::output::report::{self, Figure, Section, Table};
use granflow::output::tables::{self, Row};

use crate::failure::{Failure, print};

mod computed;
mod draw;
mod examples;
mod numbers;
mod papers;

use computed::{Computed, Runs};
use examples::EXAMPLES;
use papers::{Drawing, PAPERS, Paper};

/// Computes the tables and figures of a paper, or of all.
pub fn reproduce(paper: Option<&str>, out: &Path) -> Result<(), Failure> {
    let papers: Vec<&Paper> = match paper {
        None => PAPERS.iter().collect(),
        Some(name) => vec![find(name)?],
    };
    let runs = Runs::compute()?;
    let rows: Vec<Row> = papers.iter().flat_map(|paper| numbers::rows(paper, &runs)).collect();
    let pictures = pictures(&papers, &runs, &out.join("figures"));
    parallel(pictures.len(), |k| pictures[k].save(&runs))
        .into_iter()
        .collect::<Result<(), FigureError>>()
        .map_err(|error| Failure::File(error.to_string()))?;
    let written = |result: Result<(), granflow::output::Error>| {
        result.map_err(|error| Failure::File(error.to_string()))
    };
    written(tables::write(&out.join("tables.json"), &rows))?;
    let index = out.join("index.html");
    let sections = sections(&papers, &runs, &pictures);
    written(report::write_index(&index, "The papers, reproduced", &rows, &sections))?;
    print(&short_table(&rows, pictures.len(), &index))
}

fn find(name: &str) -> Result<&'static Paper, Failure> {
    let known = || PAPERS.iter().flat_map(|paper| [paper.name, paper.alias]);
    PAPERS.iter().find(|paper| [paper.name, paper.alias].contains(&name)).ok_or_else(|| {
        let near = nearest(name, known()).map(|near| format!("did you mean `{near}`? ")).unwrap_or_default();
        let list: Vec<String> =
            PAPERS.iter().map(|paper| format!("{} (or {})", paper.name, paper.alias)).collect();
        Failure::usage(
            format!("there is no paper `{name}`"),
            format!("{near}allowed: {}; none for both", list.join(", ")),
        )
    })
}

/// Does numbered pieces of work on all cores; the results are in order.
fn parallel<T: Send>(count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZeroUsize::get);
    let worker = || {
        let mut done = Vec::new();
        loop {
            let k = next.fetch_add(1, Ordering::Relaxed);
            if k >= count {
                return done;
            }
            done.push((k, work(k)));
        }
    };
    let mut all: Vec<(usize, T)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..cores.min(count)).map(|_| scope.spawn(worker)).collect();
        let results = workers.into_iter().map(std::thread::ScopedJoinHandle::join);
        results.flat_map(|done| done.unwrap_or_else(|panic| std::panic::resume_unwind(panic))).collect()
    });
    all.sort_by_key(|(k, _)| *k);
    all.into_iter().map(|(_, result)| result).collect()
}

/// What a picture belongs to.
enum Part {
    /// A figure of a paper: which paper, which of the examples, what is drawn.
    Printed(&'static str, examples::Id, Drawing),
    /// All schemes on an example.
    Comparison(examples::Id),
    /// A run that broke off.
    Broken(examples::Id, usize),
}

/// A picture to be drawn, and where.
struct Picture {
    part: Part,
    figure: Figure,
}

impl Picture {
    fn save(&self, runs: &Runs) -> Result<(), FigureError> {
        let path = &self.figure.path;
        match self.part {
            Part::Printed(_, example, drawing) => drawing.save(example, runs, path),
            Part::Comparison(example) => draw::comparison(runs.of(example), path),
            Part::Broken(example, scheme) => draw::failure(&runs.of(example)[scheme], path),
        }
    }
}

fn pictures(papers: &[&'static Paper], runs: &Runs, folder: &Path) -> Vec<Picture> {
    let file = |name: String| -> PathBuf { folder.join(name + ".png") };
    let mut all = Vec::new();
    for paper in papers {
        for printed in paper.figures {
            for drawing in printed.drawings {
                let example = &EXAMPLES[printed.example as usize];
                let number = printed.number.replace('.', "_");
                let path = file(format!("{}_{number}_{}_{}", paper.figure.0, example.name, drawing.name()));
                let name = format!("{} {}", paper.figure.1, printed.number);
                let caption = format!(
                    "{}: {}. Lengths in L, heights in H, times in √(L/g).",
                    printed.caption,
                    drawing.caption()
                );
                let part = Part::Printed(paper.alias, printed.example, *drawing);
                all.push(Picture { part, figure: Figure { name, caption, path } });
            }
        }
    }
    for example in &EXAMPLES {
        let name = format!("All schemes: {}", example.title);
        let caption = "Height at the end by every scheme that came to the end, in H over x in L.".into();
        let path = file(format!("schemes_{}", example.name));
        all.push(Picture { part: Part::Comparison(example.id), figure: Figure { name, caption, path } });
        for (scheme, run) in runs.of(example.id).iter().enumerate().filter(|(_, run)| run.failure.is_some()) {
            let name = format!("Failure: {}, {}", example.title, run.scheme.1);
            let caption = format!(
                "{}. The height at the first step with h < 0 and in the last finite state.",
                run.stopped()
            );
            let path = file(format!("failure_{}_{}", example.name, run.scheme.0));
            all.push(Picture {
                part: Part::Broken(example.id, scheme),
                figure: Figure { name, caption, path },
            });
        }
    }
    all
}

fn sections(papers: &[&'static Paper], runs: &Runs, pictures: &[Picture]) -> Vec<Section> {
    let figures = |wanted: &dyn Fn(&Part) -> bool| -> Vec<Figure> {
        pictures
            .iter()
            .filter(|picture| wanted(&picture.part))
            .map(|picture| picture.figure.clone())
            .collect()
    };
    let mut sections = vec![Section {
        title: "How to read this page".into(),
        text: vec![
            "The papers print few numbers: most rows hold their statements (stops, symmetric, unchanged, splits in \
             two) against our runs. Rows marked \"independent run\" hold them against a separate transcription of the \
             printed schemes, not against a printed number."
                .into(),
            "Not compared: coordinates read off the printed figures. The papers do not print the domains, the silo's \
             walls and the places x0; each example says what is used here."
                .into(),
            "ε = 0.4, Δx = 0.05, Δt = 0.001 and u = 0 at the start unless an example says otherwise; earth pressure \
             k = 1 + 2 tan² δ; open ends. balanced and balanced_2 run with the same fixed step."
                .into(),
        ],
        ..Section::default()
    }];
    for paper in papers {
        sections.push(Section { title: paper.title.into(), ..Section::default() });
        for example in &EXAMPLES {
            let figures = figures(
                &|part| matches!(part, Part::Printed(alias, id, _) if *alias == paper.alias && *id == example.id),
            );
            if !figures.is_empty() {
                let title = format!("{}: {}", paper.alias, example.title);
                sections.push(Section {
                    title,
                    text: vec![example.about.into()],
                    figures,
                    ..Section::default()
                });
            }
        }
    }
    sections.push(Section {
        title: "All schemes on all examples".into(),
        text: vec![
            "Mass change: (mass at the end + mass that left - mass at the start) / mass at the start. Smallest h: at \
             any step. A run that failed is measured in its last finite state."
                .into(),
        ],
        tables: EXAMPLES.iter().map(|example| comparison(runs.of(example.id))).collect(),
        figures: figures(&|part| matches!(part, Part::Comparison(_))),
    });
    let failed: Vec<String> = runs
        .failed()
        .map(|run| {
            let why = run.failure.as_deref().unwrap_or_default();
            format!(
                "{} on \"{}\": {}. The run ends with: {why}.",
                run.scheme.1,
                run.example.title,
                run.stopped()
            )
        })
        .collect();
    if !failed.is_empty() {
        let figures = figures(&|part| matches!(part, Part::Broken(..)));
        sections.push(Section {
            title: "Where a scheme fails".into(),
            text: failed,
            figures,
            ..Section::default()
        });
    }
    sections
}

/// All schemes on an example.
fn comparison(runs: &[Computed]) -> Table {
    let head = [
        "Scheme",
        "Mass change",
        "Smallest h",
        "max |u| at the end",
        "Total variation of h",
        "L1(h)",
        "Stopped",
    ];
    let line = |run: &Computed| {
        vec![
            run.scheme.1.to_owned(),
            format!("{:.2e}", run.mass_change),
            format!("{:.6}", run.lowest),
            format!("{:.3e}", run.end().speed()),
            format!("{:.5}", run.end().variation()),
            run.l1().map_or_else(|| "–".into(), |l1| format!("{l1:.3e}")),
            run.stopped(),
        ]
    };
    Table {
        title: runs[0].example.title.into(),
        head: head.map(str::to_owned).to_vec(),
        lines: runs.iter().map(line).collect(),
    }
}

/// Passed and failed rows by name, for the terminal.
fn short_table(rows: &[Row], figures: usize, index: &Path) -> String {
    let mut names: Vec<&str> = rows.iter().map(|row| row.name.as_str()).collect();
    names.dedup();
    let count = |name: &str, pass| rows.iter().filter(|row| row.name == name && row.pass() == pass).count();
    let width = names.iter().map(|name| name.chars().count()).max().unwrap_or(0);
    let lines = names
        .iter()
        .map(|name| format!("{name:width$}  {:6}  {:6}\n", count(name, true), count(name, false)));
    let table: String = [format!("{:width$}  passed  failed\n", "")].into_iter().chain(lines).collect();
    let failing: String = (rows.iter().filter(|row| !row.pass()))
        .map(|row| {
            format!("FAIL {}, {}: {:?}, computed {}\n", row.name, row.quantity, row.expected, row.computed)
        })
        .collect();
    let fail = rows.iter().filter(|row| !row.pass()).count();
    format!("{table}{failing}{} of {} rows fail; {figures} figures: {}\n", fail, rows.len(), index.display())
}
