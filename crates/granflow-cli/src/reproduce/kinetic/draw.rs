//! The pictures: what a paper prints, drawn from our runs; all quantities in the papers' scaling.

use granflow::output::figures::{
    Axis, Colours, Curve, Frame as Axes, HeatMap, PictureError, Profiles, Save, Style, Surface, line_colour,
};
use std::path::Path;

use super::computed::{Computed, Frame, Runs};
use super::examples::Id;
use super::papers::{Drawing, Field};

const PLACE: Axis = Axis::new("x / L", "");
const TIME: Axis = Axis::new("t √(g/L)", "");

impl Field {
    fn axis(self) -> Axis<'static> {
        match self {
            Self::Height => Axis::new("height h / H", ""),
            Self::Velocity => Axis::new("velocity u / √(gL)", ""),
        }
    }

    /// h or u, in words.
    pub const fn letter(self) -> &'static str {
        match self {
            Self::Height => "h",
            Self::Velocity => "u",
        }
    }

    fn of(self, frame: &Frame) -> &[f64] {
        match self {
            Self::Height => &frame.h,
            Self::Velocity => &frame.u,
        }
    }
}

impl Drawing {
    /// What it shows, for a file name.
    pub fn name(self) -> String {
        match self {
            Self::Exact(verfahren, field) => format!("{}_verfahren_{verfahren}", field.letter()),
            Self::Profiles(field, _) => format!("{}_profiles", field.letter()),
            Self::Above(field) => format!("{}_above", field.letter()),
            Self::Perspective(field) => format!("{}_perspective", field.letter()),
        }
    }

    /// What it shows, for a caption.
    pub fn caption(self) -> String {
        match self {
            Self::Exact(verfahren, field) => format!("{} by Verfahren {verfahren}", field.letter()),
            Self::Profiles(field, _) => format!("{} by Verfahren 5", field.letter()),
            Self::Above(field) => format!("{} by Verfahren 5 from above (Draufsicht)", field.letter()),
            Self::Perspective(field) => format!("{} by Verfahren 5 in perspective", field.letter()),
        }
    }

    /// Draws an example to a file.
    pub fn save(self, example: Id, runs: &Runs, path: &Path) -> Result<(), PictureError> {
        match self {
            Self::Exact(verfahren, field) => exact(runs.by(example, verfahren), field, path),
            Self::Profiles(field, steps) => profiles(runs.by(example, 5), field, steps, path),
            Self::Above(field) => {
                let run = runs.by(example, 5);
                let cube = Cube::of(run, field, usize::MAX);
                HeatMap {
                    title: run.example.title,
                    subtitle: run.scheme.1,
                    frame: Axes::SpaceTime,
                    x: PLACE,
                    y: TIME,
                    xs: &run.x,
                    ys: &cube.times,
                    values: &cube.values,
                    quantity: cube.axis,
                    colours: cube.colours,
                    ..Default::default()
                }
                .save(path)
            }
            Self::Perspective(field) => {
                let run = runs.by(example, 5);
                let cube = Cube::of(run, field, 100);
                Surface {
                    title: run.example.title,
                    subtitle: run.scheme.1,
                    x: PLACE,
                    y: TIME,
                    z: cube.axis,
                    xs: &run.x,
                    ys: &cube.times,
                    values: &cube.values,
                    colours: cube.colours,
                    proportions: Some([1.3, 1.0, 0.55]),
                    ..Default::default()
                }
                .save(path)
            }
        }
    }
}

/// A field over space and time.
struct Cube {
    times: Vec<f64>,
    values: Vec<f64>,
    axis: Axis<'static>,
    colours: Colours,
}

impl Cube {
    fn of(run: &Computed, field: Field, most: usize) -> Self {
        let every = run.frames.len().div_ceil(most);
        let frames = || run.frames.iter().step_by(every);
        let values: Vec<f64> = frames().flat_map(|frame| field.of(frame).iter().copied()).collect();
        let both_signs = [|v: &f64| *v < -0.01, |v: &f64| *v > 0.01].iter().all(|s| values.iter().any(s));
        let colours = if both_signs { Colours::Diverging } else { Colours::Viridis };
        let reach = values.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        let axis = if both_signs { field.axis().over(-reach, reach) } else { field.axis() };
        Self { times: frames().map(|frame| frame.time).collect(), values, axis, colours }
    }
}

/// The range of values, no narrower than a hundredth: rounding is not blown up to a picture.
fn calm<'a>(axis: Axis<'a>, curves: &[Curve]) -> Axis<'a> {
    let all = || curves.iter().flat_map(|curve| curve.y.iter().copied()).filter(|y| y.is_finite());
    let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
    if high - low < 0.01 { axis.over(low - 0.5, high + 0.5) } else { axis }
}

fn exact(run: &Computed, field: Field, path: &Path) -> Result<(), PictureError> {
    let end = run.end();
    // Ten places a cell: the line shows corners and jumps as sharp as they are.
    let fine: Vec<f64> =
        run.x.iter().flat_map(|x| (0..10).map(move |k| x + run.dx * (f64::from(k) / 10.0 - 0.45))).collect();
    let exact = run.exact(&fine);
    let line = exact.as_ref().map(|exact| Curve {
        name: "exact",
        x: &fine,
        y: field.of(exact),
        style: Style::Solid,
        colour: Some([34, 34, 34]),
    });
    let dots = Curve {
        name: run.scheme.1,
        x: &run.x,
        y: field.of(end),
        style: Style::Points,
        colour: Some(line_colour(1)),
    };
    let curves: Vec<Curve> = line.into_iter().chain([dots]).collect();
    let subtitle = format!("after {} steps, t √(g/L) = {:.3}", end.step, end.time);
    Profiles {
        title: run.example.title,
        subtitle: &subtitle,
        x: PLACE,
        y: calm(field.axis(), &curves),
        curves: &curves,
        ..Default::default()
    }
    .save(path)
}

fn profiles(run: &Computed, field: Field, steps: &[u64], path: &Path) -> Result<(), PictureError> {
    const STYLES: [Style; 3] = [Style::Solid, Style::Dotted, Style::Dashed];
    let frames: Vec<&Frame> = steps.iter().map(|&step| run.at(step)).collect();
    let names: Vec<String> = frames.iter().map(|frame| format!("step {}", frame.step)).collect();
    let curves: Vec<Curve> = (frames.iter().zip(&names).enumerate())
        .map(|(k, (frame, name))| Curve {
            name,
            x: &run.x,
            y: field.of(frame),
            style: if frames.len() <= STYLES.len() { STYLES[k] } else { Style::Solid },
            colour: None,
        })
        .collect();
    Profiles {
        title: run.example.title,
        subtitle: run.scheme.1,
        x: PLACE,
        y: field.axis(),
        curves: &curves,
        ..Default::default()
    }
    .save(path)
}

/// The final heights of an example by all schemes that came to the end.
pub fn comparison(runs: &[Computed], path: &Path) -> Result<(), PictureError> {
    // The full lines lie below the dashed ones: curves that coincide can both be seen.
    let drawn = [5..runs.len(), 0..5].into_iter().flatten().filter(|&k| runs[k].failure.is_none());
    let curves: Vec<Curve> = drawn
        .map(|k| Curve {
            name: runs[k].scheme.1,
            x: &runs[k].x,
            y: &runs[k].end().h,
            style: if k < 5 { Style::Dashed } else { Style::Solid },
            colour: Some(line_colour(k)),
        })
        .collect();
    let subtitle = format!("final height by every scheme that came to step {}", runs[0].end().step);
    Profiles {
        title: runs[0].example.title,
        subtitle: &subtitle,
        x: PLACE,
        y: calm(Field::Height.axis(), &curves),
        curves: &curves,
        ..Default::default()
    }
    .save(path)
}

/// A run that broke off: its height where it first was negative and in its last finite state.
pub fn failure(run: &Computed, path: &Path) -> Result<(), PictureError> {
    let named = |frame: &Frame, what: &str| format!("{what}, step {}", frame.step);
    let negative = run.negative.as_ref().unwrap_or_else(|| run.end());
    let names = [named(negative, "first h < 0"), named(run.end(), "last finite state")];
    let zero = vec![0.0; run.x.len()];
    let curves = [
        Curve { name: "", x: &run.x, y: &zero, style: Style::Dashed, colour: Some([110, 110, 110]) },
        Curve {
            name: &names[0],
            x: &run.x,
            y: &negative.h,
            style: Style::Solid,
            colour: Some(line_colour(0)),
        },
        Curve {
            name: &names[1],
            x: &run.x,
            y: &run.end().h,
            style: Style::Points,
            colour: Some(line_colour(1)),
        },
    ];
    Profiles {
        title: run.example.title,
        subtitle: &format!("{} fails", run.scheme.1),
        x: PLACE,
        y: Field::Height.axis(),
        curves: &curves,
        ..Default::default()
    }
    .save(path)
}
