//! All files that a case asks for, made of a finished run.

use super::story::Story;
use super::{
    Finished, Under, animation, chute_figures, drawing, mountain_figures, outlines, rasters, table_figures,
};
use crate::case::FileKind;
use crate::output::figures::PictureError;
use crate::output::report::{self, Report};
use crate::output::summary::StopReason;
use crate::output::{self, csv, vtk};
use crate::raster::RasterError;
use std::path::{Path, PathBuf};

/// A larger share of the mass in films is worth a warning.
pub const FILM_SHARE: f64 = 0.005;

/// Why a file could not be made of a run.
#[derive(Debug, thiserror::Error)]
pub enum FilesError {
    /// A file of the results could not be read or written.
    #[error(transparent)]
    Output(#[from] output::Error),
    /// A figure could not be drawn or written.
    #[error(transparent)]
    Figure(#[from] PictureError),
    /// A raster could not be written.
    #[error(transparent)]
    Raster(#[from] RasterError),
    /// There is no such result.
    #[error("{}: cannot open: {source}; `granflow run CASE.toml` writes a result.nc", path.display())]
    Missing {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is no result of granflow.
    #[error("{}: this is no result of granflow: {problem}; give the result.nc of a run", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
}

impl Story<'_> {
    /// Draw the standard figures into `folder`.
    ///
    /// # Errors
    /// [`FilesError`] naming the figure or the file.
    pub fn draw(&self, folder: &Path) -> Result<Vec<report::Figure>, FilesError> {
        let drawings = match (&self.plane.under, self.plane.y.is_empty()) {
            (Under::Mountain(_), _) => mountain_figures::mountain(self),
            (Under::Chute, true) => chute_figures::line(self),
            (Under::Chute, false) => chute_figures::plane(self),
            (Under::Table(table), true) => table_figures::line(self, table),
            (Under::Table(table), false) => table_figures::plane(self, table),
        };
        Ok(drawing::save_all(&drawings, folder)?)
    }
}

impl Finished {
    /// Write `result.nc`, `summary.json` and every kind of file that the case asks for, beside each other; returns the paths
    /// of the last.
    ///
    /// # Errors
    /// [`FilesError`] naming the file; the others are written nevertheless.
    pub fn write(&self, command: &str) -> Result<Vec<PathBuf>, FilesError> {
        // A thread of its own: it mostly waits for the disk, and the pool's draw meanwhile.
        let (result, files) = std::thread::scope(|scope| {
            let result = scope.spawn(|| {
                self.write_result(command)?;
                self.summary.write(&self.directory.join("summary.json"))
            });
            let files = self.write_files();
            (result.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)), files)
        });
        result?;
        files
    }

    /// Write every kind of file that the case asks for, beyond `result.nc`, `mass.csv` and `summary.json`; returns their
    /// paths.
    ///
    /// # Errors
    /// [`FilesError`] naming the file.
    pub fn write_files(&self) -> Result<Vec<PathBuf>, FilesError> {
        let asked = |kind| self.files.contains(&kind);
        let mut written = Vec::new();
        let drawn = asked(FileKind::Figures) || asked(FileKind::Report);
        let story = (drawn || asked(FileKind::Animation)).then(|| Story::of(self)).transpose()?;
        let ((figures, rasters), outlines) = rayon::join(
            || {
                rayon::join(
                    || match story.as_ref().filter(|_| drawn) {
                        Some(story) => story.draw(&self.figures()),
                        None => Ok(Vec::new()),
                    },
                    || if asked(FileKind::Geotiff) { rasters::write(self) } else { Ok(Vec::new()) },
                )
            },
            || if asked(FileKind::Vector) { outlines::write(self) } else { Ok(None) },
        );
        let figures = figures?;
        written.extend(figures.iter().map(|figure| figure.path.clone()));
        written.extend(rasters?);
        written.extend(outlines?);
        if asked(FileKind::Csv) {
            written.extend(self.write_csv()?);
        }
        if asked(FileKind::Vtk) {
            written.extend(self.write_vtk()?);
        }
        if let Some(story) = story.as_ref().filter(|_| asked(FileKind::Animation)) {
            written.push(animation::write(self, story)?);
        }
        if asked(FileKind::Report) {
            written.push(self.write_report(&figures)?);
        }
        Ok(written)
    }

    /// `profiles.csv`: every instant of a line; `maps.csv`: the summary maps of a plane, a line per cell. What lies on the
    /// nodes of a table goes to `profiles_node.csv` and `maps_node.csv`.
    fn write_csv(&self) -> Result<Vec<PathBuf>, output::Error> {
        let mut frames = self.frames.again()?;
        let mut written = Vec::new();
        let mut places = vec![("", &self.plane.x, &self.plane.y)];
        let (table, series) = (self.plane.as_table(), self.plane.series());
        places.extend(table.map(|table| ("_node", &table.x_node, &table.y_node)));
        for (at, x, y) in places {
            let kind = if y.is_empty() { "profiles" } else { "maps" };
            let path = self.directory.join(format!("{kind}{at}.csv"));
            if y.is_empty() {
                csv::write(&path, (&format!("x{at}"), x), &mut frames)?;
            } else {
                let mut maps: Vec<(&str, Vec<f64>)> = Vec::new();
                if table.is_some() {
                    // Of a pile that grows the last instant is the result; an avalanche has `deposit` among its maps.
                    let last = frames.times().len().saturating_sub(1);
                    for (k, field) in series.iter().enumerate().filter(|(_, f)| f.length == x.len() * y.len())
                    {
                        maps.push((&field.name, frames.read(last, k)?));
                    }
                }
                maps.extend(self.fixed(x.len() * y.len()));
                write_maps(&path, at, (x, y), &maps)?;
            }
            written.push(path);
        }
        Ok(written)
    }

    /// The maps that do not change, with so many values.
    fn fixed(&self, length: usize) -> Vec<(&str, Vec<f64>)> {
        let height = self.plane.as_table().map(|table| ("table_height", &table.height));
        let maps = self.maps.iter().map(|(name, map)| (*name, map));
        let all = height.into_iter().chain(maps);
        all.filter(|(_, map)| map.len() == length).map(|(name, map)| (name, map.clone())).collect()
    }

    /// `result.pvd` and `vtk/frame_0000.vti`, ...
    fn write_vtk(&self) -> Result<Vec<PathBuf>, output::Error> {
        let mut frames = self.frames.again()?;
        let spacing = |c: &[f64]| c.get(1).map(|second| second - c[0]);
        let (x, y, table) = (&self.plane.x, &self.plane.y, self.plane.as_table());
        let dx = spacing(x).unwrap_or(1.0);
        let dy = spacing(y).unwrap_or(dx);
        let low = |c: &[f64], d: f64| c.first().map_or(0.0, |first| first - 0.5 * d);
        let image = vtk::Image {
            cells: [x.len(), y.len().max(1)],
            origin: [low(x, dx), low(y, dy)],
            spacing: [dx, dy],
        };
        let (mut written, mut index) = (Vec::new(), Vec::new());
        for (k, time) in frames.times().to_vec().into_iter().enumerate() {
            let names: Vec<String> = frames.fields().iter().map(|field| field.name.clone()).collect();
            let mut fields = Vec::new();
            for (field, name) in names.iter().enumerate() {
                fields.push((name.as_str(), frames.read(k, field)?));
            }
            if let Some(table) = table {
                fields.extend(self.fixed(table.nodes()));
                fields.extend(self.fixed(x.len() * y.len().max(1)));
                if y.is_empty() {
                    let line = fields.iter_mut().filter(|(_, values)| values.len() == x.len() + 1);
                    line.for_each(|(_, values)| *values = values.repeat(2)); // a row of cells has two rows of nodes
                }
            }
            let fields: Vec<(&str, &[f64])> = fields.iter().map(|(name, v)| (*name, v.as_slice())).collect();
            let name = format!("vtk/frame_{k:04}.vti");
            let path = self.directory.join(&name);
            vtk::write_frame(&path, image, frames.precision(), &fields)?;
            written.push(path);
            index.push((time, name));
        }
        let collection = self.directory.join("result.pvd");
        vtk::write_collection(&collection, &index)?;
        written.push(collection);
        Ok(written)
    }

    fn write_report(&self, figures: &[report::Figure]) -> Result<PathBuf, output::Error> {
        let summary = &self.summary;
        let mut warnings = Vec::new();
        if !matches!(summary.stop_reason, StopReason::AtRest | StopReason::Steady) {
            warnings.push(format!(
                "the run ended before the mass was at rest ({}); what is called deposit is the thickness at the end.",
                summary.stop_reason
            ));
        }
        if summary.film_share() > FILM_SHARE {
            let share = 100.0 * summary.film_share();
            warnings
                .push(format!("{share:.2} % of the mass is held in films thinner than {:e} m.", self.film));
        }
        let path = self.directory.join("report.html");
        let report = Report {
            summary,
            more: &[],
            warnings: &warnings,
            figures,
            case: &self.case,
            ledger: &self.ledger,
        };
        report::write_report(&path, report)?;
        Ok(path)
    }
}

/// A line per place and a column per map; NaN stands as an empty cell.
fn write_maps(
    path: &Path,
    at: &str,
    (x, y): (&[f64], &[f64]),
    maps: &[(&str, Vec<f64>)],
) -> Result<(), output::Error> {
    output::whole_file(path, |out| {
        let names: Vec<&str> = maps.iter().map(|(name, _)| *name).collect();
        writeln!(out, "x{at},y{at},{}", names.join(","))?;
        for k in 0..x.len() * y.len() {
            write!(out, "{:?},{:?}", x[k % x.len()], y[k / x.len()])?;
            for value in maps.iter().map(|(_, map)| map[k]) {
                if value.is_nan() { write!(out, ",")? } else { write!(out, ",{value:?}")? }
            }
            writeln!(out)?;
        }
        Ok(())
    })
}
