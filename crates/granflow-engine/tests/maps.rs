//! What the summary maps count: layers thicker than a threshold, whatever films do.

use granflow_engine::grid::Grid;
use granflow_engine::simulation::{Simulation, StepSize};
use granflow_model::savage_hutter::Flow;
use granflow_model::savage_hutter::friction::Coulomb;
use granflow_model::savage_hutter::ground::Chute;
use granflow_model::savage_hutter::kinetic::{Kinetic, VERFAHREN_1};
use granflow_model::scheme::Boundary;

const CELLS: [usize; 2] = [60, 17];
const THRESHOLD: f64 = 0.05;

/// A block at rest, and ahead of it a film that runs ten times as fast as the block ever will.
fn block_behind_a_film() -> Simulation<2, Kinetic> {
    let edges = [[Boundary::Open; 2]; 2];
    let grid = Grid { cells: CELLS, origin: [0.0; 2], size: [0.1; 2], boundary: edges };
    let ground = Chute { tilt: [0.3, 0.1], beta: 0.4, cos: 0.9, curvature: 0.0 };
    let start = |[i, j]: [usize; 2]| match i {
        _ if (5..15).contains(&i) && (3..14).contains(&j) => Flow::still(1.0),
        30.. => Flow { h: 1e-4, q: [1e-3, 0.0] },
        _ => Flow::still(1e-4),
    };
    let step = StepSize::Courant(0.5);
    Simulation::new(VERFAHREN_1.with(Coulomb { mu: 0.2 }), grid, step, |_| ground, start)
        .expect("cells, and a step that the scheme takes")
}

/// The maps of a cell as they follow from its states: peak thickness, peak speed, arrival, stop.
#[derive(Clone, Copy)]
struct Seen([f32; 4]);

impl Seen {
    fn take(&mut self, thickness: f64, speed: f64, time: f64) {
        let Seen([peak, fastest, arrival, stop]) = self;
        if thickness > THRESHOLD {
            *peak = peak.max(thickness as f32);
            *fastest = fastest.max(speed as f32);
            *arrival = arrival.min(time as f32);
            *stop = if speed > 0.0 { time as f32 } else { *stop };
        }
    }
}

#[test]
fn a_cell_counts_in_the_states_in_which_it_is_thicker_than_the_threshold() {
    let mut run = block_behind_a_film();
    run.keep_maps(THRESHOLD);
    assert_eq!(run.maps().map(granflow_engine::Maps::threshold), Some(THRESHOLD));
    let count = run.grid().count();
    let (mut seen, mut fastest_film) = (vec![Seen([f32::NAN; 4]); count], 0.0_f64);
    let mut look = |run: &Simulation<2, Kinetic>, seen: &mut [Seen]| {
        for (number, seen) in seen.iter_mut().enumerate() {
            let watch = run.diagnostics(run.grid().index(number));
            let speed = watch.speed_squared.sqrt();
            seen.take(watch.thickness, speed, run.time());
            if watch.thickness <= THRESHOLD {
                fastest_film = fastest_film.max(speed);
            }
        }
    };
    look(&run, &mut seen);
    for _ in 0..60 {
        run.advance(f64::INFINITY).expect("finite");
        look(&run, &mut seen);
    }
    let layout = *run.layout();
    for (k, (name, map)) in run.maps().expect("kept from the start").named().enumerate() {
        let bits = |values: Vec<f64>| values.into_iter().map(f64::to_bits).collect::<Vec<_>>();
        let expected = seen.iter().map(|Seen(cell)| f64::from(cell[k])).collect();
        assert!(bits(layout.unpadded(map)) == bits(expected), "{name}");
    }
    let late = seen.iter().filter(|Seen([_, _, arrival, _])| *arrival > 0.0).count();
    let never = seen.iter().filter(|Seen(cell)| cell.iter().all(|value| value.is_nan())).count();
    assert!(late > 50 && never > count / 3, "{late} cells were reached, {never} never");
    let fastest = seen.iter().fold(0.0_f32, |most, Seen([_, speed, ..])| most.max(*speed));
    assert!(fastest > 0.0 && 2.0 * f64::from(fastest) < fastest_film, "{fastest}, film {fastest_film}");
}

#[test]
fn the_threshold_changes_nothing_of_what_is_computed() {
    let runs = [0.0, THRESHOLD, 10.0].map(|threshold| {
        let mut run = block_behind_a_film();
        run.keep_maps(threshold);
        for _ in 0..30 {
            run.advance(f64::INFINITY).expect("finite");
        }
        run
    });
    let [all, some, none] = &runs;
    for run in [some, none] {
        assert_eq!(run.arrays().components(), all.arrays().components());
        assert_eq!(run.time(), all.time());
    }
    let empty = |run: &Simulation<2, Kinetic>| {
        run.maps()
            .into_iter()
            .flat_map(granflow_engine::Maps::named)
            .all(|(_, map)| map.iter().all(|v| v.is_nan()))
    };
    assert!(empty(none) && !empty(some));
}
