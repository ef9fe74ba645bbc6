use super::*;
use crate::chute::InitialState;
use granflow_model::savage_hutter::friction::AnyLaw;
use std::path::Path;

mod ensemble;
mod resolved;
mod sandpile;

/// The disk, without a reader of polygons.
struct Disk;

impl FileAccess for Disk {
    fn outlines(&self, path: &Path) -> Result<Box<dyn Outline>, String> {
        Err(format!("{} holds no polygon", path.display()))
    }
    fn kinds(&self) -> &'static [FileKind] {
        const fn kind(name: &'static str, needs_terrain: bool) -> FileKind {
            FileKind { name, about: "", needs_terrain }
        }
        const KINDS: &[FileKind] = &[
            kind("netcdf", false),
            kind("figures", false),
            kind("csv", false),
            kind("vtk", false),
            kind("animation", false),
            kind("geotiff", true),
            kind("vector", true),
            kind("report", true),
        ];
        KINDS
    }
}

/// Their names.
fn named(files: &[FileKind]) -> Vec<&str> {
    files.iter().map(|kind| kind.name).collect()
}

fn checked(case: &Case) -> Checked {
    case.check(&Disk).unwrap_or_else(|error| panic!("{error}"))
}

fn on_chute(checked: Checked) -> chute::Plan {
    let Kind::Chute(plan) = checked.kind else { panic!("{:?}", checked.run) };
    plan
}

/// The words of both, with their defaults.
fn same(one: &Case, two: &Case) -> bool {
    one.to_toml() == two.to_toml()
}

const SILO: &str = r#"
title = "A silo breaks"
model = "savage_hutter"
[grid]
x = { from = -6.0, to = 6.0, cells = 240 }
[material]
epsilon = 0.4
slope = "0 deg"
friction.coulomb = { angle = "18 deg" }
earth_pressure = "kaland"
[initial]
thickness.steps = { at = [-1.0, 1.0], values = [0.3, 2.3, 0.3] }
[scheme]
name = "scheme_3"
step = 0.001
[time]
steps = 10000
"#;

fn with(changes: &[&str]) -> Result<Case, CaseError> {
    let overrides: Vec<String> = changes.iter().map(|change| (*change).to_owned()).collect();
    Case::parse_with(SILO, "silo.toml", &overrides)
}

#[test]
fn the_silo() {
    let Checked { run, kind } = checked(&with(&[]).unwrap());
    assert_eq!(
        (run.title.as_str(), run.model, run.scheme),
        ("A silo breaks", "savage_hutter", "verfahren_5")
    );
    assert_eq!((run.stepping, run.max_courant), (Stepping::Fixed(0.001), 1.0));
    assert_eq!(run.output.frames, Frames::Steps(500));
    assert_eq!(named(&run.output.files), ["netcdf", "figures"]);
    assert_eq!((run.output.precision, run.output.threshold, run.notes.len()), (Precision::F64, 1e-3, 0));
    let ends = Ends { steps: Some(10000), time: None, until: None, kinetic_energy: None };
    assert_eq!(run.ends, ends);
    let silo = on_chute(Checked { run, kind });
    assert_eq!((silo.scheme.name, silo.scheme.film), (avalanche::SchemeName::Verfahren5, 0.0));
    let tan = 18f64.to_radians().tan();
    let material = silo.material;
    assert_eq!((material.mu, material.gravity, material.density), (Some(tan), 1.0, 1.0));
    assert_eq!(material.pressure_coefficient, 1.0 + 2.0 * tan * tan);
    assert!(matches!(material.law, AnyLaw::Coulomb(law) if law.mu == tan));
    assert_eq!((silo.epsilon, silo.eta), (0.4, 1.0));
    assert!((0..240).all(|column| (silo.columns.zeta(column), silo.columns.kappa(column)) == (0.0, 0.0)));
    let InitialState { thickness: h, velocity_x, velocity_y, result: _ } = silo.initial;
    assert!(velocity_x.iter().chain(velocity_y.iter()).eq([0.0; 480]));
    let h: Vec<f64> = h.iter().collect();
    assert_eq!(h.iter().filter(|h| **h == 2.3).count(), 40);
    assert_eq!((h[99], h[100], h[139], h[140]), (0.3, 2.3, 2.3, 0.3));
}

#[test]
fn a_scheme_says_its_own_courant_numbers() {
    for (name, max, taken) in [
        ("energy_stable", 1.0, 0.9),
        ("balanced", 1.0, 0.9),
        ("balanced_2", 0.5, 0.45),
        ("verfahren_2", 1.0, 0.9),
    ] {
        let run = checked(&with(&[&format!("scheme={{name=\"{name}\"}}")]).unwrap()).run;
        assert_eq!((run.max_courant, run.stepping), (max, Stepping::Courant(taken)), "{name}");
    }
}

#[test]
fn the_numbers_of_a_law() {
    let law = |law: &str| {
        let friction = format!("material.friction={{{law}}}");
        let changes = [friction.as_str(), "material.density=2", "material.gravity=9", "scheme.name=balanced"];
        on_chute(checked(&with(&changes).unwrap())).material
    };
    let voellmy = law("voellmy={angle=\"45 deg\",xi=1000}");
    assert!(matches!(voellmy.law, AnyLaw::Voellmy(law) if law.xi == 1000.0 && law.gravity == 9.0));
    assert_eq!((voellmy.friction, voellmy.mu), ("voellmy", Some(45f64.to_radians().tan())));
    let cohesion = law("cohesion={mu=0.5,tau0=3}");
    assert!(matches!(cohesion.law, AnyLaw::Cohesion(law) if law.bond == 1.5 && law.mu == 0.5));
    let samosat = law("samosat={tau0=1}");
    assert!(
        matches!(samosat.law, AnyLaw::SamosAt(law) if law.bond == 0.5 && law.mu == 0.155 && law.b == 4.13)
    );
}

#[test]
fn a_case_survives_its_own_writing() {
    let changes: &[&[&str]] = &[
        &[],
        &["grid.y={from=0,to=1,cells=4}", "grid.boundary={x=[\"wall\",\"open\"],y=\"periodic\"}"],
        &[
            "material.slope={x=[0,1],angle=[\"5 deg\",0.1],curvature=\"x\"}",
            "scheme.name=balanced",
            "scheme.film=0",
        ],
        &["initial.thickness={cap={height=1,centre=[0,0],radius=2}}", "initial.velocity_x=0.5"],
        &["initial.thickness={formula=\"exp(-x^2)\"}", "time.until=rest", "time.rest_speed=1e-12"],
        &[
            "material.friction={samosat={}}",
            "scheme.name=balanced_2",
            "output={every=0.5,files=[\"vtk\"],precision=\"f32\",threshold=0.02}",
        ],
    ];
    for changes in changes {
        let case = with(changes).unwrap_or_else(|error| panic!("{changes:?}: {error}"));
        let again =
            Case::parse(&case.to_toml(), "again.toml").unwrap_or_else(|error| panic!("{changes:?}: {error}"));
        assert!(same(&case, &again), "{changes:?}:\n{}", case.to_toml());
    }
    let terrain = r#"
        terrain = { dem = "a.tif", crs = "EPSG:31287", curvature = "off" }
        material = { density = 200, friction.voellmy = { mu = 0.2, xi = 2000 } }
        release = [{ polygons = "r.shp", thickness.attribute = "d", measured = "vertical" }, { raster = "h.tif" }]
        time.end = 10
    "#;
    let case = Case::parse(terrain, "t.toml").unwrap();
    assert!(same(&case, &Case::parse(&case.to_toml(), "t.toml").unwrap()));
}

#[test]
fn a_mountain() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("case.toml");
    let text = r#"
        terrain = { dem = "a.tif", crs = "EPSG:31287", curvature = "off" }
        material = { density = 200, friction.voellmy = { mu = 0.2, xi = 2000 } }
        release = [{ polygons = "r.shp", thickness.attribute = "d", measured = "vertical" }, { raster = "h.tif" }]
        time.end = 10
    "#;
    std::fs::write(&file, text).unwrap();
    for name in ["a.tif", "r.shp", "h.tif"] {
        let error = Case::read(&file).unwrap().check(&Disk).unwrap_err();
        assert!(error.to_string().contains(name) && error.kind() == CaseErrorKind::File, "{error}");
        std::fs::write(folder.path().join(name), "").unwrap();
    }
    let Checked { run, kind } = checked(&Case::read(&file).unwrap());
    assert_eq!((run.output.precision, run.output.frames), (Precision::F32, Frames::Every(0.5)));
    assert_eq!(run.output.threshold, 0.01);
    assert_eq!((run.output.files.len(), run.locate(Path::new("x"))), (5, folder.path().join("x")));
    let Kind::Terrain(mountain) = kind else { panic!("it has a terrain") };
    assert_eq!((mountain.dem, mountain.curvature), (folder.path().join("a.tif"), None));
    assert_eq!((mountain.material.gravity, mountain.scheme.film), (9.81, 1e-4));
    assert_eq!(mountain.scheme.name, terrain::TerrainScheme::EnergyStable2);
    let thickness = terrain::Thickness::Attribute(terrain::Attribute { attribute: "d".into(), factor: None });
    let path = folder.path().join("r.shp");
    assert_eq!(mountain.releases[0].extent, terrain::Extent::Polygons { path, thickness });
    assert_eq!(mountain.releases[0].measured, terrain::Measured::Vertical);
    assert_eq!(mountain.releases[1].extent, terrain::Extent::Raster(folder.path().join("h.tif")));
    let refused = Case::read(&file).unwrap().check(&NoFiles).unwrap_err();
    assert!(refused.to_string().contains("files are not read here"), "{refused}");
}

#[test]
fn the_kind_is_chosen_by_model_and_place() {
    let told = |text: &str| Case::parse(text, "t.toml").unwrap_err().to_string();
    let mountain = "terrian = { dem = \"a\" }\nrelease = [{ raster = \"b\" }]";
    assert!(told(mountain).contains("t.toml:1:1: `terrian`: unknown key `terrian`"), "{}", told(mountain));
    assert!(told(mountain).contains("did you mean `terrain`?"), "{}", told(mountain));
    assert!(told("[grdi]").contains("did you mean `grid`?"));
    assert!(told("").contains("neither [grid] nor [terrain]"));
    assert!(told("grid.x = 1\nterrain.dem = \"a\"").contains("both [grid] and [terrain]"));
    assert!(told("model = \"hadeler_kuttler\"").contains("the case has no [grid]"));
    assert!(told("model = 3").contains("allowed: savage_hutter, hadeler_kuttler"));
    assert!(told("model = \"hadeler_kutler\"").contains("did you mean `hadeler_kuttler`?"));
    assert!(told("grid.x = 1\nrelease = [{ raster = \"b\" }]").contains("[[release]] needs [terrain]"));
}

#[test]
fn shapes_in_two_dimensions() {
    let at = |change: &str| {
        let grid = "grid={x={from=0,to=3,cells=3},y={from=0,to=4,cells=4}}";
        on_chute(checked(&with(&[grid, change]).unwrap())).initial.thickness.iter().collect::<Vec<f64>>()
    };
    let cap = at("initial.thickness={cap={height=2,centre=[1.5,1.5],radius=2}}");
    assert_eq!((cap.len(), cap[4], cap[3]), (12, 2.0, 1.5), "x runs fastest");
    let cone = at("initial.thickness={cone={height=2,centre=[1.5,0.5],slope=1}}");
    assert_eq!((cone[1], cone[4], cone[10]), (2.0, 1.0, 0.0));
    let parabola = at("initial.thickness={parabola={height=1,curvature=1,centre=[1.5,0.5],floor=0.25}}");
    assert_eq!((parabola[1], parabola[0], parabola[11]), (1.0, 0.25, 0.25));
    assert_eq!(at("initial.thickness={formula=\"x + 10*y\"}")[5], 2.5 + 15.0);
    assert_eq!(at("initial.thickness=3"), [3.0; 12]);
}

#[test]
fn an_override_reaches_into_lists() {
    let text = "material.friction.coulomb.mu = 0.4\nmaterial.density = 1\ntime.end = 1\nterrain.dem = \"a\"\n[[release]]\nraster = \"b\"";
    let case = Case::parse_with(text, "t.toml", &["release.0.raster=c".to_owned()]).unwrap();
    assert!(case.to_toml().contains("raster = \"c\""), "{}", case.to_toml());
    assert!(case.text().ends_with("\n# --set release.0.raster=c"));
    let error = Case::parse_with(text, "t.toml", &["release.0.raste=c".to_owned()]).unwrap_err();
    assert_eq!((error.source_name(), error.key()), ("--set release.0.raste=c", "release[0].raste"));
    assert_eq!(&error.text()[error.span().unwrap()], "raste");
}

#[test]
fn errors_know_their_bytes() {
    let error = with(&["initial.thickness={formula=\"1 + zz\"}"]).unwrap().check(&Disk).unwrap_err();
    assert_eq!(&error.text()[error.span().unwrap()], "zz");
    let error = Case::parse(&SILO.replace("0.001", "-0.001"), "silo.toml").unwrap().check(&Disk).unwrap_err();
    assert_eq!((error.key(), error.line_column()), ("scheme.step", Some((15, 8))));
    assert_eq!(&error.text()[error.span().unwrap()], "-0.001");
    assert_eq!(error.to_string(), "silo.toml:15:8: `scheme.step`: found -0.001, expected a number > 0");
}

mod any_text {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Whatever is written, the answer is a case or an error, never a panic.
        #[test]
        fn never_panics(cut in 0..SILO.len(), length in 0..40usize, put in "[ -~\n\u{e9}]{0,12}", set in "[ -~]{0,30}") {
            let mut text = SILO.to_owned();
            text.replace_range(cut..(cut + length).min(SILO.len()), &put);
            for overrides in [vec![], vec![set]] {
                match Case::parse_with(&text, "any.toml", &overrides).and_then(|case| case.check(&Disk)) {
                    Ok(_) => {}
                    Err(error) => {
                        prop_assert!(!error.to_string().is_empty());
                        prop_assert!(error.span().is_none_or(|span| error.text().get(span.start.min(error.text().len())..).is_some()));
                    }
                }
            }
        }
    }
}

#[test]
fn an_earth_pressure_needs_the_one_angle_of_a_law() {
    let text = |friction: &str, pressure: &str| {
        format!(
            "[terrain]\ndem = \"a.asc\"\n[material]\ndensity = 200.0\nfriction.{friction}\nearth_pressure{pressure}\n\
             [[release]]\ncap = {{ height = 1.0, centre = [0.0, 0.0], radius = 5.0 }}\n[time]\nend = 1.0\n"
        )
    };
    for friction in [
        "bingham = { yield = 100.0, viscosity = 10.0 }",
        "samosat = { size = \"auto\" }",
        "coulomb = { mu = { by_elevation = { at = [1000], values = [0.3, 0.4] } } }",
    ] {
        for pressure in [" = \"kaland\"", ".active_passive = { internal = \"35 deg\" }"] {
            let case = Case::parse(&text(friction, pressure), "case.toml");
            let error = case.and_then(|case| case.check(&Disk)).unwrap_err();
            assert!(error.headline().contains("needs the one friction angle"), "{}", error.headline());
        }
    }
}
