//! Cases of hadeler_kuttler: what they evaluate to, and what is refused with which cure.

use super::{Disk, checked, named};
use crate::sandpile::{Edge, Pile, Plan, Poured, SchemeName, Sources, TablePlan};
use crate::*;
use std::path::Path;

const PILE: &str = r#"
title = "pile"
model = "hadeler_kuttler"
[grid]
x = { from = 0.0, to = 1.0, cells = 10 }
y = { from = 0.0, to = 1.0, cells = 10 }
[time]
until = "steady"
[[source]]
rate = 0.5
"#;

fn with(changes: &[&str]) -> Result<Case, CaseError> {
    let overrides: Vec<String> = changes.iter().map(|change| (*change).to_owned()).collect();
    Case::parse_with(PILE, "pile.toml", &overrides)
}

fn evaluated(changes: &[&str]) -> (RunPlan, Plan) {
    let Checked { run, kind } =
        checked(&with(changes).unwrap_or_else(|error| panic!("{changes:?}: {error}")));
    let Kind::Sandpile(plan) = kind else { panic!("{changes:?}") };
    (run, plan)
}

fn plan_on_line(changes: &[&str]) -> TablePlan<1> {
    let Poured::Line(pile) = evaluated(changes).1.table else { panic!("{changes:?} has two dimensions") };
    pile.table
}

fn pile(changes: &[&str]) -> Pile<2> {
    let Poured::Plane(pile) = evaluated(changes).1.table else { panic!("{changes:?} has one dimension") };
    *pile
}

fn plan(changes: &[&str]) -> TablePlan<2> {
    pile(changes).table
}

/// Numbers of its open edges: left, right, bottom, top, hole.
fn open<const D: usize>(plan: &TablePlan<D>) -> [usize; 5] {
    let edges: Vec<Edge> = plan.table.open_edges().iter().map(Edge::of).collect();
    [Edge::Left, Edge::Right, Edge::Bottom, Edge::Top, Edge::Hole]
        .map(|kind| edges.iter().filter(|edge| **edge == kind).count())
}

fn poured(changes: &[&str]) -> Sources {
    pile(changes).sources
}

fn inside(plan: &TablePlan<2>) -> Vec<bool> {
    (0..plan.rolling.len()).map(|cell| plan.inside(cell)).collect()
}

const LINE: &str = "grid={x={from=0,to=1,cells=10}}";
const RING: &str = "table={cut=[{box=[0.4,0.6,0.4,0.6]}]}";

#[test]
fn the_rim_of_a_round_table_stands_at_its_true_edge() {
    let round = plan(&[
        "table={mask={disc={centre=[0.5,0.5],radius=0.48}},cut=[{disc={centre=[0.5,0.5],radius=0.2}}]}",
    ]);
    let mut rims = [0; 2];
    for (node, height) in round.height.iter().enumerate() {
        let [x, y] = round.nodes.at(node);
        let r = (x - 0.5).hypot(y - 0.5);
        let depth = (0.48 - r).min(r - 0.2);
        let expected = if round.table.pinned(node) { depth } else { 0.0 };
        assert!((height - expected).abs() < 1e-15, "{height} at r = {r}");
        rims[usize::from(r > 0.3)] += usize::from(round.table.pinned(node));
    }
    assert!(rims[0] > 8 && rims[1] > 30, "{rims:?}");
    assert!(plan(&[RING]).height.iter().all(|height| *height == 0.0), "edges along the grid need none");
    assert!(plan(&[]).height.iter().all(|height| *height == 0.0));
}

#[test]
fn the_defaults() {
    let (run, Plan { scheme, theta_exponent, table, .. }) = evaluated(&[]);
    assert_eq!((run.scheme, run.stepping), ("adaptive", Stepping::Courant(0.225)));
    assert_eq!((scheme, theta_exponent), (SchemeName::Adaptive, 2.0));
    assert_eq!(run.ends.until, Some(Until::Steady { rate: 1e-8 }));
    assert_eq!(named(&run.output.files), ["netcdf", "figures"]);
    let (first, _) = evaluated(&["scheme.name=first_order"]);
    assert_eq!((first.stepping, first.max_courant), (Stepping::Courant(0.45), 1.0));
    let Poured::Plane(pile) = table else { panic!("it has y") };
    let Pile { table: plan, sources } = *pile;
    assert_eq!((plan.table.pieces().len(), plan.table.count(), plan.height.len()), (1, 100, 121));
    assert_eq!((plan.table.edges().count(), open(&plan)), (40, [10, 10, 10, 10, 0]));
    assert_eq!(sources.rate(0.0), [0.5; 100]);
    let direct = evaluated(&["time.method=direct"]).0;
    assert_eq!(direct.ends.until, Some(Until::Equilibrium));
}

#[test]
fn sides_holes_and_walls() {
    let count = |changes: &[&str]| open(&plan(changes));
    assert_eq!(count(&["table.open=all"]), [10, 10, 10, 10, 0]);
    assert_eq!(count(&["table.open=[\"left\", \"top\"]"]), [10, 0, 0, 10, 0]);
    assert_eq!(count(&[RING]), [10, 10, 10, 10, 8]);
    assert_eq!(count(&[RING, "table.open=[\"hole\"]"]), [0, 0, 0, 0, 8]);
    assert_eq!(count(&[RING, "table.open=[\"right\"]"]), [0, 10, 0, 0, 0], "an island wall");
    assert_eq!(count(&["table.wall=[{on.box=[0,0,0.5,1]}]"]), [5, 10, 10, 10, 0]);
    let disc = "table.wall=[{on.disc={centre=[0.5,1],radius=0.2}}]";
    assert_eq!(count(&[disc]), [10, 10, 10, 6, 0], "of the midpoints 0.35, 0.45, 0.55, 0.65");
    assert_eq!(
        count(&["table.mask={box=[0.2,0.7,0,1]}"]),
        [10, 10, 5, 5, 0],
        "edges inside the grid face outwards"
    );
    let line = plan_on_line(&[LINE, "table.open=[\"left\"]"]);
    assert_eq!((open(&line), line.table.edges().count()), ([1, 0, 0, 0, 0], 2));
    let gap = plan_on_line(&[LINE, "table={cut=[{box=[0.4,0.6]}]}"]);
    assert_eq!((open(&gap), gap.table.pieces().len()), ([1, 1, 0, 0, 2], 2));
    let notch = plan(&["table={cut=[{box=[0.4,0.6,0,0.6]}]}"]);
    assert_eq!(open(&notch)[4], 0, "what opens to the rim is no hole");
}

#[test]
fn cells_on_which_no_sand_can_stand_are_off_the_table() {
    let tongue = "table={mask={box=[0,0.5]},cut=[{box=[0.3,0.5,0,0.8]},{box=[0.3,0.5,0.9,1]}]}";
    let plan = plan(&[tongue]);
    assert_eq!((plan.table.count(), plan.table.dropped()), (30, 2));
    assert_eq!(plan.rolling.len(), 100, "the cells are numbered as those of the grid");
    let notes = evaluated(&[tongue]).0.notes.join("\n");
    assert!(notes.contains("2 cells are taken off the table"), "{notes}");
    let bar = with(&["table={mask={box=[0,1,0.4,0.5]}}"]).unwrap().check(&Disk).unwrap_err();
    assert!(bar.to_string().contains("one cell wide") && bar.key() == "grid", "{bar}");
}

#[test]
fn a_disc_has_the_symmetries_of_the_square() {
    let disc = plan(&["table.mask={disc={centre=[0.5,0.5],radius=0.4}}"]);
    for j in 0..10 {
        for i in 0..10 {
            let at = |i: usize, j: usize| disc.inside(10 * j + i);
            assert!(at(i, j) == at(9 - i, j) && at(i, j) == at(j, i), "{i} {j}");
        }
    }
    assert_eq!(disc.table.count(), 52);
    assert_eq!(
        disc.table.edges().count(),
        32,
        "the rim of squares of a disc is as long as that of the square around it"
    );
}

#[test]
fn a_table_from_a_file() {
    let folder = tempfile::tempdir().unwrap();
    for file in ["table.geojson", "line.geojson"] {
        std::fs::write(folder.path().join(file), "").unwrap();
    }
    let name = folder.path().join("pile.toml").display().to_string();
    let check = |file: &str| {
        let overrides = [format!("table.mask.file={file}"), "table.open=[\"hole\"]".to_owned()];
        Case::parse_with(PILE, &name, &overrides).unwrap().check(&Drawn)
    };
    let Kind::Sandpile(Plan { table: Poured::Plane(pile), .. }) = check("table.geojson").unwrap().kind else {
        panic!("it is a pile on a plane")
    };
    assert_eq!(inside(&pile.table), inside(&plan(&[RING])));
    let error = check("tabel.geojson").unwrap_err();
    assert_eq!(error.kind(), CaseErrorKind::File);
    assert!(error.to_string().contains("did you mean") && error.key() == "table.mask.file", "{error}");
    let error = check("line.geojson").unwrap_err();
    assert_eq!((error.kind(), error.key()), (CaseErrorKind::File, "table.mask.file"));
    assert!(error.to_string().contains("holds no polygon"), "{error}");
}

/// A reader that knows one drawing, in `table.geojson`.
struct Drawn;

impl FileAccess for Drawn {
    fn outlines(&self, path: &Path) -> Result<Box<dyn Outline>, String> {
        match path.ends_with("table.geojson") {
            true => Ok(Box::new(Ring)),
            false => Err(format!("{} holds no polygon", path.display())),
        }
    }
}

/// The unit square with a square hole.
#[derive(Debug)]
struct Ring;

impl Outline for Ring {
    fn holds(&self, place: [f64; 2]) -> bool {
        self.depth(place) >= 0.0
    }
    fn depth(&self, [x, y]: [f64; 2]) -> f64 {
        let from_centre = (x - 0.5).abs().max((y - 0.5).abs());
        (0.5 - from_centre).min(from_centre - 0.1)
    }
    fn bounds(&self) -> [[f64; 2]; 2] {
        [[0.0, 1.0]; 2]
    }
}

#[test]
fn layers_at_nodes_and_cells() {
    let cone = "initial={standing_layer.cone={height=0.3,centre=[0.5,0.5],slope=1},rolling_layer=0.1}";
    let pile = plan(&[cone, RING, "table.open=[\"left\"]"]);
    assert_eq!(pile.standing[11 * 5 + 5], 0.0, "no cell of the table touches the node in the hole");
    assert_eq!(pile.standing[11 * 5 + 4], 0.3 - (0.5f64 - 0.4));
    assert_eq!((pile.rolling[0], pile.rolling[55]), (0.1, 0.0));
    assert_eq!(pile.clipped, 0.0);
    let level = plan(&["initial={standing_layer=0.05}"]);
    assert_eq!((level.standing[0], level.standing[12], level.clipped), (0.0, 0.05, 0.05), "0 at open edges");
    let notes = evaluated(&["initial={standing_layer=0.05}"]).0.notes.join("\n");
    assert!(notes.contains("standing_layer is up to 0.05 at open edges"), "{notes}");
    let slope = plan(&[
        "table={height.formula=\"0.5*x\"}",
        "initial={standing_layer.formula=\"max(0.04 - 0.1*x, 0)\"}",
    ]);
    assert_eq!((slope.height[10], slope.height[120]), (0.5, 0.5));
}

#[test]
fn sources_add_up_and_switch() {
    let three = "source=[{rate=1,on.box=[0,0.5]},{rate=2,from=1,to=3},{rate.formula=\"x*t\",on.disc={centre=[0.5,0.5],radius=0.1}}]";
    let sources = poured(&[three, "time={end=5}"]);
    assert_eq!(sources.changes(), [1.0, 3.0]);
    assert!(sources.is_moving(0.0) && sources.lasting().is_none());
    let at = |t: f64, cell: usize| sources.rate(t)[cell];
    assert_eq!((at(0.0, 0), at(0.0, 9), at(1.0, 0), at(1.0, 9), at(3.0, 0)), (1.0, 0.0, 3.0, 2.0, 1.0));
    assert_eq!(at(4.0, 44), 1.0 + 0.45 * 4.0);
    let still = poured(&["source=[{rate.formula=\"y\",from=1},{rate=7,to=2}]"]);
    assert!(!still.is_moving(0.0));
    let gone = poured(&["source=[{rate.formula=\"1 + t\",to=2}]"]);
    assert!(gone.is_moving(1.0) && !gone.is_moving(2.0), "what has ended moves no more");
    assert_eq!(still.lasting().unwrap()[90], 0.95);
    let dips = poured(&["source=[{rate.formula=\"1 - t\"}]"]);
    assert_eq!(dips.rate(2.0)[0], 0.0, "a rate below 0 later on counts as 0");
}

#[test]
fn what_may_surprise_is_said() {
    let notes = |changes: &[&str]| evaluated(changes).0.notes.join("\n");
    assert!(notes(&["source=[{rate=1,on.box=[0.8,1.2,0,1]}]"]).contains("source[0] reaches beyond the grid"));
    let half = notes(&["table={mask={box=[0,0.5]}}", "source=[{rate=1,on.box=[0,1,0,1]}]"]);
    assert!(half.contains("source[0]: 50.0 % of its cells lie off the table"), "{half}");
    assert!(notes(&["table={cut=[{box=[0.4,0.6]}]}"]).contains("the table is in 2 pieces"));
    let growing = notes(&["table={open=[]}", "time={end=1}"]);
    assert!(growing.contains("without an open edge") && growing.contains("grow until the end"), "{growing}");
    assert!(notes(&["source=[]"]).contains("nothing will move"));
    assert_eq!(notes(&["time.end=1"]), "");
    assert_eq!(notes(&["time.method=direct"]), "", "what does not step has no time limit");
    assert_eq!(notes(&["time.method=direct", "table={height.formula=\"0.5*x\"}"]), "", "on a slope too");
}

#[test]
fn a_sandpile_survives_its_own_writing() {
    let changes: &[&[&str]] = &[
        &[],
        &[
            LINE,
            "table={open=[\"left\",\"hole\"],wall=[{on.disc={centre=1,radius=0.1}}],cut=[{box=[0.4,0.5]}]}",
        ],
        &["table={mask={disc={centre=[0.5,0.5],radius=0.5}},height=0.5}", "scheme.theta_exponent=3"],
        &["source=[{rate.formula=\"x+t\",on.box=[0,1,0,1],from=1,to=2}]", "time.steady_rate=1e-6"],
        &["initial={standing_layer=0,rolling_layer.formula=\"x\"}", "scheme.name=second_order"],
        &["time.method=direct", "table.mask.file=a.geojson"],
    ];
    for changes in changes {
        let case = with(changes).unwrap_or_else(|error| panic!("{changes:?}: {error}"));
        let again = Case::parse(&case.to_toml(), "again.toml");
        let again = again.unwrap_or_else(|error| panic!("{changes:?}: {error}\n{}", case.to_toml()));
        assert_eq!(case.to_toml(), again.to_toml());
        assert_eq!(case.check(&Disk).is_ok(), again.check(&Disk).is_ok(), "{changes:?}");
    }
}

/// The changes that spoil the case, the key that is blamed, and parts of message and cure.
const BAD: &[(&[&str], &str, &[&str])] = &[
    // of the other model
    (
        &["material={friction={coulomb={mu=0.4}}}"],
        "material",
        &["no meaning for hadeler_kuttler", "remove it"],
    ),
    (&["grid.boundary=wall"], "grid.boundary", &["no meaning", "use [table] open"]),
    (&["terrain={dem=\"a.asc\"}"], "terrain", &["no meaning", "mask.file"]),
    (&["release=[]"], "release", &["no meaning", "[[source]]"]),
    (&["initial={thickness=1}"], "initial.thickness", &["no meaning", "standing_layer"]),
    (&["initial={velocity_x=1}"], "initial.velocity_x", &["no meaning"]),
    (&["initial={velocity_y=1}"], "initial.velocity_y", &["no meaning"]),
    (&["scheme.film=1e-6"], "scheme.film", &["no meaning", "no films"]),
    (
        &["scheme.name=balanced"],
        "scheme.name",
        &["balanced is not one of hadeler_kuttler", "allowed: first_order, second_order, adaptive"],
    ),
    (&["output.threshold=0.01"], "output.threshold", &["no meaning", "no maps of peaks and times"]),
    (&["time.rest_speed=1e-6"], "time.rest_speed", &["no meaning", "steady_rate"]),
    (&["time.stop.kinetic_energy=0.1"], "time.stop", &["no meaning", "steady_rate"]),
    (&["time.until=rest"], "time.until", &["no end \"rest\"", "until = \"steady\""]),
    (&["output.files=[\"geotiff\"]"], "output.files[0]", &["needs [terrain]", "netcdf"]),
    // scheme and time
    (
        &["scheme={name=\"first_order\",theta_exponent=3}"],
        "scheme.theta_exponent",
        &["no meaning for first_order", "adaptive"],
    ),
    (&["scheme.theta_exponent=0"], "scheme.theta_exponent", &["found 0"]),
    (&["scheme.courant=0.6"], "scheme.courant", &["<= 0.5 for adaptive"]),
    (&["scheme={name=\"first_order\",courant=1.5}"], "scheme.courant", &["<= 1 for first_order"]),
    (&["scheme={step=0.1,courant=0.1}"], "scheme.courant", &["both `step` and `courant`"]),
    (&["time={}"], "time", &["nothing ends the run", "until = \"steady\""]),
    (&["time={end=1,steady_rate=1e-6}"], "time.steady_rate", &["without until = \"steady\""]),
    (&["time.steady_rate=0"], "time.steady_rate", &["found 0"]),
    (&["time={end=1,method=\"direct\"}"], "time.method", &["without until = \"steady\""]),
    (&["time.method=newton"], "time.method", &["found `newton`", "direct"]),
    (
        &["time.method=direct", "time.end=1"],
        "time.end",
        &["no effect with time.method = \"direct\"", "remove it"],
    ),
    (&["time.method=direct", "time.steps=1"], "time.steps", &["no effect"]),
    (&["time.method=direct", "time.steady_rate=1"], "time.steady_rate", &["no effect"]),
    (&["time.method=direct", "scheme.courant=0.1"], "scheme.courant", &["no effect"]),
    (&["time.method=direct", "initial={}"], "initial", &["no effect"]),
    (&["time.method=direct", "scheme.step=0.1"], "scheme.step", &["no effect"]),
    (&["time.method=direct", "scheme.theta_exponent=3"], "scheme.theta_exponent", &["no effect"]),
    (
        &["time.method=direct", "source=[{rate.formula=\"t\"}]"],
        "source[0].rate",
        &["a source that moves", "leave t out"],
    ),
    (
        &["time.method=direct", "source=[{rate=1,to=2}]"],
        "time.method",
        &["no source pours for ever", "add a [[source]]"],
    ),
    // never steady
    (&["table={open=[]}"], "time.until", &["never be steady", "open an edge"]),
    (
        &["table={open=[\"left\"],cut=[{box=[0.4,0.6]}],wall=[{on.box=[0.6,0.6]}]}", "time.end=1"],
        "time.until",
        &["never be steady", "x = 0.65"],
    ),
    (&["table={open=[]}", "time.method=direct"], "time.until", &["never be steady"]),
    (&[RING, "table.open=[\"hole\"]", "table.wall=[{on.box=[0,1,0,1]}]"], "time.until", &["never be steady"]),
    // the table
    (&["table={open=\"left\"}"], "table.open", &["\"left\"", "\"all\" or a list"]),
    (&["table={open=[\"lefd\"]}"], "table.open[0]", &["did you mean `left`?", "hole"]),
    (&[LINE, "table={open=[\"top\"]}"], "table.open[0]", &["the grid has no y", "left, right, hole"]),
    (&["table={mask={box=[2,3]}}"], "table.mask", &["none of the 10 x 10 cells", "centre"]),
    (&["table={cut=[{box=[0,1]}]}"], "table.cut", &["none of the 10 x 10 cells"]),
    (&["table={mask={box=[0,1,0]}}"], "table.mask.box", &["found 3 numbers, expected [x0, x1, y0, y1]"]),
    (&["table={mask={box=[1,0]}}"], "table.mask.box", &["from 1 to 0 is no interval"]),
    (&[LINE, "table={mask={box=[0,1,0,1]}}"], "table.mask.box", &["the grid has no y"]),
    (
        &[LINE, "table={mask={disc={centre=[0,1],radius=1}}}"],
        "table.mask.disc.centre",
        &["expected centre = x"],
    ),
    (
        &[LINE, "source=[{rate=1,on.file=\"Cargo.toml\"}]"],
        "source[0].on.file",
        &["polygons need two dimensions"],
    ),
    (&["table={mask={disc={radius=-1}}}"], "table.mask.disc.radius", &["found -1, expected a number > 0"]),
    (&["table={mask={disk={radius=1}}}"], "table.mask.disk", &["did you mean `disc`?"]),
    (&["table={mask={disc={radius=1},box=[0,1]}}"], "table.mask", &["exactly one choice"]),
    (
        &["table={wall=[{on.box=[0.41,0.45,0.4,0.5]}]}"],
        "table.wall[0].on",
        &["no edge of the table", "widen it"],
    ),
    (&["table={wall=[{}]}"], "table.wall[0].on", &["missing"]),
    (
        &["table={height.formula=\"1.5*x\"}"],
        "table.height",
        &["the table's slope is 1.5", "x = 0, y = 0", "above 1"],
    ),
    (&["table={height.formula=\"1/x\"}"], "table.height", &["inf at x = 0, y = 0"]),
    // sources
    (
        &["source=[{rate=-1}]"],
        "source[0].rate",
        &["the rate is -1 at x = 0.05, y = 0.05, time 0", "max(..., 0)"],
    ),
    (&["source=[{rate=1},{rate.formula=\"0.5 - x\",from=2}]"], "source[1].rate", &["x = 0.55", "time 2"]),
    (&["source=[{rate.formula=\"cos(t)\"}]", "time.end=4"], "source[0].rate", &["time 1.75"]),
    (&["source=[{rate=\"x\"}]"], "source[0].rate", &["write rate.formula = \"x\""]),
    (&["source=[{rate.formula=\"x + z\"}]"], "source[0].rate.formula", &["unknown name `z`", "x, y, t"]),
    (&["source=[{rate=1,on.box=[2,3]}]"], "source[0].on", &["off the table", "move or widen it"]),
    (
        &["table={cut=[{box=[0,0.5]}]}", "source=[{rate=1,on.box=[0,0.5]}]"],
        "source[0].on",
        &["off the table"],
    ),
    (&["source=[{rate=1,from=2,to=2}]"], "source[0].to", &["from = 2 is not before to = 2"]),
    (&["source=[{rate=1,from=-1}]"], "source[0].from", &["found -1, expected a time >= 0"]),
    (&["source=[{on.box=[0,1]}]"], "source[0].rate", &["missing"]),
    // layers
    (
        &["initial={standing_layer=-1}"],
        "initial.standing_layer",
        &["the standing layer is -1 at x = 0, y = 0", "max(..., 0)"],
    ),
    (
        &["initial={rolling_layer=-1}"],
        "initial.rolling_layer",
        &["the rolling layer is -1 at x = 0.05, y = 0.05"],
    ),
    (
        &["initial={standing_layer=0.2}"],
        "initial.standing_layer",
        &["the slope of the pile is 2", "open edge"],
    ),
    (
        &["initial={standing_layer.cone={height=0.4,centre=[0.5,0.5],slope=1.2}}"],
        "initial.standing_layer",
        &["steeper than 1"],
    ),
    (
        &["table={open=[]}", "time={end=1}", "initial={standing_layer.formula=\"0.9*(x + y)\"}"],
        "initial.standing_layer",
        &["slope of the pile is 1.27"],
    ),
    (
        &[
            "table={height.formula=\"0.6*x\"}",
            "initial={standing_layer.formula=\"0.6*min(x, 1 - x, y, 1 - y)\"}",
        ],
        "initial.standing_layer",
        &["slope of the pile is 1.2"],
    ),
];

#[test]
fn bad_sandpiles_are_answered_with_place_and_cure() {
    let mut wrong = Vec::new();
    for (changes, key, parts) in BAD {
        match with(changes).and_then(|case| case.check(&Disk)) {
            Ok(_) => wrong.push(format!("{changes:?} passes")),
            Err(error) => {
                let told = error.to_string();
                if error.key() != *key || !parts.iter().all(|part| told.contains(part)) {
                    wrong.push(format!("{changes:?}: expected {key} {parts:?}, got {}\n{told}", error.key()));
                }
                let cured = !error.help_lines().is_empty()
                    || ["expected", "known are"].iter().any(|word| told.contains(word));
                if !cured {
                    wrong.push(format!("no cure: {told}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} are wrong:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn an_avalanche_has_no_table() {
    let silo = |change: &str| {
        let text =
            "grid.x={from=0,to=1,cells=4}\nmaterial.friction.coulomb.mu=0.4\ninitial.thickness=1\ntime.end=1";
        Case::parse_with(text, "silo.toml", &[change.to_owned()])
            .and_then(|case| case.check(&Disk))
            .unwrap_err()
    };
    for (change, key) in [
        ("table={}", "table"),
        ("source=[]", "source"),
        ("initial.standing_layer=1", "initial.standing_layer"),
        ("initial.rolling_layer=1", "initial.rolling_layer"),
        ("scheme.theta_exponent=2", "scheme.theta_exponent"),
        ("time.steady_rate=1", "time.steady_rate"),
        ("time.method=direct", "time.method"),
    ] {
        let error = silo(change);
        assert_eq!(error.key(), key);
        assert!(error.to_string().contains("belongs to the model hadeler_kuttler"), "{error}");
        assert!(error.to_string().contains("model = \"hadeler_kuttler\""), "{error}");
    }
    assert!(
        silo("scheme.name=adaptive")
            .to_string()
            .contains("allowed: energy_stable, energy_stable_2, balanced")
    );
    assert!(silo("time.until=steady").to_string().contains("write until = \"rest\""));
    assert!(silo("initial={}").to_string().contains("`thickness` is missing"));
}

#[test]
fn a_misspelt_model_is_not_answered_as_if_the_table_were_foreign() {
    let text =
        "modeel = \"hadeler_kuttler\"\ngrid.x = { from = 0.0, to = 1.0, cells = 4 }\ntable.height = 0.0\n";
    let error = Case::parse(text, "case.toml").unwrap_err().to_string();
    assert!(error.contains("unknown key `modeel`") && error.contains("did you mean `model`?"), "{error}");
}
