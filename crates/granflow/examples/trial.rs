//! Trial: avaKot.
use granflow::grid::Grid;
use granflow::savage_hutter::{Flow, balanced::Balanced, friction::Coulomb, ground::Terrain};
use granflow::scheme::Boundary;
use granflow::simulation::*;
use granflow::time::*;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let len: f64 = args[1].parse().unwrap();
    let second = args.get(2).map(|s| s == "2").unwrap_or(false);
    let end: f64 = args.get(3).map(|s| s.parse().unwrap()).unwrap_or(300.0);
    let text = std::fs::read_to_string("/work/shared/data/avaKot/dem.asc").unwrap();
    let mut tok = text.split_whitespace();
    let mut head = std::collections::HashMap::new();
    for _ in 0..6 {
        let k = tok.next().unwrap().to_lowercase();
        head.insert(k, tok.next().unwrap().parse::<f64>().unwrap());
    }
    let (nx, ny) = (head["ncols"] as usize, head["nrows"] as usize);
    let dx = head["cellsize"];
    let (x0, y0) = (head["xllcorner"], head["yllcorner"]);
    let mut b = vec![f64::NAN; nx * ny];
    for j in 0..ny {
        for i in 0..nx {
            let v: f64 = tok.next().unwrap().parse().unwrap();
            if v > -9000.0 {
                b[(ny - 1 - j) * nx + i] = v;
            }
        }
    }
    let rel: Vec<f64> = std::fs::read("/tmp/release.bin")
        .unwrap()
        .chunks(8)
        .map(|c| f64::from_le_bytes(c.try_into().unwrap()))
        .collect();
    // geometry by least squares quadratic
    let m = ((len / (2.0 * dx)).round() as isize).max(1);
    let at = |i: isize, j: isize| {
        if i < 0 || j < 0 || i >= nx as isize || j >= ny as isize {
            f64::NAN
        } else {
            b[j as usize * nx + i as usize]
        }
    };
    let g = 9.81;
    let mut grounds = vec![Terrain::<2, f64>::nothing(); nx * ny];
    for j in 0..ny as isize {
        for i in 0..nx as isize {
            let z = at(i, j);
            if z.is_nan() {
                continue;
            }
            let mut a = [[0.0f64; 7]; 6];
            let mut n = 0;
            for dj in -m..=m {
                for di in -m..=m {
                    let v = at(i + di, j + dj);
                    if v.is_nan() {
                        continue;
                    }
                    n += 1;
                    let (x, y) = (di as f64, dj as f64);
                    let r = [1.0, x, y, x * x / 2.0, x * y, y * y / 2.0];
                    for p in 0..6 {
                        for q in 0..6 {
                            a[p][q] += r[p] * r[q];
                        }
                        a[p][6] += r[p] * (v - z);
                    }
                }
            }
            let mut c = [0.0; 6];
            let mut ok = n >= 6;
            if ok {
                for p in 0..6 {
                    let mut best = p;
                    for q in p..6 {
                        if a[q][p].abs() > a[best][p].abs() {
                            best = q;
                        }
                    }
                    a.swap(p, best);
                    if a[p][p].abs() < 1e-9 {
                        ok = false;
                        break;
                    }
                    for q in 0..6 {
                        if q != p {
                            let f = a[q][p] / a[p][p];
                            for k in p..7 {
                                a[q][k] -= f * a[p][k];
                            }
                        }
                    }
                }
                if ok {
                    for p in 0..6 {
                        c[p] = a[p][6] / a[p][p];
                    }
                }
            }
            if !ok {
                let d = |p: f64, q: f64| {
                    if p.is_nan() && q.is_nan() {
                        0.0
                    } else if p.is_nan() {
                        q - z
                    } else if q.is_nan() {
                        z - p
                    } else {
                        (q - p) / 2.0
                    }
                };
                c = [0.0, d(at(i - 1, j), at(i + 1, j)), d(at(i, j - 1), at(i, j + 1)), 0.0, 0.0, 0.0];
            }
            let slope = [c[1] / dx, c[2] / dx];
            let cos = 1.0 / (1.0 + slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
            let h = [c[3] / dx / dx, c[4] / dx / dx, c[5] / dx / dx];
            grounds[j as usize * nx + i as usize] = Terrain {
                level: g * z,
                slope,
                cos,
                fall: g * cos,
                curvature: {
                    let o = if std::env::var("OFF").is_ok() { 0.0 } else { cos };
                    [[o * h[0], o * h[1]], [o * h[1], o * h[2]]]
                },
                bend: [0.0; 2],
            };
        }
    }
    let old = grounds.clone();
    for j in 1..ny - 1 {
        for i in 1..nx - 1 {
            let k = j * nx + i;
            if old[k].cos == 0.0 {
                continue;
            }
            for (axis, step) in [(0, 1), (1, nx)] {
                let (lo, hi) = (&old[k - step], &old[k + step]);
                if lo.cos == 0.0 || hi.cos == 0.0 {
                    continue;
                }
                let beta = |t: &Terrain<2, f64>| t.fall * t.cos * (1.0 - (t.cos * t.slope[axis]).powi(2));
                let s = old[k].cos * old[k].slope[axis];
                grounds[k].bend[axis] = (beta(hi) - beta(lo)) / (4.0 * dx)
                    - (1.0 - s * s) * (hi.fall * hi.cos - lo.fall * lo.cos) / (2.0 * dx);
            }
        }
    }
    let grid = Grid { cells: [nx, ny], origin: [x0, y0], size: [dx, dx], boundary: [[Boundary::Open; 2]; 2] };
    let f = Coulomb { mu: 0.4 };
    let scheme = if second { Balanced::second(f, 1e-6) } else { Balanced::first(f, 1e-6) };
    let t0 = std::time::Instant::now();
    let mut sim = Simulation::new(
        scheme,
        grid,
        if second { SSP_RK2 } else { EULER },
        StepSize::Courant(if second { 0.45 } else { 0.9 }),
        |i| grounds[i[1] * nx + i[0]],
        |i| {
            let k = i[1] * nx + i[0];
            Flow::still(if grounds[k].cos > 0.0 { rel[k] / grounds[k].cos } else { 0.0 })
        },
    );
    sim.maps = Some(granflow::observe::Maps::new(sim.layout()));
    let v0 = sim.totals().volume;
    println!("setup {:?} volume {v0}", t0.elapsed());
    let mut report = 10.0;
    let t1 = std::time::Instant::now();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    pool.install(|| {
    while sim.time() < end {
        if std::env::var("DUMP").is_ok_and(|d| sim.time() > d.parse().unwrap()) { 
        for k in 0..nx*ny { let i = grid.index(k); let s = sim.state(i); if s.q != [0.0;2] || (std::env::var("HELDALL").is_ok() && false) { let g0=grounds[k]; let e=|d:usize|{ (grounds[d].level+grounds[d].fall*grounds[d].cos*sim.state(grid.index(d)).h)/9.81 }; let e0=e(k);
          println!("({},{}) h {:.2e} u {:.3} {:.3} slope {:.2} {:.2} | de xl {:.3} xh {:.3} yl {:.3} yh {:.3} | h {:.1e} {:.1e} {:.1e} {:.1e}", i[0],i[1], s.h, s.q[0]/s.h, s.q[1]/s.h, g0.slope[0],g0.slope[1], e(k-1)-e0,e(k+1)-e0,e(k-nx)-e0,e(k+nx)-e0, sim.state(grid.index(k-1)).h, sim.state(grid.index(k+1)).h, sim.state(grid.index(k-nx)).h, sim.state(grid.index(k+nx)).h); } }
        if std::env::var("DUMP").is_ok() { break; } }
    if let Err(e) = sim.advance(end) { println!("{e}"); break; }
        if sim.time() >= report || sim.at_rest() { let t = sim.totals(); println!("t {:.2} step {} speed {:.3} moving {} wet {} energy {:.3e} wall {:?}", sim.time(), sim.step(), t.speed, t.moving, t.wet, t.energy, t1.elapsed()); report += 10.0; }
        if sim.at_rest() { println!("AT REST"); break; }
    } });
    let wall = t1.elapsed().as_secs_f64();
    let t = sim.totals();
    let out: f64 = sim.out().iter().sum();
    let maps = sim.maps.as_ref().unwrap();
    let (mut cx, mut cy, mut v, mut rx, mut ry, mut rv) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    for k in 0..nx * ny {
        let i = grid.index(k);
        let c = grid.centre(i);
        let h = sim.state(i).h;
        cx += h * c[0];
        cy += h * c[1];
        v += h;
        let r = if grounds[k].cos > 0.0 { rel[k] / grounds[k].cos } else { 0.0 };
        rx += r * c[0];
        ry += r * c[1];
        rv += r;
    }
    let (rx, ry) = (rx / rv, ry / rv);
    let (mut far, mut ever, mut pt, mut ps, mut area, mut maxdep) = (0.0f64, 0, 0.0f64, 0.0f64, 0.0, 0.0f64);
    for k in 0..nx * ny {
        let i = grid.index(k);
        let c = grid.centre(i);
        let p = sim.place(i);
        let th = maps.peak_thickness[p];
        pt = pt.max(th);
        if th > 0.1 {
            ps = ps.max(maps.peak_speed[p]);
            area += dx * dx;
            far = far.max(((c[0] - rx).powi(2) + (c[1] - ry).powi(2)).sqrt());
        }
        if !maps.stopping_time[p].is_nan() {
            ever += 1;
        }
        maxdep = maxdep.max(sim.watch(i).thickness);
    }
    println!(
        "len {len} order {} time {:.2} steps {} err {:.2e} film {:.2e} ever {ever} ps {ps:.2} pt {pt:.2} dep {maxdep:.2} area {area:.0} far {far:.0} centroid {:.1} {:.1} out {out:.2e} Mcups {:.2} wall {wall:.2}",
        if second { 2 } else { 1 },
        sim.time(),
        sim.step(),
        (t.volume + out - v0) / v0,
        t.film / v0,
        cx / v,
        cy / v,
        sim.updates() as f64 / wall / 1e6
    );
}
