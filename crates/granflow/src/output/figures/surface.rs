//! A surface z(x, y) or z(x, t) in perspective, hidden parts hidden, coloured by height.

use super::axes::{Axis, RIM, Scale, TICK_SIZE, extent, heading, heading_height};
use super::canvas::{Area, Canvas, Lettering, Pen, SCALE};
use super::colours::{Colours, INK, PALE, mix, pick, shade};
use super::depth::{Depth, Vertex};
use super::heat::check_coordinates;
use super::ticks::{Ticks, linear};
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
}

/// The eye: three axes of the picture and its distance from the middle of the box.
struct Eye {
    right: [f64; 3],
    up: [f64; 3],
    towards: [f64; 3],
    distance: f64,
    /// Points per unit and the place of the middle of the box.
    zoom: f64,
    middle: [f64; 2],
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Eye {
    /// The eye that sees the box as great as `area` allows; the area's height shrinks to what is used.
    fn new((azimuth, elevation): (f64, f64), half: [f64; 3], area: &mut Area) -> Self {
        let ((sa, ca), (se, ce)) = (azimuth.to_radians().sin_cos(), elevation.to_radians().sin_cos());
        let mut eye = Self {
            right: [-sa, ca, 0.0],
            up: [-se * ca, -se * sa, ce],
            towards: [ce * ca, ce * sa, se],
            distance: 5.0 * dot(half, half).sqrt(),
            zoom: 1.0,
            middle: [0.0, 0.0],
        };
        let corners =
            (0..8).map(|k| std::array::from_fn(|a| if k >> a & 1 == 1 { half[a] } else { -half[a] }));
        let (xs, ys): (Vec<f64>, Vec<f64>) =
            corners.map(|corner| eye.place(corner)).map(|p| (p[0], p[1])).unzip();
        let ([x0, x1], [y0, y1]) = (extent(xs).unwrap_or([0.0, 1.0]), extent(ys).unwrap_or([0.0, 1.0]));
        eye.zoom = (area.width / (x1 - x0)).min(area.height / (y1 - y0));
        area.top = area.top.round(); // the picture of the surface is laid on whole pixels
        area.height = eye.zoom * (y1 - y0);
        eye.middle = [
            area.left + 0.5 * area.width - eye.zoom * 0.5 * (x0 + x1),
            area.top + 0.5 * area.height - eye.zoom * 0.5 * (y0 + y1),
        ];
        eye
    }

    /// One over the distance from the eye's plane: even across a plane's picture, greater for what is nearer.
    fn nearness(&self, p: [f64; 3]) -> f64 {
        1.0 / (self.distance - dot(p, self.towards))
    }

    fn place(&self, p: [f64; 3]) -> [f64; 2] {
        let size = self.zoom * self.distance * self.nearness(p);
        [self.middle[0] + size * dot(p, self.right), self.middle[1] - size * dot(p, self.up)]
    }
}

/// One edge of the box with its marks.
struct Edge<'a> {
    axis: &'a Axis<'a>,
    scale: Scale,
    ticks: &'a Ticks,
    /// Which coordinate runs along it.
    along: usize,
    /// A point of the edge, and the direction in which its labels stand away from the box.
    point: [f64; 3],
    outward: [f64; 3],
}

impl Edge<'_> {
    fn at(&self, share: f64, half: [f64; 3], out: f64) -> [f64; 3] {
        let mut p = self.point;
        p[self.along] = (2.0 * share - 1.0) * half[self.along];
        std::array::from_fn(|a| p[a] + out * self.outward[a])
    }

    fn draw(&self, canvas: &mut Canvas, eye: &Eye, half: [f64; 3]) {
        let pen = Pen::new(INK, 1.0);
        let ends = [self.at(0.0, half, 0.0), self.at(1.0, half, 0.0)].map(|p| eye.place(p));
        canvas.line(&ends, pen);
        let [foot, tip] = [self.at(0.5, half, 0.0), self.at(0.5, half, 0.1)].map(|p| eye.place(p));
        let length = (tip[0] - foot[0]).hypot(tip[1] - foot[1]).max(1e-9);
        let away = [(tip[0] - foot[0]) / length, (tip[1] - foot[1]) / length];
        let align = [0.5 - 0.5 * away[0], 0.5 + 0.5 * away[1]];
        let off = |p: [f64; 2], d: f64| [p[0] + d * away[0], p[1] + d * away[1]];
        let mut deepest: f64 = 0.0;
        for (&value, label) in self.ticks.at.iter().zip(&self.ticks.labels) {
            let p = eye.place(self.at(self.scale.place(value), half, 0.0));
            canvas.line(&[p, off(p, 5.0)], pen);
            canvas.text(label, off(p, 9.0), Lettering::new(TICK_SIZE, align));
            let width = super::typeface::width(label, TICK_SIZE);
            deepest = deepest.max(9.0 + width * away[0].abs() + TICK_SIZE * 0.73 * away[1].abs());
        }
        let caption = self.axis.caption().text(self.ticks.exponent);
        let mut angle = (-(ends[1][1] - ends[0][1])).atan2(ends[1][0] - ends[0][0]).to_degrees();
        if !(-80.0..=100.0).contains(&angle) {
            angle -= 180.0 * angle.signum();
        }
        let middle = [0.5 * (ends[0][0] + ends[1][0]), 0.5 * (ends[0][1] + ends[1][1])];
        let how = Lettering { angle, ..Lettering::new(13.0, [0.5, 0.5]) };
        canvas.text(&caption, off(middle, deepest + 16.0), how);
    }
}

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
        let (width, top) = (800.0, heading_height(self.title, self.subtitle));
        let mut area = Area { left: 82.0, top: top + 4.0, width: width - 164.0, height: 480.0 };
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
        let vertex = |i: usize, j: usize| -> Option<Vertex> {
            let height = self.values[j * nx + i];
            let p = spot(i, j);
            let [w, e] = [spot(i.saturating_sub(1), j), spot((i + 1).min(nx - 1), j)];
            let [s, n] = [spot(i, j.saturating_sub(1)), spot(i, (j + 1).min(ny - 1))];
            let slopes = [(e[2] - w[2]) / (e[0] - w[0]), (n[2] - s[2]) / (n[1] - s[1])]
                .map(|s| if s.is_finite() { s } else { 0.0 });
            let normal = [-slopes[0], -slopes[1], 1.0];
            let light = dot(normal, sun).max(0.0) / dot(normal, normal).sqrt();
            let [x, y] = eye.place(p);
            let place = [(x - area.left) * fine, (y - area.top) * fine];
            height.is_finite().then(|| Vertex {
                place,
                nearness: eye.nearness(p),
                height,
                light,
                mesh: [i as f64, j as f64],
            })
        };
        let [columns, rows] = [area.width, area.height].map(|side| 2 * (side * SCALE).ceil() as usize);
        let mut depth = Depth::new(columns, rows);
        let lines = self.lines.unwrap_or(30);
        let spacing = [nx, ny].map(|n| {
            if lines == 0 { f64::INFINITY } else { ((n - 1) as f64 / lines as f64).ceil().max(1.0) }
        });
        let (table, range) = (self.colours.table(), self.colours.range(found.unwrap_or(heights)));
        let colour = |height: f64, light: f64, ink: f64| {
            let base = shade(pick(&table, height, range), 0.74 + 0.30 * light);
            mix(base, [20, 20, 30], if lines == 0 { 0.0 } else { 0.55 * ink })
        };
        let line = |j: usize| -> Vec<Option<Vertex>> { (0..nx).map(|i| vertex(i, j)).collect() };
        let mut before = line(0);
        for j in 1..ny {
            let after = line(j);
            for i in 1..nx {
                if let (Some(a), Some(b), Some(c), Some(d)) =
                    (before[i - 1], before[i], after[i - 1], after[i])
                {
                    depth.triangle([a, b, d], spacing, colour);
                    depth.triangle([a, d, c], spacing, colour);
                }
            }
            before = after;
        }
        if let Some(image) = depth.halved() {
            canvas.image(&image, [area.left, area.top]);
        }
        Ok(canvas.finish())
    }
}

/// Floor, the two far walls with lines at the marks, and the three edges that carry the labels.
fn draw_box(
    canvas: &mut Canvas,
    eye: &Eye,
    half: [f64; 3],
    near: [f64; 2],
    scales: &[Scale; 3],
    axes: [&Axis; 3],
) {
    let ticks: [Ticks; 3] = [0, 1, 2].map(|a| linear(scales[a].range, if a == 2 { 5 } else { 6 }, false));
    let far = [-near[0], -near[1]];
    // Each face: the coordinate held and its value.
    for (held, value) in [(2, -half[2]), (0, far[0]), (1, far[1])] {
        let [a, b] = match held {
            0 => [1, 2],
            1 => [0, 2],
            _ => [0, 1],
        };
        let at = |u: f64, v: f64| {
            let mut p = [value; 3];
            (p[a], p[b]) = (u, v);
            eye.place(p)
        };
        let corners =
            [at(-half[a], -half[b]), at(half[a], -half[b]), at(half[a], half[b]), at(-half[a], half[b])];
        canvas.fill(&corners, [246, 246, 246], 1.0);
        for &v in &ticks[a].at {
            let u = (2.0 * scales[a].place(v) - 1.0) * half[a];
            canvas.line(&[at(u, -half[b]), at(u, half[b])], Pen::new(PALE, 1.0));
        }
        for &v in &ticks[b].at {
            let u = (2.0 * scales[b].place(v) - 1.0) * half[b];
            canvas.line(&[at(-half[a], u), at(half[a], u)], Pen::new(PALE, 1.0));
        }
        canvas.ring(&corners, Pen::new([170, 170, 170], 1.0));
    }
    let floor = -half[2];
    let edge = |along: usize, point: [f64; 3], outward: [f64; 3]| Edge {
        axis: axes[along],
        scale: scales[along],
        ticks: &ticks[along],
        along,
        point,
        outward,
    };
    edge(0, [0.0, near[1], floor], [0.0, near[1].signum(), 0.0]).draw(canvas, eye, half);
    edge(1, [near[0], 0.0, floor], [near[0].signum(), 0.0, 0.0]).draw(canvas, eye, half);
    // The vertical edge at the left of the picture.
    let silhouettes = [[near[0], far[1]], [far[0], near[1]]];
    let left = |p: &[f64; 2]| eye.place([p[0], p[1], 0.0])[0];
    let [x, y] = if left(&silhouettes[0]) < left(&silhouettes[1]) { silhouettes[0] } else { silhouettes[1] };
    let outward = eye.right.map(|r| -r);
    edge(2, [x, y, 0.0], outward).draw(canvas, eye, half);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_box_fills_the_area_and_keeps_left_and_right() {
        let mut area = Area { left: 10.0, top: 20.0, width: 600.0, height: 5000.0 };
        let half = [0.5, 0.5, 0.3];
        let eye = Eye::new((-60.0, 30.0), half, &mut area);
        assert!(area.height < 600.0);
        let corners =
            (0..8).map(|k| std::array::from_fn(|a| if k >> a & 1 == 1 { half[a] } else { -half[a] }));
        let xs = extent(corners.map(|c| eye.place(c)[0])).unwrap();
        assert!((xs[0] - 10.0).abs() < 1e-9 && (xs[1] - 610.0).abs() < 1e-9);
        assert!(eye.place([0.5, 0.0, 0.0])[0] > eye.place([-0.5, 0.0, 0.0])[0]);
        assert!(eye.nearness([0.0, -0.5, 0.0]) > eye.nearness([0.0, 0.5, 0.0]));
    }
}
