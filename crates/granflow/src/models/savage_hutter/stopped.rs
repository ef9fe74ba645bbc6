//! When almost all of a mass had stopped.

use crate::output::summary::Summary;
use crate::run::Maps;

/// The share of the deposit that must have stopped. The last of it seeps out of hollows until a time that no grid tells.
const SHARE: f64 = 0.95;

/// Put that time into the summary of a run that came to rest.
pub(super) fn note(maps: &Maps, areas: impl Fn(&[Option<usize>]) -> Vec<f64>, summary: &mut Summary) {
    if summary.stopping_time.is_some() {
        summary.add("stopping_time_95", stopped(maps, areas).unwrap_or(f64::NAN));
    }
}

/// The time after which no more than 5 % of the deposit moved in layers thicker than the threshold; 0 if no more ever did. `areas` is
/// the volume per plan area of a layer of thickness 1 in some cells.
fn stopped(maps: &Maps, areas: impl Fn(&[Option<usize>]) -> Vec<f64>) -> Option<f64> {
    let map = |wanted: &str| maps.iter().find(|(name, _)| *name == wanted).map(|(_, map)| map.as_slice());
    let (deposit, time) = (map("deposit")?, map("stopping_time")?);
    let cells: Vec<Option<usize>> = (0..deposit.len()).filter(|&k| deposit[k] > 0.0).map(Some).collect();
    let volume = |(cell, area): (usize, f64)| (time[cell].max(0.0), deposit[cell] * area);
    let mut stopped: Vec<(f64, f64)> =
        cells.iter().flatten().copied().zip(areas(&cells)).map(volume).collect();
    stopped.sort_by(|a, b| a.0.total_cmp(&b.0));
    let all: f64 = stopped.iter().map(|(_, volume)| volume).sum();
    let mut sum = 0.0;
    let reached = stopped.iter().find(|(_, volume)| {
        sum += volume;
        sum >= SHARE * all
    });
    reached.map(|(time, _)| *time)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_twentieth_is_not_waited_for() {
        let maps: Maps = vec![
            ("deposit", vec![2.0, f64::NAN, 2.0, 0.0, 92.0, 4.0]),
            ("stopping_time", vec![7.0, 90.0, f64::NAN, 80.0, 5.0, 70.0]),
        ];
        let even = |cells: &[Option<usize>]| vec![1.0; cells.len()];
        assert_eq!(stopped(&maps, even), Some(7.0));
        // What lies steeper is more.
        let steep = |cells: &[Option<usize>]| {
            assert_eq!(cells, [Some(0), Some(2), Some(4), Some(5)]);
            vec![1.0, 1.0, 1.0, 2.0]
        };
        assert_eq!(stopped(&maps, steep), Some(70.0));
        assert_eq!(stopped(&vec![("deposit", vec![1.0])], even), None);
        assert_eq!(stopped(&vec![("deposit", vec![0.0]), ("stopping_time", vec![1.0])], even), None);
    }
}
