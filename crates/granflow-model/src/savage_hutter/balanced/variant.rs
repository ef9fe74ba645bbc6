//! What tells one scheme from another: friction law, thinnest moving depth, order.

use core::marker::PhantomData;

/// The scheme: friction law, thinnest moving depth, order of accuracy. `ORDER` is the order where it is known when the
/// inner loops are compiled, 1 or 2, so that each order has loops of its own; else 0.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Balanced<F, B, const ORDER: u8 = 0> {
    /// A cell thinner than this keeps what it has (units of h); at least the smallest normal number. (It comes before the law: the
    /// compiler reads all parameters of a law at once, and what follows them, and then takes that apart in every cell.)
    pub(super) film: f64,
    /// The friction law.
    pub friction: F,
    /// Limited slopes of h and u (second order).
    pub slopes: bool,
    pub(super) bed: PhantomData<fn() -> B>,
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
