//! The files of an ensemble.

use super::folder::unmade;
use super::{Ensemble, EnsembleError, Map, Outcome, Reduced};
use crate::output::netcdf::{Axis, Dataset, Values, Variable};
use crate::output::{Precision, rasters, whole_file};
use rayon::prelude::*;
use std::io;
use std::path::{Path, PathBuf};

impl Ensemble {
    /// Writes tables, maps and pages of what was added up into a folder, those that the case asks for under `output.files`; returns their
    /// paths.
    ///
    /// # Errors
    /// [`EnsembleError::AllFailed`] where there is nothing to show, after `members.csv` was written; [`EnsembleError::Output`].
    pub fn write_files(
        &self,
        reduced: &Reduced,
        folder: &Path,
        command: &str,
    ) -> Result<Vec<PathBuf>, EnsembleError> {
        let at = |name: &str| folder.join(name);
        self.write_table(reduced, &at("members.csv"))?;
        if reduced.computed() == 0 {
            let first =
                reduced.failures().next().map_or((0, String::new()), |(k, text)| (k, text.to_owned()));
            let count = reduced.failures().count();
            return Err(EnsembleError::AllFailed { count, number: first.0, failure: first.1 });
        }
        let wanted = |name: &str| self.run_plan().output.files.iter().any(|kind| kind.name == name);
        let maps = self.maps(reduced);
        let mut files = vec![at("members.csv"), at("ensemble.json")];
        self.write_numbers(reduced, &maps, &at("ensemble.json"))?;
        if wanted("netcdf") {
            self.write_member_file(reduced, &at("members.nc"), command)?;
            self.write_maps(&maps, &at("result.nc"), command)?;
            files.extend([at("members.nc"), at("result.nc")]);
        }
        if wanted("geotiff") {
            files.extend(self.write_rasters(&maps, &at("rasters"))?);
        }
        if wanted("figures") || wanted("report") {
            let figures = self.draw(reduced, &maps, &at("figures"))?;
            files.extend(figures.iter().map(|figure| figure.path.clone()));
            if wanted("report") {
                self.write_report(reduced, figures, &at("report.html"))?;
                files.push(at("report.html"));
            }
        }
        Ok(files)
    }

    /// `result.nc`: the maps, and the bed.
    fn write_maps(&self, maps: &[Map], path: &Path, command: &str) -> Result<(), EnsembleError> {
        Ok(self.dataset(maps, command).write(path, None)?)
    }

    /// What `result.nc` holds of these maps; `command` is its history.
    #[must_use]
    pub fn dataset<'a>(&'a self, maps: &'a [Map], command: &str) -> Dataset<'a> {
        let plane = self.plane();
        let (units, projected) = (plane.domain.units(), plane.domain.projected());
        let along = |axis, name: &str, places: &[f64]| {
            Axis::along(axis, name, places.to_vec(), units.length(), projected)
        };
        let mut axes = vec![along("X", "x", &plane.x)];
        if plane.dimensions() > 1 {
            axes.insert(0, along("Y", "y", &plane.y));
        }
        let names: Vec<String> = axes.iter().map(|axis| axis.name.clone()).collect();
        let variable = |map: &'a Map| Variable {
            name: map.name.clone(),
            long_name: map.long_name.clone(),
            units: map.units.to_owned(),
            axes: names.clone(),
            precision: Precision::F64,
            values: Values::Static((&map.values).into()),
        };
        let mut variables: Vec<Variable> = maps.iter().map(variable).collect();
        if let Some(bed) = plane.domain.elevation() {
            variables.push(Variable {
                name: "bed".to_owned(),
                long_name: "elevation of the bed of the case as it stands".to_owned(),
                units: units.length().to_owned(),
                axes: names.clone(),
                precision: Precision::F64,
                values: Values::Static(bed.into()),
            });
        }
        let (crs, terrain) = (plane.domain.crs(), plane.domain.elevation());
        Dataset { axes, variables, crs, terrain, ..self.about(command) }
    }

    /// `rasters/*.tif`, and beside each the style in which QGIS opens it.
    fn write_rasters(&self, maps: &[Map], folder: &Path) -> Result<Vec<PathBuf>, EnsembleError> {
        let Some(bed) = self.plane().domain.raster() else { return Ok(Vec::new()) };
        std::fs::create_dir_all(folder).map_err(unmade(folder))?;
        let write = |map: &Map| -> Result<[PathBuf; 2], EnsembleError> {
            let path = rasters::write(folder, &map.name, bed, &map.values)?;
            Ok([path, rasters::write_style(folder, &map.name, &self.style(map))?])
        };
        let written: Vec<[PathBuf; 2]> = maps.par_iter().map(write).collect::<Result<_, _>>()?;
        Ok(written.into_iter().flatten().collect())
    }

    /// `ensemble.json`: the ensemble in numbers.
    fn write_numbers(&self, reduced: &Reduced, maps: &[Map], path: &Path) -> Result<(), EnsembleError> {
        let plan = self.plan();
        let failures: Vec<_> = reduced
            .failures()
            .map(|(number, failure)| {
                let values = self.sample(number).overrides;
                serde_json::json!({ "member": number, "values": values, "failure": failure })
            })
            .collect();
        let classes = (!plan.percentiles.is_empty()).then_some(plan.classes);
        let numbers = serde_json::json!({
            "title": self.run_plan().title,
            "version": env!("CARGO_PKG_VERSION"),
            "members": reduced.rows.len(),
            "computed": reduced.computed(),
            "failed": failures.len(),
            "seed": plan.seed,
            "sampling": plan.sampling,
            "threshold": self.run_plan().output.threshold,
            "exceed": plan.exceed,
            "percentiles": plan.percentiles,
            "classes_of_a_doubling": classes,
            "maps": maps.iter().map(|map| map.name.as_str()).collect::<Vec<_>>(),
            "failures": failures,
        });
        whole_file(path, |out| {
            serde_json::to_writer_pretty(&mut *out, &numbers).map_err(io::Error::from)?;
            writeln!(out)
        })?;
        Ok(())
    }

    /// `members/N.nc`: the peaks of one member, where they are asked for.
    pub(super) fn write_member(&self, outcome: &Outcome, folder: &Path) -> Result<(), EnsembleError> {
        let Ok(computed) = &outcome.result else { return Ok(()) };
        let path = folder.join(format!("members/{:06}.nc", outcome.member.number));
        let maps: Vec<Map> =
            computed.maps.iter().zip(&self.names).map(|(values, name)| self.peak(name, values)).collect();
        self.write_maps(&maps, &path, &outcome.member.overrides.join(" "))
    }
}
