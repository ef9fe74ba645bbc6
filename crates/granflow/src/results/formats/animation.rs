//! `animation.png`: the series over time as an animated PNG, which every browser shows.

use crate::model::Scene;
use crate::output;
use crate::output::figures::{FigureError, Picture, PictureError};
use crate::output::frames::Frames;
use crate::output::whole_file;
use crate::results::format::Format;
use crate::results::{FilesError, Finished, Story};
use granflow_case::FileKind;
use rayon::prelude::*;
use std::io::{self, Write};
use std::path::PathBuf;

/// The animation.
pub(super) static ANIMATION: Format = Format {
    kind: FileKind { name: "animation", about: "The run as an animated picture.", needs_terrain: false },
    drawn: true,
    after_figures: false,
    write: |work| match &work.story {
        Some(story) => Ok(vec![write(work.run, story)?]),
        None => Ok(Vec::new()),
    },
};

/// At most so many pictures; of more instants every n-th is shown.
const PICTURES: usize = 120;
/// Pictures a second, and the seconds that the last one stays.
const RATE: u16 = 8;
const STAY: u16 = 3;

/// The instants that the animation shows.
struct Reel {
    frames: Frames,
    /// Numbers of the fields.
    fields: Vec<usize>,
    /// Numbers of the frames.
    shown: Vec<usize>,
}

impl Reel {
    fn read(&mut self, frame: usize) -> Result<Vec<Vec<f64>>, output::Error> {
        self.fields.iter().map(|&field| self.frames.read(frame, field)).collect()
    }
}

/// Draw and write the animation of a run.
fn write(run: &Finished, story: &Story) -> Result<PathBuf, FilesError> {
    let path = run.directory.join("animation.png");
    let Some(pictures) = story.domain.model().pictures else { return Ok(path) };
    let frames = run.frames.again()?;
    let fields = pictures.animated().iter().filter_map(|name| frames.position(name)).collect();
    let count = frames.times().len();
    let every = count.div_ceil(PICTURES).max(1);
    let shown: Vec<usize> = (0..count).filter(|k| k % every == 0 || k + 1 == count).collect();
    let Some(&start) = shown.first() else { return Ok(path) };
    let mut reel = Reel { frames, fields, shown: shown.clone() };
    let mut instants = shown.iter().map(|&frame| reel.read(frame));
    let scene = pictures.scene(&story.view, &*story.domain, &mut instants)?;
    let begin = reel.frames.times()[start];
    let first = scene.draw(begin, &reel.read(start)?).map_err(PictureError::from)?;
    let mut failure = None;
    let written = whole_file(&path, |out| encode(out, &first, &mut reel, &*scene, &mut failure));
    match (written, failure) {
        (_, Some(error)) => Err(PictureError::from(error).into()),
        (written, None) => {
            written?;
            Ok(path)
        }
    }
}

/// Draw all pictures, of the size of the first; why one could not be drawn goes to `failure`.
fn encode(
    out: &mut dyn Write,
    first: &Picture,
    reel: &mut Reel,
    scene: &dyn Scene,
    failure: &mut Option<FigureError>,
) -> io::Result<()> {
    let mut encoder = png::Encoder::new(out, first.width, first.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_animated(reel.shown.len() as u32, 0).map_err(io::Error::other)?;
    encoder.set_frame_delay(1, RATE).map_err(io::Error::other)?;
    let mut writer = encoder.write_header().map_err(io::Error::other)?;
    // As many pictures at once as there are cores: an animation never fills the memory.
    for group in reel.shown.clone().chunks(rayon::current_num_threads().max(1)) {
        let mut fields = Vec::new();
        for &k in group {
            fields.push((reel.frames.times()[k], reel.read(k).map_err(io::Error::other)?));
        }
        let pictures: Result<Vec<Picture>, FigureError> =
            fields.par_iter().map(|(time, fields)| scene.draw(*time, fields)).collect();
        let pictures = match pictures {
            Ok(pictures) => pictures,
            Err(error) => {
                *failure = Some(error);
                return Err(io::Error::other("a picture could not be drawn"));
            }
        };
        for (picture, k) in pictures.iter().zip(group) {
            if k + 1 == reel.frames.times().len() {
                writer.set_frame_delay(STAY, 1).map_err(io::Error::other)?;
            }
            writer.write_image_data(&picture.rgb).map_err(io::Error::other)?;
        }
    }
    writer.finish().map_err(io::Error::other)
}
