//! What tells one scheme from another: friction law, thinnest moving depth, order.

use core::marker::PhantomData;

/// The scheme over a friction law and a bed. `ORDER` is the order where it is known when the inner loops are compiled, 1 or 2, so that
/// each order has loops of its own; else 0.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct EnergyStable<F, B, const ORDER: u8 = 0> {
    /// A cell thinner than this keeps what it has (units of h); at least the smallest normal number. (It comes before the law: the
    /// compiler reads all parameters of a law at once, and what follows them, and then takes that apart in every cell.)
    pub(super) film: f64,
    /// The highest total head |V|^2/2 + psi that a cell may keep \[m^2/s^2\].
    pub(super) ceiling: f64,
    /// The friction law.
    pub friction: F,
    /// Second order in smooth flow.
    pub second: bool,
    bed: PhantomData<fn() -> B>,
}

impl<F, B> EnergyStable<F, B> {
    /// First order.
    pub fn first(friction: F, film: f64) -> Self {
        let film = film.max(f64::MIN_POSITIVE);
        EnergyStable { film, ceiling: f64::MAX, friction, second: false, bed: PhantomData }
    }
    /// Second order in smooth flow.
    pub fn second(friction: F, film: f64) -> Self {
        EnergyStable { second: true, ..Self::first(friction, film) }
    }
    /// The same with a bound on the total head |V|^2/2 + psi of a cell, over a bed with a potential (terrain) \[m^2/s^2\]: cells that
    /// would keep more lose speed.
    ///
    /// No parcel of a mass that starts at rest has more than its highest surface, and what the front of a breaking dam gains, the
    /// depth behind it (Ritter 1892: V^2/2 = 2 psi' h). Thin cells, which keep a part of their mass in every step, would collect more.
    #[must_use]
    pub fn below(self, ceiling: f64) -> Self {
        EnergyStable { ceiling, ..self }
    }
    /// The same over another bed.
    pub fn over<C>(&self) -> EnergyStable<F, C>
    where
        F: Copy,
    {
        self.of_order()
    }
}

impl<F, B, const ORDER: u8> EnergyStable<F, B, ORDER> {
    /// The same over another bed, of an order that is known.
    pub(super) fn of_order<C, const OTHER: u8>(&self) -> EnergyStable<F, C, OTHER>
    where
        F: Copy,
    {
        let EnergyStable { film, ceiling, friction, second, .. } = *self;
        EnergyStable { film, ceiling, friction, second, bed: PhantomData }
    }
}
