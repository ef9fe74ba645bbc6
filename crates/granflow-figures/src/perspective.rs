//! The eye that looks at a box in perspective, and the box with its marks.

use super::axes::{Axis, Scale, TICK_SIZE, extent};
use super::canvas::{Area, Canvas, Lettering, Pen};
use super::colours::{INK, PALE};
use super::ticks::{Ticks, linear};

/// The eye: three axes of the picture and its distance from the middle of the box.
pub(super) struct Eye {
    pub right: [f64; 3],
    pub up: [f64; 3],
    pub towards: [f64; 3],
    distance: f64,
    /// Points per unit and the place of the middle of the box.
    zoom: f64,
    middle: [f64; 2],
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Eye {
    /// The eye that sees the box as great as `area` allows; the area's height shrinks to what is used.
    pub fn new((azimuth, elevation): (f64, f64), half: [f64; 3], area: &mut Area) -> Self {
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
    pub fn nearness(&self, p: [f64; 3]) -> f64 {
        1.0 / (self.distance - dot(p, self.towards))
    }

    pub fn place(&self, p: [f64; 3]) -> [f64; 2] {
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
            // At the foot of the upright edge a floor's edge has a label too.
            let foot = self.along == 2 && self.scale.place(value) < 0.01;
            let align = if foot { [align[0], 0.0] } else { align };
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

/// Floor, the two far walls with lines at the marks, and the three edges that carry the labels.
pub(super) fn draw_box(
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
