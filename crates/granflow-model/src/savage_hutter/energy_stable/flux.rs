//! What passes a face.

use super::ends::EndsOf;
use super::faces::{FaceStatesOf, Flux};
use super::force::is_zero;
use super::limiter::Exchange;
use super::meeting::Meeting;
use super::rest::TOWER;
use crate::real::{Real, for_axis, per_axis};
use crate::savage_hutter::ground::Bed;

/// What stands too steep spreads at this share of sqrt(psi' h) less the speed of the flow, and in a step by at most the other share
/// of its excess: so much the fall of the excess pays for.
const SPREAD_SPEED: f64 = 0.125;
const SPREADS_OF_EXCESS: f64 = 1.0 / 24.0;

/// The exchange by a kinetic flux.
struct Kinetic<R> {
    /// The mass that each side sends per time.
    mass: [R; 2],
    /// The pressure less that of a level surface at rest, per time and metric.
    push: R,
}

/// The mean of both sides; of a dry one nothing but its bed is asked.
#[inline(always)]
fn mean<R: Real>(dry: [R::Mask; 2], [left, right]: [R; 2]) -> R {
    R::select(dry[0], right, R::select(dry[1], left, (left + right) * R::splat(0.5)))
}

/// By the density M = h/(2 c) for |xi - v| < c (Audusse & Bristeau, J. Comput. Phys. 206, 2005; there c^2 = 3 psi' h/2 of each side):
/// through a face it sends the mass h v+ + h c (1 - |a|)^2/4, and the share (2 + 3 a - a^3)/4 of its pressure, a = v/c the velocity
/// towards the face within [-1, 1].
///
/// Both cells have the faster one's c and the mean psi'. What is no mean flow lives on the depths that both cells have in common, the
/// deeper one lowered to the other and what its surface is above: nothing passes where the surface is level.
#[inline(always)]
fn kinetic<const D: usize, R: Real, B: Bed<D, R>, T: EndsOf<D, R>>(
    axis: usize,
    sides: [&FaceStatesOf<D, R, B, T>; 2],
    meeting: &Meeting<D, R>,
    dry: [R::Mask; 2],
    lambda: R,
) -> Kinetic<R> {
    let (zero, one) = (R::zero(), R::splat(1.0));
    let head = mean(dry, [sides[0].head, sides[1].head]);
    let per_head = mean(dry, [sides[0].per_head, sides[1].per_head]);
    let thermal = mean(dry, meeting.thermal);
    let h: [R; 2] = per_axis!(side => R::select(dry[side], zero, meeting.h[side]));
    let (v, rise) = (meeting.v, meeting.rise);
    let deeper = h[0] - h[1];
    let left_deeper = zero.lt(deeper);
    let above = R::select(left_deeper, -rise, rise) * per_head;
    let lowered = h[0].min(h[1]) + above.positive_part();
    // Within rounding a surface over a flat bed is as much higher as the layer is deeper.
    let lowers = above.lt(deeper.abs() * R::splat(1.0 - 1e-10));
    let common =
        [R::select(left_deeper & lowers, lowered, h[0]), R::select(!left_deeper & lowers, lowered, h[1])];
    let c = R::splat(1.224744871391589) * meeting.wave;
    let none = c.le(zero);
    let per = one / R::select(none, one, c);
    let a: [R; 2] = per_axis!(side => (v[side] * per).max(-one).min(one));
    let mass = per_axis!(side => {
        let rest = one - a[side].abs();
        let spray = common[side] * c * R::splat(0.25) * (rest * rest);
        let sent = h[side] * v[side].positive_part() + thermal * spray;
        R::select(dry[side], zero, sent.min(sides[side].bound(axis, 1 - side, lambda)))
    });
    let share = R::select(dry[0] | dry[1], one, thermal);
    let push: [R; 2] = per_axis!(side => {
        let a = a[side];
        common[side] * common[side] * (R::splat(2.0) + a * (R::splat(3.0) - a * a))
    });
    let level = R::splat(4.0) * (common[0] * common[1]);
    Kinetic { mass, push: share * head * R::splat(0.125) * ((push[0] + push[1]) - level) }
}

/// What the higher one of two cells lets go of, where it moves or is a tower, if it stands steeper than it holds: mass per cell area.
#[inline(always)]
fn spread<const D: usize, R: Real, B: Bed<D, R>, T: EndsOf<D, R>>(
    axis: usize,
    giver: &FaceStatesOf<D, R, B, T>,
    fall: R,
    per_head: R,
    lambda: R,
) -> R {
    let zero = R::zero();
    let lets_go = (giver.motion.is_tower() | !is_zero(giver.w)) & giver.holds[axis].lt(fall);
    if !R::any(lets_go) {
        return zero;
    }
    let holds = giver.holds[axis] * B::stretch_in(&giver.plane, axis);
    let onset = R::select(giver.motion.is_tower(), holds * R::splat(TOWER), holds);
    let excess = R::select(lets_go & onset.lt(fall), (fall - holds) * per_head, zero);
    let speed = R::splat(SPREAD_SPEED) * (giver.wave - giver.w[axis].abs()).positive_part();
    let most = giver.room.min(excess * R::splat(SPREADS_OF_EXCESS));
    (lambda * speed * excess.min(giver.h)).min(most)
}

/// What passes a face along `axis`.
#[inline(always)]
pub(super) fn flux<const D: usize, R: Real, B: Bed<D, R>, T: EndsOf<D, R>>(
    axis: usize,
    sides: [&FaceStatesOf<D, R, B, T>; 2],
    lambda: R,
) -> Flux<D, R> {
    let [left, right] = sides;
    let closed: [R::Mask; 2] = [left.motion.is_closed(), right.motion.is_closed()];
    if !R::any(!(closed[0] & closed[1])) {
        return Flux::none();
    }
    let (zero, one) = (R::zero(), R::splat(1.0));
    let outside = left.motion.is_outside() | right.motion.is_outside();
    let rise = R::select(outside, zero, B::rise(axis, [&left.surface, &right.surface]));
    let free = left.motion.between(right.motion, rise);
    let meeting = Meeting::of::<B, T>(axis, sides, rise, lambda);
    let mut mass: [R; 2] = per_axis!(side => sides[side].donor(axis, 1 - side));
    let mut push = zero;
    if R::any(zero.lt(free)) {
        let kinetic = kinetic::<D, R, B, T>(axis, sides, &meeting, closed, lambda);
        mass = per_axis!(side => mass[side] + free * (kinetic.mass[side] - mass[side]));
        push = lambda * free * kinetic.push;
    }
    let mass: [R; 2] = per_axis!(side => lambda * sides[side].share * mass[side]);
    let mut spreads = [zero, zero];
    if R::any(free.lt(one)) {
        let per_head = left.per_head.min(right.per_head);
        let within = R::select(outside, zero, one - free);
        let falls = [-rise, rise];
        spreads = per_axis!(side => within * spread::<D, R, B, T>(axis, sides[side], falls[side], per_head, lambda));
    }
    let exchange = Exchange { axis, lambda, rise, closed, mass, spreads, push, meeting };
    let limited = exchange.limited::<B, T>(sides);
    if !R::any(outside) {
        return limited;
    }
    // Nothing but what leaves, with at least the potential energy of the bed.
    let all = exchange.unlimited::<B, T>(sides);
    let mut flux = limited;
    flux.mass = R::select(outside, all.mass, flux.mass);
    for_axis!(k in D => {
        flux.left[k] = R::select(outside, all.left[k], flux.left[k]);
        flux.right[k] = R::select(outside, all.right[k], flux.right[k]);
    });
    flux.energy = per_axis!(side => {
        R::select(outside, -(all.mass * (sides[side].head * sides[side].h)), flux.energy[side])
    });
    flux
}
