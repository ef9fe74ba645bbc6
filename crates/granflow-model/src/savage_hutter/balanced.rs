//! The conservative, positive, exactly resting scheme, in one and two dimensions, on chutes and on terrain.
//!
//! Kinetic flux between moving cells; no mass between cells that hold themselves; friction clipped after the flux,
//! so that it stops and never reverses. The rules and what they were measured against:
//! `docs/decisions/0002-rest.md`.

use super::flux::{Density, Half};
use super::friction::Friction;
use super::ground::{Bed, Towards};
use super::{Flow, normal};
use crate::limiter;
use crate::real::{Real, for_axis, largest, per_axis, total};
use crate::scheme::{
    Cell, Components, Diagnostics, Faces, Neighbours, Scheme, SchemeVisitor, Side, Spacing, Stencil,
    components,
};
use crate::time::{EULER, SSP_RK2, Stages};
use core::marker::PhantomData;

/// The default scheme: friction law, thinnest moving depth, order of accuracy. `ORDER` is the order where it is known when the
/// inner loops are compiled, 1 or 2, so that each order has loops of its own; else 0.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Balanced<F, B, const ORDER: u8 = 0> {
    /// A cell thinner than this keeps what it has (units of h); at least the smallest normal number. (It comes before the law: the
    /// compiler reads all parameters of a law at once, and what follows them, and then takes that apart in every cell.)
    film: f64,
    /// The friction law.
    pub friction: F,
    /// Limited slopes of h and u (second order).
    pub slopes: bool,
    bed: PhantomData<fn() -> B>,
}

impl<F, B> Balanced<F, B> {
    /// First order.
    pub fn first(friction: F, film: f64) -> Self {
        Balanced { friction, film: film.max(f64::MIN_POSITIVE), slopes: false, bed: PhantomData }
    }
    /// Second order.
    pub fn second(friction: F, film: f64) -> Self {
        Balanced { slopes: true, ..Self::first(friction, film) }
    }
    /// The same over another bed.
    pub fn over<C>(&self) -> Balanced<F, C>
    where
        F: Copy,
    {
        let Balanced { film, friction, slopes, .. } = *self;
        Balanced { film, friction, slopes, bed: PhantomData }
    }
}

/// How depth and velocity vary across a cell.
pub trait CellSlopes<const D: usize, R: Real>: Components<R> {
    /// Not at all.
    fn none() -> Self;
    /// By dh and du from the middle to the upper end, where they can.
    fn by(dh: R, du: [R; D]) -> Self;
    /// Depth at one end.
    fn depth(&self, towards: Towards, h: R) -> R;
    /// Velocity at one end.
    fn velocity(&self, towards: Towards, u: [R; D]) -> [R; D];
}

impl<const D: usize, R: Real> CellSlopes<D, R> for () {
    #[inline(always)]
    fn none() {}
    #[inline(always)]
    fn by(_dh: R, _du: [R; D]) {}
    #[inline(always)]
    fn depth(&self, _towards: Towards, h: R) -> R {
        h
    }
    #[inline(always)]
    fn velocity(&self, _towards: Towards, u: [R; D]) -> [R; D] {
        u
    }
}

/// Half of the limited differences across a cell, along one axis.
#[derive(Clone, Copy, Debug)]
pub struct Slope<const D: usize, R> {
    h: R,
    u: [R; D],
}
components!([const D: usize, R: Real] Slope<D, R> { h: R, u: [R; D] });

impl<const D: usize, R: Real> CellSlopes<D, R> for Slope<D, R> {
    #[inline(always)]
    fn none() -> Self {
        Slope { h: R::zero(), u: [R::zero(); D] }
    }
    #[inline(always)]
    fn by(h: R, u: [R; D]) -> Self {
        Slope { h, u }
    }
    #[inline(always)]
    fn depth(&self, towards: Towards, h: R) -> R {
        match towards {
            Towards::Lo => h - self.h,
            Towards::Hi => h + self.h,
        }
        .positive_part()
    }
    #[inline(always)]
    fn velocity(&self, towards: Towards, u: [R; D]) -> [R; D] {
        per_axis!(k => match towards {
            Towards::Lo => u[k] - self.u[k],
            Towards::Hi => u[k] + self.u[k],
        })
    }
}

/// The order of a scheme: 1, 2, or 0 where it is not known when the inner loops are compiled.
#[derive(Clone, Copy, Debug)]
pub struct Order<const ORDER: u8>;

/// How values vary across the cells of a scheme.
pub trait SlopeStorage: Copy + Send + Sync + 'static {
    /// Do they vary, if that is known?
    const LIMITED: Option<bool>;
    /// Along one axis.
    type CellSlopes<const D: usize, R: Real>: CellSlopes<D, R>;
}
impl SlopeStorage for Order<1> {
    const LIMITED: Option<bool> = Some(false);
    type CellSlopes<const D: usize, R: Real> = ();
}
impl SlopeStorage for Order<2> {
    const LIMITED: Option<bool> = Some(true);
    type CellSlopes<const D: usize, R: Real> = Slope<D, R>;
}
impl SlopeStorage for Order<0> {
    const LIMITED: Option<bool> = None;
    type CellSlopes<const D: usize, R: Real> = Slope<D, R>;
}

/// What a cell offers to its faces.
#[derive(Clone, Copy, Debug)]
pub struct FaceStates<const D: usize, R: Real, P, T> {
    h: R,
    u: [R; D],
    /// How they vary, per axis.
    slopes: [P; D],
    /// What the kinetic density sends through the lower and the upper face of each axis.
    half: [[Half<R>; 2]; D],
    /// The plane that the bed lies in.
    plane: T,
    /// What the cell lets out.
    class: CellClass<R>,
}
components!([const D: usize, R: Real, P: Components<R>, T: Components<R>] FaceStates<D, R, P, T> {
    h: R, u: [R; D], slopes: [P; D], half: [[Half<R>; 2]; D], plane: T, class: CellClass<R>
});

/// Is a cell, or one of the two cells of a face, bare or held? A number, so that a few can be asked at once: 0 is open.
#[derive(Clone, Copy, Debug)]
struct CellClass<R> {
    code: R,
}

components!([R: Real] CellClass<R> { code: R });

impl<R: Real> CellClass<R> {
    #[inline(always)]
    fn new(code: R) -> Self {
        CellClass { code }
    }

    /// Dry, or a film, or outside: takes what comes, gives nothing.
    const DRY: f64 = 1.0;
    /// Holds itself: thick, q = 0, and the pull is within the static bound.
    const HELD: f64 = 3.0;

    #[inline(always)]
    fn dry(dry: R::Mask) -> Self {
        CellClass::new(R::select(dry, R::splat(Self::DRY), R::zero()))
    }
    #[inline(always)]
    fn held(self, held: R::Mask) -> Self {
        CellClass::new(R::select(held, R::splat(Self::HELD), self.code))
    }
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        CellClass::new(self.code + other.code)
    }
    /// Both cells of the face, or this one, are open.
    #[inline(always)]
    fn is_open(self) -> R::Mask {
        self.code.equals(R::zero())
    }
    /// This cell, or one of the two, is held.
    #[inline(always)]
    fn is_held(self) -> R::Mask {
        R::splat(Self::HELD).le(self.code)
    }
}

impl<const D: usize, R: Real, P: CellSlopes<D, R>, T> FaceStates<D, R, P, T> {
    /// The share of the density going out through a face that the mean flow carries.
    #[inline(always)]
    fn advected_share(&self, axis: usize, towards: Towards) -> R {
        let flow =
            self.slopes[axis].depth(towards, self.h) * self.slopes[axis].velocity(towards, self.u)[axis];
        let outward = if towards == Towards::Lo { -flow } else { flow };
        let mass = self.half[axis][towards as usize].mass;
        let none = mass.equals(R::zero());
        let share = outward.positive_part() / R::select(none, R::splat(1.0), mass.abs());
        R::select(none, R::zero(), share.min(R::splat(1.0)))
    }
}

/// What passes a face.
#[derive(Clone, Copy, Debug)]
pub struct Flux<const D: usize, R: Real> {
    mass: R,
    /// Momentum along the axis of the face, as its left and its right cell see it.
    left: [R; D],
    right: [R; D],
    /// What its two cells let out.
    class: CellClass<R>,
}
components!([const D: usize, R: Real] Flux<D, R> {
    mass: R, left: [R; D], right: [R; D], class: CellClass<R>
});

/// PotentialJump of the free surface's potential towards both neighbours of an axis.
struct PotentialJump<R> {
    whole: [R; 2],
    /// Its part by thickness, which the flux between open cells carries as pressure.
    weight: [R; 2],
    /// The rest.
    bed_jump: [R; 2],
}

impl<F: Friction, B: Copy, const ORDER: u8> Balanced<F, B, ORDER> {
    /// A pull this much above the static bound still counts as held.
    const SLACK: f64 = 1.0 + 1e-10;

    #[inline(always)]
    fn is_dry<const D: usize, R: Real>(&self, h: R, bed: &B) -> R::Mask
    where
        B: Bed<D, R>,
    {
        h.lt(R::splat(self.film)) | bed.is_nodata()
    }

    /// Largest difference du of the velocity u + du, u - du at a cell's two faces, depths h - dh and h + dh there,
    /// with which at most twice h (|u| + c) leaves, c = sqrt(2 beta h): then dt (|u| + c)/dx <= 1/2 per sum over
    /// the axes keeps h >= 0.
    ///
    /// A half sends at most u+ + 0.21 c per depth. With du <= c + |u| (h - dh)/(h + dh) one face sends
    /// (h + dh)(|u| + du) <= 2 h (|u| + c), and two receding ones 2 h du + 2 dh |u| <= 2 h (|u| + c); 0.9 c leaves
    /// room for the thermal part. Without the bound four thin fast neighbours drain a cell twice over.
    #[inline(always)]
    fn max_slope<R: Real>(h: R, dh: R, u: R, beta: R) -> R {
        let c = ((beta + beta) * h.positive_part()).sqrt();
        let sum = h + dh;
        let dry = sum.le(R::zero());
        let share = R::select(dry, R::zero(), (h - dh) / R::select(dry, R::splat(1.0), sum)).positive_part();
        R::splat(0.9) * c + u * share
    }

    /// At rest or bare.
    #[inline(always)]
    fn is_at_rest_or_dry<const D: usize, R: Real>(&self, cell: &Cell<Flow<D, R>, B>) -> R::Mask
    where
        B: Bed<D, R>,
    {
        cell.state.is_still() | self.is_dry(cell.state.h, &cell.ground)
    }

    /// The rise towards a neighbour. A bare bed above the surface leans on nothing: it counts at most as the surface
    /// continued.
    #[inline(always)]
    fn dry_neighbour<const D: usize, R: Real>(&self, there: &Cell<Flow<D, R>, B>, rise: R, opposite: R) -> R
    where
        B: Bed<D, R>,
    {
        let above = self.is_dry(there.state.h, &there.ground) & R::zero().lt(rise);
        R::select(above, rise.min((-opposite).positive_part()), rise)
    }

    /// Rises towards both neighbours of one axis where neither is bare.
    #[inline(always)]
    fn wet_jump<const D: usize, R: Real>(
        near: &Neighbours<D, R, Flow<D, R>, B>,
        axis: usize,
    ) -> PotentialJump<R>
    where
        B: Bed<D, R>,
    {
        let Cell { state, ground, .. } = &near.here;
        let dx = near.spacing.size[axis];
        let (a, b) = (&near.lo[axis], &near.hi[axis]);
        let bed_jump = [
            ground.bed_jump(axis, Towards::Lo, &a.ground, dx),
            ground.bed_jump(axis, Towards::Hi, &b.ground, dx),
        ];
        let weight = [
            ground.pressure_jump(&a.ground, state.h, a.state.h),
            ground.pressure_jump(&b.ground, state.h, b.state.h),
        ];
        PotentialJump { whole: [bed_jump[0] + weight[0], bed_jump[1] + weight[1]], weight, bed_jump }
    }

    /// Rises towards both neighbours of one axis, as a resting cell counts them.
    #[inline(always)]
    fn potential_jump<const D: usize, R: Real>(
        &self,
        near: &Neighbours<D, R, Flow<D, R>, B>,
        axis: usize,
    ) -> PotentialJump<R>
    where
        B: Bed<D, R>,
    {
        let rise = Self::wet_jump(near, axis);
        let (a, b) = (&near.lo[axis], &near.hi[axis]);
        let dry = [self.is_dry(a.state.h, &a.ground), self.is_dry(b.state.h, &b.ground)];
        if !R::any(dry[0] | dry[1]) {
            return rise;
        }
        let (out_lo, out_hi) = (a.ground.is_nodata(), b.ground.is_nodata());
        let zero = R::zero();
        let (lo, hi) = (R::select(out_lo, zero, rise.whole[0]), R::select(out_hi, zero, rise.whole[1]));
        let (bare_lo, bare_hi) = (self.dry_neighbour(a, lo, hi), self.dry_neighbour(b, hi, lo));
        // Outside the data the surface goes on as it comes; from one side only, there is no difference.
        let bare_lo = R::select(out_lo, -bare_hi, bare_lo);
        let bare_hi = R::select(out_hi, -bare_lo, bare_hi);
        let whole = [bare_lo, bare_hi];
        let weight = [R::select(out_lo, zero, rise.weight[0]), R::select(out_hi, zero, rise.weight[1])];
        let bed_jump: [R; 2] =
            per_axis!(side => R::select(dry[side], whole[side] - weight[side], rise.bed_jump[side]));
        PotentialJump { whole, weight, bed_jump }
    }
}

type SlopesOf<const D: usize, R, const ORDER: u8> = <Order<ORDER> as SlopeStorage>::CellSlopes<D, R>;
type EdgesOf<const D: usize, R, B, const ORDER: u8> =
    FaceStates<D, R, SlopesOf<D, R, ORDER>, <B as Bed<D, R>>::Plane>;

impl<F: Friction, B: Copy, const ORDER: u8> Balanced<F, B, ORDER>
where
    Order<ORDER>: SlopeStorage,
{
    /// Do depth and velocity vary across a cell?
    #[inline(always)]
    fn limited(&self) -> bool {
        match Order::<ORDER>::LIMITED {
            Some(limited) => limited,
            None => self.slopes,
        }
    }

    /// Limited slopes along one axis, and the halves at the cell's two ends.
    #[inline(always)]
    fn limited_slopes<const D: usize, R: Real>(
        &self,
        near: &Neighbours<D, R, Flow<D, R>, B>,
        u: [R; D],
        axis: usize,
        edges: &mut EdgesOf<D, R, B, ORDER>,
    ) where
        B: Bed<D, R>,
    {
        let Flow { h, .. } = near.here.state;
        let (a, b) = (&near.lo[axis].state, &near.hi[axis].state);
        let (ua, ub) = (a.velocity(), b.velocity());
        // Beside a cell at rest or bare there is no smooth flow to be second order in. A velocity reconstructed
        // down to 0 at a held cell's face carries nothing there, and two cells push each other for ever (silo);
        // thin cells beside bare ones trickle for ever (mountains).
        let smooth = !(self.is_at_rest_or_dry(&near.lo[axis]) | self.is_at_rest_or_dry(&near.hi[axis]));
        let half = R::select(smooth, R::splat(0.5), R::zero());
        let dh = half * limiter::central(h - a.h, b.h - h);
        let mut du: [R; D] = per_axis!(k => half * limiter::central(u[k] - ua[k], ub[k] - u[k]));
        let beta = near.here.ground.beta(axis);
        // Most differences are below 0.9 c, without any root.
        let wide = (R::splat(0.81) * (beta + beta) * h.positive_part()).lt(du[axis] * du[axis]);
        if R::any(wide) {
            let most = Self::max_slope(h, dh.abs(), u[axis].abs(), beta);
            du[axis] = R::select(wide, du[axis].min(most).max(-most), du[axis]);
        }
        let slopes = SlopesOf::<D, R, ORDER>::by(dh, du);
        edges.slopes[axis] = slopes;
        let depth = [slopes.depth(Towards::Lo, h), slopes.depth(Towards::Hi, h)];
        let velocity = [slopes.velocity(Towards::Lo, u)[axis], slopes.velocity(Towards::Hi, u)[axis]];
        let [lo, hi] = Density::ends(depth, velocity, beta);
        let (lo, hi) = (lo.halves(depth[0])[0], hi.halves(depth[1])[1]);
        edges.half[axis] = [lo, hi];
    }
}

/// How a mass would stand in its cell at rest.
struct StaticBalance<const D: usize, R> {
    /// The largest drop towards a neighbour, by the whole rise or by thickness alone, per axis.
    drop: [R; D],
    /// F = -M grad(psi).
    pull: [R; D],
    /// The static bound of |F|.
    holding: R,
}

impl<F: Friction, B: Copy, const ORDER: u8> Balanced<F, B, ORDER> {
    /// Acceleration of a cell by the bed, and by thickness where the flux does not carry it, beside what passes its faces.
    #[inline(always)]
    fn pull<const D: usize, R: Real>(
        &self,
        stencil: &impl Stencil<D, R, Flow<D, R>, B>,
        bed: &B,
        faces: &[Faces<Flux<D, R>>; D],
        all_open: bool,
    ) -> [R; D]
    where
        B: Bed<D, R>,
    {
        let near = stencil.star();
        let (zero, per) = (R::zero(), near.spacing.inv);
        let (mut lo, mut hi, mut bend) = ([zero; D], [zero; D], [R::splat(1.0); D]);
        let (mut weight_lo, mut weight_hi) = ([zero; D], [zero; D]);
        for_axis!(axis in D => {
            let rise = if all_open { Self::wet_jump(&near, axis) } else { self.potential_jump(&near, axis) };
            [lo[axis], hi[axis]] = rise.bed_jump;
            [weight_lo[axis], weight_hi[axis]] = rise.weight;
            if !all_open {
                // The flux carries no pressure where a cell of the face is held, and what mends it goes with it.
                let (at_lo, at_hi) = (faces[axis].lo.class.is_held(), faces[axis].hi.class.is_held());
                lo[axis] = R::select(at_lo, rise.whole[0], lo[axis]);
                hi[axis] = R::select(at_hi, rise.whole[1], hi[axis]);
                weight_lo[axis] = R::select(at_lo, zero, weight_lo[axis]);
                weight_hi[axis] = R::select(at_hi, zero, weight_hi[axis]);
                let half = R::splat(0.5);
                bend[axis] = R::select(at_lo, zero, half) + R::select(at_hi, zero, half);
            }
        });
        let mut pull = bed.driving_force(lo, hi, per);
        if bed.uniform_driving_force().is_none() {
            let cross = bed.cross_force(weight_lo, weight_hi, per);
            for_axis!(k in D => {
                let change = bed.curvature_force(k, &near.lo[k].ground, &near.hi[k].ground, per[k]);
                pull[k] = pull[k] + cross[k] + change * near.here.state.h * bend[k];
            });
        }
        pull
    }

    #[inline(always)]
    fn static_balance<const D: usize, R: Real>(
        &self,
        near: &Neighbours<D, R, Flow<D, R>, B>,
    ) -> StaticBalance<D, R>
    where
        B: Bed<D, R>,
    {
        let mut near = *near;
        near.here.ground = near.here.ground.exact();
        for_axis!(axis in D => {
            near.lo[axis].ground = near.lo[axis].ground.exact();
            near.hi[axis].ground = near.hi[axis].ground.exact();
        });
        let Cell { state, ground, .. } = &near.here;
        let zero = R::zero();
        let (mut lo, mut hi, mut drop) = ([zero; D], [zero; D], [zero; D]);
        for_axis!(axis in D => {
            let PotentialJump { whole: [a, b], weight: [c, d], .. } = self.potential_jump(&near, axis);
            (lo[axis], hi[axis]) = (a, b);
            drop[axis] = (-a).min(-c).max((-b).min(-d));
        });
        let at_rest = ground.weight_at_rest();
        let thickness = ground.thickness(state.h).max(R::splat(f64::MIN_POSITIVE));
        let holding = self.friction.resistance(thickness, zero, at_rest, at_rest).holding;
        StaticBalance { drop, pull: ground.driving_force(lo, hi, near.spacing.inv), holding }
    }
}

impl<F: Friction, const D: usize, R: Real, B: Bed<D, R>, const ORDER: u8> Scheme<D, R>
    for Balanced<F, B, ORDER>
where
    Order<ORDER>: SlopeStorage,
{
    type State = Flow<D, R>;
    type Ground = B;
    type Forcing = ();
    type Primitives = [Density<R>; D];
    type FaceStates = EdgesOf<D, R, B, ORDER>;
    type Flux = Flux<D, R>;
    type Corner = ();

    /// Euler's method at first order, else [`SSP_RK2`].
    fn stages(&self) -> Stages {
        if self.slopes { SSP_RK2 } else { EULER }
    }
    /// 1 at first order, else 1/2: the depth stays positive.
    fn max_courant(&self) -> f64 {
        if self.slopes { 0.5 } else { 1.0 }
    }

    fn with_scalar<L: Real, V: SchemeVisitor<D, L>>(&self, visitor: V) -> V::Output {
        let Balanced { friction, film, slopes, .. } = *self;
        if slopes {
            visitor.visit(&Balanced::<F, B::On<L>, 2> { friction, film, slopes, bed: PhantomData })
        } else {
            visitor.visit(&Balanced::<F, B::On<L>, 1> { friction, film, slopes, bed: PhantomData })
        }
    }

    #[inline(always)]
    fn primitives(&self, Cell { state, ground, .. }: &Cell<Flow<D, R>, B>) -> [Density<R>; D] {
        if self.limited() {
            // The halves are those of the cell's ends; here only the velocity is needed.
            let u = state.velocity();
            return per_axis!(axis => Density::mean(u[axis]));
        }
        per_axis!(axis => Density::new(state.h.positive_part(), state.q[axis], ground.beta(axis)))
    }

    #[inline(always)]
    fn reconstruct(
        &self,
        stencil: &impl Stencil<D, R, Flow<D, R>, B>,
        prime: &[Density<R>; D],
    ) -> Self::FaceStates {
        let near = stencil.star();
        let Cell { state, ground, .. } = near.here;
        let per = near.spacing.inv;
        let u: [R; D] = per_axis!(axis => prime[axis].u);
        let dry = self.is_dry(state.h, &ground);
        let mut edges = FaceStates {
            h: state.h,
            u,
            slopes: [SlopesOf::<D, R, ORDER>::none(); D],
            half: [[Half::none(); 2]; D],
            plane: ground.plane(),
            class: CellClass::dry(dry),
        };
        let at_rest_or_dry = dry | state.is_still();
        let mut closed = dry;
        if R::any(at_rest_or_dry) {
            let still = at_rest_or_dry & !dry;
            if R::any(still) {
                let static_balance = self.static_balance(&near);
                let bound =
                    static_balance.holding * R::splat(Self::SLACK) + ground.rounding(state.h, largest(per));
                let mut held = ground.square(static_balance.pull).le(bound * bound) & still;
                // A symmetric tower pulls nowhere, yet falls: bound the drop towards each neighbour too.
                for_axis!(axis in D => {
                    let most = bound * near.spacing.size[axis] * ground.stretch(axis);
                    held = held & static_balance.drop[axis].le(most);
                });
                edges.class = edges.class.held(held);
                closed = closed | held;
            }
            // A held cell and a dry one give nothing.
            if !R::any(!closed) {
                return edges;
            }
        }
        for_axis!(axis in D => {
            if self.limited() {
                self.limited_slopes(&near, u, axis, &mut edges);
            } else {
                edges.half[axis] = prime[axis].halves(state.h.positive_part());
            }
        });
        if R::any(closed) {
            for_axis!(axis in D => {
                edges.half[axis] = per_axis!(side => edges.half[axis][side].only(!closed));
            });
        }
        edges
    }

    #[inline(always)]
    fn flux(&self, axis: usize, left: &Self::FaceStates, right: &Self::FaceStates) -> Flux<D, R> {
        let (zero, one) = (R::zero(), R::splat(1.0));
        let (half_a, half_b) = (left.half[axis][1], right.half[axis][0]);
        let class = left.class.and(right.class);
        let mut flux = Flux { mass: zero, left: [zero; D], right: [zero; D], class };
        let all_open = !R::any(!class.is_open());
        if all_open || R::any(left.class.is_open() | right.class.is_open()) {
            let u_a = left.slopes[axis].velocity(Towards::Hi, left.u);
            let u_b = right.slopes[axis].velocity(Towards::Lo, right.u);
            let both = half_a.push + half_b.push;
            let (mut share_a, mut share_b, mut push_a, mut push_b) = (one, one, both, both);
            if !all_open {
                let (left_held, right_held) = (left.class.is_held(), right.class.is_held());
                // Into a held cell goes only what is carried there, the rest of the density is reflected. It feels its
                // neighbours' thickness through its pull; of the flux it takes the impact.
                share_a = R::select(right_held, left.advected_share(axis, Towards::Hi), one);
                share_b = R::select(left_held, right.advected_share(axis, Towards::Lo), one);
                let reflected_a = R::select(right_held, half_a.reflected(u_a[axis], share_a), both);
                let reflected_b = R::select(left_held, half_b.reflected(u_b[axis], share_b), both);
                push_a = R::select(left_held, zero, reflected_a);
                push_b = R::select(right_held, zero, reflected_b);
            }
            let (mass_a, mass_b) = (half_a.mass * share_a, half_b.mass * share_b);
            let [turned_a, turned_b] = B::parallel_transport([u_a, u_b], [&left.plane, &right.plane]);
            flux.mass = mass_a + mass_b;
            for_axis!(k in D => {
                flux.left[k] = mass_a * u_a[k] + mass_b * turned_b[k];
                flux.right[k] = mass_a * turned_a[k] + mass_b * u_b[k];
            });
            flux.left[axis] = flux.left[axis] + push_a;
            flux.right[axis] = flux.right[axis] + push_b;
        }
        flux
    }

    #[inline(always)]
    fn corner(&self, _around: [[&Self::FaceStates; 2]; 2]) {}
    #[inline(always)]
    fn update(
        &self,
        stencil: &impl Stencil<D, R, Flow<D, R>, B>,
        edges: &Self::FaceStates,
        faces: &[Faces<Flux<D, R>>; D],
        _corners: &[[(); 2]; 2],
        dt: R,
    ) -> Flow<D, R> {
        let Cell { state, ground, .. } = stencil.at([0; D]);
        let (bed, spacing) = (ground.exact(), stencil.spacing());
        let (zero, per) = (R::zero(), spacing.inv);
        let Flow { h, q } = state;
        let lambda: [R; D] = per_axis!(axis => dt * per[axis]);
        let gone: [R; D] = per_axis!(axis => lambda[axis] * (faces[axis].hi.mass - faces[axis].lo.mass));
        let gone = total(gone);
        let lost: [R; D] = per_axis!(k => {
            let lost: [R; D] = per_axis!(axis => lambda[axis] * (faces[axis].hi.left[k] - faces[axis].lo.right[k]));
            total(lost)
        });
        let gates: [R; D] = per_axis!(axis => faces[axis].lo.class.code + faces[axis].hi.class.code);
        let open = total(gates).equals(zero);
        let all_open = !R::any(!open);
        let mut at_rest_or_dry = None;
        if !all_open {
            // What holds itself or is bare, and is not touched, stays: leave out the work.
            let mut stays = !edges.class.is_open() & gone.equals(zero);
            for_axis!(k in D => {
                stays = stays & lost[k].equals(zero) & q[k].equals(zero);
            });
            if !R::any(!stays) {
                return state;
            }
            at_rest_or_dry = Some(stays);
        }
        // One difference of symmetric sums: the axes can be exchanged to the last bit.
        let new = normal(h - gone);
        let mut moved: [R; D] = per_axis!(k => q[k] - lost[k]);
        // The depth under the source: the new one keeps draining cells bounded; at second order the old one
        // keeps the map a forward-Euler step wherever the depth does not halve.
        let depth = if self.limited() { h.min(new + new) } else { new }.positive_part();
        let pull = match bed.uniform_driving_force() {
            Some(slide) if all_open => slide,
            slide => {
                let pull = self.pull(stencil, &bed, faces, all_open);
                slide.map_or(pull, |slide| per_axis!(k => R::select(open, slide[k], pull[k])))
            }
        };
        for_axis!(k in D => {
            moved[k] = moved[k] + dt * depth * pull[k];
        });

        let thickness = bed.thickness(new).max(R::splat(f64::MIN_POSITIVE));
        let old = edges.u;
        let square = bed.square(old);
        let law = self.friction.resistance(thickness, square, bed.normal_load(old), bed.weight_at_rest());
        let still = state.is_still();
        let mut dry = law.dry;
        if R::any(still) {
            let resting = law.holding * R::splat(Self::SLACK) + bed.rounding(h, largest(per));
            dry = R::select(still, resting, dry);
        }
        let size = bed.square(moved).sqrt();
        let loss = dt * depth * dry;
        let left = size - loss;
        // Slower than before, and within a step not by the last place of its depth: it has stopped.
        let mut spent = (left * largest(lambda)).le(R::splat(1e-15) * new);
        if R::any(spent) {
            spent = spent & left.le(square.sqrt() * h);
        }
        let stops = left.le(zero) | spent | new.lt(R::splat(self.film));
        let mut keep = left / R::select(stops, R::splat(1.0), size);
        if R::any(!law.drag.equals(zero)) {
            // v + dt drag v^2 = left/h, solved for v: the part that grows with the square, implicitly.
            let z = R::select(stops, zero, dt * law.drag * left / R::select(stops, R::splat(1.0), new));
            keep = keep * (R::splat(2.0) / (R::splat(1.0) + (R::splat(1.0) + R::splat(4.0) * z).sqrt()));
        }
        let mut slowed: [R; D] = per_axis!(k => R::select(stops, zero, moved[k] * keep));
        if self.limited() {
            // Along the new velocity friction is first order in time where the flow turns. Where a step takes at most
            // a quarter of the momentum it acts along the old one, as in a forward-Euler step.
            let speed = square.sqrt();
            let taken = dt * depth * (law.dry + law.drag * square);
            let far = (taken * R::splat(4.0)).lt(size) & !(still | stops | speed.le(zero));
            let share = taken / R::select(far, speed, R::splat(1.0));
            for_axis!(k in D => {
                slowed[k] = R::select(far, moved[k] - share * old[k], slowed[k]);
            });
        }
        match at_rest_or_dry {
            None => Flow { h: new, q: slowed },
            Some(at_rest_or_dry) => Flow {
                h: R::select(at_rest_or_dry, h, new),
                q: per_axis!(k => R::select(at_rest_or_dry, q[k], slowed[k])),
            },
        }
    }

    fn mirror(&self, axis: usize, state: &Flow<D, R>) -> Flow<D, R> {
        state.mirror(axis)
    }
    fn mirror_ground(&self, axis: usize, ground: &B) -> B {
        ground.mirror(axis)
    }
    /// A film never sets the step.
    #[inline(always)]
    fn rate(&self, here: &Cell<Flow<D, R>, B>, spacing: &Spacing<D, R>) -> R {
        let rate = here.state.rate(&here.ground, spacing.inv);
        R::select(here.state.h.lt(R::splat(self.film)), R::zero(), rate)
    }
    /// A cell whose last stage ended at rest is at rest; its depth is the average.
    #[inline(always)]
    fn rk_combine(&self, keep: R, old: &Flow<D, R>, new: &Flow<D, R>) -> Flow<D, R> {
        let give = R::splat(1.0) - keep;
        let stopped = new.is_still();
        Flow {
            h: keep * old.h + give * new.h,
            q: per_axis!(k => R::select(stopped, R::zero(), keep * old.q[k] + give * new.q[k])),
        }
    }
    /// q = 0: a cell that a step leaves at rest and unchanged, every later step leaves so. Not only held cells: where the
    /// surface or the bed bends, the pull by central differences may exceed the bound, or the drop to one neighbour,
    /// while the forces through the faces do not, and held neighbours take nothing from it.
    #[inline(always)]
    fn is_static(&self, here: &Cell<Flow<D, R>, B>) -> R::Mask {
        self.is_at_rest_or_dry(here)
    }
    #[inline(always)]
    fn is_nodata(&self, ground: &B) -> R::Mask {
        ground.is_nodata()
    }
    #[inline(always)]
    fn outflow(&self, flux: &Flux<D, R>, _side: Side) -> R {
        flux.mass
    }
    fn yield_ratio(&self, stencil: &impl Stencil<D, R, Flow<D, R>, B>) -> R {
        let near = stencil.star();
        let StaticBalance { pull, holding, .. } = self.static_balance(&near);
        let dry = self.is_dry(near.here.state.h, &near.here.ground);
        let none = dry | holding.le(R::zero());
        let share = near.here.ground.square(pull).sqrt() / R::select(none, R::splat(1.0), holding);
        R::select(none, R::zero(), share)
    }
    #[inline(always)]
    fn diagnostics(&self, here: &Cell<Flow<D, R>, B>) -> Diagnostics<R> {
        here.state.diagnostics(&here.ground, R::splat(self.film))
    }
}
