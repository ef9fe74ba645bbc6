//! Mass on the table, poured on it, and fallen off it over time.

use super::MODEL;
use crate::model::{Drawing, View};
use crate::output::figures::{Axis, Curve, Figure, History, HistoryPanel, Style};
use crate::output::ledger::Entry;

/// The ledger of a sandpile: mass on the table, what was poured, what fell over which side; none where the ledger
/// has fewer than two lines.
pub(super) fn history<'a>(view: &'a View<'a>) -> Option<Drawing<'a>> {
    if view.ledger.len() < 2 {
        return None;
    }
    let caption = "Mass on the table, poured on it since the start, and fallen off it, in all and by side.";
    Some(Drawing::new("history", caption, move || {
        let column = |value: &dyn Fn(&Entry) -> f64| view.ledger.iter().map(value).collect::<Vec<f64>>();
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
        let fallen: Vec<Curve> = MODEL
            .outlets
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
        History { title: &view.title, subtitle: &view.subtitle, time: time_axis, panels: &panels }.draw()
    }))
}
