//! The figures of an ensemble, their colours for other programs, and its report.

use super::{Ensemble, EnsembleError, Map, Measure, Reduced};
use crate::model::colour_limit;
use crate::output::figures::{
    Axis, Colours, Curve, Extent, Figure as _, FigureError, HeatMap, Map as Mountain, Outline, Overlay,
    Picture, Profiles, save,
};
use crate::output::outlines::rings;
use crate::output::report::{Figure, Section, Table, write_index};
use crate::output::style::Style;
use crate::raster::Raster;
use rayon::prelude::*;
use std::path::Path;

/// Failed members that a report lists.
const LISTED: usize = 20;
/// Below this share of the range of its colours a map shows the mountain.
const LEAST_SHOWN: f64 = 1e-3;

impl Ensemble {
    /// The colours of a map: probabilities always over 0 to 1, others up to their largest value but for a few cells.
    pub(super) fn style(&self, map: &Map) -> Style {
        let largest = colour_limit(map.values.iter().copied().filter(|value| *value > 0.0));
        let (colours, high) = match (map.measure, map.quantity.as_str()) {
            (Measure::Exceedance(_), _) => (Colours::Viridis, 1.0),
            (Measure::Members, _) => (Colours::Viridis, largest),
            (_, "peak_thickness") => (Colours::Thickness, largest),
            _ => (Colours::Speed, largest),
        };
        let unit = match map.units {
            "1" => "",
            "m s-1" => "m/s",
            other => other,
        };
        let label = match map.measure {
            Measure::Exceedance(_) => "share of the members".to_owned(),
            Measure::Members => "members".to_owned(),
            _ => map.name.replace('_', " "),
        };
        let unit = unit.to_owned();
        Style { label, unit, colours, above: LEAST_SHOWN * high, range: [0.0, high] }
    }

    /// Draws every map into a folder; one in which no member came anywhere is left out.
    pub(super) fn draw(
        &self,
        reduced: &Reduced,
        maps: &[Map],
        folder: &Path,
    ) -> Result<Vec<Figure>, EnsembleError> {
        let draw = |map: &Map| -> Result<Option<Figure>, EnsembleError> {
            let picture = match self.picture(reduced, map) {
                Err(FigureError::Empty { .. }) => return Ok(None),
                picture => picture.map_err(crate::output::figures::PictureError::from)?,
            };
            let path = folder.join(format!("{}.png", map.name));
            save(&picture, &path)?;
            let mut name = map.name.replace('_', " ");
            name[..1].make_ascii_uppercase();
            let mut caption = map.long_name.clone();
            caption[..1].make_ascii_uppercase();
            Ok(Some(Figure { name, caption: format!("{caption}."), path }))
        };
        let figures: Vec<Option<Figure>> = maps.par_iter().map(draw).collect::<Result<_, _>>()?;
        Ok(figures.into_iter().flatten().collect())
    }

    /// A map on the shaded mountain, on the chute, or along it.
    fn picture(&self, reduced: &Reduced, map: &Map) -> Result<Picture, FigureError> {
        let plane = self.plane();
        let Style { label, unit, colours, above, range } = self.style(map);
        let title = self.run_plan().title.as_str();
        let subtitle = format!("{}; {} members", map.long_name, reduced.computed());
        let quantity = Axis::new(&label, &unit).over(range[0], range[1]);
        let length = if plane.domain.projected() { "m" } else { "" };
        let shown: Vec<f64> =
            map.values.iter().map(|value| if value.is_nan() { 0.0 } else { *value }).collect();
        if let Some(raster) = plane.domain.raster() {
            let overlay = Overlay { values: &shown, quantity, threshold: above, colours };
            return self.on_mountain(raster, [title, &subtitle], overlay);
        }
        if plane.dimensions() > 1 {
            let (x, y) = (Axis::new("x", length), Axis::new("y", length));
            let (xs, ys, values) = (plane.x.as_slice(), plane.y.as_slice(), shown.as_slice());
            return HeatMap {
                title,
                subtitle: &subtitle,
                x,
                y,
                xs,
                ys,
                values,
                quantity,
                colours,
                ..Default::default()
            }
            .draw();
        }
        let curves = [Curve { x: &plane.x, y: &shown, ..Curve::default() }];
        let (x, y) = (Axis::new("x", length), Axis::new(&label, &unit));
        Profiles { title, subtitle: &subtitle, x, y, curves: &curves, ..Default::default() }.draw()
    }

    /// A map on the shaded mountain, with the release of the case.
    fn on_mountain(
        &self,
        raster: &Raster,
        [title, subtitle]: [&str; 2],
        overlay: Overlay,
    ) -> Result<Picture, FigureError> {
        let Raster { columns: nx, rows: ny, west, south, cell, .. } = *raster;
        let areas = self.plane().domain.outlines(&Vec::new());
        let release = areas.iter().find(|area| area.name == "release");
        let release = release.map_or(Vec::new(), |area| rings(&area.area, 4.0 * cell * cell));
        let outlines: Vec<Outline> = release
            .iter()
            .enumerate()
            .map(|(k, points)| {
                let name = if k == 0 { "release of the case" } else { "" };
                Outline { name, points, closed: true, ..Outline::default() }
            })
            .collect();
        let extent = Extent { nx, ny, west, south, cell };
        let (bed, overlay, outlines) = (raster.values.as_slice(), Some(overlay), outlines.as_slice());
        Mountain { title, subtitle, extent, bed, overlay, outlines, ..Default::default() }.draw()
    }

    /// `report.html`: the ensemble on one page.
    pub(super) fn write_report(
        &self,
        reduced: &Reduced,
        figures: Vec<Figure>,
        path: &Path,
    ) -> Result<(), EnsembleError> {
        let (plan, run) = (self.plan(), self.run_plan());
        let failed = reduced.failures().count();
        let line = |name: &str, value: String| vec![name.to_owned(), value];
        let mut lines = vec![
            line("Members computed", format!("{} of {}", reduced.computed(), plan.members)),
            line("Members that failed", failed.to_string()),
            line("Values drawn by", plan.to_string()),
            line("A cell counts as reached above", format!("{} m", run.output.threshold)),
            line("granflow", env!("CARGO_PKG_VERSION").to_owned()),
        ];
        if !plan.percentiles.is_empty() {
            let width = 100.0 / f64::from(plan.classes);
            lines.push(line("Percentiles are known to", format!("{width} % of their value, one class")));
        }
        let head = vec!["".to_owned(), "".to_owned()];
        let mut tables = vec![Table { title: "The ensemble".to_owned(), head, lines }];
        if failed > 0 {
            let row = |(number, failure): (u32, &str)| {
                vec![number.to_string(), self.sample(number).overrides.join(" "), failure.to_owned()]
            };
            let head = ["Member", "Values", "Why"].map(str::to_owned).to_vec();
            let title = format!("Members that failed ({failed}, seed {}); members.csv has all", plan.seed);
            tables.push(Table { title, head, lines: reduced.failures().take(LISTED).map(row).collect() });
        }
        let text = vec![
            "Shares and means are of the members that were computed to their end; a member that did not reach a cell counts there with 0."
                .to_owned(),
        ];
        let case = Section { title: "Case".to_owned(), code: run.text(), ..Section::default() };
        let maps = Section { title: "Maps".to_owned(), figures, ..Section::default() };
        let numbers = Section { title: "Numbers".to_owned(), text, tables, ..Section::default() };
        Ok(write_index(path, &run.title, &[], &[numbers, maps, case])?)
    }
}
