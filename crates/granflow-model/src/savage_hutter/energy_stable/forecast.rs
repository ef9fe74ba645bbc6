//! What neighbours must know of a cell before they move: its surface as the old momenta will leave it, and how much friction rules it.

use super::variant::EnergyStable;
use crate::real::{Real, per_axis, total};
use crate::savage_hutter::Flow;
use crate::savage_hutter::friction::LocalFriction;
use crate::savage_hutter::ground::Bed;
use crate::scheme::{Cell, Components, Stencil, components};

/// A cell counts as flowing from twice, and not at all up to once, the speed that friction takes from it in so many steps.
const STEPS_TO_STOP: f64 = 4.0;

/// The state of motion of a cell, a number: from 0 to 1 how freely it flows (0: friction could stop it within four steps), or one of
/// the constants.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion<R> {
    pub(super) code: R,
}

components!([R: Real] Motion<R> { code: R });

impl<R: Real> Motion<R> {
    /// At rest, it stands over a neighbour by more than friction holds.
    pub(super) const TOWER: f64 = -1.0;
    /// Friction stops it in this step.
    pub(super) const STOPS: f64 = -1.5;
    /// A film or bare: takes what comes, gives nothing.
    const DRY: f64 = -2.0;
    /// Holds itself, and so gives nothing.
    const HELD: f64 = -3.0;
    /// Outside the data.
    const OUTSIDE: f64 = -4.0;

    /// It gives nothing.
    #[inline(always)]
    pub(super) fn is_closed(self) -> R::Mask {
        self.code.le(R::splat(Self::DRY))
    }
    #[inline(always)]
    pub(super) fn is_tower(self) -> R::Mask {
        self.code.equals(R::splat(Self::TOWER))
    }
    #[inline(always)]
    pub(super) fn is_outside(self) -> R::Mask {
        self.code.equals(R::splat(Self::OUTSIDE))
    }
    #[inline(always)]
    pub(super) fn is_dry(self) -> R::Mask {
        self.code.equals(R::splat(Self::DRY))
    }
    /// From 0 to 1.
    #[inline(always)]
    pub(super) fn freedom(self) -> R {
        self.code.positive_part()
    }
    /// How freely mass passes between two cells, psi of the second above that of the first by `rise`: as in the less free one, of a
    /// dry one only if its bed is not above the surface of the other.
    #[inline(always)]
    pub(super) fn between(self, other: Self, rise: R) -> R {
        let zero = R::zero();
        let open = !(self.is_closed() | other.is_closed());
        let onto_other = other.is_dry() & !self.is_closed() & rise.le(zero);
        let onto_self = self.is_dry() & !other.is_closed() & zero.le(rise);
        let (a, b) = (self.freedom(), other.freedom());
        R::select(open, a.min(b), R::select(onto_other, a, R::select(onto_self, b, zero)))
    }
}

/// What is forecast of a cell.
#[derive(Clone, Copy, Debug)]
pub struct Forecast<const D: usize, R: Real, S> {
    pub(super) u: [R; D],
    /// The surface as it is.
    pub(super) surface: S,
    /// How much psi will rise by the transport of the old momenta.
    pub(super) gain: R,
    pub(super) motion: Motion<R>,
}

components!([const D: usize, R: Real, S: Components<R>] Forecast<D, R, S> { u: [R; D], surface: S, gain: R, motion: Motion<R> });

impl<F: LocalFriction, B: Copy, const ORDER: u8> EnergyStable<F, B, ORDER> {
    #[inline(always)]
    pub(super) fn is_dry<const D: usize, R: Real>(
        &self,
        Cell { state, ground, .. }: &Cell<Flow<D, R>, B, F::Parameters<R>>,
    ) -> R::Mask
    where
        B: Bed<D, R>,
    {
        state.h.lt(R::splat(self.film)) | ground.is_nodata()
    }

    /// [`crate::scheme::Scheme::forecast`].
    ///
    /// gain = psi' (1 - theta) sum over axes of lambda (q+ of the lower neighbour + q- of the upper one - |q|), and at least -psi' h/2:
    /// a downstream force from the old surface makes energy where that is level over a moving layer (E grows by psi' dh^2/2, at second
    /// order in dt); from the predicted one it does not.
    #[inline(always)]
    pub(super) fn foresee<const D: usize, R: Real>(
        &self,
        stencil: &impl Stencil<D, R, Flow<D, R>, B, F::Parameters<R>>,
        dt: R,
    ) -> Forecast<D, R, B::Surface>
    where
        B: Bed<D, R>,
    {
        let near = stencil.star();
        let (zero, one) = (R::zero(), R::splat(1.0));
        let here = Cell { ground: near.here.ground.exact(), ..near.here };
        let Cell { state: Flow { h, q }, ground: bed, .. } = here;
        let u = here.state.velocity();
        let (dry, still) = (self.is_dry(&near.here), near.here.state.is_still());
        let shut = R::select(bed.is_nodata(), R::splat(Motion::<R>::OUTSIDE), R::splat(Motion::<R>::DRY));
        let mut code = shut;
        if R::any(!dry) {
            let law = self.resistance(&here, u, near.spacing.inv);
            let loss = dt * law.dry * R::splat(STEPS_TO_STOP);
            let (none, square) = (loss.le(zero), bed.square(u));
            code = one;
            let slow = square.lt(R::splat(4.0) * (loss * loss)) & !none;
            if R::any(slow) {
                let free = (square.sqrt() / R::select(none, one, loss) - one).positive_part().min(one);
                // Where it is not slow the quotient may round to less than 1.
                code = R::select(slow, free, one);
            }
            if R::any(still & !dry) {
                let (held, tower) = self.balance(&near, law.holding);
                code = R::select(still & held, R::splat(Motion::<R>::HELD), code);
                code = R::select(still & tower & !none, R::splat(Motion::<R>::TOWER), code);
            }
            code = R::select(dry, shut, code);
        }
        let comes: [R; D] = per_axis!(axis => {
            let (lo, hi) = (near.lo[axis].state.q[axis], near.hi[axis].state.q[axis]);
            dt * near.spacing.inv[axis] * ((lo.positive_part() + (-hi).positive_part()) - q[axis].abs())
        });
        let motion = Motion { code };
        let rises = (total(comes) * (one - motion.freedom())).max(h * R::splat(-0.5));
        let gain = R::select(bed.is_nodata(), zero, bed.head() * rises);
        Forecast { u, surface: bed.surface(h, near.spacing.size), gain, motion }
    }
}
