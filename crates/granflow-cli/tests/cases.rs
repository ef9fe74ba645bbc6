//! The program as a user meets it: exit statuses, and messages that name the place and the cure.

mod support;

use std::path::Path;
use support::{granflow, said, told};

/// A case in good order; `{...}` lines are replaced by each test.
const GOOD: &str = r#"title = "test"
model = "savage_hutter"
[grid]
x = { from = -6.0, to = 6.0, cells = 240 }
boundary = "open"
[material]
epsilon = 0.4
slope = "0 deg"
friction.coulomb = { angle = "18 deg" }
[initial]
thickness.steps = { at = [-1.0, 1.0], values = [0.3, 2.3, 0.3] }
[scheme]
name = "balanced"
step = 0.001
[time]
steps = 100
"#;

const MOUNTAIN: &str = r#"title = "test"
[terrain]
dem = "dem.asc"
[material]
density = 200.0
friction.coulomb = { mu = 0.4 }
[[release]]
polygons = "release.geojson"
thickness = 1.0
[time]
until = "rest"
end = 300.0
"#;

/// What was changed, the line the message must name (0: none), fragments of the message, the exit status.
type Bad = (&'static str, &'static str, usize, &'static [&'static str], i32);

const ON_A_GRID: &[Bad] = &[
    // not TOML
    ("[grid]", "[grid", 3, &["not TOML"], 2),
    ("steps = 100", "steps = ", 16, &["not TOML"], 2),
    ("steps = 100", "steps = 100\nsteps = 200", 17, &["duplicate key"], 2),
    // unknown keys and choices
    (
        "epsilon = 0.4",
        "epsilom = 0.4",
        7,
        &["unknown key `epsilom` in material", "did you mean `epsilon`?", "allowed:"],
        2,
    ),
    ("[scheme]", "[schema]", 12, &["unknown key `schema` in the case", "did you mean `scheme`?"], 2),
    ("cells = 240", "cell = 240", 4, &["`grid.x.cell`", "did you mean `cells`?"], 2),
    (
        "\"balanced\"",
        "\"balancd\"",
        13,
        &["`scheme.name`", "found `balancd`", "did you mean `balanced`?", "verfahren_5"],
        2,
    ),
    ("\"balanced\"", "\"scheme_4\"", 13, &["did you mean"], 2),
    ("friction.coulomb", "friction.coulom", 9, &["found `coulom`", "did you mean `coulomb`?", "voellmy"], 2),
    ("{ angle =", "{ angel =", 9, &["unknown key `angel`", "did you mean `angle`?"], 2),
    (
        "epsilon = 0.4",
        "epsilon = 0.4\nearth_pressure.active_passive = { internl = \"35 deg\" }",
        8,
        &["unknown key `internl` in material.earth_pressure.active_passive", "did you mean `internal`?"],
        2,
    ),
    ("thickness.steps", "thickness.step", 11, &["found `step`", "did you mean `steps`?", "parabola"], 2),
    ("\"open\"", "\"opn\"", 5, &["grid.boundary", "did you mean `open`?"], 2),
    (
        "\"savage_hutter\"",
        "\"hadeler_kuttler\"",
        6,
        &["`material` has no meaning for hadeler_kuttler", "remove it"],
        2,
    ),
    ("\"savage_hutter\"", "\"sandpile\"", 2, &["allowed: savage_hutter, hadeler_kuttler"], 2),
    ("[time]", "[table]\nopen = \"all\"\n[time]", 15, &["`table` belongs to the model hadeler_kuttler"], 2),
    ("\"savage_hutter\"", "\"savage_huter\"", 2, &["did you mean `savage_hutter`?"], 2),
    // missing keys
    (
        "friction.coulomb = { angle = \"18 deg\" }",
        "",
        6,
        &["`material.friction`", "missing", "friction.coulomb = {"],
        2,
    ),
    ("from = -6.0, ", "", 4, &["`grid.x.from`", "missing"], 2),
    ("[time]\nsteps = 100", "", 0, &["`time`", "missing", "add a table [time]"], 2),
    ("[time]\nsteps = 100", "[time]", 15, &["nothing ends the run", "until = \"rest\""], 2),
    (
        "[initial]\nthickness.steps = { at = [-1.0, 1.0], values = [0.3, 2.3, 0.3] }",
        "",
        0,
        &["needs an [initial]"],
        2,
    ),
    // wrong types
    (
        "epsilon = 0.4",
        "epsilon = \"0.4\"",
        7,
        &["`material.epsilon`", "found the text \"0.4\"", "expected a number"],
        2,
    ),
    ("cells = 240", "cells = 2.5", 4, &["`grid.x.cells`", "expected a whole number"], 2),
    ("cells = 240", "cells = -3", 4, &["`grid.x.cells`", "expected a whole number"], 2),
    ("at = [-1.0, 1.0]", "at = 1.0", 11, &["expected a list"], 2),
    ("\"18 deg\"", "\"18 degree\"", 9, &["`18 degree` is not an angle", "\"18 deg\", \"0.3 rad\""], 2),
    (
        "thickness.steps = { at = [-1.0, 1.0], values = [0.3, 2.3, 0.3] }",
        "thickness = \"1 - x\"",
        11,
        &[".formula = \"1 - x\""],
        2,
    ),
    // two choices at once
    ("friction.coulomb =", "friction.samosat = {}\nfriction.coulomb =", 9, &["exactly one choice"], 2),
    ("thickness.steps =", "thickness.formula = \"1\"\nthickness.steps =", 11, &["exactly one choice"], 2),
    ("step = 0.001", "step = 0.001\ncourant = 0.5", 15, &["both `step` and `courant`"], 2),
    ("{ angle = \"18 deg\" }", "{ angle = \"18 deg\", mu = 0.3 }", 9, &["both `angle` and `mu`"], 2),
    ("{ angle = \"18 deg\" }", "{}", 9, &["neither `angle` nor `mu`"], 2),
    ("[time]", "[terrain]\ndem = \"dem.asc\"\n[time]", 15, &["both [grid] and [terrain]"], 2),
    ("[time]", "[[release]]\n[time]", 15, &["[[release]] needs [terrain]"], 2),
    // ranges
    (
        "steps = 100",
        "steps = 100\n[output]\nthreshold = -0.01",
        18,
        &["`output.threshold`: found -0.01, expected a number >= 0"],
        2,
    ),
    ("steps = 100", "steps = 100\n[output]\nthreshold = \"1 cm\"", 18, &["expected a number"], 2),
    ("epsilon = 0.4", "epsilon = 0", 7, &["`material.epsilon`: found 0, expected a number > 0"], 2),
    ("epsilon = 0.4", "epsilon = nan", 7, &["found NaN"], 2),
    ("cells = 240", "cells = 2", 4, &["at least 3"], 2),
    ("cells = 240", "cells = 9000000000000000000", 4, &["grid.x"], 2),
    ("from = -6.0", "from = 6.0", 4, &["from = 6 is not below to = 6"], 2),
    ("angle = \"18 deg\"", "angle = 18", 9, &["found 18", "below 90 deg", "write \"18 deg\" for degrees"], 2),
    ("angle = \"18 deg\"", "angle = \"90 deg\"", 9, &["below 90 deg"], 2),
    ("angle = \"18 deg\"", "mu = -0.1", 9, &["`material.friction.coulomb.mu`: found -0.1"], 2),
    ("slope = \"0 deg\"", "slope = \"95 deg\"", 8, &["between -90 deg and 90 deg"], 2),
    ("step = 0.001", "courant = 1.5", 14, &["<= 1 for balanced"], 2),
    ("\"balanced\"\nstep = 0.001", "\"balanced_2\"\ncourant = 0.9", 14, &["<= 0.5 for balanced_2"], 2),
    ("step = 0.001", "step = -1", 14, &["expected a number > 0"], 2),
    ("step = 0.001", "film = -1e-6", 14, &["expected a number >= 0"], 2),
    ("steps = 100", "steps = 0", 16, &["found 0"], 2),
    ("steps = 100", "stop.kinetic_energy = 2.0", 16, &["between 0 and 1"], 2),
    ("[0.3, 2.3, 0.3]", "[0.3, -2.3, 0.3]", 11, &["the thickness is -2.3 at x = -0.975"], 2),
    ("[0.3, 2.3, 0.3]", "[0.3, 2.3]", 11, &["2 values for 2 jumps, expected 3"], 2),
    ("[-1.0, 1.0]", "[1.0, -1.0]", 11, &["the jumps must grow"], 2),
    // boundaries
    ("\"open\"", "{ x = [\"periodic\", \"open\"] }", 5, &["one end is periodic"], 2),
    ("\"open\"", "{ y = \"wall\" }", 5, &["the grid has no y"], 2),
    ("\"open\"", "{ x = [\"wall\"] }", 5, &["pair"], 2),
    // formulas, with the column
    (
        "thickness.steps = { at = [-1.0, 1.0], values = [0.3, 2.3, 0.3] }",
        "thickness.formula = \"max(1 - z, 0)\"",
        11,
        &[":11:30: ", "unknown name `z`"],
        2,
    ),
    (
        "thickness.steps = { at = [-1.0, 1.0], values = [0.3, 2.3, 0.3] }",
        "thickness.formula = \"1/(x-0.025)\"",
        11,
        &["the value is inf at x = 0.025"],
        2,
    ),
    // profiles
    (
        "slope = \"0 deg\"",
        "slope = { x = [0, 1, 1], angle = [0.1, 0.2, 0.3] }",
        8,
        &["the places must grow"],
        2,
    ),
    ("slope = \"0 deg\"", "slope = { x = [0, 1], angle = [\"5 deg\"] }", 8, &["1 angles for 2 places"], 2),
    (
        "slope = \"0 deg\"",
        "slope = { x = [0, 1], angle = [\"5 deg\", 30] }",
        8,
        &["material.slope.angle[1]", "radians"],
        2,
    ),
    ("slope = \"0 deg\"", "slope = { formula = \"2*x\" }", 8, &["at x = -5.975"], 2),
    ("slope = \"0 deg\"", "slope = { formula = \"sin(y)\" }", 8, &[":8:26: ", "unknown name `y`"], 2),
    // what the published schemes cannot do
    ("steps = 100", "until = \"rest\"\n[output]\nfiles = [\"geotiff\"]", 18, &["needs [terrain]"], 2),
    ("steps = 100", "rest_speed = 1e-3\nend = 1.0", 16, &["without until"], 2),
    (
        "steps = 100",
        "until = \"steady\"",
        16,
        &["savage_hutter has no end \"steady\"", "until = \"rest\""],
        2,
    ),
    (
        "steps = 100",
        "end = 1.0\n[output]\nevery = 1e-9",
        18,
        &["`output.every`", "1000000001 frames", "more than 100000", "every = 0.001"],
        2,
    ),
    (
        "steps = 100",
        "steps = 1000000\n[output]\nsteps = 1",
        18,
        &["`output.steps`", "1000001 frames", "steps = 1000"],
        2,
    ),
    ("steps = 100", "steps = 100\n[output]\nevery = 1.0\nsteps = 10", 19, &["both `every` and `steps`"], 2),
    ("steps = 100", "steps = 100\n[output]\nfiles = [\"netcdf\", \"vkt\"]", 18, &["did you mean `vtk`?"], 2),
    // files
    (
        "thickness.steps = { at = [-1.0, 1.0], values = [0.3, 2.3, 0.3] }",
        "thickness.file = \"thicknes.npy\"",
        11,
        &["cannot read", "did you mean `thickness.npy`?"],
        4,
    ),
    (
        "thickness.steps = { at = [-1.0, 1.0], values = [0.3, 2.3, 0.3] }",
        "thickness.file = \"thickness.npy\"",
        11,
        &["cannot use thickness.npy"],
        4,
    ),
];

const ON_TERRAIN: &[Bad] = &[
    (
        "dem = \"dem.asc\"",
        "dem = \"dme.asc\"",
        3,
        &["`terrain.dem`", "cannot read", "did you mean `dem.asc`?"],
        4,
    ),
    ("release.geojson", "nowhere/release.shp", 8, &["the folder nowhere does not exist"], 4),
    ("thickness = 1.0", "", 7, &["`release[0].thickness`", "missing", "attribute"], 2),
    ("thickness = 1.0", "thickness = -1.0", 9, &["`release[0].thickness`: found -1"], 2),
    ("thickness = 1.0", "thickness = { attribut = \"d\" }", 9, &["did you mean `attribute`?"], 2),
    ("thickness = 1.0", "result = \"dem.asc\"", 7, &["exactly one of polygons, raster, cap, result"], 2),
    ("thickness = 1.0", "raster = \"dem.asc\"", 7, &["exactly one of polygons, raster, cap, result"], 2),
    (
        "polygons = \"release.geojson\"",
        "cap = { height = 1.0, centre = [0.0, 0.0], radius = 5.0 }",
        9,
        &["`thickness` belongs to polygons"],
        2,
    ),
    ("density = 200.0", "", 4, &["`material.density`", "missing", "density = 200.0"], 2),
    ("density = 200.0", "density = 200.0\nepsilon = 0.1", 6, &["no meaning on terrain"], 2),
    (
        "dem = \"dem.asc\"",
        "dem = \"dem.asc\"\ncurvature = \"none\"",
        4,
        &["{ length = \"20 m\" } or \"off\""],
        2,
    ),
    (
        "dem = \"dem.asc\"",
        "dem = \"dem.asc\"\ncurvature.length = \"20 feet\"",
        4,
        &["`20 feet` is not a length"],
        2,
    ),
    ("dem = \"dem.asc\"", "dem = \"dem.asc\"\ncell = 0", 4, &["expected a number > 0"], 2),
    ("[time]", "[scheme]\nname = \"verfahren_1\"\n[time]", 11, &["works on a [grid] only"], 2),
    ("[time]", "[initial]\nthickness = 1.0\n[time]", 10, &["[initial] needs [grid]"], 2),
];

#[test]
fn bad_cases_are_answered_with_place_and_cure() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["dem.asc", "release.geojson", "thickness.npy"] {
        std::fs::write(folder.path().join(name), "").expect("a file");
    }
    let mut wrong = Vec::new();
    let tables = ON_A_GRID.iter().map(|bad| (GOOD, bad)).chain(ON_TERRAIN.iter().map(|bad| (MOUNTAIN, bad)));
    for (good, (from, to, line, fragments, status)) in tables {
        assert!(good.contains(from), "the table replaces what is there: {from}");
        std::fs::write(folder.path().join("case.toml"), good.replacen(from, to, 1)).expect("a case");
        let output = granflow(folder.path(), &["check", "case.toml"]);
        let message = told(&output);
        let place = if *line == 0 { "case.toml: ".to_owned() } else { format!("case.toml:{line}:") };
        let found = output.status.code() == Some(*status)
            && message.contains(&place)
            && fragments.iter().all(|fragment| message.contains(fragment));
        if !found {
            wrong.push(format!(
                "{to}\n  expected {status}, {place} {fragments:?}, got {:?}:\n{message}",
                output.status.code()
            ));
        }
    }
    assert!(wrong.is_empty(), "{} of the answers are wrong:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn what_the_published_schemes_cannot_do() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("case.toml"), GOOD).expect("a case");
    let check = |extra: &[&str]| {
        let mut arguments = vec!["check", "case.toml", "--set", "scheme.name=verfahren_5"];
        extra.iter().for_each(|change| arguments.extend(["--set", change]));
        let output = granflow(folder.path(), &arguments);
        (output.status.code(), told(&output))
    };
    assert_eq!(check(&[]).0, Some(0));
    let refused = |extra: &[&str], fragment: &str| {
        let (status, message) = check(extra);
        assert!(status == Some(2) && message.contains(fragment), "{extra:?}: {message}");
    };
    refused(&["time.until=rest"], "add rest_speed = 1e-12");
    refused(&["material.friction={voellmy={mu=0.1, xi=1000}}"], "knows Coulomb friction only");
    refused(&["material.slope={formula=\"0.1*x\"}"], "works on a constant slope only");
    assert_eq!(check(&["time.until=rest", "time.rest_speed=1e-12"]).0, Some(0));
}

#[test]
fn overrides_are_laid_over_the_case_and_blamed_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("case.toml"), GOOD).expect("a case");
    let set = |change: &str| {
        let output = granflow(folder.path(), &["check", "case.toml", "--set", change]);
        (output.status.code(), said(&output), told(&output))
    };
    assert!(set("grid.x.cells=400").1.contains("400 cells"));
    assert!(set("material.slope=5 deg").1.contains("5.0000 deg"), "a word needs no quotes");
    assert!(set("material.friction={coulomb={mu=0.5}}").1.contains("mu = 0.5"));
    for (change, fragments) in [
        ("schem.name=balanced", &["--set schem.name=balanced", "did you mean `scheme`?"] as &[&str]),
        ("scheme.nam=balanced", &["--set scheme.nam=balanced", "`scheme.nam`", "did you mean `name`?"]),
        ("scheme.name=balancd", &["--set scheme.name=balancd", "did you mean `balanced`?"]),
        ("grid.x.cells=1", &["--set grid.x.cells=1", "at least 3"]),
        ("scheme.name", &["there is no `=`", "write --set key.path=value"]),
        ("scheme.name=", &["no value after `=`"]),
        ("=1", &["is not a key"]),
        ("initial.thickness.steps.at.7.x=1", &["is a list with 2 entries"]),
    ] {
        let (status, _, message) = set(change);
        assert!(
            status == Some(2) && fragments.iter().all(|part| message.contains(part)),
            "{change}: {message}"
        );
    }
}

#[test]
fn what_may_surprise_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("case.toml"), GOOD).expect("a case");
    let said = |change: &[&str]| {
        let arguments = [&["check", "case.toml"], change].concat();
        said(&granflow(folder.path(), &arguments))
    };
    let film = said(&["--set", "scheme.name=verfahren_5", "--set", "scheme.film=1e-6"]);
    assert!(film.contains("scheme.film has no effect") && film.contains("film 0e0"), "{film}");
    assert!(said(&["--set", "time={until=\"rest\"}"]).contains("no time limit"));
    assert!(!said(&[]).contains("note "));
}

#[test]
fn a_mistyped_file_is_answered_with_the_nearest_name() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("silo.toml"), GOOD).expect("a case");
    let output = granflow(folder.path(), &["run", "silo.tml"]);
    assert_eq!(output.status.code(), Some(4));
    assert!(told(&output).contains("silo.tml: cannot read the case file"), "{}", told(&output));
    assert!(told(&output).contains("did you mean `silo.toml`?"), "{}", told(&output));
    std::fs::write(folder.path().join("picture.toml"), [0xff, 0xfe, 0x00]).expect("a file");
    assert_eq!(granflow(folder.path(), &["check", "picture.toml"]).status.code(), Some(4));
    assert_eq!(granflow(folder.path(), &["run"]).status.code(), Some(2));
    assert_eq!(granflow(folder.path(), &["walk", "silo.toml"]).status.code(), Some(2));
    assert_eq!(granflow(folder.path(), &["run", "silo.toml", "--threads", "0"]).status.code(), Some(2));
}

#[test]
fn every_kind_is_written_once_and_is_in_order() {
    let folder = tempfile::tempdir().expect("a folder");
    let list = granflow(folder.path(), &["new", "--list"]);
    let list = said(&list);
    let kinds: Vec<&str> = list.lines().filter_map(|line| line.split_whitespace().next()).collect();
    let avalanches = ["silo", "inclined_silo", "parabola", "riemann", "sine", "plane"];
    let sandpiles = [
        "sandpile",
        "sandpile_1d",
        "sandpile_source",
        "sandpile_walls",
        "sandpile_disc",
        "sandpile_l",
        "silo_hole",
    ];
    let poured = ["sandpile_switched", "sandpile_moving"];
    let mountains = ["avalanche", "snow_avalanche", "debris_flow", "rock_avalanche"];
    assert_eq!(kinds, [&avalanches[..], &sandpiles[..], &poured[..], &mountains[..]].concat());
    for kind in kinds {
        let file = format!("{kind}.toml");
        assert_eq!(granflow(folder.path(), &["new", kind]).status.code(), Some(0), "{kind}");
        let output = granflow(folder.path(), &["check", &file]);
        assert_eq!(output.status.code(), Some(0), "{kind}: {}", told(&output));
        let text = std::fs::read_to_string(folder.path().join(&file)).expect("the case");
        assert!(text.contains("# Source") && text.contains("# Must come out"), "{kind} has its citation");
        let again = granflow(folder.path(), &["new", kind]);
        assert_eq!(again.status.code(), Some(4), "{kind} is not overwritten");
        assert!(told(&again).contains("is not overwritten"));
    }
    let wrong = granflow(folder.path(), &["new", "avalance"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(told(&wrong).contains("did you mean `avalanche`?"));
}

#[test]
fn the_estimates_are_right() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("case.toml"), GOOD).expect("a case");
    let output = granflow(folder.path(), &["check", "case.toml", "--set", "time={end=5.0}"]);
    let said = said(&output);
    assert!(said.contains("5000 of 1.000e-3 in time"), "{said}");
    // 40 cells of 2.3 and 200 of 0.3, 0.05 wide
    assert!(said.contains("mass 7.600000, 240 wet cells"), "{said}");
    // sqrt(2 * 0.4 * 2.3) * 0.001/0.05
    assert!(said.contains("0.0271 at the start"), "{said}");
}

#[test]
fn a_sandpile_is_described() {
    let folder = tempfile::tempdir().expect("a folder");
    assert_eq!(granflow(folder.path(), &["new", "sandpile_l", "l.toml"]).status.code(), Some(0));
    let output = granflow(folder.path(), &["check", "l.toml"]);
    let text = said(&output);
    // three quarters of the square, 40 edges along each direction of which the wall takes 20
    assert!(text.contains("1200 cells, 0.750000 in all"), "{text}");
    assert!(text.contains("open: 40 left, 40 right, 40 bottom, 20 top; walls: 20 top"), "{text}");
    assert!(text.contains("0.375000 a time at the start"), "{text}");
    // 0.225 * 0.025/2
    assert!(text.contains("of 2.812e-3 in time") && text.contains("changes below 1e-8"), "{text}");
    let direct = ["check", "l.toml", "--set", "time={until=\"steady\",method=\"direct\"}"];
    let text = said(&granflow(folder.path(), &direct));
    assert!(text.contains("at the equilibrium, computed directly"), "{text}");
    // what is printed is a case again
    let resolved = text.split_once(":\n\n").expect("the resolved case").1;
    std::fs::write(folder.path().join("again.toml"), resolved).expect("a case");
    let again = granflow(folder.path(), &["check", "again.toml"]);
    assert_eq!(again.status.code(), Some(0), "{}", told(&again));
}

#[test]
fn the_schema_names_every_key() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = granflow(folder.path(), &["schema"]);
    let schema: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let mut known = std::collections::BTreeSet::new();
    collect(&schema, &mut known);
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases");
    let mut seen = 0;
    for entry in std::fs::read_dir(root).expect("cases/") {
        let text = std::fs::read_to_string(entry.expect("an entry").path()).expect("a case");
        let case: toml::Table = text.parse().expect("TOML");
        seen += 1;
        keys(&toml::Value::Table(case), &mut |key| {
            assert!(known.contains(key), "the schema does not know {key}")
        });
    }
    assert!(seen >= 17);
    for key in [
        "velocity_y",
        "rest_speed",
        "samosat",
        "xi",
        "cell",
        "measured",
        "attribute",
        "precision",
        "kinetic_energy",
        "standing_layer",
        "theta_exponent",
        "steady_rate",
        "method",
        "height",
        "wall",
        "disc",
    ] {
        assert!(known.contains(key), "the schema does not know {key}");
    }
}

fn collect(schema: &serde_json::Value, known: &mut std::collections::BTreeSet<String>) {
    if let Some(properties) = schema.get("properties").and_then(serde_json::Value::as_object) {
        known.extend(properties.keys().cloned());
    }
    match schema {
        serde_json::Value::Object(map) => map.values().for_each(|inner| collect(inner, known)),
        serde_json::Value::Array(list) => list.iter().for_each(|inner| collect(inner, known)),
        _ => {}
    }
}

fn keys(value: &toml::Value, see: &mut impl FnMut(&str)) {
    match value {
        toml::Value::Table(table) => table.iter().for_each(|(key, inner)| {
            see(key);
            keys(inner, see);
        }),
        toml::Value::Array(list) => list.iter().for_each(|inner| keys(inner, see)),
        _ => {}
    }
}
