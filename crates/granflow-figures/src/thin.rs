//! A lattice with more points than a picture can show, thinned out to those that it can.

/// More points along an axis than a surface in perspective has pixels there show nothing more.
const MOST: usize = 1200;

/// Which points along an axis of `count` are kept: all, or evenly spread ones with the first and the last among them.
pub(super) fn kept(count: usize) -> Vec<usize> {
    let step = count.saturating_sub(1).div_ceil(MOST).max(1);
    let mut kept: Vec<usize> = (0..count).step_by(step).collect();
    if kept.last().is_some_and(|last| last + 1 < count) {
        kept.push(count - 1);
    }
    kept
}

/// The coordinates of the kept points.
pub(super) fn along(values: &[f64], kept: &[usize]) -> Vec<f64> {
    kept.iter().map(|&k| values[k]).collect()
}

/// The values at the kept columns of the kept rows of a field with `columns`.
pub(super) fn among(values: &[f64], columns: usize, [across, up]: [&[usize]; 2]) -> Vec<f64> {
    up.iter().flat_map(|j| across.iter().map(move |i| values[j * columns + i])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_picture_can_show_stays_and_the_ends_too() {
        assert_eq!(kept(5), [0, 1, 2, 3, 4]);
        for count in [MOST, MOST + 1, 99_999, 1_000_000] {
            let kept = kept(count);
            assert!(kept.len() <= MOST + 1 && kept.len() > MOST / 2, "{count}: {}", kept.len());
            assert_eq!((kept[0], kept[kept.len() - 1]), (0, count - 1));
            assert!(kept.is_sorted_by(|a, b| a < b));
        }
        let field: Vec<f64> = (0..12).map(f64::from).collect();
        assert_eq!(among(&field, 4, [&[0, 3], &[0, 2]]), [0.0, 3.0, 8.0, 11.0]);
        assert_eq!(along(&field, &[0, 11]), [0.0, 11.0]);
    }
}
