//! `animation.png`: the thickness, or the pile, over time as an animated PNG, which every browser shows.

use super::chute_figures::Window;
use super::mountain_figures::{Ground, top};
use super::path::REACHED;
use super::profiles::PILE;
use super::story::Story;
use super::table_figures::{self, Ranges};
use super::{FilesError, Finished, Under};
use crate::output;
use crate::output::figures::{
    Axis, Colours, Curve, Figure, FigureError, Fill, HeatMap, Map, Outline, Overlay, Picture, Profiles,
    Relief, Style, short,
};
use crate::output::whole_file;
use rayon::prelude::*;
use std::io;
use std::path::PathBuf;

/// At most so many pictures; of more instants every n-th is shown.
const PICTURES: usize = 120;
/// Pictures a second, and the seconds that the last one stays.
const RATE: u16 = 8;
const STAY: u16 = 3;

/// Draw and write the film of a run.
pub(super) fn write(run: &Finished, story: &Story) -> Result<PathBuf, FilesError> {
    let mut frames = run.frames.again()?;
    let times = frames.times().to_vec();
    let names: &[&str] =
        if run.plane.as_table().is_some() { &["standing_layer", "rolling_layer"] } else { &["thickness"] };
    let wanted: Vec<usize> = names.iter().filter_map(|name| frames.position(name)).collect();
    let mut read = |k: usize| -> Result<Vec<Vec<f64>>, output::Error> {
        wanted.iter().map(|&field| frames.read(k, field)).collect()
    };
    let every = times.len().div_ceil(PICTURES).max(1);
    let shown: Vec<usize> = (0..times.len()).filter(|k| k % every == 0 || k + 1 == times.len()).collect();
    let mut scene = Scene::of(run, story);
    if let Some(table) = run.plane.as_table() {
        let mut ranges = Ranges::default();
        for &k in &shown {
            ranges.widen(table, pair(&read(k)?));
        }
        scene.ranges = ranges;
    }
    let path = run.directory.join("animation.png");
    let Some(&start) = shown.first() else { return Ok(path) };
    let fields = read(start)?;
    scene.relief = scene.mountain(&fields);
    let first = scene.draw(times[start], &fields).map_err(output::figures::PictureError::from)?;
    let mut failure = None;
    let written = whole_file(&path, |out| {
        let mut encoder = png::Encoder::new(out, first.width, first.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Fast);
        encoder.set_animated(shown.len() as u32, 0).map_err(io::Error::other)?;
        encoder.set_frame_delay(1, RATE).map_err(io::Error::other)?;
        let mut writer = encoder.write_header().map_err(io::Error::other)?;
        // As many pictures at once as there are cores: a film never fills the memory.
        for group in shown.chunks(rayon::current_num_threads().max(1)) {
            let mut fields = Vec::new();
            for &k in group {
                fields.push((times[k], read(k).map_err(io::Error::other)?));
            }
            let pictures: Result<Vec<Picture>, FigureError> =
                fields.par_iter().map(|(time, fields)| scene.draw(*time, fields)).collect();
            let pictures = match pictures {
                Ok(pictures) => pictures,
                Err(error) => {
                    failure = Some(error);
                    return Err(io::Error::other("a picture could not be drawn"));
                }
            };
            for (picture, k) in pictures.iter().zip(group) {
                if k + 1 == times.len() {
                    writer.set_frame_delay(STAY, 1).map_err(io::Error::other)?;
                }
                writer.write_image_data(&picture.rgb).map_err(io::Error::other)?;
            }
        }
        writer.finish().map_err(io::Error::other)
    });
    match (written, failure) {
        (_, Some(error)) => Err(output::figures::PictureError::from(error).into()),
        (written, None) => {
            written?;
            Ok(path)
        }
    }
}

/// What all pictures share.
struct Scene<'a> {
    story: &'a Story<'a>,
    ground: Option<Ground<'a>>,
    window: Option<Window>,
    /// Greatest thickness that the colours or the axis tell apart.
    top: f64,
    /// What they tell apart on a table.
    ranges: Ranges,
    /// The mountain under them, once the first is known.
    relief: Option<Relief>,
}

/// Standing and rolling layer of a frame.
fn pair(fields: &[Vec<f64>]) -> (&[f64], &[f64]) {
    let field = |k: usize| fields.get(k).map_or(&[][..], Vec::as_slice);
    (field(0), field(1))
}

impl<'a> Scene<'a> {
    fn of(run: &Finished, story: &'a Story<'a>) -> Scene<'a> {
        let peak = run.map("peak_thickness");
        let all = || story.series("thickness").iter().flatten().copied();
        let most = match peak {
            Some(peak) if story.plane.is_terrain() => top(peak.iter().copied().filter(|&h| h > REACHED)),
            Some(peak) => peak.iter().copied().fold(0.0, f64::max),
            None => all().fold(0.0, f64::max),
        };
        let chute = matches!(story.plane.under, Under::Chute);
        let window = (!story.plane.y.is_empty() && chute).then(|| match peak {
            Some(peak) => Window::around(story, peak),
            None => {
                let cells = story.plane.x.len() * story.plane.y.len();
                Window::around(story, &story.plane.release.dense(cells))
            }
        });
        let top = if most > 0.0 { most } else { 1.0 };
        Scene { story, ground: Ground::of(story), window, top, ranges: Ranges::default(), relief: None }
    }

    /// The thickness on a mountain, without words and relief.
    fn map<'b>(&'b self, ground: &'b Ground, field: &'b [f64], outlines: &'b [Outline]) -> Map<'b> {
        let overlay = Overlay {
            values: field,
            quantity: Axis::new("thickness h", self.story.unit("m")).over(0.0, self.top),
            threshold: REACHED,
            colours: Colours::Thickness,
        };
        Map { extent: ground.extent, bed: ground.bed, overlay: Some(overlay), outlines, ..Default::default() }
    }

    /// The mountain under the picture of a frame.
    fn mountain(&self, fields: &[Vec<f64>]) -> Option<Relief> {
        let ground = self.ground.as_ref()?;
        self.map(ground, pair(fields).0, &ground.outlines(true, false)).mountain().ok()
    }

    fn draw(&self, time: f64, fields: &[Vec<f64>]) -> Result<Picture, FigureError> {
        let story = self.story;
        let subtitle = format!("t = {} {}", short(time), story.unit("s"));
        if let Some(table) = story.plane.as_table() {
            let draw = if story.plane.y.is_empty() { table_figures::instant } else { table_figures::pile };
            return draw(story, table, &subtitle, pair(fields), self.ranges);
        }
        let (field, _) = pair(fields);
        let thickness = Axis::new("thickness h", story.unit("m")).over(0.0, self.top);
        if let Some(ground) = &self.ground {
            let outlines = ground.outlines(true, false);
            let map = self.map(ground, field, &outlines);
            return Map { title: &story.title, subtitle: &subtitle, relief: self.relief.as_ref(), ..map }
                .draw();
        }
        let x = Axis::new("x", "");
        if let Some(window) = &self.window {
            return HeatMap {
                title: &story.title,
                subtitle: &subtitle,
                x,
                y: Axis::new("y", ""),
                xs: &window.x,
                ys: &window.y,
                values: &window.cut(field),
                quantity: thickness,
                ..Default::default()
            }
            .draw();
        }
        let xs = &story.plane.x;
        Profiles {
            title: &story.title,
            subtitle: &subtitle,
            x,
            y: Axis::new("thickness h", "").over(0.0, 1.08 * self.top),
            curves: &[Curve { name: "", x: xs, y: field, style: Style::Solid, colour: None }],
            fills: &[Fill { name: "", x: xs, lower: None, upper: field, colour: PILE }],
            ..Default::default()
        }
        .draw()
    }
}
