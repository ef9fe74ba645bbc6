//! The figures of a run on a mountain: shaded maps, the section along the path, the history; the animation.

use super::path::{PathLine, path};
use super::terrain::TerrainDomain;
use crate::model::{Drawing, Instants, Scene, View, colour_limit, history, watched};
use crate::output;
use crate::output::figures::{
    Axis, Colours, Extent, Figure, FigureError, Frame, HeatMap, Map, Outline, Overlay, Picture, Relief,
    Section, short,
};
use crate::output::outlines::{Lattice, contour, rings};
use crate::output::style::Style;
use std::sync::Arc;

/// Colour of the release's outline, and of the edge of all that was reached.
const RELEASE: [u8; 3] = [20, 20, 20];
const EDGE: [u8; 3] = [0, 90, 160];
const PATH: [u8; 3] = [0, 120, 80];
/// Stands where a map shows nothing: so low that no interpolation brings it back.
const NOWHERE: f64 = -1e12;

/// What all maps of a run share.
#[derive(Debug)]
struct Background<'a> {
    extent: Extent,
    bed: &'a [f64],
    release: Vec<Vec<[f64; 2]>>,
    footprint: Vec<Vec<[f64; 2]>>,
    /// The thickness from which a layer is drawn.
    drawn: f64,
    path: Option<PathLine>,
}

impl<'a> Background<'a> {
    /// Without the path.
    fn of(view: &View, terrain: &'a TerrainDomain) -> Background<'a> {
        let raster = &*terrain.raster;
        let extent = Extent {
            nx: raster.columns,
            ny: raster.rows,
            west: raster.west,
            south: raster.south,
            cell: raster.cell,
        };
        let outline = |map: &[f64], threshold: f64| {
            rings(&contour(map, Lattice::from(raster), threshold), 4.0 * raster.cell * raster.cell)
        };
        Background {
            extent,
            bed: &raster.values,
            release: outline(&terrain.released(), terrain.release_threshold()),
            footprint: view.map("peak_thickness").map_or(Vec::new(), |map| outline(map, terrain.threshold)),
            drawn: terrain.drawn(),
            path: None,
        }
    }

    /// The lines over a map: release, and, if wanted, the edge of all that was reached and the path.
    fn outlines(&self, edge: bool, along: bool) -> Vec<Outline<'_>> {
        let mut outlines = Vec::new();
        for (k, points) in self.release.iter().enumerate() {
            let name = if k == 0 { "release" } else { "" };
            outlines.push(Outline {
                name,
                points,
                closed: true,
                colour: Some(RELEASE),
                ..Default::default()
            });
        }
        if edge {
            for (k, points) in self.footprint.iter().enumerate() {
                let name = if k == 0 { "reached" } else { "" };
                outlines.push(Outline {
                    name,
                    points,
                    closed: true,
                    dashed: true,
                    colour: Some(EDGE),
                    ..Default::default()
                });
            }
        }
        if let Some(path) = self.path.as_ref().filter(|_| along) {
            let points = &path.points;
            outlines.push(Outline {
                name: "path",
                points,
                dashed: true,
                colour: Some(PATH),
                ..Default::default()
            });
        }
        outlines
    }
}

/// What one map shows over the mountain.
struct Layer<'s> {
    name: &'static str,
    label: String,
    unit: &'static str,
    colours: Colours,
    values: &'s [f64],
    /// Shown is where this is thick.
    thickness: &'s [f64],
    /// The thickness from which a layer is drawn.
    drawn: f64,
    /// The largest value that is shown, and where the colours end.
    most: f64,
    limit: f64,
}

impl Layer<'_> {
    fn is_thickness(&self) -> bool {
        matches!(self.name, "peak_thickness" | "deposit")
    }

    fn threshold(&self) -> f64 {
        if self.is_thickness() { self.drawn } else { -0.5 }
    }

    /// The values as they are shown, while they are. Films are fast and thin: a figure shows what a person would
    /// see.
    fn shown(&self) -> Vec<f64> {
        let value = |(&v, &h): (&f64, &f64)| match v {
            _ if self.is_thickness() => v,
            v if h > self.drawn && v.is_finite() => v,
            _ => NOWHERE,
        };
        self.values.iter().zip(self.thickness).map(value).collect()
    }

    /// Find its range.
    fn ranged(mut self) -> Self {
        let shown = self.shown();
        let least = if self.is_thickness() { self.drawn } else { 0.0 };
        self.limit = colour_limit(shown.iter().copied().filter(|&v| v > least));
        self.most = shown.iter().fold(0.0_f64, |most, v| most.max(*v));
        self
    }

    fn outlines<'a>(&self, ground: &'a Background) -> Vec<Outline<'a>> {
        ground.outlines(self.name == "deposit", self.name == "deposit")
    }

    /// Its map of what is shown, without words and relief.
    fn map<'a>(&'a self, shown: &'a [f64], ground: &'a Background, outlines: &'a [Outline]) -> Map<'a> {
        let most = if self.limit > 0.0 { self.limit } else { 1.0 };
        let overlay = Overlay {
            values: shown,
            quantity: Axis::new(&self.label, self.unit).over(0.0, most),
            threshold: self.threshold(),
            colours: self.colours,
        };
        Map { extent: ground.extent, bed: ground.bed, overlay: Some(overlay), outlines, ..Default::default() }
    }
}

/// The maps that figures show: name, label, unit, colours.
const SHOWN: [(&str, &str, &str, Colours); 10] = [
    ("peak_thickness", "greatest thickness", "m", Colours::Thickness),
    ("deposit", "deposit", "m", Colours::Thickness),
    ("peak_speed", "greatest speed", "m/s", Colours::Speed),
    ("peak_pressure", "greatest pressure", "kPa", Colours::Speed),
    ("arrival_time", "arrival time", "s", Colours::Viridis),
    ("duration_thickness", "time above the thickness", "s", Colours::Viridis),
    ("duration_speed", "time above the speed", "s", Colours::Viridis),
    ("duration_pressure", "time above the pressure", "s", Colours::Viridis),
    ("eroded_depth", "eroded depth", "m", Colours::Thickness),
    ("forest_broken", "time at which the forest broke", "s", Colours::Viridis),
];

/// The layers of the maps that there are, each with its range; `label` says what a map shows, where it knows more than its name.
fn layers<'a>(
    map: &dyn Fn(&str) -> Option<&'a [f64]>,
    peak: &'a [f64],
    terrain: &TerrainDomain,
    label: &dyn Fn(&str) -> Option<String>,
) -> Vec<Layer<'a>> {
    let layer = |(name, usual, unit, colours): (&'static str, &'static str, &'static str, Colours)| {
        let values = map(name)?;
        let label = label(name).unwrap_or_else(|| usual.to_owned());
        let thickness = if name == "deposit" { values } else { peak };
        let (drawn, most, limit) = (terrain.drawn(), 0.0, 0.0);
        Some(Layer { name, label, unit, colours, values, thickness, drawn, most, limit }.ranged())
    };
    SHOWN.into_iter().filter_map(layer).collect()
}

/// The colours of the maps, as the figures have them.
pub(super) fn styles<'a>(
    map: &dyn Fn(&str) -> Option<&'a [f64]>,
    terrain: &TerrainDomain,
) -> Vec<(&'static str, Style)> {
    let Some(peak) = map("peak_thickness") else { return Vec::new() };
    let style = |layer: Layer| {
        let high = if layer.limit > 0.0 { layer.limit } else { 1.0 };
        let (label, unit) = (layer.label.clone(), layer.unit.to_owned());
        let above = layer.threshold();
        (layer.name, Style { label, unit, colours: layer.colours, above, range: [0.0, high] })
    };
    layers(map, peak, terrain, &|_| None).into_iter().map(style).collect()
}

/// All figures of a run on a mountain.
pub(super) fn figures<'a>(view: &'a View<'a>, terrain: &'a TerrainDomain) -> Vec<Drawing<'a>> {
    let Some(peak) = view.map("peak_thickness") else { return Vec::new() };
    let ground = Arc::new(Background { path: path(view, terrain), ..Background::of(view, terrain) });
    let layers = layers(&|name| view.map(name), peak, terrain, &|name| view.time_above(name));
    // Before the maps are drawn side by side: most of them show the same box of the mountain.
    let relief = layers
        .first()
        .and_then(|layer| layer.map(&layer.shown(), &ground, &layer.outlines(&ground)).mountain().ok());
    let relief = Arc::new(relief);
    let mut drawings: Vec<Drawing> =
        layers.into_iter().map(|layer| map(view, layer, ground.clone(), relief.clone())).collect();
    if let (true, Some(deposit), Some(speed)) =
        (ground.path.is_some(), view.map("deposit"), view.map("peak_speed"))
    {
        drawings.push(section(view, ground, [deposit, peak, speed]));
    }
    drawings.extend(range_time(view));
    drawings.extend(watched(view));
    drawings.extend(history(view));
    drawings
}

/// What passed along the path, over time.
fn range_time<'a>(view: &'a View<'a>) -> Vec<Drawing<'a>> {
    let Some(along) = &view.along else { return Vec::new() };
    let drawing = |(name, label, unit, values, colours): (_, &'static str, _, &'a [f64], _)| {
        let near =
            along.width.map_or("near".to_owned(), |width| format!("within {} m of", short(0.5 * width)));
        let what = format!("largest {label} {near} the path");
        let caption = format!(
            "The {what} at every instant of the series: time from left to right, distance from the begin of the path upwards; white \
             where nothing is thicker than the threshold."
        );
        Drawing::new(name, caption, move || {
            HeatMap {
                title: &view.title,
                subtitle: &format!("{what}; {}", view.subtitle),
                frame: Frame::TimeSpace,
                x: Axis::new("time t", view.unit("s")),
                y: Axis::new("distance along the path", "m"),
                xs: &along.times,
                ys: &along.distance,
                values,
                quantity: Axis::new(label, unit),
                colours,
                ..Default::default()
            }
            .draw()
        })
    };
    let thickness = ("range_time", "thickness", "m", &along.thickness[..], Colours::Thickness);
    let speed = ("range_time_speed", "speed", "m/s", &along.speed[..], Colours::Speed);
    vec![drawing(thickness), drawing(speed)]
}

/// The map of a layer.
fn map<'a>(
    view: &'a View<'a>,
    layer: Layer<'a>,
    ground: Arc<Background<'a>>,
    relief: Arc<Option<Relief>>,
) -> Drawing<'a> {
    let Layer { name, unit, drawn, most, limit, .. } = layer;
    let label = layer.label.clone();
    let clipped = if limit < most { ", colours end at the value that 0.2 % of the cells exceed" } else { "" };
    let of = if name == "deposit" { "where it is" } else { "where the flow was" };
    let nowhere = !layer.shown().iter().any(|value| *value > layer.threshold());
    let largest = format!("largest {} {unit}{clipped}", short(most));
    let what = format!("{label}, {}", if nowhere { "nowhere" } else { &largest });
    let subtitle = format!("{what}; {}", view.subtitle);
    let lines = "; dashed: the edge of all that was reached, and the path of the section";
    let lines = if name == "deposit" { lines } else { "" };
    let mut caption = format!("{what}; shown {of} thicker than {drawn} m{lines}.");
    caption[..1].make_ascii_uppercase();
    Drawing::new(name, caption, move || {
        let (outlines, shown) = (layer.outlines(&ground), layer.shown());
        let map = layer.map(&shown, &ground, &outlines);
        Map { title: &view.title, subtitle: &subtitle, relief: relief.as_ref().as_ref(), ..map }.draw()
    })
}

/// The section along the path, from the maps of deposit, peak thickness and peak speed.
fn section<'a>(view: &'a View<'a>, ground: Arc<Background<'a>>, maps: [&'a [f64]; 3]) -> Drawing<'a> {
    let caption = "Section along the path: from the highest released cell to the farthest one reached, where \
                   greatest thickness times greatest speed is largest. The layers are drawn thicker than they \
                   are, as stated; the ground has its true height.";
    Drawing::new("section", caption, move || {
        let Some(path) = &ground.path else { return Section::default().draw() };
        let along = |map: &[f64]| path.cells.iter().map(|&k| map[k]).collect::<Vec<f64>>();
        let [deposit, peak_thickness, peak_speed] = maps.map(along);
        Section {
            title: &view.title,
            subtitle: "along the path of the greatest flow, from the highest release to the farthest reach",
            distance: &path.distance,
            bed: &along(ground.bed),
            deposit: &deposit,
            peak_thickness: &peak_thickness,
            peak_speed: &peak_speed,
            exaggeration: None,
        }
        .draw()
    })
}

/// The thickness on a mountain over time.
pub(super) fn scene<'a>(
    view: &'a View<'a>,
    terrain: &'a TerrainDomain,
    instants: &mut Instants<'_>,
) -> Result<Box<dyn Scene + 'a>, output::Error> {
    let drawn = terrain.drawn();
    let reached = view.map("peak_thickness").map(|peak| peak.iter().copied().filter(|&h| h > drawn));
    let most = reached.map_or(0.0, colour_limit);
    let limit = if most > 0.0 { most } else { 1.0 };
    let mut scene = TerrainScene { view, ground: Background::of(view, terrain), limit, relief: None };
    if let Some(first) = instants.next() {
        let (first, outlines) = (first?, scene.ground.outlines(true, false));
        scene.relief = scene.map(&first, &outlines).mountain().ok();
    }
    Ok(Box::new(scene))
}

struct TerrainScene<'a> {
    view: &'a View<'a>,
    ground: Background<'a>,
    /// Greatest thickness that the colours tell apart.
    limit: f64,
    /// The mountain under all pictures.
    relief: Option<Relief>,
}

impl TerrainScene<'_> {
    /// The thickness at an instant, without words and relief.
    fn map<'b>(&'b self, fields: &'b [Vec<f64>], outlines: &'b [Outline]) -> Map<'b> {
        let overlay = Overlay {
            values: fields.first().map_or(&[], Vec::as_slice),
            quantity: Axis::new("thickness h", self.view.unit("m")).over(0.0, self.limit),
            threshold: self.ground.drawn,
            colours: Colours::Thickness,
        };
        let Background { extent, bed, .. } = self.ground;
        Map { extent, bed, overlay: Some(overlay), outlines, ..Default::default() }
    }
}

impl Scene for TerrainScene<'_> {
    fn draw(&self, time: f64, fields: &[Vec<f64>]) -> Result<Picture, FigureError> {
        let subtitle = format!("t = {} {}", short(time), self.view.unit("s"));
        let outlines = self.ground.outlines(true, false);
        let map = self.map(fields, &outlines);
        Map { title: &self.view.title, subtitle: &subtitle, relief: self.relief.as_ref(), ..map }.draw()
    }
}
