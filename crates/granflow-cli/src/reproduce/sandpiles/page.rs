//! The paper's sections of the page.

use std::path::{Path, PathBuf};

use granflow::output::figures::FigureError;
use granflow::output::report::{Figure, Table};

use super::super::{Chapter, Picture};
use super::draw::{self, Layer};
use super::line::{self, Layers};
use super::numbers::orders;
use super::plane::{self, Errors, Pile};
use super::{Runs, SCHEMES, printed};

/// The page's sections on the paper; pictures go into `folder`.
pub fn chapters<'a>(runs: &'a Runs, folder: &Path) -> Vec<Chapter<'a>> {
    let mut chapters =
        vec![introduction(), transient(runs, folder), balance(&runs.line), steady(runs, folder)];
    chapters.push(iterations(&runs.line, folder));
    chapters.push(square(&runs.plane));
    chapters.extend(runs.plane.piles.iter().map(|pile| example(pile, folder)));
    chapters
}

fn picture<'a>(
    folder: &Path,
    (file, name): (String, String),
    caption: String,
    draw: impl Fn(&Path) -> Result<(), FigureError> + Sync + 'a,
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

/// Errors and orders on finer and finer grids, each with the printed one.
fn column(errors: &[f64], printed: &[printed::Entry]) -> Vec<[String; 2]> {
    let ours = orders(errors);
    (errors.iter().zip(printed).enumerate())
        .map(|(k, (error, (published, order)))| {
            let rate = |rate: Option<f64>| rate.map_or_else(|| "–".into(), |rate| format!("{rate:.4}"));
            let ours = rate(k.checked_sub(1).map(|k| ours[k]));
            [format!("{error:.6} ({published})"), format!("{ours} ({})", rate(*order))]
        })
        .collect()
}

fn transient<'a>(runs: &'a Runs, folder: &Path) -> Chapter<'a> {
    let runs = &runs.line;
    let tables = SCHEMES.iter().enumerate().map(|(scheme, (name, _))| {
        let of = |k: usize| -> Vec<f64> { runs.table_1[scheme].iter().map(|errors| errors[k]).collect() };
        let [u, v] = [0, 1].map(|k| column(&of(k), &printed::TABLE_1[scheme][k]));
        let lines = line::TABLE_1.iter().zip(u.into_iter().zip(v));
        let lines = lines.map(|(n, (u, v))| [vec![format!("1/{n}")], u.to_vec(), v.to_vec()].concat());
        let head = ["h", "sup |u - u_ref| (printed)", "E.O.C.", "L1 of v - v_ref (printed)", "E.O.C."];
        table(&format!("Table 1: {name}"), &head, lines.collect())
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

fn square<'a>(runs: &plane::Runs) -> Chapter<'a> {
    let mut tables = Vec::new();
    for (scheme, (name, _)) in SCHEMES.iter().enumerate() {
        let errors = &runs.table[scheme];
        let printed = printed::SQUARE[scheme];
        let of = |value: fn(&Errors) -> f64| -> Vec<[String; 2]> {
            let errors: Vec<f64> = errors.iter().map(value).collect();
            let unprinted = [(f64::NAN, None); 3];
            column(&errors, &unprinted)
        };
        let columns: [Vec<[String; 2]>; 4] = [of(|e| e.u[0]), of(|e| e.u[1]), of(|e| e.v[0]), of(|e| e.v[1])];
        let bare = |[error, order]: &[String; 2]| {
            [error, order].map(|text| text.split(" (").next().unwrap_or_default().to_owned())
        };
        let lines = plane::GRIDS.iter().enumerate().map(|(k, n)| {
            let ours = columns.iter().flat_map(|column| bare(&column[k]));
            let theirs = printed.iter().flat_map(|column| {
                let (error, order) = column[k];
                [format!("{error}"), order.map_or_else(|| "–".into(), |order| format!("{order}"))]
            });
            [format!("1/{n}")].into_iter().chain(ours).chain(theirs).collect()
        });
        let head = [
            "h",
            "sup u",
            "E.O.C.",
            "L1 u",
            "E.O.C.",
            "sup v",
            "E.O.C.",
            "L1 v",
            "E.O.C.",
            "printed 1",
            "E.O.C.",
            "printed 2",
            "E.O.C.",
        ];
        tables.push(table(&format!("Square, complete source: {name}"), &head, lines.collect()));
    }
    Chapter {
        title: "sandpiles: the table of errors in two dimensions".into(),
        text: vec![
            "The paper's last table has lost the headings of its two columns; which variable, which norm, which f and which \
             time they are is not known, and no reading that was tried gives both columns' sizes. Ours: all sides open, \
             f = 0.5 on the whole square, t = 15, nine tenths of the step that eqs. 26, 27 allow, against the exact \
             equilibrium, u at the nodes and v in the cells. Only the orders are held against the printed ones, those of \
             sup |v - v̄| against the first column (1), those of the L1 norm of v - v̄ against the second (1.9 for first order \
             and the adaptive scheme; the printed 1.1 of the second-order scheme is not seen here). sup |u - ū| of first order \
             falls more slowly: on the finest grid the summit is not yet steady at t = 15."
                .into(),
        ],
        tables,
        ..Chapter::default()
    }
}

fn example<'a>(pile: &'a Pile, folder: &Path) -> Chapter<'a> {
    let example = pile.example;
    let off = pile.off();
    let most = pile.v.iter().copied().fold(0.0, f64::max);
    let shown = draw::largest_shown(&pile.v);
    let clipped = if shown < most {
        format!(" v reaches {most:.2}; the colours end at {shown:.2}, which one cell in a hundred exceeds.")
    } else {
        String::new()
    };
    let number = |value: f64| format!("{value:.2e}");
    let line = |name: &str, [sup, l1]: [f64; 2]| vec![name.to_owned(), number(sup), number(l1)];
    let file = |what: &str| (format!("sandpiles_2d_{}_{what}", example.name), format!("Sandpiles, {what}"));
    Chapter {
        title: format!("sandpiles: {}", example.title),
        text: vec![
            example.about.into(),
            format!(
                "Grown by the first-order scheme on {n} × {n} cells to t = {:.1} ({} steps), where max |u_t| = {:.1e} and \
                 max |v_t| = {:.1e}.",
                pile.end.0,
                pile.end.1,
                pile.drift[0],
                pile.drift[1],
                n = plane::CELLS
            ),
        ],
        tables: vec![table(
            "Against the equilibrium that is computed without time steps",
            &["", "sup", "L1"],
            vec![line("u", off.u), line("v", off.v)],
        )],
        pictures: vec![
            picture(
                folder,
                file("pile"),
                format!("The pile in perspective, coloured by the rolling layer.{clipped}"),
                move |path| draw::pile(pile, path),
            ),
            picture(
                folder,
                file("sections"),
                "Both layers along two lines, against x; v in the cells just above the line.".into(),
                move |path| draw::sections(pile, path),
            ),
        ],
    }
}
