//! Mass, moving cells, speed and energy over time.

use super::drawing::Drawing;
use super::quantity::Units;
use super::view::View;
use crate::output::figures::{Axis, Curve, Figure, History, HistoryPanel};
use crate::output::ledger::Entry;

/// The history, from the ledger; none where that has fewer than two lines.
pub fn history<'a>(view: &'a View<'a>) -> Option<Drawing<'a>> {
    if view.ledger.len() < 2 {
        return None;
    }
    let caption = "Mass, moving cells, greatest speed and kinetic energy (divided by the density) over time.";
    Some(Drawing::new("history", caption, move || {
        let column = |value: fn(&Entry) -> f64| view.ledger.iter().map(value).collect::<Vec<f64>>();
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
        let volume = if view.units == Units::Si { "volume" } else { "mass" };
        let panels = [
            HistoryPanel { y: axis(volume, view.unit("m³"), &mass), curves: masses },
            HistoryPanel { y: axis("moving cells", "", &moving), curves: &count },
            HistoryPanel { y: axis("greatest speed", view.unit("m/s"), &speed), curves: &fast },
            HistoryPanel { y: axis("kin. energy", view.unit("m⁵/s²"), &energy), curves: &work },
        ];
        let time_axis = Axis::new("time t", view.unit("s"));
        History { title: &view.title, subtitle: &view.subtitle, time: time_axis, panels: &panels }.draw()
    }))
}
