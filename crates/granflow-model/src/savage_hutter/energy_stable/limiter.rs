//! The energy that passes a face with its mass and momentum: no more than the cells can pay for.

use super::ends::EndsOf;
use super::faces::{FaceStatesOf, Flux};
use super::meeting::Meeting;
use crate::real::{Real, for_axis, per_axis};
use crate::savage_hutter::ground::Bed;

/// Half of the share of the loss by mixing that is left with the giver, at second order.
const MIXING: f64 = 0.1;

/// What two cells exchange in a step, per cell area.
pub(super) struct Exchange<const D: usize, R: Real> {
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
    /// What they showed each other.
    pub meeting: Meeting<D, R>,
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

impl<const D: usize, R: Real> Exchange<D, R> {
    /// The mass that passes to the right.
    #[inline(always)]
    fn net(&self) -> R {
        (self.mass[0] + self.spreads[0]) - (self.mass[1] + self.spreads[1])
    }

    /// Mass and momentum as they come, without the flux of energy.
    #[inline(always)]
    pub(super) fn unlimited<B: Bed<D, R>, T: EndsOf<D, R>>(
        &self,
        [left, right]: [&FaceStatesOf<D, R, B, T>; 2],
    ) -> Flux<D, R> {
        let zero = R::zero();
        let sends = [self.mass[0] + self.spreads[0], self.mass[1] + self.spreads[1]];
        let carried = self.meeting.carried;
        let [turned_left, turned_right] = B::parallel_transport(carried, [&left.plane, &right.plane]);
        let push = self.push + self.lambda * self.meeting.later;
        let along: [R; D] = per_axis!(k => if k == self.axis { push } else { zero });
        let (to_left, to_right) = (B::metric(&left.plane, along), B::metric(&right.plane, along));
        Flux {
            mass: self.net(),
            left: per_axis!(k => (sends[0] * carried[0][k] - sends[1] * turned_right[k]) + to_left[k]),
            right: per_axis!(k => (sends[0] * turned_left[k] - sends[1] * carried[1][k]) + to_right[k]),
            energy: [zero, zero],
        }
    }

    /// The energy that passes to the right less the net mass times the mean psi: what each giver pays for the rise of its mass, half
    /// of it if it flows freely, the whole if not; the kinetic energy and the gain of psi of what passes, and the work of the push.
    #[inline(always)]
    fn energy<B: Bed<D, R>, T: EndsOf<D, R>>(&self, sides: [&FaceStatesOf<D, R, B, T>; 2]) -> R {
        let [left, right] = sides;
        let (half, one, axis) = (R::splat(0.5), R::splat(1.0), self.axis);
        let (gain, carried) = (self.meeting.gain, self.meeting.carried);
        let rise = self.rise + (gain[1] - gain[0]);
        let price: [R; 2] = per_axis!(side => {
            let shared = one - sides[side].free[axis];
            half * R::select(self.closed[1 - side], one, shared)
        });
        let paid =
            (self.mass[0] * price[0] + self.mass[1] * price[1]) + (self.spreads[0] + self.spreads[1]) * half;
        let kinetic: [R; 2] = per_axis!(side => {
            let k = half * B::square_in(&sides[side].plane, carried[side]);
            (self.mass[side] + self.spreads[side]) * k
        });
        // By the velocity of what passes: a mean of both sides would charge the slow side of a shock with the work of the fast one.
        let sent = self.mass[0] + self.mass[1];
        let none = sent.le(R::zero());
        let speed =
            (self.mass[0] * carried[0][axis] + self.mass[1] * carried[1][axis]) / R::select(none, one, sent);
        let energy = (rise * paid + (kinetic[0] - kinetic[1]))
            + (half * self.net() * (gain[0] + gain[1]) + self.push * speed);
        let second = self.meeting.second;
        if !R::any(second) {
            return energy;
        }
        // A fifth of what the receiver will lose by mixing stays with the giver, or the limiter cuts true shocks.
        let turned = B::parallel_transport(carried, [&left.plane, &right.plane]);
        let apart: [[R; D]; 2] = per_axis!(side => per_axis!(k => turned[side][k] - sides[1 - side].w[k]));
        let mixed: [R; 2] =
            per_axis!(side => self.mass[side] * B::square_in(&sides[1 - side].plane, apart[side]));
        R::select(second, energy - R::splat(MIXING) * (mixed[0] - mixed[1]), energy)
    }

    /// What the share s of this exchange costs a side beyond what it was predicted to, psi'/2 (n d^2 + P d), d = s inflow - p.
    #[inline(always)]
    fn cost<B: Bed<D, R>, T: EndsOf<D, R>>(
        &self,
        side: &FaceStatesOf<D, R, B, T>,
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
    pub(super) fn limited<B: Bed<D, R>, T: EndsOf<D, R>>(
        &self,
        sides: [&FaceStatesOf<D, R, B, T>; 2],
    ) -> Flux<D, R> {
        let [left, right] = sides;
        let (zero, one, half) = (R::zero(), R::splat(1.0), R::splat(0.5));
        let mut flux = self.unlimited::<B, T>(sides);
        let net = flux.mass;
        let between = half * self.lambda * (left.h * left.u[self.axis] + right.h * right.u[self.axis]);
        let costs = [
            self.cost::<B, T>(left, -net, -(left.inflow_share * between)),
            self.cost::<B, T>(right, net, right.inflow_share * between),
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
        let energy = share * self.energy::<B, T>(sides);
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
        if let (Some(from), Some(to)) = (left.ends.get(), right.ends.get()) {
            // Bed and friction act on the mean of old and new mass.
            let passes = R::select(self.meeting.second, half * flux.mass, zero);
            for_axis!(k in D => {
                flux.left[k] = flux.left[k] + passes * from.given[k];
                flux.right[k] = flux.right[k] + passes * to.given[k];
            });
        }
        let lift = half * flux.mass * self.rise;
        flux.energy = [energy + lift, energy - lift];
        flux
    }
}

#[inline(always)]
fn half_of<R: Real>(value: R) -> R {
    value * R::splat(0.5)
}
