//! The map: shaded mountain, contour lines, a field laid over it, outlines, scale bar.

use tiny_skia::Pixmap;

use super::axes::{
    Axis, Caption, Panel, RIM, Scale, bottom_room, extent, heading, heading_height, left_room,
};
use super::canvas::{Area, Canvas};
use super::colour_bar::ColourBar;
use super::colours::{Colours, mix, pick, shade};
use super::contours::{Contours, Elevations};
use super::heat::Outline;
use super::lattice::{Lattice, paint};
use super::legend::{Key, Legend, along};
use super::relief::{Relief, ground};
use super::scale_bar::ScaleBar;
use super::view::{Extent, View, paper};
use super::{Figure, FigureError, Picture};

/// The field laid over the mountain.
#[derive(Debug, Clone, Copy, Default)]
pub struct Overlay<'a> {
    /// `ny` rows of `nx` values as the bed; a value that is not finite counts as zero.
    pub values: &'a [f64],
    /// Name, unit and range of the field.
    pub quantity: Axis<'a>,
    /// The mountain shows where the field is not above this.
    pub threshold: f64,
    /// The scale of colours.
    pub colours: Colours,
}

/// A map of a mountain with what happened on it.
#[derive(Debug, Clone, Copy)]
pub struct Map<'a> {
    /// The heading.
    pub title: &'a str,
    /// A second, smaller line under it.
    pub subtitle: &'a str,
    /// Where the rasters lie.
    pub extent: Extent,
    /// Elevation of the ground, `ny` rows of `nx` values; white where not finite.
    pub bed: &'a [f64],
    /// The field over it.
    pub overlay: Option<Overlay<'a>>,
    /// Lines over both.
    pub outlines: &'a [Outline<'a>],
    /// Whether contour lines of the elevation are drawn.
    pub contours: bool,
    /// Shows only the box around field and outlines, widened on each side by this share of its greater side.
    pub crop: Option<f64>,
    /// [`Map::mountain`] of this map, or of another of the same raster; found again where that shows another box.
    pub relief: Option<&'a Relief>,
}

impl Default for Map<'_> {
    fn default() -> Self {
        let (title, subtitle, bed, outlines): (_, _, &[f64], &[Outline]) = ("", "", &[], &[]);
        Self {
            title,
            subtitle,
            extent: Extent::default(),
            bed,
            overlay: None,
            outlines,
            contours: true,
            crop: Some(0.12),
            relief: None,
        }
    }
}

impl Map<'_> {
    /// The mountain as this map shows it, for [`Map::relief`] of maps that show the same box.
    ///
    /// # Errors
    /// As [`Figure::draw`].
    pub fn mountain(&self) -> Result<Relief, FigureError> {
        self.check()?;
        let view = self.view();
        let (width, height) = paper(view);
        Ok(Relief::of(
            self.bed,
            self.extent,
            self.contours,
            view,
            Area { left: 0.0, top: 0.0, width, height }.pixels(),
        ))
    }

    fn check(&self) -> Result<(), FigureError> {
        let e = self.extent;
        if e.nx < 2
            || e.ny < 2
            || !(e.cell > 0.0 && e.cell.is_finite() && e.west.is_finite() && e.south.is_finite())
        {
            return Err(FigureError::empty(
                self.title,
                "a raster of fewer than two cells along an axis, or without a place",
            ));
        }
        FigureError::same_length(self.title, "the bed", self.bed.len(), e.nx * e.ny)?;
        self.overlay.map_or(Ok(()), |o| {
            FigureError::same_length(self.title, "the field", o.values.len(), e.nx * e.ny)
        })
    }
}

impl Overlay<'_> {
    fn is_seen(&self) -> bool {
        self.values.iter().any(|&value| value > self.threshold)
    }
}

/// The range of colours of an overlay: from zero (or the threshold) to its greatest value.
fn colour_range(overlay: &Overlay) -> [f64; 2] {
    let found = extent(overlay.values.iter().copied().filter(|&v| v > overlay.threshold));
    let range = overlay.quantity.range_of(found.map(|[low, high]| [low.min(0.0), high]), 0.0);
    match range {
        Some(range) if range[0] < range[1] => overlay.colours.range(range),
        _ => [0.0, if overlay.threshold > 0.0 { 2.0 * overlay.threshold } else { 1.0 }],
    }
}

/// An overlay as it is drawn: no holes, and the range of its colours.
struct Laid<'a> {
    overlay: Overlay<'a>,
    values: Vec<f64>,
    nx: usize,
    range: [f64; 2],
}

impl<'a> Laid<'a> {
    fn new(overlay: Overlay<'a>, nx: usize) -> Self {
        let values = overlay.values.iter().map(|&v| if v.is_finite() { v } else { 0.0 }).collect();
        Self { range: colour_range(&overlay), overlay, values, nx }
    }

    fn bar(&self) -> ColourBar {
        let Overlay { colours, quantity, .. } = &self.overlay;
        ColourBar { colours: *colours, range: self.range, caption: quantity.caption() }
    }

    /// The field at a pixel, where it is above the threshold.
    fn at(&self, relief: &Relief, column: usize, row: usize) -> Option<f64> {
        let lattice = Lattice { values: &self.values, nx: self.nx };
        Some(lattice.at(relief.across[column], relief.up[row])).filter(|&v| v > self.overlay.threshold)
    }
}

/// The panel's pixels: the mountain with the field over it.
fn image(relief: &Relief, laid: Option<&Laid>, (columns, rows): (usize, usize)) -> Option<Pixmap> {
    let Relief { elevation, light, ink, .. } = relief;
    let table = laid.map(|laid| laid.overlay.colours.table());
    paint((columns, rows), |column, row| {
        let pixel = row * columns + column;
        if !elevation[pixel].is_finite() {
            return None;
        }
        let light = if light[pixel].is_finite() { light[pixel] } else { 0.7 };
        let mut colour = ground(light);
        if let (Some(laid), Some(table)) = (laid, &table)
            && let Some(value) = laid.at(relief, column, row)
        {
            let over = shade(pick(table, value, laid.range), (0.80 + 0.34 * light).min(1.06));
            colour = mix(colour, over, 0.88);
        }
        Some(ink.get(pixel).map_or(colour, |&ink| Contours::over_colour(colour, ink)))
    })
}

impl Map<'_> {
    /// What lies over the image: names of contour lines, outlines, scale bar and legend, where they hide least.
    fn draw_over(&self, canvas: &mut Canvas, panel: &Panel, relief: &Relief, laid: Option<&Laid>) {
        let (columns, rows) = panel.area.pixels();
        let covered =
            |column: usize, row: usize| laid.is_some_and(|laid| laid.at(relief, column, row).is_some());
        let (mut taken, mut lines) = (Vec::new(), Vec::new());
        for row in (0..rows).step_by(12) {
            let inside = (0..columns).step_by(12).filter(|&column| covered(column, row));
            taken.extend(inside.map(|column| panel.area.at_pixel(column, row)));
        }
        let mut legend = Legend::default();
        for outline in self.outlines {
            let line: Vec<_> = outline.points.iter().map(|&[x, y]| panel.place(x, y)).collect();
            along(&line, panel.area, &mut lines);
            legend.add(outline.name, Key::Line(outline.pen()));
        }
        taken.extend(&lines);
        let ruler = ScaleBar::fit(panel, &taken);
        along(&ruler.area.corners(), panel.area, &mut taken);
        let (place, _) = legend.best_place(panel.area, &taken);
        let boxes = if legend.is_empty() { vec![ruler.area] } else { vec![ruler.area, place] };
        if let Some(contours) = relief.contours {
            let free = |column: usize, row: usize| {
                let p = panel.area.at_pixel(column, row);
                let beside = |q: &[f64; 2]| (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2) < 12.0 * 12.0;
                !covered(column, row) && !boxes.iter().any(|b| b.contains(p)) && !lines.iter().any(beside)
            };
            let elevations = Elevations { elevation: &relief.elevation, columns, rows };
            elevations.label(canvas, panel, contours, free);
        }
        self.outlines.iter().for_each(|outline| outline.draw(canvas, panel));
        ruler.draw(canvas);
        legend.draw(canvas, place);
    }
}

impl Figure for Map<'_> {
    fn draw(&self) -> Result<Picture, FigureError> {
        self.check()?;
        let view = self.view();
        let scale = |range| Scale { coordinates: true, ..Scale::new(range) };
        let (x, y) = (scale(view.x), scale(view.y));
        let (wide, high) = paper(view);
        // Colours that stand nowhere need no scale.
        let laid = self.overlay.filter(Overlay::is_seen).map(|overlay| Laid::new(overlay, self.extent.nx));
        let bar = laid.as_ref().map(Laid::bar);
        let room = bar.as_ref().map_or(10.0, |bar| 16.0 + bar.room(high));
        let head = heading_height(self.title, self.subtitle);
        let (easting, northing) = (Caption::new("easting", "m"), Caption::new("northing", "m"));
        let left = RIM + left_room(&y.upright_ticks(high), &northing);
        let (width, height) = (left + wide + room + RIM, head + high + bottom_room(&easting) + RIM);

        let mut canvas = Canvas::new(width, height);
        heading(&mut canvas, self.title, self.subtitle, width);
        let area = Area { left, top: head, width: wide, height: high };
        let panel = Panel::within(area, x, y, easting, northing);
        let pixels = panel.area.pixels();
        let own;
        let relief = match self.relief {
            Some(relief) if relief.shows(view, pixels) => relief,
            _ => {
                own = Relief::of(self.bed, self.extent, self.contours, view, pixels);
                &own
            }
        };
        if let Some(image) = image(relief, laid.as_ref(), pixels) {
            canvas.image(&image, [panel.area.left, panel.area.top]);
        }
        canvas.clip(Some(panel.area));
        self.draw_over(&mut canvas, &panel, relief, laid.as_ref());
        canvas.clip(None);
        panel.draw_frame(&mut canvas);
        if let Some(bar) = bar {
            bar.draw(&mut canvas, panel.area.right() + 16.0, panel.area.top, panel.area.height);
        }
        Ok(canvas.finish())
    }
}

impl Map<'_> {
    /// The whole raster, or the box around what is of interest, not narrower than 1 to 2.2.
    pub(super) fn view(&self) -> View {
        let e = self.extent;
        let whole = View { x: [e.west, e.east()], y: [e.south, e.north()] };
        let Some(margin) = self.crop else { return whole };
        let (mut xs, mut ys): (Vec<f64>, Vec<f64>) =
            self.outlines.iter().flat_map(|o| o.points).map(|p| (p[0], p[1])).unzip();
        if let Some(overlay) = self.overlay {
            for (k, _) in overlay.values.iter().enumerate().filter(|&(_, &v)| v > overlay.threshold) {
                let (i, j) = ((k % e.nx) as f64, (k / e.nx) as f64);
                xs.extend([e.west + i * e.cell, e.west + (i + 1.0) * e.cell]);
                ys.extend([e.south + j * e.cell, e.south + (j + 1.0) * e.cell]);
            }
        }
        let (Some([x0, x1]), Some([y0, y1])) = (extent(xs), extent(ys)) else { return whole };
        let greater = (x1 - x0).max(y1 - y0).max(12.0 * e.cell);
        // Each side: the box and its margin, the other side over 2.2 at least, the raster at most.
        let side = |[low, high]: [f64; 2], [least, most]: [f64; 2]| {
            let half = (0.5 * (high - low) + margin.max(0.0) * greater).max(greater / 4.4);
            let middle = 0.5 * (low + high);
            let (low, high) = ((middle - half).max(least), (middle + half).min(most));
            if low < high { [low, high] } else { [least, most] }
        };
        View { x: side([x0, x1], whole.x), y: side([y0, y1], whole.y) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shared_mountain_changes_no_pixel() {
        let extent = Extent { nx: 40, ny: 30, west: 0.0, south: 0.0, cell: 5.0 };
        let bed: Vec<f64> =
            (0..1200).map(|k| 3.0 * f64::from(k % 40) + (0.3 * f64::from(k / 40)).sin() * 20.0).collect();
        let field = |lowest: usize| -> Vec<f64> {
            (0..1200).map(|k| f64::from(u8::from((lowest..20).contains(&(k / 40))))).collect()
        };
        let (one, other) = (field(10), field(4));
        let map = |values| Map {
            extent,
            bed: &bed,
            overlay: Some(Overlay { values, threshold: 0.5, ..Default::default() }),
            ..Default::default()
        };
        let relief = map(&one).mountain().unwrap();
        assert!(relief.ink.iter().any(|&ink| ink > 0.0));
        for values in [&one, &other] {
            let shared = Map { relief: Some(&relief), ..map(values) };
            assert!(shared.draw().unwrap() == map(values).draw().unwrap());
        }
        assert!(relief.shows(map(&one).view(), map(&one).mountain().unwrap().size()));
        let next = |[low, high]: [f64; 2]| [low.next_up(), high.next_down()];
        let View { x, y } = map(&one).view();
        assert!(
            relief.shows(View { x: next(x), y: next(y) }, relief.size()),
            "the last bits are no other box"
        );
        assert!(!relief.shows(map(&other).view(), relief.size()), "it shows another box");
    }

    #[test]
    fn an_overlay_that_nowhere_passes_its_threshold_is_none() {
        let extent = Extent { nx: 3, ny: 2, west: 0.0, south: 0.0, cell: 5.0 };
        let overlay =
            Overlay { values: &[0.0, 0.01, f64::NAN, 0.1, 0.0, -1.0], threshold: 0.1, ..Default::default() };
        let with = Map { extent, bed: &[0.0; 6], overlay: Some(overlay), ..Default::default() };
        assert!(with.draw().unwrap() == Map { overlay: None, ..with }.draw().unwrap());
        let flat = Overlay { values: &[2.0, 2.0], threshold: 0.1, ..Default::default() };
        assert_eq!(colour_range(&flat), [0.0, 2.0]);
    }

    #[test]
    fn the_view_holds_the_field_and_stays_inside() {
        let extent = Extent { nx: 100, ny: 80, west: 1000.0, south: 2000.0, cell: 10.0 };
        let bed = vec![0.0; 8000];
        let mut values = vec![0.0; 8000];
        for j in 20..60 {
            values[j * 100 + 3] = 1.0;
        }
        let overlay = Overlay { values: &values, threshold: 0.5, ..Default::default() };
        let map = Map { extent, bed: &bed, overlay: Some(overlay), crop: Some(0.1), ..Default::default() };
        let view = map.view();
        assert_eq!(view.y, [2200.0 - 40.0, 2600.0 + 40.0]);
        assert_eq!(view.x[0], 1000.0);
        assert!(view.x[1] >= 1040.0 + 40.0 && view.x[1] - view.x[0] < 400.0);
        let nothing = Map { overlay: None, ..map };
        assert_eq!(nothing.view().x, [1000.0, 2000.0]);
    }
}
