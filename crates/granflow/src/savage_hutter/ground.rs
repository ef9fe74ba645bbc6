//! What is fixed in a cell: the papers' chute, or a piece of a mountain.

use crate::real::{Real, dot, unroll};
use crate::scheme::{Parts, parts};
use crate::terrain::Terrain as Mountain;

/// The neighbour's place along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Towards {
    /// Smaller coordinates.
    Lo,
    /// Larger coordinates.
    Hi,
}

/// The bed under a cell, with all of the model that depends on it.
///
/// The pull of a mass at rest is F = -M grad(psi), psi the potential of the free surface per mass, M the metric of
/// horizontal vectors (identity on a chute, I - s s^T on terrain).
pub trait Bed<const D: usize, R: Real>: Parts<R> {
    /// The same bed on another scalar.
    type On<L: Real>: Bed<D, L>;
    /// What a face must know of the bed to turn a velocity into it.
    type Plane: Parts<R>;
    /// Is it more than a plane, so that [`Bed::cross`] or [`Bed::bend`] are not 0?
    const BENT: bool;
    /// See [`Bed::turn`].
    fn plane(&self) -> Self::Plane;
    /// Pressure coefficient along `axis`: P = beta h^2/2.
    fn beta(&self, axis: usize) -> R;
    /// psi at the neighbour minus psi here, depths `h_there` and `h`; `dx` is their distance.
    #[inline(always)]
    fn rise(&self, axis: usize, towards: Towards, there: &Self, h: R, h_there: R, dx: R) -> R {
        self.climb(axis, towards, there, dx) + self.weight(there, h, h_there)
    }
    /// The part of the rise that the bed makes.
    fn climb(&self, axis: usize, towards: Towards, there: &Self, dx: R) -> R;
    /// The part of the rise that the momentum flux carries as pressure.
    fn weight(&self, there: &Self, h: R, h_there: R) -> R;
    /// Acceleration -M (hi - lo)/(2 dx) of the rises towards both neighbours of each axis.
    fn pull(&self, lo: [R; D], hi: [R; D], per: [R; D]) -> [R; D];
    /// The part of [`Bed::pull`] that a pressure along the other axes makes (off the diagonal of M).
    fn cross(&self, lo: [R; D], hi: [R; D], per: [R; D]) -> [R; D];
    /// Acceleration per depth that the change of beta and of the bed's tilt along `axis` leaves beside the flux.
    fn bend(&self, axis: usize) -> R;
    /// Normal acceleration under a mass of velocity `w`, N+ = max(N, 0).
    fn load(&self, w: [R; D]) -> R;
    /// Normal acceleration at rest.
    fn weight_at_rest(&self) -> R;
    /// Squared physical length of the tangential vector with horizontal part `v`.
    fn square(&self, v: [R; D]) -> R;
    /// Length along the bed of a unit step along `axis`.
    fn stretch(&self, axis: usize) -> R;
    /// `w` turned from one tangent plane into another, at the same speed along the bed.
    fn turn(w: [R; D], from: &Self::Plane, to: &Self::Plane) -> [R; D];
    /// Thickness normal to the bed.
    fn thickness(&self, h: R) -> R;
    /// Rounding of a rise divided by dx: the uncertainty of the pull.
    fn rounding(&self, h: R, per: R) -> R;
    /// Elevation b \[m\], not a number outside the data; a chute has none.
    fn elevation(&self) -> R;
    /// Outside the data.
    fn outside(&self) -> R::Mask;
    /// The mirror image across a wall normal to `axis`.
    fn mirror(self, axis: usize) -> Self;
}

/// Central differences -(hi - lo)/(2 dx) of the rises towards both neighbours.
#[inline(always)]
fn straight<const D: usize, R: Real>(lo: [R; D], hi: [R; D], per: [R; D]) -> [R; D] {
    let mut difference = lo;
    unroll!(axis in D => {
        difference[axis] = (lo[axis] - hi[axis]) * (per[axis] * R::of(0.5));
    });
    difference
}

/// The papers' chute (report eqs. 1 and 13), in their scaling; also a tilted plane in two dimensions.
///
/// A cell outside the grid has cos = 0. psi = beta h per cell pair with P = beta h^2/2: a variable beta enters as h (beta_hi - beta_lo)/2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chute<const D: usize, R> {
    /// g sin(zeta), as a vector down the slope; g = 1 in the papers' scaling.
    pub tilt: [R; D],
    /// g epsilon k cos(zeta).
    pub beta: R,
    /// g cos(zeta).
    pub cos: R,
    /// eta kappa: curvature of the chute times L/R; N = cos(zeta) + eta kappa u^2.
    pub curvature: R,
}

// SAFETY: the parts are numbered below COUNT.
unsafe impl<const D: usize, R: Real> Parts<R> for Chute<D, R> {
    const COUNT: usize = D + 3;
    #[inline(always)]
    fn gather(part: impl Fn(usize) -> R) -> Self {
        let mut tilt = [R::zero(); D];
        unroll!(axis in D => {
            tilt[axis] = part(axis);
        });
        Chute { tilt, beta: part(D), cos: part(D + 1), curvature: part(D + 2) }
    }
    #[inline(always)]
    fn scatter(self, mut put: impl FnMut(usize, R)) {
        unroll!(axis in D => {
            put(axis, self.tilt[axis]);
        });
        put(D, self.beta);
        put(D + 1, self.cos);
        put(D + 2, self.curvature);
    }
}

impl<const D: usize, R: Real> Bed<D, R> for Chute<D, R> {
    type On<L: Real> = Chute<D, L>;
    type Plane = ();
    const BENT: bool = false;
    #[inline(always)]
    fn plane(&self) {}
    #[inline(always)]
    fn beta(&self, _axis: usize) -> R {
        self.beta
    }
    #[inline(always)]
    fn climb(&self, axis: usize, towards: Towards, _there: &Self, dx: R) -> R {
        let fall = self.tilt[axis] * dx;
        match towards {
            Towards::Hi => -fall,
            Towards::Lo => fall,
        }
    }
    #[inline(always)]
    fn weight(&self, there: &Self, h: R, h_there: R) -> R {
        self.beta * (h_there - h) + (there.beta - self.beta) * h * R::of(0.5)
    }
    #[inline(always)]
    fn pull(&self, lo: [R; D], hi: [R; D], per: [R; D]) -> [R; D] {
        straight(lo, hi, per)
    }
    #[inline(always)]
    fn cross(&self, _lo: [R; D], _hi: [R; D], _per: [R; D]) -> [R; D] {
        [R::zero(); D]
    }
    #[inline(always)]
    fn bend(&self, _axis: usize) -> R {
        R::zero()
    }
    #[inline(always)]
    fn load(&self, w: [R; D]) -> R {
        (self.cos + self.curvature * dot(w, w)).positive()
    }
    #[inline(always)]
    fn weight_at_rest(&self) -> R {
        self.cos
    }
    #[inline(always)]
    fn square(&self, v: [R; D]) -> R {
        dot(v, v)
    }
    #[inline(always)]
    fn stretch(&self, _axis: usize) -> R {
        R::of(1.0)
    }
    #[inline(always)]
    fn turn(w: [R; D], _from: &(), _to: &()) -> [R; D] {
        w
    }
    #[inline(always)]
    fn thickness(&self, h: R) -> R {
        h
    }
    #[inline(always)]
    fn rounding(&self, h: R, per: R) -> R {
        R::of(1e-14) * (self.beta * h * per + self.cos)
    }
    #[inline(always)]
    fn elevation(&self) -> R {
        R::of(f64::NAN)
    }
    #[inline(always)]
    fn outside(&self) -> R::Mask {
        self.cos.le(R::zero())
    }
    fn mirror(mut self, axis: usize) -> Self {
        self.tilt[axis] = -self.tilt[axis];
        self
    }
}

/// A cell of a terrain z = b(x, y), SI units (Bouchut & Westdickenberg, Commun. Math. Sci. 2, 2004, for the true
/// horizontal velocity w and the volume per plan area H = h/c).
///
/// psi = g (b + c^2 H), M = I - s s^T, s = c grad b, beta = g c^2 (1 - s_axis^2). A cell outside the data has c = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terrain<const D: usize, R> {
    /// g b \[m^2/s^2\].
    pub level: R,
    /// grad b.
    pub slope: [R; D],
    /// c = 1/sqrt(1 + |grad b|^2).
    pub cos: R,
    /// g c \[m/s^2\].
    pub fall: R,
    /// c D^2 b \[1/m\]; only the upper triangle is stored.
    pub curvature: [[R; D]; D],
    /// See [`Bed::bend`]: (beta_hi - beta_lo)/(4 dx) - g (1 - s^2) (c_hi^2 - c_lo^2)/(2 dx).
    pub bend: [R; D],
}

impl<const D: usize, R: Real> Terrain<D, R> {
    /// A cell outside the data.
    #[inline(always)]
    pub fn nothing() -> Self {
        let zero = R::zero();
        Terrain {
            level: zero,
            slope: [zero; D],
            cos: zero,
            fall: zero,
            curvature: [[zero; D]; D],
            bend: [zero; D],
        }
    }
    /// The part in which the second derivative along axes i and j is kept.
    #[inline(always)]
    fn packed(i: usize, j: usize) -> usize {
        let (i, j) = if i < j { (i, j) } else { (j, i) };
        3 + 2 * D + i * D + j - i * (i + 1) / 2
    }
    #[inline(always)]
    fn metric(&self, mut v: [R; D]) -> [R; D] {
        let along = self.cos * self.cos * dot(self.slope, v);
        unroll!(axis in D => {
            v[axis] = v[axis] - self.slope[axis] * along;
        });
        v
    }
}

impl Terrain<2, f64> {
    /// The ground of a cell of a mountain under `gravity` \[m/s^2\], by column and row, the first row in the south.
    pub fn at(mountain: &Mountain, gravity: f64, cell: [usize; 2]) -> Self {
        let mut here = Self::unbent(mountain, gravity, cell);
        let count = [mountain.bed.columns, mountain.bed.rows];
        for axis in 0..2 {
            if cell[axis] == 0 || cell[axis] + 1 == count[axis] {
                continue;
            }
            let (mut lo, mut hi) = (cell, cell);
            (lo[axis], hi[axis]) = (cell[axis] - 1, cell[axis] + 1);
            let [lo, hi] = [lo, hi].map(|cell| Self::unbent(mountain, gravity, cell));
            if !(lo.outside() || hi.outside() || here.outside()) {
                let s = here.cos * here.slope[axis];
                let pressure = (hi.beta(axis) - lo.beta(axis)) / (4.0 * mountain.bed.cell);
                let tilt = (hi.fall * hi.cos - lo.fall * lo.cos) / (2.0 * mountain.bed.cell);
                here.bend[axis] = pressure - (1.0 - s * s) * tilt;
            }
        }
        here
    }

    /// As [`Terrain::at`], without what the neighbours bend.
    fn unbent(mountain: &Mountain, gravity: f64, [column, row]: [usize; 2]) -> Self {
        let z = mountain.bed.at(column, row);
        if z.is_nan() {
            return Self::nothing();
        }
        let fit = mountain.fit([column, row]);
        let cos = fit.cosine();
        let [xx, xy, yy] = fit.hessian.map(|second| cos * second);
        Terrain {
            level: gravity * z,
            slope: fit.gradient,
            cos,
            fall: gravity * cos,
            curvature: [[xx, xy], [xy, yy]],
            bend: [0.0; 2],
        }
    }
}

// SAFETY: the parts are numbered below COUNT.
unsafe impl<const D: usize, R: Real> Parts<R> for Terrain<D, R> {
    const COUNT: usize = 3 + 2 * D + D * (D + 1) / 2;
    #[inline(always)]
    fn gather(part: impl Fn(usize) -> R) -> Self {
        let mut cell = Terrain { level: part(0), cos: part(1), fall: part(2), ..Terrain::nothing() };
        unroll!(i in D => {
            cell.slope[i] = part(3 + i);
            cell.bend[i] = part(3 + D + i);
            unroll!(j in D => {
                cell.curvature[i][j] = part(Self::packed(i, j));
            });
        });
        cell
    }
    #[inline(always)]
    fn scatter(self, mut put: impl FnMut(usize, R)) {
        put(0, self.level);
        put(1, self.cos);
        put(2, self.fall);
        unroll!(i in D => {
            put(3 + i, self.slope[i]);
            put(3 + D + i, self.bend[i]);
            unroll!(j in D => {
                if j >= i {
                    put(Self::packed(i, j), self.curvature[i][j]);
                }
            });
        });
    }
}

/// The tangent plane of a bed.
#[derive(Clone, Copy, Debug)]
pub struct Tangent<const D: usize, R> {
    slope: [R; D],
    cos: R,
}
parts!([const D: usize, R: Real] Tangent<D, R> { slope: [R; D], cos: R } masks {});

impl<const D: usize, R: Real> Bed<D, R> for Terrain<D, R> {
    type On<L: Real> = Terrain<D, L>;
    type Plane = Tangent<D, R>;
    const BENT: bool = true;
    #[inline(always)]
    fn plane(&self) -> Tangent<D, R> {
        Tangent { slope: self.slope, cos: self.cos }
    }
    #[inline(always)]
    fn beta(&self, axis: usize) -> R {
        let s = self.cos * self.slope[axis];
        self.fall * self.cos * (R::of(1.0) - s * s)
    }
    #[inline(always)]
    fn climb(&self, _axis: usize, _towards: Towards, there: &Self, _dx: R) -> R {
        there.level - self.level
    }
    #[inline(always)]
    fn weight(&self, there: &Self, h: R, h_there: R) -> R {
        there.fall * there.cos * h_there - self.fall * self.cos * h
    }
    #[inline(always)]
    fn pull(&self, lo: [R; D], hi: [R; D], per: [R; D]) -> [R; D] {
        self.metric(straight(lo, hi, per))
    }
    #[inline(always)]
    fn cross(&self, lo: [R; D], hi: [R; D], per: [R; D]) -> [R; D] {
        let straight = straight(lo, hi, per);
        let c2 = self.cos * self.cos;
        let mut cross = [R::zero(); D];
        unroll!(axis in D => {
            let mut others = straight;
            others[axis] = R::zero();
            cross[axis] = -(self.slope[axis] * (c2 * dot(self.slope, others)));
        });
        cross
    }
    #[inline(always)]
    fn bend(&self, axis: usize) -> R {
        self.bend[axis]
    }
    #[inline(always)]
    fn load(&self, w: [R; D]) -> R {
        let mut bent = R::zero();
        unroll!(axis in D => {
            bent = bent + w[axis] * dot(self.curvature[axis], w);
        });
        (self.fall + bent).positive()
    }
    #[inline(always)]
    fn weight_at_rest(&self) -> R {
        self.fall
    }
    #[inline(always)]
    fn square(&self, v: [R; D]) -> R {
        let up = dot(self.slope, v);
        dot(v, v) + up * up
    }
    #[inline(always)]
    fn stretch(&self, axis: usize) -> R {
        (R::of(1.0) + self.slope[axis] * self.slope[axis]).sqrt()
    }
    #[inline(always)]
    fn turn(w: [R; D], from: &Tangent<D, R>, to: &Tangent<D, R>) -> [R; D] {
        // V = (w, grad b . w); what sticks out of the receiver's plane is cut off and the rest stretched to |V|.
        let up = dot(from.slope, w);
        let out = up - dot(to.slope, w);
        let c2 = to.cos * to.cos;
        let whole = dot(w, w) + up * up;
        let left = whole - c2 * (out * out);
        let flat = left.le(R::zero());
        let stretch = R::select(flat, R::of(1.0), (whole / R::select(flat, R::of(1.0), left)).sqrt());
        let mut turned = w;
        unroll!(axis in D => {
            turned[axis] = (w[axis] + c2 * out * to.slope[axis]) * stretch;
        });
        turned
    }
    #[inline(always)]
    fn thickness(&self, h: R) -> R {
        self.cos * h
    }
    #[inline(always)]
    fn rounding(&self, h: R, per: R) -> R {
        // 1e-14 g (|eta| + dx)/dx
        R::of(1e-14) * ((self.level.abs() + self.fall * self.cos * h) * per + self.fall / self.cos)
    }
    #[inline(always)]
    fn elevation(&self) -> R {
        R::select(self.outside(), R::of(f64::NAN), self.level)
    }
    #[inline(always)]
    fn outside(&self) -> R::Mask {
        self.cos.le(R::zero())
    }
    fn mirror(mut self, axis: usize) -> Self {
        self.slope[axis] = -self.slope[axis];
        self.bend[axis] = -self.bend[axis];
        unroll!(other in D => {
            if other != axis {
                self.curvature[axis][other] = -self.curvature[axis][other];
                self.curvature[other][axis] = -self.curvature[other][axis];
            }
        });
        self
    }
}
