//! A run behind `dyn Stepper` is the run itself.

use granflow_engine::grid::Grid;
use granflow_engine::simulation::{Simulation, StepSize};
use granflow_engine::{Field, Stepper};
use granflow_model::savage_hutter::Flow;
use granflow_model::savage_hutter::friction::Coulomb;
use granflow_model::savage_hutter::ground::Chute;
use granflow_model::savage_hutter::kinetic::{Kinetic, VERFAHREN_1};
use granflow_model::scheme::Boundary;

fn run<const D: usize>(cells: [usize; D]) -> Simulation<D, Kinetic> {
    let grid = Grid { cells, origin: [0.5; D], size: [0.1; D], boundary: [[Boundary::Open; 2]; D] };
    let ground = Chute { tilt: [0.1; D], beta: 0.4, cos: 0.9, curvature: 0.0 };
    let start = |index: [usize; D]| Flow { h: 1.0 + 0.1 * (index[0] % 5) as f64, q: [0.2; D] };
    Simulation::new(VERFAHREN_1.with(Coulomb { mu: 0.3 }), grid, StepSize::Courant(0.5), |_| ground, start)
        .expect("cells, and a step that the scheme takes")
}

#[test]
fn views_are_the_state_and_a_restart_goes_on_as_the_run() {
    let mut plain = run([40, 17]);
    let mut erased: Box<dyn Stepper> = Box::new(run([40, 17]));
    erased.keep_maps(0.0);
    for _ in 0..3 {
        let dt = plain.advance(f64::INFINITY).unwrap();
        assert_eq!(erased.advance(f64::INFINITY), Ok(dt));
    }
    assert_eq!((erased.steps(), erased.dimensions(), erased.components()), (3, 2, 3));
    assert_eq!((erased.cells(), erased.size()), ([40, 17], [0.1; 2]));
    let h = erased.component(0);
    for (j, row) in h.rows().enumerate() {
        for (i, value) in row.iter().enumerate() {
            assert_eq!((*value, h.get([i, j])), (plain.state([i, j]).h, *value));
        }
    }
    let saved = (erased.clock(), Field::of(erased.arrays().components().to_vec()));
    let mut again: Box<dyn Stepper> = Box::new(run([40, 17]));
    assert!(again.restore(&saved.0, saved.1));
    erased.advance(f64::INFINITY).unwrap();
    again.advance(f64::INFINITY).unwrap();
    for k in 0..3 {
        let rows = |run: &dyn Stepper| -> Vec<f64> { run.component(k).rows().flatten().copied().collect() };
        assert_eq!(rows(&*again), rows(&*erased), "component {k}");
    }
    assert_eq!((again.time(), again.outflow()), (erased.time(), erased.outflow()));
    assert!(erased.map_mut("nothing").is_none() && erased.map_mut("peak_speed").is_some());
    assert_eq!(erased.into_maps().len(), 4);
}

#[test]
fn a_line_has_one_cell_along_y() {
    let line: Box<dyn Stepper> = Box::new(run([30]));
    assert_eq!((line.cells(), line.size(), line.origin()), ([30, 1], [0.1, 1.0], [0.5, 0.0]));
    assert_eq!(line.component(1).rows().map(<[f64]>::len).collect::<Vec<_>>(), [30]);
    assert!(!run([30]).restore(&line.clock(), Field::of(vec![vec![0.0; 3]; 2])));
}
