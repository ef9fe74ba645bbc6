//! Parts of the plane that a case names: boxes, discs, polygons from a file.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::fault::PartFault;
use super::files::Outline;
use super::grid::Points;
use super::look::Look;
use super::quantity::Centre;

/// A part of the plane (of the line in one dimension), with its rim.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Region {
    /// [x0, x1, y0, y1], or [x0, x1] for all y.
    Box(Vec<f64>),
    /// All places within a distance of a centre.
    Disc(Disc),
    /// The polygons of a GeoJSON file or shapefile, without their holes, in the case's coordinates.
    File(PathBuf),
}

/// A disc (an interval in one dimension).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Disc {
    /// Centre: x, or [x, y].
    #[serde(default)]
    pub centre: Centre,
    /// Distance from the centre to the rim.
    pub radius: f64,
}

/// A region whose file is read.
#[derive(Debug)]
pub(crate) enum Area {
    Box([f64; 2], [f64; 2]),
    Disc(Disc),
    Polygons(Box<dyn Outline>),
}

impl Region {
    /// The file that the region needs.
    pub(crate) fn needs_file(&self) -> Option<&Path> {
        match self {
            Self::File(path) => Some(path),
            Self::Box(_) | Self::Disc(_) => None,
        }
    }

    /// Checks the numbers and reads the file; `points` tells one dimension from two.
    pub(crate) fn area(&self, points: &Points, look: &Look) -> Result<Area, PartFault> {
        let plane = points.y.is_some();
        match self {
            Self::Box(ends) => {
                let (x, y) = match (ends.as_slice(), plane) {
                    ([x0, x1], _) => ([*x0, *x1], [f64::NEG_INFINITY, f64::INFINITY]),
                    ([x0, x1, y0, y1], true) => ([*x0, *x1], [*y0, *y1]),
                    (_, true) => {
                        let found = ends.len();
                        let message = format!(
                            "found {found} numbers, expected [x0, x1, y0, y1], or [x0, x1] for all y"
                        );
                        return Err(PartFault::new("box", message));
                    }
                    (_, false) => {
                        let message =
                            format!("found {} numbers, expected [x0, x1]: the grid has no y", ends.len());
                        return Err(PartFault::new("box", message));
                    }
                };
                for [low, high] in [x, y] {
                    // an edge of the table may be a box without breadth
                    if low.is_nan() || high.is_nan() || low > high {
                        let message =
                            format!("from {low} to {high} is no interval, expected the low end first");
                        return Err(PartFault::new("box", message));
                    }
                }
                Ok(Area::Box(x, y))
            }
            Self::Disc(disc) if disc.radius > 0.0 && disc.radius.is_finite() => {
                if matches!(disc.centre, Centre::Xy(_)) && !plane {
                    return Err(PartFault::new("disc.centre", "expected centre = x: the grid has no y"));
                }
                Ok(Area::Disc(disc.clone()))
            }
            Self::Disc(disc) => {
                let message = format!("found {}, expected a number > 0", disc.radius);
                Err(PartFault::new("disc.radius", message))
            }
            Self::File(_) if !plane => Err(PartFault::new(
                "file",
                "polygons need two dimensions, expected box = [x0, x1]: the grid has no y",
            )),
            Self::File(path) => {
                let polygons = look.files.outlines(&look.locate(path));
                polygons.map(Area::Polygons).map_err(|error| PartFault::new("file", error).file())
            }
        }
    }
}

impl Area {
    /// Whether the place lies in the region or, up to `slack`, on its rim.
    ///
    /// The slack is rounding's: it lets a box from 0.1 to 0.9 hold both or none of two mirrored places.
    pub(crate) fn holds(&self, [x, y]: [f64; 2], slack: f64) -> bool {
        let between = |[low, high]: [f64; 2], at: f64| low - slack <= at && at <= high + slack;
        match self {
            Self::Box(xs, ys) => between(*xs, x) && between(*ys, y),
            Self::Disc(disc) => disc.centre.distance(x, y) <= disc.radius + slack,
            Self::Polygons(polygons) => polygons.holds([x, y]),
        }
    }

    /// Distance of a place from the region's rim, positive within.
    pub(crate) fn depth(&self, [x, y]: [f64; 2]) -> f64 {
        match self {
            Self::Box(xs, ys) => {
                let [across, along] = [(xs, x), (ys, y)].map(|([low, high], at)| (at - low).min(high - at));
                let within = across.min(along);
                if within >= 0.0 { within } else { -across.min(0.0).hypot(along.min(0.0)) }
            }
            Self::Disc(disc) => disc.radius - disc.centre.distance(x, y),
            Self::Polygons(polygons) => polygons.depth([x, y]),
        }
    }

    /// The ends [low, high] of the region along x and y.
    pub(crate) fn bounds(&self) -> [[f64; 2]; 2] {
        match self {
            Self::Box(x, y) => [*x, *y],
            Self::Disc(disc) => {
                let [cx, cy] = match disc.centre {
                    Centre::X(x) => [x, 0.0],
                    Centre::Xy(xy) => xy,
                };
                [cx, cy].map(|at| [at - disc.radius, at + disc.radius])
            }
            Self::Polygons(polygons) => polygons.bounds(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::files::NoFiles;
    use super::super::grid::{Axis, Grid};
    use super::super::source::Source;
    use super::*;

    fn in_box(ends: &[f64]) -> Area {
        let look = Look { source: &Source::default(), files: &NoFiles };
        Region::Box(ends.to_vec()).area(&plane(), &look).unwrap()
    }

    fn plane() -> Points {
        let axis = Axis { from: -1.0, to: 1.0, cells: 3 };
        Grid { x: axis.clone(), y: Some(axis) }.centres()
    }

    #[test]
    fn a_box_has_its_rim_and_may_be_without_breadth() {
        let area = in_box(&[0.0, 0.0, 0.25, 0.75]);
        assert!(area.holds([0.0, 0.25], 0.0) && area.holds([0.0, 0.75], 0.0));
        assert!(!area.holds([0.0, 0.76], 1e-3) && !area.holds([0.01, 0.5], 1e-3));
        assert!(area.holds([1e-12, 0.5], 1e-9), "rounding does not push a place off an edge");
        let strip = in_box(&[0.0, 1.0]);
        assert!(strip.holds([0.5, 1e6], 0.0));
        assert_eq!([[0.25, 9.0], [-3.0, 0.0]].map(|place| strip.depth(place)), [0.25, -3.0]);
        let square = in_box(&[0.0, 1.0, 0.0, 1.0]);
        assert_eq!([[0.5, 0.125], [4.0, 5.0]].map(|place| square.depth(place)), [0.125, -5.0]);
    }
}
