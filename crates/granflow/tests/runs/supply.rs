//! Mass that comes in the course of a run: late and secondary releases, inflows by hydrographs.

use super::valley::{CELL, FIRST, number, start, steps, thickness, try_start, valley, write_grid};
use granflow::Case;
use granflow::case::Frames;
use granflow::run::{Ends, Run, Until, drive};
use granflow::sinks::Memory;
use std::fs;

#[test]
fn a_hydrograph_brings_its_integral_whatever_the_steps() {
    let folder = valley();
    let hydrograph = "time = [1.3, 2.0, 5.7, 9.1], discharge = [0.0, 40.0, 25.0, 0.0]";
    let exact = 0.5 * 0.7 * 40.0 + 0.5 * 3.7 * 65.0 + 0.5 * 3.4 * 25.0;
    for (over, rest) in [
        ("line = [[30.0, 47.0], [30.0, 73.0]]", ""),
        ("line = [[30.0, 47.0], [33.0, 73.0]]", ", speed = [3.0, 8.0, 8.0, 2.0]"),
        ("polygons = \"pond.geojson\"", ""),
    ] {
        fs::write(
            folder.path().join("pond.geojson"),
            r#"{"type":"Polygon","coordinates":[[[20,50],[38,50],[38,71],[20,71],[20,50]]]}"#,
        )
        .unwrap();
        let inflow = format!("[[inflow]]\n{over}\nhydrograph = {{ {hydrograph}{rest} }}\n");
        let mut run = start(folder.path(), &inflow, "until = \"rest\"\nend = 400.0");
        assert_eq!(run.totals().volume, 0.0);
        run.to_rest(400.0).unwrap();
        let poured = run.stepper().poured();
        assert!((poured / exact - 1.0).abs() < 1e-13, "{over}{rest}: {poured} instead of {exact}");
        let volume = run.totals().volume + run.stepper().outflow().iter().sum::<f64>();
        assert!((volume / exact - 1.0).abs() < 1e-12, "{over}{rest}: {volume} of {exact} is left");
        assert!(run.at_rest() && run.time() > 9.1);
    }
}

/// With a speed a mass arrives with its momentum: h u summed over the cells.
#[test]
fn an_inflow_brings_the_momentum_of_its_speed() {
    let folder = tempfile::tempdir().unwrap();
    write_grid(&folder.path().join("dem.asc"), [40, 40], |_, _| 100.0);
    let inflow = "[[inflow]]\nline = [[100.0, 80.0], [100.0, 120.0]]\ndirection = [3.0, 4.0]\n\
                  hydrograph = { time = [0.0, 0.002], discharge = [50.0, 50.0], speed = [10.0, 10.0] }\n";
    let mut run = start(folder.path(), inflow, "end = 1.0");
    let momentum = |run: &dyn Run| {
        let [h, u, v] = ["thickness", "velocity_x", "velocity_y"]
            .map(|name| run.field(name).unwrap().iter().collect::<Vec<f64>>());
        let sum = |w: &[f64]| h.iter().zip(w).map(|(h, w)| h * w).sum::<f64>() * CELL * CELL;
        [sum(&u), sum(&v)]
    };
    // The first step sees nothing yet; the second moves what came in the first.
    while run.time() < 0.002 {
        run.step(0.002).unwrap();
    }
    run.step(0.0021).unwrap();
    let [x, y] = momentum(&*run);
    let volume = run.totals().volume;
    assert!((volume - 0.1).abs() < 1e-13, "{volume}");
    // Friction took at most mu g t of the speed.
    assert!(
        (x / volume - 6.0).abs() < 0.02 && (y / volume - 8.0).abs() < 0.02,
        "{} {}",
        x / volume,
        y / volume
    );
}

/// The depth on the plane b = 300 - 0.4 x under a steady discharge of 2 m^2/s, away from the line where it enters.
fn steady(friction: &str, scheme: &str) -> Vec<f64> {
    let folder = tempfile::tempdir().unwrap();
    write_grid(&folder.path().join("dem.asc"), [60, 41], |x, _| 300.0 - 0.4 * x);
    let path = folder.path().join("case.toml");
    let text = format!(
        "[terrain]\ndem = \"dem.asc\"\ncrs = \"EPSG:31287\"\n[material]\ndensity = 200.0\n{friction}\n\
         [scheme]\nname = \"{scheme}\"\n[[inflow]]\nline = [[22.5, 0.0], [22.5, 205.0]]\n\
         hydrograph = {{ time = [0.0, 500.0], discharge = [410.0, 410.0], speed = [4.0, 4.0] }}\n[time]\nend = 150.0\n"
    );
    fs::write(&path, text).unwrap();
    let mut run = Case::read(&path).unwrap().check().unwrap().start().unwrap();
    run.until(150.0).unwrap();
    let h: Vec<f64> = run.field("thickness").unwrap().iter().collect();
    h[20 * 60 + 30..20 * 60 + 55].to_vec()
}

/// Voellmy: q = h v and v^2 = xi h (sin - mu cos), slow enough (Fr^2 = xi (tan - mu)/g = 1.5) to make no roll waves, which grow
/// from Fr = 2 on. In a forest: v^2 = g (sin - mu cos)/drag, whatever the depth.
#[test]
fn a_steady_inflow_reaches_the_uniform_depth_of_its_discharge() {
    let [sin, cos] = [0.4, 1.0].map(|leg| leg / 1.0_f64.hypot(0.4));
    let per_width = 410.0_f64 / 205.0;
    let pull = sin - 0.3 * cos;
    let voellmy = (per_width * per_width / (150.0 * pull)).cbrt();
    let forest = per_width / (9.81 * pull / 0.05).sqrt();
    for scheme in ["energy_stable", "energy_stable_2"] {
        for (friction, depth) in [
            ("friction.voellmy = { mu = 0.3, xi = 150.0 }", voellmy),
            ("friction.coulomb = { mu = 0.3 }\nforest = 0.05", forest),
        ] {
            let found = steady(friction, scheme);
            let worst = found.iter().map(|h| (h / depth - 1.0).abs()).fold(0.0, f64::max);
            println!("{scheme}, {friction}: {depth} m to {worst:e}");
            assert!(worst < 1e-6, "{scheme}, {friction}: {found:?} instead of {depth}");
        }
    }
}

#[test]
fn a_late_release_flows_as_one_at_the_start() {
    let folder = valley();
    // Both runs have something to come, and so no bound on the head from what lies there at the start.
    let aside = "[[release]]\ncap = { height = 1.0, centre = [40.0, 8.0], radius = 5.0 }\nat = 1e6\n";
    let mut early = start(folder.path(), &format!("{FIRST}{aside}"), "end = 50.0");
    let mut late = start(folder.path(), &format!("{aside}{FIRST}at = 3.0\n"), "end = 50.0");
    late.step(1e9).unwrap();
    assert_eq!((late.time(), late.totals().volume, late.at_rest()), (3.0, 0.0, false));
    steps(&mut *early, 60);
    steps(&mut *late, 60);
    assert!(thickness(&*early) == thickness(&*late));
    assert!((late.time() - 3.0 - early.time()).abs() < 1e-12);
    assert!((late.stepper().poured() / early.totals().volume - 1.0).abs() < 1e-13);
}

#[test]
fn a_secondary_release_starts_when_it_is_hit_and_rest_does_not_wait_for_one_that_is_not() {
    let folder = valley();
    let second =
        "[[release]]\ncap = { height = 2.0, centre = [150.0, 60.0], radius = 20.0 }\nwhen = \"hit\"\n";
    let aside = "[[release]]\ncap = { height = 2.0, centre = [40.0, 8.0], radius = 5.0 }\nwhen = \"hit\"\n";
    let mut run = start(folder.path(), &format!("{FIRST}{second}{aside}"), "until = \"rest\"");
    let before = run.totals().volume;
    while run.stepper().poured() == 0.0 {
        run.step(1e9).unwrap();
    }
    // The front has some 100 m to go.
    assert!(run.time() > 2.0 && run.time() < 15.0, "{}", run.time());
    assert!(number(&*run, "unreleased_volume").unwrap() > 0.0);
    run.to_rest(1000.0).unwrap();
    assert!(run.at_rest());
    let whole = before + run.stepper().poured();
    assert!((run.totals().volume / whole - 1.0).abs() < 1e-12);
    assert!(number(&*run, "unreleased_volume").unwrap() > 0.0, "nothing came by there");
}

/// Neither rest, nor a trickle, nor a low speed ends a run for which something is still to come.
#[test]
fn a_run_until_rest_waits_for_what_is_to_come() {
    let folder = valley();
    let again = "[[release]]\ncap = { height = 2.0, centre = [60.0, 60.0], radius = 20.0 }\nat = 100.0\n";
    let pulse = "[[inflow]]\nline = [[60.0, 50.0], [60.0, 70.0]]\n\
                 hydrograph = { time = [90.0, 91.0, 95.0], discharge = [0.0, 30.0, 0.0] }\n";
    for (later, volume) in [(again, None), (pulse, Some(75.0))] {
        for rest in [
            Until::Rest { speed: None, trickle: None },
            Until::Rest { speed: None, trickle: Some(0.01) },
            Until::Rest { speed: Some(0.5), trickle: None },
        ] {
            let mut run = start(folder.path(), &format!("{FIRST}{later}"), "end = 900.0");
            let ends = Ends { steps: None, time: Some(900.0), until: Some(rest), kinetic_energy: None };
            let reason = drive(&mut *run, &ends, &mut []).unwrap();
            let poured = run.stepper().poured();
            assert!(run.time() > 95.0 && run.time() < 900.0, "{rest:?} ends at {} by {reason}", run.time());
            assert!(
                volume.is_none_or(|all| (poured / all - 1.0_f64).abs() < 1e-13) && poured > 1.0,
                "{poured}"
            );
        }
    }
}

#[test]
fn what_comes_at_the_end_is_there_at_the_end() {
    let folder = valley();
    let inflow = "[[inflow]]\nline = [[60.0, 50.0], [60.0, 70.0]]\n\
                  hydrograph = { time = [0.0, 10.0], discharge = [50.0, 50.0] }\n";
    for end in [0.7, 5.0, 10.0, 11.0] {
        let mut run = start(folder.path(), inflow, "end = 50.0");
        let ends = Ends { steps: None, time: Some(end), until: None, kinetic_energy: None };
        drive(&mut *run, &ends, &mut []).unwrap();
        let (poured, exact) = (run.stepper().poured(), 50.0 * end.min(10.0));
        assert!((poured / exact - 1.0).abs() < 1e-13, "{poured} instead of {exact}");
    }
    let mut run = start(folder.path(), &format!("{FIRST}at = 7.0\n"), "end = 50.0");
    run.until(7.0).unwrap();
    assert!(run.totals().volume > 1000.0);
    let peak = run.peaks().into_iter().find(|(name, _)| *name == "peak_thickness").unwrap().1;
    let largest = peak.into_iter().filter(|h| !h.is_nan()).fold(0.0, f64::max);
    assert!((largest - 3.0).abs() < 0.1, "the release itself counts: {largest}");
}

/// Frames before a release do not show it, that at its time does.
#[test]
fn a_frame_shows_a_release_from_its_time_on() {
    let folder = valley();
    let mut run = start(folder.path(), &format!("{FIRST}at = 3.0\n"), "end = 50.0");
    let mut memory = Memory::begin(&mut *run, Frames::Every(0.5), &["thickness"]);
    let ends = Ends { steps: None, time: Some(4.0), until: None, kinetic_energy: None };
    drive(&mut *run, &ends, &mut [&mut memory]).unwrap();
    for entry in memory.finish(&mut *run).ledger {
        assert_eq!(entry.mass > 0.0, entry.time >= 3.0, "at {}: {}", entry.time, entry.mass);
    }
}

#[test]
fn a_mass_enters_at_rest_where_there_is_no_way_down() {
    let folder = tempfile::tempdir().unwrap();
    write_grid(&folder.path().join("dem.asc"), [21, 21], |_, _| 100.0);
    let inflow = "[[inflow]]\nline = [[52.0, 40.0], [52.0, 60.0]]\n\
                  hydrograph = { time = [0.0, 10.0], discharge = [1.0, 1.0] }\n";
    let mut run = start(folder.path(), inflow, "end = 400.0");
    run.to_rest(400.0).unwrap();
    assert!((run.totals().volume / 10.0 - 1.0).abs() < 1e-12, "{}", run.totals().volume);
}

#[test]
fn a_comma_is_a_decimal_point_where_semicolons_part_the_numbers() {
    let folder = valley();
    fs::write(folder.path().join("q.csv"), "\u{feff}Zeit;Q\n0;1,5\n60;2,5\n").unwrap();
    let inflow = "[[inflow]]\nline = [[60.0, 50.0], [60.0, 70.0]]\nhydrograph = \"q.csv\"\n";
    let mut run = start(folder.path(), inflow, "end = 80.0");
    run.until(61.0).unwrap();
    assert!((run.stepper().poured() / 120.0 - 1.0).abs() < 1e-13, "{}", run.stepper().poured());
}

#[test]
fn columns_are_taken_by_their_names() {
    let folder = valley();
    let inflow = "[[inflow]]\nline = [[60.0, 50.0], [60.0, 70.0]]\nhydrograph = \"q.csv\"\n";
    fs::write(folder.path().join("q.csv"), "speed [m/s],time [s],Q (m3/s)\n1,0,5\n1,20,5\n").unwrap();
    let mut run = start(folder.path(), inflow, "end = 80.0");
    run.until(21.0).unwrap();
    assert!((run.stepper().poured() / 100.0 - 1.0).abs() < 1e-13, "{}", run.stepper().poured());
    for (text, said) in [
        ("time [min],discharge\n0,5\n20,5\n", "`min`"),
        ("time,depth\n0,5\n20,5\n", "`depth`"),
        ("time,speed\n0,5\n20,5\n", "no column `discharge`"),
        ("time,discharge,speed\n0,5\n20,5\n", "names 3 columns and has 2"),
    ] {
        fs::write(folder.path().join("q.csv"), text).unwrap();
        let error = try_start(folder.path(), inflow, "end = 9.0").err().unwrap();
        assert!(error.contains(said), "{text}: {error}");
    }
}

#[test]
fn the_order_of_the_releases_changes_no_bit() {
    let folder = valley();
    let cap = |height: f64, x: f64, when: &str| {
        format!(
            "[[release]]\ncap = {{ height = {height:?}, centre = [{x:?}, 60.0], radius = 20.0 }}\n{when}\n"
        )
    };
    let parts = [
        cap(1.1, 130.0, "at = 2.0"),
        cap(0.7, 133.0, "at = 2.0"),
        cap(0.3, 137.0, "when = \"hit\""),
        cap(1.3, 135.0, "at = 2.0"),
        FIRST.to_owned(),
    ];
    let ends = [[0, 1, 2, 3, 4], [4, 3, 2, 1, 0], [3, 0, 4, 2, 1]].map(|order| {
        let text: String = order.iter().map(|k| parts[*k].as_str()).collect();
        let mut run = start(folder.path(), &text, "end = 50.0");
        run.until(8.0).unwrap();
        thickness(&*run)
    });
    assert!(ends[0] == ends[1] && ends[0] == ends[2]);
}

#[test]
fn a_run_taken_up_in_the_middle_goes_on_to_the_same_bits() {
    let folder = valley();
    let parts = format!(
        "{FIRST}[[release]]\ncap = {{ height = 2.0, centre = [120.0, 60.0], radius = 20.0 }}\nwhen = \"hit\"\n\
         [[release]]\ncap = {{ height = 2.0, centre = [90.0, 60.0], radius = 20.0 }}\nat = 6.0\n\
         [[inflow]]\nline = [[60.0, 50.0], [60.0, 70.0]]\n\
         hydrograph = {{ time = [1.0, 9.0], discharge = [30.0, 10.0] }}\n"
    );
    for middle in [0.5, 3.0, 7.0, 12.0] {
        let mut whole = start(folder.path(), &parts, "end = 50.0");
        let mut part = start(folder.path(), &parts, "end = 50.0");
        while whole.time() < middle {
            whole.step(1e9).unwrap();
        }
        part.restore(whole.save().into_owned()).unwrap();
        steps(&mut *whole, 80);
        steps(&mut *part, 80);
        assert!(thickness(&*whole) == thickness(&*part), "from {middle} s");
        assert_eq!(whole.stepper().poured().to_bits(), part.stepper().poured().to_bits());
    }
}

#[test]
fn what_is_wrong_with_a_supply_is_named_with_a_cure() {
    let folder = valley();
    fs::write(folder.path().join("q.csv"), "time,discharge\n0,5\n10,many\n").unwrap();
    fs::write(folder.path().join("one.csv"), "0\n10\n").unwrap();
    let table = "hydrograph = { time = [0, 9], discharge = [5, 0] }";
    for (parts, said) in [
        (format!("{FIRST}at = 3.0\nwhen = \"hit\"\n"), vec!["at", "when"]),
        (format!("{FIRST}at = -3.0\n"), vec![">= 0"]),
        (format!("{FIRST}when = \"hit\"\n"), vec!["starts by itself"]),
        (format!("[[inflow]]\n{table}\n"), vec!["exactly one of line, polygons"]),
        (format!("[[inflow]]\nline = [[10, 20]]\n{table}\n"), vec!["two points"]),
        (
            format!("[[inflow]]\nline = [[10, 20], [900, 20]]\n{table}\n"),
            vec!["no elevation", "the line of an inflow"],
        ),
        (
            "[[inflow]]\nline = [[10, 20], [10, 40]]\nhydrograph = \"q.csv\"\n".to_owned(),
            vec!["q.csv", "line 3", "many"],
        ),
        (
            "[[inflow]]\nline = [[10, 20], [10, 40]]\nhydrograph = \"one.csv\"\n".to_owned(),
            vec!["one.csv", "1 columns"],
        ),
        (
            "[[inflow]]\nline = [[10, 20], [10, 40]]\nhydrograph = \"none.csv\"\n".to_owned(),
            vec!["cannot read", "none.csv"],
        ),
        (
            "[[inflow]]\nline = [[10, 20], [10, 40]]\nhydrograph = { time = [5, 4], discharge = [1, 1] }\n"
                .to_owned(),
            vec!["growing"],
        ),
        (
            "[[inflow]]\nline = [[10, 20], [10, 40]]\nhydrograph = { time = [4, 5], discharge = [1] }\n"
                .to_owned(),
            vec!["2 times and 1 values of discharge"],
        ),
        (
            "[[inflow]]\nline = [[10, 20], [10, 40]]\nhydrograph = { time = [4, 5], discharge = [0, 0] }\n"
                .to_owned(),
            vec!["no volume"],
        ),
    ] {
        let error = match try_start(folder.path(), &parts, "end = 9.0") {
            Ok(_) => panic!("{parts} passed"),
            Err(error) => error,
        };
        for part in said {
            assert!(error.contains(part), "{parts}: `{part}` is not in\n{error}");
        }
    }
}
