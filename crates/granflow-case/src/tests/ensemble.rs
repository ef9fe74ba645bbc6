//! `[ensemble]`: what it takes, what it refuses, and what its members change.

use super::{SILO, checked};
use crate::ensemble::Drawn;
use crate::{Case, CaseError, Ensemble};
use std::sync::Arc;

fn silo(ensemble: &str) -> Case {
    Case::parse(&format!("{SILO}\n[ensemble]\n{ensemble}\n"), "silo.toml").unwrap()
}

fn ensemble(text: &str) -> Arc<Ensemble> {
    checked(&silo(text)).run.ensemble.unwrap()
}

fn refused(text: &str) -> String {
    let case = Case::parse(&format!("{SILO}\n[ensemble]\n{text}\n"), "silo.toml");
    let error: CaseError = case.and_then(|case| case.check(&super::Disk)).unwrap_err();
    assert!(error.key().starts_with("ensemble"), "{error}");
    assert!(!error.help_lines().is_empty() || error.message().contains("expected"), "{error}");
    error.to_string()
}

const ANGLE: &str = "vary.\"material.friction.coulomb.angle\"";

#[test]
fn a_member_is_a_pure_function_of_case_and_number() {
    for sampling in ["sobol", "latin_hypercube", "random"] {
        let text = format!(
            "members = 40\nseed = 7\nsampling = \"{sampling}\"\n{ANGLE} = {{ uniform = [15, 25], unit = \"deg\" }}\n\
             vary.\"material.epsilon\" = {{ normal = {{ mean = 0.4, sd = 0.1, min = 0.2 }} }}"
        );
        let (one, two) = (ensemble(&text), ensemble(&text));
        for number in (0..40).rev() {
            assert_eq!(one.sample(number), two.sample(number));
        }
        let other = ensemble(&text.replace("seed = 7", "seed = 8"));
        assert_ne!(one.sample(3), other.sample(3));
        let names: Vec<_> = one.columns().into_iter().map(|column| column.name).collect();
        assert_eq!(names, ["material.epsilon", "material.friction.coulomb.angle"]);
    }
}

#[test]
fn what_a_member_changes_is_what_its_case_has() {
    let text = format!(
        "members = 16\n{ANGLE} = {{ factor = {{ uniform = [0.8, 1.2] }} }}\n\
         vary.\"scheme\" = {{ choice = [{{ name = \"balanced\" }}, {{ name = \"energy_stable\", film = 1e-6 }}] }}"
    );
    let (case, ensemble) = (silo(&text), ensemble(&text));
    for number in 0..16 {
        let member = ensemble.sample(number);
        let run = case.check_with(&member.overrides, &super::Disk).unwrap().run;
        let [Drawn::Number(angle), Drawn::Choice(scheme)] = member.values[..] else { panic!("{member:?}") };
        assert!((0.8 * 18.0..=1.2 * 18.0).contains(&angle), "{angle}");
        assert_eq!(run.scheme, ["balanced", "energy_stable"][scheme]);
        assert!(run.text().contains(&format!("{angle} deg")), "{}", run.text());
        assert!(run.ensemble.is_none());
    }
}

#[test]
fn a_grid_has_the_middles_of_parts_of_equal_probability() {
    let text = format!(
        "sampling = \"grid\"\n{ANGLE} = {{ uniform = [10, 20], unit = \"deg\", levels = 5 }}\n\
         vary.\"material.epsilon\" = {{ choice = [0.4, 0.5] }}"
    );
    let ensemble = ensemble(&text);
    assert_eq!(ensemble.members, 10);
    let angle = |number| ensemble.sample(number).values[1].value();
    assert_eq!([0, 1, 2, 3, 4, 5].map(angle), [11.0, 13.0, 15.0, 17.0, 19.0, 11.0]);
    assert!(refused(&text.replace(", levels = 5", "")).contains("add levels = 5"));
    assert!(refused(&format!("members = 11\n{text}")).contains("has 10 combinations"));
}

#[test]
fn bad_tables_are_refused_with_place_and_cure() {
    let angle = |vary: &str| format!("members = 8\n{ANGLE} = {vary}");
    let mu = "vary.\"material.friction.coulomb.mu\"";
    let table = [
        ("members = 8".to_owned(), "vary"),
        ("members = 8\nvary = {}".to_owned(), "nothing differs"),
        ("members = 8\nvary.material.epsilon = { uniform = [0.1, 0.2] }".to_owned(), "stands in quotes"),
        (angle("{ uniform = [25, 15] }"), "a lower and a larger number"),
        (angle("{ uniform = [0.1, 0.2], choice = [1] }"), "exactly one of uniform"),
        (angle("{}"), "exactly one of uniform"),
        (angle("{ choice = [] }"), "nothing to choose from"),
        (angle("{ normal = { mean = 0.3, sd = 0 } }"), "expected a number > 0"),
        (angle("{ normal = { mean = 0.3, sd = 0.1, min = 0.5, max = 0.4 } }"), "is not below max"),
        (angle("{ normal = { mean = 0.3, sd = 0.001, min = 0.5 } }"), "nothing of the distribution is left"),
        (angle("{ lognormal = { median = -1, sigma = 0.1 } }"), "expected a number > 0"),
        (angle("{ uniform = [0.1, 0.2], levels = 3 }"), "belongs to sampling = \"grid\""),
        (angle("{ uniform = [0.1, 0.2] }\nsampling = \"grid\""), "levels"),
        (angle("{ choice = [0.3], unit = \"deg\" }"), "belongs to uniform"),
        (angle("{ ci95 = \"ci95\" }"), "no thickness by an attribute"),
        // what the case itself refuses is said before any work
        (angle("{ normal = { mean = 0.1, sd = 0.2 } }"), "does not take"),
        (angle("{ uniform = [85, 95], unit = \"deg\" }"), "does not take"),
        (format!("members = 8\n{mu} = {{ uniform = [0.2, 0.3] }}"), "does not take"),
        (
            format!("members = 8\n{mu} = {{ factor = {{ uniform = [0.2, 0.3] }} }}"),
            "the case says nothing there",
        ),
        ("members = 8\nvary.\"no.such.key\" = { uniform = [0.2, 0.3] }".to_owned(), "does not take"),
        ("members = 8\nvary.\"title\" = { choice = [\"a\"] }".to_owned(), "cannot differ"),
        ("members = 8\nvary.\"grid.x.cells\" = { choice = [10] }".to_owned(), "cannot differ"),
        (
            format!(
                "{}\nvary.\"material.friction\" = {{ choice = [{{ coulomb = {{ mu = 1 }} }}] }}",
                angle("{ choice = [0.3] }")
            ),
            "is a part of",
        ),
        (angle("{ choice = [0.3] }").replace('8', "0"), "expected 1 to"),
        (angle("{ choice = [0.3] }").replace('8', "70000"), "latin_hypercube"),
        (angle("{ choice = [0.3] }\nclasses = 7"), "allowed: 4, 8"),
        (angle("{ choice = [0.3] }\npercentiles = [100]"), "from 0.01 to 99.99"),
        (angle("{ choice = [0.3] }\npercentiles = [50, 50.0]"), "stands here twice"),
        (angle("{ choice = [0.3] }\nexceed.peak_pressure = [1]"), "no pressure on a chute"),
        (angle("{ choice = [0.3] }\nexceed.peak_speed = [1, 1]"), "stands here twice"),
        (angle("{ choice = [0.3] }\nexceed.peak_speed = [-1]"), "from 1e-9 to 1e12"),
        (format!("{ANGLE} = {{ choice = [0.3] }}"), "members"),
    ];
    for (text, part) in table {
        let message = refused(&text);
        assert!(message.contains(part), "{text}\n{message}");
    }
}
