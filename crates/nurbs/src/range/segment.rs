//! Control points of a spline and of its derivatives over a part of a knot span, by blossoms (The NURBS Book, 3.3 and 5.2).
//! The spline lies in their hull.

use crate::basis::{MAX_DEGREE, blossom, span};
use std::ops::{Add, Mul, Sub};

/// Most control points of a span.
pub(super) const MAX_CONTROL_POINTS: usize = MAX_DEGREE + 1;

/// A part of a knot span.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpanPart<'k> {
    knots: &'k [f64],
    degree: usize,
    /// Index of the span.
    span: usize,
    /// Parameters from..to.
    range: [f64; 2],
}

impl<'k> SpanPart<'k> {
    /// The parts of the spans of clamped knots that a range within [0, 1] covers, also where it is a single place.
    pub(super) fn all(knots: &'k [f64], degree: usize, [from, to]: [f64; 2]) -> impl Iterator<Item = Self> + use<'k> {
        let spans = span(knots, degree, from)..=span(knots, degree, to);
        let nonempty = spans.filter(move |i| knots[*i] < knots[*i + 1]);
        nonempty.map(move |i| Self { knots, degree, span: i, range: [from.max(knots[i]), to.min(knots[i + 1])] })
    }

    /// Index of its first control point.
    pub(super) fn first(&self) -> usize {
        self.span - self.degree
    }

    /// Turns the control points of the span into those of a derivative over the segment; returns how many there are. Derivatives
    /// above the degree are zero.
    pub(super) fn derivative<T>(&self, order: usize, points: &mut [T; MAX_CONTROL_POINTS]) -> usize
    where
        T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>,
    {
        if order > self.degree {
            points[0] = points[0] * 0.0;
            return 1;
        }
        for d in 0..order {
            let degree = self.degree - d;
            for j in 0..degree {
                let width = self.knots[self.span + 1 + j] - self.knots[self.span + 1 + j - degree];
                points[j] = (points[j + 1] - points[j]) * (degree as f64 / width);
            }
        }
        let degree = self.degree - order;
        let net = *points;
        for (j, point) in points.iter_mut().enumerate().take(degree + 1) {
            // Blossom with the end of the segment j times and its beginning otherwise.
            let argument = |level: usize| self.range[usize::from(level < j)];
            *point = blossom(self.knots, degree, self.span, net, argument, |a, b, t| a + (b - a) * t);
        }
        degree + 1
    }
}

/// Order of the highest derivative, up to the second, that has no jump at the knots within a range or at its ends.
pub(super) fn smoothness(knots: &[f64], degree: usize, [from, to]: [f64; 2]) -> i32 {
    let inner = &knots[degree + 1..knots.len() - degree - 1];
    let within = &inner[inner.partition_point(|k| *k < from)..inner.partition_point(|k| *k <= to)];
    let by_knot = within.chunk_by(|a, b| a == b).map(|same| degree as i32 - same.len() as i32);
    by_knot.min().map_or(2, |least| least.min(2))
}
