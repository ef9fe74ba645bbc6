//! What a growing sandpile would compute: table, sources, layers at the start.

use super::start::BESIDE;
use crate::describe::{Line, axis, case, effort, memory, range, written};
use crate::memory::{Drawn, Size};
use granflow_case::sandpile::{Edge, Pile, Plan, Poured, SchemeName, TablePlan};
use granflow_case::{Axis, Frames, RunPlan, Until};
use granflow_engine::simulation::Simulation;
use granflow_model::hadeler_kuttler::scheme::HadelerKuttler;

/// The lines about a sandpile.
pub(crate) fn lines(run: &RunPlan, plan: &Plan) -> Vec<Line> {
    let scheme = match plan.scheme {
        SchemeName::FirstOrder => "first order, ".to_owned(),
        SchemeName::SecondOrder => "second order, ".to_owned(),
        SchemeName::Adaptive => {
            format!("second order away from steady states, theta_exponent {}, ", plan.theta_exponent)
        }
    };
    let mut lines = case(run, Vec::new(), &scheme);
    let axes: Vec<&Axis> = [Some(&plan.grid.x), plan.grid.y.as_ref()].into_iter().flatten().collect();
    for (name, along) in ["x", "y"].into_iter().zip(&axes) {
        lines.push((if name == "x" { "grid" } else { "" }, axis(name, along)));
    }
    match &plan.table {
        Poured::Line(pile) => lines.extend(on(run, pile, &axes)),
        Poured::Plane(pile) => lines.extend(on(run, pile, &axes)),
    }
    lines
}

/// Bytes of the two layers in a cell, and of what the equilibrium takes beside them while it is found.
const STATE: usize = 16;
const EQUILIBRIUM: usize = 100;
/// What pictures of a line and of a table take: measured.
const ON_LINE: Drawn = Drawn { figure: 18e6, picture: 15e6, of_ensemble: 0.0, held: 8.0 };
const ON_TABLE: Drawn = Drawn { figure: 40e6, picture: 66e6, of_ensemble: 0.0, held: 0.0 };

fn on<const D: usize>(run: &RunPlan, Pile { table: plan, sources }: &Pile<D>, axes: &[&Axis]) -> Vec<Line> {
    let cell: f64 = axes.iter().map(|axis| axis.width()).product();
    let count = plan.table.count();
    let mut lines =
        vec![("table", format!("{count} cells, {:.6} in all, {}", count as f64 * cell, edges(plan)))];
    let (low, high) = range(plan.height.iter().copied());
    if (low, high) != (0.0, 0.0) {
        lines.push(("", format!("{low} to {high} high")));
    }
    let poured = |t: f64| sources.rate(t).iter().sum::<f64>() * cell;
    lines.push(("poured", format!("{:.6} a time at the start", poured(0.0))));
    lines.extend(sources.changes().iter().map(|t| ("", format!("{:.6} from time {t} on", poured(*t)))));
    if sources.is_moving(0.0) {
        lines.push(("", "and changing in time by a formula".to_owned()));
    }
    let [u, v] = [&plan.standing, &plan.rolling].map(|layer| range(layer.iter().copied()).1);
    lines.push(("layers", format!("at the start standing up to {u}, rolling up to {v}")));
    let nodes: usize = plan.nodes.counts().iter().product();
    let size = size::<D>(run, nodes, sources.bytes());
    if run.ends.until == Some(Until::Equilibrium) {
        lines.extend([("memory", memory(run, &size)), ("writes", written(run, &size))]);
        lines.push(("steps", "none".to_owned()));
    } else {
        // The paper's bound along each axis, dt max(1, max v)/h: slopes are at most 1.
        let rate = axes.iter().map(|axis| v.max(1.0) / axis.width()).sum();
        lines.extend(effort(run, &size, rate));
    }
    lines
}

/// How large a run is whose sources hold so many bytes.
fn size<const D: usize>(run: &RunPlan, nodes: usize, sources: usize) -> Size {
    let simulation = Simulation::<D, HadelerKuttler>::bytes_per_cell(false);
    // Schemes of two stages keep the state before a step that an instant of the frames lies in.
    let instants = matches!(run.output.frames, Frames::Every(_) | Frames::Ends);
    let before = if instants && run.scheme != SchemeName::FirstOrder.as_str() { STATE } else { 0 };
    let direct = run.ends.until == Some(Until::Equilibrium);
    let beside = BESIDE + if direct { EQUILIBRIUM } else { before };
    let drawn = if D == 1 { ON_LINE } else { ON_TABLE };
    let bytes = (simulation + beside) as f64 + sources as f64 / nodes as f64;
    Size {
        reading: 0.0,
        cells: nodes,
        line: D == 1,
        setup: bytes,
        run: bytes,
        shared: 0.0,
        saved: STATE as f64,
        maps: 3,
        frame: 2 * nodes,
        drawn,
    }
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
