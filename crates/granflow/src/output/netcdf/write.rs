//! How a dataset becomes a file: the skeleton first, then the numbers, part by part.

use super::{Dataset, Values, Variable};
use crate::output::frames::Frames;
use crate::output::hdf5::{Block, allocate};
use crate::output::{Error, Precision, whole_file};
use netcdf_writer::{DimensionId, NcAttrValue, NcFileBuilder, NcWriteFormat, NcWriteOptions, VariableId};
use std::io::{self, Write};
use std::path::Path;

/// An attribute of HDF5 must fit 64 KiB unless it stands in the heap; longer texts go there.
const LONGEST_INLINE_TEXT: usize = 60_000;

/// Numbers of a map that are turned into bytes in one go.
const PART: usize = 1 << 15;

impl Dataset<'_> {
    /// Writes the file as a whole; stored series pass through memory one field of one frame at a time.
    ///
    /// # Errors
    /// [`Error::Invalid`] if names, shapes and frames do not fit together; [`Error::Io`], [`Error::Damaged`].
    pub fn write(&self, path: &Path, frames: Option<&mut Frames>) -> Result<(), Error> {
        let layout = self.layout(frames.as_deref()).map_err(|problem| Error::invalid(path, problem))?;
        whole_file(path, |out| self.stream(&layout, frames, out))
    }

    /// The bytes of the file, where no series is stored on disk.
    ///
    /// # Errors
    /// [`Error::Invalid`] if names and shapes do not fit together.
    pub fn to_bytes(&self) -> Result<Vec<u8>, Error> {
        let name = Path::new("result.nc");
        let layout = self.layout(None).map_err(|problem| Error::invalid(name, problem))?;
        let mut bytes = Vec::new();
        self.stream(&layout, None, &mut bytes).map_err(Error::io(name, "write"))?;
        Ok(bytes)
    }

    /// Where everything stands in the file, after checking that it fits together.
    fn layout(&self, frames: Option<&Frames>) -> Result<Layout, String> {
        let plan = self.plan(frames)?;
        let mut skeleton = self.skeleton().map_err(|error| error.to_string())?;
        let sizes: Vec<_> = self.variables.iter().zip(&plan).map(|(v, maps)| maps.bytes(v)).collect();
        let blocks = allocate(&mut skeleton, &sizes)?;
        Ok(Layout { plan, skeleton, blocks })
    }

    fn stream(
        &self,
        Layout { plan, skeleton, blocks }: &Layout,
        mut frames: Option<&mut Frames>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        out.write_all(skeleton)?;
        let mut position = skeleton.len() as u64;
        for ((variable, maps), block) in self.variables.iter().zip(plan).zip(blocks) {
            let Block { address, size } = *block;
            out.write_all(&vec![0; (address - position) as usize])?;
            self.write_maps(variable, maps, frames.as_deref_mut(), out)?;
            position = address + size;
        }
        Ok(())
    }

    fn write_maps(
        &self,
        variable: &Variable,
        maps: &Maps,
        mut frames: Option<&mut Frames>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        let precision = variable.precision;
        let terrain = self.mask(variable, maps.length);
        let mut nothing = Vec::new();
        precision.encode(&[f64::NAN], &mut nothing);
        let mut bytes = Vec::new();
        // Part by part: a map is a good share of what a run takes.
        let part = |from: usize| from..(from + PART).min(maps.length);
        let parts = || (0..maps.length).step_by(PART).map(part);
        for (instant, part) in (0..maps.count).flat_map(|instant| parts().map(move |part| (instant, part))) {
            bytes.clear();
            match (&variable.values, frames.as_deref_mut()) {
                (Values::Static(map), _) => precision.encode(&map[part.clone()], &mut bytes),
                (Values::Series(series), _) => precision.encode(&series[instant][part.clone()], &mut bytes),
                (Values::Stored(_), Some(frames)) => {
                    let read = frames.read_bytes(instant, maps.field, part.clone(), &mut bytes);
                    read.map_err(io::Error::other)?;
                    // What is stored as it is wanted is not taken apart.
                    if frames.precision() != precision {
                        let values = frames.precision().decode(&bytes);
                        bytes.clear();
                        precision.encode(&values, &mut bytes);
                    }
                }
                (Values::Stored(_), None) => unreachable!("plan() has refused this"),
            }
            if let Some(terrain) = terrain {
                let cells = bytes.chunks_exact_mut(precision.width()).zip(&terrain[part]);
                cells.filter(|(_, z)| z.is_nan()).for_each(|(cell, _)| cell.copy_from_slice(&nothing));
            }
            out.write_all(&bytes)?;
        }
        Ok(())
    }

    /// How many maps of which length each variable has, after checking that everything fits.
    fn plan(&self, frames: Option<&Frames>) -> Result<Vec<Maps>, String> {
        for axis in &self.axes {
            if axis.values.is_empty() {
                return Err(format!("axis {} has no values", axis.name));
            }
        }
        self.variables.iter().map(|variable| self.maps(variable, frames)).collect()
    }

    fn maps(&self, variable: &Variable<'_>, frames: Option<&Frames>) -> Result<Maps, String> {
        let name = &variable.name;
        let size = |own: &String| {
            let axis = self.axes.iter().find(|axis| axis.name == *own);
            axis.map(|axis| axis.values.len())
                .ok_or_else(|| format!("variable {name} lies on axis {own}, which is not given"))
        };
        let sizes: Vec<_> = variable.axes.iter().map(size).collect::<Result<_, _>>()?;
        let timed = variable.axes.first().is_some_and(|first| first == "time");
        let (count, length) = (if timed { sizes[0] } else { 1 }, sizes.iter().skip(timed.into()).product());
        let mut field = 0;
        let (found, lengths): (usize, Vec<usize>) = match &variable.values {
            Values::Static(map) => (1, vec![map.len()]),
            Values::Series(series) => (series.len(), series.iter().map(Vec::len).collect()),
            Values::Stored(stored) => {
                let frames = frames.ok_or_else(|| format!("variable {name} needs the store of frames"))?;
                field = frames
                    .position(stored)
                    .ok_or_else(|| format!("the store of frames has no field {stored}"))?;
                (frames.times().len(), vec![frames.fields()[field].length])
            }
        };
        if timed == matches!(variable.values, Values::Static(_)) || variable.axes.is_empty() {
            return Err(format!(
                "variable {name} on axes {:?} does not fit values of its kind",
                variable.axes
            ));
        }
        if found != count || lengths.iter().any(|&own| own != length) {
            return Err(format!(
                "variable {name} should have {count} maps of {length} values, found {found} of {lengths:?}"
            ));
        }
        Ok(Maps { count, length, field })
    }

    fn skeleton(&self) -> netcdf_writer::Result<Vec<u8>> {
        let mut file = NcFileBuilder::new();
        for (name, value) in self.described() {
            file.add_attribute(name, text(value))?;
        }
        let mut dimensions: Vec<(&str, DimensionId)> = Vec::new();
        for axis in &self.axes {
            let id = file.add_dimension(&axis.name, axis.values.len() as u64)?;
            dimensions.push((&axis.name, id));
        }
        for (axis, &(_, dimension)) in self.axes.iter().zip(&dimensions) {
            let id = file.add_variable::<f64>(&axis.name, &[dimension])?;
            file.write_variable(id, &axis.values)?;
            describe(&mut file, id, axis.described())?;
        }
        if let Some(crs) = &self.crs {
            let id = file.add_variable::<i32>("crs", &[])?;
            file.write_variable(id, &[0])?;
            describe(&mut file, id, crs.described().iter().map(|(name, value)| (*name, value.as_str())))?;
            if let Some(code) = crs.number() {
                file.add_variable_attribute(id, "epsg", NcAttrValue::Ints(vec![code]))?;
            }
        }
        for variable in &self.variables {
            let dimension =
                |axis: &String| dimensions.iter().find(|(name, _)| name == axis).map(|&(_, id)| id);
            let axes: Vec<_> = variable.axes.iter().filter_map(dimension).collect(); // plan() has found them all
            let id = match variable.precision {
                Precision::F32 => {
                    let id = file.add_variable::<f32>(&variable.name, &axes)?;
                    file.set_variable_fill_value(id, f32::NAN)?;
                    id
                }
                Precision::F64 => {
                    let id = file.add_variable::<f64>(&variable.name, &axes)?;
                    file.set_variable_fill_value(id, f64::NAN)?;
                    id
                }
            };
            describe(&mut file, id, self.described_variable(variable))?;
        }
        Ok(file.to_vec(NcWriteOptions { format: NcWriteFormat::Nc4 })?.1)
    }
}

/// The file but for its numbers: the maps of each variable, the skeleton, and where the numbers go.
struct Layout {
    plan: Vec<Maps>,
    skeleton: Vec<u8>,
    blocks: Vec<Block>,
}

/// The maps of one variable: how many, how long, and which field of the store.
struct Maps {
    count: usize,
    length: usize,
    field: usize,
}

impl Maps {
    fn bytes(&self, variable: &Variable) -> u64 {
        (self.count * self.length * variable.precision.width()) as u64
    }
}

fn describe<'a>(
    file: &mut NcFileBuilder,
    id: VariableId,
    attributes: impl IntoIterator<Item = (&'a str, &'a str)>,
) -> netcdf_writer::Result<()> {
    attributes.into_iter().try_for_each(|(name, value)| file.add_variable_attribute(id, name, text(value)))
}

fn text(value: &str) -> NcAttrValue {
    if value.len() > LONGEST_INLINE_TEXT {
        NcAttrValue::Strings(vec![value.into()])
    } else {
        NcAttrValue::Chars(value.into())
    }
}
