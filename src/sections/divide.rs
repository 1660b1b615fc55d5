//! Division of a closed section into its faces and edges.
//!
//! A blade turns slowly along its faces and by about half a turn at each of its edges. An edge is therefore the shortest part
//! of the section that turns by a stated angle, whatever the start, the sense and the spacing of the points are.

use super::{EdgeForm, Outline};
use nalgebra::{Point3, Vector3};

/// Turn of an edge: half a turn less the angle between the faces, of up to 50 deg.
const TURN: f64 = 130.0 / 180.0 * std::f64::consts::PI;

/// Turn at one point from which on the point is a corner: a round edge with four points or more turns less.
const CORNER: f64 = 50.0 / 180.0 * std::f64::consts::PI;

/// Turn at one point from which on an edge has no thickness.
const SHARP: f64 = TURN;

/// Share of the length of a section by which the middles of its edges are apart, at least.
const APART: f64 = 0.2;

/// Fewest points of a section: three for each face and each edge.
const LEAST_POINTS: usize = 12;

/// Why a section cannot be divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DivideFault {
    /// It has fewer than 12 points: their number.
    TooFew(usize),
    /// A point coincides with the next one: its index.
    Repeated(usize),
    /// It has no two edges: no second part turns by 130 deg.
    NoEdges,
    /// Both faces end in one point: its index.
    Sharp(usize),
    /// The leading (0) or trailing edge (1) is stated to be cut off, but has no two corners.
    NoCorners(usize),
}

/// Divides a closed section, whose first point is not repeated. `flow` ascends from inlet to outlet: the edge with the smaller
/// value is the leading edge. `forms` are the forms of the leading and of the trailing edge where they are stated; else an edge
/// with two corners is cut off, and any other edge is round. `span` goes into the outline.
///
/// The first face is the one that follows the leading edge in the order of the points.
///
/// # Errors
/// [`DivideFault`].
pub fn divide(
    points: &[Point3<f64>],
    forms: [Option<EdgeForm>; 2],
    flow: impl Fn(&Point3<f64>) -> f64,
    span: Option<f64>,
) -> Result<Outline, DivideFault> {
    let n = points.len();
    if n < LEAST_POINTS {
        return Err(DivideFault::TooFew(n));
    }
    if let Some(i) = (0..n).find(|i| points[*i] == points[(i + 1) % n]) {
        return Err(DivideFault::Repeated(i));
    }
    let bends = Bends::new(points);
    let first = bends.shortest(None).ok_or(DivideFault::NoEdges)?;
    let second = bends.shortest(Some(&first)).ok_or(DivideFault::NoEdges)?;
    let ahead = |window: &[usize; 2]| flow(&points[window[0] % n]) + flow(&points[window[1] % n]);
    let windows = if ahead(&first) <= ahead(&second) { [first, second] } else { [second, first] };
    let [leading, trailing] = [0, 1].map(|edge| bends.edge(windows[edge], edge, forms[edge]));
    let ([from, to], [start, end]) = (leading?, trailing?);
    let run = |from: usize, to: usize| -> Vec<Point3<f64>> {
        let to = if to < from { to + n } else { to };
        (from..=to).map(|i| points[i % n]).collect()
    };
    let back = |mut points: Vec<Point3<f64>>| {
        points.reverse();
        points
    };
    let faces = [run(to % n, start % n), back(run(end % n, from % n))];
    Ok(Outline { span, faces, edges: [back(run(from, to)), run(start, end)] })
}

/// Turns of a closed section at its points.
struct Bends<'a> {
    points: &'a [Point3<f64>],
    /// Turn at each point, about the normal of the section.
    turns: Vec<f64>,
    /// Length from the first point to each point, and the whole length behind the last one.
    lengths: Vec<f64>,
}

impl<'a> Bends<'a> {
    fn new(points: &'a [Point3<f64>]) -> Self {
        let n = points.len();
        let step = |i: usize| points[(i + 1) % n] - points[i % n];
        // Twice the area of the section, as a vector along its normal.
        let normal: Vector3<f64> = (1..n).map(|i| (points[i] - points[0]).cross(&step(i))).sum();
        let turn = |i: usize| {
            let (a, b) = (step(i + n - 1), step(i));
            let across = a.cross(&b);
            let angle = libm::atan2(across.norm(), a.dot(&b));
            if across.dot(&normal) < 0.0 { -angle } else { angle }
        };
        let mut lengths = vec![0.0];
        for i in 0..n {
            lengths.push(lengths[i] + step(i).norm());
        }
        Self { points, turns: (0..n).map(turn).collect(), lengths }
    }

    /// Length from the first point to point i, which may lie one round ahead.
    fn length(&self, i: usize) -> f64 {
        let n = self.points.len();
        self.lengths[i % n] + if i >= n { self.lengths[n] } else { 0.0 }
    }

    /// First and last point of the shortest part whose points turn by at least `TURN`; apart from another such part. The first
    /// index is below the number of points, the last one may lie one round ahead.
    fn shortest(&self, other: Option<&[usize; 2]>) -> Option<[usize; 2]> {
        let n = self.points.len();
        let whole = self.lengths[n];
        let middle = |[from, to]: [usize; 2]| 0.5 * (self.length(from) + self.length(to));
        let apart = |window: [usize; 2]| {
            other.is_none_or(|other| {
                let gap = (middle(window) - middle(*other)).rem_euclid(whole);
                gap.min(whole - gap) > APART * whole
            })
        };
        let mut best: Option<([usize; 2], f64)> = None;
        for from in 0..n {
            let mut turned = 0.0;
            for to in from..from + n / 2 {
                turned += self.turns[to % n];
                if turned < TURN {
                    continue;
                }
                let length = self.length(to) - self.length(from);
                if apart([from, to]) && best.is_none_or(|b| length < b.1) {
                    best = Some(([from, to], length));
                }
                break;
            }
        }
        best.map(|b| b.0)
    }

    /// First and last point of an edge: its corners, or the points beside the part that turns.
    fn edge(&self, [from, to]: [usize; 2], edge: usize, form: Option<EdgeForm>) -> Result<[usize; 2], DivideFault> {
        let n = self.points.len();
        let at = |i: usize| self.turns[i % n];
        if let Some(sharp) = (from..=to).find(|i| at(*i) > SHARP) {
            return Err(DivideFault::Sharp(sharp % n));
        }
        let mut corners: Vec<usize> = (from..=to).filter(|i| at(*i) > CORNER).collect();
        corners.sort_by(|a, b| at(*b).total_cmp(&at(*a)));
        let cut = match corners.as_slice() {
            [a, b, ..] => Some([*a.min(b), *a.max(b)]),
            _ => None,
        };
        match (form, cut) {
            (Some(EdgeForm::CutOff), None) => Err(DivideFault::NoCorners(edge)),
            (None | Some(EdgeForm::CutOff), Some([a, b])) => Ok([a % n, if b % n < a % n { b % n + n } else { b % n }]),
            _ => {
                // The neighbours are the ends of the faces. A round edge has a point between its ends.
                let from = from + n - 1;
                Ok([from % n, to + 1 + n - (from - from % n)])
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half a thickness of 2 along a chord of 40, with round ends.
    fn round(count: usize) -> Vec<Point3<f64>> {
        let on = |angle: f64| {
            let x = 20.0 * libm::cos(angle);
            // A flat oval: straight faces and half circles.
            let side = if libm::sin(angle) >= 0.0 { 1.0 } else { -1.0 };
            let beyond = x.abs() - 19.0;
            let y = if beyond > 0.0 { (1.0 - beyond * beyond).max(0.0).sqrt() } else { 1.0 };
            Point3::new(x, side * y, 0.1 * x)
        };
        (0..count).map(|i| on(std::f64::consts::TAU * i as f64 / count as f64)).collect()
    }

    fn cut(count: usize) -> Vec<Point3<f64>> {
        let side = |i: usize| -19.0 + 39.0 * i as f64 / count as f64;
        let mut all: Vec<Point3<f64>> = (0..=count).map(|i| Point3::new(side(i), 1.0, 0.0)).collect();
        all.extend((0..=count).rev().map(|i| Point3::new(side(i), -1.0, 0.0)));
        // A round nose at the other end.
        all.extend((1..12).map(|i| {
            let a = std::f64::consts::PI * f64::from(i) / 12.0;
            Point3::new(-19.0 - libm::sin(a), -libm::cos(a), 0.0)
        }));
        all
    }

    fn pieces_cover(points: &[Point3<f64>], o: &Outline) {
        let [a, b] = &o.faces;
        let [leading, trailing] = &o.edges;
        assert_eq!(a.len() + b.len() + leading.len() + trailing.len(), points.len() + 4);
        assert_eq!((leading[0], *leading.last().unwrap()), (a[0], b[0]));
        assert_eq!((trailing[0], *trailing.last().unwrap()), (*a.last().unwrap(), *b.last().unwrap()));
    }

    /// Start and sense of the points do not matter; the edge with the smaller flow is the leading edge.
    #[test]
    fn any_start_and_sense() {
        for (points, trailing) in [(round(200), 3), (cut(60), 2)] {
            for start in (0..points.len()).step_by(7) {
                for reverse in [false, true] {
                    let mut turned = points.clone();
                    turned.rotate_left(start);
                    if reverse {
                        turned.reverse();
                    }
                    let o = divide(&turned, [None; 2], |p| p.x, Some(0.5)).expect("divided");
                    pieces_cover(&turned, &o);
                    assert!(o.edges[0].iter().all(|p| p.x < -15.0) && o.edges[1].iter().all(|p| p.x > 15.0));
                    assert!(o.faces.iter().flatten().all(|p| p.x.abs() < 20.0 + 1e-9));
                    assert!(o.faces.iter().all(|face| face[0].x < face[face.len() - 1].x));
                    assert!(if trailing == 2 { o.edges[1].len() == 2 } else { o.edges[1].len() > 4 });
                    let o = divide(&turned, [None; 2], |p| -p.x, None).expect("divided");
                    assert!(o.edges[0].iter().all(|p| p.x > 15.0));
                }
            }
        }
    }

    #[test]
    fn faults_are_told() {
        assert_eq!(divide(&round(8), [None; 2], |p| p.x, None), Err(DivideFault::TooFew(8)));
        let mut twice = round(100);
        twice.insert(31, twice[30]);
        assert_eq!(divide(&twice, [None; 2], |p| p.x, None), Err(DivideFault::Repeated(30)));
        let circle: Vec<_> =
            (0..90).map(|i| f64::from(i) * 4.0_f64.to_radians()).map(|a| Point3::new(a.cos(), a.sin(), 0.0)).collect();
        assert!(divide(&circle, [None; 2], |p| p.x, None).is_ok(), "a circle has edges everywhere");
        let stated = [Some(EdgeForm::CutOff), None];
        assert_eq!(divide(&round(200), stated, |p| p.x, None), Err(DivideFault::NoCorners(0)));
        // A lens ends in points.
        let arc = |i: i32| f64::from(i) / 20.0;
        let mut lens: Vec<_> = (-20..20).map(|i| Point3::new(arc(i) * 10.0, 1.0 - arc(i) * arc(i), 0.0)).collect();
        lens.extend((-20..20).map(|i| Point3::new(-arc(i) * 10.0, arc(i) * arc(i) - 1.0, 0.0)));
        assert!(matches!(divide(&lens, [None; 2], |p| p.x, None), Err(DivideFault::Sharp(_))));
    }
}
