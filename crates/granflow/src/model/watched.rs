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
        let curves: Vec<Vec<Curve>> = shown
            .iter()
            .enumerate()
            .map(|(panel, (_, values))| {
                let curve = |(name, y): (&'a String, _)| Curve {
                    // One panel names them all.
                    name: if panel == 0 { name.as_str() } else { "" },
                    x: &table.times,
                    y,
                    ..Default::default()
                };
                table.names.iter().zip(values.iter().map(Vec::as_slice)).map(curve).collect()
            })
            .collect();
        let panels: Vec<HistoryPanel> = shown
            .iter()
            .zip(&curves)
            .map(|(((_, label, unit), _), curves)| HistoryPanel {
                y: Axis::new(label, view.unit(unit)),
                curves,
            })
            .collect();
        let time = Axis::new("time t", view.unit("s"));
        History { title: &view.title, subtitle: &view.subtitle, time, panels: &panels }.draw()
    })
}
