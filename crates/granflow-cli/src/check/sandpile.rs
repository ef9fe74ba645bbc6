//! What a sandpile would compute: table, sources, layers at the start.

use granflow::case::sandpile::{Edge, Pile, Plan, Poured, TablePlan};
use granflow::case::{Axis, Grid, RunPlan, Until};
use granflow::hadeler_kuttler::scheme::HadelerKuttler;
use granflow::simulation::Simulation;

use super::{Lines, axis_line, effort, range};

/// The lines about a table and what is poured on it.
pub(super) fn lines(run: &RunPlan, plan: &Plan) -> Lines {
    match &plan.table {
        Poured::Line(pile) => table_lines(run, &plan.grid, pile),
        Poured::Plane(pile) => table_lines(run, &plan.grid, pile),
    }
}

fn table_lines<const D: usize>(run: &RunPlan, grid: &Grid, pile: &Pile<D>) -> Lines {
    let Pile { table: plan, sources } = pile;
    let mut lines = Lines::new();
    let axes: Vec<&Axis> = grid.axes().collect();
    for (name, axis) in ["x", "y"].into_iter().zip(&axes) {
        lines.push((if name == "x" { "grid" } else { "" }, axis_line(name, axis)));
    }
    let cell: f64 = axes.iter().map(|axis| axis.width()).product();
    let count = plan.table.count();
    lines.push(("table", format!("{count} cells, {:.6} in all, {}", count as f64 * cell, edges(plan))));
    let (low, high) = range(&plan.height);
    if (low, high) != (0.0, 0.0) {
        lines.push(("", format!("{low} to {high} high")));
    }
    let poured = |t: f64| sources.rate(t).iter().sum::<f64>() * cell;
    lines.push(("poured", format!("{:.6} a time at the start", poured(0.0))));
    lines.extend(sources.changes().iter().map(|t| ("", format!("{:.6} from time {t} on", poured(*t)))));
    if sources.is_moving(0.0) {
        lines.push(("", "and changing in time by a formula".to_owned()));
    }
    let [u, v] = [&plan.standing, &plan.rolling].map(|layer| range(layer).1);
    lines.push(("layers", format!("at the start standing up to {u}, rolling up to {v}")));
    if run.ends.until == Some(Until::Equilibrium) {
        lines.push(("steps", "none".to_owned()));
    } else {
        // The paper's bound along each axis, dt max(1, max v)/h: slopes are at most 1.
        let rate = axes.iter().map(|axis| v.max(1.0) / axis.width()).sum();
        let bytes = plan.nodes.counts().iter().product::<usize>()
            * Simulation::<D, HadelerKuttler>::bytes_per_cell(false);
        lines.extend(effort(run, bytes, rate));
    }
    lines
}

/// How many edges of each kind there are, open and walls.
fn edges<const D: usize>(plan: &TablePlan<D>) -> String {
    let kinds = [Edge::Left, Edge::Right, Edge::Bottom, Edge::Top, Edge::Hole];
    let all: Vec<(Edge, bool)> = plan.table.edges().map(|(edge, wall)| (Edge::of(&edge), wall)).collect();
    let count = |kind, wall| all.iter().filter(|edge| **edge == (kind, wall)).count();
    let words = |wall: bool| {
        let of =
            |kind: Edge| (count(kind, wall) > 0).then(|| format!("{} {}", count(kind, wall), kind.as_str()));
        let list: Vec<String> = kinds.into_iter().filter_map(of).collect();
        if list.is_empty() { "none".to_owned() } else { list.join(", ") }
    };
    format!("edges open: {}; walls: {}", words(false), words(true))
}
