//! How far an area reaches along a path.

/// Points of the path from which its direction at an end is taken.
const END: usize = 10;

/// A line down the flow; beyond its ends it goes straight on.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Path {
    /// Its points, between one far before its begin and one far beyond its end.
    points: Vec<[f64; 2]>,
    /// Distance of each point along the line from its begin.
    distance: Vec<f64>,
}

impl Path {
    /// The path through these points; none of fewer than two places.
    pub fn through(points: &[[f64; 2]]) -> Option<Path> {
        let (first, last) = (points.first()?, points.last()?);
        let length: f64 = points.windows(2).map(|pair| apart(pair[0], pair[1])).sum();
        let near = END.min(points.len() - 1);
        let before = beyond(points[near], *first, 1e3 * length)?;
        let after = beyond(points[points.len() - 1 - near], *last, 1e3 * length)?;
        let mut all = vec![before];
        all.extend_from_slice(points);
        all.push(after);
        let mut distance = vec![-apart(before, *first)];
        for pair in all.windows(2) {
            distance.push(distance[distance.len() - 1] + apart(pair[0], pair[1]));
        }
        Some(Path { points: all, distance })
    }

    /// The longest of the paths through these lines.
    pub fn longest(lines: impl Iterator<Item = Vec<[f64; 2]>>) -> Option<Path> {
        let paths = lines.filter_map(|line| Path::through(&line));
        paths.max_by(|a, b| a.length().total_cmp(&b.length()))
    }

    fn length(&self) -> f64 {
        self.distance[self.distance.len() - 2]
    }

    /// The points of the path itself.
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points[1..self.points.len() - 1]
    }

    /// Distance along the path of the point of it that is nearest to a place.
    pub fn along(&self, place: [f64; 2]) -> f64 {
        let (mut nearest, mut found) = (f64::INFINITY, 0.0);
        for (k, pair) in self.points.windows(2).enumerate() {
            let [a, b] = [pair[0], pair[1]];
            let edge = [b[0] - a[0], b[1] - a[1]];
            let square = edge[0] * edge[0] + edge[1] * edge[1];
            if square == 0.0 {
                continue;
            }
            let share = ((place[0] - a[0]) * edge[0] + (place[1] - a[1]) * edge[1]) / square;
            let share = share.clamp(0.0, 1.0);
            let away = apart(place, [a[0] + share * edge[0], a[1] + share * edge[1]]);
            if away < nearest {
                (nearest, found) = (away, self.distance[k] + share * square.sqrt());
            }
        }
        found
    }

    /// The straight distance of a place from the begin.
    pub fn straight(&self, place: [f64; 2]) -> f64 {
        apart(self.points[1], place)
    }
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The place so far beyond `end` on the line from `from`.
fn beyond(from: [f64; 2], end: [f64; 2], far: f64) -> Option<[f64; 2]> {
    let length = apart(from, end);
    (length > 0.0).then(|| [0, 1].map(|axis| end[axis] + (end[axis] - from[axis]) * far / length))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_measured_along_a_bent_path_and_beyond_its_ends() {
        let path = Path::through(&[[0.0, 0.0], [10.0, 0.0], [10.0, 5.0]]).unwrap();
        assert_eq!(path.length(), 15.0);
        for (place, along) in [([3.0, -2.0], 3.0), ([12.0, 3.0], 13.0), ([0.0, 0.0], 0.0)] {
            assert!((path.along(place) - along).abs() < 1e-12, "{place:?}");
        }
        let straight = Path::through(&[[1.0, 0.0], [4.0, 0.0]]).unwrap();
        assert!((straight.along([9.0, 2.0]) - 8.0).abs() < 1e-9);
        assert!((straight.along([-1.0, 2.0]) + 2.0).abs() < 1e-9);
        assert_eq!(straight.straight([4.0, 4.0]), 5.0);
    }

    #[test]
    fn a_path_of_one_place_is_none() {
        assert_eq!(Path::through(&[]), None);
        assert_eq!(Path::through(&[[1.0, 1.0], [1.0, 1.0]]), None);
    }
}
