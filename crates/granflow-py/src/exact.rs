//! Exact solutions, place by place; the package gives them arrays of one shape.

use granflow::hadeler_kuttler::{Pile, exact as piles};
use granflow::savage_hutter::exact::{
    CapRelease, ExactError, FlatDamBreak, Flow1, Flow2, GranularJump, ParabolicCap, Riemann, SimilarityCap,
    SlidingSlab, SlopeDamBreak, ThackerParaboloid,
};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Arrays of several quantities in the same places.
type Arrays<'py> = Vec<Bound<'py, PyArray1<f64>>>;

fn refused(error: ExactError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// What `value` gives for the numbers of each place.
fn each<'py, const IN: usize, const OUT: usize>(
    py: Python<'py>,
    places: [&PyReadonlyArray1<'py, f64>; IN],
    value: impl Fn([f64; IN]) -> [f64; OUT],
) -> PyResult<Arrays<'py>> {
    let places = places.map(|array| array.as_array());
    let mut values = [const { Vec::new() }; OUT];
    for index in 0..places[0].len() {
        let place = std::array::from_fn(|k| places[k][index]);
        values.iter_mut().zip(value(place)).for_each(|(all, one)| all.push(one));
    }
    Ok(values.into_iter().map(|all| PyArray1::from_vec(py, all)).collect())
}

fn one(Flow1 { h, u }: Flow1) -> [f64; 2] {
    [h, u]
}

fn two(Flow2 { h, u, v }: Flow2) -> [f64; 3] {
    [h, u, v]
}

fn lake(Flow2 { h, u, v }: Flow2, bed: f64) -> [f64; 4] {
    [h, u, v, bed]
}

fn layers(pile: Pile<f64>) -> [f64; 2] {
    [pile.u, pile.v]
}

fn flow([h, u]: [f64; 2]) -> Flow1 {
    Flow1 { h, u }
}

fn release([height, length, slope, friction, earth_pressure, gravity]: [f64; 6]) -> CapRelease {
    CapRelease { height, length, slope, friction, earth_pressure, gravity }
}

/// Functions of Python, a line each: `name(places; parameters): what is made of the parameters once => its values in a place`.
macro_rules! functions {
    ($($name:ident($($place:ident),+; $($given:ident: $kind:ty),+): $made:expr => |$exact:pat_param| $values:expr;)+) => {
        $(
            #[pyfunction]
            #[allow(clippy::too_many_arguments, reason = "a function of Python has its parameters side by side")]
            pub fn $name<'py>(
                py: Python<'py>,
                $($place: PyReadonlyArray1<'py, f64>,)+
                $($given: $kind),+
            ) -> PyResult<Arrays<'py>> {
                let $exact = $made.map_err(refused)?;
                each(py, [$(&$place),+], |[$($place),+]| $values)
            }
        )+
    };
}

functions! {
    riemann(x, t; beta: f64, left: [f64; 2], right: [f64; 2]):
        Riemann::new(beta, flow(left), flow(right)) => |exact| one(exact.flow(x, t));

    slope_dam_break(x, t; gravity: f64, h0: f64, slope: f64, friction: f64, earth_pressure: f64):
        SlopeDamBreak::new(gravity, h0, slope, friction, earth_pressure) => |exact| one(exact.flow(x, t));

    flat_dam_break(h, t; mu: f64):
        FlatDamBreak::new(mu) => |exact| exact.contour(h, t).map_or([f64::NAN; 2], |at| [at.x, at.u]);

    flat_dam_break_front(t; mu: f64):
        FlatDamBreak::new(mu) => |exact| [exact.front(t)];

    granular_jump(x, t; beta: f64, minus: [f64; 2], h_plus: f64):
        GranularJump::new(beta, flow(minus), h_plus) => |exact| one(exact.flow(x, t));

    sliding_slab(t; gravity: f64, slope: f64, friction: f64, u0: f64):
        SlidingSlab::new(gravity, slope, friction, u0) => |exact| [exact.displacement(t), exact.velocity(t)];

    parabolic_cap(x, t; cap: [f64; 6]):
        ParabolicCap::new(release(cap)) => |exact| one(exact.flow(x, t));

    // At one time: the stretches are integrated once.
    similarity_cap(x, y; t: f64, cap: [f64; 6], length: f64, earth_pressure: f64):
        SimilarityCap::new(release(cap), length, earth_pressure).map(|exact| exact.at(t))
            => |exact| two(exact.flow(x, y));

    thacker(x, y, t; gravity: f64, a: f64, sigma: f64, h0: f64):
        ThackerParaboloid::new(gravity, a, sigma, h0) => |exact| lake(exact.flow(x, y, t), exact.bed(x, y));

    pile_on_rectangle(x, y; sides: [f64; 2], open: [[bool; 2]; 2], source: f64):
        Ok(()) => |()| piles::rectangle(sides, open, source, [x, y]).map_or([f64::NAN; 2], layers);

    pile_on_disc(r; radius: f64, source: f64, hole: Option<f64>):
        Ok(()) => |()| layers(match hole {
            None => piles::disc(radius, source, r),
            Some(hole) => piles::funnel(radius, hole, source, r),
        });
}
