//! Lines of chords through points, in the plane and in space.

use nalgebra::Point;

/// The place of a line of chords that is nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnChords<const D: usize> {
    /// Number of its chord, which begins at the point of this number.
    pub chord: usize,
    /// Share of the way along the chord, from 0 to 1.
    pub share: f64,
    /// The place.
    pub foot: Point<f64, D>,
    /// Distance from the point.
    pub distance: f64,
}

/// The nearest place of a line of chords, the first of several; `None` for a line without points. A line of one point is a chord
/// without length.
pub fn nearest<const D: usize>(p: &Point<f64, D>, line: &[Point<f64, D>]) -> Option<OnChords<D>> {
    let chord = |(chord, w): (usize, &[Point<f64, D>])| {
        let (from, to) = (w[0], w[w.len() - 1]);
        let d = to - from;
        let square = d.norm_squared();
        let share = if square > 0.0 { ((p - from).dot(&d) / square).clamp(0.0, 1.0) } else { 0.0 };
        let foot = from + d * share;
        OnChords { chord, share, foot, distance: nalgebra::distance(p, &foot) }
    };
    let chords = line.windows(line.len().clamp(1, 2)).enumerate();
    chords.map(chord).min_by(|a, b| a.distance.total_cmp(&b.distance))
}

/// Length of a line of chords up to each of its points.
pub fn lengths<const D: usize>(line: &[Point<f64, D>]) -> Vec<f64> {
    let mut lengths = vec![0.0];
    for pair in line.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + nalgebra::distance(&pair[0], &pair[1]));
    }
    lengths
}

/// Distance of a point from a line of chords; infinite from a line without points.
pub fn from_chords<const D: usize>(p: &Point<f64, D>, line: &[Point<f64, D>]) -> f64 {
    nearest(p, line).map_or(f64::INFINITY, |near| near.distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Point2, Point3};

    #[test]
    fn the_nearest_place_is_found_in_plane_and_space() {
        let line = [Point2::new(0.0, 0.0), Point2::new(2.0, 0.0), Point2::new(2.0, 2.0)];
        let near = nearest(&Point2::new(3.0, 0.5), &line).expect("a line");
        assert_eq!((near.chord, near.share, near.foot, near.distance), (1, 0.25, Point2::new(2.0, 0.5), 1.0));
        // Before its start a line ends.
        let near = nearest(&Point2::new(-3.0, 4.0), &line).expect("a line");
        assert_eq!((near.chord, near.share, near.distance), (0, 0.0, 5.0));
        let space = line.map(|p| Point3::new(p.x, p.y, 1.0));
        assert_eq!(from_chords(&Point3::new(3.0, 0.5, 1.0), &space), 1.0);
    }

    #[test]
    fn a_point_and_equal_points_are_lines_without_length() {
        let one = [Point3::new(1.0, 0.0, 0.0)];
        assert_eq!(from_chords(&Point3::origin(), &one), 1.0);
        assert_eq!(from_chords(&Point3::origin(), &[one[0], one[0]]), 1.0);
        assert_eq!(from_chords(&Point3::origin(), &[]), f64::INFINITY);
        assert_eq!(nearest::<2>(&Point2::origin(), &[]), None);
    }
}
