//! The rolling layer that a resting surface carries: -div(v grad s) = f, in the order in which sand flows.
//!
//! On a given surface the first-order flux (eq. 10) is affine in the v of the two cells at the face, and vanishes in the
//! v of the lower one: each cell's own slopes decide where it sends sand. So the equations are triangular, cells being
//! taken after those that send to them. The coefficients are the scheme's own flux for v = 1 on one side.

use super::super::scheme::{FIRST_ORDER, FaceStates};
use super::super::table::Table;
use super::super::{Ground, Pile, Source};
use super::unsteady::Unsteady;
use crate::scheme::{Cell, Forecasts, Scheme, Spacing, Stencil};
use alloc::vec;
use alloc::vec::Vec;

/// A surface, and what is poured on its cells along each axis.
pub(super) struct Slope<'a, const D: usize> {
    pub table: &'a Table<D>,
    pub size: [f64; D],
    pub surface: &'a [f64],
    pub source: &'a [[f64; D]],
}

/// A cell of it with the neighbours that first order sees, all with the same rolling layer, the source on or off.
struct Even<'a, const D: usize> {
    slope: &'a Slope<'a, D>,
    place: usize,
    spacing: Spacing<D, f64>,
    v: f64,
    poured: bool,
}

impl<const D: usize> Stencil<D, f64, Pile<f64>, Ground<D, f64>, Source<D, f64>> for Even<'_, D> {
    #[inline(always)]
    fn at(&self, offset: [isize; D]) -> Cell<Pile<f64>, Ground<D, f64>, Source<D, f64>> {
        let Slope { table, surface, source, .. } = self.slope;
        let step = (0..D).map(|k| offset[k] * table.step(k) as isize).sum();
        let place = self.place.wrapping_add_signed(step);
        let Some(&surface) = surface.get(place) else {
            return Cell {
                state: Pile { u: 0.0, v: 0.0 },
                ground: Ground::outside(),
                forcing: Source::none(),
            };
        };
        let source = if self.poured { source[place] } else { [0.0; D] };
        Cell {
            state: Pile { u: surface, v: self.v },
            ground: table.ground_at(place, 0.0),
            forcing: table.source_at(place, source),
        }
    }
    #[inline(always)]
    fn spacing(&self) -> &Spacing<D, f64> {
        &self.spacing
    }
}

/// What passes a face towards smaller coordinates: below v_below + above v_above + poured.
#[derive(Clone, Copy, Default)]
struct Face {
    below: f64,
    above: f64,
    poured: f64,
}

/// The face between two cells, each poured on, rolling and empty.
fn meet<const D: usize>(
    axis: usize,
    below: &[FaceStates<D, f64>; 3],
    above: &[FaceStates<D, f64>; 3],
) -> Face {
    let flux = |low: &FaceStates<D, f64>, high: &FaceStates<D, f64>| FIRST_ORDER.flux(axis, low, high, 0.0);
    Face {
        below: flux(&below[1], &above[2]),
        above: flux(&below[2], &above[1]),
        poured: flux(&below[0], &above[0]),
    }
}

/// A sandpile is not forecast.
const fn none<const D: usize>() -> Forecasts<D, ()> {
    Forecasts { here: (), lo: [(); D], hi: [(); D] }
}

/// What enters a cell is rounding below this share of the largest source.
const ROUNDING: f64 = 1e-11;
/// A cell is level if less than this share of its sand leaves it per time.
const LEVEL: f64 = 1e-12;
/// Sweeps over cells that send sand round in a circle.
const SWEEPS: usize = 10_000;

/// The rolling layer, and what passes the face below each place along each axis towards smaller coordinates.
pub(super) struct Rolling<const D: usize> {
    pub v: Vec<f64>,
    pub flux: Vec<[f64; D]>,
    /// Cells of a crest from which sand was made to leave across it.
    pub crests: Vec<usize>,
}

impl<const D: usize> Slope<'_, D> {
    fn edges(&self, place: usize) -> [FaceStates<D, f64>; 3] {
        let spacing = Spacing::new(self.size);
        [(0.0, true), (1.0, false), (0.0, false)].map(|(v, poured)| {
            FIRST_ORDER.reconstruct(&Even { slope: self, place, spacing, v, poured }, &(), &none(), 0.0)
        })
    }

    /// The faces below each place.
    fn faces(&self) -> Vec<[Face; D]> {
        // The edges of the last row are at hand when those of the next come: one is kept for each column.
        let mut row = vec![self.edges(0); self.table.step(D - 1)];
        let columns = row.len();
        let mut faces = vec![[Face::default(); D]; self.table.size()];
        for (place, faces) in faces.iter_mut().enumerate() {
            let here = self.edges(place);
            for (axis, face) in faces.iter_mut().enumerate() {
                let below = self.table.below(place, axis);
                if self.table.is_inside(below)
                    || (self.table.is_inside(place) && place >= self.table.step(axis))
                {
                    *face = meet(axis, &row[below % columns], &here);
                } else if self.table.is_inside(place) {
                    *face = meet(axis, &self.edges(below), &here);
                }
            }
            row[place % columns] = here;
        }
        faces
    }

    /// The share of its v that leaves a cell per time.
    fn leaves(&self, faces: &[[Face; D]], place: usize) -> f64 {
        let along = |axis: usize| {
            let (lo, hi) = (&faces[place][axis], &faces[place + self.table.step(axis)][axis]);
            (lo.above - hi.below) / self.size[axis]
        };
        (0..D).map(along).sum()
    }

    /// Open the crests on which sand would be dammed up; returns them.
    ///
    /// On a crest one cell wide the cell's slopes are those of both flanks, averaged: sand that rolls along the crest onto
    /// a cell that is more level than the one before would pile up there, v -> infinity as the crest levels out. There it
    /// leaves across the crest, at each face by the mean of the slopes of the two cells.
    fn open_crests(&self, faces: &mut [[Face; D]]) -> Vec<usize> {
        let table = self.table;
        let mut opened = Vec::new();
        for place in table.places() {
            let near = |axis: usize| (table.below(place, axis), place + table.step(axis));
            let slow = 2.0 * self.leaves(faces, place);
            let dammed = |axis: usize| {
                let (below, above) = near(axis);
                let from_below = table.is_inside(below) && -faces[place][axis].below > slow * self.size[axis];
                let from_above = table.is_inside(above) && faces[above][axis].above > slow * self.size[axis];
                from_below || from_above
            };
            let along = (0..D).find(|axis| dammed(*axis));
            for axis in (0..D).filter(|axis| along.is_some_and(|along| along != *axis)) {
                let (below, above) = near(axis);
                if table.is_inside(below) && table.is_inside(above) {
                    let (down, up) = (faces[below][axis].above, faces[above + table.step(axis)][axis].below);
                    if down > 0.0 && up < 0.0 {
                        let own = faces[place][axis].above + faces[above][axis].below;
                        opened.push((place, axis, [(own + down) / 2.0, (own + up) / 2.0]));
                    }
                }
            }
        }
        for &(place, axis, [down, up]) in &opened {
            faces[place][axis].above = down.max(0.0);
            faces[place + table.step(axis)][axis].below = up.min(0.0);
        }
        opened.into_iter().map(|(place, ..)| place).collect()
    }

    /// How many neighbours of each cell send sand into it.
    fn waits(&self, faces: &[[Face; D]]) -> Vec<u8> {
        let table = self.table;
        let mut waits = vec![0_u8; table.size()];
        for place in 0..table.size() {
            for (axis, face) in faces[place].iter().enumerate() {
                let below = table.below(place, axis);
                if face.above > 0.0 && table.is_inside(place) && table.is_inside(below) {
                    waits[below] += 1;
                }
                if face.below < 0.0 && table.is_inside(place) && table.is_inside(below) {
                    waits[place] += 1;
                }
            }
        }
        waits
    }

    /// Solve for v: what leaves a cell is what enters it and what is poured on it.
    pub(super) fn carry(&self) -> Result<Rolling<D>, Unsteady<D>> {
        let table = self.table;
        let mut faces = self.faces();
        let opened = self.open_crests(&mut faces);
        let mut waits = self.waits(&faces);
        let largest = self.source.iter().map(|f| f.iter().sum::<f64>()).fold(0.0, f64::max);
        let mut v = vec![0.0; table.size()];
        let cell = |v: &[f64], place: usize| -> Result<f64, Unsteady<D>> {
            let mut enters = 0.0;
            for axis in 0..D {
                let above = place + table.step(axis);
                let (lo, hi) = (&faces[place][axis], &faces[above][axis]);
                let sent = |from: usize| if table.is_inside(from) { v[from] } else { 0.0 };
                let from_below = -lo.below * sent(table.below(place, axis));
                let from_above = hi.above * sent(above);
                let per = 1.0 / self.size[axis];
                let poured = self.source[place][axis] + (hi.poured - lo.poured) * per;
                enters += (from_below + from_above) * per + poured;
            }
            if enters.abs() <= ROUNDING * largest {
                return Ok(0.0);
            }
            let leaves = self.leaves(&faces, place);
            if leaves > LEVEL {
                Ok(enters / leaves)
            } else {
                Err(Unsteady::Trapped { cell: table.index(place) })
            }
        };
        let mut ready: Vec<usize> = table.places().filter(|place| waits[*place] == 0).collect();
        let mut done = vec![false; table.size()];
        while let Some(place) = ready.pop() {
            v[place] = cell(&v, place)?;
            done[place] = true;
            for axis in 0..D {
                let (below, above) = (table.below(place, axis), place + table.step(axis));
                let down = (faces[place][axis].above > 0.0, below);
                let up = (faces[above][axis].below < 0.0, above);
                for (sends, to) in [down, up] {
                    if sends && table.is_inside(to) {
                        waits[to] -= 1;
                        if waits[to] == 0 {
                            ready.push(to);
                        }
                    }
                }
            }
        }
        self.settle(table.places().filter(|place| !done[*place]).collect(), &mut v, cell)?;
        let flux = |place: usize, axis: usize| {
            let face = &faces[place][axis];
            let below = table.below(place, axis);
            let lower = if table.is_inside(below) { face.below * v[below] } else { 0.0 };
            (face.above * v[place] + lower) + face.poured
        };
        let flux = (0..table.size()).map(|place| core::array::from_fn(|axis| flux(place, axis))).collect();
        let crests = opened.into_iter().filter(|place| v[*place] > 0.0).collect();
        Ok(Rolling { v, flux, crests })
    }

    /// Cells that send sand round in a circle, as where two faces of a pile meet in a valley, and those below them: by
    /// sweeps from the highest to the lowest (Gauss-Seidel), until nothing changes but by rounding.
    fn settle(
        &self,
        mut cells: Vec<usize>,
        v: &mut [f64],
        cell: impl Fn(&[f64], usize) -> Result<f64, Unsteady<D>>,
    ) -> Result<(), Unsteady<D>> {
        let height = |place: usize| self.table.corners(place).map(|node| self.surface[node]).sum::<f64>();
        cells.sort_by(|a, b| height(*b).total_cmp(&height(*a)).then(a.cmp(b)));
        let Some(&first) = cells.first() else { return Ok(()) };
        for _ in 0..SWEEPS {
            let (mut change, mut most) = (0.0_f64, 0.0_f64);
            for &place in &cells {
                let value = cell(v, place)?;
                change = change.max((value - v[place]).abs());
                most = most.max(value.abs());
                v[place] = value;
            }
            if change <= f64::EPSILON * most {
                return Ok(());
            }
        }
        Err(Unsteady::Trapped { cell: self.table.index(first) })
    }
}
