//! Exact solutions, place by place; the package gives them arrays of one shape.

use granflow::hadeler_kuttler::exact as piles;
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

type Places<'py> = PyReadonlyArray1<'py, f64>;

fn one(Flow1 { h, u }: Flow1) -> [f64; 2] {
    [h, u]
}

fn two(Flow2 { h, u, v }: Flow2) -> [f64; 3] {
    [h, u, v]
}

fn flow([h, u]: [f64; 2]) -> Flow1 {
    Flow1 { h, u }
}

#[pyfunction]
pub fn riemann<'py>(
    py: Python<'py>,
    x: Places<'py>,
    t: Places<'py>,
    beta: f64,
    left: [f64; 2],
    right: [f64; 2],
) -> PyResult<Arrays<'py>> {
    let exact = Riemann::new(beta, flow(left), flow(right)).map_err(refused)?;
    each(py, [&x, &t], |[x, t]| one(exact.flow(x, t)))
}

#[pyfunction]
pub fn slope_dam_break<'py>(
    py: Python<'py>,
    x: Places<'py>,
    t: Places<'py>,
    numbers: [f64; 5],
) -> PyResult<Arrays<'py>> {
    let [gravity, h0, slope, friction, earth_pressure] = numbers;
    let exact = SlopeDamBreak::new(gravity, h0, slope, friction, earth_pressure).map_err(refused)?;
    each(py, [&x, &t], |[x, t]| one(exact.flow(x, t)))
}

#[pyfunction]
pub fn flat_dam_break<'py>(
    py: Python<'py>,
    h: Places<'py>,
    t: Places<'py>,
    mu: f64,
) -> PyResult<Arrays<'py>> {
    let exact = FlatDamBreak::new(mu).map_err(refused)?;
    each(py, [&h, &t], |[h, t]| exact.contour(h, t).map_or([f64::NAN; 2], |contour| [contour.x, contour.u]))
}

#[pyfunction]
pub fn flat_dam_break_front<'py>(py: Python<'py>, t: Places<'py>, mu: f64) -> PyResult<Arrays<'py>> {
    let exact = FlatDamBreak::new(mu).map_err(refused)?;
    each(py, [&t], |[t]| [exact.front(t)])
}

#[pyfunction]
pub fn granular_jump<'py>(
    py: Python<'py>,
    x: Places<'py>,
    t: Places<'py>,
    beta: f64,
    minus: [f64; 2],
    h_plus: f64,
) -> PyResult<Arrays<'py>> {
    let exact = GranularJump::new(beta, flow(minus), h_plus).map_err(refused)?;
    each(py, [&x, &t], |[x, t]| one(exact.flow(x, t)))
}

#[pyfunction]
pub fn sliding_slab<'py>(py: Python<'py>, t: Places<'py>, numbers: [f64; 4]) -> PyResult<Arrays<'py>> {
    let [gravity, slope, friction, u0] = numbers;
    let exact = SlidingSlab::new(gravity, slope, friction, u0).map_err(refused)?;
    each(py, [&t], |[t]| [exact.displacement(t), exact.velocity(t)])
}

fn release([height, length, slope, friction, earth_pressure, gravity]: [f64; 6]) -> CapRelease {
    CapRelease { height, length, slope, friction, earth_pressure, gravity }
}

#[pyfunction]
pub fn parabolic_cap<'py>(
    py: Python<'py>,
    x: Places<'py>,
    t: Places<'py>,
    cap: [f64; 6],
) -> PyResult<Arrays<'py>> {
    let exact = ParabolicCap::new(release(cap)).map_err(refused)?;
    each(py, [&x, &t], |[x, t]| one(exact.flow(x, t)))
}

/// At one time: the stretches are integrated once.
#[pyfunction]
pub fn similarity_cap<'py>(
    py: Python<'py>,
    x: Places<'py>,
    y: Places<'py>,
    t: f64,
    cap: [f64; 6],
    across: [f64; 2],
) -> PyResult<Arrays<'py>> {
    let [length, earth_pressure] = across;
    let exact = SimilarityCap::new(release(cap), length, earth_pressure).map_err(refused)?.at(t);
    each(py, [&x, &y], |[x, y]| two(exact.flow(x, y)))
}

#[pyfunction]
pub fn thacker<'py>(
    py: Python<'py>,
    x: Places<'py>,
    y: Places<'py>,
    t: Places<'py>,
    numbers: [f64; 4],
) -> PyResult<Arrays<'py>> {
    let [gravity, a, sigma, h0] = numbers;
    let exact = ThackerParaboloid::new(gravity, a, sigma, h0).map_err(refused)?;
    each(py, [&x, &y, &t], |[x, y, t]| {
        let [h, u, v] = two(exact.flow(x, y, t));
        [h, u, v, exact.bed(x, y)]
    })
}

#[pyfunction]
pub fn pile_on_rectangle<'py>(
    py: Python<'py>,
    x: Places<'py>,
    y: Places<'py>,
    sides: [f64; 2],
    open: [[bool; 2]; 2],
    source: f64,
) -> PyResult<Arrays<'py>> {
    each(py, [&x, &y], |place| {
        piles::rectangle(sides, open, source, place).map_or([f64::NAN; 2], |pile| [pile.u, pile.v])
    })
}

#[pyfunction]
pub fn pile_on_disc<'py>(
    py: Python<'py>,
    r: Places<'py>,
    radius: f64,
    source: f64,
    hole: Option<f64>,
) -> PyResult<Arrays<'py>> {
    each(py, [&r], |[r]| {
        let pile = match hole {
            None => piles::disc(radius, source, r),
            Some(hole) => piles::funnel(radius, hole, source, r),
        };
        [pile.u, pile.v]
    })
}
