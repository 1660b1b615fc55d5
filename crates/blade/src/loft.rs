//! Faces and edges of a blade through its outlines.
//!
//! The curve of a section goes round the blade without a corner where an edge is round: faces and edges are parts of one
//! spline, so that they meet with the same tangents and curvatures. An edge that is cut off divides the curve.

use super::Outline;
use super::joined::{JoinedSections, OutlinePiece, Run};
use nalgebra::Point3;
use nurbs::row_fit::fit_rows;
use nurbs::{GeomError, LoftedSurface, NurbsCurve, lofted};

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
        let joined = JoinedSections::new(outlines, &chain, closed).map_err(|section| LoftFault::Points { section })?;
        let fit = fit_rows(&joined.rows, closed, tolerance).ok_or(LoftFault::Points { section: 0 })?;
        for (section, (distance, point)) in fit.residuals.iter().enumerate() {
            if *distance > residual.distance {
                residual = Residual { distance: *distance, section, at: joined.rows[section].points[*point] };
            }
        }
        for ((piece, back), between) in chain.iter().zip(joined.joints.windows(2)) {
            let of_section = |row| fit.piece(row, [between[0], between[1]], *back);
            curves.push((*piece, (0..outlines.len()).map(of_section).collect()));
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use nurbs::proximity::Patch;

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

    /// A convex section: faces of 200 mm radius and noses of 0.13 mm. Points are 0.03 to 0.05 mm apart at the noses and 1.5 mm on
    /// the faces; points and the ends of edges jump from section to section.
    fn slender(section: usize) -> Outline {
        use std::f64::consts::PI;
        let height = section as f64 / 10.0;
        let scale = 1.0 - 0.3 * height;
        let [half, nose, face] = [25.0, 0.13, 200.0].map(|x| x * scale);
        // The direction of the normal, from the tip of a nose (0) to the other (pi); faces begin at `from`.
        let from = libm::acos((half - nose) / (face - nose));
        let point = |a: f64| {
            let (sin, cos) = libm::sincos(a);
            let turn = libm::fabs(libm::remainder(a, 2.0 * PI));
            let (x, y) = match turn {
                turn if turn < from => (half - nose + nose * cos, nose * sin),
                turn if turn > PI - from => (nose - half + nose * cos, nose * sin),
                _ => (face * cos, face * sin - libm::copysign((face - nose) * libm::sin(from), sin)),
            };
            Point3::new(x, y, 25.0 * height)
        };
        // Angles up to the middle of a face, at steps that grow.
        let (mut angles, mut last) = (vec![0.0], 0.0);
        let mut step = 0.03 + 0.02 * (section % 3) as f64 / 2.0;
        loop {
            let on_nose = last + step / nose;
            last = match on_nose {
                _ if last > from => last + step / face,
                next if next > from => from + (next - from) * nose / face,
                next => next,
            };
            if last > 0.49 * PI {
                break;
            }
            angles.push(last);
            step = if last <= from { step } else { (1.4 * step).min(1.5) };
        }
        let edge = angles.iter().position(|x| *x > from).unwrap_or(0) + section % 2;
        let side = |mirror: &dyn Fn(f64) -> f64| -> Vec<Point3<f64>> {
            let back = angles[edge..].iter().rev().map(|x| PI - x);
            angles[edge..].iter().copied().chain(back).map(|x| point(mirror(x))).collect()
        };
        let round = |at: &dyn Fn(f64) -> f64| -> Vec<Point3<f64>> {
            let up = angles[1..=edge].iter().rev().copied();
            up.chain(angles[..=edge].iter().map(|x| -x)).map(|x| point(at(x))).collect()
        };
        Outline { span: Some(height), faces: [side(&|x| x), side(&|x| -x)], edges: [round(&|x| x), round(&|x| PI - x)] }
    }

    /// On a convex blade no ball cuts in beside its contact, though the points of the file are few at the noses.
    #[test]
    fn slender_sections_have_no_waves() {
        let outlines: Vec<Outline> = (0..=10).map(slender).collect();
        let made = loft(&outlines, 0.005).expect("a blade");
        assert!(made.residual.distance <= 0.005, "{:?}", made.residual);
        let surfaces = made.faces.iter().chain(made.edges.iter().flatten());
        let mut deepest = 0.0_f64;
        for surface in surfaces {
            for (i, j) in (0..=300).flat_map(|i| (0..=50).map(move |j| (i, j))) {
                let (u, v) = (f64::from(i) / 300.0, f64::from(j) / 50.0);
                let d = surface.derivatives(u, v);
                let normal = d.su.cross(&d.sv).normalize();
                // The normal that points away from the middle plane.
                let outward = if normal.y * d.point.y + normal.x * d.point.x > 0.0 { normal } else { -normal };
                for k in 1..=40 {
                    let share = 0.02 * f64::from(k) * f64::from(k) / 1600.0;
                    for (du, dv) in [(share, 0.0), (-share, 0.0), (0.0, 2.0 * share), (0.0, -2.0 * share)] {
                        let (u, v) = (u + du, v + dv);
                        if (0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v) {
                            let off = surface.derivatives(u, v).point - d.point;
                            deepest = deepest.max(1.0 - (off - outward).norm());
                        }
                    }
                }
            }
        }
        assert!(deepest < 5e-4, "{deepest}");
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
