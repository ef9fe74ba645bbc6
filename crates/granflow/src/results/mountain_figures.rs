//! The figures of a run on a mountain: shaded maps, the section along the path, the history.

use super::drawing::Drawing;
use super::outlines::{lattice, release_threshold, rings};
use super::path::{PathLine, REACHED, path};
use super::story::Story;
use crate::output::figures::{Axis, Colours, Extent, Figure, Map, Outline, Overlay, Section, short};
use crate::output::outlines::contour;
use std::sync::Arc;

/// Colour of the release's outline, and of the edge of all that was reached.
const RELEASE: [u8; 3] = [20, 20, 20];
const EDGE: [u8; 3] = [0, 90, 160];
const PATH: [u8; 3] = [0, 120, 80];
/// Stands where a map shows nothing: so low that no interpolation brings it back.
const NOWHERE: f64 = -1e12;

/// What all maps of a run share.
#[derive(Debug)]
pub(super) struct Ground<'a> {
    pub extent: Extent,
    pub bed: &'a [f64],
    pub release: Vec<Vec<[f64; 2]>>,
    pub footprint: Vec<Vec<[f64; 2]>>,
    pub path: Option<PathLine>,
}

impl<'a> Ground<'a> {
    pub fn of(story: &'a Story) -> Option<Ground<'a>> {
        let raster = story.plane.mountain()?;
        let extent = Extent {
            nx: raster.columns,
            ny: raster.rows,
            west: raster.west,
            south: raster.south,
            cell: raster.cell,
        };
        let outline = |map: &[f64], threshold: f64| {
            rings(&contour(map, lattice(raster), threshold), 4.0 * raster.cell * raster.cell)
        };
        let release = &story.plane.release;
        Some(Ground {
            extent,
            bed: &raster.values,
            release: outline(&release.dense(raster.values.len()), release_threshold(release)),
            footprint: story.map("peak_thickness").map_or(Vec::new(), |map| outline(map, REACHED)),
            path: path(story),
        })
    }

    /// The lines over a map: release, and, if wanted, the edge of all that was reached and the path.
    pub fn outlines(&self, edge: bool, along: bool) -> Vec<Outline<'_>> {
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

/// The top of a range of colours: the greatest value, or where a few cells stand far above the others the value that
/// one in 500 exceeds.
pub(super) fn top(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let Some(&most) = values.last() else { return 1.0 };
    let nearly = values[(values.len() - 1) * 499 / 500];
    if most > 1.25 * nearly { nearly } else { most }
}

/// What one map shows over the mountain.
struct Layer<'s> {
    name: &'static str,
    label: &'static str,
    unit: &'static str,
    colours: Colours,
    values: &'s [f64],
    /// Shown is where this is thick.
    thickness: &'s [f64],
    /// The largest value that is shown, and where the colours end.
    most: f64,
    limit: f64,
}

impl Layer<'_> {
    fn is_thickness(&self) -> bool {
        matches!(self.name, "peak_thickness" | "deposit")
    }

    fn threshold(&self) -> f64 {
        if self.is_thickness() { REACHED } else { -0.5 }
    }

    /// The values as they are shown, while they are. Films are fast and thin: a figure shows what a person would see.
    fn shown(&self) -> Vec<f64> {
        let value = |(&v, &h): (&f64, &f64)| match v {
            _ if self.is_thickness() => v,
            v if h > REACHED && v.is_finite() => v,
            _ => NOWHERE,
        };
        self.values.iter().zip(self.thickness).map(value).collect()
    }

    /// Find its range.
    fn ranged(mut self) -> Self {
        let shown = self.shown();
        let least = if self.is_thickness() { REACHED } else { 0.0 };
        self.limit = top(shown.iter().copied().filter(|&v| v > least));
        self.most = shown.iter().fold(0.0_f64, |most, v| most.max(*v));
        self
    }

    fn outlines<'a>(&self, ground: &'a Ground) -> Vec<Outline<'a>> {
        ground.outlines(self.name == "deposit", self.name == "deposit")
    }

    /// Its map of what is shown, without words and relief.
    fn map<'a>(&self, shown: &'a [f64], ground: &'a Ground, outlines: &'a [Outline]) -> Map<'a> {
        let most = if self.limit > 0.0 { self.limit } else { 1.0 };
        let overlay = Overlay {
            values: shown,
            quantity: Axis::new(self.label, self.unit).over(0.0, most),
            threshold: self.threshold(),
            colours: self.colours,
        };
        Map { extent: ground.extent, bed: ground.bed, overlay: Some(overlay), outlines, ..Default::default() }
    }
}

/// All figures of a run on a mountain.
pub(super) fn mountain<'a>(story: &'a Story<'a>) -> Vec<Drawing<'a>> {
    let (Some(ground), Some(peak)) = (Ground::of(story), story.map("peak_thickness")) else {
        return Vec::new();
    };
    let ground = Arc::new(ground);
    let plan: [(&'static str, &'static str, &'static str, Colours); 5] = [
        ("peak_thickness", "greatest thickness", "m", Colours::Thickness),
        ("deposit", "deposit", "m", Colours::Thickness),
        ("peak_speed", "greatest speed", "m/s", Colours::Speed),
        ("peak_pressure", "greatest pressure", "kPa", Colours::Speed),
        ("arrival_time", "arrival time", "s", Colours::Viridis),
    ];
    let layers = plan.into_iter().filter_map(|(name, label, unit, colours)| {
        let values = story.map(name)?;
        let thickness = if name == "deposit" { values } else { peak };
        Some(Layer { name, label, unit, colours, values, thickness, most: 0.0, limit: 0.0 }.ranged())
    });
    let layers: Vec<Layer> = layers.collect();
    // Before the maps are drawn side by side: most of them show the same box of the mountain.
    let relief = layers
        .first()
        .and_then(|layer| layer.map(&layer.shown(), &ground, &layer.outlines(&ground)).mountain().ok());
    let relief = Arc::new(relief);
    let mut drawings = Vec::new();
    for layer in layers {
        let Layer { name, label, unit, most, limit, .. } = layer;
        let (ground, relief) = (ground.clone(), relief.clone());
        let clipped =
            if limit < most { ", colours end at the value that 0.2 % of the cells exceed" } else { "" };
        let of = if name == "deposit" { "where it is" } else { "where the flow was" };
        let what = format!("{label}, largest {} {unit}{clipped}", short(most));
        let subtitle = format!("{what}; {}", story.subtitle);
        let lines = "; dashed: the edge of all that was reached, and the path of the section";
        let lines = if name == "deposit" { lines } else { "" };
        let mut caption = format!("{what}; shown {of} thicker than {REACHED} m{lines}.");
        caption[..1].make_ascii_uppercase();
        drawings.push(Drawing::new(name, caption, move || {
            let (outlines, shown) = (layer.outlines(&ground), layer.shown());
            let map = layer.map(&shown, &ground, &outlines);
            Map { title: &story.title, subtitle: &subtitle, relief: relief.as_ref().as_ref(), ..map }.draw()
        }));
    }
    if let (true, Some(deposit), Some(speed)) =
        (ground.path.is_some(), story.map("deposit"), story.map("peak_speed"))
    {
        let caption = "Section along the path: from the highest released cell to the farthest one reached, where \
                       greatest thickness times greatest speed is largest. The layers are drawn thicker than they \
                       are, as stated; the ground has its true height.";
        let ground = ground.clone();
        drawings.push(Drawing::new("section", caption, move || {
            let Some(path) = &ground.path else { return Section::default().draw() };
            let along = |map: &[f64]| path.cells.iter().map(|&k| map[k]).collect::<Vec<f64>>();
            Section {
                title: &story.title,
                subtitle: "along the path of the greatest flow, from the highest release to the farthest reach",
                distance: &path.distance,
                bed: &along(ground.bed),
                deposit: &along(deposit),
                peak_thickness: &along(peak),
                peak_speed: &along(speed),
                exaggeration: None,
            }
            .draw()
        }));
    }
    drawings.extend(super::history_figure::drawing(story));
    drawings
}
