//! A piece of a mountain.

use super::bed::{Bed, Towards, straight};
use crate::real::{Real, dot, for_axis, per_axis, repeated};
use crate::scheme::{Components, components};

/// A cell of a terrain z = b(x, y), SI units (Bouchut & Westdickenberg, Commun. Math. Sci. 2, 2004, for the true
/// horizontal velocity w and the volume per plan area H = h/c).
///
/// psi = g (b + k c^2 H), M = I - s s^T, s = c grad b, beta = g k c^2 (1 - s_axis^2), k = 1 if nobody says another
/// ([`Terrain::with_pressure`]). A cell outside the data has c = 0. A grid keeps all but b, g and g k in single precision, 6e-8 of a slope; for the metric, the friction and the weight of a cell, and
/// wherever rest is decided, c follows from its slope as it is kept ([`Bed::exact`]); differences between cells and the turn
/// of a velocity into the next plane are right to 1e-7.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terrain<const D: usize, R> {
    /// b \[m\].
    pub level: R,
    /// grad b.
    pub slope: [R; D],
    /// c = 1/sqrt(1 + |grad b|^2).
    pub cos: R,
    /// c D^2 b \[1/m\]; only the upper triangle is stored.
    pub curvature: [[R; D]; D],
    /// g \[m/s^2\], the same in all cells, also outside the data.
    pub gravity: R,
    /// g k \[m/s^2\], k the earth-pressure coefficient; the same in all cells.
    pub pressure: R,
}

impl<const D: usize, R: Real> Terrain<D, R> {
    /// A cell outside the data.
    #[inline(always)]
    pub fn nothing(gravity: R) -> Self {
        let zero = R::zero();
        Terrain {
            level: zero,
            slope: repeated(zero),
            cos: zero,
            curvature: repeated(repeated(zero)),
            gravity,
            pressure: gravity,
        }
    }
    /// The part in which the second derivative along axes i and j is kept.
    #[inline(always)]
    fn packed(i: usize, j: usize) -> usize {
        let (i, j) = if i < j { (i, j) } else { (j, i) };
        2 + D + i * D + j - i * (i + 1) / 2
    }
    /// g c \[m/s^2\].
    #[inline(always)]
    fn fall(&self) -> R {
        self.gravity * self.cos
    }
}

impl Terrain<2, f64> {
    /// A cell at `level` \[m\] with slope `gradient`, unit normal component `cos` = 1/sqrt(1 + |grad b|^2) and second
    /// derivatives `hessian` = \[b_xx, b_xy, b_yy\] \[1/m\].
    pub fn of(level: f64, gradient: [f64; 2], cos: f64, hessian: [f64; 3], gravity: f64) -> Self {
        let [xx, xy, yy] = hessian.map(|second| cos * second);
        Terrain { level, slope: gradient, cos, curvature: [[xx, xy], [xy, yy]], gravity, pressure: gravity }
    }

    /// The same under the earth-pressure coefficient `k`.
    #[must_use]
    pub fn with_pressure(self, k: f64) -> Self {
        Terrain { pressure: self.gravity * k, ..self }
    }
}

/// By hand: the curvature is kept as a triangle, and all but the level and what is the same everywhere in single precision.
impl<const D: usize, R: Real> Components<R> for Terrain<D, R> {
    const COUNT: usize = 4 + D + D * (D + 1) / 2;
    const UNIFORM_MASK: u32 = 0b11 << (Self::COUNT - 2);
    const F32_MASK: u32 = (1 << (Self::COUNT - 2)) - 2;
    #[inline(always)]
    fn load(part: impl Fn(usize) -> R) -> Self {
        let (gravity, pressure) = (part(Self::COUNT - 2), part(Self::COUNT - 1));
        let mut cell = Terrain { level: part(0), cos: part(1), pressure, ..Terrain::nothing(gravity) };
        for_axis!(i in D => {
            cell.slope[i] = part(2 + i);
            for_axis!(j in D => {
                cell.curvature[i][j] = part(Self::packed(i, j));
            });
        });
        cell
    }
    #[inline(always)]
    fn store(self, mut put: impl FnMut(usize, R)) {
        put(0, self.level);
        put(1, self.cos);
        for_axis!(i in D => {
            put(2 + i, self.slope[i]);
            for_axis!(j in D => {
                if j >= i {
                    put(Self::packed(i, j), self.curvature[i][j]);
                }
            });
        });
        put(Self::COUNT - 2, self.gravity);
        put(Self::COUNT - 1, self.pressure);
    }
}

/// The tangent plane of a bed.
#[derive(Clone, Copy, Debug)]
pub struct Tangent<const D: usize, R> {
    slope: [R; D],
    /// c^2
    square: R,
}
components!([const D: usize, R: Real] Tangent<D, R> { slope: [R; D], square: R });

/// 1/sqrt(1 - t) for t in \[0, 1): a polynomial without roots and divisions up to t = 1/32, planes at 10 degrees to each other.
#[inline(always)]
fn stretch<R: Real>(t: R) -> R {
    /// (f - 1)/t by powers of t: with it f has the smallest relative error on \[0, 1/32\] that its degree allows, 7e-18 (Remez's
    /// exchange). Taylor's series would need three terms more.
    const FACTORS: [f64; 7] = [
        0.500_000_000_000_017_3,
        0.374_999_999_985_889_34,
        0.312_500_003_884_920_1,
        0.273_436_993_594_434_13,
        0.246_128_970_170_969_7,
        0.224_246_064_451_280_17,
        0.235_581_606_796_899_93,
    ];
    let one = R::splat(1.0);
    // In pairs, which do not wait for each other (Estrin).
    let square = t * t;
    let low = (R::splat(FACTORS[0]) + R::splat(FACTORS[1]) * t)
        + (R::splat(FACTORS[2]) + R::splat(FACTORS[3]) * t) * square;
    let high = (R::splat(FACTORS[4]) + R::splat(FACTORS[5]) * t) + R::splat(FACTORS[6]) * square;
    let mut sum = one + (low + high * (square * square)) * t;
    let far = R::splat(1.0 / 32.0).lt(t);
    if R::any(far) {
        let steep = one.le(t);
        let exact = one / (one - R::select(steep, R::zero(), t)).sqrt();
        sum = R::select(far, exact, sum);
    }
    sum
}

impl<const D: usize, R: Real> Bed<D, R> for Terrain<D, R> {
    type On<L: Real> = Terrain<D, L>;
    type Plane = Tangent<D, R>;
    /// psi
    type Surface = R;
    #[inline(always)]
    fn surface(&self, h: R, _size: [R; D]) -> R {
        self.gravity * self.level + self.head() * h
    }
    #[inline(always)]
    fn rise(_axis: usize, [a, b]: [&R; 2]) -> R {
        *b - *a
    }
    #[inline(always)]
    fn potential(surface: &R) -> R {
        *surface
    }
    /// g k c^2 \[m/s^2\]: pressure at the bed of a column of H = 1, beta across the slope.
    #[inline(always)]
    fn head(&self) -> R {
        self.pressure * (self.cos * self.cos)
    }
    #[inline(always)]
    fn per_head(&self) -> R {
        let per = (R::splat(1.0) + dot(self.slope, self.slope)) * (R::splat(1.0) / self.pressure);
        R::select(self.is_nodata(), R::zero(), per)
    }
    #[inline(always)]
    fn stretch_in(plane: &Tangent<D, R>, axis: usize) -> R {
        (R::splat(1.0) + plane.slope[axis] * plane.slope[axis]).sqrt()
    }
    #[inline(always)]
    fn metric(plane: &Tangent<D, R>, mut v: [R; D]) -> [R; D] {
        let along = plane.square * dot(plane.slope, v);
        for_axis!(axis in D => {
            v[axis] = v[axis] - plane.slope[axis] * along;
        });
        v
    }
    #[inline(always)]
    fn square_in(plane: &Tangent<D, R>, v: [R; D]) -> R {
        let up = dot(plane.slope, v);
        dot(v, v) + up * up
    }
    #[inline(always)]
    fn gravity(&self) -> R {
        self.gravity
    }
    #[inline(always)]
    fn exact(self) -> Self {
        // One step of Newton's: 6e-8 become 5e-15.
        let whole = (self.cos * self.cos) * (R::splat(1.0) + dot(self.slope, self.slope));
        Terrain { cos: self.cos * (R::splat(1.5) - R::splat(0.5) * whole), ..self }
    }
    #[inline(always)]
    fn plane(&self) -> Tangent<D, R> {
        Tangent { slope: self.slope, square: self.cos * self.cos }
    }
    #[inline(always)]
    fn beta(&self, axis: usize) -> R {
        let s = self.cos * self.slope[axis];
        self.head() * (R::splat(1.0) - s * s)
    }
    #[inline(always)]
    fn bed_jump(&self, _axis: usize, _towards: Towards, there: &Self, _dx: R) -> R {
        self.gravity * (there.level - self.level)
    }
    #[inline(always)]
    fn pressure_jump(&self, there: &Self, h: R, h_there: R) -> R {
        there.head() * h_there - self.head() * h
    }
    #[inline(always)]
    fn driving_force(&self, lo: [R; D], hi: [R; D], per: [R; D]) -> [R; D] {
        Self::metric(&self.plane(), straight(lo, hi, per))
    }
    #[inline(always)]
    fn uniform_driving_force(&self) -> Option<[R; D]> {
        None
    }
    #[inline(always)]
    fn cross_force(&self, lo: [R; D], hi: [R; D], per: [R; D]) -> [R; D] {
        let straight = straight(lo, hi, per);
        let c2 = self.cos * self.cos;
        let mut cross = repeated(R::zero());
        for_axis!(axis in D => {
            let mut others = straight;
            others[axis] = R::zero();
            cross[axis] = -(self.slope[axis] * (c2 * dot(self.slope, others)));
        });
        cross
    }
    #[inline(always)]
    fn curvature_force(&self, axis: usize, lo: &Self, hi: &Self, per: R) -> R {
        // (beta_hi - beta_lo)/(4 dx) - g (1 - s^2) (c_hi^2 - c_lo^2)/(2 dx), 0 beside the edge of the data.
        let s = self.cos * self.slope[axis];
        let pressure = (hi.beta(axis) - lo.beta(axis)) * (per * R::splat(0.25));
        let tilt = (hi.head() - lo.head()) * (per * R::splat(0.5));
        let bend = pressure - (R::splat(1.0) - s * s) * tilt;
        let beside = hi.is_nodata() | lo.is_nodata();
        R::select(beside, R::zero(), bend)
    }
    #[inline(always)]
    fn normal_load(&self, w: [R; D]) -> R {
        let mut bent = R::zero();
        for_axis!(axis in D => {
            bent = bent + w[axis] * dot(self.curvature[axis], w);
        });
        (self.fall() + bent).positive_part()
    }
    #[inline(always)]
    fn weight_at_rest(&self) -> R {
        self.fall()
    }
    #[inline(always)]
    fn square(&self, v: [R; D]) -> R {
        Self::square_in(&self.plane(), v)
    }
    #[inline(always)]
    fn parallel_transport(w: [[R; D]; 2], planes: [&Tangent<D, R>; 2]) -> [[R; D]; 2] {
        /// Slower than 1e-75 m/s is no speed.
        const LEAST: f64 = 1e-150;
        // V = (w, grad b . w); what sticks out of the receiver's plane is cut off and the rest stretched to |V|.
        let up: [R; 2] = per_axis!(side => dot(planes[side].slope, w[side]));
        let out: [R; 2] = per_axis!(side => up[side] - dot(planes[1 - side].slope, w[side]));
        let whole: [R; 2] = per_axis!(side => {
            let square = dot(w[side], w[side]) + up[side] * up[side];
            R::select(square.lt(R::splat(LEAST)), R::splat(1.0), square)
        });
        let per = R::splat(1.0) / (whole[0] * whole[1]);
        per_axis!(side => {
            let to = planes[1 - side];
            let cut = to.square * out[side];
            let stretch = stretch((cut * out[side]) * (whole[1 - side] * per));
            per_axis!(axis => (w[side][axis] + cut * to.slope[axis]) * stretch)
        })
    }
    #[inline(always)]
    fn thickness(&self, h: R) -> R {
        self.cos * h
    }
    #[inline(always)]
    fn rounding(&self, h: R, per: R) -> R {
        // 1e-14 g (|eta| + dx)/dx
        R::splat(1e-14) * ((self.gravity * self.level.abs() + self.head() * h) * per + self.gravity)
    }
    #[inline(always)]
    fn elevation(&self) -> R {
        R::select(self.is_nodata(), R::splat(f64::NAN), self.level)
    }
    #[inline(always)]
    fn is_nodata(&self) -> R::Mask {
        self.cos.le(R::zero())
    }
    fn mirror(mut self, axis: usize) -> Self {
        self.slope[axis] = -self.slope[axis];
        for_axis!(other in D => {
            if other != axis {
                self.curvature[axis][other] = -self.curvature[axis][other];
                self.curvature[other][axis] = -self.curvature[other][axis];
            }
        });
        self
    }
}

#[cfg(test)]
mod tests {
    use super::stretch;

    /// The polynomial and the root meet at 1/32; both are right to one unit in the last place, and nothing is stretched at 0.
    #[test]
    fn stretching_is_right_to_the_last_place() {
        assert_eq!(stretch(0.0), 1.0);
        for k in 0..=100_000 {
            let t = f64::from(k) / 1_600_000.0;
            let exact = 1.0 / (1.0 - t).sqrt();
            assert!((stretch(t) - exact).abs() <= f64::EPSILON, "t = {t}: {} for {exact}", stretch(t));
        }
    }
}
