//! Random rough mountains: a fall that runs out, fractal roughness, cliffs, pits, holes in the data.

use super::dice::Dice;
use super::scheme::GRAVITY;
use granflow::kernels::Kernel;
use granflow::savage_hutter::Flow;
use granflow::savage_hutter::ground::{Bed, Terrain};
use granflow::simulation::Simulation;

/// How rough a mountain is.
#[derive(Clone, Copy, Debug)]
pub struct Roughness {
    /// Height of the roughness at the longest wave length \[m\]; halved with each octave times 2^(1 - 0.8).
    pub height: f64,
    /// Height of a cliff across the slope \[m\], within one cell.
    pub cliff: f64,
    /// Depth of the pits \[m\].
    pub pits: f64,
    /// Share of the cells outside the data.
    pub holes: f64,
}

/// A mountain of `cells` cells of size `dx` \[m\]: levels x fastest, NaN outside the data.
pub struct Mountain {
    pub cells: [usize; 2],
    pub dx: f64,
    levels: Vec<f64>,
}

impl Mountain {
    /// From a seed. It falls towards larger x at up to 40 degrees and runs out over the last third.
    pub fn random(seed: u64, cells: [usize; 2], dx: f64, rough: Roughness) -> Mountain {
        let mut dice = Dice(seed);
        let [columns, rows] = cells;
        let length = columns as f64 * dx;
        let steepest = dice.between(25.0, 40.0_f64).to_radians().tan();
        let noise = Noise::random(&mut dice, length);
        let cliff = dice.between(0.25, 0.55) * length;
        let pits: Vec<[f64; 3]> = (0..4)
            .map(|_| {
                let at = [dice.between(0.1, 0.9) * length, dice.between(0.1, 0.9) * rows as f64 * dx];
                [at[0], at[1], dice.between(1.5, 4.0) * dx]
            })
            .collect();
        let mut levels = Vec::with_capacity(columns * rows);
        for j in 0..rows {
            for i in 0..columns {
                let [x, y] = [i, j].map(|k| (k as f64 + 0.5) * dx);
                let s = (x / length).min(0.67) / 0.67;
                // The slope falls linearly to 0 at two thirds.
                let mut z = 1000.0 - steepest * 0.67 * length * (s - 0.5 * s * s);
                z += rough.height * noise.at([x, y]);
                z -= if x > cliff + 0.1 * y { rough.cliff } else { 0.0 };
                for [px, py, radius] in &pits {
                    let away = ((x - px).powi(2) + (y - py).powi(2)) / (radius * radius);
                    z -= rough.pits * (-away).exp();
                }
                let hole = dice.roll() < rough.holes;
                levels.push(if hole { f64::NAN } else { z });
            }
        }
        Mountain { cells, dx, levels }
    }

    /// The lowest elevation of the data.
    pub fn lowest(&self) -> f64 {
        self.levels.iter().copied().filter(|z| z.is_finite()).fold(f64::INFINITY, f64::min)
    }

    pub fn level(&self, i: isize, j: isize) -> Option<f64> {
        let inside = i >= 0 && j >= 0 && i < self.cells[0] as isize && j < self.cells[1] as isize;
        let level = |i: isize, j: isize| self.levels[j as usize * self.cells[0] + i as usize];
        inside.then(|| level(i, j)).filter(|z| z.is_finite())
    }

    /// The ground of a cell: gradient and second derivatives by differences over 3 x 3 cells, less where data end.
    pub fn ground(&self, [i, j]: [usize; 2]) -> Terrain<2, f64> {
        let (i, j) = (i as isize, j as isize);
        let Some(here) = self.level(i, j) else { return Terrain::nothing(GRAVITY) };
        let at = |di: isize, dj: isize| self.level(i + di, j + dj);
        let along = |ways: [(isize, isize); 2]| match ways.map(|(di, dj)| at(di, dj)) {
            [Some(lo), Some(hi)] => ((hi - lo) / (2.0 * self.dx), (hi - 2.0 * here + lo) / self.dx.powi(2)),
            [Some(lo), None] => ((here - lo) / self.dx, 0.0),
            [None, Some(hi)] => ((hi - here) / self.dx, 0.0),
            [None, None] => (0.0, 0.0),
        };
        let (x, xx) = along([(-1, 0), (1, 0)]);
        let (y, yy) = along([(0, -1), (0, 1)]);
        let corners = [at(1, 1), at(-1, -1), at(1, -1), at(-1, 1)];
        let xy = match corners {
            [Some(a), Some(b), Some(c), Some(d)] => ((a + b) - (c + d)) / (4.0 * self.dx.powi(2)),
            _ => 0.0,
        };
        // As a grid keeps them.
        let slope = [x, y].map(|s| f64::from(s as f32));
        let cos = 1.0 / (1.0 + slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
        Terrain::of(here, slope, cos, [xx, xy, yy], GRAVITY)
    }
}

/// Sums over the cells of h |V|^2/2 and of g (b - lowest) h + g c^2 h^2/2, per cell area.
pub fn energy<S>(run: &Simulation<2, S>, lowest: f64) -> [f64; 2]
where
    S: Kernel<2, State = Flow<2, f64>, Ground = Terrain<2, f64>>,
{
    let parts = run.collect(|cell| {
        let (Flow { h, .. }, ground) = (cell.state, cell.ground.exact());
        if ground.is_nodata() || h <= 0.0 {
            return [0.0; 2];
        }
        let kinetic = 0.5 * h * ground.square(cell.state.velocity());
        [kinetic, h * (GRAVITY * (ground.level - lowest) + 0.5 * ground.head() * h)]
    });
    [0, 1].map(|which| granflow::run::sum(parts.iter().map(|part| part[which])))
}

/// Octaves of smooth value noise of about unit height.
struct Noise {
    seed: u64,
    length: f64,
}

impl Noise {
    fn random(dice: &mut Dice, length: f64) -> Noise {
        Noise { seed: (dice.roll() * 1e15) as u64, length }
    }
    fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let (mut sum, mut height, mut wave) = (0.0, 1.0, self.length / 3.0);
        for octave in 0..6 {
            sum += height * self.octave(octave, x / wave, y / wave);
            height *= 0.5_f64.powf(0.8);
            wave *= 0.5;
        }
        sum
    }
    fn octave(&self, octave: u64, x: f64, y: f64) -> f64 {
        let corner = |i: f64, j: f64| {
            let key = self.seed ^ octave << 48 ^ ((i + 1e6) as u64) << 24 ^ (j + 1e6) as u64;
            2.0 * Dice(key).roll() - 1.0
        };
        let (i, j) = (x.floor(), y.floor());
        let fade = |t: f64| t * t * (3.0 - 2.0 * t);
        let (s, t) = (fade(x - i), fade(y - j));
        let row = |j: f64| corner(i, j) * (1.0 - s) + corner(i + 1.0, j) * s;
        row(j) * (1.0 - t) + row(j + 1.0) * t
    }
}
