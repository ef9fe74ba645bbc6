//! What the model asks of a bed.

use crate::real::{Real, for_axis};
use crate::scheme::Components;

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
pub trait Bed<const D: usize, R: Real>: Components<R> {
    /// The same bed on another scalar.
    type On<L: Real>: Bed<D, L>;
    /// What a face must know of the bed to turn a velocity into it.
    type Plane: Components<R>;
    /// The same bed with what follows from its slope as that is: rest is not decided in single precision.
    fn exact(self) -> Self;
    /// See [`Bed::parallel_transport`].
    fn plane(&self) -> Self::Plane;
    /// Pressure coefficient along `axis`: P = beta h^2/2.
    fn beta(&self, axis: usize) -> R;
    /// The free surface, as far as [`Bed::rise`] must know it.
    type Surface: Components<R>;
    /// The free surface of a layer of depth `h`; `size` are the lengths of a cell.
    fn surface(&self, h: R, size: [R; D]) -> Self::Surface;
    /// psi of the second of two neighbours along `axis` less psi of the first; where psi is no function of the cell (a chute whose
    /// beta varies) by the means of both.
    fn rise(axis: usize, between: [&Self::Surface; 2]) -> R;
    /// psi, 0 where it is no function of the cell (a chute).
    fn potential(surface: &Self::Surface) -> R;
    /// d psi/dh (terrain: g c^2, chute: beta), 0 outside the data.
    fn head(&self) -> R;
    /// 1/[`Bed::head`], 0 outside the data.
    fn per_head(&self) -> R;
    /// M v in a plane: the acceleration that a horizontal force per mass leaves.
    fn metric(plane: &Self::Plane, v: [R; D]) -> [R; D];
    /// Squared length of the tangential vector of a plane with horizontal part `v`.
    fn square_in(plane: &Self::Plane, v: [R; D]) -> R;
    /// Length along a plane of a unit step along `axis`.
    fn stretch_in(plane: &Self::Plane, axis: usize) -> R;
    /// The acceleration of free fall.
    fn gravity(&self) -> R;
    /// psi at the neighbour minus psi here, depths `h_there` and `h`; `dx` is their distance.
    #[inline(always)]
    fn potential_jump(&self, axis: usize, towards: Towards, there: &Self, h: R, h_there: R, dx: R) -> R {
        self.bed_jump(axis, towards, there, dx) + self.pressure_jump(there, h, h_there)
    }
    /// The part of the rise that the bed makes.
    fn bed_jump(&self, axis: usize, towards: Towards, there: &Self, dx: R) -> R;
    /// The part of the rise that the momentum flux carries as pressure.
    fn pressure_jump(&self, there: &Self, h: R, h_there: R) -> R;
    /// Acceleration -M (hi - lo)/(2 dx) of the rises towards both neighbours of each axis.
    fn driving_force(&self, lo: [R; D], hi: [R; D], per: [R; D]) -> [R; D];
    /// The rest of the pull where the fluxes carry all pressure, if it is the same whatever the neighbours hold; then
    /// [`Bed::cross_force`] and [`Bed::curvature_force`] are 0.
    fn uniform_driving_force(&self) -> Option<[R; D]>;
    /// The part of [`Bed::driving_force`] that a pressure along the other axes makes (off the diagonal of M).
    fn cross_force(&self, lo: [R; D], hi: [R; D], per: [R; D]) -> [R; D];
    /// Acceleration per depth that the change of beta and of the bed's tilt between the neighbours along `axis` leaves beside
    /// the flux; 1/dx is `per`.
    fn curvature_force(&self, axis: usize, lo: &Self, hi: &Self, per: R) -> R;
    /// Normal acceleration under a mass of velocity `w`, N+ = max(N, 0).
    fn normal_load(&self, w: [R; D]) -> R;
    /// Normal acceleration at rest.
    fn weight_at_rest(&self) -> R;
    /// Squared physical length of the tangential vector with horizontal part `v`.
    fn square(&self, v: [R; D]) -> R;
    /// Length along the bed of a unit step along `axis`.
    #[inline(always)]
    fn stretch(&self, axis: usize) -> R {
        Self::stretch_in(&self.plane(), axis)
    }
    /// The velocities in two tangent planes, each turned into the other's at the same speed along the bed.
    fn parallel_transport(w: [[R; D]; 2], planes: [&Self::Plane; 2]) -> [[R; D]; 2];
    /// Thickness normal to the bed.
    fn thickness(&self, h: R) -> R;
    /// Rounding of a rise divided by dx: the uncertainty of the pull.
    fn rounding(&self, h: R, per: R) -> R;
    /// Elevation b \[m\], not a number outside the data; a chute has none.
    fn elevation(&self) -> R;
    /// Outside the data.
    fn is_nodata(&self) -> R::Mask;
    /// The mirror image across a wall normal to `axis`.
    fn mirror(self, axis: usize) -> Self;
}

/// Central differences -(hi - lo)/(2 dx) of the rises towards both neighbours.
#[inline(always)]
pub(super) fn straight<const D: usize, R: Real>(lo: [R; D], hi: [R; D], per: [R; D]) -> [R; D] {
    let mut difference = lo;
    for_axis!(axis in D => {
        difference[axis] = (lo[axis] - hi[axis]) * (per[axis] * R::splat(0.5));
    });
    difference
}
