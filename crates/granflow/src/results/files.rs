//! All files that a case asks for, made of a finished run.

use super::{FilesError, Finished};
use crate::case::FileKind;
use crate::model::Plane;
use crate::output;
use crate::output::report::{self, Report};
use std::path::PathBuf;

/// Can all these kinds of files be made by this program, of a run on this plane?
///
/// # Errors
/// [`FilesError::Kind`] naming the first that cannot, and what helps.
pub fn check_kinds(files: &[FileKind], plane: &Plane) -> Result<(), FilesError> {
    for &kind in files {
        let (needed, built) = match kind {
            FileKind::Figures | FileKind::Animation | FileKind::Report => {
                ("figures", cfg!(feature = "figures"))
            }
            FileKind::Geotiff | FileKind::Vector => ("geo", cfg!(feature = "geo")),
            FileKind::Netcdf | FileKind::Csv | FileKind::Vtk => continue,
        };
        if !built {
            let problem =
                format!("this program was built without `{needed}`; build it with --features {needed}");
            return Err(FilesError::Kind { kind, problem });
        }
        #[cfg(feature = "figures")]
        if needed == "figures" && plane.model().pictures.is_none() {
            let problem = format!("nothing draws the model {}; give it pictures", plane.model().name);
            return Err(FilesError::Kind { kind, problem });
        }
    }
    let _ = plane;
    Ok(())
}

impl Finished {
    /// Write `result.nc`, `summary.json` and every kind of file that the case asks for, beside each other; returns
    /// the paths of the last.
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

    /// Write every kind of file that the case asks for, beyond `result.nc`, `mass.csv` and `summary.json`; returns
    /// their paths.
    ///
    /// # Errors
    /// [`FilesError`] naming the file.
    pub fn write_files(&self) -> Result<Vec<PathBuf>, FilesError> {
        check_kinds(&self.files, &self.plane)?;
        let drawings = Drawings::of(self)?;
        let ((figures, rasters), outlines) =
            rayon::join(|| rayon::join(|| drawings.figures(self), || self.rasters()), || self.outlines());
        let figures = figures?;
        let mut written: Vec<PathBuf> = figures.iter().map(|figure| figure.path.clone()).collect();
        written.extend(rasters?);
        written.extend(outlines?);
        if self.asked(FileKind::Csv) {
            written.extend(self.write_csv()?);
        }
        if self.asked(FileKind::Vtk) {
            written.extend(self.write_vtk()?);
        }
        written.extend(drawings.animation(self)?);
        if self.asked(FileKind::Report) {
            written.push(self.write_report(&figures)?);
        }
        Ok(written)
    }

    fn asked(&self, kind: FileKind) -> bool {
        self.files.contains(&kind)
    }

    #[cfg(feature = "geo")]
    fn rasters(&self) -> Result<Vec<PathBuf>, FilesError> {
        if self.asked(FileKind::Geotiff) { Ok(super::rasters::write(self)?) } else { Ok(Vec::new()) }
    }

    /// `outlines.geojson`, where the model outlines anything.
    #[cfg(feature = "geo")]
    fn outlines(&self) -> Result<Option<PathBuf>, FilesError> {
        let Some(raster) = self.plane.domain.raster().filter(|_| self.asked(FileKind::Vector)) else {
            return Ok(None);
        };
        let path = self.directory.join("outlines.geojson");
        let epsg = raster.crs.as_ref().and_then(|crs| crs.epsg);
        output::outlines::write(&path, &self.plane.domain.outlines(&self.maps), epsg)?;
        Ok(Some(path))
    }

    #[cfg(not(feature = "geo"))]
    fn rasters(&self) -> Result<Vec<PathBuf>, FilesError> {
        Ok(Vec::new())
    }

    #[cfg(not(feature = "geo"))]
    fn outlines(&self) -> Result<Option<PathBuf>, FilesError> {
        Ok(None)
    }

    fn write_report(&self, figures: &[report::Figure]) -> Result<PathBuf, output::Error> {
        let path = self.directory.join("report.html");
        let findings = (self.plane.model().findings)(&self.summary, self.film);
        let report = Report {
            summary: &self.summary,
            findings: &findings,
            figures,
            case: &self.case_text,
            ledger: &self.ledger,
        };
        report::write_report(&path, report)?;
        Ok(path)
    }
}

/// The run as its figures see it, where the case asks for any.
#[cfg(feature = "figures")]
struct Drawings<'r>(Option<super::Story<'r>>);

#[cfg(feature = "figures")]
impl<'r> Drawings<'r> {
    fn of(run: &'r Finished) -> Result<Self, FilesError> {
        let kinds = [FileKind::Figures, FileKind::Report, FileKind::Animation];
        let wanted = kinds.into_iter().any(|kind| run.asked(kind));
        Ok(Drawings(wanted.then(|| super::Story::of(run)).transpose()?))
    }

    fn figures(&self, run: &Finished) -> Result<Vec<report::Figure>, FilesError> {
        let drawn = run.asked(FileKind::Figures) || run.asked(FileKind::Report);
        match self.0.as_ref().filter(|_| drawn) {
            Some(story) => story.draw(&run.figures()),
            None => Ok(Vec::new()),
        }
    }

    fn animation(&self, run: &Finished) -> Result<Option<PathBuf>, FilesError> {
        let story = self.0.as_ref().filter(|_| run.asked(FileKind::Animation));
        story.map(|story| super::animation::write(run, story)).transpose()
    }
}

/// Nothing is drawn; [`check_kinds`] has refused a case that asks for it.
#[cfg(not(feature = "figures"))]
struct Drawings;

#[cfg(not(feature = "figures"))]
impl Drawings {
    fn of(_run: &Finished) -> Result<Self, FilesError> {
        Ok(Drawings)
    }

    fn figures(&self, _run: &Finished) -> Result<Vec<report::Figure>, FilesError> {
        Ok(Vec::new())
    }

    fn animation(&self, _run: &Finished) -> Result<Option<PathBuf>, FilesError> {
        Ok(None)
    }
}
