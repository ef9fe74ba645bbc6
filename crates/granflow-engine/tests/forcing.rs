//! A source that moves wakes the tiles that it touches, and no result notices that the others sleep.

use granflow_engine::grid::Grid;
use granflow_engine::simulation::{Simulation, StepSize};
use granflow_model::hadeler_kuttler::scheme::{ADAPTIVE, FIRST_ORDER, HadelerKuttler};
use granflow_model::hadeler_kuttler::table::Table;
use granflow_model::hadeler_kuttler::{Pile, Source};
use granflow_model::scheme::Boundary;

const CELLS: [usize; 2] = [140, 90];
const SIZE: f64 = 0.01;

fn empty(scheme: HadelerKuttler, table: &Table<2>) -> Simulation<2, HadelerKuttler> {
    let grid = Grid {
        cells: table.nodes(),
        origin: [0.0; 2],
        size: [SIZE; 2],
        boundary: [[Boundary::Absorbing; 2]; 2],
    };
    let ground = |index| table.ground(index, 0.0);
    let step = StepSize::Courant(0.4);
    Simulation::new(scheme, grid, step, ground, |_| Pile { u: 0.0, v: 0.0 }).expect("a step that it takes")
}

/// A disc that goes along the table with speed 1.
fn pour(run: &mut Simulation<2, HadelerKuttler>, table: &Table<2>) {
    let middle = [0.2 + run.time(), 0.45];
    run.apply(|index, _| {
        let away = (0..2).map(|k| ((index[k] as f64 + 0.5) * SIZE - middle[k]).powi(2)).sum::<f64>();
        table.source(index, if away < 0.05 * 0.05 { [0.3, 0.2] } else { [0.0; 2] })
    });
}

#[test]
fn a_moving_source_wakes_the_tiles_that_it_touches() {
    let table = Table::rectangle(CELLS, [[true; 2]; 2]);
    for scheme in [FIRST_ORDER, ADAPTIVE] {
        let (mut some, mut all) = (empty(scheme, &table), empty(scheme, &table));
        assert_eq!(some.supply(), 0.0);
        for _ in 0..60 {
            for run in [&mut some, &mut all] {
                pour(run, &table);
            }
            all.wake_all();
            assert_eq!(some.advance(f64::INFINITY), all.advance(f64::INFINITY));
            assert_eq!(some.supply(), all.supply());
        }
        assert_eq!(some.arrays().components(), all.arrays().components());
        assert_eq!((some.poured(), some.out()), (all.poured(), all.out()));
        let share = some.updates() as f64 / all.updates() as f64;
        assert!((0.02..0.3).contains(&share), "{share} of the cells were computed");
        // The supply is the sum over all cells in their order, however it was found.
        let mut sum = granflow_model::real::CompensatedSum::default();
        (0..some.grid().count()).for_each(|number| sum.add(some.forcing(some.grid().index(number)).rate()));
        assert_eq!(some.supply(), sum.value() * some.grid().measure());
    }
}

#[test]
fn a_forcing_that_stays_the_same_wakes_nothing() {
    let table = Table::rectangle(CELLS, [[true; 2]; 2]);
    let mut run = empty(FIRST_ORDER, &table);
    run.advance(f64::INFINITY).unwrap();
    assert!(run.at_rest());
    run.apply(|_, source| source);
    assert!(run.at_rest());
    run.apply(|index, source| if index == [70, 45] { table.source(index, [0.1; 2]) } else { source });
    assert!(!run.at_rest() && run.supply() == 0.2 * SIZE * SIZE);
    let before = run.updates();
    run.advance(f64::INFINITY).unwrap();
    assert!(run.updates() - before <= 9 * 21 * 12, "a tile and its neighbours");
    run.apply(|_, _| Source::none());
    assert_eq!(run.supply(), 0.0);
}
