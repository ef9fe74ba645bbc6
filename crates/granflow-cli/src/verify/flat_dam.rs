//! The dam break on the flat with friction (E).

use granflow::savage_hutter::Flow as State;
use granflow::savage_hutter::exact::FlatDamBreak;
use granflow::savage_hutter::ground::Chute;
use granflow::scheme::Boundary;

use super::benchmark::Benchmark;
use super::convergence::{Bound, Flow, Most, Over, Solved};
use super::planes::{KINKS, SCALED, curves, errors, places};
use super::scheme::Scheme::{Balanced, Balanced2, EnergyStable, EnergyStable2};
use super::scheme::{Scheme, Setting, depths, failed, line, on_plane, until};
use crate::failure::Failure;

/// The benchmark of this file.
pub const BENCHMARK: Benchmark = Benchmark {
    name: "E",
    title: "Dam break on the flat with friction",
    about: "h = 1 at x < 0 on a horizontal bed, μ = 0.5, scaled (β = 1); at t = 2. Exact: Kerswell 2005, by characteristics; \
            the front has come to 2t - μt²/2 = 3. The vanishing tip converges slowly: compared is the place where h = 0.01.",
    pieces: |size| FLOW_E.pieces(size),
    curves: curves(
        SCALED,
        "Depth at t = 2 √(L/g) on the finest grid; the exact line is known from h = 0.01 to 0.95.",
    ),
    errors: errors("L", "error of the place where h = 0.01", "L"),
};

const FIRST_TIP: Most = Most::Fixed(
    0.11,
    "a sixth of the 0.6 from the contour to the exact front: a first-order scheme lets the tip lag",
);
const SECOND_TIP: Most = Most::Fixed(0.03, "a twentieth of the 0.6 from the contour to the exact front");

const FLOW_E: Flow = Flow {
    coarsest: 1600,
    grids: 4,
    quantity: "place of h = 0.01, off by / L",
    formal: KINKS,
    over: Over::Finest,
    bounds: &[
        Bound { scheme: EnergyStable, most: FIRST_TIP, order: Some(0.6) },
        Bound { scheme: EnergyStable2, most: SECOND_TIP, order: Some(0.9) },
        Bound { scheme: Balanced, most: FIRST_TIP, order: Some(0.6) },
        Bound { scheme: Balanced2, most: SECOND_TIP, order: Some(0.9) },
    ],
    solve: flat_dam,
};

fn flat_dam(scheme: Scheme, cells: usize) -> Result<Solved, Failure> {
    let (mu, contour) = (0.5, 0.01);
    let exact = FlatDamBreak::new(mu).map_err(failed)?;
    let place = |h: f64| exact.contour(h, 2.0).map(|contour| contour.x);
    let domain = line([-10.0, 6.0], cells, Boundary::Open);
    let ground = Chute { tilt: [0.0], beta: 1.0, cos: 1.0, curvature: 0.0 };
    let start = |[x]: [f64; 1]| State::still(if x < 0.0 { 1.0 } else { 0.0 });
    let mut run = on_plane(Setting::coulomb(scheme, mu, 1e-12), domain, ground, start)?;
    until(&mut *run, 2.0)?;
    let h = depths(&*run);
    let last = h.iter().rposition(|h| *h >= contour).unwrap_or(0);
    let share = (h[last] - contour) / (h[last] - h[last + 1]);
    let size = domain.size[0];
    let found = domain.centre([last])[0] + share * size;
    let error = place(contour).map_or(f64::NAN, |exact| (found - exact).abs());
    let known: (Vec<f64>, Vec<f64>) =
        (1..=95).map(|k| f64::from(k) / 100.0).filter_map(|h| Some((place(h)?, h))).unzip();
    Ok(Solved { error, one_cell: size, size, section: [places(&run), h], exact: [known.0, known.1] })
}
