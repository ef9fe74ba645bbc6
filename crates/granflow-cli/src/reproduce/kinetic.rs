//! The kinetic schemes for the Savage-Hutter equations: the report and the thesis, which share their examples.

use std::path::{Path, PathBuf};

use granflow::output::report::{Figure, Table};

use crate::page::{Chapter, Picture};

mod computed;
mod draw;
mod examples;
mod numbers;
mod papers;

use computed::Computed;
pub use computed::Runs;
use examples::EXAMPLES;
pub use numbers::rows;
pub use papers::{PAPERS, Paper};

/// The page's sections on these papers; pictures go into `folder`.
pub fn chapters<'a>(papers: &[&'static Paper], runs: &'a Runs, folder: &Path) -> Vec<Chapter<'a>> {
    let file = |name: String| -> PathBuf { folder.join(name + ".png") };
    let mut chapters = vec![introduction()];
    for paper in papers {
        chapters.push(Chapter { title: paper.title.into(), ..Chapter::default() });
        for example in &EXAMPLES {
            let mut pictures = Vec::new();
            for printed in paper.figures.iter().filter(|printed| printed.example == example.id) {
                for drawing in printed.drawings {
                    let number = printed.number.replace('.', "_");
                    let path =
                        file(format!("{}_{number}_{}_{}", paper.figure.0, example.name, drawing.name()));
                    let name = format!("{} {}", paper.figure.1, printed.number);
                    let caption = format!(
                        "{}: {}. Lengths in L, heights in H, times in √(L/g).",
                        printed.caption,
                        drawing.caption()
                    );
                    let draw = Box::new(move |path: &Path| drawing.save(example.id, runs, path));
                    pictures.push(Picture { figure: Figure { name, caption, path }, draw });
                }
            }
            if !pictures.is_empty() {
                let title = format!("{}: {}", paper.alias, example.title);
                let text = vec![example.about.into()];
                chapters.push(Chapter { title, text, pictures, ..Chapter::default() });
            }
        }
    }
    chapters.push(all_schemes(runs, &file));
    if runs.failed().next().is_some() {
        chapters.push(failures(runs, &file));
    }
    chapters
}

fn introduction<'a>() -> Chapter<'a> {
    Chapter {
        title: "The kinetic schemes: how to read".into(),
        text: vec![
            "The papers print few numbers: most rows hold their statements (stops, symmetric, unchanged, splits in \
             two) against our runs. Where \"independent run\" stands beside the expected number, it comes from a \
             separate transcription of the printed schemes, not from the paper."
                .into(),
            "Not compared: coordinates read off the printed figures. The papers do not print the domains, the silo's \
             walls and the places x0; each example says what is used here."
                .into(),
            "ε = 0.4, Δx = 0.05, Δt = 0.001 and u = 0 at the start unless an example says otherwise; earth pressure \
             k = 1 + 2 tan² δ; open ends. balanced and balanced_2 run with the same fixed step."
                .into(),
        ],
        ..Chapter::default()
    }
}

fn all_schemes<'a>(runs: &'a Runs, file: &dyn Fn(String) -> PathBuf) -> Chapter<'a> {
    let picture = |example: &examples::Example| {
        let runs = runs.of(example.id);
        let name = format!("All schemes: {}", example.title);
        let caption = "Height at the end by every scheme that came to the end, in H over x in L.".into();
        let path = file(format!("schemes_{}", example.name));
        let draw = Box::new(move |path: &Path| draw::comparison(runs, path));
        Picture { figure: Figure { name, caption, path }, draw }
    };
    Chapter {
        title: "All schemes on all examples".into(),
        text: vec![
            "Mass change: (mass at the end + mass that left - mass at the start) / mass at the start. Smallest h: at \
             any step. A run that failed is measured in its last finite state."
                .into(),
        ],
        tables: EXAMPLES.iter().map(|example| comparison(runs.of(example.id))).collect(),
        pictures: EXAMPLES.iter().map(picture).collect(),
    }
}

fn failures<'a>(runs: &'a Runs, file: &dyn Fn(String) -> PathBuf) -> Chapter<'a> {
    let text = |run: &Computed| {
        let why = run.failure.as_deref().unwrap_or_default();
        format!("{} on \"{}\": {}. The run ends with: {why}.", run.scheme.1, run.example.title, run.stopped())
    };
    let picture = |run: &'a Computed| {
        let name = format!("Failure: {}, {}", run.example.title, run.scheme.1);
        let caption = format!(
            "{}. The height at the first step with h < 0 and in the last finite state.",
            run.stopped()
        );
        let path = file(format!("failure_{}_{}", run.example.name, run.scheme.0));
        let draw = Box::new(move |path: &Path| draw::failure(run, path));
        Picture { figure: Figure { name, caption, path }, draw }
    };
    Chapter {
        title: "Where a scheme fails".into(),
        text: runs.failed().map(text).collect(),
        pictures: runs.failed().map(picture).collect(),
        ..Chapter::default()
    }
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
