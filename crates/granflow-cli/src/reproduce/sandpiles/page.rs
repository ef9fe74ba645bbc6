//! The paper's sections of the page.

use std::path::{Path, PathBuf};

use granflow::output::figures::PictureError;
use granflow::output::report::{Figure, Table};

mod square;

use super::draw::{self, Layer};
use super::line::{self, Layers};
use super::numbers::orders;
use super::{Runs, SCHEMES, printed};
use crate::page::{Chapter, Picture};

/// The page's sections on the paper; pictures go into `folder`.
pub fn chapters<'a>(runs: &'a Runs, folder: &Path) -> Vec<Chapter<'a>> {
    let mut chapters =
        vec![introduction(), transient(runs, folder), balance(&runs.line), steady(runs, folder)];
    chapters.push(iterations(&runs.line, folder));
    chapters.push(square::square(&runs.plane));
    chapters.extend(runs.plane.piles.iter().map(|pile| square::example(pile, folder)));
    chapters
}

fn picture<'a>(
    folder: &Path,
    (file, name): (String, String),
    caption: String,
    draw: impl Fn(&Path) -> Result<(), PictureError> + Sync + 'a,
) -> Picture<'a> {
    let path: PathBuf = folder.join(file + ".png");
    Picture { figure: Figure { name, caption, path }, draw: Box::new(draw) }
}

fn introduction<'a>() -> Chapter<'a> {
    Chapter {
        title: "A. Aggarwal, G. D. Veerappa Gowda and K. Sudarshan Kumar, A well-balanced second-order finite volume \
                approximation for a coupled system of granular flow, arXiv 2310.13971 (2023)"
            .into(),
        text: vec![
            "u: standing layer (at the nodes), v: rolling layer (in the cells), in the paper's scaling, in which sand lies at \
             slopes up to 1. All begin with an empty table. The paper as we have it has lost its formulas and some numbers: \
             what is used in their place is said with each example."
                .into(),
            "Our flux carries the source within half a cell of a face, not its sum B over the table; the two are equal but \
             for rounding."
                .into(),
        ],
        ..Chapter::default()
    }
}

fn table(title: &str, head: &[&str], lines: Vec<Vec<String>>) -> Table {
    Table { title: title.into(), head: head.iter().map(|text| (*text).to_owned()).collect(), lines }
}

/// Errors on finer and finer grids and their orders.
fn ours(errors: &[f64]) -> Vec<[String; 2]> {
    let orders = orders(errors);
    let order = |k: usize| k.checked_sub(1).map(|k| orders[k]);
    errors.iter().enumerate().map(|(k, error)| [format!("{error:.6}"), rate(order(k))]).collect()
}

/// A printed error and its order.
fn theirs((error, order): printed::Entry) -> [String; 2] {
    [error.to_string(), rate(order)]
}

fn rate(order: Option<f64>) -> String {
    order.map_or_else(|| "–".into(), |order| format!("{order:.4}"))
}

fn transient<'a>(runs: &'a Runs, folder: &Path) -> Chapter<'a> {
    let runs = &runs.line;
    let tables = SCHEMES.iter().enumerate().map(|(scheme, (name, _))| {
        let of = |k: usize| -> Vec<f64> { runs.table_1[scheme].iter().map(|errors| errors[k]).collect() };
        let columns = [0, 1].map(|k| ours(&of(k)));
        let line = |k: usize| {
            let both = (0..2).flat_map(|column| {
                let theirs = theirs(printed::TABLE_1[scheme][column][k]);
                let ours = &columns[column][k];
                [0, 1].map(|part| format!("{} ({})", ours[part], theirs[part]))
            });
            [format!("1/{}", line::TABLE_1[k])].into_iter().chain(both).collect()
        };
        let lines: Vec<_> = (0..line::TABLE_1.len()).map(line).collect();
        let head = ["h", "sup |u - u_ref| (printed)", "E.O.C.", "L1 of v - v_ref (printed)", "E.O.C."];
        table(&format!("Table 1: {name}"), &head, lines)
    });
    let pictures = Layer::BOTH.map(|layer| {
        let letter = layer.letter();
        let caption = format!(
            "{letter} at t = {} with λ = 0.45, h = 1/{}, and the reference, h = 1/{}.",
            line::TRANSIENT,
            line::FIGURE_3,
            line::REFERENCE
        );
        let subtitle = format!("t = {}, λ = 0.45, h = 1/{}", line::TRANSIENT, line::FIGURE_3);
        picture(folder, (format!("sandpiles_3_{letter}"), "Sandpiles Fig. 3".into()), caption, move |path| {
            let title = ("While the pile grows", subtitle.as_str());
            draw::schemes(title, ("reference", &runs.reference), &runs.figure_3, layer, path)
        })
    });
    Chapter {
        title: "sandpiles: example 1, while the pile grows".into(),
        text: vec![
            "[0, 1] open at both ends, f = 0.5, t = 1.2, λ = Δt/h = 0.1 (printed numbers lost; these fit Table 1). The \
             reference is ours by the second-order scheme with h = 1/10240 and λ = 0.45; λ = 0.1 there changes no printed \
             digit. u is compared at the nodes, v with the mean of the reference over each cell. The adaptive scheme's \
             exponent in Θ = E²/(E² + h^m) is m = 3 here, chosen because it fits this table."
                .into(),
            "Fig. 3 repeats it with λ = 0.45. As in the paper the first-order scheme oscillates there, in v, and the other two do \
             not: its v swings about the reference, by up to a tenth beside the summit. The swings are the same on both sides \
             of the summit, so that they are the scheme's, not rounding."
                .into(),
        ],
        tables: tables.collect(),
        pictures: pictures.into(),
    }
}

fn balance<'a>(runs: &line::Runs) -> Chapter<'a> {
    let lines = SCHEMES.iter().enumerate().flat_map(|(scheme, (name, _))| {
        line::TABLE_2.iter().enumerate().map(move |(k, n)| {
            let [u, v] = runs.table_2[scheme][k];
            let [printed_u, printed_v] = printed::TABLE_2[scheme].map(|column| column[k]);
            vec![
                (*name).to_owned(),
                format!("1/{n}"),
                format!("{u:.4e} ({printed_u:.4e})"),
                format!("{v:.4e} ({printed_v:.4e})"),
            ]
        })
    });
    let head = ["Scheme", "h", "sup |u - ū| (printed)", "L1 of v - v̄ (printed)"];
    Chapter {
        title: "sandpiles: example 2, one step from the steady state".into(),
        text: vec![
            "λ = 0.45 (printed number lost; f h² (2λ - λ²) is the exact v of the second-order scheme and gives all printed \
             digits). First order and the adaptive scheme leave the steady state as it is, but for rounding."
                .into(),
        ],
        tables: vec![table("Table 2", &head, lines.collect())],
        ..Chapter::default()
    }
}

fn steady<'a>(runs: &'a Runs, folder: &Path) -> Chapter<'a> {
    let runs = &runs.line;
    let (n, end) = line::FIGURE_4;
    let pictures = Layer::BOTH.map(|layer| {
        let letter = layer.letter();
        let caption = format!("{letter} at t = {end}, λ = 0.45, h = 1/{n}, and the exact steady state.");
        let file = (format!("sandpiles_4_{letter}"), "Sandpiles Fig. 4".into());
        picture(folder, file, caption, move |path| {
            let title = format!("t = {end}, λ = 0.45, h = 1/{n}");
            let title = ("The grown pile", title.as_str());
            draw::schemes(title, ("exact", &Layers::steady(1000)), &runs.figure_4, layer, path)
        })
    });
    Chapter {
        title: "sandpiles: example 3, the grown pile".into(),
        text: vec![
            "u = min(x, 1 - x), v = 0.5 |x - 1/2| is the steady state. The end t = 20 and h = 1/50 are ours, the printed \
             numbers are lost. As in the paper the second-order scheme reaches it in u, not in v at the summit."
                .into(),
        ],
        pictures: pictures.into(),
        ..Chapter::default()
    }
}

fn iterations<'a>(runs: &'a line::Runs, folder: &Path) -> Chapter<'a> {
    let schemes = line::history_schemes();
    let step = |step: Option<usize>| step.map_or_else(|| "never".into(), |step| step.to_string());
    let tables = line::HISTORIES.iter().zip(&runs.histories).map(|(n, histories)| {
        let lines = schemes.iter().zip(histories).map(|((name, _), history)| {
            vec![
                name.clone(),
                step(history.first_u(1e-3)),
                step(history.lasting_v(1e-4)),
                step(history.lasting_v(1e-5)),
                format!("{:.3}", history.rise()),
                format!("{:.1e}", history.v.last().copied().unwrap_or(f64::NAN)),
            ]
        });
        let head = [
            "Scheme",
            "steps to sup |u - ū| < 1e-3",
            "steps to L1 of v - v̄ < 1e-4 for good",
            "the same for 1e-5",
            "largest rise of that error again (ratio)",
            "that error at t = 60",
        ];
        table(&format!("h = 1/{n}"), &head, lines.collect())
    });
    let pictures = Layer::BOTH.map(|layer| {
        let letter = layer.letter();
        let caption = format!("Error of {letter} against the number of steps, logarithmic.");
        let file = (format!("sandpiles_5_{letter}"), "Sandpiles Fig. 5".into());
        picture(folder, file, caption, move |path| draw::errors(runs, &[0, 1, 2, 4, 6], layer, path))
    });
    Chapter {
        title: "sandpiles: example 4, error against the number of steps".into(),
        text: vec![
            "λ = 0.45, h = 1/50 in the figure (printed numbers lost). The paper's finding is that the adaptive scheme needs fewer \
             steps than first order; with the exponent of Θ between 2.25 and 2.5 it does so in u and in v, and the error of v \
             never rises again once below 1e-3. With m = 3, which fits Table 1, u is reached soonest, but v follows the \
             second-order scheme towards its own wrong steady state and leaves it late, with h = 1/100 not before t = 60. \
             m = 2 is the default."
                .into(),
        ],
        tables: tables.collect(),
        pictures: pictures.into(),
    }
}
