//! Every kind of figure, drawn from made-up data; the pictures stay in `target/tmp/figures`.

use std::path::PathBuf;

use granflow_figures::{
    Axis, Colours, Convergence, Curve, ErrorSeries, Extent, Figure, FigureError, Fill, Frame, HeatMap,
    History, HistoryPanel, Map, Outline, Overlay, Paint, Profiles, Section, Style, Surface,
};

/// A decoded PNG.
struct Png {
    width: usize,
    height: usize,
    rgb: Vec<u8>,
}

impl Png {
    fn pixel(&self, x: usize, y: usize) -> [u8; 3] {
        let k = 3 * (y * self.width + x);
        [self.rgb[k], self.rgb[k + 1], self.rgb[k + 2]]
    }

    /// Number of pixels whose colour is within 12 of `colour` in every part.
    fn count(&self, colour: [u8; 3]) -> usize {
        self.rgb
            .as_chunks::<3>()
            .0
            .iter()
            .filter(|p| p.iter().zip(&colour).all(|(a, b)| a.abs_diff(*b) <= 12))
            .count()
    }

    fn colours(&self) -> usize {
        let mut seen: Vec<_> = self.rgb.as_chunks::<3>().0.to_vec();
        seen.sort_unstable();
        seen.dedup();
        seen.len()
    }

    /// Whether nothing but white stands in the outermost pixels: no text runs out of the sheet.
    fn rim_is_white(&self) -> bool {
        let (w, h) = (self.width, self.height);
        let sides =
            (0..h).flat_map(|y| [[0, y], [w - 1, y]]).chain((0..w).flat_map(|x| [[x, 0], [x, h - 1]]));
        sides.into_iter().all(|[x, y]| self.pixel(x, y) == [255; 3])
    }
}

/// Saves the figure, reads it back, and checks what holds for every figure.
fn drawn(name: &str, figure: &dyn Figure) -> Png {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("figures").join(format!("{name}.png"));
    let picture = figure.draw().unwrap();
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    picture.write_png(&mut std::fs::File::create(&path).unwrap()).unwrap();
    let mut reader =
        png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&path).unwrap())).read_info().unwrap();
    let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut rgb).unwrap();
    assert_eq!(info.color_type, png::ColorType::Rgb);
    let png = Png { width: info.width as usize, height: info.height as usize, rgb };
    assert!(png.rim_is_white(), "{name}: something is cut at the edge");
    assert!(png.count([34, 34, 34]) > 2000, "{name}: no frame or no text");
    png
}

fn range(n: usize, low: f64, high: f64) -> Vec<f64> {
    (0..n).map(|k| low + (high - low) * (k as f64 + 0.5) / n as f64).collect()
}

/// A heap that collapses: smooth, with a front.
fn heap(x: f64, t: f64) -> f64 {
    let width = 1.0 + 0.8 * t;
    0.3 + 2.0 / width * (1.0 - (x / width).powi(2)).max(0.0)
}

#[test]
fn profiles_show_their_curves_and_fills() {
    let x = range(400, -6.0, 6.0);
    let at = |t: f64| -> Vec<f64> { x.iter().map(|&x| heap(x, t)).collect() };
    let (start, middle, end) = (at(0.0), at(1.5), at(4.0));
    let coarse = range(40, -6.0, 6.0);
    let points: Vec<f64> = coarse.iter().map(|&x| heap(x, 4.0) + 0.01 * (9.0 * x).sin()).collect();
    let ground = vec![0.0; x.len()];
    let figure = Profiles {
        title: "A silo breaks: thickness against the exact solution",
        subtitle: "ε = 0.4, δ = 18°, 240 cells, Verfahren 5",
        x: Axis::new("x", ""),
        y: Axis::new("thickness h", "m"),
        curves: &[
            Curve { name: "t = 0", x: &x, y: &start, style: Style::Dashed, colour: Some([110, 110, 110]) },
            Curve { name: "t = 1.5", x: &x, y: &middle, style: Style::Dotted, ..Default::default() },
            Curve { name: "t = 4, exact", x: &x, y: &end, style: Style::Solid, colour: Some([0, 114, 178]) },
            Curve {
                name: "t = 4, computed",
                x: &coarse,
                y: &points,
                style: Style::Points,
                ..Default::default()
            },
        ],
        fills: &[Fill {
            name: "pile at rest",
            x: &x,
            lower: Some(&ground),
            upper: &end,
            colour: [201, 178, 140],
        }],
        ..Default::default()
    };
    let png = drawn("profiles", &figure);
    assert_eq!((png.width, png.height), (1600, 1000));
    assert!(
        png.count([0, 114, 178]) > 1500
            && png.count([204, 121, 167]) > 500
            && png.count([224, 214, 192]) > 50_000
    );
    let again = figure.draw().unwrap();
    assert_eq!(again.rgb, png.rgb, "the same data give the same picture");
}

#[test]
fn crowded_profiles_put_the_legend_beside() {
    let x = range(300, 0.0, 1.0);
    let ys: Vec<Vec<f64>> =
        (0..8).map(|k| x.iter().map(|x| (20.0 * x + f64::from(k)).sin() * 3e-7).collect()).collect();
    let names: Vec<String> = (0..8).map(|k| format!("phase {k}, a rather long name")).collect();
    let curves: Vec<Curve> =
        ys.iter().zip(&names).map(|(y, name)| Curve { name, x: &x, y, ..Default::default() }).collect();
    let figure = Profiles {
        x: Axis::new("x", "m"),
        y: Axis::new("error", "m"),
        curves: &curves,
        ..Default::default()
    };
    assert!(drawn("profiles_crowded", &figure).colours() > 50);
}

#[test]
fn space_time_is_seen_from_above() {
    let (x, t) = (range(240, -6.0, 6.0), (0..=20).map(|k| 0.5 * f64::from(k)).collect::<Vec<_>>());
    let values: Vec<f64> = t.iter().flat_map(|&t| x.iter().map(move |&x| heap(x, t))).collect();
    let figure = HeatMap {
        title: "Thickness seen from above",
        frame: Frame::SpaceTime,
        x: Axis::new("x", "m"),
        y: Axis::new("time t", "s"),
        xs: &x,
        ys: &t,
        values: &values,
        quantity: Axis::new("thickness h", "m"),
        ..Default::default()
    };
    let png = drawn("space_time", &figure);
    assert!(png.colours() > 400);
    assert!(png.count(Colours::Viridis.at(0.0)) > 50_000);
    let close = |a: [u8; 3], b: [u8; 3]| a.iter().zip(&b).all(|(a, b)| a.abs_diff(*b) < 25);
    assert!(close(png.pixel(713, 869), Colours::Viridis.at(1.0)), "the heap stands in the middle at first");
    assert!(close(png.pixel(160, 869), Colours::Viridis.at(0.0)));
}

#[test]
fn a_plane_keeps_its_proportions() {
    let (x, y) = (range(120, -1.5, 1.5), range(80, -1.0, 1.0));
    let field = |x: f64, y: f64| if x.hypot(y) > 1.4 { f64::NAN } else { x * (-2.0 * (x * x + y * y)).exp() };
    let values: Vec<f64> = y.iter().flat_map(|&y| x.iter().map(move |&x| field(x, y))).collect();
    let circle: Vec<[f64; 2]> =
        (0..90).map(|k| (f64::from(k) * 4.0).to_radians()).map(|a| [0.8 * a.cos(), 0.8 * a.sin()]).collect();
    let figure = HeatMap {
        title: "Velocity on a table",
        x: Axis::new("x", "m"),
        y: Axis::new("y", "m"),
        xs: &x,
        ys: &y,
        values: &values,
        quantity: Axis::new("velocity u", "m/s"),
        colours: Colours::Diverging,
        outlines: &[Outline { points: &circle, closed: true, dashed: true, ..Default::default() }],
        ..Default::default()
    };
    let png = drawn("plane", &figure);
    assert!(png.count(Colours::Diverging.at(0.0)) > 100 && png.count(Colours::Diverging.at(1.0)) > 100);
    let tall = HeatMap {
        xs: &y,
        ys: &x,
        values: &vec![1.0; x.len() * y.len()],
        outlines: &[],
        colours: Colours::Viridis,
        ..figure
    };
    let tall = drawn("plane_tall", &tall);
    assert!(tall.height > png.height && tall.width < png.width);
}

#[test]
fn surfaces_over_space_and_time() {
    let (x, t) = (range(200, -6.0, 6.0), (0..=60).map(|k| 0.1 * f64::from(k)).collect::<Vec<_>>());
    let values: Vec<f64> = t.iter().flat_map(|&t| x.iter().map(move |&x| heap(x, t))).collect();
    let figure = Surface {
        title: "A heap collapses",
        subtitle: "thickness over space and time",
        x: Axis::new("x", "m"),
        y: Axis::new("time t", "s"),
        z: Axis::new("thickness h", "m"),
        xs: &x,
        ys: &t,
        values: &values,
        ..Default::default()
    };
    assert!(drawn("surface_time", &figure).colours() > 1000);

    let below = Surface { azimuth: Some(120.0), elevation: Some(12.0), lines: Some(0), ..figure };
    assert!(drawn("surface_behind", &below).colours() > 1000);
}

#[test]
fn surfaces_of_two_lengths() {
    let (x, y) = (range(90, -1.0, 1.0), range(90, -1.0, 1.0));
    let pile = |x: f64, y: f64| (0.6 - 0.5 * x.hypot(y) - 0.15 * (5.0 * x).sin() * y).max(0.0);
    let values: Vec<f64> = y.iter().flat_map(|&y| x.iter().map(move |&x| pile(x, y))).collect();
    let figure = Surface {
        title: "A pile on a table",
        x: Axis::new("x", "m"),
        y: Axis::new("y", "m"),
        z: Axis::new("standing layer u", "m"),
        xs: &x,
        ys: &y,
        values: &values,
        proportions: Some([1.0, 1.0, 0.4]),
        ..Default::default()
    };
    assert!(drawn("surface_pile", &figure).colours() > 1000);
}

/// A made-up mountain with a gully, an avalanche down it, and holes at a corner.
struct Mountain {
    extent: Extent,
    bed: Vec<f64>,
    thickness: Vec<f64>,
    release: Vec<[f64; 2]>,
    path: Vec<[f64; 2]>,
}

fn mountain(nx: usize, ny: usize) -> Mountain {
    let extent = Extent { nx, ny, west: 21_300.0, south: 237_400.0, cell: 5.0 };
    let (lx, ly) = (nx as f64 * 5.0, ny as f64 * 5.0);
    let middle = |y: f64| lx * (0.5 + 0.08 * (6.0 * y / ly).sin());
    let (mut bed, mut thickness) = (Vec::new(), Vec::new());
    for j in 0..ny {
        for i in 0..nx {
            let (x, y) = ((i as f64 + 0.5) * 5.0, (j as f64 + 0.5) * 5.0);
            let s = y / ly;
            let off = (x - middle(y)) / lx;
            let ridges = 40.0 * (9.0 * x / lx).sin() * s + 25.0 * (17.0 * x / lx + 5.0 * s).cos() * s;
            let z = 1000.0 + 1300.0 * s.powf(1.6) + 900.0 * off * off + ridges
                - 60.0 * (-(off * 12.0).powi(2)).exp();
            bed.push(if i + j < nx / 6 { f64::NAN } else { z });
            let flow = 4.5 * (-(off * 16.0).powi(2)).exp() * (1.2 - s);
            thickness.push(if (0.12..0.85).contains(&s) && flow > 0.1 { flow } else { 0.0 });
        }
    }
    let place = |x: f64, s: f64| [extent.west + x, extent.south + s * ly];
    let release = [(-90.0, 0.80), (80.0, 0.79), (100.0, 0.87), (-70.0, 0.88)]
        .map(|(dx, s)| place(middle(s * ly) + dx, s));
    let path = (0..40).map(|k| 0.84 - 0.7 * f64::from(k) / 39.0).map(|s| place(middle(s * ly), s)).collect();
    Mountain { extent, bed, thickness, release: release.to_vec(), path }
}

#[test]
fn maps_show_mountain_field_and_outlines() {
    let m = mountain(439, 517);
    let quantity = Axis::new("greatest thickness", "m");
    let figure = Map {
        title: "Greatest thickness",
        subtitle: "a made-up mountain, Coulomb friction μ = 0.4",
        extent: m.extent,
        bed: &m.bed,
        overlay: Some(Overlay {
            values: &m.thickness,
            quantity,
            threshold: 0.1,
            colours: Colours::Thickness,
        }),
        outlines: &[
            Outline { name: "release", points: &m.release, closed: true, ..Default::default() },
            Outline {
                name: "path",
                points: &m.path,
                dashed: true,
                colour: Some([0, 90, 200]),
                ..Default::default()
            },
        ],
        ..Default::default()
    };
    let start = std::time::Instant::now();
    let png = drawn("map", &figure);
    println!("map drawn, written and read in {:?}", start.elapsed());
    assert!(png.colours() > 3000);
    assert!(png.count(Colours::Thickness.at(0.5)) > 100);
    let whole = drawn("map_whole", &Map { crop: None, title: "", subtitle: "", overlay: None, ..figure });
    let shape = whole.width as f64 / whole.height as f64;
    assert!((0.6..1.2).contains(&shape));
    // The corner without elevation is white, in the picture too.
    let white = (0..whole.height).filter(|&y| (200..260).all(|x| whole.pixel(x, y) == [255; 3])).count();
    assert!(white > 100, "{white}");
}

#[test]
fn sections_say_how_much_the_layers_are_exaggerated() {
    let s: Vec<f64> = (0..300).map(|k| 6.0 * f64::from(k)).collect();
    let bed: Vec<f64> = s.iter().map(|s| 1000.0 + 1000.0 * (-s / 700.0).exp()).collect();
    let bump = |at: f64, width: f64, height: f64| -> Vec<f64> {
        s.iter().map(|s| height * (1.0 - ((s - at) / width).powi(2)).max(0.0)).collect()
    };
    let (deposit, peak, speed) =
        (bump(1400.0, 300.0, 2.5), bump(900.0, 850.0, 4.0), bump(700.0, 900.0, 38.0));
    let figure = Section {
        title: "Section along the path",
        distance: &s,
        bed: &bed,
        deposit: &deposit,
        peak_thickness: &peak,
        peak_speed: &speed,
        ..Default::default()
    };
    let png = drawn("section", &figure);
    assert!(png.count([70, 62, 54]) > 1000 && png.count([213, 94, 0]) > 1000);
    // No value is drawn as nothing.
    let masked =
        |layer: &[f64]| layer.iter().map(|&v| if v > 0.0 { v } else { f64::NAN }).collect::<Vec<f64>>();
    let [deposit, peak, speed] = [&deposit, &peak, &speed].map(|layer| masked(layer));
    let gaps = Section { deposit: &deposit, peak_thickness: &peak, peak_speed: &speed, ..figure };
    assert!(drawn("section_gaps", &gaps).rgb == png.rgb);
    let alone = Section { peak_thickness: &[], peak_speed: &[], ..figure };
    assert!(drawn("section_alone", &alone).height < png.height);
}

#[test]
fn histories_share_the_time() {
    let t: Vec<f64> = (0..200).map(|k| 0.5 * f64::from(k)).collect();
    let of = |f: fn(f64) -> f64| -> Vec<f64> { t.iter().map(|&t| f(t)).collect() };
    let mass = of(|t| 1.234e7 * (1.0 + 1e-14 * t.sin()));
    let moving = of(|t| (-t / 30.0).exp());
    let speed = of(|t| 35.0 * (t / 15.0) * (1.0 - t / 15.0).exp());
    let energy = of(|t| 4.2e9 * (t / 15.0).powi(2) * (2.0 - t / 7.5).exp());
    let curve = |y| [Curve { x: &t, y, ..Default::default() }];
    let (a, b, c, d) = (curve(&mass), curve(&moving), curve(&speed), curve(&energy));
    let figure = History {
        title: "From release to rest",
        time: Axis::new("time t", "s"),
        panels: &[
            HistoryPanel { y: Axis::new("mass", "kg"), curves: &a },
            HistoryPanel { y: Axis::new("moving share", ""), curves: &b },
            HistoryPanel { y: Axis::new("greatest speed", "m/s"), curves: &c },
            HistoryPanel { y: Axis::new("kinetic energy", "J"), curves: &d },
        ],
        ..Default::default()
    };
    assert!(drawn("history", &figure).count([0, 114, 178]) > 4 * 1400);
}

#[test]
fn convergence_shows_orders() {
    let dx = [0.1, 0.05, 0.025, 0.0125, 0.00625];
    let first = dx.map(|dx: f64| 0.8 * dx.powf(0.95));
    let second = dx.map(|dx: f64| 1.5 * dx.powf(1.9));
    let figure = Convergence {
        title: "Dam break: error against cell size",
        size: Axis::new("cell size Δx", "m"),
        error: Axis::new("L¹ error of h", "m²"),
        series: &[
            ErrorSeries { name: "first order", sizes: &dx, errors: &first },
            ErrorSeries { name: "second order", sizes: &dx, errors: &second },
        ],
        orders: &[1.0, 2.0],
        ..Default::default()
    };
    let png = drawn("convergence", &figure);
    assert!(png.count([0, 114, 178]) > 1000 && png.count([213, 94, 0]) > 1000);
}

#[test]
fn errors_against_iterations_run_over_decades() {
    let steps: Vec<f64> = (0..3000).map(f64::from).collect();
    let falls = |rate: f64, floor: f64| -> Vec<f64> {
        steps.iter().map(|n| 0.3 * (-rate * n).exp() + floor).collect()
    };
    let (first, second) = (falls(0.01, 0.0), falls(0.02, 3e-4));
    let figure = Profiles {
        title: "Error against iterations",
        subtitle: "Δx = 0.02, λ = 0.45",
        x: Axis::new("iterations", ""),
        y: Axis::new("sup norm of u − ū", "").over(1e-9, 1.0),
        curves: &[
            Curve { name: "first order", x: &steps, y: &first, ..Default::default() },
            Curve { name: "second order", x: &steps, y: &second, style: Style::Dashed, ..Default::default() },
        ],
        logarithmic: [true, true],
        ..Default::default()
    };
    let png = drawn("iterations", &figure);
    assert!(png.count([0, 114, 178]) > 1000 && png.count([213, 94, 0]) > 500);
    let half = Profiles { logarithmic: [false, true], y: Axis::new("error", ""), ..figure };
    assert_ne!(half.draw().unwrap().rgb, png.rgb);
    let none = Curve { x: &[0.0, -1.0], y: &[1.0, 2.0], ..Default::default() };
    assert!(matches!(Profiles { curves: &[none], ..figure }.draw(), Err(FigureError::Empty { .. })));
}

/// A cone in a box, open at one side, with a shaft in the middle: the colour lies in the cells, which leave the hole.
#[test]
fn a_surface_is_painted_by_another_field_and_walled_in() {
    let nodes: Vec<f64> = (0..=30).map(|i| f64::from(i) / 30.0).collect();
    let cone = |x: f64, y: f64| 0.8 * (x - 0.5).hypot(y - 0.5);
    let heights: Vec<f64> = nodes.iter().flat_map(|&y| nodes.iter().map(move |&x| cone(x, y))).collect();
    let centres = range(30, 0.0, 1.0);
    let speed = |x: f64, y: f64| if cone(x, y) < 0.1 { f64::NAN } else { 1.0 - cone(x, y) };
    let paint: Vec<f64> = centres.iter().flat_map(|&y| centres.iter().map(move |&x| speed(x, y))).collect();
    let walls = [[[0.0, 0.0], [1.0, 0.0]], [[1.0, 0.0], [1.0, 1.0]], [[0.0, 1.0], [1.0, 1.0]]];
    let figure = Surface {
        title: "A silo empties",
        x: Axis::new("x", "m"),
        y: Axis::new("y", "m"),
        z: Axis::new("height", "m").over(0.0, 0.65),
        xs: &nodes,
        ys: &nodes,
        values: &heights,
        paint: Some(Paint { values: &paint, quantity: Axis::new("rolling layer v", "m") }),
        colours: Colours::Thickness,
        facets: true,
        walls: &walls,
        elevation: Some(45.0),
        ..Default::default()
    };
    let png = drawn("surface_painted", &figure);
    assert!(png.colours() > 1000);
    let count = |figure: &Surface| {
        let rgb = figure.draw().unwrap().rgb;
        rgb.as_chunks::<3>().0.iter().filter(|p| **p == [246; 3]).count()
    };
    let whole = Surface { paint: None, ..figure };
    assert!(count(&figure) > count(&whole) + 2000, "the floor is seen through the shaft");
    let wrong = Surface { paint: Some(Paint { values: &paint[1..], quantity: Axis::default() }), ..figure };
    assert!(matches!(wrong.draw(), Err(FigureError::Shape { found: 899, .. })));
}

#[test]
fn what_cannot_be_drawn_is_refused_by_name() {
    let curve = Curve { name: "h", x: &[0.0, 1.0], y: &[1.0], ..Default::default() };
    let message =
        Profiles { title: "A", curves: &[curve], ..Default::default() }.draw().unwrap_err().to_string();
    assert!(
        message.contains("`A`") && message.contains("`h`") && message.contains("1 values where 2"),
        "{message}"
    );
    assert!(matches!(Profiles::default().draw(), Err(FigureError::Empty { .. })));
    let short = HeatMap { xs: &[0.0, 1.0], ys: &[0.0, 1.0], values: &[1.0; 3], ..Default::default() };
    assert!(matches!(short.draw(), Err(FigureError::Shape { found: 3, expected: 4, .. })));
    let nan = HeatMap { values: &[f64::NAN; 4], ..short };
    assert!(matches!(nan.draw(), Err(FigureError::Empty { .. })));
    assert!(matches!(Map::default().draw(), Err(FigureError::Empty { .. })));
}

#[test]
fn extremes_do_not_break_the_drawing() {
    let x = [0.0, f64::NAN, 1.0, 2.0, 1e300];
    let y = [f64::INFINITY, 1.0, -1e300, 0.0, 1e300];
    let curve = Curve { x: &x, y: &y, ..Default::default() };
    let figure = Profiles { x: Axis::default().over(0.0, 3.0), curves: &[curve], ..Default::default() };
    figure.draw().unwrap();
    let zero = Curve { x: &[0.0, 1.0], y: &[0.0, 0.0], ..Default::default() };
    Profiles { curves: &[zero], ..Default::default() }.draw().unwrap();
    let flat = [5.0; 6];
    let extent = Extent { nx: 3, ny: 2, west: 0.0, south: 0.0, cell: 1.0 };
    Map { extent, bed: &flat, ..Default::default() }.draw().unwrap();
    Surface { xs: &[0.0, 1.0, 2.0], ys: &[0.0, 1.0], values: &flat, ..Default::default() }.draw().unwrap();
}
