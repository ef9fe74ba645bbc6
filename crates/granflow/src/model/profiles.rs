//! A quantity along a line at four instants: the start, two on the way, the end.

use super::drawing::Drawing;
use super::view::View;
use crate::output::figures::{Axis, Curve, Figure, Fill, Profiles, Style, short};

/// Colour of a layer at the end.
pub const PILE: [u8; 3] = [201, 178, 140];
/// Colours of the ground beneath it and of walls.
const GROUND: [u8; 3] = [150, 140, 128];
const WALL: [u8; 3] = [88, 92, 104];

/// What is drawn along the line.
#[derive(Debug, Clone, Default)]
pub struct Line<'a> {
    /// The places.
    pub x: &'a [f64],
    /// The values at every instant that is kept.
    pub series: Vec<Vec<f64>>,
    /// Is it a thickness, drawn from 0 and filled at the end?
    pub filled: bool,
    /// The ground beneath it, with its name for the legend.
    pub ground: Option<(&'static str, &'a [f64])>,
    /// Where walls stand.
    pub walls: Vec<f64>,
    /// Where the line begins and ends; found from the places where `None`.
    pub ends: Option<[f64; 2]>,
}

/// The first instant, those at which a third and two thirds of all change has happened, and the last.
fn instants(series: &[Vec<f64>]) -> Vec<usize> {
    let last = series.len().saturating_sub(1);
    let change = |pair: &[Vec<f64>]| -> f64 {
        let moved = pair[0].iter().zip(&pair[1]).map(|(a, b)| (a - b).abs());
        moved.filter(|moved| moved.is_finite()).sum()
    };
    let mut changed = vec![0.0];
    for pair in series.windows(2) {
        changed.push(changed[changed.len() - 1] + change(pair));
    }
    let after = |share: f64| changed.partition_point(|c| *c < share * changed[last]);
    let mut shown = vec![0, after(1.0 / 3.0), after(2.0 / 3.0), last];
    shown.dedup();
    shown.retain(|&k| k < series.len());
    shown
}

/// The drawing of a quantity with this label.
pub fn profiles<'a>(
    view: &'a View,
    (name, caption): (&'static str, &str),
    label: &'static str,
    line: Line<'a>,
) -> Drawing<'a> {
    Drawing::new(name, caption, move || {
        let Line { x, series, .. } = &line;
        let shown = instants(series);
        let names: Vec<String> = shown.iter().map(|&k| format!("t = {}", short(view.times[k]))).collect();
        let style = |place: usize| match place {
            0 => (Style::Dashed, Some([110, 110, 110])),
            place if place + 1 == shown.len() => (Style::Solid, Some([0, 114, 178])),
            1 => (Style::Dotted, Some([213, 94, 0])),
            _ => (Style::DashDot, Some([0, 158, 115])),
        };
        let curve = |(place, &k): (usize, &usize)| {
            let (style, colour) = style(place);
            Curve { name: &names[place], x, y: &series[k], style, colour }
        };
        let curves: Vec<Curve> = shown.iter().enumerate().map(curve).collect();
        let lower = line.ground.map(|(_, heights)| heights);
        let ends = |fold: fn(f64, f64) -> f64| {
            series.iter().flatten().chain(lower.unwrap_or(&[])).copied().fold(0.0, fold)
        };
        let (low, high) = (ends(f64::min), ends(f64::max));
        let top = low + 1.08 * (high - low);
        let mut fills = Vec::new();
        if let Some((name, upper)) = line.ground {
            fills.push(Fill { name, x, lower: None, upper, colour: GROUND });
        }
        if let Some(upper) = series.last().filter(|_| line.filled) {
            fills.push(Fill { name: "", x, lower, upper, colour: PILE });
        }
        // A wall is a block beside the line: left of its first end, or right of where it stands.
        let [first, last] = line.ends.unwrap_or_default();
        let (thick, room) = (0.015 * (last - first), 0.02 * (last - first));
        let block = |&at: &f64| if at <= first { [at - thick, at] } else { [at, at + thick] };
        let blocks: Vec<[f64; 2]> = line.walls.iter().map(block).collect();
        for (k, x) in blocks.iter().enumerate() {
            let name = if k == 0 { "wall" } else { "" };
            fills.push(Fill { name, x, lower: None, upper: &[1e9; 2], colour: WALL });
        }
        let y = Axis::new(label, "");
        Profiles {
            title: &view.title,
            subtitle: &view.subtitle,
            x: match line.ends {
                Some([a, b]) if line.walls.is_empty() => Axis::new("x", "").over(a, b),
                Some([a, b]) => Axis::new("x", "").over(a - room, b + room),
                None => Axis::new("x", ""),
            },
            y: if line.filled && high > low { y.over(low, top) } else { y },
            curves: &curves,
            fills: &fills,
            ..Default::default()
        }
        .draw()
    })
}

#[cfg(test)]
mod tests {
    use super::instants;

    #[test]
    fn instants_follow_the_change_not_the_clock() {
        let heights = [0.0, 0.4, 0.7, 0.9, 1.0, 1.0, 1.0, 1.0];
        let series: Vec<Vec<f64>> = heights.iter().map(|h| vec![f64::NAN, *h]).collect();
        assert_eq!(instants(&series), [0, 1, 2, 7]);
        assert_eq!(instants(&series[4..]), [0, 3]);
        assert_eq!(instants(&series[..1]), [0]);
        assert_eq!(instants(&[]), [0; 0]);
    }
}
