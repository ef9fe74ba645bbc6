//! A surface z(x, y) or z(x, t) in perspective, hidden parts hidden, coloured by height or by another field.

use super::axes::{Axis, RIM, Scale, extent, heading, heading_height};
use super::canvas::{Area, Canvas, SCALE};
use super::colour_bar::ColourBar;
use super::colours::{Colours, Rgb, mix, pick, shade};
use super::depth::{Depth, Vertex};
use super::heat::check_coordinates;
use super::perspective::{Eye, dot, draw_box};
use super::{Figure, FigureError, Picture};

/// A surface over a rectangle.
#[derive(Debug, Clone, Copy, Default)]
pub struct Surface<'a> {
    /// The heading.
    pub title: &'a str,
    /// A second, smaller line under it.
    pub subtitle: &'a str,
    /// The first horizontal axis (its range is that of `xs`).
    pub x: Axis<'a>,
    /// The second horizontal axis, a length or the time (its range is that of `ys`).
    pub y: Axis<'a>,
    /// The vertical axis.
    pub z: Axis<'a>,
    /// Increasing abscissae, at least two.
    pub xs: &'a [f64],
    /// Increasing ordinates, at least two.
    pub ys: &'a [f64],
    /// The heights, `ys.len()` rows of `xs.len()` values; the surface has a hole where one is not finite.
    pub values: &'a [f64],
    /// The field that gives the colours; the height itself where `None`.
    pub paint: Option<Paint<'a>>,
    /// The scale of colours.
    pub colours: Colours,
    /// Where the eye stands: degrees from the x axis towards the y axis (-60 where `None`).
    pub azimuth: Option<f64>,
    /// How high the eye stands, degrees above the floor, 5 to 85 (32 where `None`).
    pub elevation: Option<f64>,
    /// Sides of the box along x, y and z ([1, 1, 0.6] where `None`).
    pub proportions: Option<[f64; 3]>,
    /// Mesh lines along each axis (30 where `None`; 0 for a smooth surface).
    pub lines: Option<usize>,
    /// Whether each face has its own light, so that ridges stay sharp; else the light goes over from one to the next.
    pub facets: bool,
    /// Walls that stand along lines of the lattice, from the floor to a little above the surface: their two ends.
    pub walls: &'a [[[f64; 2]; 2]],
}

/// A field on a surface: a value for each of its points, or for each cell between four of them, where one that is not
/// finite leaves a hole.
#[derive(Debug, Clone, Copy)]
pub struct Paint<'a> {
    /// The field, in the order of the heights.
    pub values: &'a [f64],
    /// Name, unit and range, for the colour bar.
    pub quantity: Axis<'a>,
}

impl Paint<'_> {
    /// The field at the points of the surface: the mean of the cells around.
    fn at_points(&self, nx: usize, ny: usize) -> Vec<f64> {
        if self.values.len() == nx * ny {
            return self.values.to_vec();
        }
        let mean = |k: usize| {
            let (i, j) = (k % nx, k / nx);
            let rows = j.saturating_sub(1)..(j + 1).min(ny - 1);
            let around = rows.flat_map(|j| {
                (i.saturating_sub(1)..(i + 1).min(nx - 1)).map(move |i| self.values[j * (nx - 1) + i])
            });
            let (sum, count) =
                around.filter(|v| v.is_finite()).fold((0.0, 0.0), |(sum, n), v| (sum + v, n + 1.0));
            sum / count
        };
        (0..nx * ny).map(mean).collect()
    }
}

/// How far walls stand above the surface, as a share of the height of the box, and their colour.
const WALL: (f64, Rgb) = (0.05, [88, 92, 104]);

/// A point of the surface: where it is in the box, and in the picture.
type Point = ([f64; 3], Vertex);

impl Figure for Surface<'_> {
    fn draw(&self) -> Result<Picture, FigureError> {
        let (nx, ny) = (self.xs.len(), self.ys.len());
        check_coordinates(self.title, "abscissae", self.xs)?;
        check_coordinates(self.title, "ordinates", self.ys)?;
        FigureError::same_length(self.title, "the surface", self.values.len(), nx * ny)?;
        let found = extent(self.values.iter().copied());
        let heights = self.z.range_of(found, 0.0);
        let heights = heights.ok_or_else(|| FigureError::empty(self.title, "no finite height"))?;
        let scales = [[self.xs[0], self.xs[nx - 1]], [self.ys[0], self.ys[ny - 1]], heights].map(Scale::new);

        let sides = self
            .proportions
            .filter(|p| p.iter().all(|&s| s > 0.0 && s.is_finite()))
            .unwrap_or([1.0, 1.0, 0.6]);
        let half = sides.map(|side| 0.5 * side);
        let (colours_of, cells) = match &self.paint {
            Some(paint) => {
                let cells = paint.values.len() == (nx - 1) * (ny - 1);
                if !cells {
                    FigureError::same_length(self.title, "the paint", paint.values.len(), nx * ny)?;
                }
                (paint.at_points(nx, ny), cells)
            }
            None => (self.values.to_vec(), false),
        };
        let shown = extent(colours_of.iter().copied()).unwrap_or(heights);
        let quantity = self.paint.map(|paint| paint.quantity);
        let shown = quantity.and_then(|quantity| quantity.range_of(Some(shown), 0.0)).unwrap_or(shown);
        let range = self.colours.range(shown);
        let bar =
            quantity.map(|quantity| ColourBar { colours: self.colours, range, caption: quantity.caption() });
        const BAR: f64 = 260.0;
        let room = bar.as_ref().map_or(0.0, |bar| bar.room(BAR) - 30.0);
        let (width, top) = (800.0 + room, heading_height(self.title, self.subtitle));
        let mut area = Area { left: 82.0, top: top + 4.0, width: 636.0, height: 480.0 };
        let towards = (self.azimuth.unwrap_or(-60.0), self.elevation.unwrap_or(32.0).clamp(5.0, 85.0));
        let eye = Eye::new(towards, half, &mut area);
        let height = area.bottom() + 62.0 + RIM;
        let mut canvas = Canvas::new(width, height);
        heading(&mut canvas, self.title, self.subtitle, width);
        let side = |a: usize| if eye.towards[a] >= 0.0 { half[a] } else { -half[a] };
        let near = [side(0), side(1)];
        draw_box(&mut canvas, &eye, half, near, &scales, [&self.x, &self.y, &self.z]);

        let spot = |i: usize, j: usize| -> [f64; 3] {
            let z = self.values[j * nx + i].clamp(heights[0], heights[1]);
            let shares = [scales[0].place(self.xs[i]), scales[1].place(self.ys[j]), scales[2].place(z)];
            std::array::from_fn(|a| (2.0 * shares[a] - 1.0) * half[a])
        };
        let sun: [f64; 3] =
            std::array::from_fn(|a| -0.55 * eye.right[a] + 0.45 * eye.up[a] + 0.70 * eye.towards[a]);
        let fine = 2.0 * SCALE;
        let seen = |p: [f64; 3], height: f64, light: f64, mesh: [f64; 2]| {
            let [x, y] = eye.place(p);
            let place = [(x - area.left) * fine, (y - area.top) * fine];
            Vertex { place, nearness: eye.nearness(p), height, light, mesh }
        };
        let point = |i: usize, j: usize| -> Option<Point> {
            let p = spot(i, j);
            let [w, e] = [spot(i.saturating_sub(1), j), spot((i + 1).min(nx - 1), j)];
            let [s, n] = [spot(i, j.saturating_sub(1)), spot(i, (j + 1).min(ny - 1))];
            let slopes = [(e[2] - w[2]) / (e[0] - w[0]), (n[2] - s[2]) / (n[1] - s[1])]
                .map(|s| if s.is_finite() { s } else { 0.0 });
            let light = lit([-slopes[0], -slopes[1], 1.0], sun);
            let vertex = seen(p, colours_of[j * nx + i], light, [i as f64, j as f64]);
            self.values[j * nx + i].is_finite().then_some((p, vertex))
        };
        let [columns, rows] = [area.width, area.height].map(|side| 2 * (side * SCALE).ceil() as usize);
        let mut depth = Depth::new(columns, rows);
        let lines = self.lines.unwrap_or(30);
        let spacing = [nx, ny].map(|n| {
            if lines == 0 { f64::INFINITY } else { ((n - 1) as f64 / lines as f64).ceil().max(1.0) }
        });
        let table = self.colours.table();
        let colour = |height: f64, light: f64, ink: f64| {
            let base = shade(pick(&table, height, range), 0.74 + 0.30 * light);
            mix(base, [20, 20, 30], if lines == 0 { 0.0 } else { 0.55 * ink })
        };
        let mut face = |corners: [Point; 3]| {
            let mut seen = corners.map(|(_, vertex)| vertex);
            if self.facets {
                let light = lit(upwards(corners.map(|(p, _)| p)), sun);
                seen.iter_mut().for_each(|vertex| vertex.light = light);
            }
            depth.triangle(seen, spacing, colour);
        };
        let line = |j: usize| -> Vec<Option<Point>> { (0..nx).map(|i| point(i, j)).collect() };
        let hole = |i: usize, j: usize| {
            cells && self.paint.is_some_and(|paint| !paint.values[(j - 1) * (nx - 1) + i - 1].is_finite())
        };
        let mut before = line(0);
        for j in 1..ny {
            let after = line(j);
            for i in 1..nx {
                let (Some(a), Some(b), Some(c), Some(d)) = (before[i - 1], before[i], after[i - 1], after[i])
                else {
                    continue;
                };
                if hole(i, j) {
                    continue;
                }
                // Cut along the higher diagonal: a ridge that crosses the cell stays one.
                let high = |p: Point, q: Point| p.0[2] + q.0[2];
                if high(b, c) > high(a, d) {
                    face([a, b, c]);
                    face([b, d, c]);
                } else {
                    face([a, b, d]);
                    face([a, d, c]);
                }
            }
            before = after;
        }
        for [from, to] in self.walls {
            let near = |at: f64, among: &[f64]| among.partition_point(|&c| c < at - 1e-9 * at.abs());
            let index = |[x, y]: [f64; 2]| [near(x, self.xs).min(nx - 1), near(y, self.ys).min(ny - 1)];
            let ([i0, j0], [i1, j1]) = (index(*from), index(*to));
            let steps = i0.abs_diff(i1).max(j0.abs_diff(j1));
            let at = |k: usize| {
                let along = |a: usize, b: usize| {
                    if a < b {
                        a + k
                    } else if a > b {
                        a - k
                    } else {
                        a
                    }
                };
                let foot = spot(along(i0, i1), along(j0, j1));
                let top = foot[2] + WALL.0 * 2.0 * half[2];
                [-half[2], top].map(|z| seen([foot[0], foot[1], z], 0.0, 0.0, [0.0; 2]))
            };
            for k in 0..steps {
                let ([a, b], [c, d]) = (at(k), at(k + 1));
                let across = if i0 == i1 { 0 } else { 1 };
                let dark = shade(WALL.1, if across == 0 { 1.1 } else { 0.92 });
                depth.triangle([a, b, d], [f64::INFINITY; 2], |_, _, _| dark);
                depth.triangle([a, d, c], [f64::INFINITY; 2], |_, _, _| dark);
            }
        }
        if let Some(image) = depth.halved() {
            canvas.image(&image, [area.left, area.top]);
        }
        if let Some(bar) = bar {
            bar.draw(&mut canvas, 800.0 - 44.0, area.top + 0.5 * (area.height - BAR), BAR);
        }
        Ok(canvas.finish())
    }
}

/// How much of the sun's light a face with this normal gets.
fn lit(normal: [f64; 3], sun: [f64; 3]) -> f64 {
    dot(normal, sun).max(0.0) / dot(normal, normal).sqrt()
}

/// The normal of a triangle that points upwards.
fn upwards([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let [p, q]: [[f64; 3]; 2] = [b, c].map(|corner| std::array::from_fn(|k| corner[k] - a[k]));
    let normal = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
    if normal[2] < 0.0 { normal.map(|part| -part) } else { normal }
}
