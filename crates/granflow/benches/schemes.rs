//! What a step costs: nanoseconds of a thread for each cell and scheme in two dimensions, and its ratio to `balanced` on the
//! same number of cells. `cargo bench -p granflow` prints a table; medians of rounds that are taken in turn, so that other
//! work on the machine falls on all alike.

use granflow::grid::Grid;
use granflow::hadeler_kuttler::scheme::{ADAPTIVE, FIRST_ORDER, HadelerKuttler, SECOND_ORDER};
use granflow::hadeler_kuttler::site::Site;
use granflow::hadeler_kuttler::table::Table;
use granflow::savage_hutter::Flow;
use granflow::savage_hutter::balanced::Balanced;
use granflow::savage_hutter::friction::Coulomb;
use granflow::savage_hutter::ground::Chute;
use granflow::scheme::{Boundary, Scheme};
use granflow::simulation::{Simulation, StepSize};
use granflow::time::{EULER, SSP_RK2};
use std::time::Instant;

/// Cells along each axis.
const CELLS: usize = 300;
const ROUNDS: usize = 9;
const STEPS: u64 = 4;

/// Nanoseconds for each cell of a step.
fn cost<const D: usize, S: Scheme<D, f64>>(run: &mut Simulation<D, S>) -> f64 {
    let (clock, cells) = (Instant::now(), run.grid().count() as f64);
    for _ in 0..STEPS {
        run.wake_all();
        run.advance(f64::INFINITY).expect("a sound step");
    }
    clock.elapsed().as_nanos() as f64 / (STEPS as f64 * cells)
}

fn flow(second: bool) -> Simulation<2, Balanced<Coulomb, Chute<2, f64>>> {
    let size = 1.0 / CELLS as f64;
    let grid =
        Grid { cells: [CELLS; 2], origin: [-0.5; 2], size: [size; 2], boundary: [[Boundary::Wall; 2]; 2] };
    let flat = Chute { tilt: [0.0; 2], beta: 1.0, cos: 1.0, curvature: 0.0 };
    let cap = |index| {
        let [x, y] = grid.centre(index);
        let h = 0.02 + 0.2 * (1.0 - (x * x + y * y) / 0.09).max(0.0);
        Flow { h, q: [0.2 * h * x, 0.2 * h * y] }
    };
    let (law, film) = (Coulomb { mu: 0.3 }, 1e-9);
    let scheme = if second { Balanced::second(law, film) } else { Balanced::first(law, film) };
    let stages = if second { SSP_RK2 } else { EULER };
    Simulation::new(scheme, grid, stages, StepSize::Courant(0.4), |_| flat, cap)
}

fn pile(scheme: HadelerKuttler) -> Simulation<2, HadelerKuttler> {
    let site = Site::level(Table::rectangle([CELLS; 2], [[true; 2]; 2]), [1.0 / CELLS as f64; 2]);
    let source = vec![0.5; CELLS * CELLS];
    let found = site.equilibrium(&source).expect("an equilibrium");
    let half: Vec<f64> = found.u.iter().map(|u| 0.5 * u).collect();
    site.simulation(scheme, StepSize::Courant(0.2), &source, (&half, &found.v))
}

fn main() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    pool.install(|| {
        let (mut first, mut second) = (flow(false), flow(true));
        let mut piles = [FIRST_ORDER, SECOND_ORDER, ADAPTIVE].map(pile);
        let names = ["balanced", "balanced_2", "first_order", "second_order", "adaptive"];
        let mut costs = [const { Vec::new() }; 5];
        for _ in 0..ROUNDS {
            let [a, b, c] = &mut piles;
            let round = [cost(&mut first), cost(&mut second), cost(a), cost(b), cost(c)];
            costs.iter_mut().zip(round).for_each(|(costs, cost)| costs.push(cost));
        }
        let median = |costs: &mut Vec<f64>| {
            costs.sort_by(f64::total_cmp);
            costs[costs.len() / 2]
        };
        let costs = costs.each_mut().map(median);
        println!(
            "{CELLS} x {CELLS} cells, one thread, all cells computed\nscheme         ns/cell  of balanced"
        );
        for (name, cost) in names.iter().zip(costs) {
            println!("{name:13} {cost:8.1} {:11.2}", cost / costs[0]);
        }
    });
}
