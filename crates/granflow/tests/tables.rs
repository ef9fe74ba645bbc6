//! Made-up sandpiles on tables of every shape: each file opens and holds what the run left. The pictures stay in
//! `target/tmp/tables`.

use granflow::models::hadeler_kuttler::TableDomain;
use granflow::output::Precision;
use granflow::output::frames::Frames;
use granflow::output::ledger::{Entry, Ledger};
use granflow::output::summary::{StopReason, Summary};
use granflow::results::{Finished, Plane, Story};
use netcdf_reader::NcFile;
use std::fs;
use std::path::{Path, PathBuf};

/// The instants of the frames.
const TIMES: [f64; 4] = [0.0, 0.5, 1.0, 2.0];

/// A table of `n` by `n` cells on the unit square; `wall` says which faces are walls by their middles.
fn table(n: usize, inside: impl Fn(f64, f64) -> bool, wall: impl Fn(f64, f64) -> bool) -> Plane {
    let size = 1.0 / n as f64;
    let centres: Vec<f64> = (0..n).map(|i| (i as f64 + 0.5) * size).collect();
    let nodes: Vec<f64> = (0..=n).map(|i| i as f64 * size).collect();
    let over = |ys: &[f64], xs: &[f64], f: &dyn Fn(f64, f64) -> bool| -> Vec<bool> {
        ys.iter().flat_map(|&y| xs.iter().map(move |&x| f(x, y))).collect()
    };
    let table = TableDomain {
        inside: over(&centres, &centres, &inside),
        wall_x: over(&centres, &nodes, &wall),
        wall_y: over(&nodes, &centres, &wall),
        x_node: nodes.clone(),
        y_node: nodes,
        height: Vec::new(),
    };
    table.plane(centres.clone(), centres)
}

/// The distance to the open edges on the nodes of a plane table, by Gauss-Seidel sweeps of the eikonal equation.
fn distance(plane: &Plane, open: impl Fn(f64, f64) -> bool) -> Vec<f64> {
    let table = plane.domain.get::<TableDomain>().unwrap();
    let (n, size) = (table.x_node.len(), table.x_node[1]);
    let mut on = vec![0.0; n * n];
    table.blank(&mut on);
    let mut u = vec![f64::INFINITY; n * n];
    for k in 0..n * n {
        let (x, y) = (table.x_node[k % n], table.y_node[k / n]);
        let beside = |di: isize, dj: isize| {
            let (i, j) = ((k % n) as isize + di, (k / n) as isize + dj);
            let within = (0..n as isize - 1).contains(&i) && (0..n as isize - 1).contains(&j);
            !(within && table.inside[j as usize * (n - 1) + i as usize])
        };
        let edge = beside(-1, -1) || beside(0, -1) || beside(-1, 0) || beside(0, 0);
        if on[k].is_nan() {
            u[k] = f64::NAN;
        } else if edge && open(x, y) {
            u[k] = 0.0;
        }
    }
    let least = |a: f64, b: f64| if a < b || b.is_nan() { a } else { b };
    for _ in 0..2 * n {
        let before = u.clone();
        for k in 0..n * n {
            let at = |di: isize, dj: isize| {
                let (i, j) = ((k % n) as isize + di, (k / n) as isize + dj);
                let within = (0..n as isize).contains(&i) && (0..n as isize).contains(&j);
                if within { before[j as usize * n + i as usize] } else { f64::INFINITY }
            };
            let (a, b) = (least(at(-1, 0), at(1, 0)), least(at(0, -1), at(0, 1)));
            let (a, b) = (least(f64::INFINITY, a), least(f64::INFINITY, b));
            let new = if (a - b).abs() >= size {
                a.min(b) + size
            } else {
                0.5 * (a + b + (2.0 * size * size - (a - b) * (a - b)).sqrt())
            };
            if !u[k].is_nan() && new < u[k] {
                u[k] = new;
            }
        }
    }
    u
}

/// A run in which the pile grows in proportion to the time, and what rolls is thickest where the pile is lowest.
fn run(name: &str, plane: Plane, full: &[f64], files: &[&str]) -> Finished {
    let directory = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("tables").join(name);
    let _ = fs::remove_dir_all(&directory);
    fs::create_dir_all(&directory).unwrap();
    let table = plane.domain.get::<TableDomain>().unwrap();
    let columns = table.x_node.len();
    let cells = plane.x.len() * plane.y.len().max(1);
    let most = full.iter().copied().filter(|u| u.is_finite()).fold(0.0, f64::max);
    let mut rolling: Vec<f64> = (0..cells)
        .map(|k| {
            let (i, j) = (k % plane.x.len(), k / plane.x.len());
            let below = j * columns + i;
            let above = if plane.y.is_empty() { below } else { below + columns };
            0.5 * (most - 0.25 * (full[below] + full[below + 1] + full[above] + full[above + 1]))
        })
        .collect();
    table.blank(&mut rolling);
    let mut frames = Frames::create(&directory.join("frames.bin"), Precision::F64, plane.series()).unwrap();
    let mut ledger = Ledger::create(&directory.join("mass.csv"), plane.outlets()).unwrap();
    for (k, time) in TIMES.into_iter().enumerate() {
        let mut standing: Vec<f64> = full.iter().map(|u| u * (time / TIMES[3]).sqrt()).collect();
        table.blank(&mut standing);
        let rolling: Vec<f64> = rolling.iter().map(|v| v * (3.0 * time).tanh()).collect();
        frames.append(time, &[&standing, &rolling]).unwrap();
        let out = [0.02, 0.02, 0.03, 0.0, 0.01].map(|rate| rate * time * time);
        let entry = Entry {
            time,
            step: k as u64,
            mass: 0.1 * time.sqrt(),
            mass_in: 0.5 * time,
            out,
            wet_cells: cells as u64,
            moving_cells: cells as u64,
            max_speed: f64::NAN,
            kinetic_energy: f64::NAN,
            ..Entry::default()
        };
        ledger.append(entry).unwrap();
    }
    let summary = Summary {
        title: format!("A sandpile on a table: {name}"),
        model: "hadeler_kuttler".to_owned(),
        scheme: "adaptive".to_owned(),
        cells: cells as u64,
        steps: 3,
        time: TIMES[3],
        stop_reason: StopReason::Steady,
        stopping_time: None,
        threshold: None,
        mass_initial: 0.0,
        mass_final: 0.1,
        mass_in: 1.0,
        mass_out: 0.3,
        mass_error: 0.0,
        film_volume: f64::NAN,
        max_speed_final: f64::NAN,
        max_speed: f64::NAN,
        runout: None,
        reach_angle: None,
        wall_seconds: 1.0,
        stepping_seconds: 0.5,
        cell_updates_per_second: 1.0,
        threads: 1,
        version: "0".to_owned(),
        warnings: Vec::new(),
        extra: serde_json::Map::new(),
    };
    let mut source = vec![0.5; cells];
    table.blank(&mut source);
    Finished {
        series: [None, None],
        folder: None,
        directory,
        files: granflow::file_kinds().iter().filter(|kind| files.contains(&kind.name)).copied().collect(),
        case: "title = \"made up\"\n".to_owned(),
        case_text: String::new(),
        maps: vec![("source", source)],
        frames,
        ledger: ledger.entries().to_vec(),
        path: None,
        path_width: 0.0,
        history: vec!["test".to_owned()],
        summary,
        plane,
    }
}

const ALL: [&str; 4] = ["figures", "csv", "vtk", "animation"];

fn square() -> Finished {
    let plane = table(40, |_, _| true, |_, _| false);
    let full = distance(&plane, |_, _| true);
    run("square", plane, &full, &ALL)
}

/// A line with a wall at its right end, on a table that bends up there.
fn line() -> Finished {
    let nodes: Vec<f64> = (0..=50).map(|i| f64::from(i) / 50.0).collect();
    let centres: Vec<f64> = (0..50).map(|i| (f64::from(i) + 0.5) / 50.0).collect();
    let height: Vec<f64> = nodes.iter().map(|x| 0.2 * x * x).collect();
    let full: Vec<f64> = nodes.iter().zip(&height).map(|(x, b)| x - b).collect();
    let mut wall_x = vec![false; 51];
    wall_x[50] = true;
    let table =
        TableDomain { x_node: nodes, inside: vec![true; 50], height, wall_x, ..TableDomain::default() };
    run("line", table.plane(centres, Vec::new()), &full, &ALL)
}

/// Width, height and number of pictures of a PNG whose pixels are not all alike.
fn picture(path: &Path) -> (u32, u32, u32) {
    let file = std::io::BufReader::new(fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut rgb).unwrap();
    let mut colours = rgb.as_chunks::<3>().0.to_vec();
    colours.sort_unstable();
    colours.dedup();
    assert!(colours.len() > 20, "{}: {} colours", path.display(), colours.len());
    let info = reader.info();
    (info.width, info.height, info.animation_control().map_or(1, |film| film.num_frames))
}

#[test]
fn every_file_of_a_square_table_opens_and_holds_the_pile() {
    let run = square();
    run.write_result().unwrap();
    let written = run.write_files().unwrap();
    assert!(written.iter().all(|path| path.exists()), "{written:?}");
    let out = |name: &str| run.directory.join(name);
    for name in ["pile", "rolling_layer", "sections", "history"] {
        let (width, height, pictures) = picture(&out(&format!("figures/{name}.png")));
        assert!(width > 500 && height > 500 && pictures == 1, "{name}");
    }
    assert_eq!(picture(&out("animation.png")).2, 4);

    let file = NcFile::open(run.result()).unwrap();
    let (standing, rolling) = (
        file.read_variable::<f64>("standing_layer").unwrap(),
        file.read_variable::<f64>("rolling_layer").unwrap(),
    );
    assert_eq!((standing.shape(), rolling.shape()), (&[4, 41, 41][..], &[4, 40, 40][..]));
    let names = |name: &str| -> Vec<String> {
        file.variable(name).unwrap().dimensions.iter().map(|dimension| dimension.name.clone()).collect()
    };
    assert_eq!(names("standing_layer"), ["time", "y_node", "x_node"]);
    assert_eq!(names("rolling_layer"), ["time", "y", "x"]);
    assert_eq!(names("source"), ["y", "x"]);
    let mut frames = Frames::open(run.frames.path()).unwrap().0;
    for (k, time) in TIMES.iter().enumerate() {
        let (u, v) = (frames.read(k, 0).unwrap(), frames.read(k, 1).unwrap());
        assert!(standing.index_axis(ndarray::Axis(0), k).iter().eq(u.iter()), "t = {time}");
        assert!(rolling.index_axis(ndarray::Axis(0), k).iter().eq(v.iter()), "t = {time}");
    }
    assert!(file.variable("table_height").is_err(), "a flat table has no height");

    let lines =
        |name: &str| fs::read_to_string(out(name)).unwrap().lines().map(str::to_owned).collect::<Vec<_>>();
    let (cells, nodes) = (lines("maps.csv"), lines("maps_node.csv"));
    assert_eq!((cells.len(), nodes.len()), (1 + 40 * 40, 1 + 41 * 41));
    assert_eq!(
        (cells[0].as_str(), nodes[0].as_str()),
        ("x,y,rolling_layer,source", "x_node,y_node,standing_layer")
    );
    assert!(lines("mass.csv")[0].contains("mass_out_hole") && lines("mass.csv")[1].ends_with(",,"));
    let frame = fs::read_to_string(out("vtk/frame_0003.vti")).unwrap();
    let (points, cells) = frame.split_once("</PointData>").unwrap();
    assert!(points.contains("standing_layer") && cells.contains("rolling_layer") && cells.contains("source"));
}

#[test]
fn every_file_of_a_line_opens_and_holds_the_pile() {
    let run = line();
    run.write_result().unwrap();
    run.write_files().unwrap();
    for name in ["pile", "rolling_layer", "history"] {
        picture(&run.figures().join(format!("{name}.png")));
    }
    assert_eq!(picture(&run.directory.join("animation.png")).2, 4);
    let file = NcFile::open(run.result()).unwrap();
    let shape = |name: &str| file.read_variable::<f64>(name).unwrap().shape().to_vec();
    assert_eq!((shape("standing_layer"), shape("rolling_layer")), (vec![4, 51], vec![4, 50]));
    assert_eq!((shape("table_height"), shape("wall_x"), shape("source")), (vec![51], vec![51], vec![50]));
    let table = |name: &str| fs::read_to_string(run.directory.join(name)).unwrap();
    let (cells, nodes) = (table("profiles.csv"), table("profiles_node.csv"));
    assert_eq!((cells.lines().count(), nodes.lines().count()), (1 + 4 * 50, 1 + 4 * 51));
    assert!(cells.starts_with("time,x,rolling_layer\n") && nodes.starts_with("time,x_node,standing_layer\n"));
}

/// Ring, L and slit: holes in the table, walls outside and inside it.
#[test]
fn tables_of_any_shape_are_drawn_the_same_from_run_and_file() {
    let disc = table(40, |x, y| (x - 0.5).hypot(y - 0.5) < 0.48, |_, _| false);
    let hole = table(40, |x, y| (x - 0.5).hypot(y - 0.5) > 0.1, |x, y| (x - 0.5).hypot(y - 0.5) > 0.3);
    let low = |x: f64, y: f64| x < 1e-9 || y < 1e-9;
    let corner = table(40, |x, y| x < 0.5 || y < 0.5, low);
    let open = |_: f64, _: f64| true;
    let full = [
        distance(&disc, open),
        distance(&hole, |x, y| (x - 0.5).hypot(y - 0.5) < 0.3),
        distance(&corner, |x, y| !low(x, y) || (x > 0.999 && y < 1e-9) || (y > 0.999 && x < 1e-9)),
    ];
    for ((name, plane), full) in [("disc", disc), ("hole", hole), ("corner", corner)].into_iter().zip(&full) {
        let run = run(name, plane, full, &["figures"]);
        run.write_result().unwrap();
        run.write_files().unwrap();
        let again = run.directory.join("again");
        let figures = Story::read(&run.result()).unwrap().draw(&again).unwrap();
        assert_eq!(figures.len(), 4, "{name}");
        for figure in figures {
            picture(&figure.path);
            let file = figure.path.file_name().unwrap();
            let first = fs::read(run.figures().join(file)).unwrap();
            assert!(fs::read(&figure.path).unwrap() == first, "{name}: {file:?}");
        }
    }
}
