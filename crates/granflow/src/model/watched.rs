//! Gauges and sections over time.

use super::drawing::Drawing;
use super::view::View;
use crate::output::figures::{Axis, Curve, Figure, History, HistoryPanel};
use crate::output::lines::Table;

/// A column of a table as a panel shows it: its name in the file, its words, its SI unit.
type Column = (&'static str, &'static str, &'static str);

const GAUGES: [Column; 3] =
    [("thickness", "thickness", "m"), ("speed", "speed", "m/s"), ("pressure", "pressure", "kPa")];
const SECTIONS: [Column; 4] = [
    ("discharge", "discharge", "m³/s"),
    ("volume", "volume passed", "m³"),
    ("thickness", "largest thickness", "m"),
    ("pressure", "largest pressure", "kPa"),
];

/// The figures of gauges and of sections, where there are some.
pub fn watched<'a>(view: &'a View<'a>) -> Vec<Drawing<'a>> {
    let gauges = "What was at each gauge over time.";
    let sections = "What passed each section over time, from its left to its right: discharge and volume, and the largest \
                    thickness and pressure along it.";
    let plans = [("gauges", gauges, &GAUGES[..]), ("sections", sections, &SECTIONS[..])];
    let tables = plans.into_iter().zip(&view.watched);
    tables.filter_map(|(plan, table)| Some(series(view, plan, table.as_ref()?))).collect()
}

fn series<'a>(
    view: &'a View<'a>,
    (name, caption, columns): (&'static str, &'static str, &'static [Column]),
    table: &'a Table,
) -> Drawing<'a> {
    Drawing::new(name, caption, move || {
        let count = table.names.len();
        let of = |column: usize, k: usize| {
            table.values[column].iter().skip(k).step_by(count).copied().collect::<Vec<f64>>()
        };
        let mut shown: Vec<(Column, Vec<Vec<f64>>)> = Vec::new();
        for &column in columns {
            let Some(number) = table.columns.iter().position(|known| known == column.0) else { continue };
            let curves: Vec<Vec<f64>> = (0..count).map(|k| of(number, k)).collect();
            if curves.iter().flatten().any(|value| value.is_finite()) {
                shown.push((column, curves));
            }
        }
        let names: Vec<String> = (0..count).map(|k| named(&table.names[k], &shown, k)).collect();
        let curves: Vec<Vec<Curve>> = shown
            .iter()
            .enumerate()
            .map(|(panel, (_, values))| {
                let curve = |(name, y)| Curve {
                    // One panel names them all.
                    name: if panel == 0 { name } else { "" },
                    x: &table.times,
                    y,
                    ..Default::default()
                };
                names.iter().map(String::as_str).zip(values.iter().map(Vec::as_slice)).map(curve).collect()
            })
            .collect();
        let panels: Vec<HistoryPanel> = shown
            .iter()
            .zip(&curves)
            .map(|(((_, label, unit), values), curves)| HistoryPanel {
                y: from_zero(Axis::new(label, view.unit(unit)), values),
                curves,
            })
            .collect();
        let time = Axis::new("time t", view.unit("s"));
        History { title: &view.title, subtitle: &view.subtitle, time, panels: &panels }.draw()
    })
}

/// A place as the legend names it, number `k` of them: with a word where all of its values stay 0.
fn named(name: &str, shown: &[(Column, Vec<Vec<f64>>)], k: usize) -> String {
    let came =
        shown.iter().flat_map(|(_, curves)| &curves[k]).any(|value| value.is_finite() && *value != 0.0);
    if came { name.to_owned() } else { format!("{name}: nothing came") }
}

/// An axis that begins at 0, where none of its values is negative.
fn from_zero<'a>(axis: Axis<'a>, curves: &[Vec<f64>]) -> Axis<'a> {
    let finite = || curves.iter().flatten().copied().filter(|value| value.is_finite());
    let (least, largest) = (finite().fold(0.0, f64::min), finite().fold(0.0, f64::max));
    match (least, largest) {
        (0.0, 0.0) => axis.over(0.0, 1.0),
        (0.0, largest) => axis.over(0.0, 1.07 * largest),
        _ => axis,
    }
}
