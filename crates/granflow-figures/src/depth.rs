//! What is nearer hides what is behind: triangles painted by depth.

use tiny_skia::{Pixmap, PremultipliedColorU8};

use super::colours::Rgb;

/// A corner of the surface in the picture: place in pixels, nearness, height, light, position in the lattice.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vertex {
    pub place: [f64; 2],
    pub nearness: f64,
    pub height: f64,
    pub light: f64,
    pub mesh: [f64; 2],
}

/// Pixels with the nearness of what is seen in them.
pub(super) struct Depth {
    width: usize,
    height: usize,
    nearness: Vec<f32>,
    colour: Vec<Rgb>,
}

impl Depth {
    /// Nothing painted yet.
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, height, nearness: vec![0.0; width * height], colour: vec![[255; 3]; width * height] }
    }

    /// Paints a triangle where nothing nearer was painted.
    pub fn triangle(
        &mut self,
        [a, b, c]: [Vertex; 3],
        spacing: [f64; 2],
        colour: impl Fn(f64, f64, f64) -> Rgb,
    ) {
        let cross = |o: [f64; 2], p: [f64; 2], q: [f64; 2]| {
            (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0])
        };
        let doubled = cross(a.place, b.place, c.place);
        if doubled.abs() < 1e-9 || !doubled.is_finite() {
            return;
        }
        let bounds = |k: usize, n: usize| {
            let values = [a.place[k], b.place[k], c.place[k]];
            let low = values.iter().fold(f64::INFINITY, |m, &v| m.min(v)).floor().max(0.0);
            let high = values.iter().fold(0.0, |m: f64, &v| m.max(v)).ceil().min(n as f64);
            (low as usize)..(high as usize)
        };
        let mesh_gradient: [f64; 2] = std::array::from_fn(|k| {
            let (db, dc) = (b.mesh[k] - a.mesh[k], c.mesh[k] - a.mesh[k]);
            let gx = db * (c.place[1] - a.place[1]) - dc * (b.place[1] - a.place[1]);
            let gy = dc * (b.place[0] - a.place[0]) - db * (c.place[0] - a.place[0]);
            gx.hypot(gy) / doubled.abs()
        });
        for row in bounds(1, self.height) {
            for column in bounds(0, self.width) {
                let p = [column as f64 + 0.5, row as f64 + 0.5];
                let (wb, wc) = (cross(a.place, p, c.place) / doubled, cross(a.place, b.place, p) / doubled);
                let wa = 1.0 - wb - wc;
                let rim = -1e-6;
                if wa < rim || wb < rim || wc < rim {
                    continue;
                }
                let of = |f: fn(&Vertex) -> f64| wa * f(&a) + wb * f(&b) + wc * f(&c);
                let nearness = of(|v| v.nearness) as f32;
                let index = row * self.width + column;
                if nearness <= self.nearness[index] {
                    continue;
                }
                let line = (0..2).map(|k| {
                    let at = wa * a.mesh[k] + wb * b.mesh[k] + wc * c.mesh[k];
                    let away =
                        (at - (at / spacing[k]).round() * spacing[k]).abs() / mesh_gradient[k].max(1e-12);
                    let crowded = (spacing[k] / mesh_gradient[k].max(1e-12) / 14.0).min(1.0);
                    (1.3 - away).clamp(0.0, 1.0) * crowded
                });
                let ink = line.fold(0.0, f64::max);
                self.nearness[index] = nearness;
                self.colour[index] = colour(of(|v| v.height), of(|v| v.light), ink);
            }
        }
    }

    /// The picture at half the resolution, each pixel the mean of four.
    pub fn halved(&self) -> Option<Pixmap> {
        let (width, height) = (self.width / 2, self.height / 2);
        let mut image = Pixmap::new(u32::try_from(width).ok()?, u32::try_from(height).ok()?)?;
        for (k, pixel) in image.pixels_mut().iter_mut().enumerate() {
            let first = 2 * (k / width) * self.width + 2 * (k % width);
            let mut sum = [0u16; 4];
            for index in [first, first + 1, first + self.width, first + self.width + 1] {
                if self.nearness[index] > 0.0 {
                    let [r, g, b] = self.colour[index];
                    [r, g, b, 255].iter().zip(&mut sum).for_each(|(&part, sum)| *sum += u16::from(part));
                }
            }
            let [r, g, b, a] = sum.map(|s| (s / 4) as u8);
            *pixel = PremultipliedColorU8::from_rgba(r, g, b, a).unwrap_or(*pixel);
        }
        Some(image)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles that cross the same pixels, the red one nearer: red is seen, whichever is painted first.
    #[test]
    fn the_nearer_triangle_is_seen_in_any_order() {
        let triangle = |nearness: f64| {
            [[0.0, 0.0], [8.0, 0.0], [0.0, 8.0]].map(|place| Vertex {
                place,
                nearness,
                height: 0.0,
                light: 0.0,
                mesh: [0.0; 2],
            })
        };
        let smooth = [f64::INFINITY; 2];
        for red_first in [true, false] {
            let mut depth = Depth::new(8, 8);
            for red in [red_first, !red_first] {
                let colour: Rgb = if red { [200, 0, 0] } else { [0, 0, 200] };
                depth.triangle(triangle(if red { 2.0 } else { 1.0 }), smooth, |_, _, _| colour);
            }
            assert_eq!(depth.colour[9], [200, 0, 0]);
            assert_eq!(depth.colour[63], [255; 3], "outside the triangles");
        }
    }
}
