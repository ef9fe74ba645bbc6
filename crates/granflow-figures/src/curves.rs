//! Curves over one axis: profiles, exact against computed, with filled ground and pile.

use super::axes::{Axis, Panel, RIM, Scale, extent, heading, rounded};
use super::canvas::{Area, Canvas, Pen};
use super::colours::{LINE_COLOURS, Rgb, line_colour};
use super::legend::{Key, Legend, along};
use super::{Figure, FigureError, Picture};

/// How a curve is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Style {
    /// A full line.
    #[default]
    Solid,
    /// Dashes.
    Dashed,
    /// Dots.
    Dotted,
    /// Dashes and dots.
    DashDot,
    /// A disc at each point, no line.
    Points,
}

/// A named curve y(x); a point that is not finite breaks the line.
#[derive(Debug, Clone, Copy, Default)]
pub struct Curve<'a> {
    /// Its name in the legend; empty for none.
    pub name: &'a str,
    /// Abscissae.
    pub x: &'a [f64],
    /// Ordinates, as many.
    pub y: &'a [f64],
    /// Line or points.
    pub style: Style,
    /// Its colour; by turn from [`line_colour`] where `None`.
    pub colour: Option<Rgb>,
}

impl Curve<'_> {
    pub(super) fn check(&self, figure: &str) -> Result<(), FigureError> {
        FigureError::same_length(figure, &format!("y of curve `{}`", self.name), self.y.len(), self.x.len())
    }

    pub(super) fn colour(&self, turn: usize) -> Rgb {
        self.colour.unwrap_or_else(|| line_colour(turn))
    }

    pub(super) fn key(&self, turn: usize) -> Key {
        let pen = Pen { colour: self.colour(turn), ..solid(turn) };
        let dashes: &'static [f32] = match self.style {
            Style::Points => return Key::Points(self.colour(turn)),
            Style::Solid if self.colour.is_none() => pen.dashes,
            Style::Solid => &[],
            Style::Dashed => &[7.0, 4.0],
            Style::Dotted => &[2.0, 3.0],
            Style::DashDot => &[8.0, 3.0, 2.0, 3.0],
        };
        Key::Line(Pen { dashes, ..pen })
    }

    pub(super) fn draw(&self, canvas: &mut Canvas, panel: &Panel, turn: usize) {
        let line = panel.line(self.x, self.y);
        match self.key(turn) {
            Key::Line(pen) => canvas.line(&line, pen),
            Key::Points(colour) => {
                let radius = if line.len() > 150 { 1.8 } else { 3.0 };
                let drawn = line.iter().filter(|p| p[0].is_finite() && p[1].is_finite());
                drawn.for_each(|&p| canvas.disc(p, radius, colour));
            }
            Key::Area(..) => {}
        }
    }
}

/// The pen of line number `turn`; with long dashes where the colours come round again.
pub(super) fn solid(turn: usize) -> Pen {
    let dashes: &'static [f32] = if turn < LINE_COLOURS { &[] } else { &[12.0, 2.5] };
    Pen { dashes, ..Pen::new(line_colour(turn), 1.9) }
}

/// A filled band between two curves.
#[derive(Debug, Clone, Copy)]
pub struct Fill<'a> {
    /// Its name in the legend; empty for none.
    pub name: &'a str,
    /// Abscissae.
    pub x: &'a [f64],
    /// The lower edge, as many; the foot of the panel where `None`.
    pub lower: Option<&'a [f64]>,
    /// The upper edge, as many.
    pub upper: &'a [f64],
    /// Its colour.
    pub colour: Rgb,
}

impl Fill<'_> {
    /// Opacity of a filled band.
    const ALPHA: f64 = 0.55;

    pub(super) fn check(&self, figure: &str) -> Result<(), FigureError> {
        let edge = |which| format!("{which} edge of fill `{}`", self.name);
        FigureError::same_length(figure, &edge("upper"), self.upper.len(), self.x.len())?;
        let lower = self.lower.map_or(self.x.len(), <[f64]>::len);
        FigureError::same_length(figure, &edge("lower"), lower, self.x.len())
    }

    pub(super) fn key(&self) -> Key {
        Key::Area(self.colour, Self::ALPHA)
    }

    pub(super) fn draw(&self, canvas: &mut Canvas, panel: &Panel) {
        let foot = vec![panel.y.range[0]; self.x.len()];
        let mut ring = panel.line(self.x, self.upper);
        ring.extend(panel.line(self.x, self.lower.unwrap_or(&foot)).into_iter().rev());
        ring.retain(|p| p[0].is_finite() && p[1].is_finite());
        canvas.fill(&ring, self.colour, Self::ALPHA);
    }
}

/// Several curves over one axis, with legend and filled bands.
#[derive(Debug, Clone, Copy, Default)]
pub struct Profiles<'a> {
    /// The heading.
    pub title: &'a str,
    /// A second, smaller line under it.
    pub subtitle: &'a str,
    /// The horizontal axis.
    pub x: Axis<'a>,
    /// The vertical axis.
    pub y: Axis<'a>,
    /// The curves, later ones above earlier ones.
    pub curves: &'a [Curve<'a>],
    /// Bands behind the curves.
    pub fills: &'a [Fill<'a>],
    /// Which of the axes x and y are logarithmic, as for errors against iterations; what is not positive is left out there.
    pub logarithmic: [bool; 2],
}

impl Figure for Profiles<'_> {
    fn draw(&self) -> Result<Picture, FigureError> {
        for curve in self.curves {
            curve.check(self.title)?;
        }
        for fill in self.fills {
            fill.check(self.title)?;
        }
        let none = |axis: &str| FigureError::empty(self.title, format!("no finite value along {axis}"));
        let all = |pick: fn(&Curve<'_>) -> Vec<f64>| self.curves.iter().flat_map(pick);
        let xs = all(|c| c.x.to_vec()).chain(self.fills.iter().flat_map(|f| f.x.iter().copied()));
        let bands =
            self.fills.iter().flat_map(|f| f.upper.iter().chain(f.lower.into_iter().flatten()).copied());
        let ys = all(|c| c.y.to_vec()).chain(bands);
        let [log_x, log_y] = self.logarithmic;
        let x = if log_x {
            Scale::logarithmic(&self.x, xs, 1.0)
        } else {
            self.x.range_of(extent(xs).map(rounded), 0.0).map(Scale::new)
        };
        let y = if log_y {
            Scale::logarithmic(&self.y, ys, 1.5)
        } else {
            self.y.range_of(extent(ys), 0.05).map(Scale::new)
        };
        let (x, y) = (x.ok_or_else(|| none("x"))?, y.ok_or_else(|| none("y"))?);

        let (width, height) = (800.0, 500.0);
        let mut canvas = Canvas::new(width, height);
        let top = heading(&mut canvas, self.title, self.subtitle, width);
        let outer = Area { left: RIM, top, width: width - 2.0 * RIM, height: height - top - RIM };
        let panel = |outer| Panel::fit(outer, x, y, self.x.caption(), self.y.caption());

        let legend = legend(self.curves, self.fills);
        let mut frame = panel(outer);
        let (mut place, covered) = legend.best_place(frame.area, &taken(&frame, self.curves, self.fills));
        if covered > 2 && !legend.is_empty() {
            let side = legend.size()[0] + 6.0;
            frame = panel(Area { width: outer.width - side, ..outer });
            place = Area { left: frame.area.right() + 12.0, top: frame.area.top, ..place };
        }
        frame.draw_grid(&mut canvas);
        draw_all(&mut canvas, &frame, self.curves, self.fills);
        frame.draw_frame(&mut canvas);
        legend.draw(&mut canvas, place);
        Ok(canvas.finish())
    }
}

pub(super) fn legend(curves: &[Curve], fills: &[Fill]) -> Legend {
    let mut legend = Legend::default();
    curves.iter().enumerate().for_each(|(turn, curve)| legend.add(curve.name, curve.key(turn)));
    fills.iter().for_each(|fill| legend.add(fill.name, fill.key()));
    legend
}

/// Where in a panel its curves and the edges of its bands run.
pub(super) fn taken(panel: &Panel, curves: &[Curve], fills: &[Fill]) -> Vec<[f64; 2]> {
    let mut points = Vec::new();
    for curve in curves {
        let line = panel.line(curve.x, curve.y);
        if curve.style == Style::Points { points.extend(line) } else { along(&line, panel.area, &mut points) }
    }
    for fill in fills {
        along(&panel.line(fill.x, fill.upper), panel.area, &mut points);
    }
    points
}

pub(super) fn draw_all(canvas: &mut Canvas, panel: &Panel, curves: &[Curve], fills: &[Fill]) {
    canvas.clip(Some(panel.area));
    fills.iter().for_each(|fill| fill.draw(canvas, panel));
    curves.iter().enumerate().for_each(|(turn, curve)| curve.draw(canvas, panel, turn));
    canvas.clip(None);
}
