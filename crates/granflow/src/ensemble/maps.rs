//! The maps of an ensemble.

use super::Ensemble;
use super::reduced::{Peaks, Reduced};

/// What a map of an ensemble shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measure {
    /// How many members reached the cell.
    Members,
    /// The share of the members that exceeded this threshold.
    Exceedance(f64),
    /// The value that so many percent of the members do not exceed.
    Percentile(f64),
    /// The mean of all members, 0 for those that did not come.
    Mean,
    /// The largest of all members.
    Largest,
}

/// A map of an ensemble, x fastest, the first row in the south; not a number where no member came.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// Name in all files.
    pub name: String,
    /// What it is, in words.
    pub long_name: String,
    /// Units after UDUNITS.
    pub units: &'static str,
    /// The map of a member that it is of, as `peak_thickness`; empty where it is of none.
    pub quantity: String,
    /// What it shows.
    pub measure: Measure,
    /// The values.
    pub values: Vec<f64>,
}

impl Ensemble {
    /// The maps of what was added up: members that reached a cell, and of each quantity exceedance, percentiles, mean and largest.
    /// Members that failed count in none.
    #[must_use]
    pub fn maps(&self, reduced: &Reduced) -> Vec<Map> {
        let count = reduced.computed();
        let threshold = self.run.output.threshold;
        let unit = self.plane().domain.units().label(" m");
        let mut maps = vec![Map {
            name: "count".to_owned(),
            long_name: format!("number of members, of {count}, with a layer thicker than {threshold}{unit}"),
            units: "1",
            quantity: String::new(),
            measure: Measure::Members,
            values: at(reduced, |cell| f64::from(reduced.reached[cell])),
        }];
        for peaks in &reduced.peaks {
            maps.extend(self.of_peaks(peaks, reduced, count));
        }
        maps
    }

    /// The map of one member.
    pub(super) fn peak(&self, name: &str, values: &[f64]) -> Map {
        let quantity = self.plane.model().quantity(name);
        Map {
            name: name.to_owned(),
            long_name: quantity.map_or("", |quantity| quantity.long_name).to_owned(),
            units: quantity.map_or("1", |quantity| quantity.units_in(self.plane.domain.units())),
            quantity: name.to_owned(),
            measure: Measure::Largest,
            values: values.to_vec(),
        }
    }

    fn of_peaks(&self, peaks: &Peaks, reduced: &Reduced, count: u32) -> Vec<Map> {
        let quantity = peaks.name.clone();
        let words = quantity.replace('_', " ");
        let units = self.plane.model().quantity(&peaks.name);
        let units = units.map_or("1", |quantity| quantity.units_in(self.plane.domain.units()));
        let unit = if units == "1" { String::new() } else { format!(" {units}") };
        let map = |name: String, long_name: String, units, measure, values| Map {
            name,
            long_name,
            units,
            quantity: quantity.clone(),
            measure,
            values,
        };
        let mut maps = Vec::new();
        for (threshold, above) in peaks.thresholds.iter().zip(&peaks.above) {
            maps.push(map(
                format!("exceedance_{quantity}_{}", spelt(*threshold)),
                format!("share of the members whose {words} exceeded {threshold}{unit}"),
                "1",
                Measure::Exceedance(*threshold),
                at(reduced, |cell| f64::from(above[cell]) / f64::from(count)),
            ));
        }
        if let Some(bits) = reduced.bits {
            for percent in &self.plan.percentiles {
                maps.push(map(
                    format!("p{}_{quantity}", of_two_digits(*percent)),
                    format!("{words} that {percent} % of the members do not exceed"),
                    units,
                    Measure::Percentile(*percent),
                    at(reduced, |cell| {
                        let value = peaks.classes[cell].percentile(percent / 100.0, count, bits);
                        value.min(peaks.largest[cell])
                    }),
                ));
            }
        }
        maps.push(map(
            format!("mean_{quantity}"),
            format!("mean {words} of all members, 0 for those that did not come"),
            units,
            Measure::Mean,
            at(reduced, |cell| peaks.mean(cell, count)),
        ));
        maps.push(map(
            format!("max_{quantity}"),
            format!("largest {words} of all members"),
            units,
            Measure::Largest,
            at(reduced, |cell| peaks.largest[cell]),
        ));
        maps
    }
}

/// Values where a member came.
fn at(reduced: &Reduced, value: impl Fn(usize) -> f64) -> Vec<f64> {
    let of = |(cell, reached): (usize, &u32)| if *reached > 0 { value(cell) } else { f64::NAN };
    reduced.reached.iter().enumerate().map(of).collect()
}

/// A percentage as a part of a name: 5 is 05, 2.5 is 02_5.
fn of_two_digits(percent: f64) -> String {
    let spelt = spelt(percent);
    if percent < 10.0 { format!("0{spelt}") } else { spelt }
}

/// A number as a part of a name: 0.5 is 0_5.
fn spelt(number: f64) -> String {
    format!("{number}").replace('.', "_").replace('-', "m")
}
