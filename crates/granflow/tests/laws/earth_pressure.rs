//! Active and passive earth pressure: a cap that is pressed together and then spreads, rest, conservation, symmetry.

use granflow::Case;
use granflow::run::Run;
use granflow::savage_hutter::earth_pressure::coefficients;
use granflow::savage_hutter::exact::{CapRelease, SimilarityCap};

const SLOPE: f64 = 35.0;
const BED: f64 = 25.0;
const INTERNAL: f64 = 35.0;
const EPSILON: f64 = 0.05;
/// Speed of the cap at the start, and how fast its ends approach the middle.
const SPEED: f64 = 1.0;
const CLOSING: f64 = 0.4;
const SCHEMES: [&str; 4] = ["energy_stable", "energy_stable_2", "balanced", "balanced_2"];

fn start(text: &str) -> Box<dyn Run> {
    Case::parse(text, "test.toml").unwrap().check().unwrap().start().unwrap()
}

fn material(pressure: &str) -> String {
    format!(
        "[material]\nepsilon = {EPSILON}\nslope = \"{SLOPE} deg\"\nfriction.coulomb = {{ angle = \"{BED} deg\" }}\n\
         earth_pressure{pressure}\n"
    )
}

fn active_passive() -> String {
    material(&format!(".active_passive = {{ internal = \"{INTERNAL} deg\" }}"))
}

/// Half length g of the cap and its rate at `time`: g'' = 2 epsilon k cos z/g^2 (Savage & Hutter 1989, benchmark B), with k_pas while
/// g' < 0 and then k_act.
fn stretch(time: f64) -> [f64; 2] {
    let [active, passive] = coefficients(INTERNAL.to_radians().tan(), BED.to_radians().tan()).unwrap();
    let rate = |[g, v]: [f64; 2]| {
        let k = if v < 0.0 { passive } else { active };
        [v, 2.0 * EPSILON * k * SLOPE.to_radians().cos() / (g * g)]
    };
    let (steps, mut y) = (100_000, [1.0, -CLOSING]);
    let dt = time / f64::from(steps);
    let moved = |y: [f64; 2], r: [f64; 2], dt: f64| [y[0] + dt * r[0], y[1] + dt * r[1]];
    for _ in 0..steps {
        let a = rate(y);
        let b = rate(moved(y, a, 0.5 * dt));
        let c = rate(moved(y, b, 0.5 * dt));
        let d = rate(moved(y, c, dt));
        let mean = [0, 1].map(|k| (a[k] + 2.0 * (b[k] + c[k]) + d[k]) / 6.0);
        y = moved(y, mean, dt);
    }
    y
}

/// L1 error of the thickness, by the volume.
fn error(scheme: &str, cells: usize, time: f64) -> f64 {
    let text = format!(
        "grid.x = {{ from = -1.5, to = 6.5, cells = {cells} }}\n\
         initial.thickness.formula = \"max(0, 1 - x^2)\"\n\
         initial.velocity_x.formula = \"{SPEED} - {CLOSING}*x\"\n\
         scheme.name = \"{scheme}\"\ntime.end = {time}\n{}",
        active_passive()
    );
    let mut run = start(&text);
    run.until(time).unwrap();
    let [g, _] = stretch(time);
    let (slope, bed) = (SLOPE.to_radians(), BED.to_radians());
    let centre = SPEED * time + 0.5 * (slope.sin() - slope.cos() * bed.tan()) * time * time;
    let dx = 8.0 / cells as f64;
    let field = run.field("thickness").unwrap();
    let wrong: f64 = field
        .iter()
        .enumerate()
        .map(|(k, h)| {
            let xi = (-1.5 + (k as f64 + 0.5) * dx - centre) / g;
            (h - (1.0 - xi * xi).max(0.0) / g).abs()
        })
        .sum();
    wrong * dx / (4.0 / 3.0)
}

#[test]
fn a_cap_pressed_together_follows_the_passive_and_then_the_active_solution() {
    for (time, what) in [(1.0, "pressed together"), (3.0, "spreading again")] {
        let [g, rate] = stretch(time);
        assert_eq!(rate < 0.0, time == 1.0, "{what}: {g} {rate}");
        for (scheme, order, bound) in [
            ("energy_stable", 0.8, 0.02),
            ("energy_stable_2", 1.1, 0.003),
            ("balanced", 0.8, 0.02),
            ("balanced_2", 1.1, 0.003),
        ] {
            let errors = [200, 400, 800].map(|cells| error(scheme, cells, time));
            let found = (errors[1] / errors[2]).log2();
            assert!(found > order && errors[2] < bound, "{what}, {scheme}: {errors:?}, order {found}");
        }
    }
}

#[test]
fn an_internal_angle_as_that_of_the_bed_is_one_coefficient() {
    let run = |material: &str, scheme: &str| {
        let text = format!(
            "grid = {{ x = {{ from = -2.0, to = 4.0, cells = 60 }}, y = {{ from = -2.0, to = 2.0, cells = 40 }} }}\n\
             initial.thickness.cap = {{ height = 1.0, radius = 1.0 }}\nscheme.name = \"{scheme}\"\ntime.end = 1.0\n{material}"
        );
        let mut run = start(&text);
        for _ in 0..80 {
            run.step(1e9).unwrap();
        }
        run.field("thickness").unwrap().iter().map(f64::to_bits).collect::<Vec<_>>()
    };
    for scheme in SCHEMES {
        let one = run(&material(&format!(".active_passive = {{ internal = \"{BED} deg\" }}")), scheme);
        assert_eq!(one, run(&material(" = \"kaland\""), scheme), "{scheme}");
        assert_ne!(one, run(&active_passive(), scheme), "{scheme}");
    }
}

#[test]
fn a_pile_that_holds_is_not_started_by_the_switch() {
    // Under k_act it holds up to the friction, whatever k_pas would do.
    let [active, _] = coefficients(INTERNAL.to_radians().tan(), 30_f64.to_radians().tan()).unwrap();
    let (slope, bed) = (10_f64.to_radians(), 30_f64.to_radians());
    let most = (slope.cos() * bed.tan() - slope.sin()) / (active * slope.cos());
    for (share, holds) in [(0.999, true), (1.001, false)] {
        for scheme in ["energy_stable", "energy_stable_2", "balanced"] {
            let text = format!(
                "grid.x = {{ from = -3.0, to = 3.0, cells = 120 }}\n[material]\nepsilon = 1.0\nslope = \"10 deg\"\n\
                 friction.coulomb = {{ angle = \"30 deg\" }}\nearth_pressure.active_passive = {{ internal = \"{INTERNAL} deg\" }}\n\
                 [initial]\nthickness.cone = {{ height = 1.0, slope = {} }}\n[scheme]\nname = \"{scheme}\"\n[time]\nend = 1.0\n",
                most * share
            );
            let mut run = start(&text);
            let bits =
                |run: &dyn Run| run.field("thickness").unwrap().iter().map(f64::to_bits).collect::<Vec<_>>();
            let before = bits(&*run);
            for _ in 0..2000 {
                run.step(1e9).unwrap();
            }
            assert_eq!(bits(&*run) == before, holds, "{scheme} at {share}");
        }
    }
}

/// A layer that slides from a steep part of a chute against one on a flat part is held by stresses between both coefficients: it rests
/// when its fall is over, on any grid, and as one pile.
#[test]
fn what_passive_stress_holds_comes_to_rest_on_any_grid() {
    let slab = |scheme: &str, cells: usize| {
        let text = format!(
            "grid.x = {{ from = -2.0, to = 18.0, cells = {cells} }}\ngrid.boundary = \"wall\"\n\
             initial.thickness.formula = \"if(x>0, if(x<14, 1, 0), 0)\"\nscheme.name = \"{scheme}\"\n\
             time = {{ until = \"rest\", end = 100.0, trickle = 0.0 }}\n[material]\n\
             slope = {{ x = [4.5, 5.5], angle = [\"28 deg\", \"10 deg\"] }}\nfriction.coulomb = {{ angle = \"20 deg\" }}\n\
             earth_pressure.active_passive = {{ internal = \"40 deg\" }}\n"
        );
        let mut run = start(&text);
        assert!(run.to_rest(100.0).unwrap(), "{scheme}, {cells} cells");
        // The fall takes 8.
        assert!(run.time() < 30.0, "{scheme}, {cells} cells: {}", run.time());
        assert_eq!(run.totals().energy, 0.0);
        let field = run.field("thickness").unwrap();
        let h: Vec<f64> = field.iter().collect();
        let volume: f64 = h.iter().sum();
        (h, volume)
    };
    for scheme in ["energy_stable", "energy_stable_2"] {
        let piles = [200, 400, 800].map(|cells| slab(scheme, cells));
        let apart = |[(coarse, volume), (fine, _)]: [&(Vec<f64>, f64); 2]| {
            let means = fine
                .chunks(fine.len() / coarse.len())
                .map(|part| part.iter().sum::<f64>() / part.len() as f64);
            coarse.iter().zip(means).map(|(a, b)| (a - b).abs()).sum::<f64>() / (2.0 * volume)
        };
        let [far, near] = [apart([&piles[0], &piles[2]]), apart([&piles[1], &piles[2]])];
        assert!(near < 0.01 && far < 0.05, "{scheme}: {far} {near}");
    }
}

#[test]
fn colliding_masses_keep_momentum_and_symmetry_and_lose_energy() {
    for scheme in SCHEMES {
        for plane in ["", ", y = { from = -1.0, to = 1.0, cells = 12 }"] {
            let text = format!(
                "grid = {{ x = {{ from = -3.0, to = 3.0, cells = 90 }}{plane} }}\n[material]\nepsilon = 0.2\n\
                 friction.coulomb = {{ mu = 0.0 }}\nearth_pressure.active_passive = {{ internal = \"40 deg\" }}\n\
                 [initial]\nthickness.formula = \"0.2 + max(0, 1 - (abs(x) - 1)^2*4)\"\n\
                 velocity_x.formula = \"if(abs(x) < 1.8, if(x < 0, 1, if(x > 0, -1, 0)), 0)\"\n\
                 [scheme]\nname = \"{scheme}\"\n[time]\nend = 0.6\n"
            );
            let mut run = start(&text);
            let begun = run.totals().energy;
            run.until(0.6).unwrap();
            let energy = run.totals().energy;
            let (h, u) = (run.field("thickness").unwrap(), run.field("velocity_x").unwrap());
            let (h, u): (Vec<f64>, Vec<f64>) = (h.iter().collect(), u.iter().collect());
            let momentum: f64 = h.iter().zip(&u).map(|(h, u)| h * u).sum();
            let size: f64 = h.iter().zip(&u).map(|(h, u)| (h * u).abs()).sum();
            assert!(momentum.abs() < 1e-13 * size.max(1.0), "{scheme}: {momentum:e}");
            // The limiter of balanced_2 multiplies roundings in thin layers.
            let rows = if scheme == "balanced_2" { 0 } else { h.len() / 90 };
            for row in 0..rows {
                for k in 0..45 {
                    // A part that moves as one has the mean velocity, whose sum is rounded from one end to the other.
                    let (a, b) = (row * 90 + k, row * 90 + 89 - k);
                    assert!((h[a] - h[b]).abs() < 1e-12, "{scheme}: cell {k}, {} {}", h[a], h[b]);
                    assert!((u[a] + u[b]).abs() < 1e-11, "{scheme}: cell {k}, {} {}", u[a], u[b]);
                }
            }
            assert!(energy < begun, "{scheme}");
        }
    }
}

#[test]
fn what_has_no_such_coefficient_is_refused() {
    let text = |pressure: &str, more: &str| {
        format!(
            "grid.x = {{ from = -1.0, to = 1.0, cells = 10 }}\ninitial.thickness = 1.0\ntime.end = 1.0\n{more}{}",
            material(pressure)
        )
    };
    for (text, words) in [
        (text(".active_passive = { internal = \"20 deg\" }", ""), "below that of the bed, 25.000 deg"),
        (text(".active_passive = { internal = \"95 deg\" }", ""), "below 90 deg"),
        (
            text(".active_passive = { internal = \"35 deg\" }", "scheme.name = \"verfahren_1\"\n"),
            "one earth-pressure coefficient",
        ),
    ] {
        let error = Case::parse(&text, "test.toml").and_then(|case| case.check().map(drop)).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
    }
}

/// Benchmark C with k_act along both axes: the cap is stretched along both as it slides down.
#[test]
fn a_round_cap_spreads_with_the_active_coefficient() {
    let [active, _] = coefficients(INTERNAL.to_radians().tan(), BED.to_radians().tan()).unwrap();
    let text = "grid = { x = { from = -120.0, to = 160.0, cells = 112 }, y = { from = -120.0, to = 120.0, cells = 96 } }\n\
                initial.thickness.cap = { height = 4.0, radius = 80.0 }\nscheme.name = \"energy_stable_2\"\ntime.end = 5.0\n\
                [material]\ngravity = 9.81\nslope = \"35 deg\"\nfriction.coulomb = { angle = \"25 deg\" }\n\
                earth_pressure.active_passive = { internal = \"35 deg\" }\n";
    let mut run = start(text);
    run.until(5.0).unwrap();
    let (dx, h) = (2.5, run.field("thickness").unwrap());
    let error = |k: f64| {
        let release = CapRelease {
            height: 4.0,
            length: 80.0,
            slope: SLOPE.to_radians(),
            friction: BED.to_radians(),
            earth_pressure: k,
            gravity: 9.81,
        };
        let exact = SimilarityCap::new(release, 80.0, k).unwrap().at(5.0);
        let (mut wrong, mut volume) = (0.0, 0.0);
        for (cell, h) in h.iter().enumerate() {
            let place = [cell % 112, cell / 112].map(|k| -120.0 + (k as f64 + 0.5) * dx);
            wrong += (h - exact.flow(place[0], place[1]).h).abs();
            volume += h;
        }
        wrong / volume
    };
    let (own, one) = (error(active), error(1.0));
    assert!(own < 0.01, "{own}");
    assert!(one > 2.0 * own, "{one} under k = 1");
}

/// A wall is the mirror: a cap that runs against one, on either side, is half of two that run against each other.
#[test]
fn a_wall_is_a_mirror_at_either_end() {
    for scheme in ["energy_stable", "energy_stable_2", "balanced"] {
        let run = |from: f64, to: f64, cells: usize, sides: [&str; 2], thickness: &str, velocity: &str| {
            let text = format!(
                "grid.x = {{ from = {from}, to = {to}, cells = {cells} }}\ngrid.boundary.x = [\"{}\", \"{}\"]\n\
                 initial.thickness.formula = \"{thickness}\"\ninitial.velocity_x.formula = \"{velocity}\"\n\
                 scheme.name = \"{scheme}\"\ntime.end = 1.5\n[material]\nepsilon = 0.3\nfriction.coulomb = {{ mu = 0.3 }}\n\
                 earth_pressure.active_passive = {{ internal = \"35 deg\" }}\n",
                sides[0], sides[1]
            );
            let mut run = start(&text);
            run.until(1.5).unwrap();
            run.field("thickness").unwrap().iter().collect::<Vec<f64>>()
        };
        let left =
            run(0.0, 4.0, 200, ["wall", "open"], "max(0, 1 - ((x-1)/0.9)^2)", "if(abs(x-1) < 0.9, -1.5, 0)");
        let right =
            run(-4.0, 0.0, 200, ["open", "wall"], "max(0, 1 - ((x+1)/0.9)^2)", "if(abs(x+1) < 0.9, 1.5, 0)");
        let both = run(
            -4.0,
            4.0,
            400,
            ["open", "open"],
            "max(0, 1 - ((abs(x)-1)/0.9)^2)",
            "if(abs(abs(x)-1) < 0.9, if(x > 0, -1.5, 1.5), 0)",
        );
        for k in 0..200 {
            for (found, wanted) in [(left[k], both[200 + k]), (right[k], both[k]), (left[k], right[199 - k])]
            {
                assert!((found - wanted).abs() < 1e-9, "{scheme}: cell {k}, {found} {wanted}");
            }
        }
    }
}
