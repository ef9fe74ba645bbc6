//! The benchmarks with known answers: three resolutions each, errors and orders as rows of data with their bounds.
//! `cargo test --release --test benchmarks -- --nocapture` prints the verification table.

use super::support::{
    GRAVITY, ORDERS, Order, Surface, Tried, alone, depths, grid, incline, line, lost, on_plane, plane, run,
    states, steps, terrain, until,
};
use granflow::grid::Grid;
use granflow::kernels::Kernel;
use granflow::savage_hutter::Flow;
use granflow::savage_hutter::exact::{
    CapRelease, FlatDamBreak, Flow1, GranularJump, ParabolicCap, Riemann, SimilarityCap, SlidingSlab,
    SlopeDamBreak, ThackerParaboloid,
};
use granflow::savage_hutter::ground::{Bed, Chute};
use granflow::scheme::Boundary;
use granflow::simulation::{Simulation, StepSize};

/// One row of the verification table.
struct Row {
    name: &'static str,
    /// Cells of the three grids, each twice as fine as the one before.
    cells: [usize; 3],
    /// Error of a run with so many cells.
    error: fn(Order, usize) -> f64,
    /// Largest error on the finest grid, of `balanced`, `balanced_2`, `energy_stable` and `energy_stable_2`.
    most: [f64; 4],
    /// Least observed order between the two finest grids, of `balanced`, `balanced_2`, `energy_stable` and `energy_stable_2`.
    rate: [f64; 4],
}

const TABLE: &[Row] = &[
    Row {
        name: "A Riemann, L1(h)",
        cells: [400, 800, 1600],
        error: riemann,
        most: [0.012, 0.0025, 0.0085, 0.004],
        rate: [0.6, 0.9, 0.6, 0.6],
    },
    Row {
        name: "B cap, chute, rel. L1(h)",
        cells: [400, 800, 1600],
        error: cap_on_chute,
        most: [0.0033, 8e-5, 0.0033, 8e-5],
        rate: [0.95, 1.6, 0.95, 1.6],
    },
    Row {
        name: "B cap, terrain, rel. L1(h)",
        cells: [400, 800, 1600],
        error: cap_on_terrain,
        most: [0.0033, 8e-5, 0.0033, 8e-5],
        rate: [0.95, 1.6, 0.95, 1.6],
    },
    // Its exact solution is that of a linearised lateral friction: at second order 0.5 % of the model remain.
    Row {
        name: "C cap 2-D, rel. L1(h)",
        cells: [60, 120, 240],
        error: cap_in_two_dimensions,
        most: [0.015, 0.006, 0.015, 0.01],
        rate: [0.8, f64::NEG_INFINITY, 0.75, f64::NEG_INFINITY],
    },
    Row {
        name: "D dam on slope, chute, L1(h)",
        cells: [250, 500, 1000],
        error: dam_on_chute,
        most: [0.2, 0.03, 0.15, 0.045],
        rate: [0.6, 0.9, 0.6, 0.9],
    },
    Row {
        name: "D dam on slope, terrain, L1(h)",
        cells: [250, 500, 1000],
        error: dam_on_terrain,
        most: [0.2, 0.03, 0.15, 0.045],
        rate: [0.6, 0.9, 0.6, 0.9],
    },
    Row {
        name: "E dam on flat, contour 0.01",
        // The contour of `energy_stable` crosses the exact one on coarser grids.
        cells: [1600, 3200, 6400],
        error: flat_dam,
        most: [0.11, 0.03, 0.11, 0.03],
        rate: [0.6, 0.9, 0.6, 0.9],
    },
    Row {
        name: "I Ritter, L1(h)",
        cells: [200, 400, 800],
        error: ritter,
        most: [0.025, 0.003, 0.02, 0.007],
        rate: [0.6, 0.9, 0.6, 0.9],
    },
    Row {
        name: "I Stoker, L1(h)",
        cells: [200, 400, 800],
        error: stoker,
        most: [0.025, 0.006, 0.02, 0.009],
        rate: [0.6, 0.8, 0.6, 0.8],
    },
    Row {
        name: "I Thacker, terrain, rel. L1(h)",
        cells: [25, 50, 100],
        error: thacker,
        most: [0.03, 0.007, 0.05, 0.011],
        rate: [0.75, 1.3, 0.75, 1.3],
    },
    Row {
        name: "J granular jump, L1(h)",
        cells: [200, 400, 800],
        error: jump,
        most: [0.007, 0.005, 0.007, 0.006],
        rate: [0.6, 0.6, 0.6, 0.5],
    },
];

#[test]
fn every_benchmark_converges_to_its_exact_solution() {
    let mut broken = String::new();
    println!("{:32} {:7} {:>10} {:>10} {:>10} {:>7}", "", "order", "coarse", "middle", "fine", "rate");
    for row in TABLE {
        for order in ORDERS {
            let k = order.row();
            let [coarse, middle, fine] = row.cells.map(|cells| alone(|| (row.error)(order, cells)));
            let rate = (middle / fine).log2();
            println!("{:32} {order:7?} {coarse:10.3e} {middle:10.3e} {fine:10.3e} {rate:7.2}", row.name);
            if !(fine <= row.most[k] && rate >= row.rate[k]) {
                broken += &format!(
                    "{} {order:?}: error {fine:.3e} (at most {}), rate {rate:.2} (at least {})\n",
                    row.name, row.most[k], row.rate[k]
                );
            }
        }
    }
    assert!(broken.is_empty(), "\n{broken}");
}

/// sum |h - exact| dx over the grid.
fn l1<S: Kernel<1, State = Flow<1, f64>>>(run: &Simulation<1, S>, exact: impl Fn(f64) -> f64) -> f64 {
    let apart =
        depths(run).into_iter().enumerate().map(|(i, h)| (h - exact(run.grid().centre([i])[0])).abs());
    apart.sum::<f64>() * run.grid().size[0]
}

fn flow(Flow1 { h, u }: Flow1) -> Flow<1, f64> {
    Flow { h, q: [h * u] }
}

/// A Riemann problem without friction or slope from -5 to 5, at time 5 in the scaling of beta.
fn two_states(order: Order, cells: usize, beta: f64, exact: &Riemann, end: f64) -> f64 {
    let ground = plane([0.0], beta);
    let mut run = on_plane(
        order,
        (0.0, 0.0),
        order.courant(),
        line(-5.0, 5.0, cells, Boundary::Open),
        ground,
        |[x]| flow(exact.flow(x, 0.0)),
    );
    until(&mut run, end);
    l1(&run, |x| exact.flow(x, end).h)
}

fn riemann(order: Order, cells: usize) -> f64 {
    two_states(order, cells, 0.4, &Riemann::stoker(0.4, 1.0, 0.5).expect("wet"), 5.0)
}

fn ritter(order: Order, cells: usize) -> f64 {
    two_states(order, cells, GRAVITY, &Riemann::ritter(GRAVITY, 1.0).expect("wet"), 0.7)
}

fn stoker(order: Order, cells: usize) -> f64 {
    two_states(order, cells, GRAVITY, &Riemann::stoker(GRAVITY, 1.0, 0.1).expect("wet"), 1.0)
}

fn jump(order: Order, cells: usize) -> f64 {
    let zeta = 30.0_f64.to_radians();
    let ground = incline::<1>(zeta);
    let exact = GranularJump::new(ground.beta, Flow1 { h: 0.3, u: 6.0 }, 1.0).expect("a jump");
    let mut run = on_plane(
        order,
        (zeta.tan(), 0.0),
        order.courant(),
        line(-5.0, 5.0, cells, Boundary::Open),
        ground,
        |[x]| flow(exact.flow(x, 0.0)),
    );
    until(&mut run, 1.0);
    l1(&run, |x| exact.flow(x, 1.0).h)
}

/// Terrain that falls to larger x by the angle `zeta`; lengths along the bed are x/cos(zeta).
fn slope<const D: usize>(zeta: f64) -> impl Fn([f64; D]) -> Option<Surface<D>> {
    move |x| {
        let mut slope = [0.0; D];
        slope[0] = -zeta.tan();
        Some(Surface { z: 1000.0 - zeta.tan() * x[0], slope, bent: [[0.0; D]; D] })
    }
}

/// A run on that terrain from a flow given along the bed, and its L1 error along the bed.
fn down_the_terrain(
    order: Order,
    (mu, zeta): (f64, f64),
    [from, to]: [f64; 2],
    cells: usize,
    end: f64,
    exact: impl Fn(f64, f64) -> Flow1 + Sync,
) -> f64 {
    let cos = zeta.cos();
    let grid = line(from * cos, to * cos, cells, Boundary::Absorbing);
    let grounds = terrain(&grid, slope(zeta));
    let mut run = run(order, (mu, 1e-9), order.courant(), grid, &grounds, |[x], _| {
        let Flow1 { h, u } = exact(x / cos, 0.0);
        Flow { h: h / cos, q: [h / cos * u * cos] }
    });
    until(&mut run, end);
    l1(&run, |x| exact(x / cos, end).h / cos) // dx shorter, H larger: the same area
}

fn release() -> CapRelease {
    CapRelease {
        height: 4.0,
        length: 80.0,
        slope: 35.0_f64.to_radians(),
        friction: 25.0_f64.to_radians(),
        earth_pressure: 1.0,
        gravity: GRAVITY,
    }
}

/// Area of the parabolic cap, 4 H L/3.
const CAP: f64 = 4.0 * 4.0 * 80.0 / 3.0;

fn cap_on_chute(order: Order, cells: usize) -> f64 {
    let exact = ParabolicCap::new(release()).expect("it slides");
    let mu = release().friction.tan();
    let domain = line(-120.0, 200.0, cells, Boundary::Open);
    let mut run = on_plane(order, (mu, 1e-9), order.courant(), domain, incline(release().slope), |[x]| {
        flow(exact.flow(x, 0.0))
    });
    until(&mut run, 5.0);
    l1(&run, |x| exact.flow(x, 5.0).h) / CAP
}

fn cap_on_terrain(order: Order, cells: usize) -> f64 {
    let exact = ParabolicCap::new(release()).expect("it slides");
    let laws = (release().friction.tan(), release().slope);
    down_the_terrain(order, laws, [-120.0, 200.0], cells, 5.0, |x, t| exact.flow(x, t)) / CAP
}

fn cap_in_two_dimensions(order: Order, cells: usize) -> f64 {
    let exact = SimilarityCap::new(release(), 80.0, 1.0).expect("it slides");
    let mu = release().friction.tan();
    let size = 240.0 / cells as f64;
    let sheet = grid([cells, cells], [-95.0, -120.0], size, Boundary::Open);
    let start = exact.at(0.0);
    let mut run = on_plane(order, (mu, 1e-9), order.courant(), sheet, incline(release().slope), |[x, y]| {
        Flow::still(start.flow(x, y).h)
    });
    until(&mut run, 5.0);
    let end = exact.at(5.0);
    let (mut apart, mut moment, mut mass) = (0.0, 0.0, 0.0);
    for (number, h) in depths(&run).into_iter().enumerate() {
        let [x, y] = sheet.centre(sheet.index(number));
        apart += (h - end.flow(x, y).h).abs();
        moment += h * x;
        mass += h;
    }
    // Only the lateral part is linearised; Euler's method lags by half a step.
    assert!((moment / mass - 23.49490).abs() < 0.3 * size.max(1.0), "centre at {}", moment / mass);
    apart / mass
}

fn dam() -> (SlopeDamBreak, f64, f64) {
    let (zeta, delta) = (22.0_f64.to_radians(), 21.0_f64.to_radians());
    (SlopeDamBreak::new(GRAVITY, 1.0, zeta, delta, 1.0).expect("it slides"), zeta, delta.tan())
}

fn dam_on_chute(order: Order, cells: usize) -> f64 {
    let (exact, zeta, mu) = dam();
    let domain = line(-60.0, 60.0, cells, Boundary::Open);
    let mut run =
        on_plane(order, (mu, 1e-9), order.courant(), domain, incline(zeta), |[x]| flow(exact.flow(x, 0.0)));
    until(&mut run, 5.0);
    l1(&run, |x| exact.flow(x, 5.0).h)
}

/// As on the chute, with an end of the slab far upstream of what is compared.
fn dam_on_terrain(order: Order, cells: usize) -> f64 {
    let (exact, zeta, mu) = dam();
    let cos = zeta.cos();
    let grid = line(-60.0 * cos, 60.0 * cos, cells, Boundary::Wall);
    let grounds = terrain(&grid, slope(zeta));
    let mut run = run(order, (mu, 1e-9), order.courant(), grid, &grounds, |[x], _| {
        Flow::still(exact.flow(x / cos, 0.0).h / cos)
    });
    until(&mut run, 5.0);
    let apart = depths(&run).into_iter().enumerate().map(|(i, h)| {
        let x = grid.centre([i])[0] / cos;
        if x < -30.0 { 0.0 } else { (h * cos - exact.flow(x, 5.0).h).abs() }
    });
    apart.sum::<f64>() * grid.size[0] / cos
}

fn flat_dam(order: Order, cells: usize) -> f64 {
    let mu = 0.5;
    let exact = FlatDamBreak::new(mu).expect("friction").contour(0.01, 2.0).expect("resolved").x;
    let domain = line(-10.0, 6.0, cells, Boundary::Open);
    let start = |[x]: [f64; 1]| Flow::still(if x < 0.0 { 1.0 } else { 0.0 });
    let ground = Chute { tilt: [0.0], beta: 1.0, cos: 1.0, curvature: 0.0 };
    let mut run = on_plane(order, (mu, 1e-12), order.courant(), domain, ground, start);
    until(&mut run, 2.0);
    let h = depths(&run);
    let last = h.iter().rposition(|h| *h >= 0.01).expect("some mass");
    let share = (h[last] - 0.01) / (h[last] - h[last + 1]);
    (domain.centre([last])[0] + share * domain.size[0] - exact).abs()
}

fn thacker(order: Order, cells: usize) -> f64 {
    let exact = ThackerParaboloid::new(GRAVITY, 1.0, 0.5, 1e-4).expect("a lake");
    let sheet = grid([cells; 2], [-2.0; 2], 4.0 / cells as f64, Boundary::Absorbing);
    let bend = 2e-4;
    let grounds = terrain(&sheet, |[x, y]| {
        Some(Surface { z: exact.bed(x, y), slope: [bend * x, bend * y], bent: [[bend, 0.0], [0.0, bend]] })
    });
    let mut run = run(order, (0.0, 1e-12), order.courant(), sheet, &grounds, |[x, y], _| {
        let now = exact.flow(x, y, 0.0);
        Flow { h: now.h, q: [now.h * now.u, now.h * now.v] }
    });
    let before = run.totals().volume;
    until(&mut run, exact.period());
    assert!(lost(&run, before).abs() < 1e-12);
    let (mut apart, mut mass) = (0.0, 0.0);
    for (number, h) in depths(&run).into_iter().enumerate() {
        let [x, y] = sheet.centre(sheet.index(number));
        apart += (h - exact.flow(x, y, exact.period()).h).abs();
        mass += h;
    }
    apart / mass
}

/// Averages of a fine grid over the cells of one half as fine.
fn halved<const D: usize>(fine: &[Flow<D, f64>], grid: &Grid<D>) -> Vec<f64> {
    let coarse = Grid { cells: grid.cells.map(|n| n / 2), ..*grid };
    let corners = 1 << D;
    let mut means = vec![0.0; coarse.count()];
    for (number, flow) in fine.iter().enumerate() {
        let index = grid.index(number);
        let place = (0..D).rev().fold(0, |place, k| place * coarse.cells[k] + index[k] / 2);
        means[place] += flow.h / f64::from(corners);
    }
    means
}

/// Observed order from runs on four grids: the differences of neighbouring grids, the finest two.
fn smooth_order<const D: usize>(runs: [(Vec<Flow<D, f64>>, Grid<D>); 4]) -> f64 {
    let apart: Vec<f64> = runs
        .windows(2)
        .map(|pair| {
            let [(coarse, _), (fine, grid)] = pair else { unreachable!("windows of two") };
            let means = halved(fine, grid);
            coarse.iter().zip(&means).map(|(c, f)| (c.h - f).abs()).sum::<f64>() / means.len() as f64
        })
        .collect();
    println!(
        "differences {apart:.3?}, rates {:.3} {:.3}",
        (apart[0] / apart[1]).log2(),
        (apart[1] / apart[2]).log2()
    );
    (apart[1] / apart[2]).log2()
}

/// Averages over the cell of 1 + a sin(2 pi x), by two Gauss points.
fn wave(x: f64, size: f64, height: f64, phase: f64) -> f64 {
    let off = size / 12.0_f64.sqrt();
    let at = |x: f64| 1.0 + height * (std::f64::consts::TAU * x + phase).sin();
    (at(x - off) + at(x + off)) / 2.0
}

const SMOOTH: [f64; 4] = [0.95, 1.9, 0.95, 1.9];

#[test]
fn order_on_a_smooth_flow_down_an_incline() {
    for order in ORDERS {
        let k = order.row();
        let runs = [200, 400, 800, 1600].map(|cells| {
            let domain = line(0.0, 1.0, cells, Boundary::Periodic);
            let size = domain.size[0];
            let mut run = on_plane(order, (0.5, 0.0), order.courant(), domain, plane([0.3], 0.4), |[x]| {
                let h = wave(x, size, 0.2, 0.0);
                Flow { h, q: [h * (0.7 + 0.1 * wave(x, size, 1.0, 1.0))] }
            });
            alone(|| until(&mut run, 0.3));
            (states(&run), domain)
        });
        let rate = smooth_order(runs);
        assert!(rate >= SMOOTH[k], "{order:?}: {rate}");
    }
}

/// Rates of a smooth flow that turns: gravity along x, motion across it, strong friction.
fn turning<B: Bed<2, f64>>(
    order: Order,
    ground: impl Fn(&Grid<2>) -> Vec<B>,
    mu: f64,
    pace: f64,
    end: f64,
) -> f64
where
    Tried<B>: Kernel<2, State = Flow<2, f64>, Ground = B>,
{
    let runs = [48, 96, 192, 384].map(|cells| {
        let sheet = grid([cells; 2], [0.0; 2], 1.0 / cells as f64, Boundary::Periodic);
        let size = sheet.size[0];
        let mut run = run(order, (mu, 0.0), order.courant(), sheet, &ground(&sheet), |[x, y], _| {
            let h = wave(x, size, 0.1, 0.0) * wave(y, size, 0.1, 1.0);
            let u = [wave(y, size, 0.1, 0.3), 0.6 * wave(x, size, 0.1, 0.7)];
            Flow { h, q: u.map(|u| pace * h * u) }
        });
        alone(|| until(&mut run, end));
        (states(&run), sheet)
    });
    smooth_order(runs)
}

#[test]
fn order_on_a_smooth_flow_that_turns() {
    for order in ORDERS {
        let k = order.row();
        let rate = turning(order, |sheet| vec![plane([0.5, 0.0], 0.4); sheet.count()], 0.8, 1.0, 0.25);
        assert!(rate >= SMOOTH[k], "{order:?}: {rate}");
    }
}

/// A two-stage step whose last stage stops is at rest at its end, within its last step before the exact time.
fn ends_early(order: Order, u: f64, exact: f64, lost_per_step: f64) -> bool {
    order.ends_early() && u == 0.0 && exact <= lost_per_step
}

/// Benchmark F on a chute: moves until the exact time, then not at all.
#[test]
fn a_slab_stops_at_the_exact_time_and_is_then_exactly_still() {
    let (zeta, delta) = (20.0_f64.to_radians(), 30.0_f64.to_radians());
    let exact = SlidingSlab::new(GRAVITY, zeta, delta, 5.0).expect("it stops");
    for order in ORDERS {
        for step in [0.01, 0.0173, 0.1] {
            if step > 0.05 && !order.takes_long_steps() {
                continue;
            }
            let domain = line(0.0, 10.0, 40, Boundary::Periodic);
            let mut run =
                on_plane(order, (delta.tan(), 0.0), StepSize::Fixed(step), domain, incline(zeta), |_| Flow {
                    h: 1.0,
                    q: [5.0],
                });
            let name = format!("{order:?}, dt = {step}");
            let lost_per_step = exact.velocity(0.0) - exact.velocity(step);
            alone(|| {
                while run.time() < 1.5 * exact.stopping_time() {
                    steps(&mut run, 1);
                    let u = states(&run)[7].q[0];
                    let right = exact.velocity(run.time());
                    assert!(
                        (u - right).abs() < 1e-12 || ends_early(order, u, right, lost_per_step),
                        "{name}: {u} at {}",
                        run.time()
                    );
                    if run.time() > exact.stopping_time() + 1e-12 {
                        assert!(u == 0.0 && run.speed() == 0.0, "{name}: {u} at {}", run.time());
                    }
                }
            });
            assert!(depths(&run).iter().all(|h| *h == 1.0), "{name}");
        }
        println!(
            "F slab, chute, {order:?}: exact to 1e-12, 0 from the first step after {:.4} s",
            exact.stopping_time()
        );
    }
}

/// Benchmark F on terrain: the middle of a long slab, untouched by its ends.
#[test]
fn a_slab_on_terrain_stops_at_the_exact_time() {
    let (steep, delta) = (20.0_f64.to_radians().tan(), 30.0_f64.to_radians());
    for order in ORDERS {
        for angle in [0.0, 35.0_f64] {
            let (sin, cos) = angle.to_radians().sin_cos();
            let sheet = grid([121, 121], [0.0; 2], 2.0, Boundary::Absorbing);
            // A slope that a grid keeps as it is.
            let fall = [-steep * cos, -steep * sin].map(|slope| f64::from(slope as f32));
            let tan = fall[0].hypot(fall[1]);
            let (zeta, down) = (tan.atan(), fall.map(|slope| -slope / tan));
            let exact = SlidingSlab::new(GRAVITY, zeta, delta, 5.0).expect("it stops");
            let grounds = terrain(&sheet, |[x, y]| {
                Some(Surface { z: 900.0 + fall[0] * x + fall[1] * y, slope: fall, bent: [[0.0; 2]; 2] })
            });
            let mut run =
                run(order, (delta.tan(), 1e-6), StepSize::Fixed(0.03), sheet, &grounds, |_, ground| {
                    let h = 1.0 / ground.cos;
                    Flow { h, q: down.map(|n| h * 5.0 * zeta.cos() * n) }
                });
            let lost_per_step = exact.velocity(0.0) - exact.velocity(0.03);
            alone(|| {
                while run.time() < 1.2 * exact.stopping_time() {
                    steps(&mut run, 1);
                    let v = run.diagnostics([60, 60]).speed_squared.sqrt();
                    let right = exact.velocity(run.time());
                    assert!(
                        (v - right).abs() < 1e-10 || ends_early(order, v, right, lost_per_step),
                        "{order:?} {angle}: {v} at {}",
                        run.time()
                    );
                    assert!(
                        run.time() <= exact.stopping_time() || v == 0.0,
                        "{order:?} {angle}: {v} at {}",
                        run.time()
                    );
                }
            });
        }
    }
}

#[test]
fn riemann_is_monotone_at_the_published_step() {
    let case = crate::oracle::published("riemann");
    for order in ORDERS {
        let domain = line(case.x_from, case.x_to, case.cells, Boundary::Open);
        let start = |[x]: [f64; 1]| Flow::still((case.initial)(x));
        let mut run =
            on_plane(order, (0.0, 0.0), StepSize::Fixed(case.dt), domain, plane([0.0], case.eps), start);
        alone(|| steps(&mut run, 5000));
        let h = depths(&run);
        let variation: f64 = h.windows(2).map(|w| (w[1] - w[0]).abs()).sum();
        println!("Riemann, {order:?}: total variation {variation:.5}");
        assert!(variation <= order.variation(), "{order:?}: {variation}");
        let off = (order.variation() - 0.502) / 2.0 + 1e-12;
        assert!(h.iter().all(|h| (0.5 - off..=1.0 + off).contains(h)), "{order:?}");
    }
}

/// Benchmark E: the flow on the flat stops by itself, its tip (a millionth of the dam) before the exact 2/mu.
#[test]
fn the_dam_break_on_the_flat_comes_to_rest_behind_its_exact_front() {
    for order in ORDERS {
        let exact = FlatDamBreak::new(0.5).expect("friction");
        let domain = line(-10.0, 6.0, 400, Boundary::Open);
        let ground = Chute { tilt: [0.0], beta: 1.0, cos: 1.0, curvature: 0.0 };
        let start = |[x]: [f64; 1]| Flow::still(if x < 0.0 { 1.0 } else { 0.0 });
        let mut run = on_plane(order, (0.5, 1e-9), order.courant(), domain, ground, start);
        alone(|| {
            while !run.at_rest() && run.time() < 50.0 {
                steps(&mut run, 1);
            }
        });
        let tip = depths(&run).iter().rposition(|h| *h > 1e-6).expect("mass");
        let front = domain.centre([tip])[0];
        println!("E dam on flat, {order:?}: at rest after {:.3}, front {front:.3} (exact 4)", run.time());
        assert!(run.at_rest(), "{order:?}");
        assert!(front < exact.front(4.0) + 2.0 * domain.size[0] && front > 3.0, "{order:?}: {front}");
    }
}

/// A uniform flow across the slope turns into it: an ordinary differential equation, no error in space.
#[test]
fn order_in_time_of_a_slab_that_turns() {
    let (tilt, mu) = (0.5, 0.4);
    let ground = plane([tilt, 0.0], 0.4);
    let rate = |u: [f64; 2]| {
        let size = u[0].hypot(u[1]);
        [tilt - mu * ground.cos * u[0] / size, -mu * ground.cos * u[1] / size]
    };
    let mut exact = [0.1, 0.9];
    let (dt, along) = (1e-4, |u: [f64; 2], k: [f64; 2], t: f64| [u[0] + t * k[0], u[1] + t * k[1]]);
    for _ in 0..10_000 {
        let k1 = rate(exact);
        let k2 = rate(along(exact, k1, dt / 2.0));
        let k3 = rate(along(exact, k2, dt / 2.0));
        let k4 = rate(along(exact, k3, dt));
        for i in 0..2 {
            exact[i] += dt / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
    }
    for order in ORDERS {
        let k = order.row();
        let errors = [20, 40, 80, 160].map(|count| {
            let sheet = grid([4, 4], [0.0; 2], 1.0, Boundary::Periodic);
            let step = StepSize::Fixed(1.0 / f64::from(count));
            let mut run = on_plane(order, (mu, 0.0), step, sheet, ground, |_| Flow { h: 1.0, q: [0.1, 0.9] });
            alone(|| steps(&mut run, count as usize));
            let [u, v] = run.state([1, 2]).q;
            (u - exact[0]).hypot(v - exact[1])
        });
        let rate = (errors[2] / errors[3]).log2();
        println!("turning slab, {order:?}: {:.2e} to {:.2e}, order {rate:.3}", errors[0], errors[3]);
        assert!(rate >= SMOOTH[k], "{order:?}: {rate}");
    }
}
