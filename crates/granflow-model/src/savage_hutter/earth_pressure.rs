//! Earth pressure: more of it where a mass is compressed than where it is stretched.
//!
//! Along an axis the mass pushes with k g_n h^2/2, k = k_act where it is stretched and k_pas >= k_act where it is compressed. The
//! schemes push with k_act always, so that rest and their energy are those of one k. What compression adds acts as a
//! stress against it, between nothing and the excess of k_pas: of all such stresses those that take the most energy
//! ([`stresses`]), as in a rigid plastic body. They give none, and are none at rest.

use crate::real::Real;
#[cfg(feature = "std")]
use std::prelude::v1::*;

/// \[k_act, k_pas\] = 1 + 2 tan^2 phi -+ 2 sqrt((1 + tan^2 phi) (tan^2 phi - mu^2)) of a mass with the tangent `internal` of its
/// angle of internal friction phi on a bed with the friction coefficient `mu` (thesis eq. 2.17; Savage & Hutter, J. Fluid Mech.
/// 199, 1989). With mu = tan phi both are 1 + 2 mu^2; none where mu > tan phi.
#[must_use]
pub fn coefficients(internal: f64, mu: f64) -> Option<[f64; 2]> {
    let square = internal * internal;
    let apart = square - mu * mu;
    if apart.is_nan() || apart < 0.0 {
        return None;
    }
    let mean = 1.0 + 2.0 * square;
    if apart == 0.0 {
        return Some([mean; 2]);
    }
    let passive = mean + 2.0 * Real::sqrt((1.0 + square) * apart);
    // Their product is 1 + 4 mu^2 (1 + tan^2 phi); their difference from the mean would leave nothing of a small one.
    Some([(1.0 + 4.0 * (mu * mu) * (1.0 + square)) / passive, passive])
}

/// The most that compression adds at the face of two cells: the momentum per cell area, in a step with dt/dx = `lambda`, of the
/// excess (k_pas/k_act - 1) psi' h^2/2 of the pressure; `head` is psi' = d psi/dh of each cell with k_act. h is the harmonic mean of
/// their depths `h` > 0: a thin layer bears no more than its own thickness lets it.
#[must_use]
pub fn excess(excess: f64, head: [f64; 2], h: [f64; 2], lambda: f64) -> f64 {
    let mean = 2.0 * (h[0] * h[1]) / (h[0] + h[1]);
    lambda * (excess * (head[0] + head[1]) * 0.25 * (mean * mean))
}

/// A cell of a line.
#[derive(Clone, Copy, Debug)]
pub struct Mass {
    /// Its mass: depth, on a slope by the metric along the line.
    pub mass: f64,
    /// Its velocity along the line.
    pub velocity: f64,
    /// The most that compression adds at its face to the next cell ([`excess`]); of no use in the last one.
    pub most: f64,
}

/// A place on the string.
#[cfg(feature = "std")]
#[derive(Clone, Copy)]
struct Knot {
    face: usize,
    /// Mass and momentum up to there.
    mass: f64,
    momentum: f64,
    /// The stress there.
    stress: f64,
}

#[cfg(feature = "std")]
impl Knot {
    /// The velocity of what lies between two knots.
    fn velocity(self, upper: Knot) -> f64 {
        (upper.momentum - self.momentum) / (upper.mass - self.mass)
    }
}

/// A wall is so many times heavier than the line before it.
#[cfg(feature = "std")]
const WALL: f64 = 1e12;

/// The momentum along a line of cells that the stresses of compression give each of them. An end at a wall has in `walls` the most that
/// compression adds there; at other ends nothing does.
///
/// The stress P of each face, 0 <= P <= `most`, goes from the lower cell to the upper one. Of all choices the one after which the
/// kinetic energy is least: P = 0 where the cells part, P = `most` where they still approach each other, between these what lets them
/// move alike. Over the mass up to each face, the momentum Q - P is then the taut string through the tube from Q - `most` to Q: it is found
/// from end to end by the funnel of what can be seen from its last knot. A wall is a mass that does not move, beyond the end.
///
/// So the energy does not grow, the momentum of a line without walls stays, and cells all at rest or moving alike get nothing.
#[cfg(feature = "std")]
#[must_use]
pub fn stresses(line: &[Mass], walls: [Option<f64>; 2]) -> Vec<f64> {
    let all: f64 = line.iter().map(|cell| cell.mass).sum();
    let before = usize::from(walls[0].is_some());
    // The masses of the line are counted from its own begin: beside that of a wall nothing would be left of them.
    let start = if before == 1 { -WALL * all } else { 0.0 };
    let start = Knot { face: 0, mass: start, momentum: 0.0, stress: 0.0 };
    let mut funnel = Funnel { knots: vec![start], chains: [vec![start].into(), vec![start].into()] };
    if let Some(most) = walls[0] {
        funnel.pass(Knot { face: 1, mass: 0.0, momentum: 0.0, stress: 0.0 }, most);
    }
    let (mut mass, mut momentum) = (0.0, 0.0);
    let mut end = start;
    for (cell, one) in line.iter().enumerate() {
        mass += one.mass;
        momentum += one.mass * one.velocity;
        end = Knot { face: before + cell + 1, mass, momentum, stress: 0.0 };
        let last = cell + 1 == line.len();
        funnel.pass(end, if last { walls[1].unwrap_or(0.0) } else { one.most });
    }
    if walls[1].is_some() {
        end = Knot { face: end.face + 1, mass: mass + WALL * all, ..end };
        funnel.pass(end, 0.0);
    }
    if funnel.knots.last().is_some_and(|last| last.face < end.face) {
        funnel.knots.push(end);
    }
    let mut given = Vec::with_capacity(line.len());
    for pair in funnel.knots.windows(2) {
        let [lower, upper] = [pair[0], pair[1]];
        let at_wall = lower.face < before || upper.face > before + line.len();
        let cells = &line[lower.face.max(before) - before..(upper.face - before).min(line.len())];
        given.extend(together(cells, lower.stress - upper.stress, at_wall));
    }
    given
}

/// What cells get that move as one under a `push`, or stand with a wall.
#[cfg(feature = "std")]
fn together(cells: &[Mass], push: f64, at_wall: bool) -> Vec<f64> {
    if at_wall {
        return cells.iter().map(|cell| -(cell.mass * cell.velocity)).collect();
    }
    if let [_] = cells {
        return vec![push];
    }
    let mass: f64 = cells.iter().map(|cell| cell.mass).sum();
    // Without the velocity that all have, of which nothing is to be left by rounding.
    let base = cells[0].velocity;
    let apart: f64 = cells.iter().map(|cell| cell.mass * (cell.velocity - base)).sum();
    let velocity = (apart + push) / mass;
    cells.iter().map(|cell| cell.mass * (velocity - (cell.velocity - base))).collect()
}

/// A cell of a line that is to stand still.
#[derive(Clone, Copy, Debug)]
pub struct Standing {
    /// Its momentum along the line, which stresses have to take.
    pub momentum: f64,
    /// What its friction takes of a push along the line, either way, beyond what it holds already.
    pub spare: f64,
    /// The most that compression adds at its face to the next cell ([`excess`]); of no use in the last one.
    pub most: f64,
}

/// Can stresses between nothing and `most`, with the friction of cells at rest, bring a line to rest? An end at a wall has in `walls` the
/// most that compression adds there; at other ends nothing does.
///
/// The stress P of a face less that of the one before is the momentum of the cell between them, but for its `spare`: from face to face an
/// interval of what P can be.
#[must_use]
pub fn holds(line: &[Standing], walls: [Option<f64>; 2]) -> bool {
    let (mut least, mut largest) = (0.0, walls[0].unwrap_or(0.0));
    for (k, cell) in line.iter().enumerate() {
        let most = if k + 1 == line.len() { walls[1].unwrap_or(0.0) } else { cell.most };
        least = (least + cell.momentum - cell.spare).max(0.0);
        largest = (largest + cell.momentum + cell.spare).min(most);
        if least > largest {
            return false;
        }
    }
    true
}

/// What can be seen from the last knot of the string: the ends of the tube that bound it, below the upper one (P = 0) a chain with
/// growing velocities, above the lower one (P = most) one with falling.
#[cfg(feature = "std")]
struct Funnel {
    knots: Vec<Knot>,
    chains: [std::collections::VecDeque<Knot>; 2],
}

#[cfg(feature = "std")]
impl Funnel {
    /// Go on to the next face, whose stress is at most `most`.
    fn pass(&mut self, knot: Knot, most: f64) {
        self.widen(0, knot);
        self.widen(1, Knot { momentum: knot.momentum - most, stress: most, ..knot });
    }

    /// Go on to another end of the tube on a side, 0 the upper and 1 the lower one.
    fn widen(&mut self, side: usize, knot: Knot) {
        // Is the first velocity on the inner side of the second, seen from this side of the tube?
        let inside = |a: f64, b: f64| if side == 0 { a < b } else { a > b };
        let [own, other] = match side {
            0 => {
                let [upper, lower] = &mut self.chains;
                [upper, lower]
            }
            _ => {
                let [upper, lower] = &mut self.chains;
                [lower, upper]
            }
        };
        while let [.., before, last] = own.make_contiguous()
            && !inside(before.velocity(*last), before.velocity(knot))
        {
            own.pop_back();
        }
        own.push_back(knot);
        while own.len() == 2 && other.len() > 1 && inside(own[0].velocity(knot), other[0].velocity(other[1]))
        {
            // It cannot be reached past the other side: the string bends there.
            other.pop_front();
            own[0] = other[0];
            self.knots.push(other[0]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_are_those_of_mohrs_circle() {
        // As printed: 2 (1 -+ sqrt(1 - cos^2 phi/cos^2 delta))/cos^2 phi - 1.
        for (phi, delta) in [(35_f64, 25_f64), (40.0, 10.0), (30.0, 30.0), (37.0, 0.0)] {
            let (phi, delta) = (phi.to_radians(), delta.to_radians());
            let [active, passive] = coefficients(phi.tan(), delta.tan()).unwrap();
            let root = (1.0 - (phi.cos() / delta.cos()).powi(2)).max(0.0).sqrt();
            for (found, sign) in [(active, -1.0), (passive, 1.0)] {
                let printed = 2.0 * (1.0 + sign * root) / phi.cos().powi(2) - 1.0;
                assert!((found - printed).abs() < 1e-12 * printed.max(1.0), "{found} {printed}");
            }
        }
        let mu = 0.4663;
        assert_eq!(coefficients(mu, mu), Some([1.0 + 2.0 * (mu * mu); 2]));
        assert_eq!(coefficients(0.3, 0.31), None);
        // A smooth bed: Rankine's (1 -+ sin phi)/(1 +- sin phi).
        let phi = 0.6_f64;
        let [active, passive] = coefficients(phi.tan(), 0.0).unwrap();
        assert!((active - (1.0 - phi.sin()) / (1.0 + phi.sin())).abs() < 1e-14);
        assert!((active * passive - 1.0).abs() < 1e-14);
    }

    /// The kinetic energy that is left, twice.
    fn energy(line: &[Mass], given: &[f64]) -> f64 {
        line.iter()
            .zip(given)
            .map(|(cell, push)| (cell.mass * cell.velocity + push).powi(2) / cell.mass)
            .sum()
    }

    /// The same by descent along one stress after the other, which ends where no stress can take more.
    fn by_descent(line: &[Mass]) -> Vec<f64> {
        let mut stress = vec![0.0; line.len() + 1];
        let mut u: Vec<f64> = line.iter().map(|cell| cell.velocity).collect();
        for _ in 0..20_000 {
            for face in 1..line.len() {
                let (lower, upper) = (line[face - 1], line[face]);
                let best = (u[face - 1] - u[face]) / (1.0 / lower.mass + 1.0 / upper.mass);
                let new = (stress[face] + best).clamp(0.0, lower.most);
                let more = new - stress[face];
                stress[face] = new;
                u[face - 1] -= more / lower.mass;
                u[face] += more / upper.mass;
            }
        }
        (0..line.len()).map(|cell| stress[cell] - stress[cell + 1]).collect()
    }

    fn dice(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*state >> 11) as f64 / (1_u64 << 53) as f64
    }

    #[test]
    fn the_stresses_are_those_that_take_the_most_energy() {
        let mut state = 7;
        for trial in 0..200 {
            let size = 10_f64.powi(trial % 7 - 5);
            let line: Vec<Mass> = (0..2 + trial as usize % 19)
                .map(|_| Mass {
                    mass: 0.1 + dice(&mut state),
                    velocity: dice(&mut state) - 0.5,
                    most: size * dice(&mut state),
                })
                .collect();
            let (found, wanted) = (stresses(&line, [None; 2]), by_descent(&line));
            assert_eq!(found.len(), line.len());
            for (found, wanted) in found.iter().zip(&wanted) {
                assert!((found - wanted).abs() < 1e-9, "trial {trial}: {found} {wanted}");
            }
            let before = energy(&line, &vec![0.0; line.len()]);
            assert!(energy(&line, &found) <= before * (1.0 + 1e-14));
            assert!(found.iter().sum::<f64>().abs() < 1e-14);
        }
    }

    /// A wall is a heavy cell; it stands at either end and at both.
    #[test]
    fn walls_stand_at_either_end() {
        let mut state = 11;
        for trial in 0..200 {
            let size = 10_f64.powi(trial % 5 - 3);
            let line: Vec<Mass> = (0..1 + trial as usize % 12)
                .map(|_| Mass {
                    mass: 0.1 + dice(&mut state),
                    velocity: dice(&mut state) - 0.5,
                    most: size * dice(&mut state),
                })
                .collect();
            let most = [size * dice(&mut state), size * dice(&mut state)];
            for walls in [[true, false], [false, true], [true, true]] {
                let given = [0, 1].map(|side| walls[side].then_some(most[side]));
                let found = stresses(&line, given);
                let wall = |most| Mass { mass: 1e9, velocity: 0.0, most };
                let mut heavy = line.clone();
                if walls[1] {
                    heavy.last_mut().unwrap().most = most[1];
                    heavy.push(wall(0.0));
                }
                if walls[0] {
                    heavy.insert(0, wall(most[0]));
                }
                let wanted = by_descent(&heavy).split_off(usize::from(walls[0]));
                for (found, wanted) in found.iter().zip(&wanted) {
                    assert!((found - wanted).abs() < 1e-8, "trial {trial} {walls:?}: {found} {wanted}");
                }
                // The mirror image.
                let mut mirrored: Vec<Mass> =
                    line.iter().rev().map(|cell| Mass { velocity: -cell.velocity, ..*cell }).collect();
                for (k, cell) in mirrored.iter_mut().enumerate() {
                    cell.most = line.len().checked_sub(k + 2).map_or(0.0, |below| line[below].most);
                }
                let image = stresses(&mirrored, [given[1], given[0]]);
                for (a, b) in found.iter().zip(image.iter().rev()) {
                    assert!((a + b).abs() < 1e-13, "trial {trial} {walls:?}: {a} {b}");
                }
            }
        }
    }

    #[test]
    fn a_line_is_held_by_what_its_stresses_and_its_friction_can_take() {
        let cell = |momentum: f64, spare: f64, most: f64| Standing { momentum, spare, most };
        let line = [cell(1.0, 0.0, 2.0), cell(0.0, 0.5, 2.0), cell(0.0, 0.6, 2.0)];
        assert!(holds(&line, [None; 2]));
        // The other way it leans on nothing.
        assert!(!holds(&line.map(|cell| Standing { momentum: -cell.momentum, ..cell }), [None; 2]));
        assert!(holds(&line.map(|cell| Standing { momentum: -cell.momentum, ..cell }), [Some(1.0), None]));
        assert!(!holds(&line.map(|cell| Standing { spare: 0.3, ..cell }), [None; 2]), "too little friction");
        assert!(holds(&line.map(|cell| Standing { spare: 0.3, ..cell }), [None, Some(0.2)]), "a wall");
        assert!(!holds(&line.map(|cell| Standing { most: 0.9, ..cell }), [None; 2]), "too much stress");
        assert!(holds(&[], [None; 2]));
    }

    #[test]
    fn rest_and_a_body_that_moves_as_one_feel_nothing() {
        for velocity in [0.0, 0.1, -3.7] {
            let line: Vec<Mass> =
                (0..30).map(|k| Mass { mass: 0.3 + 0.01 * f64::from(k), velocity, most: 2.0 }).collect();
            assert!(stresses(&line, [None; 2]).iter().all(|push| *push == 0.0));
        }
        // Parting cells too, and those that no stress can hold.
        let parting: Vec<Mass> =
            (0..30).map(|k| Mass { mass: 0.5, velocity: 0.1 * f64::from(k), most: 2.0 }).collect();
        assert!(stresses(&parting, [None; 2]).iter().all(|push| *push == 0.0));
        let apart: Vec<Mass> =
            (0..30).map(|k| Mass { mass: 0.5, velocity: f64::from(-k), most: 0.0 }).collect();
        assert!(stresses(&apart, [None; 2]).iter().all(|push| *push == 0.0));
    }
}
