//! Faces and edges of a blade through its outlines.
//!
//! The curve of a section goes round the blade without a corner where an edge is round: faces and edges are parts of one
//! spline, so that they meet with the same tangents and curvatures. An edge that is cut off divides the curve.

use super::Outline;
use crate::geom::row_fit::{Row, RowFit, fit_rows};
use crate::geom::{GeomError, LoftedSurface, NurbsCurve, lofted};
use nalgebra::Point3;

/// Faces and edges of a blade. Their v goes from the first section (0) to the last (1).
#[derive(Clone, Debug)]
pub struct LoftedBlade {
    /// Pressure and suction face; u goes from the leading (0) to the trailing edge (1).
    pub faces: [LoftedSurface; 2],
    /// Leading and trailing edge; u goes from the pressure (0) to the suction face (1). `None` for an edge that is cut off.
    pub edges: [Option<LoftedSurface>; 2],
    /// Largest distance of a point to the curve of its section.
    pub residual: Residual,
}

/// A distance of a point to the curve of its section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// The distance, mm.
    pub distance: f64,
    /// Index of the section.
    pub section: usize,
    /// The point.
    pub at: Point3<f64>,
}

/// Why outlines are not a blade.
#[derive(Clone, Debug, PartialEq)]
pub enum LoftFault {
    /// An edge is round in a section and cut off in another: the edge (0 leading, 1 trailing) and the first section that
    /// differs from section 0.
    EdgesDiffer {
        /// 0 for the leading, 1 for the trailing edge.
        edge: usize,
        /// Index of the section.
        section: usize,
    },
    /// A section has too few points, or a point twice: its index.
    Points {
        /// Index of the section.
        section: usize,
    },
    /// No surface goes through the curves of the sections.
    Surface(GeomError),
}

/// A part of the curve of a section.
#[derive(Clone, Copy, Debug, PartialEq)]
enum OutlinePiece {
    Face(usize),
    Edge(usize),
}

/// A piece and whether the curve runs through it from its end to its start.
type Run = (OutlinePiece, bool);

/// Faces and edges through outlines from hub to shroud; each point lies within `tolerance`, mm, of the curve of its section
/// where the points allow it.
///
/// # Errors
/// [`LoftFault`].
pub fn loft(outlines: &[Outline], tolerance: f64) -> Result<LoftedBlade, LoftFault> {
    if outlines.len() < 2 {
        return Err(LoftFault::Surface(GeomError::TooFewPoints { given: outlines.len(), needed: 2 }));
    }
    let cut = |outline: &Outline, edge: usize| outline.edges[edge].len() < 3;
    for edge in [0, 1] {
        if let Some(section) = outlines.iter().position(|o| cut(o, edge) != cut(&outlines[0], edge)) {
            return Err(LoftFault::EdgesDiffer { edge, section });
        }
    }
    let chains: Vec<(Vec<Run>, bool)> = match [0, 1].map(|edge| cut(&outlines[0], edge)) {
        [false, false] => vec![(
            vec![
                (OutlinePiece::Face(0), true),
                (OutlinePiece::Edge(0), false),
                (OutlinePiece::Face(1), false),
                (OutlinePiece::Edge(1), true),
            ],
            true,
        )],
        [false, true] => vec![(
            vec![(OutlinePiece::Face(0), true), (OutlinePiece::Edge(0), false), (OutlinePiece::Face(1), false)],
            false,
        )],
        [true, false] => vec![(
            vec![(OutlinePiece::Face(0), false), (OutlinePiece::Edge(1), false), (OutlinePiece::Face(1), true)],
            false,
        )],
        [true, true] => {
            vec![(vec![(OutlinePiece::Face(0), false)], false), (vec![(OutlinePiece::Face(1), false)], false)]
        }
    };
    let mut curves: Vec<(OutlinePiece, Vec<NurbsCurve>)> = Vec::new();
    let mut residual = Residual { distance: 0.0, section: 0, at: Point3::origin() };
    for (chain, closed) in chains {
        let joined = JoinedSections::new(outlines, &chain, closed)?;
        let fit = fit_rows(&joined.rows, closed, tolerance).ok_or(LoftFault::Points { section: 0 })?;
        for (section, (distance, point)) in fit.residuals.iter().enumerate() {
            if *distance > residual.distance {
                residual = Residual { distance: *distance, section, at: joined.rows[section].points[*point] };
            }
        }
        curves.extend(joined.pieces(&chain, &fit, outlines.len()));
    }
    surfaces(&curves, residual)
}

fn surfaces(curves: &[(OutlinePiece, Vec<NurbsCurve>)], residual: Residual) -> Result<LoftedBlade, LoftFault> {
    let of = |piece: OutlinePiece| curves.iter().find(|(p, _)| *p == piece).map(|(_, curves)| curves);
    let faces = [0, 1].map(|k| of(OutlinePiece::Face(k)).map_or(&[][..], Vec::as_slice));
    // One set of places for all pieces: neighbours share their border.
    let sections: Vec<Vec<&NurbsCurve>> = faces[0].iter().zip(faces[1]).map(|(p, s)| vec![p, s]).collect();
    let places = lofted::places(&sections).map_err(LoftFault::Surface)?;
    let through =
        |curves: &[NurbsCurve]| LoftedSurface::at(curves.to_vec(), places.clone()).map_err(LoftFault::Surface);
    let [leading, trailing] = [0, 1].map(|k| of(OutlinePiece::Edge(k)).map(|curves| through(curves)).transpose());
    Ok(LoftedBlade { faces: [through(faces[0])?, through(faces[1])?], edges: [leading?, trailing?], residual })
}

/// Points of a chain of pieces, section by section, with parameters that are equal at the joints of all sections.
struct JoinedSections {
    rows: Vec<Row>,
    /// Parameters of the ends of the pieces, from 0 to 1.
    joints: Vec<f64>,
}

impl JoinedSections {
    fn new(outlines: &[Outline], chain: &[Run], closed: bool) -> Result<Self, LoftFault> {
        let mut lengths = Vec::new();
        let mut points = Vec::new();
        for (section, outline) in outlines.iter().enumerate() {
            let (row, ends) = joined(outline, chain, closed).ok_or(LoftFault::Points { section })?;
            points.push(row);
            lengths.push(ends);
        }
        // The share of a piece is its mean share in the sections.
        let count = outlines.len() as f64;
        let share = |j: usize| lengths.iter().map(|ends| ends[j] / ends[chain.len()]).sum::<f64>() / count;
        let joints: Vec<f64> = (0..=chain.len()).map(share).collect();
        let rows = points.into_iter().zip(&lengths).map(|(row, ends)| {
            let map = MonotoneMap::new(ends, &joints, closed);
            let (points, at): (Vec<_>, Vec<f64>) = row.into_iter().unzip();
            Row { points, parameters: at.into_iter().map(|s| map.at(s)).collect() }
        });
        let rows = rows.collect();
        Ok(Self { rows, joints })
    }

    fn pieces(&self, chain: &[Run], fit: &RowFit, sections: usize) -> Vec<(OutlinePiece, Vec<NurbsCurve>)> {
        let piece = |(j, (piece, back)): (usize, &Run)| {
            let between = [self.joints[j], self.joints[j + 1]];
            (*piece, (0..sections).map(|row| fit.piece(row, between, *back)).collect())
        };
        chain.iter().enumerate().map(piece).collect()
    }
}

/// Points of a chain with their lengths along the chords, and the lengths at the ends of its pieces. `None` for a piece with
/// fewer than two points, or a point that coincides with the one before it.
#[expect(clippy::type_complexity, reason = "a row and its ends")]
fn joined(outline: &Outline, chain: &[Run], closed: bool) -> Option<(Vec<(Point3<f64>, f64)>, Vec<f64>)> {
    let mut row: Vec<(Point3<f64>, f64)> = Vec::new();
    let mut ends = vec![0.0];
    for (piece, back) in chain {
        let points = match piece {
            OutlinePiece::Face(k) => &outline.faces[*k],
            OutlinePiece::Edge(k) => &outline.edges[*k],
        };
        if points.len() < 2 {
            return None;
        }
        let ordered: Vec<Point3<f64>> = if *back { points.iter().rev().copied().collect() } else { points.clone() };
        // The first point of a piece is the last one of the piece before.
        for p in ordered.into_iter().skip(usize::from(!row.is_empty())) {
            let length = match row.last() {
                Some((before, length)) => {
                    let chord = (p - before).norm();
                    if !(chord > 0.0 && chord.is_finite()) {
                        return None;
                    }
                    length + chord
                }
                None => 0.0,
            };
            row.push((p, length));
        }
        ends.push(row.last()?.1);
    }
    if closed {
        // The last point is the first one again.
        row.pop();
    }
    Some((row, ends))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::proximity::Patch;

    /// Half the thickness of the test blade at a share of the chord: round at both ends.
    fn half(x: f64, thick: f64) -> f64 {
        thick * (x * (1.0 - x)).max(0.0).sqrt() * 2.0
    }

    /// A blade of elliptic sections whose chord grows and turns with the height. Edges are what lies within 3 % of an end.
    fn outline(height: f64, cut: bool) -> Outline {
        let (chord, turn) = (40.0 + 10.0 * height, 0.3 * height);
        let place = |x: f64, side: f64| {
            let (s, t) = (x * chord, side * half(x, 2.0 - height));
            Point3::new(
                20.0 + s * libm::cos(turn) - t * libm::sin(turn),
                s * libm::sin(turn) + t * libm::cos(turn),
                30.0 * height,
            )
        };
        // Angles of an ellipse give dense points at its ends.
        let from = libm::acos(1.0 - 2.0 * 0.03);
        let x = |angle: f64| 0.5 * (1.0 - libm::cos(angle));
        let last = if cut { std::f64::consts::FRAC_PI_2 } else { std::f64::consts::PI - from };
        let face = |side: f64| -> Vec<_> {
            (0..=90).map(|i| place(x(from + (last - from) * f64::from(i) / 90.0), side)).collect()
        };
        let nose = |at: &dyn Fn(f64) -> f64| -> Vec<_> {
            (0..=30)
                .map(|i| {
                    let a = from * (1.0 - f64::from(i) / 15.0);
                    place(at(x(a.abs())), if a >= 0.0 { 1.0 } else { -1.0 })
                })
                .collect()
        };
        let trailing = if cut { vec![place(0.5, 1.0), place(0.5, -1.0)] } else { nose(&|x| 1.0 - x) };
        Outline { span: Some(height), faces: [face(1.0), face(-1.0)], edges: [nose(&|x| x), trailing] }
    }

    fn blade(cut: bool) -> LoftedBlade {
        let outlines: Vec<Outline> = (0..6).map(|k| outline(f64::from(k) / 5.0, cut)).collect();
        loft(&outlines, 0.002).expect("a blade")
    }

    /// All points lie near the surface of their piece, and the residual is the largest distance.
    #[test]
    fn points_lie_on_their_pieces() {
        for cut in [false, true] {
            let made = blade(cut);
            assert!(made.residual.distance <= 0.002, "{:?}", made.residual);
            assert_eq!(made.edges[1].is_none(), cut);
            let whole = Patch { u: [0.0, 1.0], v: [0.0, 1.0] };
            for k in 0..6 {
                let o = outline(f64::from(k) / 5.0, cut);
                for (points, surface) in [(&o.faces[0], &made.faces[0]), (&o.faces[1], &made.faces[1])] {
                    for p in points.iter().step_by(9) {
                        assert!(surface.closest(p, whole).distance < 0.003);
                    }
                }
            }
        }
    }

    /// At the joints the pieces have the same point, the same direction and, where the curve is smooth, no change of the
    /// normal, at all heights.
    #[test]
    fn pieces_meet_without_a_corner() {
        let made = blade(false);
        let [leading, trailing] = made.edges.each_ref().map(|e| e.as_ref().expect("round"));
        for i in 0..=20 {
            let v = f64::from(i) / 20.0;
            for (face, edge, u, s) in [
                (&made.faces[0], leading, 0.0, 0.0),
                (&made.faces[1], leading, 0.0, 1.0),
                (&made.faces[0], trailing, 1.0, 0.0),
                (&made.faces[1], trailing, 1.0, 1.0),
            ] {
                let (a, b) = (face.derivatives(u, v), edge.derivatives(s, v));
                assert!((a.point - b.point).norm() < 1e-9, "{v}: {}", (a.point - b.point).norm());
                let [n, m] = [a, b].map(|d| d.su.cross(&d.sv).normalize());
                assert!(n.cross(&m).norm() < 1e-6, "{v}: {}", n.cross(&m).norm());
            }
        }
    }

    #[test]
    fn faults_are_told() {
        let mixed = [outline(0.0, false), outline(0.5, true), outline(1.0, false)];
        assert_eq!(loft(&mixed, 0.002).err(), Some(LoftFault::EdgesDiffer { edge: 1, section: 1 }));
        let mut twice = outline(0.5, false);
        let again = twice.faces[0][7];
        twice.faces[0].insert(7, again);
        assert_eq!(loft(&[outline(0.0, false), twice], 0.002).err(), Some(LoftFault::Points { section: 1 }));
        assert!(matches!(loft(&[outline(0.0, false)], 0.002), Err(LoftFault::Surface(_))));
        assert!(matches!(loft(&[outline(0.0, false), outline(0.0, false)], 0.002), Err(LoftFault::Surface(_))));
    }
}
