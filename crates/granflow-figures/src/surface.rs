//! A surface z(x, y) or z(x, t) in perspective, hidden parts hidden, coloured by height or by another field.

use std::cmp::Ordering;

use tiny_skia::Pixmap;

use super::axes::{Axis, RIM, Scale, extent, heading, heading_height};
use super::canvas::{Area, Canvas, SCALE};
use super::colour_bar::ColourBar;
use super::colours::{Colours, Rgb, mix, pick, shade};
use super::depth::{Depth, Vertex};
use super::heat::check_coordinates;
use super::perspective::{Eye, dot, draw_box};
use super::thin;
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
/// Height of the colour bar.
const BAR: f64 = 260.0;

/// A point of the surface: where it is in the box, and in the picture.
type Point = ([f64; 3], Vertex);

/// A surface in its box before an eye.
struct Scene<'a> {
    surface: &'a Surface<'a>,
    scales: [Scale; 3],
    /// Half the sides of the box.
    half: [f64; 3],
    /// The field that gives the colours, at the points, and the range of the colours.
    painted: Vec<f64>,
    range: [f64; 2],
    eye: Eye,
    /// Where the surface is on the sheet.
    area: Area,
    /// The direction of the light.
    sun: [f64; 3],
}

impl Surface<'_> {
    /// The range of the heights.
    fn heights(&self) -> Result<[f64; 2], FigureError> {
        check_coordinates(self.title, "abscissae", self.xs)?;
        check_coordinates(self.title, "ordinates", self.ys)?;
        let (nx, ny) = (self.xs.len(), self.ys.len());
        FigureError::same_length(self.title, "the surface", self.values.len(), nx * ny)?;
        if let Some(paint) = self.paint.filter(|_| !self.paints_cells()) {
            FigureError::same_length(self.title, "the paint", paint.values.len(), nx * ny)?;
        }
        let heights = self.z.range_of(extent(self.values.iter().copied()), 0.0);
        heights.ok_or_else(|| FigureError::empty(self.title, "no finite height"))
    }

    /// Whether the paint has a value for each cell, not for each point.
    fn paints_cells(&self) -> bool {
        let cells = (self.xs.len() - 1) * (self.ys.len() - 1);
        self.paint.is_some_and(|paint| paint.values.len() == cells)
    }

    /// The field that gives the colours, at the points, and the range of the colours.
    fn painted(&self, heights: [f64; 2]) -> (Vec<f64>, [f64; 2]) {
        let painted = match &self.paint {
            Some(paint) => paint.at_points(self.xs.len(), self.ys.len()),
            None => self.values.to_vec(),
        };
        let shown = extent(painted.iter().copied()).unwrap_or(heights);
        let shown = self.paint.and_then(|paint| paint.quantity.range_of(Some(shown), 0.0)).unwrap_or(shown);
        (painted, self.colours.range(shown))
    }

    /// Half the sides of the box.
    fn half(&self) -> [f64; 3] {
        let sound = |p: &[f64; 3]| p.iter().all(|&s| s > 0.0 && s.is_finite());
        self.proportions.filter(sound).unwrap_or([1.0, 1.0, 0.6]).map(|side| 0.5 * side)
    }
}

impl Scene<'_> {
    /// Where the point (i, j) is in the box.
    fn spot(&self, i: usize, j: usize) -> [f64; 3] {
        let Surface { xs, ys, values, .. } = self.surface;
        let [low, high] = self.scales[2].range;
        let z = values[j * xs.len() + i].clamp(low, high);
        let shares = [self.scales[0].place(xs[i]), self.scales[1].place(ys[j]), self.scales[2].place(z)];
        std::array::from_fn(|a| (2.0 * shares[a] - 1.0) * self.half[a])
    }

    /// A place of the box as it is seen.
    fn seen(&self, p: [f64; 3], height: f64, light: f64, mesh: [f64; 2]) -> Vertex {
        let [x, y] = self.eye.place(p);
        let fine = 2.0 * SCALE;
        let place = [(x - self.area.left) * fine, (y - self.area.top) * fine];
        Vertex { place, nearness: self.eye.nearness(p), height, light, mesh }
    }

    /// The point (i, j) with the light of the slopes around it, unless there is a hole.
    fn point(&self, i: usize, j: usize) -> Option<Point> {
        let (nx, ny) = (self.surface.xs.len(), self.surface.ys.len());
        let p = self.spot(i, j);
        let [w, e] = [self.spot(i.saturating_sub(1), j), self.spot((i + 1).min(nx - 1), j)];
        let [s, n] = [self.spot(i, j.saturating_sub(1)), self.spot(i, (j + 1).min(ny - 1))];
        let slopes = [(e[2] - w[2]) / (e[0] - w[0]), (n[2] - s[2]) / (n[1] - s[1])]
            .map(|s| if s.is_finite() { s } else { 0.0 });
        let light = lit([-slopes[0], -slopes[1], 1.0], self.sun);
        let vertex = self.seen(p, self.painted[j * nx + i], light, [i as f64, j as f64]);
        self.surface.values[j * nx + i].is_finite().then_some((p, vertex))
    }

    /// The two triangles of a cell with the corners a, b below and c, d above.
    fn triangles([a, b, c, d]: [Point; 4]) -> [[Point; 3]; 2] {
        // Cut along the higher diagonal: a ridge that crosses the cell stays one.
        let high = |p: Point, q: Point| p.0[2] + q.0[2];
        if high(b, c) > high(a, d) { [[a, b, c], [b, d, c]] } else { [[a, b, d], [a, d, c]] }
    }

    fn draw_surface(&self, depth: &mut Depth) {
        let surface = self.surface;
        let (nx, ny) = (surface.xs.len(), surface.ys.len());
        let lines = surface.lines.unwrap_or(30);
        let spacing = [nx, ny].map(|n| {
            if lines == 0 { f64::INFINITY } else { ((n - 1) as f64 / lines as f64).ceil().max(1.0) }
        });
        let table = surface.colours.table();
        let colour = |height: f64, light: f64, ink: f64| {
            let base = shade(pick(&table, height, self.range), 0.74 + 0.30 * light);
            mix(base, [20, 20, 30], if lines == 0 { 0.0 } else { 0.55 * ink })
        };
        let cells = surface.paint.filter(|_| surface.paints_cells());
        let hole = |i: usize, j: usize| {
            cells.is_some_and(|paint| !paint.values[(j - 1) * (nx - 1) + i - 1].is_finite())
        };
        let line = |j: usize| -> Vec<Option<Point>> { (0..nx).map(|i| self.point(i, j)).collect() };
        let mut before = line(0);
        for j in 1..ny {
            let after = line(j);
            for i in (1..nx).filter(|&i| !hole(i, j)) {
                let (Some(a), Some(b), Some(c), Some(d)) = (before[i - 1], before[i], after[i - 1], after[i])
                else {
                    continue;
                };
                for corners in Self::triangles([a, b, c, d]) {
                    let mut seen = corners.map(|(_, vertex)| vertex);
                    if surface.facets {
                        let light = lit(upwards(corners.map(|(p, _)| p)), self.sun);
                        seen.iter_mut().for_each(|vertex| vertex.light = light);
                    }
                    depth.triangle(seen, spacing, colour);
                }
            }
            before = after;
        }
    }

    fn draw_wall(&self, depth: &mut Depth, [from, to]: [[f64; 2]; 2]) {
        let Surface { xs, ys, .. } = self.surface;
        let near = |at: f64, among: &[f64]| among.partition_point(|&c| c < at - 1e-9 * at.abs());
        let index = |[x, y]: [f64; 2]| [near(x, xs).min(xs.len() - 1), near(y, ys).min(ys.len() - 1)];
        let ([i0, j0], [i1, j1]) = (index(from), index(to));
        let at = |k: usize| {
            let along = |a: usize, b: usize| match a.cmp(&b) {
                Ordering::Less => a + k,
                Ordering::Greater => a - k,
                Ordering::Equal => a,
            };
            let foot = self.spot(along(i0, i1), along(j0, j1));
            let top = foot[2] + WALL.0 * 2.0 * self.half[2];
            [-self.half[2], top].map(|z| self.seen([foot[0], foot[1], z], 0.0, 0.0, [0.0; 2]))
        };
        let dark = shade(WALL.1, if i0 == i1 { 1.1 } else { 0.92 });
        for k in 0..i0.abs_diff(i1).max(j0.abs_diff(j1)) {
            let ([a, b], [c, d]) = (at(k), at(k + 1));
            depth.triangle([a, b, d], [f64::INFINITY; 2], |_, _, _| dark);
            depth.triangle([a, d, c], [f64::INFINITY; 2], |_, _, _| dark);
        }
    }

    /// Surface and walls, what is nearer before what is behind.
    fn image(&self) -> Option<Pixmap> {
        let [columns, rows] =
            [self.area.width, self.area.height].map(|side| 2 * (side * SCALE).ceil() as usize);
        let mut depth = Depth::new(columns, rows);
        self.draw_surface(&mut depth);
        self.surface.walls.iter().for_each(|wall| self.draw_wall(&mut depth, *wall));
        depth.halved()
    }
}

impl Surface<'_> {
    /// Draws the surface by fewer points where there are more than the picture can show.
    fn draw_thinned(&self, kept: &[Vec<usize>; 2]) -> Result<Picture, FigureError> {
        let [across, up] = kept;
        let (nx, both) = (self.xs.len(), [across.as_slice(), up]);
        // A cell is painted as the one at its lower corner was.
        let cells = [&across[..across.len() - 1], &up[..up.len() - 1]];
        let painted = self.paint.map(|paint| match self.paints_cells() {
            true => thin::among(paint.values, nx - 1, cells),
            false => thin::among(paint.values, nx, both),
        });
        let paint = |values| self.paint.map(|paint| Paint { values, ..paint });
        Surface {
            xs: &thin::along(self.xs, across),
            ys: &thin::along(self.ys, up),
            values: &thin::among(self.values, nx, both),
            paint: painted.as_deref().and_then(paint),
            ..*self
        }
        .draw()
    }
}

impl Figure for Surface<'_> {
    fn draw(&self) -> Result<Picture, FigureError> {
        let heights = self.heights()?;
        let kept = [self.xs, self.ys].map(|at| thin::kept(at.len()));
        if kept[0].len() < self.xs.len() || kept[1].len() < self.ys.len() {
            return self.draw_thinned(&kept);
        }
        let ends = |at: &[f64]| [at[0], at[at.len() - 1]];
        let scales = [ends(self.xs), ends(self.ys), heights].map(Scale::new);
        let half = self.half();
        let (painted, range) = self.painted(heights);
        let quantity = self.paint.map(|paint| paint.quantity);
        let bar =
            quantity.map(|quantity| ColourBar { colours: self.colours, range, caption: quantity.caption() });
        let room = bar.as_ref().map_or(0.0, |bar| bar.room(BAR) - 30.0);
        let (width, top) = (800.0 + room, heading_height(self.title, self.subtitle));
        let mut area = Area { left: 82.0, top: top + 4.0, width: 636.0, height: 480.0 };
        let towards = (self.azimuth.unwrap_or(-60.0), self.elevation.unwrap_or(32.0).clamp(5.0, 85.0));
        let eye = Eye::new(towards, half, &mut area);
        let mut canvas = Canvas::new(width, area.bottom() + 62.0 + RIM);
        heading(&mut canvas, self.title, self.subtitle, width);
        let side = |a: usize| if eye.towards[a] >= 0.0 { half[a] } else { -half[a] };
        draw_box(&mut canvas, &eye, half, [side(0), side(1)], &scales, [&self.x, &self.y, &self.z]);

        let sun = std::array::from_fn(|a| -0.55 * eye.right[a] + 0.45 * eye.up[a] + 0.70 * eye.towards[a]);
        let scene = Scene { surface: self, scales, half, painted, range, eye, area, sun };
        if let Some(image) = scene.image() {
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
