//! Where the edges of a loop end and the faces begin.
//!
//! An edge is curved more than the faces by a factor of ten or more, and the change is within a few points. The threshold is
//! the geometric mean of the median curvature of the loop, which is that of the faces, and of the largest curvature at the
//! nose. From the nose the edge goes to both sides as far as the curvature is above the threshold. So an edge that is round, or
//! half an ellipse up to twice as deep as its half width, ends where it meets the face; an edge that is cut off ends at its two
//! corners. A slender ellipse ends where its sides are curved like the faces.

use super::ring::Ring;
use nalgebra::{Point3, Vector3};

/// Turn of a corner, rad: 30 deg. Points of a round edge turn less from one to the next, where it has six or more.
pub const CORNER_TURN: f64 = 30.0 * std::f64::consts::PI / 180.0;

/// Turn of the blunter corner of an edge that is cut off at a slant, rad: 15 deg.
const OBTUSE: f64 = 0.5 * CORNER_TURN;

/// An edge that is cut off is straight within this share of its width.
const STRAIGHT_SHARE: f64 = 0.02;

/// The largest curvature at a nose counts up to this number over the thickness: a single sharp corner has no finite one.
const SHARPEST: f64 = 50.0;

/// Least thickness that the search takes for one, as a share of the length of the loop.
const THINNEST: f64 = 1e-6;

/// Form of an edge of a blade.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeForm {
    /// Round or elliptic, without a corner.
    Round,
    /// Straight between two corners.
    CutOff,
    /// Both faces meet in one point.
    Sharp,
}

impl EdgeForm {
    /// Forms that a job can state: no tool leaves a sharp edge.
    pub const STATED: [Self; 2] = [Self::Round, Self::CutOff];

    /// Name in the job language.
    pub fn name(self) -> &'static str {
        match self {
            Self::Round => "round",
            Self::CutOff => "cut-off",
            Self::Sharp => "sharp",
        }
    }
}

/// An edge as it was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundEdge {
    /// Its form.
    pub form: EdgeForm,
    /// Distance between the ends of both faces, mm.
    pub width: f64,
    /// How far the nose stands out over the line between these ends, mm.
    pub depth: f64,
    /// Radius of curvature at the nose, mm: that of half an ellipse with the width and the depth of the edge. Zero for an
    /// edge without depth.
    pub radius: f64,
    /// Largest distance of its points from this half ellipse, or from the straight line of an edge that is cut off, mm.
    pub residual: f64,
    /// Number of its points.
    pub points: usize,
}

/// Curvature above which a point belongs to an edge with this nose, 1/mm.
fn threshold(ring: &Ring, nose: usize, thickness: f64, of_faces: f64) -> f64 {
    let n = ring.len();
    let near = (0..n).filter(|k| ring.between(*k, nose).min(ring.between(nose, *k)) <= 0.5 * thickness);
    let peak = near.map(|k| ring.curvature(k)).fold(0.0, f64::max);
    libm::sqrt(of_faces * peak.min(SHARPEST / thickness))
}

/// Curvature of the faces, 1/mm: the median over the length of the loop, and at least one over this length.
pub(super) fn of_faces(ring: &Ring) -> f64 {
    let mut all: Vec<(f64, f64)> =
        (0..ring.len()).map(|k| (ring.curvature(k), 0.5 * (ring.chord(ring.on(k, -1)) + ring.chord(k)))).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut sum = 0.0;
    let median = all.iter().find(|(_, length)| {
        sum += length;
        sum >= 0.5 * ring.length()
    });
    median.map_or(0.0, |m| m.0).max(1.0 / ring.length())
}

/// Ends of the edge about a nose: the last points of it before and behind the nose.
pub(super) fn ends(ring: &Ring, nose: usize, thickness: f64, of_faces: f64) -> [usize; 2] {
    let thickness = thickness.max(THINNEST * ring.length());
    let threshold = threshold(ring, nose, thickness, of_faces);
    let found = [-1, 1].map(|way: isize| {
        let mut end = nose;
        let (mut gone, mut since) = (0.0, 0.0);
        let mut found = ring.curvature(nose) > threshold;
        for step in 1..ring.len() as isize / 2 {
            let k = ring.on(nose, way * step);
            let chord = if way > 0 { ring.chord(ring.on(k, -1)) } else { ring.chord(k) };
            gone += chord;
            since += chord;
            let beyond = if way > 0 { ring.chord(k) } else { ring.chord(ring.on(k, -1)) };
            // The points of a face are farther apart than those of its edge. Where the steps grow, the face begins: the turn is
            // that of the edge, over half of its last chord.
            let over = if beyond > 2.0 * chord { 0.5 * chord } else { chord };
            let above = ring.turns[k] > threshold * over;
            // The middle of a blunt edge is flat, so up to its corner the curvature may be low. Behind that one point may
            // be, such as one that was rounded when the file was written.
            let reach = if found { 0.05 * thickness } else { 0.75 * thickness };
            if !above && (gone > 3.0 * thickness || since > reach) {
                break;
            }
            if above {
                (end, since, found) = (k, 0.0, true);
            }
        }
        end
    });
    if found == [nose; 2] { slanting(ring, nose, thickness) } else { found }
}

/// Ends of an edge that is cut off at a slant, from its sharper corner: the other corner is a straight line away, which is
/// longer than the blade is thick. The sharper corner alone where there is no other.
fn slanting(ring: &Ring, nose: usize, thickness: f64) -> [usize; 2] {
    /// Longest edge, in thicknesses: a slant of 75 deg.
    const MAX_EDGE_THICKNESSES: f64 = 4.0;
    let other = |way: isize| {
        let mut gone = 0.0;
        for step in 1..ring.len() as isize / 2 {
            let k = ring.on(nose, way * step);
            gone += if way > 0 { ring.chord(ring.on(k, -1)) } else { ring.chord(k) };
            if gone > MAX_EDGE_THICKNESSES * thickness {
                return None;
            }
            if ring.turns[k] >= OBTUSE {
                return Some((gone, k));
            }
        }
        None
    };
    match (other(-1), other(1)) {
        (Some(before), Some(behind)) if before.0 <= behind.0 => [before.1, nose],
        (Some(before), None) => [before.1, nose],
        (_, Some(behind)) => [nose, behind.1],
        (None, None) => [nose; 2],
    }
}

/// Whether an edge is cut off: straight between two corners, which turn by these angles, rad. `highest` is its largest distance from
/// the chord of length `width`.
#[must_use]
pub fn is_cut_off(turns: [f64; 2], highest: f64, width: f64) -> bool {
    let corners = turns.iter().all(|turn| *turn >= OBTUSE) && turns.iter().any(|turn| *turn >= CORNER_TURN);
    corners && highest <= STRAIGHT_SHARE * width
}

/// Points of an edge, from which an edge that is cut off leaves out those between its corners, and what it is.
pub(super) fn describe(ring: &Ring, [from, to]: [usize; 2]) -> (Vec<Point3<f64>>, FoundEdge) {
    let points = ring.points_between(from, to);
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return (points, sharp(0));
    };
    let width = nalgebra::distance(first, last);
    if points.len() == 1 || width == 0.0 {
        return (vec![*first], sharp(1));
    }
    let chord = (last - first) / width;
    let off_chord = |p: &Point3<f64>| {
        let d = p - first;
        d - chord * d.dot(&chord)
    };
    let highest = points.iter().map(|p| off_chord(p).norm()).fold(0.0, f64::max);
    let turns = [from, to].map(|k| ring.turns[k]);
    if points.len() == 2 || is_cut_off(turns, highest, width) {
        let edge = FoundEdge { form: EdgeForm::CutOff, width, depth: 0.0, radius: 0.0, residual: highest, points: 2 };
        return (vec![*first, *last], edge);
    }
    // The direction in which the edge stands out: that of the mean of its points.
    let mean = points.iter().map(off_chord).sum::<Vector3<f64>>() / points.len() as f64;
    let out = mean.try_normalize(0.0).unwrap_or_else(Vector3::zeros);
    let depth = points.iter().map(|p| off_chord(p).dot(&out)).fold(0.0, f64::max);
    let half = 0.5 * width;
    let radius = if depth > 0.0 { half * half / depth } else { 0.0 };
    let middle = nalgebra::center(first, last);
    let residual = points
        .iter()
        .map(|p| {
            let d = p - middle;
            let (x, y) = (d.dot(&chord), d.dot(&out));
            let off = (d - chord * x - out * y).norm();
            libm::hypot(from_ellipse([x, y], [half, depth]), off)
        })
        .fold(0.0, f64::max);
    let edge = FoundEdge { form: EdgeForm::Round, width, depth, radius, residual, points: points.len() };
    (points, edge)
}

fn sharp(points: usize) -> FoundEdge {
    FoundEdge { form: EdgeForm::Sharp, width: 0.0, depth: 0.0, radius: 0.0, residual: 0.0, points }
}

/// Distance of a point from an ellipse about the origin with half axes along x and y, to first order: the value of its
/// equation over the length of the gradient.
fn from_ellipse([x, y]: [f64; 2], [a, b]: [f64; 2]) -> f64 {
    if a <= 0.0 || b <= 0.0 {
        return y.abs();
    }
    let value = libm::hypot(x / a, y / b);
    let gradient = libm::hypot(x / (a * a), y / (b * b));
    if gradient > 0.0 { ((value * value - value) / gradient).abs() } else { a.min(b) }
}
