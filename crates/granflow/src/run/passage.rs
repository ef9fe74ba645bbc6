//! What passes sections: sums of the scheme's own fluxes through faces.

use super::Face;
use granflow_engine::simulation::Simulation;
use granflow_model::real::CompensatedSum;
use granflow_model::scheme::Scheme;

/// What has passed a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Volume per time in the last step; NaN before the first one.
    pub discharge: f64,
    /// Volume since the start.
    pub volume: f64,
}

/// Sections, and what has passed them up to the end of the last step.
#[derive(Debug, Default)]
pub(super) struct Passages {
    /// The faces of all sections, each once.
    faces: Vec<Face>,
    sections: Vec<Section>,
    /// When the last step began and ended.
    step: [f64; 2],
}

#[derive(Debug, Default)]
struct Section {
    /// Numbers of its faces, and which way through them counts.
    faces: Vec<(usize, f64)>,
    sum: CompensatedSum,
    /// Volume of the last step.
    last: f64,
}

impl Passages {
    /// Nothing has passed these yet.
    pub fn through(sections: Vec<Vec<(Face, f64)>>) -> Passages {
        let mut faces: Vec<Face> = sections.iter().flatten().map(|(face, _)| *face).collect();
        faces.sort_unstable();
        faces.dedup();
        // A face that is not found is none of the faces, which are all of them.
        let numbered = |(face, way): (Face, f64)| Some((faces.binary_search(&face).ok()?, way));
        let section = |own: Vec<(Face, f64)>| Section {
            faces: own.into_iter().filter_map(numbered).collect(),
            ..Section::default()
        };
        let sections = sections.into_iter().map(section).collect();
        Passages { faces, sections, step: [f64::NAN; 2] }
    }

    pub fn is_empty(&self) -> bool {
        self.sections.is_empty()
    }

    /// Add what passed in the step that has just been taken, from time `begin` on.
    pub fn take<const D: usize, S: Scheme<D, f64>>(&mut self, simulation: &mut Simulation<D, S>, begin: f64) {
        if self.is_empty() {
            return;
        }
        let passed = simulation.passed(&self.faces);
        for section in &mut self.sections {
            let mut volume = CompensatedSum::default();
            section.faces.iter().for_each(|&(face, way)| volume.add(way * passed[face]));
            section.last = volume.value();
            section.sum.add(section.last);
        }
        self.step = [begin, simulation.time()];
    }

    /// What had passed at a time within the last step, at a steady rate in it, or at its end.
    pub fn at(&self, time: f64) -> Vec<Passage> {
        let [begin, end] = self.step;
        let length = end - begin;
        let hidden = if time < end { (end - time) / length } else { 0.0 };
        let passage = |section: &Section| Passage {
            discharge: section.last / length,
            volume: section.sum.value() - hidden * section.last,
        };
        self.sections.iter().map(passage).collect()
    }

    pub fn save(&self) -> Vec<[f64; 2]> {
        self.sections.iter().map(|section| section.sum.parts()).collect()
    }

    /// Go on from what [`Passages::save`] gave; false where it is of another number of sections.
    pub fn restore(&mut self, saved: &[[f64; 2]], time: f64) -> bool {
        for (section, parts) in self.sections.iter_mut().zip(saved) {
            (section.sum, section.last) = (CompensatedSum::from_parts(*parts), f64::NAN);
        }
        self.step = [f64::NAN, time];
        saved.len() == self.sections.len()
    }
}
