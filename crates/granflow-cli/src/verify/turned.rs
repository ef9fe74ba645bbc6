//! The same scene turned over the grid (H).

use granflow::output::figures::Axis;
use granflow::savage_hutter::Flow;
use granflow::scheme::Boundary;

use super::benchmark::{Benchmark, Check, Errors, Finding, Piece, Size, View};
use super::scheme::{RESTING, Scheme, Setting, Surface, depths, failed, grid, lost, on_bed, terrain};
use crate::failure::Failure;

/// The benchmark of this file.
pub const BENCHMARK: Benchmark = Benchmark {
    name: "H",
    title: "Turned scene",
    about: "A cap of 3 m and radius 30 m is released on a cone-shaped mountain whose slope falls from 35° to 0 over 300 m, μ = 0.35, \
            and comes to rest; the same release 15°, 30° and 45° further around the mountain. Reach, from the axis to the farthest \
            depth above 0.05 m, and the mean distance of the mass must be the same; what differs is the grid's error and falls with it.",
    pieces: |size| RESTING.map(|scheme| Piece::new(scheme.name(), move || turn(scheme, size))).into(),
    curves: None,
    errors: Some(View {
        x: Axis::new("cell size Δx", "m"),
        y: Axis::new("largest difference of the mean distance of the mass", "m"),
        caption: "Difference between the turned scenes over cell size, both logarithmic; the grey lines have slope 1 and 2.",
    }),
};

const FOOT: f64 = 300.0;

/// A cone with its top and its foot rounded: the slope rises from 0 to tan 35° over the first 40 m and falls to 0 at the foot.
fn mountain([x, y]: [f64; 2]) -> Surface<2> {
    let (steepest, top) = (35.0_f64.to_radians().tan(), 40.0);
    let r = x.hypot(y).max(1e-9);
    // z(r), z'(r), z''(r)
    let (z, fall, bend) = if r < top {
        (500.0 - steepest * r * r / (2.0 * top), -steepest * r / top, -steepest / top)
    } else if r < FOOT {
        let (s, length) = (r - top, FOOT - top);
        let below = steepest * (s - s * s / (2.0 * length));
        (500.0 - steepest * top / 2.0 - below, -steepest * (1.0 - s / length), steepest / length)
    } else {
        (500.0 - steepest * (top + (FOOT - top)) / 2.0, 0.0, 0.0)
    };
    let (cos, sin, per) = (x / r, y / r, fall / r);
    let cross = (bend - per) * cos * sin;
    let bent = [[bend * cos * cos + per * sin * sin, cross], [cross, bend * sin * sin + per * cos * cos]];
    Surface { z, slope: [fall * cos, fall * sin], bent }
}

/// Reach and mean distance of a release that stands at this angle, and the relative error of its volume.
fn released(scheme: Scheme, angle: f64, size: f64) -> Result<[f64; 3], Failure> {
    let half = (480.0 / size) as usize;
    let sheet = grid([2 * half; 2], [-(half as f64) * size; 2], size, Boundary::Absorbing);
    let grounds = terrain(&sheet, |x| Some(mountain(x)));
    let (sin, cos) = angle.to_radians().sin_cos();
    let middle = [90.0 * cos, 90.0 * sin];
    let cap = |[x, y]: [f64; 2]| {
        let away = ((x - middle[0]).powi(2) + (y - middle[1]).powi(2)) / 900.0;
        Flow::still((3.0 * (1.0 - away)).max(0.0))
    };
    let mut run = on_bed(Setting::coulomb(scheme, 0.35, 1e-4), sheet, &grounds, |x, _| cap(x))?;
    let before = run.totals().volume;
    while !run.at_rest() && run.time() < 300.0 {
        run.advance(300.0).map_err(failed)?;
    }
    let (mut reach, mut moment, mut mass) = (0.0_f64, 0.0, 0.0);
    for (number, h) in depths(&*run).into_iter().enumerate() {
        let [x, y] = sheet.centre(sheet.index(number));
        let r = x.hypot(y);
        moment += h * r;
        mass += h;
        if h > 0.05 {
            reach = reach.max(r);
        }
    }
    Ok([reach, moment / mass, lost(&*run, before).abs()])
}

fn turn(scheme: Scheme, size: Size) -> Result<Finding, Failure> {
    let grids: &[f64] = if size == Size::Full { &[8.0, 4.0, 2.0] } else { &[8.0, 4.0] };
    let mut errors = Errors::default();
    let (mut reaches, mut volume) = (0.0_f64, 0.0_f64);
    for &cell in grids {
        let scenes = [0.0, 15.0, 30.0, 45.0].map(|angle| released(scheme, angle, cell));
        let scenes = scenes.into_iter().collect::<Result<Vec<_>, _>>()?;
        let spread = |k: usize| {
            let of = || scenes.iter().map(|scene| scene[k]);
            of().fold(f64::NEG_INFINITY, f64::max) - of().fold(f64::INFINITY, f64::min)
        };
        errors.cells.push((960.0 / cell) as usize);
        errors.sizes.push(cell);
        errors.errors.push(spread(1));
        reaches = spread(0) / cell;
        volume = scenes.iter().map(|scene| scene[2]).fold(volume, f64::max);
    }
    let last = errors.sizes.len() - 1;
    let checks = vec![
        Check::error(
            format!("largest difference of the reach in cells of {} m", errors.sizes[last]),
            reaches,
            2.0,
            "the rim is known to a cell, at either end",
        ),
        Check::error(
            format!("largest difference of the mean distance in cells of {} m", errors.sizes[last]),
            errors.errors[last] / errors.sizes[last],
            0.5,
            "half a cell: the mean is known better than the rim",
        ),
        Check::at_least(
            "order of that difference over all grids",
            errors.order(),
            [1.0, 0.5],
            "an error of the grid falls with it; the rim jumps from cell to cell",
        ),
        Check::error("largest relative error of the volume", volume, 1e-13, "rounding"),
    ];
    Ok(Finding { checks, errors: Some(errors), ..Finding::default() })
}
