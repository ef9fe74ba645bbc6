//! The conservative, positive, exactly resting scheme, in one and two dimensions, on chutes and on terrain.
//!
//! Kinetic flux between moving cells; no mass between cells that hold themselves; friction clipped after the flux,
//! so that it stops and never reverses. The rules and what they were measured against:
//! `docs/decisions/0002-rest.md`.

use super::flux::{Density, Half};
use super::friction::Friction;
use super::ground::{Bed, Towards};
use super::{Flow, normal};
use crate::limiter::{self, Varies};
use crate::real::{Real, each, largest, total, unroll};
use crate::scheme::{Cell, Faces, Near, Parts, Scheme, Side, Spacing, Watch, Window, Work, parts};
use core::marker::PhantomData;

/// The default scheme: friction law, thinnest moving depth, order of accuracy. Where it is known that there are no slopes,
/// `LIMITED` is false.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Balanced<F, B, const LIMITED: bool = true> {
    /// A cell thinner than this keeps what it has (units of h); at least the smallest normal number. (It comes before the law: the
    /// compiler reads all parameters of a law at once, and what follows them, and then takes that apart in every cell.)
    film: f64,
    /// The friction law.
    pub friction: F,
    /// Limited slopes of h and u (second order, with [`crate::time::SSP_RK2`]).
    pub slopes: bool,
    bed: PhantomData<fn() -> B>,
}

impl<F, B> Balanced<F, B> {
    /// First order, to be stepped by [`crate::time::EULER`].
    pub fn first(friction: F, film: f64) -> Self {
        Balanced { friction, film: film.max(f64::MIN_POSITIVE), slopes: false, bed: PhantomData }
    }
    /// Second order, to be stepped by [`crate::time::SSP_RK2`].
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
pub trait Spread<const D: usize, R: Real>: Parts<R> {
    /// Not at all.
    fn none() -> Self;
    /// By dh and du from the middle to the upper end, where they can.
    fn by(dh: R, du: [R; D]) -> Self;
    /// Depth at one end.
    fn depth(&self, towards: Towards, h: R) -> R;
    /// Velocity at one end.
    fn velocity(&self, towards: Towards, u: [R; D]) -> [R; D];
}

impl<const D: usize, R: Real> Spread<D, R> for () {
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
parts!([const D: usize, R: Real] Slope<D, R> { h: R, u: [R; D] } masks {});

impl<const D: usize, R: Real> Spread<D, R> for Slope<D, R> {
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
        .positive()
    }
    #[inline(always)]
    fn velocity(&self, towards: Towards, u: [R; D]) -> [R; D] {
        each!(k => match towards {
            Towards::Lo => u[k] - self.u[k],
            Towards::Hi => u[k] + self.u[k],
        })
    }
}

/// How values vary across the cells of a scheme.
pub trait Kind: Copy + Send + Sync + 'static {
    /// Along one axis.
    type Spread<const D: usize, R: Real>: Spread<D, R>;
}
impl Kind for Varies<false> {
    type Spread<const D: usize, R: Real> = ();
}
impl Kind for Varies<true> {
    type Spread<const D: usize, R: Real> = Slope<D, R>;
}

/// What a cell offers to its faces.
#[derive(Clone, Copy, Debug)]
pub struct Edges<const D: usize, R: Real, P, T> {
    h: R,
    u: [R; D],
    /// How they vary, per axis.
    spread: [P; D],
    /// What the kinetic density sends through the lower and the upper face of each axis.
    half: [[Half<R>; 2]; D],
    /// The plane that the bed lies in.
    plane: T,
    /// What the cell lets out.
    gate: Gate<R>,
}
parts!([const D: usize, R: Real, P: Parts<R>, T: Parts<R>] Edges<D, R, P, T> {
    h: R, u: [R; D], spread: [P; D], half: [[Half<R>; 2]; D], plane: T, gate: Gate<R>
} masks {});

/// Is a cell, or one of the two cells of a face, bare or held? A number, so that a few can be asked at once: 0 is open.
#[derive(Clone, Copy, Debug)]
struct Gate<R>(R);

impl<R: Real> Parts<R> for Gate<R> {
    const COUNT: usize = 1;
    #[inline(always)]
    fn gather(part: impl Fn(usize) -> R) -> Self {
        Gate(part(0))
    }
    #[inline(always)]
    fn scatter(self, mut put: impl FnMut(usize, R)) {
        put(0, self.0);
    }
}

impl<R: Real> Gate<R> {
    /// Dry, or a film, or outside: takes what comes, gives nothing.
    const VOID: f64 = 1.0;
    /// Holds itself: thick, q = 0, and the pull is within the static bound.
    const HELD: f64 = 3.0;

    #[inline(always)]
    fn void(void: R::Mask) -> Self {
        Gate(R::select(void, R::of(Self::VOID), R::zero()))
    }
    #[inline(always)]
    fn held(self, held: R::Mask) -> Self {
        Gate(R::select(held, R::of(Self::HELD), self.0))
    }
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Gate(self.0 + other.0)
    }
    /// Both cells of the face, or this one, are open.
    #[inline(always)]
    fn is_open(self) -> R::Mask {
        self.0.same(R::zero())
    }
    /// This cell, or one of the two, is held.
    #[inline(always)]
    fn is_held(self) -> R::Mask {
        R::of(Self::HELD).le(self.0)
    }
}

impl<const D: usize, R: Real, P: Spread<D, R>, T> Edges<D, R, P, T> {
    /// The share of the density going out through a face that the mean flow carries.
    #[inline(always)]
    fn carried(&self, axis: usize, towards: Towards) -> R {
        let flow =
            self.spread[axis].depth(towards, self.h) * self.spread[axis].velocity(towards, self.u)[axis];
        let outward = if towards == Towards::Lo { -flow } else { flow };
        let mass = self.half[axis][towards as usize].mass;
        let none = mass.same(R::zero());
        let share = outward.positive() / R::select(none, R::of(1.0), mass.abs());
        R::select(none, R::zero(), share.min(R::of(1.0)))
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
    gate: Gate<R>,
}
parts!([const D: usize, R: Real] Flux<D, R> {
    mass: R, left: [R; D], right: [R; D], gate: Gate<R>
} masks {});

/// Rise of the free surface's potential towards both neighbours of an axis.
struct Rise<R> {
    whole: [R; 2],
    /// Its part by thickness, which the flux between open cells carries as pressure.
    weight: [R; 2],
    /// The rest.
    climb: [R; 2],
}

impl<F: Friction, B: Copy, const LIMITED: bool> Balanced<F, B, LIMITED> {
    /// A pull this much above the static bound still counts as held.
    const SLACK: f64 = 1.0 + 1e-10;

    #[inline(always)]
    fn is_void<const D: usize, R: Real>(&self, h: R, bed: &B) -> R::Mask
    where
        B: Bed<D, R>,
    {
        h.lt(R::of(self.film)) | bed.outside()
    }

    /// Largest difference du of the velocity u + du, u - du at a cell's two faces, depths h - dh and h + dh there,
    /// with which at most twice h (|u| + c) leaves, c = sqrt(2 beta h): then dt (|u| + c)/dx <= 1/2 per sum over
    /// the axes keeps h >= 0.
    ///
    /// A half sends at most u+ + 0.21 c per depth. With du <= c + |u| (h - dh)/(h + dh) one face sends
    /// (h + dh)(|u| + du) <= 2 h (|u| + c), and two receding ones 2 h du + 2 dh |u| <= 2 h (|u| + c); 0.9 c leaves
    /// room for the thermal part. Without the bound four thin fast neighbours drain a cell twice over.
    #[inline(always)]
    fn most_spread<R: Real>(h: R, dh: R, u: R, beta: R) -> R {
        let c = ((beta + beta) * h.positive()).sqrt();
        let sum = h + dh;
        let dry = sum.le(R::zero());
        let share = R::select(dry, R::zero(), (h - dh) / R::select(dry, R::of(1.0), sum)).positive();
        R::of(0.9) * c + u * share
    }

    /// At rest or bare.
    #[inline(always)]
    fn is_idle<const D: usize, R: Real>(&self, cell: &Cell<Flow<D, R>, B>) -> R::Mask
    where
        B: Bed<D, R>,
    {
        cell.state.is_still() | self.is_void(cell.state.h, &cell.ground)
    }

    /// The rise towards a neighbour. A bare bed above the surface leans on nothing: it counts at most as the surface
    /// continued.
    #[inline(always)]
    fn bare<const D: usize, R: Real>(&self, there: &Cell<Flow<D, R>, B>, rise: R, opposite: R) -> R
    where
        B: Bed<D, R>,
    {
        let above = self.is_void(there.state.h, &there.ground) & R::zero().lt(rise);
        R::select(above, rise.min((-opposite).positive()), rise)
    }

    /// Rises towards both neighbours of one axis where neither is bare.
    #[inline(always)]
    fn thick_rise<const D: usize, R: Real>(near: &Near<D, R, Flow<D, R>, B>, axis: usize) -> Rise<R>
    where
        B: Bed<D, R>,
    {
        let Cell { state, ground } = &near.here;
        let dx = near.spacing.size[axis];
        let (a, b) = (&near.lo[axis], &near.hi[axis]);
        let climb =
            [ground.climb(axis, Towards::Lo, &a.ground, dx), ground.climb(axis, Towards::Hi, &b.ground, dx)];
        let weight =
            [ground.weight(&a.ground, state.h, a.state.h), ground.weight(&b.ground, state.h, b.state.h)];
        Rise { whole: [climb[0] + weight[0], climb[1] + weight[1]], weight, climb }
    }

    /// Rises towards both neighbours of one axis, as a resting cell counts them.
    #[inline(always)]
    fn rise<const D: usize, R: Real>(&self, near: &Near<D, R, Flow<D, R>, B>, axis: usize) -> Rise<R>
    where
        B: Bed<D, R>,
    {
        let rise = Self::thick_rise(near, axis);
        let (a, b) = (&near.lo[axis], &near.hi[axis]);
        let void = [self.is_void(a.state.h, &a.ground), self.is_void(b.state.h, &b.ground)];
        if !R::any(void[0] | void[1]) {
            return rise;
        }
        let (out_lo, out_hi) = (a.ground.outside(), b.ground.outside());
        let zero = R::zero();
        let (lo, hi) = (R::select(out_lo, zero, rise.whole[0]), R::select(out_hi, zero, rise.whole[1]));
        let (bare_lo, bare_hi) = (self.bare(a, lo, hi), self.bare(b, hi, lo));
        // Outside the data the surface goes on as it comes; from one side only, there is no difference.
        let bare_lo = R::select(out_lo, -bare_hi, bare_lo);
        let bare_hi = R::select(out_hi, -bare_lo, bare_hi);
        let whole = [bare_lo, bare_hi];
        let weight = [R::select(out_lo, zero, rise.weight[0]), R::select(out_hi, zero, rise.weight[1])];
        let climb: [R; 2] =
            each!(side => R::select(void[side], whole[side] - weight[side], rise.climb[side]));
        Rise { whole, weight, climb }
    }
}

type SpreadOf<const D: usize, R, const LIMITED: bool> = <Varies<LIMITED> as Kind>::Spread<D, R>;
type EdgesOf<const D: usize, R, B, const LIMITED: bool> =
    Edges<D, R, SpreadOf<D, R, LIMITED>, <B as Bed<D, R>>::Plane>;

impl<F: Friction, B: Copy, const LIMITED: bool> Balanced<F, B, LIMITED>
where
    Varies<LIMITED>: Kind,
{
    /// Limited slopes along one axis, and the halves at the cell's two ends.
    #[inline(always)]
    fn spread<const D: usize, R: Real>(
        &self,
        near: &Near<D, R, Flow<D, R>, B>,
        u: [R; D],
        axis: usize,
        edges: &mut EdgesOf<D, R, B, LIMITED>,
    ) where
        B: Bed<D, R>,
    {
        let Flow { h, .. } = near.here.state;
        let (a, b) = (&near.lo[axis].state, &near.hi[axis].state);
        let (ua, ub) = (a.velocity(), b.velocity());
        // Beside a cell at rest or bare there is no smooth flow to be second order in. A velocity reconstructed
        // down to 0 at a held cell's face carries nothing there, and two cells push each other for ever (silo);
        // thin cells beside bare ones trickle for ever (mountains).
        let smooth = !(self.is_idle(&near.lo[axis]) | self.is_idle(&near.hi[axis]));
        let half = R::select(smooth, R::of(0.5), R::zero());
        let dh = half * limiter::central(h - a.h, b.h - h);
        let mut du: [R; D] = each!(k => half * limiter::central(u[k] - ua[k], ub[k] - u[k]));
        let beta = near.here.ground.beta(axis);
        // Most differences are below 0.9 c, without any root.
        let wide = (R::of(0.81) * (beta + beta) * h.positive()).lt(du[axis] * du[axis]);
        if R::any(wide) {
            let most = Self::most_spread(h, dh.abs(), u[axis].abs(), beta);
            du[axis] = R::select(wide, du[axis].min(most).max(-most), du[axis]);
        }
        let spread = SpreadOf::<D, R, LIMITED>::by(dh, du);
        edges.spread[axis] = spread;
        let depth = [spread.depth(Towards::Lo, h), spread.depth(Towards::Hi, h)];
        let velocity = [spread.velocity(Towards::Lo, u)[axis], spread.velocity(Towards::Hi, u)[axis]];
        let [lo, hi] = Density::ends(depth, velocity, beta);
        let (lo, hi) = (lo.halves(depth[0])[0], hi.halves(depth[1])[1]);
        edges.half[axis] = [lo, hi];
    }
}

/// How a mass would stand in its cell at rest.
struct Stance<const D: usize, R> {
    /// The largest drop towards a neighbour, by the whole rise or by thickness alone, per axis.
    drop: [R; D],
    /// F = -M grad(psi).
    pull: [R; D],
    /// The static bound of |F|.
    holding: R,
}

impl<F: Friction, B: Copy, const LIMITED: bool> Balanced<F, B, LIMITED> {
    /// Acceleration of a cell by the bed, and by thickness where the flux does not carry it, beside what passes its faces.
    #[inline(always)]
    fn pull<const D: usize, R: Real>(
        &self,
        window: &impl Window<D, R, Flow<D, R>, B>,
        bed: &B,
        faces: &[Faces<Flux<D, R>>; D],
        all_open: bool,
    ) -> [R; D]
    where
        B: Bed<D, R>,
    {
        let near = window.cross();
        let (zero, per) = (R::zero(), near.spacing.per);
        let (mut lo, mut hi, mut bend) = ([zero; D], [zero; D], [R::of(1.0); D]);
        let (mut weight_lo, mut weight_hi) = ([zero; D], [zero; D]);
        unroll!(axis in D => {
            let rise = if all_open { Self::thick_rise(&near, axis) } else { self.rise(&near, axis) };
            [lo[axis], hi[axis]] = rise.climb;
            [weight_lo[axis], weight_hi[axis]] = rise.weight;
            if !all_open {
                // The flux carries no pressure where a cell of the face is held, and what mends it goes with it.
                let (at_lo, at_hi) = (faces[axis].lo.gate.is_held(), faces[axis].hi.gate.is_held());
                lo[axis] = R::select(at_lo, rise.whole[0], lo[axis]);
                hi[axis] = R::select(at_hi, rise.whole[1], hi[axis]);
                weight_lo[axis] = R::select(at_lo, zero, weight_lo[axis]);
                weight_hi[axis] = R::select(at_hi, zero, weight_hi[axis]);
                let half = R::of(0.5);
                bend[axis] = R::select(at_lo, zero, half) + R::select(at_hi, zero, half);
            }
        });
        let mut pull = bed.pull(lo, hi, per);
        if bed.slide().is_none() {
            let cross = bed.cross(weight_lo, weight_hi, per);
            unroll!(k in D => {
                let change = bed.bend(k, &near.lo[k].ground, &near.hi[k].ground, per[k]);
                pull[k] = pull[k] + cross[k] + change * near.here.state.h * bend[k];
            });
        }
        pull
    }

    #[inline(always)]
    fn stance<const D: usize, R: Real>(&self, near: &Near<D, R, Flow<D, R>, B>) -> Stance<D, R>
    where
        B: Bed<D, R>,
    {
        let mut near = *near;
        near.here.ground = near.here.ground.exact();
        unroll!(axis in D => {
            near.lo[axis].ground = near.lo[axis].ground.exact();
            near.hi[axis].ground = near.hi[axis].ground.exact();
        });
        let Cell { state, ground } = &near.here;
        let zero = R::zero();
        let (mut lo, mut hi, mut drop) = ([zero; D], [zero; D], [zero; D]);
        unroll!(axis in D => {
            let Rise { whole: [a, b], weight: [c, d], .. } = self.rise(&near, axis);
            (lo[axis], hi[axis]) = (a, b);
            drop[axis] = (-a).min(-c).max((-b).min(-d));
        });
        let at_rest = ground.weight_at_rest();
        let thickness = ground.thickness(state.h).max(R::of(f64::MIN_POSITIVE));
        let holding = self.friction.resistance(thickness, zero, at_rest, at_rest).holding;
        Stance { drop, pull: ground.pull(lo, hi, near.spacing.per), holding }
    }
}

impl<F: Friction, const D: usize, R: Real, B: Bed<D, R>, const LIMITED: bool> Scheme<D, R>
    for Balanced<F, B, LIMITED>
where
    Varies<LIMITED>: Kind,
{
    type State = Flow<D, R>;
    type Ground = B;
    type Prime = [Density<R>; D];
    type Edges = EdgesOf<D, R, B, LIMITED>;
    type Flux = Flux<D, R>;
    type Corner = ();

    fn on<L: Real, W: Work<D, L>>(&self, work: W) -> W::Output {
        let Balanced { friction, film, slopes, .. } = *self;
        if slopes {
            work.with(&Balanced::<F, B::On<L>, true> { friction, film, slopes, bed: PhantomData })
        } else {
            work.with(&Balanced::<F, B::On<L>, false> { friction, film, slopes, bed: PhantomData })
        }
    }

    #[inline(always)]
    fn prime(&self, Cell { state, ground }: &Cell<Flow<D, R>, B>) -> [Density<R>; D] {
        if LIMITED && self.slopes {
            // The halves are those of the cell's ends; here only the velocity is needed.
            let u = state.velocity();
            return each!(axis => Density::mean(u[axis]));
        }
        each!(axis => Density::new(state.h.positive(), state.q[axis], ground.beta(axis)))
    }

    #[inline(always)]
    fn reconstruct(&self, window: &impl Window<D, R, Flow<D, R>, B>, prime: &[Density<R>; D]) -> Self::Edges {
        let near = window.cross();
        let Cell { state, ground } = near.here;
        let per = near.spacing.per;
        let u: [R; D] = each!(axis => prime[axis].u);
        let void = self.is_void(state.h, &ground);
        let mut edges = Edges {
            h: state.h,
            u,
            spread: [SpreadOf::<D, R, LIMITED>::none(); D],
            half: [[Half::none(); 2]; D],
            plane: ground.plane(),
            gate: Gate::void(void),
        };
        let idle = void | state.is_still();
        let mut closed = void;
        if R::any(idle) {
            let still = idle & !void;
            if R::any(still) {
                let stance = self.stance(&near);
                let bound = stance.holding * R::of(Self::SLACK) + ground.rounding(state.h, largest(per));
                let mut held = ground.square(stance.pull).le(bound * bound) & still;
                // A symmetric tower pulls nowhere, yet falls: bound the drop towards each neighbour too.
                unroll!(axis in D => {
                    let most = bound * near.spacing.size[axis] * ground.stretch(axis);
                    held = held & stance.drop[axis].le(most);
                });
                edges.gate = edges.gate.held(held);
                closed = closed | held;
            }
            // A held cell and a void one give nothing.
            if !R::any(!closed) {
                return edges;
            }
        }
        unroll!(axis in D => {
            if LIMITED && self.slopes {
                self.spread(&near, u, axis, &mut edges);
            } else {
                edges.half[axis] = prime[axis].halves(state.h.positive());
            }
        });
        if R::any(closed) {
            unroll!(axis in D => {
                edges.half[axis] = each!(side => edges.half[axis][side].only(!closed));
            });
        }
        edges
    }

    #[inline(always)]
    fn flux(&self, axis: usize, left: &Self::Edges, right: &Self::Edges) -> Flux<D, R> {
        let (zero, one) = (R::zero(), R::of(1.0));
        let (half_a, half_b) = (left.half[axis][1], right.half[axis][0]);
        let gate = left.gate.and(right.gate);
        let mut flux = Flux { mass: zero, left: [zero; D], right: [zero; D], gate };
        let all_open = !R::any(!gate.is_open());
        if all_open || R::any(left.gate.is_open() | right.gate.is_open()) {
            let u_a = left.spread[axis].velocity(Towards::Hi, left.u);
            let u_b = right.spread[axis].velocity(Towards::Lo, right.u);
            let both = half_a.push + half_b.push;
            let (mut share_a, mut share_b, mut push_a, mut push_b) = (one, one, both, both);
            if !all_open {
                let (left_held, right_held) = (left.gate.is_held(), right.gate.is_held());
                // Into a held cell goes only what is carried there, the rest of the density is reflected. It feels its
                // neighbours' thickness through its pull; of the flux it takes the impact.
                share_a = R::select(right_held, left.carried(axis, Towards::Hi), one);
                share_b = R::select(left_held, right.carried(axis, Towards::Lo), one);
                let reflected_a = R::select(right_held, half_a.reflected(u_a[axis], share_a), both);
                let reflected_b = R::select(left_held, half_b.reflected(u_b[axis], share_b), both);
                push_a = R::select(left_held, zero, reflected_a);
                push_b = R::select(right_held, zero, reflected_b);
            }
            let (mass_a, mass_b) = (half_a.mass * share_a, half_b.mass * share_b);
            let [turned_a, turned_b] = B::turn([u_a, u_b], [&left.plane, &right.plane]);
            flux.mass = mass_a + mass_b;
            unroll!(k in D => {
                flux.left[k] = mass_a * u_a[k] + mass_b * turned_b[k];
                flux.right[k] = mass_a * turned_a[k] + mass_b * u_b[k];
            });
            flux.left[axis] = flux.left[axis] + push_a;
            flux.right[axis] = flux.right[axis] + push_b;
        }
        flux
    }

    #[inline(always)]
    fn corner(&self, _around: [[&Self::Edges; 2]; 2]) {}
    #[inline(always)]
    fn update(
        &self,
        window: &impl Window<D, R, Flow<D, R>, B>,
        edges: &Self::Edges,
        faces: &[Faces<Flux<D, R>>; D],
        _corners: &[[(); 2]; 2],
        dt: R,
    ) -> Flow<D, R> {
        let Cell { state, ground } = window.at([0; D]);
        let (bed, spacing) = (ground.exact(), window.spacing());
        let (zero, per) = (R::zero(), spacing.per);
        let Flow { h, q } = state;
        let lambda: [R; D] = each!(axis => dt * per[axis]);
        let gone: [R; D] = each!(axis => lambda[axis] * (faces[axis].hi.mass - faces[axis].lo.mass));
        let gone = total(gone);
        let lost: [R; D] = each!(k => {
            let lost: [R; D] = each!(axis => lambda[axis] * (faces[axis].hi.left[k] - faces[axis].lo.right[k]));
            total(lost)
        });
        let gates: [R; D] = each!(axis => faces[axis].lo.gate.0 + faces[axis].hi.gate.0);
        let open = total(gates).same(zero);
        let all_open = !R::any(!open);
        let mut idle = None;
        if !all_open {
            // What holds itself or is bare, and is not touched, stays: leave out the work.
            let mut stays = !edges.gate.is_open() & gone.same(zero);
            unroll!(k in D => {
                stays = stays & lost[k].same(zero) & q[k].same(zero);
            });
            if !R::any(!stays) {
                return state;
            }
            idle = Some(stays);
        }
        // One difference of symmetric sums: the axes can be exchanged to the last bit.
        let new = normal(h - gone);
        let mut moved: [R; D] = each!(k => q[k] - lost[k]);
        // The depth under the source: the new one keeps draining cells bounded; at second order the old one
        // keeps the map a forward-Euler step wherever the depth does not halve.
        let depth = if LIMITED && self.slopes { h.min(new + new) } else { new }.positive();
        let pull = match bed.slide() {
            Some(slide) if all_open => slide,
            slide => {
                let pull = self.pull(window, &bed, faces, all_open);
                slide.map_or(pull, |slide| each!(k => R::select(open, slide[k], pull[k])))
            }
        };
        unroll!(k in D => {
            moved[k] = moved[k] + dt * depth * pull[k];
        });

        let thickness = bed.thickness(new).max(R::of(f64::MIN_POSITIVE));
        let old = edges.u;
        let square = bed.square(old);
        let law = self.friction.resistance(thickness, square, bed.load(old), bed.weight_at_rest());
        let still = state.is_still();
        let mut dry = law.dry;
        if R::any(still) {
            let resting = law.holding * R::of(Self::SLACK) + bed.rounding(h, largest(per));
            dry = R::select(still, resting, dry);
        }
        let size = bed.square(moved).sqrt();
        let loss = dt * depth * dry;
        let left = size - loss;
        // Slower than before, and within a step not by the last place of its depth: it has stopped.
        let mut spent = (left * largest(lambda)).le(R::of(1e-15) * new);
        if R::any(spent) {
            spent = spent & left.le(square.sqrt() * h);
        }
        let stops = left.le(zero) | spent | new.lt(R::of(self.film));
        let mut keep = left / R::select(stops, R::of(1.0), size);
        if R::any(!law.drag.same(zero)) {
            // v + dt drag v^2 = left/h, solved for v: the part that grows with the square, implicitly.
            let z = R::select(stops, zero, dt * law.drag * left / R::select(stops, R::of(1.0), new));
            keep = keep * (R::of(2.0) / (R::of(1.0) + (R::of(1.0) + R::of(4.0) * z).sqrt()));
        }
        let mut slowed: [R; D] = each!(k => R::select(stops, zero, moved[k] * keep));
        if LIMITED && self.slopes {
            // Along the new velocity friction is first order in time where the flow turns. Where a step takes at most
            // a quarter of the momentum it acts along the old one, as in a forward-Euler step.
            let speed = square.sqrt();
            let taken = dt * depth * (law.dry + law.drag * square);
            let far = (taken * R::of(4.0)).lt(size) & !(still | stops | speed.le(zero));
            let share = taken / R::select(far, speed, R::of(1.0));
            unroll!(k in D => {
                slowed[k] = R::select(far, moved[k] - share * old[k], slowed[k]);
            });
        }
        match idle {
            None => Flow { h: new, q: slowed },
            Some(idle) => {
                Flow { h: R::select(idle, h, new), q: each!(k => R::select(idle, q[k], slowed[k])) }
            }
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
        let rate = here.state.rate(&here.ground, spacing.per);
        R::select(here.state.h.lt(R::of(self.film)), R::zero(), rate)
    }
    /// A cell whose last stage ended at rest is at rest; its depth is the average.
    #[inline(always)]
    fn average(&self, keep: R, old: &Flow<D, R>, new: &Flow<D, R>) -> Flow<D, R> {
        let give = R::of(1.0) - keep;
        let stopped = new.is_still();
        Flow {
            h: keep * old.h + give * new.h,
            q: each!(k => R::select(stopped, R::zero(), keep * old.q[k] + give * new.q[k])),
        }
    }
    /// q = 0: a cell that a step leaves at rest and unchanged, every later step leaves so. Not only held cells: where the
    /// surface or the bed bends, the pull by central differences may exceed the bound, or the drop to one neighbour,
    /// while the forces through the faces do not, and held neighbours take nothing from it.
    #[inline(always)]
    fn rests(&self, here: &Cell<Flow<D, R>, B>) -> R::Mask {
        self.is_idle(here)
    }
    #[inline(always)]
    fn outside(&self, ground: &B) -> R::Mask {
        ground.outside()
    }
    #[inline(always)]
    fn booked(&self, flux: &Flux<D, R>, _side: Side) -> R {
        flux.mass
    }
    fn margin(&self, window: &impl Window<D, R, Flow<D, R>, B>) -> R {
        let near = window.cross();
        let Stance { pull, holding, .. } = self.stance(&near);
        let void = self.is_void(near.here.state.h, &near.here.ground);
        let none = void | holding.le(R::zero());
        let share = near.here.ground.square(pull).sqrt() / R::select(none, R::of(1.0), holding);
        R::select(none, R::zero(), share)
    }
    #[inline(always)]
    fn watch(&self, here: &Cell<Flow<D, R>, B>) -> Watch<R> {
        here.state.watch(&here.ground, R::of(self.film))
    }
}
