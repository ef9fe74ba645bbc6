//! Laws of erosion: how fast a flow picks up the layer that lies under it.

use crate::real::Real;

/// How a flow picks up an erodible layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Erosion {
    /// By speed, d' = -kappa |V| (Christen, Kowalski & Bartelt, Cold Reg. Sci. Technol. 63, 2010).
    Speed {
        /// kappa, depth by the length that the flow has moved.
        coefficient: f64,
    },
    /// By shear stress above a threshold: where tau > tau_c at the constant `rate`, down to the depth a (tau - tau_c) below the
    /// bed as it was (Frank et al., Nat. Hazards Earth Syst. Sci. 15, 2015).
    Shear {
        /// tau_c \[Pa\].
        threshold: f64,
        /// a \[m/Pa\].
        depth_by_stress: f64,
        /// Speed at which the bed sinks \[m/s\].
        rate: f64,
    },
    /// By the work of friction, rho_layer d' = -tau |V|/e (AvaFrame's com1DFA).
    Energy {
        /// Specific erosion energy e \[J/kg\].
        specific: f64,
    },
    /// By the front, which takes the whole layer while it crosses a cell: d' = -d_0 |V|/dx.
    Plough,
}

/// An erodible layer in a cell; depths are normal to the bed.
#[derive(Clone, Copy, Debug)]
pub struct ErodibleLayer {
    /// Depth d_0 at the start \[m\].
    pub whole: f64,
    /// Depth taken so far \[m\].
    pub taken: f64,
    /// Density of the layer \[kg/m^3\].
    pub density: f64,
}

/// What flows over an erodible layer.
#[derive(Clone, Copy, Debug)]
pub struct FlowOver {
    /// Thickness h normal to the bed \[m\].
    pub thickness: f64,
    /// Speed |V| along the bed \[m/s\].
    pub speed: f64,
    /// Shear stress tau at the bed \[Pa\].
    pub stress: f64,
    /// Density rho of the flow \[kg/m^3\].
    pub density: f64,
    /// Length of the cell \[m\].
    pub size: f64,
}

impl Erosion {
    /// The depth \[m\] of the layer that the flow takes in `dt`, not more than is left.
    ///
    /// Where the rate grows with the speed, d' = -k |V|, the speed falls as the flow takes up mass at rest, h |V| being constant:
    /// h(t)^2 = h^2 + 2 r k h |V| t with r = rho_layer/rho, so that no step is too long.
    #[must_use]
    pub fn depth(&self, layer: &ErodibleLayer, flow: &FlowOver, dt: f64) -> f64 {
        let left = layer.whole - layer.taken;
        let by_path = |k: f64| {
            let (h, r) = (flow.thickness, layer.density / flow.density);
            // (h(t) - h)/r without the difference of like numbers.
            let path = k * flow.speed * dt;
            2.0 * path * h / (h + Real::sqrt(h * (h + 2.0 * r * path)))
        };
        let depth = match *self {
            Erosion::Speed { coefficient } => by_path(coefficient),
            Erosion::Shear { threshold, depth_by_stress, rate } => {
                (rate * dt).min((flow.stress - threshold) * depth_by_stress - layer.taken).max(0.0)
            }
            Erosion::Energy { specific } => by_path(flow.stress / (layer.density * specific)),
            Erosion::Plough => by_path(layer.whole / flow.size),
        };
        depth.min(left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::prelude::v1::*;

    const FLOW: FlowOver =
        FlowOver { thickness: 1.0, speed: 10.0, stress: 1000.0, density: 200.0, size: 5.0 };
    const LAYER: ErodibleLayer = ErodibleLayer { whole: 2.0, taken: 0.5, density: 100.0 };

    #[test]
    fn the_rate_of_a_short_step_is_the_published_one() {
        let dt = 1e-6;
        let rate = |law: Erosion| law.depth(&LAYER, &FLOW, dt) / dt;
        let close =
            |found: f64, wanted: f64| assert!((found / wanted - 1.0).abs() < 1e-5, "{found} {wanted}");
        close(rate(Erosion::Speed { coefficient: 0.01 }), 0.1);
        // com1DFA: 1000 Pa, 10 m/s, 5000 J/kg take 2 kg/m^2 a second.
        close(rate(Erosion::Energy { specific: 5000.0 }), 2.0 / 100.0);
        close(rate(Erosion::Plough), 2.0 * 10.0 / 5.0);
        let shear = Erosion::Shear { threshold: 400.0, depth_by_stress: 1e-3, rate: 0.025 };
        close(rate(shear), 0.025);
    }

    #[test]
    fn any_step_takes_what_many_short_ones_take() {
        for law in [Erosion::Speed { coefficient: 0.02 }, Erosion::Plough] {
            let whole = law.depth(&LAYER, &FLOW, 0.2);
            let (mut layer, mut flow) = (LAYER, FLOW);
            for _ in 0..1000 {
                let depth = law.depth(&layer, &flow, 2e-4);
                layer.taken += depth;
                let h = flow.thickness + depth * layer.density / flow.density;
                flow = FlowOver { thickness: h, speed: flow.speed * flow.thickness / h, ..flow };
            }
            let parts = layer.taken - LAYER.taken;
            assert!((whole / parts - 1.0).abs() < 1e-12, "{law:?}: {whole} {parts}");
        }
    }

    #[test]
    fn no_more_is_taken_than_is_left_or_reached() {
        assert_eq!(Erosion::Plough.depth(&LAYER, &FLOW, 1e3), 1.5);
        let shear = |depth_by_stress| Erosion::Shear { threshold: 400.0, depth_by_stress, rate: 0.025 };
        assert_eq!(shear(1e-3).depth(&LAYER, &FLOW, 1e3), 1e-3 * 600.0 - 0.5);
        assert_eq!(shear(1e-4).depth(&LAYER, &FLOW, 1.0), 0.0);
        let weak = FlowOver { stress: 399.0, ..FLOW };
        assert_eq!(shear(1.0).depth(&LAYER, &weak, 1.0), 0.0);
    }
}
