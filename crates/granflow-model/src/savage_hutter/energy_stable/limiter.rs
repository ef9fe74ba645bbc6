//! The energy that passes a face with its mass and momentum: no more than the cells can pay for.

use super::faces::{FaceStatesOf, Flux};
use crate::real::{Real, for_axis, per_axis};
use crate::savage_hutter::ground::Bed;

/// What two cells exchange in a step, per cell area.
pub(super) struct Exchange<R: Real> {
    pub axis: usize,
    pub lambda: R,
    /// psi of the right cell less that of the left one.
    pub rise: R,
    /// The side gives nothing.
    pub closed: [R::Mask; 2],
    /// The mass that each side sends, and what it lets spread besides.
    pub mass: [R; 2],
    pub spreads: [R; 2],
    /// The pressure less that of a level surface at rest, per metric.
    pub push: R,
}

/// a s^2 + b s + c
struct Quadratic<R> {
    a: R,
    b: R,
    c: R,
}

impl<R: Real> Quadratic<R> {
    #[inline(always)]
    fn at(&self, s: R) -> R {
        (self.a * s + self.b) * s + self.c
    }
}

impl<R: Real> Exchange<R> {
    /// The mass that passes to the right.
    #[inline(always)]
    fn net(&self) -> R {
        (self.mass[0] + self.spreads[0]) - (self.mass[1] + self.spreads[1])
    }

    /// Mass and momentum as they come, without the flux of energy.
    #[inline(always)]
    pub(super) fn unlimited<const D: usize, B: Bed<D, R>>(
        &self,
        [left, right]: [&FaceStatesOf<D, R, B>; 2],
    ) -> Flux<D, R> {
        let zero = R::zero();
        let sends = [self.mass[0] + self.spreads[0], self.mass[1] + self.spreads[1]];
        let [turned_left, turned_right] =
            B::parallel_transport([left.w, right.w], [&left.plane, &right.plane]);
        let along: [R; D] = per_axis!(k => if k == self.axis { self.push } else { zero });
        let (to_left, to_right) = (B::metric(&left.plane, along), B::metric(&right.plane, along));
        Flux {
            mass: self.net(),
            left: per_axis!(k => (sends[0] * left.w[k] - sends[1] * turned_right[k]) + to_left[k]),
            right: per_axis!(k => (sends[0] * turned_left[k] - sends[1] * right.w[k]) + to_right[k]),
            energy: [zero; 2],
        }
    }

    /// The energy that passes to the right less the net mass times the mean psi: what each giver pays for the rise of its mass, half
    /// of it if it flows freely, the whole if not; the kinetic energy and the gain of psi of what passes, and the work of the push.
    #[inline(always)]
    fn energy<const D: usize, B: Bed<D, R>>(&self, sides: [&FaceStatesOf<D, R, B>; 2]) -> R {
        let [left, right] = sides;
        let (half, one, axis) = (R::splat(0.5), R::splat(1.0), self.axis);
        let rise = self.rise + (right.gain - left.gain);
        let price: [R; 2] = per_axis!(side => {
            let shared = one - sides[side].free[axis];
            half * R::select(self.closed[1 - side], one, shared)
        });
        let paid =
            (self.mass[0] * price[0] + self.mass[1] * price[1]) + (self.spreads[0] + self.spreads[1]) * half;
        let kinetic: [R; 2] = per_axis!(side => {
            let k = half * B::square_in(&sides[side].plane, sides[side].w);
            (self.mass[side] + self.spreads[side]) * k
        });
        // By the velocity of what passes: a mean of both sides would charge the slow side of a shock with the work of the fast one.
        let sent = self.mass[0] + self.mass[1];
        let none = sent.le(R::zero());
        let speed = (self.mass[0] * left.w[axis] + self.mass[1] * right.w[axis]) / R::select(none, one, sent);
        (rise * paid + (kinetic[0] - kinetic[1]))
            + (half * self.net() * (left.gain + right.gain) + self.push * speed)
    }

    /// What the share s of this exchange costs a side beyond what it was predicted to, psi'/2 (n d^2 + P d), d = s inflow - p.
    #[inline(always)]
    fn cost<const D: usize, B: Bed<D, R>>(
        &self,
        side: &FaceStatesOf<D, R, B>,
        inflow: R,
        predicted: R,
    ) -> Quadratic<R> {
        let (n, half) = (R::splat(2.0 * D as f64), half_of(side.head));
        let np = n * predicted;
        Quadratic {
            a: half * n * (inflow * inflow),
            b: half * inflow * (side.inflow - (np + np)),
            c: half * predicted * (np - side.inflow),
        }
    }

    /// Scaled by the largest share that both cells can pay for, with a flux of energy that they can.
    #[inline(always)]
    pub(super) fn limited<const D: usize, B: Bed<D, R>>(
        &self,
        sides: [&FaceStatesOf<D, R, B>; 2],
    ) -> Flux<D, R> {
        let [left, right] = sides;
        let (zero, one, half) = (R::zero(), R::splat(1.0), R::splat(0.5));
        let mut flux = self.unlimited::<D, B>(sides);
        let net = flux.mass;
        let between = half * self.lambda * (left.h * left.u[self.axis] + right.h * right.u[self.axis]);
        let costs = [
            self.cost::<D, B>(left, -net, -(left.inflow_share * between)),
            self.cost::<D, B>(right, net, right.inflow_share * between),
        ];
        let head: [R; 2] = per_axis!(side => half_of(sides[side].head) * sides[side].inflow);
        let stays: [R; 2] = per_axis!(side => sides[side].budget * R::splat(0.5 / D as f64));
        let given: [R; 2] = per_axis!(side => {
            self.mass[side] * (half * B::square_in(&sides[side].plane, sides[side].u))
        });
        let a = costs[0].a + costs[1].a;
        let b = ((costs[0].b + costs[1].b) + net * (self.rise + (head[1] - head[0]))) - (given[0] + given[1]);
        let c = (costs[0].c + costs[1].c) - (stays[0] + stays[1]);
        let mut share = one;
        let over = zero.lt((a + b) + c);
        if R::any(over) {
            let root = (b * b - R::splat(4.0) * a * c).positive_part().sqrt();
            let falls = b.le(zero);
            let (top, under) = (R::select(falls, root - b, -(c + c)), R::select(falls, a + a, b + root));
            let none = under.le(zero);
            let largest = top / R::select(none, one, under);
            let largest = R::select(none, zero, largest.positive_part().min(one)) * R::splat(1.0 - 1e-12);
            share = R::select(over, largest, one);
        }
        let energy = share * self.energy::<D, B>(sides);
        flux.mass = share * net;
        for_axis!(k in D => {
            flux.left[k] = share * flux.left[k];
            flux.right[k] = share * flux.right[k];
        });
        let up =
            ((stays[0] + given[0] * share) + flux.mass * (head[0] - half * self.rise)) - costs[0].at(share);
        let low =
            costs[1].at(share) - ((stays[1] + given[1] * share) - flux.mass * (head[1] + half * self.rise));
        let middle = half * (up + low);
        let crossed = up.lt(low);
        let (low, up) = (R::select(crossed, middle, low), R::select(crossed, middle, up));
        let energy = energy.min(up).max(low);
        let lift = half * flux.mass * self.rise;
        flux.energy = [energy + lift, energy - lift];
        flux
    }
}

#[inline(always)]
fn half_of<R: Real>(value: R) -> R {
    value * R::splat(0.5)
}
