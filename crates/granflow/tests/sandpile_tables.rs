//! The one-dimensional tables of Aggarwal, Veerappa Gowda & Sudarshan Kumar (2023).

use granflow::grid::Grid;
use granflow::hadeler_kuttler::scheme::{ADAPTIVE, FIRST_ORDER, HadelerKuttler, SECOND_ORDER, Slopes};
use granflow::hadeler_kuttler::{Ground, Pile};
use granflow::scheme::Boundary;
use granflow::simulation::{Simulation, StepSize};
use granflow::time::{EULER, SSP_RK2, Stages};

fn stages(scheme: HadelerKuttler) -> Stages {
    if scheme.slopes == Slopes::None { EULER } else { SSP_RK2 }
}

/// [0, 1] open at both ends.
fn line(
    n: usize,
    scheme: HadelerKuttler,
    f: f64,
    lambda: f64,
    u: impl Fn(f64) -> f64,
    v: impl Fn(f64) -> f64,
) -> Simulation<1, HadelerKuttler> {
    let h = 1.0 / n as f64;
    let grid = Grid { cells: [n + 1], origin: [0.0], size: [h], boundary: [[Boundary::Nothing; 2]] };
    let ground = |[i]: [usize; 1]| {
        let inside = if i < n { 1.0 } else { 0.0 };
        let weight = if i == 0 || i == n { 0.0 } else { 1.0 };
        Ground { source: [f * inside], bed: 0.0, inside, weight, wall: [0.0], hole: 0.0 }
    };
    let state = |[i]: [usize; 1]| Pile {
        u: if i == 0 || i == n { 0.0 } else { u(i as f64 * h) },
        v: if i < n { v((i as f64 + 0.5) * h) } else { 0.0 },
    };
    Simulation::new(scheme, grid, stages(scheme), StepSize::Fixed(lambda * h), ground, state)
}

fn errors(run: &Simulation<1, HadelerKuttler>, u: impl Fn(f64) -> f64, v: impl Fn(f64) -> f64) -> [f64; 2] {
    let n = run.grid().cells[0] - 1;
    let h = 1.0 / n as f64;
    let sup = (0..=n).fold(0.0_f64, |m, i| m.max((run.state([i]).u - u(i as f64 * h)).abs()));
    let l1: f64 = (0..n).map(|i| (run.state([i]).v - v((i as f64 + 0.5) * h)).abs() * h).sum();
    [sup, l1]
}

#[test]
fn table_2() {
    let (u, v) = (|x: f64| x.min(1.0 - x), |x: f64| 0.5 * (x - 0.5).abs());
    for (name, scheme) in [("FO", FIRST_ORDER), ("SO", SECOND_ORDER), ("SOT", ADAPTIVE)] {
        for n in [50, 100, 200, 400] {
            let mut run = line(n, scheme, 0.5, 0.45, u, v);
            run.advance(f64::INFINITY).unwrap();
            println!("{name} {n} {:?}", errors(&run, u, v));
        }
    }
}

#[test]
fn table_1() {
    let zero = |_| 0.0;
    let t: f64 = 1.2;
    let m = 10240;
    let start = std::time::Instant::now();
    let mut fine = line(m, SECOND_ORDER, 0.5, 0.1, zero, zero);
    while fine.time() < t {
        fine.advance(t).unwrap();
    }
    println!("reference {:?}", start.elapsed());
    let adaptive3 = HadelerKuttler { slopes: Slopes::Adaptive { exponent: 3.0 } };
    for (name, scheme) in [("FO", FIRST_ORDER), ("SO", SECOND_ORDER), ("SOT2", ADAPTIVE), ("SOT3", adaptive3)]
    {
        for n in [40, 80, 160, 320, 640] {
            let mut run = line(n, scheme, 0.5, 0.1, zero, zero);
            while run.time() < t {
                run.advance(t).unwrap();
            }
            let per = m / n;
            let sup = (0..=n).fold(0.0_f64, |s, i| s.max((run.state([i]).u - fine.state([i * per]).u).abs()));
            let l1: f64 = (0..n)
                .map(|i| {
                    let mean: f64 = (0..per).map(|k| fine.state([i * per + k]).v).sum::<f64>() / per as f64;
                    (run.state([i]).v - mean).abs() / n as f64
                })
                .sum();
            println!("{name} {n} {sup:.4} {l1:.4}");
        }
    }
}

#[test]
fn iterations() {
    let zero = |_| 0.0;
    let (ub, vb) = (|x: f64| x.min(1.0 - x), |x: f64| 0.5 * (x - 0.5).abs());
    let adaptive3 = HadelerKuttler { slopes: Slopes::Adaptive { exponent: 3.0 } };
    for (name, scheme) in [("FO", FIRST_ORDER), ("SO", SECOND_ORDER), ("SOT2", ADAPTIVE), ("SOT3", adaptive3)]
    {
        let mut run = line(50, scheme, 0.5, 0.45, zero, zero);
        let (mut first_u, mut last_v) = (0, 0);
        let mut e = [1.0; 2];
        for k in 1..=(60.0 / 0.009) as usize {
            run.advance(f64::INFINITY).unwrap();
            e = errors(&run, ub, vb);
            if e[0] < 1e-3 && first_u == 0 {
                first_u = k;
            }
            if e[1] >= 1e-4 {
                last_v = k;
            }
            if k % 500 == 0 {
                print!("{:.1e}/{:.1e} ", e[0], e[1]);
            }
        }
        println!(
            "\n{name}: u<1e-3 at {first_u}, v<1e-4 for good after {last_v}, at T=60 {e:?} drift {:?}",
            run.drift()
        );
    }
}

#[test]
#[ignore]
fn search() {
    let zero = |_| 0.0;
    let (ub, vb) = (|x: f64| x.min(1.0 - x), |x: f64| 0.5 * (x - 0.5).abs());
    for (n, f, lambda) in [(50, 0.5, 0.45), (100, 0.5, 0.45), (200, 0.5, 0.45), (50, 1.0, 0.45)] {
        println!("n {n} f {f} lambda {lambda}");
        let mut list = vec![("FO".to_string(), FIRST_ORDER)];
        for m in [2.0, 2.25, 2.5, 2.6, 2.75, 3.0] {
            list.push((format!("m={m}"), HadelerKuttler { slopes: Slopes::Adaptive { exponent: m } }));
        }
        for (name, scheme) in list {
            let mut run = line(n, scheme, f, lambda, zero, zero);
            let mut first_u = [0; 2];
            let mut last_v = [0; 4];
            let (mut least, mut rise) = (f64::INFINITY, 1.0_f64);
            for k in 1..=(80.0 / lambda * n as f64 / (f * 2.0)) as usize {
                if run.advance(f64::INFINITY).is_err() {
                    println!("too long");
                    break;
                }
                let e = errors(&run, ub, |x| vb(x) * f * 2.0);
                for (first, bound) in first_u.iter_mut().zip([1e-3, 1e-4]) {
                    if e[0] < bound && *first == 0 {
                        *first = k;
                    }
                }
                for (last, bound) in last_v.iter_mut().zip([1e-3, 1e-4, 1e-5, 1e-6]) {
                    if e[1] >= bound * f * 2.0 {
                        *last = k;
                    }
                }
                if e[1] < 1e-3 {
                    least = least.min(e[1]);
                    rise = rise.max(e[1] / least);
                }
                if e[1] < 1e-7 {
                    break;
                }
            }
            println!(
                "{name}: u<1e-3,4 at {first_u:?}, v<1e-3,4,5,6 for good after {last_v:?}, v rises by {rise:.2}"
            );
        }
    }
}
