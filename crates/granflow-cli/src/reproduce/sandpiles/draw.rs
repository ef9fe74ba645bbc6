//! The pictures, in the paper's scaling.

use std::path::Path;

use granflow::output::figures::{
    Axis, Colours, Curve, History as Panels, HistoryPanel, Paint, PictureError, Profiles, Save, Style,
    Surface, line_colour,
};

use super::SCHEMES;
use super::line::{self, Layers};
use super::plane::{CELLS, Pile};

const PLACE: Axis = Axis::new("x", "");
const DARK: Option<[u8; 3]> = Some([34, 34, 34]);

/// One of the two layers.
#[derive(Debug, Clone, Copy)]
pub enum Layer {
    /// u.
    Standing,
    /// v.
    Rolling,
}

impl Layer {
    /// Both.
    pub const BOTH: [Self; 2] = [Self::Standing, Self::Rolling];

    /// u or v.
    pub const fn letter(self) -> &'static str {
        match self {
            Self::Standing => "u",
            Self::Rolling => "v",
        }
    }

    fn axis(self) -> Axis<'static> {
        match self {
            Self::Standing => Axis::new("standing layer u", ""),
            Self::Rolling => Axis::new("rolling layer v", ""),
        }
    }

    fn of(self, layers: &Layers) -> &[f64] {
        match self {
            Self::Standing => &layers.u,
            Self::Rolling => &layers.v,
        }
    }

    /// Where its values lie on n cells.
    fn places(self, n: usize) -> Vec<f64> {
        match self {
            Self::Standing => line::nodes(n),
            Self::Rolling => line::centres(n),
        }
    }
}

/// What the three schemes give, against a line.
pub fn schemes(
    (title, subtitle): (&str, &str),
    (name, line): (&str, &Layers),
    runs: &[Layers; 3],
    layer: Layer,
    path: &Path,
) -> Result<(), PictureError> {
    let fine = layer.places(line.count());
    let coarse = layer.places(runs[0].count());
    let mut curves = vec![Curve { name, x: &fine, y: layer.of(line), style: Style::Solid, colour: DARK }];
    for (k, style) in [(1, Style::Dashed), (0, Style::Points), (2, Style::Dotted)] {
        let y = layer.of(&runs[k]);
        curves.push(Curve { name: SCHEMES[k].0, x: &coarse, y, style, colour: Some(line_colour(k)) });
    }
    Profiles { title, subtitle, x: PLACE, y: layer.axis(), curves: &curves, ..Default::default() }.save(path)
}

/// Error against step (Fig. 5): the schemes numbered `drawn`.
pub fn errors(runs: &line::Runs, drawn: &[usize], layer: Layer, path: &Path) -> Result<(), PictureError> {
    let names = line::history_schemes();
    let of = |k: usize| match layer {
        Layer::Standing => &runs.histories[0][k].u,
        Layer::Rolling => &runs.histories[0][k].v,
    };
    let steps: Vec<f64> = (1..=of(0).len()).map(|step| step as f64).collect();
    let curves: Vec<Curve> = drawn
        .iter()
        .map(|&k| Curve { name: &names[k].0, x: &steps, y: of(k), ..Default::default() })
        .collect();
    let y = match layer {
        Layer::Standing => Axis::new("sup |u − ū|", ""),
        Layer::Rolling => Axis::new("L1 norm of v − v̄", ""),
    };
    Profiles {
        title: "Error against the steady state",
        subtitle: &format!("N = {}, λ = 0.45, to t = {}", line::HISTORIES[0], line::HISTORY_END),
        x: Axis::new("step", ""),
        y: y.over(1e-15, 1.0),
        curves: &curves,
        logarithmic: [false, true],
        ..Default::default()
    }
    .save(path)
}

fn end(pile: &Pile) -> String {
    format!("first order, {CELLS} × {CELLS} cells, t = {:.1}", pile.end.0)
}

/// The pile in perspective, the rolling layer as colour on it.
pub fn pile(pile: &Pile, path: &Path) -> Result<(), PictureError> {
    let nodes = line::nodes(CELLS);
    let shown = largest_shown(&pile.v);
    Surface {
        title: pile.example.title,
        subtitle: &end(pile),
        x: PLACE,
        y: Axis::new("y", ""),
        z: Layer::Standing.axis(),
        xs: &nodes,
        ys: &nodes,
        values: &pile.u,
        paint: Some(Paint { values: &pile.v, quantity: Layer::Rolling.axis().over(0.0, shown) }),
        colours: Colours::Thickness,
        facets: true,
        proportions: Some([1.0, 1.0, 0.5]),
        walls: &pile.walls,
        elevation: (!pile.walls.is_empty()).then_some(45.0),
        ..Default::default()
    }
    .save(path)
}

/// Where the colours end: at the value that one cell in a hundred exceeds, so that a peak does not pale the rest.
pub fn largest_shown(v: &[f64]) -> f64 {
    let mut sorted = v.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (most, nearly) = (sorted[sorted.len() - 1], sorted[(sorted.len() - 1) * 99 / 100]);
    if most > 2.0 * nearly { nearly } else { most }
}

/// Both layers along two lines, the equilibrium as a line.
pub fn sections(pile: &Pile, path: &Path) -> Result<(), PictureError> {
    let along = |field: &[f64], columns: usize, y: Option<f64>| -> Vec<f64> {
        // A height between two rows of cells belongs to the upper one.
        let row = |k: usize| y.map_or(k, |y| (y * CELLS as f64).round() as usize);
        (0..columns).map(|k| field[row(k) * columns + k]).collect()
    };
    let names = pile.example.sections.map(|y| match y {
        Some(y) => format!("along x at y = {y}"),
        None => "along the diagonal".into(),
    });
    let places = [line::nodes(CELLS), line::centres(CELLS)];
    let fields = [(&pile.u, &pile.direct.u), (&pile.v, &pile.direct.v)];
    let values: Vec<_> = (0..2)
        .map(|k| {
            let cut = |field: &[f64]| pile.example.sections.map(|y| along(field, places[k].len(), y));
            (cut(fields[k].0), cut(fields[k].1))
        })
        .collect();
    let curves: Vec<Vec<Curve>> = (0..2)
        .map(|k| {
            let (grown, direct) = &values[k];
            let mut curves = Vec::new();
            for section in 0..2 {
                let colour = Some(line_colour(section));
                let x = &places[k];
                // One key for both panels.
                let name = if k == 0 { names[section].as_str() } else { "" };
                curves.push(Curve { name, x, y: &direct[section], style: Style::Solid, colour });
                curves.push(Curve { name: "", x, y: &grown[section], style: Style::Points, colour });
            }
            curves
        })
        .collect();
    let panel = |k: usize| HistoryPanel { y: Layer::BOTH[k].axis(), curves: &curves[k] };
    Panels {
        title: pile.example.title,
        subtitle: &format!("dots: {}; lines: equilibrium without time steps", end(pile)),
        time: PLACE,
        panels: &[panel(0), panel(1)],
    }
    .save(path)
}
