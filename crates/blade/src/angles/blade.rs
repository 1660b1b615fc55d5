//! Sections of a blade by its camber surface and its thickness.

use super::camber::{CamberLine, CamberSurface, MAX_CAMBER_ANGLE};
use super::distribution::{Distribution, weights};
use crate::Outline;
use crate::outline::Side;
use nalgebra::Point3;
use nurbs::bracket::Bracket;

/// Most halvings of an interval of the camber line: more change no digit.
const BISECTION_ROUNDS: usize = 60;

/// Intervals of a face between its points.
const FACE: usize = 160;

/// Intervals of half an elliptic edge between its points.
const HALF_EDGE: usize = 32;

/// Intervals along a camber line at which angles and thicknesses are checked.
const CHECKED: usize = 256;

/// Share of the camber line that both elliptic edges may take.
const MAX_EDGES: f64 = 0.9;

/// Thinnest blade, mm.
const THINNEST: f64 = 1e-3;

/// Form of an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EdgeShape {
    /// Cut off along the meridional edge, as a lathe does.
    CutOff,
    /// Half an ellipse: its half axis along the camber line is this multiple of half the thickness there. 1 is round.
    Elliptic(f64),
}

/// Thicknesses on spans, mm, by the share of the way from the leading to the trailing edge of the blade.
#[derive(Clone, Debug)]
pub struct Thickness {
    /// Shares of the span, ascending from 0 to 1; or one that holds for all.
    pub spans: Vec<f64>,
    /// Thickness on each.
    pub rows: Vec<Distribution>,
}

impl Thickness {
    /// Thickness at a share of the way and a share of the span, mm; zero unless the spans are as stated.
    pub fn at(&self, way: f64, span: f64) -> f64 {
        let weights = weights(&self.spans, span).unwrap_or_default();
        self.rows.iter().zip(weights).map(|(row, weight)| weight * row.at(way)).sum()
    }
}

/// A blade on a camber surface, or on a part of it.
#[derive(Clone, Debug)]
pub struct AngleBlade<'a> {
    /// The camber surface.
    pub camber: &'a CamberSurface,
    /// Shares of the way at which the blade begins and ends, at hub and shroud. A splitter has a part of the way.
    pub part: [[f64; 2]; 2],
    /// Its thickness.
    pub thickness: Thickness,
    /// Leading and trailing edge.
    pub edges: [EdgeShape; 2],
}

/// Why a section cannot be made, with its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionFault {
    /// Share of the span.
    pub span: f64,
    /// Share of the way of the camber surface.
    pub way: f64,
    /// The place on the camber line.
    pub at: Point3<f64>,
    /// What is wrong.
    pub kind: FaultKind,
}

/// What is wrong with a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaultKind {
    /// The camber line is steeper than [`MAX_CAMBER_ANGLE`]: its beta, rad.
    Steep(f64),
    /// The blade has no thickness: its thickness, mm.
    Thin(f64),
    /// A face folds: the camber line bends too much for the thickness, mm.
    Fold(f64),
    /// Both edges together are longer than most of the camber line: their length and that of the line, mm.
    EdgesMeet([f64; 2]),
    /// A face does not reach the line at which an edge is cut off: 0 for the leading, 1 for the trailing edge.
    NotCut(usize),
}

/// A point of a side: share of the way and theta.
type OnSurface = [f64; 2];

impl AngleBlade<'_> {
    /// Mean angle about +Z from the leading to the trailing edge, and mean turn of the camber lines, rad.
    pub fn turns(&self) -> [f64; 2] {
        const THICKNESS_SPANS: usize = 5;
        let mut sum = [0.0; 2];
        for k in 0..THICKNESS_SPANS {
            let span = k as f64 / (THICKNESS_SPANS - 1) as f64;
            let line = self.camber.line(span);
            let [first, last] = self.ends(span).map(|x| line.at(x));
            sum = [sum[0] + last.theta - first.theta, sum[1] + last.beta - first.beta];
        }
        sum.map(|s| s / THICKNESS_SPANS as f64)
    }

    /// Shares of the way at which the blade begins and ends at a share of the span.
    fn ends(&self, span: f64) -> [f64; 2] {
        self.part.map(|[hub, shroud]| hub + (shroud - hub) * span)
    }

    /// The section at a share of the span, with the pressure face on a side.
    ///
    /// # Errors
    /// [`SectionFault`].
    pub fn section(&self, span: f64, pressure: Side) -> Result<Outline, SectionFault> {
        let line = self.camber.line(span);
        let section = SectionLine {
            ends: self.ends(span),
            // The spans are checked where the blade is made.
            weights: weights(&self.thickness.spans, span).unwrap_or_default(),
            line,
            blade: self,
        };
        section.check()?;
        let depths = [0, 1].map(|edge| section.depth(edge));
        let length = section.line.length(section.ends[0], section.ends[1]);
        if depths[0] + depths[1] > MAX_EDGES * length {
            return Err(section.fault(section.ends[0], FaultKind::EdgesMeet([depths[0] + depths[1], length])));
        }
        let mut joints = section.ends;
        for edge in [0, 1] {
            joints[edge] = section.inside(edge, depths[edge]);
        }
        // Sides towards greater and smaller theta, each from the leading to the trailing edge.
        let on_edges = [0, 1].map(|edge| section.edge_places(edge, joints[edge], depths[edge]));
        let sides = [1.0, -1.0].map(|side| section.side(side, joints, depths, &on_edges));
        let [greater, smaller] = sides;
        let (greater, smaller) = (greater?, smaller?);
        let faces = match pressure {
            Side::Greater => [greater, smaller],
            Side::Smaller => [smaller, greater],
        };
        let edges = [0, 1].map(|edge| faces[0].edge(edge).chain(faces[1].edge(edge).rev().skip(1)).collect());
        let edges: [Vec<Point3<f64>>; 2] = edges;
        let edges = [0, 1].map(|edge| {
            if self.edges[edge] == EdgeShape::CutOff {
                let end = |face: &SidePoints| if edge == 0 { face.face.first() } else { face.face.last() }.copied();
                faces.iter().filter_map(end).collect()
            } else {
                edges[edge].clone()
            }
        });
        let faces = faces.map(|side| side.face);
        Ok(Outline { span: Some(span), faces, edges })
    }
}

/// Points of one side of a section.
#[derive(Clone, Debug, Default)]
struct SidePoints {
    face: Vec<Point3<f64>>,
    /// Halves of the leading and of the trailing edge, each from the face to the nose; empty where it is cut off.
    halves: [Vec<Point3<f64>>; 2],
}

impl SidePoints {
    fn edge(&self, edge: usize) -> impl DoubleEndedIterator<Item = Point3<f64>> + '_ {
        self.halves[edge].iter().copied()
    }
}

/// A section while it is made.
struct SectionLine<'a> {
    blade: &'a AngleBlade<'a>,
    line: CamberLine<'a>,
    /// Shares of the way of the leading and the trailing edge.
    ends: [f64; 2],
    weights: Vec<f64>,
}

impl SectionLine<'_> {
    fn fault(&self, way: f64, kind: FaultKind) -> SectionFault {
        let at = self.line.at(way);
        SectionFault { span: self.line.span, way, at: self.point([way, at.theta]), kind }
    }

    fn point(&self, [x, theta]: OnSurface) -> Point3<f64> {
        let [r, z] = self.line.meridian(x);
        let (sin, cos) = libm::sincos(theta);
        Point3::new(r * cos, r * sin, z)
    }

    /// Stated thickness, mm.
    fn thickness(&self, x: f64) -> f64 {
        let share = (x - self.ends[0]) / (self.ends[1] - self.ends[0]);
        self.blade.thickness.rows.iter().zip(&self.weights).map(|(row, weight)| weight * row.at(share)).sum()
    }

    /// Checks angles and thicknesses along the line.
    fn check(&self) -> Result<(), SectionFault> {
        for k in 0..=CHECKED {
            let x = self.ends[0] + (self.ends[1] - self.ends[0]) * k as f64 / CHECKED as f64;
            let (beta, thickness) = (self.line.at(x).beta, self.thickness(x));
            if beta.is_nan() || beta.abs() > MAX_CAMBER_ANGLE {
                return Err(self.fault(x, FaultKind::Steep(beta)));
            }
            if thickness.is_nan() || thickness < THINNEST {
                return Err(self.fault(x, FaultKind::Thin(thickness)));
            }
        }
        Ok(())
    }

    /// Length of an elliptic edge along the camber line, mm; zero for one that is cut off.
    fn depth(&self, edge: usize) -> f64 {
        match self.blade.edges[edge] {
            EdgeShape::CutOff => 0.0,
            EdgeShape::Elliptic(ratio) => 0.5 * ratio * self.thickness(self.ends[edge]),
        }
    }

    /// The share of the way at a distance along the camber line from an edge, mm.
    fn inside(&self, edge: usize, distance: f64) -> f64 {
        let [from, far] = [self.ends[edge], self.ends[1 - edge]];
        let (mut near, mut beyond) = (from, far);
        let mut x = from;
        for _ in 0..BISECTION_ROUNDS {
            let over = self.line.length(from, x).abs() - distance;
            if over > 0.0 {
                beyond = x
            } else {
                near = x
            }
            let step = over / self.line.at(x).speed() * (far - from).signum();
            let next = x - step;
            let between = (next - near) * (next - beyond) <= 0.0;
            let next = if between { next } else { 0.5 * (near + beyond) };
            if (next - x).abs() <= f64::EPSILON {
                break;
            }
            x = next;
        }
        x
    }

    /// A point of a side (1 towards greater theta, -1), at half of a share of the stated thickness from the camber line.
    fn on_side(&self, x: f64, side: f64, share: f64) -> OnSurface {
        self.line.across(x, 0.5 * side * share * self.thickness(x))
    }

    /// The place of the camber line whose point on a side lies where an edge is cut off.
    fn cut(&self, edge: usize, side: f64) -> Option<f64> {
        let end = self.ends[edge];
        let over = |x: f64| self.on_side(x, side, 1.0)[0] - end;
        let first = over(end);
        if first == 0.0 {
            return Some(end);
        }
        // The offset is nearly the same over a blade's thickness, so the way back is about as long.
        let mut reach = first.abs();
        let whole = (self.ends[1] - self.ends[0]).abs();
        while over(end - reach * first.signum()) * first > 0.0 {
            reach *= 1.5;
            if reach >= whole {
                return None;
            }
        }
        let ends = Bracket { holds: end, fails: end - reach * first.signum() };
        Some(ends.halved(BISECTION_ROUNDS, |x| over(x) * first > 0.0).middle())
    }

    /// Shares of the way for the points of a face: at even steps along the camber line, and denser towards elliptic edges, whose
    /// points are dense, since the curvature jumps there.
    fn places(&self, [from, to]: [f64; 2], depths: [f64; 2]) -> Vec<f64> {
        /// Pieces of the length between two points.
        const LENGTH_PIECES: usize = 4;
        /// Growth of the steps with the distance from an edge.
        const STEP_GROWTH: f64 = 0.15;
        let cells = FACE * LENGTH_PIECES;
        let x = |k: usize| from + (to - from) * k as f64 / cells as f64;
        let lengths: Vec<f64> = (0..cells)
            .map(|k| self.line.at(0.5 * (x(k) + x(k + 1))).speed().abs() * (to - from).abs() / cells as f64)
            .collect();
        let whole: f64 = lengths.iter().sum();
        let step = |gone: f64| {
            let near = [(0, gone), (1, whole - gone)].into_iter().filter(|(edge, _)| depths[*edge] > 0.0);
            let finest = near.map(|(edge, distance)| depths[edge] / HALF_EDGE as f64 + STEP_GROWTH * distance);
            finest.fold(whole / FACE as f64, f64::min)
        };
        let (mut gone, mut counts) = (0.0, vec![0.0]);
        for (k, length) in lengths.iter().enumerate() {
            counts.push(counts[k] + length / step(gone + 0.5 * length));
            gone += length;
        }
        let at = |k: usize| {
            let due = counts[cells] * k as f64 / FACE as f64;
            let cell = counts.partition_point(|l| *l <= due).clamp(1, cells) - 1;
            let share = (due - counts[cell]) / (counts[cell + 1] - counts[cell]);
            from + (to - from) * (cell as f64 + share) / cells as f64
        };
        (0..=FACE)
            .map(|k| {
                if k == 0 {
                    from
                } else if k == FACE {
                    to
                } else {
                    at(k)
                }
            })
            .collect()
    }

    /// Shares of the way for the points of both halves of an elliptic edge, from the faces to the nose, with the share of the thickness
    /// there; none for an edge that is cut off.
    fn edge_places(&self, edge: usize, joint: f64, depth: f64) -> Vec<[f64; 2]> {
        if self.blade.edges[edge] == EdgeShape::CutOff {
            return Vec::new();
        }
        let angle = |k: usize| std::f64::consts::FRAC_PI_2 * k as f64 / HALF_EDGE as f64;
        let at = |k: usize| {
            let (sin, cos) = libm::sincos(angle(k));
            match k {
                0 => [joint, cos],
                HALF_EDGE => [self.ends[edge], 0.0],
                _ => [self.inside(edge, depth * (1.0 - sin)), cos],
            }
        };
        (0..=HALF_EDGE).map(at).collect()
    }

    /// Points of a side.
    fn side(
        &self,
        side: f64,
        joints: [f64; 2],
        depths: [f64; 2],
        on_edges: &[Vec<[f64; 2]>; 2],
    ) -> Result<SidePoints, SectionFault> {
        let mut range = joints;
        for edge in [0, 1] {
            if self.blade.edges[edge] == EdgeShape::CutOff {
                range[edge] =
                    self.cut(edge, side).ok_or_else(|| self.fault(self.ends[edge], FaultKind::NotCut(edge)))?;
            }
        }
        let places = self.places(range, depths).into_iter();
        let face: Vec<(f64, OnSurface)> = places.map(|x| (x, self.on_side(x, side, 1.0))).collect();
        let halves = on_edges.each_ref().map(|places| -> Vec<(f64, OnSurface)> {
            places.iter().map(|[x, share]| (*x, self.on_side(*x, side, *share))).collect()
        });
        for (line, forth) in [(&face, 1.0), (&halves[0], -1.0), (&halves[1], 1.0)] {
            self.check_fold(line, forth)?;
        }
        let points = |line: &[(f64, OnSurface)]| line.iter().map(|(_, p)| self.point(*p)).collect::<Vec<_>>();
        Ok(SidePoints { face: points(&face), halves: halves.each_ref().map(|half| points(half)) })
    }

    /// Checks that each point of a line lies ahead of the one before, along the camber line.
    fn check_fold(&self, line: &[(f64, OnSurface)], forth: f64) -> Result<(), SectionFault> {
        for pair in line.windows(2) {
            let [(x, p), (to, q)] = [pair[0], pair[1]];
            let middle = self.line.at(0.5 * (x + to));
            let (sin, cos) = libm::sincos(middle.beta);
            let step = middle.dm * (q[0] - p[0]) * cos + middle.r * (q[1] - p[1]) * sin;
            if step.is_nan() || step * forth <= 0.0 {
                return Err(self.fault(x, FaultKind::Fold(self.thickness(x))));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::camber::{CamberAngles, CamberRow};
    use super::super::meridional::{EdgeLine, MeridianByLength, MeridionalPatch};
    use super::*;
    use nurbs::interpolate;

    /// Camber lines of constant beta on cones (hub, shroud) from (5, 0) to (29, -32), 10 mm apart: sin(phi) = 0.6.
    fn cone(beta: f64) -> CamberSurface {
        let meridian = |r: f64| {
            let points = [Point3::new(r, 0.0, 0.0), Point3::new(r + 24.0, 0.0, -32.0)];
            MeridianByLength::new(&interpolate(&points, 1).unwrap()).unwrap()
        };
        let ends = [5.0, 15.0].map(meridian);
        let edges = [EdgeLine::straight([0.0; 2]), EdgeLine::straight([40.0; 2])];
        let angles = CamberAngles::Beta { beta: Distribution::constant(beta), end: 0, theta: 0.0 };
        let row = CamberRow { span: 0.0, angles };
        CamberSurface::new(MeridionalPatch::new(ends, edges), &[row], Distribution::constant(0.0)).unwrap()
    }

    fn blade<'a>(camber: &'a CamberSurface, thickness: &[[f64; 2]], edges: [EdgeShape; 2]) -> AngleBlade<'a> {
        let thickness = Thickness { spans: vec![0.0], rows: vec![Distribution::through(thickness).unwrap()] };
        AngleBlade { camber, part: [[0.0; 2], [1.0; 2]], thickness, edges }
    }

    /// A point of the hub's cone laid flat: distance from the apex and angle shrink by sin(phi).
    fn flat(p: &Point3<f64>) -> [f64; 2] {
        let r = libm::hypot(p.x, p.y);
        let (sin, cos) = libm::sincos(libm::atan2(p.y, p.x) * 0.6);
        [r / 0.6 * cos, r / 0.6 * sin]
    }

    /// Cones can be laid flat without strain, where both faces must lie at half of the thickness from the spiral, and the edge
    /// on its ellipse. The spiral is the closed form.
    #[test]
    fn on_a_cone_half_of_the_thickness_lies_to_each_side() {
        let beta: f64 = 0.5;
        let camber = cone(beta);
        let made = blade(&camber, &[[0.0, 2.0], [1.0, 2.0]], [EdgeShape::Elliptic(3.0), EdgeShape::CutOff]);
        let outline = made.section(0.0, Side::Greater).unwrap();
        let spiral: Vec<[f64; 2]> = (-2000..=22_000)
            .map(|k| {
                let r = 5.0 + 24.0 * f64::from(k) / 20_000.0;
                let angle = libm::tan(beta) * libm::log(r / 5.0);
                let (sin, cos) = libm::sincos(angle);
                [r / 0.6 * cos, r / 0.6 * sin]
            })
            .collect();
        let nearest =
            |p: [f64; 2]| spiral.iter().map(|q| libm::hypot(p[0] - q[0], p[1] - q[1])).fold(f64::INFINITY, f64::min);
        for p in outline.faces.iter().flatten() {
            // Points of the spiral are 2.3 um apart.
            assert!((nearest(flat(p)) - 1.0).abs() < 3e-6, "{}", nearest(flat(p)));
        }
        // The spiral and its normals are coordinates for the edge: its length from the nose, and the distance beside.
        for p in &outline.edges[0] {
            let q = flat(p);
            let (k, on_side) = spiral
                .iter()
                .enumerate()
                .map(|(k, s)| (k, libm::hypot(q[0] - s[0], q[1] - s[1])))
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .unwrap();
            let depth = 40.0 * (k as f64 - 2000.0) / 20_000.0 / libm::cos(beta);
            let ellipse = libm::hypot((3.0 - depth) / 3.0, on_side);
            assert!((ellipse - 1.0).abs() < 2e-3, "{depth} {on_side} {ellipse}");
        }
        // Both faces end on the rim.
        for face in &outline.faces {
            assert!((face.last().unwrap().z + 32.0).abs() < 1e-9);
        }
        assert_eq!(outline.edges[1], outline.faces.each_ref().map(|face| *face.last().unwrap()));
    }

    /// A straight blade has faces that are mirror images, and its thickness at each place is the stated one.
    #[test]
    fn a_straight_blade_is_symmetric() {
        let camber = cone(0.0);
        let stated = [[0.0, 1.0], [0.4, 3.0], [1.0, 2.0]];
        let made = blade(&camber, &stated, [EdgeShape::Elliptic(1.0), EdgeShape::Elliptic(2.0)]);
        let thickness = Distribution::through(&stated).unwrap();
        for span in [0.0, 0.3, 1.0] {
            let outline = made.section(span, Side::Smaller).unwrap();
            for (p, s) in outline.faces[0].iter().zip(&outline.faces[1]) {
                assert!((p.x - s.x).abs() < 1e-9 && (p.y + s.y).abs() < 1e-9 && (p.z - s.z).abs() < 1e-9);
                assert!(p.y < 0.0);
            }
            if span > 0.0 {
                continue;
            }
            // Laid flat the camber line is the x axis.
            for p in &outline.faces[1] {
                let [x, y] = flat(p);
                let way = (x * 0.6 - 5.0) / 24.0;
                assert!((2.0 * y - thickness.at(way)).abs() < 1e-6, "{way}: {}", 2.0 * y - thickness.at(way));
            }
        }
    }

    #[test]
    fn what_no_blade_can_be_is_told() {
        let camber = cone(0.5);
        let kind = |thickness: &[[f64; 2]], edges| {
            blade(&camber, thickness, edges).section(0.5, Side::Greater).err().map(|f| f.kind)
        };
        let cut = [EdgeShape::CutOff; 2];
        assert_eq!(kind(&[[0.0, 2.0], [1.0, 2.0]], cut), None);
        assert!(matches!(kind(&[[0.0, 3.0], [0.3, 0.1], [1.0, 3.0]], cut), Some(FaultKind::Thin(t)) if t < 0.0));
        let edges = [EdgeShape::Elliptic(8.0); 2];
        assert!(matches!(kind(&[[0.0, 6.0], [1.0, 6.0]], edges), Some(FaultKind::EdgesMeet(_))));
        // The line bends by 1.2 rad over some 4 mm.
        let values: Vec<[f64; 2]> =
            (0..=20).map(|k| [f64::from(k) / 20.0, 0.6 * f64::from((k - 10_i32).signum())]).collect();
        let beta = Distribution::through(&values).unwrap();
        let angles = CamberAngles::Beta { beta, end: 0, theta: 0.0 };
        let row = CamberRow { span: 0.0, angles };
        let straight = [EdgeLine::straight([0.0; 2]), EdgeLine::straight([40.0; 2])];
        let meridian = |r: f64| {
            let points = [Point3::new(r, 0.0, 0.0), Point3::new(r + 24.0, 0.0, -32.0)];
            MeridianByLength::new(&interpolate(&points, 1).unwrap()).unwrap()
        };
        let patch = MeridionalPatch::new([5.0, 15.0].map(meridian), straight);
        let bent = CamberSurface::new(patch, &[row], Distribution::constant(0.0)).unwrap();
        let thin = blade(&bent, &[[0.0, 0.5], [1.0, 0.5]], cut);
        assert!(thin.section(0.0, Side::Greater).is_ok());
        let fault = blade(&bent, &[[0.0, 10.0], [1.0, 10.0]], cut).section(0.0, Side::Greater).unwrap_err();
        assert!(matches!(fault.kind, FaultKind::Fold(_)) && (fault.way - 0.5).abs() < 0.1, "{fault:?}");
    }
}
