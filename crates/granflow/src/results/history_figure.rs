//! Mass, moving cells, speed and energy over time; the books of a sandpile.

use super::drawing::Drawing;
use super::story::Story;
use crate::output::figures::{Axis, Curve, Figure, History, HistoryPanel, Style};
use crate::output::ledger::Entry;

/// The history, from the ledger; none where that has fewer than two lines.
pub(super) fn drawing<'a>(story: &'a Story<'a>) -> Option<Drawing<'a>> {
    if story.ledger.len() < 2 {
        return None;
    }
    let caption = "Mass, moving cells, greatest speed and kinetic energy (divided by the density) over time.";
    Some(Drawing::new("history", caption, move || {
        let column = |value: fn(&Entry) -> f64| story.ledger.iter().map(value).collect::<Vec<f64>>();
        let time = column(|entry| entry.time);
        let (mass, left) = (column(|entry| entry.mass), column(Entry::mass_out));
        let moving = column(|entry| entry.moving_cells as f64);
        let (speed, energy) = (column(|entry| entry.max_speed), column(|entry| entry.kinetic_energy));
        let most = |values: &[f64]| values.iter().fold(0.0_f64, |most, v| most.max(*v));
        let axis = |label, unit, values: &[f64]| {
            let top = most(values);
            Axis::new(label, unit).over(0.0, if top > 0.0 { 1.12 * top } else { 1.0 })
        };
        let curve = |name, y| Curve { name, x: &time, y, colour: None, ..Default::default() };
        let gone = most(&left) > 0.0;
        let masses =
            [curve(if gone { "on the grid" } else { "" }, &mass), curve("left over the edges", &left)];
        let masses = &masses[..if gone { 2 } else { 1 }];
        let (count, fast, work) = ([curve("", &moving)], [curve("", &speed)], [curve("", &energy)]);
        let volume = if story.plane.is_terrain() { "volume" } else { "mass" };
        let panels = [
            HistoryPanel { y: axis(volume, story.unit("m³"), &mass), curves: masses },
            HistoryPanel { y: axis("moving cells", "", &moving), curves: &count },
            HistoryPanel { y: axis("greatest speed", story.unit("m/s"), &speed), curves: &fast },
            HistoryPanel { y: axis("kin. energy", story.unit("m⁵/s²"), &energy), curves: &work },
        ];
        let time_axis = Axis::new("time t", story.unit("s"));
        History { title: &story.title, subtitle: &story.subtitle, time: time_axis, panels: &panels }.draw()
    }))
}

/// The books of a sandpile: what lies on the table, what was poured, what fell over which side; none where the ledger has
/// fewer than two lines.
pub(super) fn books<'a>(story: &'a Story<'a>) -> Option<Drawing<'a>> {
    if story.ledger.len() < 2 {
        return None;
    }
    let caption = "Mass on the table, poured on it since the start, and fallen off it, in all and by side.";
    Some(Drawing::new("history", caption, move || {
        let column = |value: &dyn Fn(&Entry) -> f64| story.ledger.iter().map(value).collect::<Vec<f64>>();
        let time = column(&|entry| entry.time);
        let all = [column(&|entry| entry.mass), column(&|entry| entry.mass_in), column(&Entry::mass_out)];
        let sides: [Vec<f64>; 5] = std::array::from_fn(|k| column(&|entry| entry.out[k]));
        let fell = |values: &[f64]| values.iter().any(|&v| v > 0.0);
        let styles = [Style::Solid, Style::Dashed, Style::Dotted, Style::DashDot, Style::Solid];
        let masses: Vec<Curve> = ["on the table", "poured", "fallen"]
            .into_iter()
            .zip(&all)
            .map(|(name, y)| Curve { name, x: &time, y, ..Default::default() })
            .collect();
        let fallen: Vec<Curve> = story
            .plane
            .outlets()
            .into_iter()
            .zip(&sides)
            .zip(styles)
            .filter(|((_, y), _)| fell(y))
            .map(|((name, y), style)| Curve { name, x: &time, y, style, ..Default::default() })
            .collect();
        let rise = |label, columns: &[Vec<f64>]| {
            let most = columns.iter().flatten().fold(0.0_f64, |most, v| most.max(*v));
            Axis::new(label, "").over(0.0, if most > 0.0 { 1.08 * most } else { 1.0 })
        };
        let mut panels = vec![HistoryPanel { y: rise("mass", &all), curves: &masses }];
        if !fallen.is_empty() {
            panels.push(HistoryPanel { y: rise("fallen, by side", &sides), curves: &fallen });
        }
        let time_axis = Axis::new("time t", "");
        History { title: &story.title, subtitle: &story.subtitle, time: time_axis, panels: &panels }.draw()
    }))
}
