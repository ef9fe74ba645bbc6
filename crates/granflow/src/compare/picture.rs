//! The figure of a comparison: what both have, what A misses, what A has alone.

use super::side::Side;
use super::{CompareError, Comparison};
use crate::model::Units;
use crate::output::figures::{
    Axis, Curve, Extent, Figure, Outline, Part, Parts, Picture, Profiles, Style, short,
};

/// Cells along the longer side of the picture.
const CELLS: f64 = 900.0;
/// What is shown around the areas, as a share of their longer side.
const MARGIN: f64 = 0.12;

const HIT: [u8; 3] = [0, 158, 115];
const MISS: [u8; 3] = [0, 114, 178];
const FALSE: [u8; 3] = [230, 120, 0];
const PATH: [u8; 3] = [20, 20, 20];

/// The picture of a comparison.
pub(super) fn draw(comparison: &Comparison) -> Result<Picture, CompareError> {
    let [a, b] = &comparison.drawn.sides;
    let name = |side: &Side| {
        let path = side.path();
        let folder = path.parent().and_then(std::path::Path::file_name);
        let result = path.file_name().is_some_and(|file| file == "result.nc");
        let named = folder.filter(|_| result).or(path.file_name());
        named.map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
    };
    let title = format!("{} held against {}", name(a), name(b));
    let unit = side_units(comparison).label(" m");
    let subtitle = format!(
        "critical success index {:.3}; {} thicker than {}{unit}",
        comparison.csi,
        comparison.by.word(),
        short(comparison.threshold)
    );
    if a.line().is_some() {
        return line(comparison, &title, &subtitle);
    }
    plane(comparison, &title, &subtitle)
}

fn side_units(comparison: &Comparison) -> Units {
    let domain = comparison.drawn.sides.iter().find_map(Side::domain);
    domain.map_or(Units::Si, |domain| domain.units())
}

/// Two profiles in one dimension.
fn line(comparison: &Comparison, title: &str, subtitle: &str) -> Result<Picture, CompareError> {
    let lines = comparison.drawn.sides.each_ref().map(|side| {
        let (grid, map) = side.line()?;
        let x: Vec<f64> = (0..grid.cells()).map(|cell| grid.centre(cell)[0]).collect();
        let y: Vec<f64> = map.iter().map(|h| if h.is_nan() { 0.0 } else { *h }).collect();
        Some((x, y))
    });
    let curves: Vec<Curve> = ["A", "B"]
        .into_iter()
        .zip(&lines)
        .zip([Style::Solid, Style::Dashed])
        .filter_map(|((name, line), style)| {
            let (x, y) = line.as_ref()?;
            Some(Curve { name, x, y, style, colour: None })
        })
        .collect();
    let label = format!("{} h", comparison.by.map().replace('_', " "));
    let figure = Profiles {
        title,
        subtitle,
        x: Axis::new("x", ""),
        y: Axis::new(&label, ""),
        curves: &curves,
        ..Default::default()
    };
    Ok(figure.draw()?)
}

/// The three areas in the plane, over the mountain of a run where there is one.
fn plane(comparison: &Comparison, title: &str, subtitle: &str) -> Result<Picture, CompareError> {
    let [a, b] = &comparison.drawn.sides;
    let extent = around(comparison);
    let cells = extent.nx * extent.ny;
    let centre = |k: usize| {
        let (i, j) = ((k % extent.nx) as f64, (k / extent.nx) as f64);
        [extent.west + (i + 0.5) * extent.cell, extent.south + (j + 0.5) * extent.cell]
    };
    let [in_a, in_b] =
        [a, b].map(|side| (0..cells).map(|k| side.area().holds(centre(k))).collect::<Vec<_>>());
    let chosen = |of: fn(bool, bool) -> bool| -> Vec<bool> {
        in_a.iter().zip(&in_b).map(|(a, b)| of(*a, *b)).collect()
    };
    let (hit, miss, alone) = (chosen(|a, b| a && b), chosen(|a, b| b && !a), chosen(|a, b| a && !b));
    let ground = [a, b].into_iter().filter_map(Side::domain).find_map(|domain| domain.raster());
    let bed: Vec<f64> = ground.map_or_else(Vec::new, |ground| {
        (0..cells).map(|k| ground.sample(centre(k)[0], centre(k)[1])).collect()
    });
    let path = comparison.drawn.path.as_ref().filter(|_| ground.is_some());
    let path = path.map(|path| Outline {
        name: "path",
        points: path.points(),
        dashed: true,
        colour: Some(PATH),
        ..Default::default()
    });
    let unit = side_units(comparison).label("m");
    let [x, y] = if unit.is_empty() { ["x", "y"] } else { ["easting", "northing"] };
    let figure = Parts {
        title,
        subtitle,
        x: Axis::new(x, unit),
        y: Axis::new(y, unit),
        extent,
        bed: &bed,
        parts: &[
            Part { name: "both (hit)", colour: HIT, cells: &hit },
            Part { name: "B alone (missed)", colour: MISS, cells: &miss },
            Part { name: "A alone (false)", colour: FALSE, cells: &alone },
        ],
        outlines: path.as_slice(),
    };
    Ok(figure.draw()?)
}

/// The box around both areas.
fn around(comparison: &Comparison) -> Extent {
    let bounds = comparison.drawn.sides.iter().filter_map(|side| side.area().bounds());
    let both = bounds.reduce(|one, other| {
        [0, 1].map(|axis| [one[axis][0].min(other[axis][0]), one[axis][1].max(other[axis][1])])
    });
    let ends = both.unwrap_or([[0.0, 1.0]; 2]);
    let sides = ends.map(|[low, high]| high - low);
    let longer = sides[0].max(sides[1]);
    let margin = MARGIN * longer;
    let cell = (longer + 2.0 * margin) / CELLS;
    // A narrow strip is shown in a box of 1 to 2.2, as maps are.
    let shown = sides.map(|side| (side + 2.0 * margin).max((longer + 2.0 * margin) / 2.2));
    let low = [0, 1].map(|axis| 0.5 * (ends[axis][0] + ends[axis][1] - shown[axis]));
    let count = shown.map(|side| (side / cell).round().max(2.0) as usize);
    Extent { nx: count[0], ny: count[1], west: low[0], south: low[1], cell }
}
