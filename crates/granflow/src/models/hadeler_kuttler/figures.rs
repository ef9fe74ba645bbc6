//! The figures of a sandpile on a table: the pile, what rolls on it, sections, the ledger; the animation.

use super::history::history;
use super::table::TableDomain;
use crate::model::{Drawing, Instants, Line, Scene, View, colour_limit, profiles};
use crate::output;
use crate::output::figures::{
    Axis, Colours, Curve, Figure, FigureError, Frame, HeatMap, History, HistoryPanel, Levels, Outline, Paint,
    Picture, Style, Surface, round_length, short,
};

const STANDING: &str = "standing layer u";
const ROLLING: &str = "rolling layer v";
const WALL: [u8; 3] = [88, 92, 104];

/// Name of the height that is drawn: u on a flat table.
fn height(table: &TableDomain) -> &'static str {
    if table.height.is_empty() { STANDING } else { "surface u + b" }
}

/// The ends of axes and colours: lowest and highest surface, largest rolling layer.
#[derive(Debug, Clone, Copy, Default)]
struct Ranges {
    height: [f64; 2],
    rolling: f64,
}

impl Ranges {
    /// The same, wide enough for these standing and rolling layers too.
    fn widen(&mut self, table: &TableDomain, (standing, rolling): (&[f64], &[f64])) {
        let surface = table.surface(standing);
        let all = || surface.iter().chain(&table.height).copied();
        self.height = [all().fold(self.height[0], f64::min), all().fold(self.height[1], f64::max)];
        let rolls = rolling.iter().copied().filter(|&v| v > 0.0);
        self.rolling =
            if rolls.clone().next().is_some() { self.rolling.max(colour_limit(rolls)) } else { self.rolling };
    }

    /// The axis of the height.
    fn height(&self, label: &'static str) -> Axis<'static> {
        let [low, high] = self.height;
        Axis::new(label, "").over(low, if low < high { high } else { low + 1.0 })
    }

    /// The axis of the rolling layer.
    fn rolling(&self) -> Axis<'static> {
        Axis::new(ROLLING, "").over(0.0, if self.rolling > 0.0 { self.rolling } else { 1.0 })
    }
}

/// The same axis with a little room above the greatest.
fn roomy(axis: Axis<'static>) -> Axis<'static> {
    match axis.range {
        Some([low, high]) => axis.over(low, low + 1.08 * (high - low)),
        None => axis,
    }
}

/// The pile in perspective, the rolling layer as colour on it.
fn pile(
    view: &View,
    table: &TableDomain,
    subtitle: &str,
    (standing, rolling): (&[f64], &[f64]),
    ranges: Ranges,
) -> Result<Picture, FigureError> {
    let (x, y, walls) = (&table.x_node, &table.y_node, table.edges(true));
    // Walls stand a little above the sand, and who looks over them stands higher.
    let elevation = if walls.is_empty() { None } else { Some(45.0) };
    let z = if walls.is_empty() { ranges.height(height(table)) } else { roomy(ranges.height(height(table))) };
    let side = |c: &[f64]| c[c.len() - 1] - c[0];
    let long = side(x).max(side(y));
    let sides = [side(x) / long, side(y) / long];
    Surface {
        title: &view.title,
        subtitle,
        x: Axis::new("x", ""),
        y: Axis::new("y", ""),
        z,
        xs: x,
        ys: y,
        values: &table.surface(standing),
        paint: Some(Paint { values: rolling, quantity: ranges.rolling() }),
        colours: Colours::Thickness,
        facets: true,
        proportions: Some([sides[0].max(0.2), sides[1].max(0.2), 0.45]),
        walls: &walls,
        elevation,
        ..Default::default()
    }
    .draw()
}

/// The figures of a pile on a plane table.
pub(super) fn plane<'a>(view: &'a View, table: &'a TableDomain) -> Vec<Drawing<'a>> {
    let mut drawings = Vec::new();
    let last = (view.series("standing_layer").last(), view.series("rolling_layer").last());
    if let (Some(standing), Some(rolling)) = last {
        let mut ranges = Ranges::default();
        ranges.widen(table, (standing, rolling));
        let most = rolling.iter().copied().fold(0.0, f64::max);
        let clipped = if most > ranges.rolling {
            format!("; v reaches {}, colours end at the value that 0.2 % of the cells exceed", short(most))
        } else {
            String::new()
        };
        let caption = format!("The pile at the end, coloured by the rolling layer{clipped}.");
        drawings.push(Drawing::new("pile", caption, move || {
            pile(view, table, &view.subtitle, (standing, rolling), ranges)
        }));
        let surface = table.surface(standing);
        let [low, high] = ranges.height;
        let interval = round_length(if low < high { (high - low) / 8.0 } else { 1.0 });
        let lines = format!("lines: {} every {}", height(table), short(interval));
        let caption = format!("The rolling layer at the end; {lines}, thick grey: walls{clipped}.");
        let subtitle = format!("{}; {lines}", view.subtitle);
        drawings.push(Drawing::new("rolling_layer", caption, move || {
            above(view, table, &subtitle, (&surface, rolling), ranges, interval)
        }));
        drawings.push(sections(view, table, (standing, rolling)));
    }
    drawings.extend(history(view));
    drawings
}

/// The rolling layer from above, with lines of equal height of the pile, the walls, and the table's open edge.
fn above(
    view: &View,
    table: &TableDomain,
    subtitle: &str,
    (surface, rolling): (&[f64], &[f64]),
    ranges: Ranges,
    interval: f64,
) -> Result<Picture, FigureError> {
    let (walls, open) = (table.edges(true), table.edges(false));
    let open = open.iter().map(|edge| (edge, 1.0, [34, 34, 34]));
    let lines: Vec<_> = open.chain(walls.iter().map(|edge| (edge, 7.0, WALL))).collect();
    let outlines: Vec<Outline> = lines
        .iter()
        .map(|&(points, width, colour)| Outline {
            points,
            width: Some(width),
            colour: Some(colour),
            ..Default::default()
        })
        .collect();
    HeatMap {
        title: &view.title,
        subtitle,
        frame: Frame::Plane,
        x: Axis::new("x", ""),
        y: Axis::new("y", ""),
        xs: &view.x,
        ys: &view.y,
        values: rolling,
        quantity: ranges.rolling(),
        colours: Colours::Thickness,
        levels: Some(Levels { xs: &table.x_node, ys: &table.y_node, values: surface, interval }),
        outlines: &outlines,
    }
    .draw()
}

/// The mean of the two middle rows, which is the middle one where their number is odd.
fn middle(field: &[f64], columns: usize) -> Vec<f64> {
    let rows = field.len() / columns;
    let (a, b) = ((rows - 1) / 2, rows / 2);
    (0..columns).map(|i| 0.5 * (field[a * columns + i] + field[b * columns + i])).collect()
}

/// u and v at the end along x through the middle and, where cells along x and y are as many, from corner to
/// corner.
fn sections<'a>(
    view: &'a View,
    table: &'a TableDomain,
    (standing, rolling): (&'a [f64], &'a [f64]),
) -> Drawing<'a> {
    let square = view.x.len() == view.y.len();
    let and = if square { ", and along the diagonal, against x" } else { "" };
    let caption = format!("Pile and rolling layer at the end along x through the middle of the table{and}.");
    Drawing::new("sections", caption, move || {
        let surface = table.surface(standing);
        let across = |field: &[f64], n: usize| -> Vec<f64> { (0..n).map(|k| field[k * n + k]).collect() };
        let panel = |x: &'a [f64], field: &[f64]| {
            (x, middle(field, x.len()), if square { across(field, x.len()) } else { Vec::new() })
        };
        let parts = [panel(&table.x_node, &surface), panel(&view.x, rolling)];
        let named =
            if square { ["along x, y in the middle", "along the diagonal, against x"] } else { [""; 2] };
        let curves: [Vec<Curve>; 2] = std::array::from_fn(|k| {
            let (x, along, across) = &parts[k];
            let [first, second] = if k == 0 { named } else { [""; 2] }; // one key for both panels
            let mut curves = vec![Curve { name: first, x, y: along, ..Default::default() }];
            if square {
                let style = Style::Dashed;
                curves.push(Curve { name: second, x, y: across, style, ..Default::default() });
            }
            curves
        });
        let [above, below] = [height(table), ROLLING].map(|label| Axis::new(label, ""));
        History {
            title: &view.title,
            subtitle: &view.subtitle,
            time: Axis::new("x", ""),
            panels: &[
                HistoryPanel { y: above, curves: &curves[0] },
                HistoryPanel { y: below, curves: &curves[1] },
            ],
        }
        .draw()
    })
}

/// The figures of a pile on a line.
pub(super) fn line<'a>(view: &'a View, table: &'a TableDomain) -> Vec<Drawing<'a>> {
    let standing = view.series("standing_layer").iter().map(|u| table.surface(u)).collect();
    let walls = table.x_node.iter().zip(&table.wall_x).filter(|(_, wall)| **wall).map(|(x, _)| *x).collect();
    let x = &table.x_node;
    let ends = x.first().zip(x.last()).map(|(&first, &last)| [first, last]);
    let pile = Line {
        x,
        series: standing,
        filled: true,
        ground: (!table.height.is_empty()).then_some(("table", &table.height)),
        walls,
        ends,
    };
    let rolling = view.series("rolling_layer").to_vec();
    let rolling = Line { x: &view.x, series: rolling, filled: true, ends, ..Line::default() };
    let when = "at the start, at two instants between, and at the end";
    let mut drawings = vec![
        profiles(view, ("pile", &format!("The pile {when}.")), height(table), pile),
        profiles(view, ("rolling_layer", &format!("The rolling layer {when}.")), ROLLING, rolling),
    ];
    drawings.extend(history(view));
    drawings
}

/// Pile and rolling layer on a line at one instant, on axes that hold for all.
fn instant(
    view: &View,
    table: &TableDomain,
    subtitle: &str,
    (standing, rolling): (&[f64], &[f64]),
    ranges: Ranges,
) -> Result<Picture, FigureError> {
    let surface = table.surface(standing);
    let x = &table.x_node;
    let mut pile = vec![Curve { x, y: &surface, ..Default::default() }];
    if !table.height.is_empty() {
        pile[0].name = "pile";
        let style = Style::Dashed;
        pile.push(Curve { name: "table", x, y: &table.height, style, colour: Some([110, 110, 110]) });
    }
    let rolls = [Curve { x: &view.x, y: rolling, colour: Some([213, 94, 0]), ..Default::default() }];
    let (above, below) = (roomy(ranges.height(height(table))), roomy(ranges.rolling()));
    History {
        title: &view.title,
        subtitle,
        time: Axis::new("x", ""),
        panels: &[HistoryPanel { y: above, curves: &pile }, HistoryPanel { y: below, curves: &rolls }],
    }
    .draw()
}

/// The pile over time.
pub(super) fn scene<'a>(
    view: &'a View<'a>,
    table: &'a TableDomain,
    instants: &mut Instants<'_>,
) -> Result<Box<dyn Scene + 'a>, output::Error> {
    let mut ranges = Ranges::default();
    for fields in instants {
        ranges.widen(table, pair(&fields?));
    }
    Ok(Box::new(TableScene { view, table, ranges }))
}

struct TableScene<'a> {
    view: &'a View<'a>,
    table: &'a TableDomain,
    ranges: Ranges,
}

impl Scene for TableScene<'_> {
    fn draw(&self, time: f64, fields: &[Vec<f64>]) -> Result<Picture, FigureError> {
        let subtitle = format!("t = {} {}", short(time), self.view.unit("s"));
        let draw = if self.view.dimensions() == 1 { instant } else { pile };
        draw(self.view, self.table, &subtitle, pair(fields), self.ranges)
    }
}

/// Standing and rolling layer of a frame.
fn pair(fields: &[Vec<f64>]) -> (&[f64], &[f64]) {
    let field = |k: usize| fields.get(k).map_or(&[][..], Vec::as_slice);
    (field(0), field(1))
}
