//! A run one can hold: memory, views, save and restore, frames, all without a disk.

#[path = "support/asc.rs"]
mod asc;
#[path = "runs/erosion.rs"]
mod erosion;
#[path = "runs/pressed.rs"]
mod pressed;
#[path = "runs/supply.rs"]
mod supply;
#[path = "runs/valley.rs"]
mod valley;

use granflow::Case;
use granflow::build::{Avalanche, Grid, Sandpile, Table};
use granflow::case::Frames;
use granflow::run::{Ends, Run, StopReason, Until, drive};
use granflow::sinks::{Callback, Memory};

const PILE: &str = r#"
model = "hadeler_kuttler"
grid = { x = { from = 0.0, to = 1.0, cells = 16 }, y = { from = 0.0, to = 1.0, cells = 12 } }
table.cut = [{ box = [0.5, 1.0, 0.5, 1.0] }]
source = [{ rate.formula = "0.5*max(0, sin(3*t))*(1 + x)" }, { rate = 0.25, on.box = [0.0, 0.4, 0.0, 0.4], from = 0.3, to = 0.9 }]
time.end = 1.5
"#;

const SLIDE: &str = r#"
grid = { x = { from = -3.0, to = 6.0, cells = 40 }, y = { from = -3.0, to = 3.0, cells = 24 } }
material = { epsilon = 0.4, slope = "12 deg", friction.coulomb = { angle = "22 deg" } }
initial.thickness.cap = { height = 1.0, radius = 1.5 }
scheme.name = "balanced_2"
time = { until = "rest", end = 50.0 }
"#;

fn start(text: &str) -> Box<dyn Run> {
    Case::parse(text, "test.toml").unwrap().check().unwrap().start().unwrap()
}

/// All fields, as bits.
fn bits(run: &dyn Run) -> Vec<u64> {
    let names: Vec<String> = run.plane().series().into_iter().map(|field| field.name).collect();
    names
        .iter()
        .flat_map(|name| run.field(name).unwrap().iter().map(f64::to_bits).collect::<Vec<_>>())
        .collect()
}

/// The bits of the maps of peaks and times, which have no value in most cells.
fn peaks(run: &dyn Run) -> Vec<u64> {
    run.peaks().iter().flat_map(|(_, map)| map.iter().map(|value| value.to_bits())).collect()
}

#[test]
fn a_run_is_saved_and_taken_up_again_bit_for_bit() {
    for text in [PILE, SLIDE] {
        let (mut whole, mut parts) = (start(text), start(text));
        whole.until(0.4).unwrap();
        let saved = whole.save().into_owned();
        whole.until(1.2).unwrap();
        parts.until(0.1).unwrap(); // somewhere else
        parts.restore(saved).unwrap();
        assert_eq!(parts.time(), 0.4);
        parts.until(1.2).unwrap();
        assert!(bits(&*whole) == bits(&*parts));
        assert_eq!(whole.record().peak_speed, parts.record().peak_speed);
        assert_eq!(whole.peaks().len(), parts.peaks().len());
        for ((name, a), (_, b)) in whole.peaks().iter().zip(parts.peaks()) {
            assert!(a.iter().zip(&b).all(|(a, b)| a.to_bits() == b.to_bits()), "{name}");
        }
    }
}

#[test]
fn what_does_not_fit_is_refused_in_words() {
    let (slide, mut pile) = (start(SLIDE), start(PILE));
    let refused = pile.restore(slide.save().into_owned()).unwrap_err();
    assert!(refused.contains("40 x 24 cells"), "{refused}");
    let mut turned = start(
        &SLIDE
            .replace("cells = 40", "cells = 0")
            .replace("cells = 24", "cells = 40")
            .replace("cells = 0", "cells = 24"),
    );
    let refused = turned.restore(slide.save().into_owned()).unwrap_err();
    assert!(refused.contains("40 x 24 cells") && refused.contains("24 x 40"), "{refused}");
}

#[test]
fn a_field_of_the_state_is_shown_without_a_copy() {
    let mut run = start(SLIDE);
    run.until(0.5).unwrap();
    let view = run.field("thickness").unwrap();
    assert!(view.is_borrowed());
    assert_eq!(view.shape, [24, 40]);
    let mut filled = vec![0.0; 24 * 40];
    run.fill(0, 0, &mut filled);
    assert!(view.iter().eq(filled.iter().copied()));
    assert_eq!(view.at(7, 5), filled[5 * 40 + 7]);
    assert!(run.field("velocity_x").is_some_and(|view| !view.is_borrowed()));
    assert!(run.field("depth").is_none());
    let pile = start(PILE);
    assert!(pile.field("rolling_layer").unwrap().iter().any(f64::is_nan), "the cut corner has no value");
}

#[test]
fn frames_come_at_their_instants_and_end_at_rest() {
    let mut run = start(SLIDE);
    let mut frames = run.frames(0.5);
    let mut times = Vec::new();
    while let Some(run) = frames.next().unwrap() {
        times.push(run.time());
    }
    assert!(times.len() > 3, "{times:?}");
    let (last, regular) = times.split_last().unwrap();
    assert!(regular.iter().enumerate().all(|(k, time)| *time == 0.5 * k as f64), "{times:?}");
    assert!(run.at_rest() && run.time() == *last && run.stepper().speed() == 0.0);
}

#[test]
fn sinks_see_every_step_and_memory_keeps_what_it_is_asked_for() {
    let mut run = start(SLIDE);
    let mut memory = Memory::begin(&mut *run, Frames::Every(1.0), &["thickness"]);
    let mut steps = 0;
    let mut count = Callback(|run: &dyn Run| {
        steps += 1;
        assert_eq!(run.steps(), steps);
    });
    let ends = Ends {
        until: Some(Until::Rest { speed: None, trickle: None }),
        time: Some(50.0),
        steps: None,
        kinetic_energy: None,
    };
    drive(&mut *run, &ends, &mut [&mut count, &mut memory]).unwrap();
    let recording = memory.finish(&mut *run);
    assert_eq!(steps, run.steps());
    assert_eq!(recording.fields.len(), 1);
    assert_eq!(recording.times.len(), recording.field("thickness").unwrap().len());
    assert_eq!(recording.ledger.len(), recording.times.len());
    assert!(recording.ledger.iter().all(|line| line.mass_error.abs() < 1e-13));
    assert!(recording.map("deposit").is_some() && recording.map("peak_speed").is_some());
}

#[test]
fn a_builder_and_a_case_make_the_same_run() {
    let case = r#"
grid.x = { from = -6.0, to = 6.0, cells = 240 }
material = { epsilon = 0.4, friction.coulomb = { mu = 0.32 } }
initial.thickness.steps = { at = [-1.0, 1.0], values = [0.3, 2.3, 0.3] }
time = { until = "rest", end = 50.0 }
"#;
    let column = |[x]: [f64; 1]| if x > -1.0 && x <= 1.0 { 2.3 } else { 0.3 };
    let grid = Grid::line([-6.0, 6.0], 240);
    let built = Avalanche::on_plane(grid, 0.0).scaled(0.4).mu(0.32).thickness(column).start();
    let (mut built, mut read) = (built.unwrap(), start(case));
    assert!(built.to_rest(50.0).unwrap() && read.to_rest(50.0).unwrap());
    assert!(bits(&*built) == bits(&*read));
}

const SWITCHED: &str = r#"
model = "hadeler_kuttler"
grid = { x = { from = 0.0, to = 1.0, cells = 20 } }
source = [{ rate = 0.5, from = 0.25, to = 1.0 }]
time.end = 3.0
"#;

#[test]
fn a_run_put_back_pours_what_its_time_asks_for() {
    let mut run = start(SWITCHED);
    run.until(0.5).unwrap();
    let saved = run.save().into_owned();
    run.until(2.0).unwrap();
    let (poured, state) = (run.stepper().poured(), bits(&*run));
    run.restore(saved).unwrap();
    run.until(2.0).unwrap();
    assert_eq!(run.stepper().poured(), poured);
    assert!(bits(&*run) == state);
}

#[test]
fn nothing_is_at_rest_before_its_last_source() {
    let mut run = start(SWITCHED);
    assert!(!run.to_rest(0.2).unwrap() && run.time() == 0.2);
    run.until(0.6).unwrap();
    assert!(run.stepper().poured() > 0.0);
}

#[test]
fn a_sink_goes_on_where_a_run_was_stepped_past_its_instant() {
    let mut run = start(SLIDE);
    let mut memory = Memory::begin(&mut *run, Frames::Every(0.25), &["thickness"]);
    run.until(0.9).unwrap();
    let ends = Ends { steps: None, time: Some(1.5), until: None, kinetic_energy: None };
    drive(&mut *run, &ends, &mut [&mut memory]).unwrap();
    let times = memory.finish(&mut *run).times;
    assert!(times.len() > 3 && times.is_sorted() && times.last() == Some(&1.5), "{times:?}");
}

const FIXED: &str = r#"
grid.x = { from = -6.0, to = 6.0, cells = 60 }
material.friction.coulomb = { angle = "18 deg" }
initial.thickness.cap = { height = 1.0, radius = 2.0 }
scheme = { name = "verfahren_5", step = 0.003 }
time.end = 1.0
"#;

#[test]
fn what_is_looked_at_changes_nothing_of_what_is_computed() {
    let ends = |time| Ends {
        steps: None,
        time: Some(time),
        until: Some(Until::Rest { speed: None, trickle: None }),
        kinetic_energy: None,
    };
    for (text, end) in [(PILE, 1.5), (SLIDE, 50.0), (SLIDE, 80.0), (FIXED, 1.0)] {
        let mut alone = start(text);
        let reason = drive(&mut *alone, &ends(end), &mut []).unwrap();
        for every in [0.3, 0.017, 0.0023, 7.0] {
            let mut run = start(text);
            let mut memory = Memory::begin(&mut *run, Frames::Every(every), &[]);
            let mut other = Memory::begin(&mut *run, Frames::Every(0.7 * every), &[]);
            assert_eq!(drive(&mut *run, &ends(end), &mut [&mut memory, &mut other]).unwrap(), reason);
            assert!(bits(&*run) == bits(&*alone), "frames every {every}");
            assert_eq!((run.time(), run.steps()), (alone.time(), alone.steps()));
            assert_eq!(run.stepper().outflow(), alone.stepper().outflow());
            assert_eq!(run.stepper().poured(), alone.stepper().poured());
            assert!(peaks(&*run) == peaks(&*alone), "frames every {every}");
            let recording = memory.finish(&mut *run);
            let (last, regular) = recording.times.split_last().unwrap();
            assert_eq!(*last, alone.time());
            assert!(regular.iter().enumerate().all(|(k, time)| (time - every * k as f64).abs() < 1e-12));
            // The published schemes lose mass beside resting cells.
            if text != FIXED {
                assert!(
                    recording.ledger.iter().all(|line| line.mass_error.abs() <= 1e-14),
                    "{:?}",
                    recording.ledger
                );
            }
        }
    }
}

#[test]
fn an_instant_lies_on_the_straight_line_between_two_steps() {
    for text in [PILE, SLIDE, FIXED] {
        let mut run = start(text);
        run.until(0.2).unwrap();
        let begin = (run.time(), fields(&*run));
        run.stepper_mut().expect(begin.0);
        run.step(f64::INFINITY).unwrap();
        let (end, outflow) = ((run.time(), fields(&*run)), run.stepper().outflow());
        for share in [0.25, 0.5, 0.875, 1.0] {
            let time = begin.0 + share * (end.0 - begin.0);
            run.stepper_mut().show(time);
            assert_eq!(run.time(), time);
            for ((shown, a), b) in fields(&*run).iter().zip(&begin.1).zip(&end.1) {
                assert!(
                    (shown - (a + share * (b - a))).abs() <= 4e-15 * a.abs().max(b.abs()),
                    "{a} {shown} {b}"
                );
            }
        }
        run.stepper_mut().show_end();
        assert!(fields(&*run) == end.1 && run.time() == end.0 && run.stepper().outflow() == outflow);
    }
}

#[test]
fn frames_within_one_step_are_those_of_the_step() {
    for text in [PILE, SLIDE, FIXED] {
        let (mut whole, mut run) = (start(text), start(text));
        whole.until(0.2).unwrap();
        run.until(0.2).unwrap();
        let begin = (whole.time(), fields(&*whole));
        whole.step(f64::INFINITY).unwrap();
        let end = (whole.time(), fields(&*whole));
        let every = (end.0 - begin.0) / 3.5;
        let mut frames = run.frames(every);
        while let Some(run) = frames.next().unwrap() {
            let time = run.time();
            if time >= end.0 {
                break;
            }
            let share = (time - begin.0) / (end.0 - begin.0);
            for ((shown, a), b) in fields(&*run).iter().zip(&begin.1).zip(&end.1) {
                let most = 1e-14 * a.abs().max(b.abs());
                assert!((shown - (a + share * (b - a))).abs() <= most, "at {share}: {a} {shown} {b}");
            }
        }
        // What goes on goes on from the end of the step, not from what was shown last.
        let mut memory = Memory::begin(&mut *run, Frames::Every(0.3 * every), &[]);
        let until = run.time() + 20.0 * every;
        let ends = Ends { steps: None, time: Some(until), until: None, kinetic_energy: None };
        drive(&mut *run, &ends, &mut [&mut memory]).unwrap();
        assert_eq!(run.time(), until);
    }
}

/// The state, component by component.
fn fields(run: &dyn Run) -> Vec<f64> {
    let stepper = run.stepper();
    (0..stepper.components())
        .flat_map(|k| stepper.component(k).rows().flatten().copied().collect::<Vec<_>>())
        .collect()
}

#[test]
fn a_builder_refuses_what_a_case_refuses() {
    let slide = || Avalanche::on_plane(Grid::line([-1.0, 1.0], 10), 0.1);
    for (wrong, part) in [
        (slide().thickness(|_| -1.0).start(), "thickness is -1"),
        (slide().thickness(|_| f64::NAN).start(), "thickness is NaN"),
        (slide().mu(-1.0).start(), "friction"),
        (slide().mu(f64::NAN).start(), "friction"),
        (
            Sandpile::on(Table::rectangle([10], [[true; 2]]), [0.1]).source(|_| -1.0).start(),
            "rate of the source is -1",
        ),
    ] {
        let error = wrong.err().expect("it is out of range").to_string();
        assert!(error.contains(part), "{error}");
    }
}

/// A frame may be due a rounding of the step, but not of its own interval, after a step's end.
#[test]
fn a_frame_due_a_rounding_after_a_step_is_shown_once() {
    let text = format!("{FIXED}\noutput.every = 0.0010000000000005\n");
    let case = Case::parse(&text, "test.toml").unwrap().check().unwrap();
    let plan = case.plan().clone();
    let mut run = case.start().unwrap();
    let mut memory = Memory::begin(&mut *run, plan.output.frames, &["thickness"]);
    drive(&mut *run, &plan.ends, &mut [&mut memory]).unwrap();
    let times = memory.finish(&mut *run).times;
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
}

/// A thin layer under Voellmy's law on a slope steeper than mu, and a lump that stops below it.
const TRICKLE: &str = r#"
grid = { x = { from = 0.0, to = 400.0, cells = 200 }, boundary = "wall" }
scheme.film = 1e-4
material.gravity = 9.81
material.density = 200.0
material.slope = { x = [0.0, 200.0, 300.0, 400.0], angle = ["25 deg", "25 deg", "0 deg", "0 deg"] }
material.friction.voellmy = { mu = 0.3, xi = 1000.0 }
initial.thickness.formula = "max(0, sign(60 - x))"
time = { until = "rest", end = 4000.0, trickle = 0.01 }
"#;

#[test]
fn a_trickle_does_not_keep_a_run_from_ending_and_is_booked() {
    let run_of = |trickle: f64, every: f64| {
        let text = TRICKLE.replace("trickle = 0.01", &format!("trickle = {trickle:?}"));
        let checked = Case::parse(&text, "test.toml").unwrap().check().unwrap();
        assert!(checked.plan().notes.iter().any(|note| note.contains("drag")), "{:?}", checked.plan().notes);
        let ends = checked.plan().ends;
        let mut run = checked.start().unwrap();
        let mut memory = Memory::begin(&mut *run, Frames::Every(every), &["thickness"]);
        let reason = drive(&mut *run, &ends, &mut [&mut memory]).unwrap();
        (run, reason)
    };
    let (run, reason) = run_of(0.01, 1000.0);
    assert_eq!(reason, StopReason::Trickle);
    let (flowed, end) = (run.record().flowed, run.time());
    assert!(flowed > 10.0 && end >= 1.5 * flowed && !run.at_rest(), "{flowed} {end}");
    let totals = run.totals();
    assert!(totals.moving > 0 && totals.moving_volume > 0.0, "{totals:?}");
    assert!(totals.moving_volume < 0.05 * totals.volume, "{totals:?}");
    // What is written moves no look.
    let (other, reason) = run_of(0.01, 0.7);
    assert_eq!(reason, StopReason::Trickle);
    assert!(bits(&*run) == bits(&*other));
    // The deposit is that of the run to rest, but for what still moved.
    let (rest, reason) = run_of(0.0, 1000.0);
    assert_eq!(reason, StopReason::AtRest);
    assert!(rest.time() > end, "{} {end}", rest.time());
    let thickness = |run: &dyn Run| run.field("thickness").unwrap().iter().collect::<Vec<_>>();
    let (a, b) = (thickness(&*run), thickness(&*rest));
    let shifted: f64 = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).sum(); // half of it times dx = 2
    assert!(shifted <= totals.moving_volume, "{shifted} of {}", totals.moving_volume);
}

#[test]
fn a_run_taken_up_again_ends_by_the_same_trickle() {
    let ends = Case::parse(TRICKLE, "test.toml").unwrap().check().unwrap().plan().ends;
    let mut whole = start(TRICKLE);
    assert_eq!(drive(&mut *whole, &ends, &mut []).unwrap(), StopReason::Trickle);
    let mut first = start(TRICKLE);
    let half =
        Ends { time: None, steps: Some(whole.steps() * 3 / 4), until: ends.until, kinetic_energy: None };
    assert_eq!(drive(&mut *first, &half, &mut []).unwrap(), StopReason::Steps);
    let saved = first.save().into_owned();
    let mut second = start(TRICKLE);
    second.restore(saved).unwrap();
    assert_eq!(drive(&mut *second, &ends, &mut []).unwrap(), StopReason::Trickle);
    assert_eq!((second.steps(), second.record().flowed), (whole.steps(), whole.record().flowed));
    assert!(bits(&*whole) == bits(&*second));
}
