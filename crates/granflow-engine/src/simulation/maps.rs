//! The summary maps of a run.

use super::state::Simulation;
use crate::observe::Maps;
use granflow_model::scheme::Scheme;

impl<const D: usize, S: Scheme<D, f64>> Simulation<D, S> {
    /// Keep summary maps from now on, beginning with the state as it stands; counted is what is thicker than
    /// `threshold` (units of the thickness, normal to the bed).
    pub fn keep_maps(&mut self, threshold: f64) {
        let mut maps = Maps::new(&self.layout, threshold);
        for number in 0..self.grid.count() {
            let index = self.grid.index(number);
            maps.begin(self.place(index), &self.diagnostics(index), self.time);
        }
        self.maps = Some(maps);
    }
    /// The summary maps, where they are kept.
    pub fn maps(&self) -> Option<&Maps> {
        self.maps.as_ref()
    }
    /// The summary maps by name, padded, to be overwritten; none where they are not kept.
    pub fn maps_mut(&mut self) -> impl Iterator<Item = (&'static str, &mut [f32])> {
        self.maps.iter_mut().flat_map(Maps::named_mut)
    }
    /// The summary maps by name, x fastest, each copied when all else and those before it are given back.
    pub fn into_maps(self) -> Vec<(&'static str, Vec<f64>)> {
        let Simulation { maps, layout, now, next, grounds, .. } = self;
        drop((now, next, grounds));
        let named = maps.into_iter().flat_map(Maps::into_named);
        named.map(|(name, map)| (name, layout.unpadded(&map))).collect()
    }
}
