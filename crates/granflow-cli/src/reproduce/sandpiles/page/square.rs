//! The page's sections on the square.

use std::path::Path;

use super::super::plane::{self, Errors, Pile};
use super::super::{SCHEMES, draw, printed};
use super::{ours, picture, table, theirs};
use crate::page::Chapter;

/// The table of errors on the square.
pub fn square<'a>(runs: &plane::Runs) -> Chapter<'a> {
    let mut tables = Vec::new();
    for (scheme, (name, _)) in SCHEMES.iter().enumerate() {
        let errors = &runs.table[scheme];
        let values: [fn(&Errors) -> f64; 4] = [|e| e.u[0], |e| e.u[1], |e| e.v[0], |e| e.v[1]];
        let columns = values.map(|value| ours(&errors.iter().map(value).collect::<Vec<_>>()));
        let lines = plane::GRIDS.iter().enumerate().map(|(k, n)| {
            let ours = columns.iter().flat_map(|column| column[k].clone());
            let theirs = printed::SQUARE[scheme].iter().flat_map(|column| theirs(column[k]));
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
             falls more slowly: on the finer grids the summit is not yet steady at t = 15 (it ends a third of h low)."
                .into(),
        ],
        tables,
        ..Chapter::default()
    }
}

/// A pile.
pub fn example<'a>(pile: &'a Pile, folder: &Path) -> Chapter<'a> {
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
