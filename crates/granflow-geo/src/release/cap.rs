//! A release in the form of a parabolic cap.

use super::{LOST, ReleaseError, Sparse};
use crate::raster::Raster;

/// Thickness per cell \[m\] of the parabolic cap h = height max(0, 1 - r^2 / radius^2), r the horizontal distance of the
/// cell's centre from `centre` \[m\].
///
/// # Errors
/// [`ReleaseError::Cap`] where the height or radius is not above 0, no cell with a value lies under the cap, or a part of it lies
/// beyond the edge of `template` or on its nodata cells.
pub fn cap(height: f64, centre: [f64; 2], radius: f64, template: &Raster) -> Result<Sparse, ReleaseError> {
    let error = |problem: String| ReleaseError::Cap { problem };
    for (name, value) in [("height", height), ("radius", radius)] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(error(format!("releases nothing: its {name} must be above 0, found {value}")));
        }
    }
    let inside = |at: [f64; 2]| {
        let [x, y] = [at[0] - centre[0], at[1] - centre[1]];
        (1.0 - (x * x + y * y) / (radius * radius)).max(0.0)
    };
    let at = |k: usize| {
        let [column, row] = template.place(k);
        if template.values[k].is_nan() { 0.0 } else { height * inside([template.x(column), template.y(row)]) }
    };
    let thickness = Sparse::of((0..template.values.len()).map(at));
    let [x, y] = centre;
    if thickness.most() == 0.0 {
        let terrain = ReleaseError::extent(template);
        return Err(error(format!(
            "releases nothing: no cell with a value lies within {radius} m of its centre ({x}, {y}); the terrain \
             extends over {terrain}"
        )));
    }
    let whole = height * under(&inside, centre, radius, template);
    let lost = 1.0 - thickness.iter().map(|(_, h)| h).sum::<f64>() / whole;
    if lost > LOST {
        return Err(ReleaseError::cut([x, y], radius, template, lost));
    }
    Ok(thickness)
}

/// The sum of `inside` over the centres of the cells of `template` carried on beyond its edges, as far as a circle reaches; by its
/// integral where these are far more than the cells there are.
fn under(inside: &impl Fn([f64; 2]) -> f64, centre: [f64; 2], radius: f64, template: &Raster) -> f64 {
    let across = radius / template.cell;
    if (2.0 * across + 1.0).powi(2) > 4.0 * template.values.len() as f64 + 1e6 {
        return 0.5 * std::f64::consts::PI * across * across;
    }
    let span = |low: f64, centre: f64| {
        let at = (centre - low) / template.cell;
        (at - across).floor() as i64..=(at + across).ceil() as i64
    };
    let place = |low: f64, k: i64| low + (k as f64 + 0.5) * template.cell;
    let row = |j: i64| -> f64 {
        let y = place(template.south, j);
        span(template.west, centre[0]).map(|i| inside([place(template.west, i), y])).sum()
    };
    span(template.south, centre[1]).map(row).sum()
}
