//! Parameters of friction that differ from place to place, read for the cells of a mountain.

use crate::StartError;
use crate::inputs::Inputs;
use granflow_case::RunPlan;
use granflow_case::avalanche::{FOREST, InSpace, Material, Place};
use granflow_geo::Remark;
use granflow_geo::raster::{Crs, Raster, Reading};
use granflow_geo::release::ReleaseError;
use granflow_model::savage_hutter::friction::Parameters;

/// The numbers of the law in the cells of a mountain.
pub(crate) struct InCells {
    /// Where they are the same everywhere.
    usual: Parameters<f64>,
    /// Those that differ: which number it is, and its value in each cell; not a number outside the data.
    fields: Vec<(usize, Vec<f64>)>,
    /// Each parameter with its least and its largest value, as a case writes it.
    pub ranges: Vec<(String, [f64; 2])>,
}

impl InCells {
    /// One set of parameters for all cells.
    pub fn everywhere(material: &Material) -> InCells {
        InCells { usual: Parameters::of(&material.law), fields: Vec::new(), ranges: Vec::new() }
    }

    /// Reads what differs from place to place, on the cells of `bed`; each value must be one that the law takes.
    pub fn read(
        run: &RunPlan,
        material: &Material,
        inputs: &Inputs,
        (bed, crs): (&Raster, Option<&Crs>),
        remarks: &mut Vec<Remark>,
    ) -> Result<InCells, StartError> {
        let mut cells = Self::everywhere(material);
        for parameter in &material.in_space {
            let first = |cell| cells.number(0, cell);
            let (values, [least, largest]) = read(run, parameter, inputs, (bed, crs), first, remarks)?;
            if parameter.index == FOREST || !matches!(parameter.place, Place::Everywhere(_)) {
                cells.ranges.push((parameter.key.clone(), [least, largest]));
            }
            cells.fields.push((parameter.index, values));
        }
        Ok(cells)
    }

    /// The number of cells for which something differs.
    pub fn count(&self) -> usize {
        self.fields.first().map_or(0, |(_, values)| values.len())
    }

    /// Number `k` of the law in a cell. (The first one, with which others are compared, is as a case writes it.)
    fn number(&self, k: usize, cell: usize) -> f64 {
        self.fields
            .iter()
            .find(|(index, _)| *index == k)
            .map_or(self.usual.get(k), |(_, values)| values[cell])
    }

    /// The parameters of a cell.
    pub fn at(&self, cell: usize) -> Parameters<f64> {
        let here = self.fields.iter().filter(|(_, values)| !values[cell].is_nan());
        let mut all = self.usual;
        for (index, values) in here {
            match *index {
                FOREST => all.drag = values[cell],
                index => all = all.with(index, values[cell]),
            }
        }
        all
    }
}

/// A parameter on the cells of a bed, not a number outside the data, with its least and its largest value as a case writes it. Each must
/// be one that it can have; `first` is the first parameter of the law.
pub(super) fn read(
    run: &RunPlan,
    parameter: &InSpace,
    inputs: &Inputs,
    (bed, crs): (&Raster, Option<&Crs>),
    first: impl Fn(usize) -> f64,
    remarks: &mut Vec<Remark>,
) -> Result<(Vec<f64>, [f64; 2]), StartError> {
    let mut values = values(run, parameter, inputs, (bed, crs), remarks)?;
    let (mut least, mut largest) = (f64::INFINITY, f64::NEG_INFINITY);
    for (cell, (value, level)) in values.iter_mut().zip(&bed.values).enumerate() {
        if level.is_nan() {
            *value = f64::NAN;
            continue;
        }
        if !parameter.range.fits(*value, first(cell)) {
            return Err(fault(run, parameter, bed, cell, *value));
        }
        (least, largest) = (least.min(*value), largest.max(*value));
        *value /= parameter.per;
    }
    Ok((values, [least, largest]))
}

/// The values of a parameter on the cells of a bed.
fn values(
    run: &RunPlan,
    InSpace { key, place, .. }: &InSpace,
    inputs: &Inputs,
    (bed, crs): (&Raster, Option<&Crs>),
    remarks: &mut Vec<Remark>,
) -> Result<Vec<f64>, StartError> {
    let (mut values, elsewhere) = match place {
        Place::Raster(path, elsewhere) => {
            let Reading { raster, notes, .. } = inputs.numbers(path, bed.crs.as_ref().or(crs))?;
            remarks.extend(notes);
            raster.same_system(path, bed)?;
            let at = |k: usize| {
                let cell = raster.cell_at([bed.x(k % bed.columns), bed.y(k / bed.columns)]);
                cell.map_or(f64::NAN, |cell| raster.values[cell])
            };
            let values: Vec<f64> = (0..bed.values.len()).map(at).collect();
            if values.iter().all(|value| value.is_nan()) {
                let (x, y) = ([raster.west, raster.east()], [raster.south, raster.north()]);
                let message = format!("{}: it has no value for any cell of the terrain", path.display());
                let cure = format!(
                    "it lies at x {} to {}, y {} to {}: give one of the same place",
                    x[0], x[1], y[0], y[1]
                );
                return Err(run.fault(key, message, &cure).into());
            }
            (values, *elsewhere)
        }
        Place::Polygons(path, attribute, elsewhere) => {
            let layer = inputs.layer(path)?;
            remarks.extend(layer.notes(bed));
            let unusable = |error: ReleaseError| match error {
                ReleaseError::Attribute { .. } | ReleaseError::Value { .. } => {
                    let cure = "name one of its attributes that holds numbers, as in attribute = \"mu\"";
                    StartError::from(run.fault(&format!("{key}.attribute"), error.to_string(), cure))
                }
                _ => StartError::from(error),
            };
            (layer.zones(attribute, bed).map_err(unusable)?, *elsewhere)
        }
        Place::ByElevation(classes) => {
            return Ok(bed.values.iter().map(|level| classes.at(*level)).collect());
        }
        Place::Everywhere(value) => return Ok(vec![*value; bed.values.len()]),
    };
    if let Some(elsewhere) = elsewhere {
        values.iter_mut().filter(|value| value.is_nan()).for_each(|value| *value = elsewhere);
    }
    Ok(values)
}

/// A value that the law does not take, or none.
fn fault(run: &RunPlan, parameter: &InSpace, bed: &Raster, cell: usize, value: f64) -> StartError {
    let InSpace { key, place, range, .. } = parameter;
    let file = match place {
        Place::Raster(path, _) | Place::Polygons(path, _, _) => format!("{}: ", path.display()),
        Place::ByElevation(_) | Place::Everywhere(_) => String::new(),
    };
    let [column, row] = bed.place(cell);
    let at = format!("at ({}, {})", bed.x(column), bed.y(row));
    let allowed = range.allowed();
    if value.is_nan() {
        let message = format!("{file}no value {at}, where the terrain has one");
        let cure = format!("say what holds there, for instance elsewhere = 0.4 beside it ({allowed})");
        return run.fault(key, message, &cure).into();
    }
    run.fault(key, format!("{file}found {value} {at}, expected {allowed}"), "mend the file").into()
}
