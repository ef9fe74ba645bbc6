//! The series and maps of a run as csv tables, and as frames for ParaView.

use crate::model::{At, Kind};
use crate::output::{self, csv, vtk};
use crate::results::Finished;
use crate::results::format::Format;
use granflow_case::FileKind;
use std::path::{Path, PathBuf};

/// Tables.
pub(super) static CSV: Format =
    Format::of(FileKind { name: "csv", about: "The fields as tables.", needs_terrain: false }, |work| {
        Ok(work.run.write_csv()?)
    });
/// ParaView.
pub(super) static VTK: Format =
    Format::of(FileKind { name: "vtk", about: "The fields for ParaView.", needs_terrain: false }, |work| {
        Ok(work.run.write_vtk()?)
    });

impl Finished {
    /// `profiles.csv`: every instant of a line; `maps.csv`: the summary maps of a plane, a line per cell. Quantities at nodes
    /// go to `profiles_node.csv` and `maps_node.csv`.
    fn write_csv(&self) -> Result<Vec<PathBuf>, output::Error> {
        let mut frames = self.frames.again()?;
        let mut written = Vec::new();
        let mut places = vec![("", self.plane.x.as_slice(), self.plane.y.as_slice())];
        places.extend(self.plane.domain.nodes().map(|[x, y]| ("_node", x, y)));
        for (at, x, y) in places {
            let kind = if y.is_empty() { "profiles" } else { "maps" };
            let path = self.directory.join(format!("{kind}{at}.csv"));
            let length = x.len() * y.len();
            if y.is_empty() {
                csv::write(&path, (&format!("x{at}"), x), &mut frames)?;
            } else {
                let mut maps: Vec<(&str, Vec<f64>)> = Vec::new();
                let series = self.plane.series();
                if self.plane.model().last_instant {
                    let last = frames.times().len().saturating_sub(1);
                    for (k, field) in series.iter().enumerate().filter(|(_, field)| field.length == length) {
                        maps.push((&field.name, frames.read(last, k)?));
                    }
                }
                maps.extend(self.still(length));
                write_maps(&path, at, (x, y), &maps)?;
            }
            written.push(path);
        }
        Ok(written)
    }

    /// The maps that do not change, with so many values.
    fn still(&self, length: usize) -> Vec<(&str, Vec<f64>)> {
        let model = self.plane.model();
        let tabulated = |name: &str| {
            model.of_kind(Kind::Fixed).any(|quantity| quantity.tabulated && quantity.name == name)
        };
        let fixed = self.plane.domain.fixed().into_iter().filter(|(name, _)| tabulated(name));
        let fixed = fixed.map(|(name, values)| (name, values.into_owned()));
        let maps = self.maps.iter().map(|(name, map)| (*name, map.clone()));
        fixed.chain(maps).filter(|(_, map)| map.len() == length).collect()
    }

    /// `result.pvd` and `vtk/frame_0000.vti`, ...
    fn write_vtk(&self) -> Result<Vec<PathBuf>, output::Error> {
        let mut frames = self.frames.again()?;
        let spacing = |c: &[f64]| c.get(1).map(|second| second - c[0]);
        let (x, y) = (&self.plane.x, &self.plane.y);
        let dx = spacing(x).unwrap_or(1.0);
        let dy = spacing(y).unwrap_or(dx);
        let low = |c: &[f64], d: f64| c.first().map_or(0.0, |first| first - 0.5 * d);
        let image = vtk::Image {
            cells: [x.len(), y.len().max(1)],
            origin: [low(x, dx), low(y, dy)],
            spacing: [dx, dy],
        };
        let (mut written, mut index) = (Vec::new(), Vec::new());
        let nodes = self.plane.length(At::Nodes);
        for (k, time) in frames.times().to_vec().into_iter().enumerate() {
            let names: Vec<String> = frames.fields().iter().map(|field| field.name.clone()).collect();
            let mut fields = Vec::new();
            for (field, name) in names.iter().enumerate() {
                fields.push((name.as_str(), frames.read(k, field)?));
            }
            if self.plane.model().last_instant {
                fields.extend(if nodes > 0 { self.still(nodes) } else { Vec::new() });
                fields.extend(self.still(self.plane.cells()));
            }
            if y.is_empty() && nodes > 0 {
                let line = fields.iter_mut().filter(|(_, values)| values.len() == nodes);
                line.for_each(|(_, values)| *values = values.repeat(2)); // a row of cells has two rows of nodes
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
