//! The points round the sections of a blade, with parameters that belong together from section to section.
//!
//! A lofted surface joins places of equal parameter. So the noses of edges have the same parameter in all sections, and so have
//! the ends of edges. The ends that a section shows are points of its file, which jump from section to section: on a nose
//! with a radius of 0.1 mm such jumps make waves between the sections. So the distances of both ends from the nose follow
//! parabolas over the sections.

use super::Outline;
use nalgebra::{DMatrix, DVector, Point3};
use nurbs::{interpolate_at, row_fit::Row};
use rayon::prelude::*;

/// Points by which a closed row goes on beyond both ends: the spline forgets its ends within a few.
const ROUND: usize = 12;

/// Turn between two points, rad: 4 deg.
const TURN_A_PART: f64 = 0.07;

/// Parts of a chord, at least and at most.
const LEAST_PARTS: usize = 5;
const MAX_PARTS: usize = 50;

/// A part of the curve of a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum OutlinePiece {
    Face(usize),
    Edge(usize),
}

/// A piece and whether the curve runs through it from its end to its start.
pub(super) type Run = (OutlinePiece, bool);

/// Points of a chain of pieces, section by section, with parameters that are equal at the joints and noses of all sections.
pub(super) struct JoinedSections {
    pub rows: Vec<Row>,
    /// Parameters of the ends of the pieces, from 0 to 1.
    pub joints: Vec<f64>,
}

impl JoinedSections {
    /// # Errors
    /// The index of a section with a piece of fewer than two points, or a point that coincides with the one before it.
    pub(super) fn new(outlines: &[Outline], chain: &[Run], closed: bool) -> Result<Self, usize> {
        let row = |outline: &Outline| {
            let row = SectionRow::new(outline, chain)?;
            Some(SectionRow { points: dense(&row.points, closed)?, ..row })
        };
        let rows: Vec<Option<SectionRow>> = outlines.par_iter().map(row).collect();
        let found = rows.into_iter().enumerate().map(|(section, row)| row.ok_or(section));
        let mut rows = found.collect::<Result<Vec<_>, _>>()?;
        smooth_ends(&mut rows, chain, closed);
        // The share of an interval between anchors is its mean share in the sections.
        let last = rows[0].anchors.len() - 1;
        let mean = |j: usize| rows.iter().map(|row| row.share(j)).sum::<f64>() / rows.len() as f64;
        let shares: Vec<f64> = (0..=last).map(mean).collect();
        let mut joints = vec![0.0];
        let mut at = 0;
        for (piece, _) in chain {
            at += if matches!(piece, OutlinePiece::Edge(_)) { 2 } else { 1 };
            joints.push(shares[at]);
        }
        Ok(Self { rows: rows.into_iter().map(|row| row.on(&shares, closed)).collect(), joints })
    }
}

/// A point of a section with its length along the chords.
#[derive(Clone, Copy)]
struct RowPoint {
    at: Point3<f64>,
    length: f64,
    /// False for a point between those of the file.
    given: bool,
}

/// Points round a section.
struct SectionRow {
    points: Vec<RowPoint>,
    /// Lengths at the start, then for each piece at the nose of an edge and at the end of the piece.
    anchors: Vec<f64>,
}

impl SectionRow {
    fn new(outline: &Outline, chain: &[Run]) -> Option<Self> {
        let mut points: Vec<RowPoint> = Vec::new();
        let mut anchors = vec![0.0];
        for (piece, back) in chain {
            let given = match piece {
                OutlinePiece::Face(k) => &outline.faces[*k],
                OutlinePiece::Edge(k) => &outline.edges[*k],
            };
            if given.len() < 2 {
                return None;
            }
            let ordered: Vec<Point3<f64>> = if *back { given.iter().rev().copied().collect() } else { given.clone() };
            let first = points.len().saturating_sub(1);
            // The first point of a piece is the last one of the piece before.
            for p in ordered.into_iter().skip(usize::from(!points.is_empty())) {
                let length = match points.last() {
                    Some(before) => {
                        let chord = (p - before.at).norm();
                        if !(chord > 0.0 && chord.is_finite()) {
                            return None;
                        }
                        before.length + chord
                    }
                    None => 0.0,
                };
                points.push(RowPoint { at: p, length, given: true });
            }
            if matches!(piece, OutlinePiece::Edge(_)) {
                anchors.push(half_turn(&points[first..]));
            }
            anchors.push(points.last()?.length);
        }
        Some(Self { points, anchors })
    }

    /// Length of the anchor as a share of the whole.
    fn share(&self, anchor: usize) -> f64 {
        let (from, to) = (self.anchors[0], self.anchors[self.anchors.len() - 1]);
        (self.anchors[anchor] - from) / (to - from)
    }

    /// The row with parameters that are the given shares at the anchors.
    fn on(mut self, shares: &[f64], closed: bool) -> Row {
        if closed {
            // The last point is the first one again. The row begins at the first anchor, wherever that is.
            self.points.pop();
            let (from, to) = (self.anchors[0], self.anchors[self.anchors.len() - 1]);
            for p in &mut self.points {
                p.length += if p.length < from { to - from } else { 0.0 };
                p.length -= if p.length >= to { to - from } else { 0.0 };
            }
            self.points.sort_by(|a, b| a.length.total_cmp(&b.length));
        }
        let map = MonotoneMap::new(&self.anchors, shares, closed);
        Row {
            points: self.points.iter().map(|p| p.at).collect(),
            parameters: self.points.iter().map(|p| map.at(p.length)).collect(),
            judged: self.points.iter().map(|p| p.given).collect(),
        }
    }
}

/// The points with further ones between them, on a cubic spline through them: sections have few points where the next one has
/// many, and a fit goes where it likes between points. The parameters of the spline are centripetal (Lee 1989): with those of
/// chord lengths it overshoots beside a nose.
fn dense(points: &[RowPoint], closed: bool) -> Option<Vec<RowPoint>> {
    // A closed row goes on round its start, so that the spline has no end there.
    let round = if closed { ROUND.min(points.len() - 1) } else { 0 };
    let (last, whole) = (points.len() - 1, points[points.len() - 1].length);
    let turned = |i: usize, by: f64| RowPoint { length: points[i].length + by, ..points[i] };
    let before = (last - round..last).map(|i| turned(i, -whole));
    let after = (1..=round).map(|i| turned(i, whole));
    let all: Vec<RowPoint> = before.chain(points.iter().copied()).chain(after).collect();
    let mut at = vec![0.0];
    for pair in all.windows(2) {
        at.push(at[at.len() - 1] + (pair[1].at - pair[0].at).norm().sqrt());
    }
    let end = at[at.len() - 1];
    at.iter_mut().for_each(|t| *t /= end);
    let places: Vec<Point3<f64>> = all.iter().map(|p| p.at).collect();
    let curve = interpolate_at(&at, &places, 3.min(places.len() - 1)).ok()?;
    let mut dense = vec![points[0]];
    for i in round..round + last {
        let directions = [at[i], at[i + 1]].map(|t| curve.derivatives(t).first);
        let turn = libm::atan2(directions[0].cross(&directions[1]).norm(), directions[0].dot(&directions[1]));
        let parts = ((turn / TURN_A_PART).ceil() as usize).clamp(LEAST_PARTS, MAX_PARTS);
        let (from, to) = (all[i].length, all[i + 1].length);
        for k in 1..parts {
            let share = k as f64 / parts as f64;
            let place = curve.point(at[i] + (at[i + 1] - at[i]) * share);
            dense.push(RowPoint { at: place, length: from + (to - from) * share, given: false });
        }
        dense.push(all[i + 1]);
    }
    Some(dense)
}

/// Length at which half of the turn of a piece is done. The direction of a chord is that of its middle.
fn half_turn(points: &[RowPoint]) -> f64 {
    let chords: Vec<_> =
        points.windows(2).map(|pair| (0.5 * (pair[0].length + pair[1].length), pair[1].at - pair[0].at)).collect();
    let mut turned = vec![0.0];
    for pair in chords.windows(2) {
        let [(_, a), (_, b)] = [pair[0], pair[1]];
        turned.push(turned[turned.len() - 1] + libm::atan2(a.cross(&b).norm(), a.dot(&b)));
    }
    let half = 0.5 * turned[turned.len() - 1];
    let k = turned.partition_point(|turn| *turn < half).clamp(1, turned.len().max(2) - 1);
    match (chords.get(k - 1), chords.get(k)) {
        (Some((a, _)), Some((b, _))) if turned[k] > turned[k - 1] => {
            a + (b - a) * (half - turned[k - 1]) / (turned[k] - turned[k - 1])
        }
        // One chord, or a straight piece.
        _ => 0.5 * (points[0].length + points[points.len() - 1].length),
    }
}

/// Moves the ends of edges to distances from the noses that follow parabolas over the sections. Where anchors would change their
/// order, they stay.
fn smooth_ends(rows: &mut [SectionRow], chain: &[Run], closed: bool) {
    let mut moved: Vec<Vec<f64>> = rows.iter().map(|row| row.anchors.clone()).collect();
    let mut nose = 0;
    for (piece, _) in chain {
        nose += 1;
        if !matches!(piece, OutlinePiece::Edge(_)) {
            continue;
        }
        for end in [nose - 1, nose + 1] {
            let distances: Vec<f64> = rows.iter().map(|row| row.anchors[end] - row.anchors[nose]).collect();
            for (anchors, distance) in moved.iter_mut().zip(parabola(&heights(rows, nose), &distances)) {
                anchors[end] = anchors[nose] + distance;
            }
        }
        nose += 1;
    }
    if closed {
        // A closed chain ends with an edge, whose end is its start.
        for (anchors, row) in moved.iter_mut().zip(rows.iter()) {
            let last = anchors.len() - 1;
            anchors[0] = anchors[last] - (row.anchors[last] - row.anchors[0]);
        }
    }
    if moved.iter().all(|anchors| anchors.windows(2).all(|pair| pair[0] < pair[1])) {
        rows.iter_mut().zip(moved).for_each(|(row, anchors)| row.anchors = anchors);
    }
}

/// Heights of sections: distances along the points nearest to an anchor.
fn heights(rows: &[SectionRow], anchor: usize) -> Vec<f64> {
    let at = |row: &SectionRow| {
        let k = row.points.partition_point(|p| p.length < row.anchors[anchor]);
        row.points[k.min(row.points.len() - 1)].at
    };
    let mut heights = vec![0.0];
    for pair in rows.windows(2) {
        heights.push(heights[heights.len() - 1] + (at(&pair[1]) - at(&pair[0])).norm());
    }
    heights
}

/// Values of the parabola with the least squared distances to given values, at their places; the values themselves where they
/// determine no parabola.
fn parabola(places: &[f64], values: &[f64]) -> Vec<f64> {
    let whole = places.last().copied().unwrap_or(0.0);
    if values.len() <= 3 || whole <= 0.0 {
        return values.to_vec();
    }
    let powers = DMatrix::from_fn(values.len(), 3, |i, k| (places[i] / whole).powi(k as i32));
    let normal = powers.transpose() * &powers;
    let right = powers.transpose() * DVector::from_column_slice(values);
    let Some(found) = normal.cholesky().map(|c| c.solve(&right)) else { return values.to_vec() };
    (powers * found).iter().copied().collect()
}

/// A map that ascends through given pairs with a continuous derivative: cubic Hermite pieces with harmonic means of the
/// slopes beside a pair (Fritsch and Butland 1984).
struct MonotoneMap<'a> {
    from: &'a [f64],
    to: &'a [f64],
    slopes: Vec<f64>,
}

impl<'a> MonotoneMap<'a> {
    /// `closed` when the derivative at the end is that at the start.
    fn new(from: &'a [f64], to: &'a [f64], closed: bool) -> Self {
        let n = from.len() - 1;
        let secant = |j: usize| (to[j + 1] - to[j]) / (from[j + 1] - from[j]);
        let mean = |a: f64, b: f64| 2.0 * a * b / (a + b);
        let end = |j: usize, other: usize| if closed { mean(secant(j), secant(other)) } else { secant(j) };
        let slope = |j: usize| match j {
            0 => end(0, n - 1),
            j if j == n => end(n - 1, 0),
            j => mean(secant(j - 1), secant(j)),
        };
        let slopes = (0..=n).map(slope).collect();
        Self { from, to, slopes }
    }

    fn at(&self, x: f64) -> f64 {
        let j = self.from.partition_point(|f| *f <= x).clamp(1, self.from.len() - 1) - 1;
        let width = self.from[j + 1] - self.from[j];
        let t = (x - self.from[j]) / width;
        let (a, b) = (self.to[j], self.to[j + 1]);
        let (square, cube) = (t * t, t * t * t);
        let smooth = 3.0 * square - 2.0 * cube;
        let [start, end] = [cube - 2.0 * square + t, cube - square];
        a + (b - a) * smooth + width * (start * self.slopes[j] + end * self.slopes[j + 1])
    }
}
