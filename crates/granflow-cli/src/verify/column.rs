//! A granular column that collapses on a horizontal plane, in the scaling of the laboratory (L).

use granflow::output::figures::{Axis, Style};
use granflow::output::tables::{Expected, Measure};
use granflow::savage_hutter::Flow;
use granflow::scheme::Boundary;

use super::benchmark::{Benchmark, Check, Finding, Line, Piece, Size, View};
use super::scheme::{RESTING, Scheme, Setting, depths, failed, grid, incline, on_plane};
use crate::failure::Failure;

/// The benchmark of this file.
pub const BENCHMARK: Benchmark = Benchmark {
    name: "L",
    title: "Collapse of a round column",
    about: "A column of radius 1 m and height a, a = 0.25, 0.5, 0.75, on a horizontal plane, μ = 0.6 (sand, 31°), to its rest. Known \
            from the laboratory: (r∞ - r0)/r0 = 1.24 a for a < 1.7 (Lube, Huppert, Sparks & Hallworth 2004). Depth-averaged equations leave out \
            the vertical acceleration and run too far: the measured factor is reported, not tuned. r∞ is where 1 % of the height is left.",
    pieces: |size| RESTING.map(|scheme| Piece::new(scheme.name(), move || collapse(scheme, size))).into(),
    curves: Some(View {
        x: Axis::new("distance from the axis r", "m"),
        y: Axis::new("depth of the deposit h", "m"),
        caption: "Deposit of the column a = 0.5 along x; the dashed line is the column.",
    }),
    errors: None,
};

const MU: f64 = 0.6;

fn collapse(scheme: Scheme, size: Size) -> Result<Finding, Failure> {
    // A quarter of it, between two planes of symmetry.
    let (cells, reach) = (if size == Size::Full { 160 } else { 80 }, 3.2);
    let mut finding = Finding::default();
    for a in [0.25, 0.5, 0.75] {
        let mut sheet = grid([cells; 2], [0.0; 2], reach / cells as f64, Boundary::Open);
        sheet.boundary = [[Boundary::Wall, Boundary::Open]; 2];
        let column = |[x, y]: [f64; 2]| Flow::still(if x.hypot(y) < 1.0 { a } else { 0.0 });
        let mut run = on_plane(Setting::coulomb(scheme, MU, 1e-6), sheet, incline(0.0), column)?;
        while !run.at_rest() {
            run.advance(20.0).map_err(failed)?;
            if run.time() >= 20.0 {
                break;
            }
        }
        let row: Vec<f64> = depths(&*run).into_iter().take(cells).collect();
        let rim =
            row.iter().rposition(|h| *h > 0.01 * a).map_or(f64::NAN, |i| (i + 1) as f64 * sheet.size[0]);
        finding.checks.push(Check {
            quantity: format!("(r∞ - r0)/(r0 a), a = {a}"),
            expected: Expected::Published(1.24),
            computed: (rim - 1.0) / a,
            measure: Measure::Relative,
            tolerance: 1.0,
            reason: "nothing is tuned: a depth-averaged front runs up to 2 h/μ (E), a factor of 3.3, where the wall of grains in the \
                     laboratory falls first; within a factor of two"
                .into(),
        });
        finding.checks.push(Check::error(
            format!("speed at the end / (m/s), a = {a}"),
            if run.at_rest() { run.speed() } else { f64::NAN },
            0.0,
            "the deposit rests exactly within 20 s",
        ));
        if a == 0.5 {
            let x: Vec<f64> = (0..cells).map(|i| (i as f64 + 0.5) * sheet.size[0]).collect();
            finding.curves = vec![Line { name: scheme.name().into(), x, y: row, style: Style::Solid }];
            let (x, y) = (vec![0.0, 1.0, 1.0], vec![a, a, 0.0]);
            finding.exact = Some(Line { name: "column".into(), x, y, style: Style::Dashed });
        }
    }
    Ok(finding)
}
