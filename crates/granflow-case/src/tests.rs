use super::*;

mod sandpile;

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

fn same(one: &Case, two: &Case) -> bool {
    let value = |case: &Case| serde_json::to_value(case).unwrap();
    value(one) == value(two)
}

#[test]
fn the_silo() {
    let case = with(&[]).unwrap();
    case.check().unwrap();
    assert_eq!(case.scheme.name, SchemeName::Verfahren5);
    assert_eq!(case.scheme.stepping(), Stepping::Fixed(0.001));
    assert_eq!((case.scheme.film(), case.gravity()), (0.0, 1.0));
    let tan = 18f64.to_radians().tan();
    assert_eq!(case.material().pressure_coefficient(), 1.0 + 2.0 * tan * tan);
    let state = case.initial_state().unwrap();
    assert_eq!(state.thickness.iter().filter(|h| **h == 2.3).count(), 40);
    assert_eq!(
        (state.thickness[99], state.thickness[100], state.thickness[139], state.thickness[140]),
        (0.3, 2.3, 2.3, 0.3)
    );
    assert_eq!(case.frames(), Frames::Steps(500));
    assert_eq!(case.files(), [FileKind::Netcdf, FileKind::Figures]);
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
            "output={every=0.5,files=[\"vtk\"],precision=\"f32\"}",
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
    assert_eq!(case.terrain.as_ref().unwrap().curvature.length(), None);
    assert_eq!((case.gravity(), case.precision(), case.frames()), (9.81, Precision::F32, Frames::Every(0.5)));
}

#[test]
fn shapes_in_two_dimensions() {
    let at = |change: &str| {
        let grid = "grid={x={from=0,to=3,cells=3},y={from=0,to=4,cells=4}}";
        with(&[grid, change]).unwrap().initial_state().unwrap_or_else(|error| panic!("{error}")).thickness
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
    assert_eq!(case.release[0].raster.as_deref(), Some(Path::new("c")));
    assert!(case.text().ends_with("\n# --set release.0.raster=c"));
    let error = Case::parse_with(text, "t.toml", &["release.0.raste=c".to_owned()]).unwrap_err();
    assert_eq!((error.source_name(), error.key()), ("--set release.0.raste=c", "release[0].raste"));
    assert_eq!(&error.text()[error.span().unwrap()], "raste");
}

#[test]
fn errors_know_their_bytes() {
    let error = with(&["initial.thickness={formula=\"1 + zz\"}"]).unwrap().check().unwrap_err();
    assert_eq!(&error.text()[error.span().unwrap()], "zz");
    let error = Case::parse(&SILO.replace("0.001", "-0.001"), "silo.toml").unwrap().check().unwrap_err();
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
                match Case::parse_with(&text, "any.toml", &overrides).and_then(|case| case.check()) {
                    Ok(()) => {}
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
fn an_earth_pressure_on_terrain_is_refused_not_ignored() {
    let text = "[terrain]\ndem = \"a.asc\"\n[material]\ndensity = 200.0\nfriction.coulomb = { mu = 0.4 }\n\
                earth_pressure = \"kaland\"\n[[release]]\ncap = { height = 1.0, centre = [0.0, 0.0], radius = 5.0 }\n\
                [time]\nend = 1.0\n";
    let error = Case::parse(text, "case.toml").and_then(|case| case.check()).unwrap_err();
    assert!(error.headline().contains("material.earth_pressure"), "{}", error.headline());
}
