//! What another run left on a chute, under the layer of the next one.

use crate::StartError;
use crate::inputs::Inputs;
use granflow_case::chute::Plan;

/// The thickness in every cell at rest under the layer of the case, x fastest.
#[derive(Default)]
pub(crate) struct Laid {
    thickness: Vec<f64>,
    /// What a user should know of it, beginning with `note: ` or `warning: `.
    pub remarks: Vec<String>,
}

impl Laid {
    /// What the case names; nothing where it names nothing.
    #[cfg(feature = "files")]
    pub fn of(plan: &Plan, inputs: &Inputs) -> Result<Laid, StartError> {
        plan.initial
            .result
            .as_deref()
            .map_or_else(|| Ok(Laid::default()), |path| read::laid(path, plan, inputs))
    }

    /// Nothing: a result is read with the feature `files`.
    #[cfg(not(feature = "files"))]
    pub fn of(plan: &Plan, _: &Inputs) -> Result<Laid, StartError> {
        match plan.initial.result {
            None => Ok(Laid::default()),
            Some(_) => Err(StartError::Feature { feature: "files" }),
        }
    }

    /// The thickness in cell number `cell` together with that of the case, `own`.
    pub fn with(&self, cell: usize, own: f64) -> f64 {
        self.thickness.get(cell).map_or(own, |laid| laid + own)
    }
}

#[cfg(feature = "files")]
mod read {
    use super::super::super::ended::{self, Ended};
    use super::{Inputs, Laid, Plan, StartError};
    use granflow_case::{Axis, Case, Kind, NoFiles};
    use granflow_model::real::CompensatedSum;
    use std::path::Path;

    /// The share of the volume that may lie beyond the grid, by rounding.
    const LOST: f64 = 1e-9;
    /// Centres apart by this share of a cell are the same: they were rounded.
    const SAME: f64 = 1e-6;

    pub(super) fn laid(path: &Path, plan: &Plan, inputs: &Inputs) -> Result<Laid, StartError> {
        let unusable = |problem| StartError::Result { path: path.to_owned(), place: "a chute", problem };
        if inputs.holds(path) {
            let problem = "it is in memory, and what a run left is read from the disk";
            return Err(unusable(problem.to_owned()));
        }
        let ended = ended::open(path, false).map_err(unusable)?;
        let thickness = thickness(&ended, plan).map_err(unusable)?;
        let (rests, text) = ended::remark(path, &ended.time.to_string(), ended.rests);
        let kind = if rests { "note" } else { "warning" };
        let mut remarks = vec![format!("{kind}: {text}")];
        if let Some(epsilon) = epsilon(&ended.file.text("case")).filter(|epsilon| *epsilon != plan.epsilon) {
            remarks.push(format!(
                "warning: {}: its thickness was scaled with epsilon = {epsilon}, this case has {}; its numbers are taken as they are",
                path.display(),
                plan.epsilon
            ));
        }
        Ok(Laid { thickness, remarks })
    }

    /// H/L of the case of a result, where that can be read without other files.
    fn epsilon(case: &str) -> Option<f64> {
        let written = ["output = {}".to_owned()];
        match Case::parse_with(case, "case", &written).ok()?.check(&NoFiles).ok()?.kind {
            Kind::Chute(plan) => Some(plan.epsilon),
            _ => None,
        }
    }

    /// The last thickness of a run on the cells of the plan: by number where the cells are the same, else by area, so that the
    /// volume stays.
    fn thickness(ended: &Ended, plan: &Plan) -> Result<Vec<f64>, String> {
        let file = &ended.file;
        let axes: Vec<&Axis> = std::iter::once(&plan.grid.x).chain(&plan.grid.y).collect();
        let dimensions = 1 + usize::from(file.has("y"));
        if dimensions != axes.len() {
            return Err(format!("it has {dimensions} dimensions, this case {}", axes.len()));
        }
        let values = file.instant("thickness", ended.instant, dimensions)?;
        let names = ["x", "y"];
        let centres =
            names[..dimensions].iter().map(|name| file.whole(name)).collect::<Result<Vec<_>, _>>()?;
        if values.len() != centres.iter().map(Vec::len).product::<usize>() {
            return Err("its thickness does not fit its coordinates".to_owned());
        }
        if let Some(wrong) = values.iter().find(|h| !(0.0..=f64::MAX).contains(*h)) {
            return Err(format!("it has a thickness of {wrong}"));
        }
        let total = sum(&values);
        if total == 0.0 {
            return Err("nothing lay on it at its end".to_owned());
        }
        let same = |(own, centres): (&&Axis, &Vec<f64>)| {
            let near = |(k, centre): (usize, &f64)| (own.centre(k) - centre).abs() <= SAME * own.width();
            own.cells == centres.len() && centres.iter().enumerate().all(near)
        };
        if axes.iter().zip(&centres).all(same) {
            return Ok(values);
        }
        let shares = axes.iter().zip(&centres).map(|(own, centres)| overlaps(own, centres));
        let shares = shares.collect::<Result<Vec<_>, _>>()?;
        let along = &shares[0];
        let whole = vec![vec![(0, 1.0)]];
        let across = shares.get(1).unwrap_or(&whole);
        let row = |from: usize, cell: &[(usize, f64)]| -> f64 {
            cell.iter().map(|(k, share)| share * values[from * centres[0].len() + k]).sum()
        };
        let cell = |y: &[(usize, f64)], x: &[(usize, f64)]| -> f64 {
            y.iter().map(|(j, share)| share * row(*j, x)).sum()
        };
        let carried: Vec<f64> = across.iter().flat_map(|y| along.iter().map(|x| cell(y, x))).collect();
        let sizes = axes.iter().zip(&centres).map(|(own, centres)| Ok(own.width() / width(centres)?));
        let sizes = sizes.product::<Result<f64, String>>()?;
        let lost = 1.0 - sum(&carried) * sizes / total;
        if lost > LOST {
            return Err(format!(
                "{:.4} % of what lay on it lies beyond the grid of this case, which has to be larger",
                100.0 * lost
            ));
        }
        Ok(carried)
    }

    fn sum(values: &[f64]) -> f64 {
        let mut sum = CompensatedSum::default();
        values.iter().for_each(|value| sum.add(*value));
        sum.value()
    }

    /// The size of cells with these centres, from all of them: one difference far from 0 would be rounding.
    fn width(centres: &[f64]) -> Result<f64, String> {
        let [first, .., last] = centres else {
            return Err("it has fewer than two cells along an axis".to_owned());
        };
        let width = (last - first) / (centres.len() - 1) as f64;
        let even = |(k, centre): (usize, &f64)| (first + k as f64 * width - centre).abs() <= SAME * width;
        if width > 0.0 && centres.iter().enumerate().all(even) {
            Ok(width)
        } else {
            Err("the centres of its cells are not evenly apart, in growing order".to_owned())
        }
    }

    /// For each cell of an axis the cells with these centres that overlap it, each with the share of the own cell that it covers.
    fn overlaps(own: &Axis, centres: &[f64]) -> Result<Vec<Vec<(usize, f64)>>, String> {
        let width = width(centres)?;
        let (low, size) = (centres[0] - 0.5 * width, own.width());
        let place = |edge: f64| ((edge - low) / width).clamp(0.0, centres.len() as f64);
        let cells = (0..own.cells).map(|k| {
            let [from, to] = [k, k + 1].map(|k| place(own.from + k as f64 * size));
            let touched = from.floor() as usize..to.ceil() as usize;
            let share = |j: usize| (to.min((j + 1) as f64) - from.max(j as f64)).max(0.0) * width / size;
            touched.map(|j| (j, share(j))).collect()
        });
        Ok(cells.collect())
    }

    #[cfg(test)]
    mod tests {
        use super::{overlaps, width};
        use granflow_case::Axis;

        /// Far from 0 the difference of two centres has few digits; the volume is that of the cells all the same.
        #[test]
        fn far_from_0_the_volume_stays() {
            for from in [0.0, 377_650.3, 5e6] {
                let centres: Vec<f64> = (0..240).map(|k| from + (f64::from(k) + 0.5) * 0.1).collect();
                assert!((width(&centres).unwrap() / 0.1 - 1.0).abs() < 1e-9, "{from}");
                let own = Axis { from, to: from + 24.0, cells: 57 };
                let shares = overlaps(&own, &centres).unwrap();
                let volume: f64 = shares.iter().flatten().map(|(_, share)| share * own.width()).sum();
                assert!((volume / 24.0 - 1.0).abs() < 1e-10, "{from}: {volume}");
            }
        }

        #[test]
        fn cells_of_different_sizes_are_refused() {
            for centres in [&[0.0, 1.0, 2.5][..], &[2.0, 1.0, 0.0], &[0.0, f64::NAN, 2.0], &[1.0]] {
                assert!(width(centres).is_err(), "{centres:?}");
            }
        }
    }
}
