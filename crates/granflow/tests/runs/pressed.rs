//! Under active and passive earth pressure a mass comes to rest by itself, as under one coefficient.

use crate::valley::{FIRST, start, valley};

/// The time of rest; a trickle is waited for.
fn rest(material: &str, scheme: &str) -> f64 {
    let folder = valley();
    let parts = format!("{material}{FIRST}[scheme]\nname = \"{scheme}\"\n");
    let mut run = start(folder.path(), &parts, "until = \"rest\"\nend = 600.0\ntrickle = 0.0");
    assert!(run.to_rest(600.0).unwrap(), "{scheme}, {material}: moves after 600 s");
    run.time()
}

/// A forest makes a mass slow long before it stops: friction holds most of it and a part is still driven. Were stresses to make these
/// move alike, friction would take a share of what is left in each step, without end.
#[test]
fn what_is_pressed_comes_to_rest_as_without() {
    for forest in ["", "forest = 0.03\n"] {
        for scheme in ["energy_stable", "energy_stable_2"] {
            let alone = rest(forest, scheme);
            for internal in [30, 35, 45] {
                let pressed =
                    format!("{forest}earth_pressure.active_passive = {{ internal = \"{internal} deg\" }}\n");
                let time = rest(&pressed, scheme);
                assert!(time < 2.0 * alone, "{scheme}, {pressed}: {time} s, {alone} s without");
            }
        }
    }
}
