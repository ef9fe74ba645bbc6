//! The figures of a run on a chute: profiles and space-time in one dimension, the plane in two.

use super::drawing::Drawing;
use super::profiles::{self, Line};
use super::story::Story;
use crate::output::figures::{Axis, Colours, Figure, Frame, HeatMap, Surface, short};

/// Shown part of a plane: cells whose peak thickness passes this share of the largest.
const FOOTPRINT: f64 = 0.01;
/// Cells around the footprint, as a share of its size.
const MARGIN: f64 = 0.1;

/// Profiles and space-time of a one-dimensional run.
pub(super) fn line<'a>(story: &'a Story<'a>) -> Vec<Drawing<'a>> {
    let x = &story.plane.x;
    let (thickness, velocity) = (story.series("thickness"), story.series("velocity_x"));
    let profile = |name, caption: &str, label, series: &[Vec<f64>], filled: bool| {
        let line = Line { x, series: series.to_vec(), filled, ground: &[], walls: Vec::new(), ends: None };
        profiles::drawing(story, (name, caption), label, line)
    };
    let above = |name, caption: &str, label, series: &'_ [Vec<f64>], colours| {
        let values: Vec<f64> = series.concat();
        Drawing::new(name, caption, move || {
            HeatMap {
                title: &story.title,
                subtitle: &story.subtitle,
                frame: Frame::SpaceTime,
                x: Axis::new("x", ""),
                y: Axis::new("time t", ""),
                xs: x,
                ys: &story.times,
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
                title: &story.title,
                subtitle: &story.subtitle,
                x: Axis::new("x", ""),
                y: Axis::new("time t", ""),
                z: Axis::new(h, ""),
                xs: x,
                ys: &story.times,
                values: &thickness.concat(),
                ..Default::default()
            }
            .draw()
        }),
    ];
    drawings.extend(super::history_figure::drawing(story));
    drawings
}

/// The part of a plane that the mass ever covered, with a margin.
#[derive(Debug)]
pub(super) struct Window {
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    low: [usize; 2],
    columns: usize,
}

impl Window {
    /// The window around the cells of `map` above [`FOOTPRINT`].
    pub fn around(story: &Story, map: &[f64]) -> Window {
        let (x, y) = (&story.plane.x, &story.plane.y);
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
    pub fn cut(&self, map: &[f64]) -> Vec<f64> {
        let row = |j: usize| {
            let start = (self.low[1] + j) * self.columns + self.low[0];
            &map[start..start + self.x.len()]
        };
        (0..self.y.len()).flat_map(row).copied().collect()
    }
}

/// The maps of a run on a plane.
pub(super) fn plane<'a>(story: &'a Story<'a>) -> Vec<Drawing<'a>> {
    let thickness = story.series("thickness");
    let footprint = story.map("peak_thickness").or(thickness.first().map(Vec::as_slice)).unwrap_or(&[]);
    let mut drawings = Vec::new();
    if footprint.is_empty() {
        return drawings;
    }
    let window = std::sync::Arc::new(Window::around(story, footprint));
    let ends = [
        ("thickness_start", thickness.first(), story.times.first()),
        ("thickness_end", thickness.last(), story.times.last()),
    ];
    let mut maps: Vec<(&'static str, &str, String, &[f64])> = Vec::new();
    for (name, field, time) in ends {
        if let (Some(field), Some(time)) = (field, time) {
            maps.push((name, "thickness h", format!("thickness at t = {}", short(*time)), field));
        }
    }
    let peaks = [("peak_thickness", "greatest thickness"), ("peak_speed", "greatest speed")];
    maps.extend(peaks.iter().filter_map(|(name, label)| {
        Some((*name, *label, format!("{label} over the run"), story.map(name)?))
    }));
    for (name, label, what, map) in maps {
        let window = window.clone();
        let subtitle = format!("{what}; {}", story.subtitle);
        drawings.push(Drawing::new(name, format!("Map of the {what}."), move || {
            HeatMap {
                title: &story.title,
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
    drawings.extend(super::history_figure::drawing(story));
    drawings
}
