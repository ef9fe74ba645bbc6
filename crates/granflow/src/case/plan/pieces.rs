//! Which cells hang together.

/// The piece of every cell that `belongs`, numbered from 0 in the order of their first cells, and how many there are.
///
/// Cells hang together over faces, and over `corners` too if those count. What hangs together over faces is enclosed by
/// what does over corners, so that of a table and its surroundings one takes corners, the other does not.
pub(super) fn pieces(
    [nx, ny]: [usize; 2],
    belongs: impl Fn(usize) -> bool,
    corners: bool,
) -> (Vec<Option<usize>>, usize) {
    let mut piece = vec![None; nx * ny];
    let mut count = 0;
    let mut next = Vec::new();
    for first in 0..nx * ny {
        if piece[first].is_some() || !belongs(first) {
            continue;
        }
        piece[first] = Some(count);
        next.push(first);
        while let Some(cell) = next.pop() {
            let [i, j] = [cell % nx, cell / nx];
            for (b, a) in (j.saturating_sub(1)..ny.min(j + 2))
                .flat_map(|b| (i.saturating_sub(1)..nx.min(i + 2)).map(move |a| (b, a)))
            {
                let other = b * nx + a;
                if (corners || a == i || b == j) && piece[other].is_none() && belongs(other) {
                    piece[other] = Some(count);
                    next.push(other);
                }
            }
        }
        count += 1;
    }
    (piece, count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_squares_that_touch_at_a_corner() {
        let squares = [true, false, false, true];
        assert_eq!(pieces([2, 2], |cell| squares[cell], false), (vec![Some(0), None, None, Some(1)], 2));
        assert_eq!(pieces([2, 2], |cell| squares[cell], true), (vec![Some(0), None, None, Some(0)], 1));
        assert_eq!(pieces([4, 1], |cell| squares[cell], true).1, 2);
    }
}
