//! The figures of a run on a chute: profiles and space-time in one dimension, the plane in two; the animation.

use crate::model::{Drawing, Line, PILE, Scene, View, history, profiles, watched};
use crate::output::figures::{
    Axis, Colours, Curve, Figure, FigureError, Fill, Frame, HeatMap, Picture, Profiles, Style, Surface, short,
};

/// Shown part of a plane: cells whose peak thickness passes this share of the largest.
const FOOTPRINT: f64 = 0.01;
/// Cells around the footprint, as a share of its size.
const MARGIN: f64 = 0.1;

/// Profiles and space-time of a one-dimensional run.
pub(super) fn line<'a>(view: &'a View<'a>) -> Vec<Drawing<'a>> {
    let x = &view.x;
    let (thickness, velocity) = (view.series("thickness"), view.series("velocity_x"));
    let profile = |name, caption: &str, label, series: &[Vec<f64>], filled: bool| {
        let line = Line { x, series: series.to_vec(), filled, ..Line::default() };
        profiles(view, (name, caption), label, line)
    };
    let above = |name, caption: &str, label, series: &'_ [Vec<f64>], colours| {
        let values: Vec<f64> = series.concat();
        Drawing::new(name, caption, move || {
            HeatMap {
                title: &view.title,
                subtitle: &view.subtitle,
                frame: Frame::SpaceTime,
                x: Axis::new("x", ""),
                y: Axis::new("time t", ""),
                xs: x,
                ys: &view.times,
                values: &values,
                quantity: Axis::new(label, ""),
                colours,
                ..Default::default()
            }
            .draw()
        })
    };
    let signed = velocity.iter().flatten().any(|&u| u < 0.0);
    let colours = if signed { Colours::Diverging } else { Colours::Viridis };
    let (h, u) = ("thickness h", "velocity u");
    let mut drawings = vec![
        profile(
            "profile",
            "Thickness at the start, at two instants between, and at the end.",
            h,
            thickness,
            true,
        ),
        profile("velocity", "Velocity at the same instants.", u, velocity, false),
        above("space_time_thickness", "Thickness over space and time.", h, thickness, Colours::Viridis),
        above("space_time_velocity", "Velocity over space and time.", u, velocity, colours),
        Drawing::new("surface", "Thickness over space and time in perspective.", move || {
            Surface {
                title: &view.title,
                subtitle: &view.subtitle,
                x: Axis::new("x", ""),
                y: Axis::new("time t", ""),
                z: Axis::new(h, ""),
                xs: x,
                ys: &view.times,
                values: &thickness.concat(),
                ..Default::default()
            }
            .draw()
        }),
    ];
    drawings.extend(durations(view));
    drawings.extend(watched(view));
    drawings.extend(history(view));
    drawings
}

/// For how long thresholds were exceeded, along x.
fn durations<'a>(view: &'a View<'a>) -> Option<Drawing<'a>> {
    let named = |name| Some((view.time_above(name)?, view.map(name)?));
    let maps: Vec<(String, &[f64])> =
        ["duration_thickness", "duration_speed"].into_iter().filter_map(named).collect();
    if maps.is_empty() {
        return None;
    }
    let caption = "For how long the thickness and the speed were above the thresholds of output.durations.";
    Some(Drawing::new("durations", caption, move || {
        let curves: Vec<Curve> =
            maps.iter().map(|&(ref name, y)| Curve { name, x: &view.x, y, ..Default::default() }).collect();
        Profiles {
            title: &view.title,
            subtitle: &view.subtitle,
            x: Axis::new("x", ""),
            y: Axis::new("time above", ""),
            curves: &curves,
            ..Default::default()
        }
        .draw()
    }))
}

/// The part of a plane that the mass ever covered, with a margin.
#[derive(Debug)]
struct Window {
    x: Vec<f64>,
    y: Vec<f64>,
    low: [usize; 2],
    columns: usize,
}

impl Window {
    /// The window around the cells of `map` above [`FOOTPRINT`].
    fn around(view: &View, map: &[f64]) -> Window {
        let (x, y) = (&view.x, &view.y);
        let limit = FOOTPRINT * map.iter().fold(0.0_f64, |most, v| most.max(*v));
        let inside: Vec<usize> = (0..map.len()).filter(|&k| map[k] > limit).collect();
        let range = |place: &dyn Fn(usize) -> usize, count: usize| {
            let low = inside.iter().map(|&k| place(k)).min().unwrap_or(0);
            let high = inside.iter().map(|&k| place(k)).max().unwrap_or(count - 1);
            let margin = ((MARGIN * (high - low) as f64) as usize).max(2);
            (low.saturating_sub(margin), (high + margin).min(count - 1))
        };
        let (west, east) = range(&|k| k % x.len(), x.len());
        let (south, north) = range(&|k| k / x.len(), y.len());
        Window {
            x: x[west..=east].to_vec(),
            y: y[south..=north].to_vec(),
            low: [west, south],
            columns: x.len(),
        }
    }
    /// The values of a map in the window.
    fn cut(&self, map: &[f64]) -> Vec<f64> {
        let row = |j: usize| {
            let start = (self.low[1] + j) * self.columns + self.low[0];
            &map[start..start + self.x.len()]
        };
        (0..self.y.len()).flat_map(row).copied().collect()
    }
}

/// The maps of a run on a plane.
pub(super) fn plane<'a>(view: &'a View<'a>) -> Vec<Drawing<'a>> {
    let thickness = view.series("thickness");
    let footprint = view.map("peak_thickness").or(thickness.first().map(Vec::as_slice)).unwrap_or(&[]);
    let mut drawings = Vec::new();
    if footprint.is_empty() {
        return drawings;
    }
    let window = std::sync::Arc::new(Window::around(view, footprint));
    let ends = [
        ("thickness_start", thickness.first(), view.times.first()),
        ("thickness_end", thickness.last(), view.times.last()),
    ];
    let mut maps: Vec<(&'static str, &str, String, &[f64])> = Vec::new();
    for (name, field, time) in ends {
        if let (Some(field), Some(time)) = (field, time) {
            maps.push((name, "thickness h", format!("thickness at t = {}", short(*time)), field));
        }
    }
    let peaks = [
        ("peak_thickness", "greatest thickness"),
        ("peak_speed", "greatest speed"),
        ("duration_thickness", "time above"),
        ("duration_speed", "time above"),
    ];
    maps.extend(peaks.iter().filter_map(|(name, label)| {
        let what = view.time_above(name).unwrap_or_else(|| format!("{label} over the run"));
        Some((*name, *label, what, view.map(name)?))
    }));
    for (name, label, what, map) in maps {
        let window = window.clone();
        let subtitle = format!("{what}; {}", view.subtitle);
        drawings.push(Drawing::new(name, format!("Map of the {what}."), move || {
            HeatMap {
                title: &view.title,
                subtitle: &subtitle,
                frame: Frame::Plane,
                x: Axis::new("x", ""),
                y: Axis::new("y", ""),
                xs: &window.x,
                ys: &window.y,
                values: &window.cut(map),
                quantity: Axis::new(label, ""),
                ..Default::default()
            }
            .draw()
        }));
    }
    drawings.extend(watched(view));
    drawings.extend(history(view));
    drawings
}

/// The thickness on a chute over time.
pub(super) fn scene<'a>(view: &'a View<'a>) -> Box<dyn Scene + 'a> {
    let (peak, thickness) = (view.map("peak_thickness"), view.series("thickness"));
    let largest = match peak {
        Some(peak) => peak.iter().copied().fold(0.0, f64::max),
        None => thickness.iter().flatten().copied().fold(0.0, f64::max),
    };
    let footprint = peak.or(thickness.first().map(Vec::as_slice)).unwrap_or(&[]);
    let window = (view.dimensions() > 1).then(|| Window::around(view, footprint));
    Box::new(ChuteScene { view, window, top: if largest > 0.0 { largest } else { 1.0 } })
}

struct ChuteScene<'a> {
    view: &'a View<'a>,
    /// The part that is shown of a plane.
    window: Option<Window>,
    /// Greatest thickness that the colours or the axis tell apart.
    top: f64,
}

impl Scene for ChuteScene<'_> {
    fn draw(&self, time: f64, fields: &[Vec<f64>]) -> Result<Picture, FigureError> {
        let view = self.view;
        let subtitle = format!("t = {} {}", short(time), view.unit("s"));
        let field: &[f64] = fields.first().map_or(&[], Vec::as_slice);
        let x = Axis::new("x", "");
        if let Some(window) = &self.window {
            return HeatMap {
                title: &view.title,
                subtitle: &subtitle,
                x,
                y: Axis::new("y", ""),
                xs: &window.x,
                ys: &window.y,
                values: &window.cut(field),
                quantity: Axis::new("thickness h", view.unit("m")).over(0.0, self.top),
                ..Default::default()
            }
            .draw();
        }
        let xs = &view.x;
        Profiles {
            title: &view.title,
            subtitle: &subtitle,
            x,
            y: Axis::new("thickness h", "").over(0.0, 1.08 * self.top),
            curves: &[Curve { name: "", x: xs, y: field, style: Style::Solid, colour: None }],
            fills: &[Fill { name: "", x: xs, lower: None, upper: field, colour: PILE }],
            ..Default::default()
        }
        .draw()
    }
}
