//! Divides sections into faces and edges.
//!
//! A loop is divided at its noses and edges. Two rules tell what is what:
//!
//! - The leading edge is the nose nearer to the inlet: along the hub where it is known, otherwise the caller says at which edge
//!   the loop begins.
//! - The pressure face is that of a section given as faces, or the one that the caller states by its side of the blade.
//!   [`pressure_side`] finds the side for a blade that takes up work.

use super::edges::{self, FoundEdge};
use super::fold::{Fold, fold};
use super::ring::Ring;
use super::stream::{self, Camber};
use super::{LoopEdges, MeanPoint, Outline, Section, SectionForm, ThicknessDirection, mean_line};
use nalgebra::Point3;
use nurbs::chords::from_chords;
use std::fmt;

/// Fewest points of a loop.
const MIN_LOOP_POINTS: usize = 8;

/// Least turn of a mean line that shows its concave face, rad: 3 deg.
const LEAST_TURN: f64 = 3.0 * std::f64::consts::PI / 180.0;

/// Side of a blade by the angle about the axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The face at the greater angle about +Z.
    Greater,
    /// The face at the smaller angle.
    Smaller,
}

/// What tells the leading edge of a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Inlet<'a> {
    /// Points (r, z) of a meridian from inlet to outlet, mm: hub or shroud.
    Meridian(&'a [[f64; 2]]),
    /// The loop begins near its leading edge.
    BeginsThere,
    /// The loop begins near its trailing edge.
    BeginsAtOutlet,
    /// Nothing.
    Unknown,
}

/// What is known in addition to the points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known<'a> {
    /// What tells the leading edge.
    pub inlet: Inlet<'a>,
    /// Side of the pressure face. A section that is given as faces says it itself.
    pub pressure: Side,
}

/// A section with its faces and edges.
#[derive(Clone, Debug, PartialEq)]
pub struct DividedSection {
    /// Faces and edges.
    pub outline: Outline,
    /// Leading and trailing edge.
    pub edges: [FoundEdge; 2],
    /// Largest distance from one face to the other, mm.
    pub thickness: f64,
    /// Turn of the mean line, rad; positive towards greater angles about +Z.
    pub turn: f64,
    /// Angle about +Z from the leading to the trailing edge of the mean line, rad.
    pub wrap: f64,
    /// Side of the pressure face.
    pub pressure: Side,
}

/// Why a section cannot be divided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutlineFault {
    /// Too few points.
    TooFewPoints(usize),
    /// A coordinate is not finite, or the section has no length.
    NoLength,
    /// Nothing tells which nose is the leading edge.
    NoInlet,
    /// Both noses are as near to the inlet.
    SameInlet,
    /// An edge takes the whole blade: the section has no faces.
    NoFaces,
    /// A mean line has no direction at a point, or a thickness larger than the blade.
    MeanLine(usize),
}

impl fmt::Display for OutlineFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFewPoints(n) => write!(f, "{n} points are too few for faces and edges"),
            Self::NoLength => write!(f, "the points have no length"),
            Self::NoInlet => write!(f, "nothing tells which end is the leading edge"),
            Self::SameInlet => write!(f, "both ends are as near to the inlet"),
            Self::NoFaces => write!(f, "the points have no two faces with an edge at each end"),
            Self::MeanLine(k) => write!(f, "the mean line has no direction at point {}", k + 1),
        }
    }
}

impl std::error::Error for OutlineFault {}

/// Side of the pressure face of a blade by its sections, where two rules do not contradict each other.
///
/// - A blade that takes up work, of a compressor, pump or fan, meets the flow against the rotation, so from the leading to
///   the trailing edge it falls behind. The pressure face is the one ahead.
/// - The pressure face is the concave one, where the mean line is taken in coordinates that keep its angles (`stream.rs`) and
///   turns by 3 deg or more on the mean. On a radial blade the face that is concave in space may be another one.
///
/// The blades of turbines contradict the first rule.
pub fn pressure_side(sections: &[DividedSection]) -> Option<Side> {
    let mean =
        |value: fn(&DividedSection) -> f64| sections.iter().map(value).sum::<f64>() / sections.len().max(1) as f64;
    side_by_turns(mean(|d| d.wrap), mean(|d| d.turn))
}

/// The same by the means of wrap and turn, rad.
pub fn side_by_turns(wrap: f64, turn: f64) -> Option<Side> {
    let ahead = if wrap < 0.0 { Side::Greater } else { Side::Smaller };
    let concave = if turn > 0.0 { Side::Greater } else { Side::Smaller };
    (wrap != 0.0 && (turn.abs() < LEAST_TURN || ahead == concave)).then_some(ahead)
}

/// Divides a section.
///
/// # Errors
/// [`OutlineFault`].
pub fn outline(section: &Section, known: &Known<'_>) -> Result<DividedSection, OutlineFault> {
    match &section.form {
        SectionForm::Loop(points) => of_loop(points, section.span, known),
        SectionForm::DividedLoop { points, edges } => of_divided_loop(points, *edges, section.span, known.pressure),
        SectionForm::Faces([pressure, suction]) => of_faces([pressure, suction], section.span),
        SectionForm::MeanLine { points, thickness } => of_mean_line(points, *thickness, section.span, known),
    }
}

fn checked(points: &[Point3<f64>], fewest: usize) -> Result<Ring, OutlineFault> {
    if points.iter().any(|p| !p.coords.iter().all(|x| x.is_finite())) {
        return Err(OutlineFault::NoLength);
    }
    let ring = Ring::new(points);
    if ring.len() < fewest {
        return Err(OutlineFault::TooFewPoints(ring.len()));
    }
    if ring.length() > 0.0 && ring.length().is_finite() { Ok(ring) } else { Err(OutlineFault::NoLength) }
}

fn of_loop(points: &[Point3<f64>], span: Option<f64>, known: &Known<'_>) -> Result<DividedSection, OutlineFault> {
    let ring = checked(points, MIN_LOOP_POINTS)?;
    let Fold { noses, thickness } = fold(&ring);
    let noses = from_inlet(&ring, noses, known.inlet)?;
    let of_faces = edges::of_faces(&ring);
    let ends = noses.map(|nose| edges::ends(&ring, nose, thickness, of_faces));
    divided(&ring, ends, span, Sides::By(known.pressure))
}

/// A loop whose edges are stated.
fn of_divided_loop(
    points: &[Point3<f64>],
    edges: LoopEdges,
    span: Option<f64>,
    pressure: Side,
) -> Result<DividedSection, OutlineFault> {
    let ring = checked(points, MIN_LOOP_POINTS)?;
    if ring.len() != points.len() || edges.iter().flatten().any(|k| *k >= points.len()) {
        return Err(OutlineFault::NoFaces);
    }
    divided(&ring, edges, span, Sides::By(pressure))
}

/// Largest distance from one face to the other, mm. Where an end of the other face is nearest, what is measured is its edge,
/// which counts only on a blade without any other place.
fn thickness([face, other]: [&[Point3<f64>]; 2]) -> f64 {
    let ends = [other.first(), other.last()];
    let (mut inside, mut all) = (0.0_f64, 0.0_f64);
    for p in face {
        let distance = from_chords(p, other);
        all = all.max(distance);
        if ends.iter().flatten().all(|end| distance < nalgebra::distance(p, end)) {
            inside = inside.max(distance);
        }
    }
    if inside > 0.0 { inside } else { all }
}

/// Orders the noses: the leading edge first.
fn from_inlet(ring: &Ring, [a, b]: [usize; 2], inlet: Inlet<'_>) -> Result<[usize; 2], OutlineFault> {
    let leading_first = match inlet {
        Inlet::Meridian(line) => {
            let [at_a, at_b] = [a, b]
                .map(|k| stream::along(line, [libm::hypot(ring.points[k].x, ring.points[k].y), ring.points[k].z]));
            if at_a == at_b {
                return Err(OutlineFault::SameInlet);
            }
            at_a < at_b
        }
        Inlet::BeginsThere | Inlet::BeginsAtOutlet => {
            let [at_a, at_b] = [a, b].map(|k| ring.between(0, k).min(ring.between(k, 0)));
            (at_a <= at_b) == (inlet == Inlet::BeginsThere)
        }
        Inlet::Unknown => return Err(OutlineFault::NoInlet),
    };
    Ok(if leading_first { [a, b] } else { [b, a] })
}

/// How the faces are named.
enum Sides {
    /// The face in the order of the loop from the leading edge is the suction face.
    SuctionFirst,
    /// By the side of the pressure face.
    By(Side),
}

/// Divides a loop at its edges, the leading one first. Each is from its first to its last point in the order of the loop.
fn divided(
    ring: &Ring,
    [leading, trailing]: [[usize; 2]; 2],
    span: Option<f64>,
    sides: Sides,
) -> Result<DividedSection, OutlineFault> {
    let (forth, back) = ([leading[1], trailing[0]], [trailing[1], leading[0]]);
    // Once round the loop, or twice where the edges overlap.
    let in_order = [forth[0], forth[1], back[0], back[1], forth[0]];
    let round: f64 = in_order.windows(2).map(|w| ring.between(w[0], w[1])).sum();
    if round > 1.5 * ring.length() || forth[0] == forth[1] || back[0] == back[1] {
        return Err(OutlineFault::NoFaces);
    }
    let forth_points = ring.points_between(forth[0], forth[1]);
    let mut back_points = ring.points_between(back[0], back[1]);
    back_points.reverse();
    let (leading_points, leading_edge) = edges::describe(ring, [back[1], forth[0]]);
    let (trailing_points, trailing_edge) = edges::describe(ring, [forth[1], back[0]]);

    let Camber { between, turn, wrap } = stream::camber([&forth_points, &back_points]);
    // `between` is the angle from the face forth to the face back.
    let side_of_back = if between > 0.0 { Side::Greater } else { Side::Smaller };
    let back_is_pressure = match sides {
        Sides::SuctionFirst => true,
        Sides::By(side) => side == side_of_back,
    };
    let pressure = if back_is_pressure == (side_of_back == Side::Greater) { Side::Greater } else { Side::Smaller };
    let other_way = |mut points: Vec<Point3<f64>>| {
        points.reverse();
        points
    };
    // In the order of the loop the leading edge goes from the face back to the face forth.
    let (faces, edges) = if back_is_pressure {
        ([back_points, forth_points], [leading_points, other_way(trailing_points)])
    } else {
        ([forth_points, back_points], [other_way(leading_points), trailing_points])
    };
    let thickness = thickness([&faces[0], &faces[1]]);
    let outline = Outline { span, faces, edges };
    Ok(DividedSection { outline, edges: [leading_edge, trailing_edge], thickness, turn, wrap, pressure })
}

/// Joins two faces to a loop. Where they meet, the edge is searched for; where they do not, it is cut off.
fn of_faces([pressure, suction]: [&[Point3<f64>]; 2], span: Option<f64>) -> Result<DividedSection, OutlineFault> {
    let [mut back, mut forth] = [pressure, suction].map(<[Point3<f64>]>::to_vec);
    back.dedup();
    forth.dedup();
    let (meet_first, meet_last) = (back.first() == forth.first(), back.last() == forth.last());
    let count = forth.len();
    let back = back.iter().skip(usize::from(meet_first)).rev().skip(usize::from(meet_last));
    let ring = checked(&forth.iter().chain(back).copied().collect::<Vec<_>>(), 4)?;
    let last = count.checked_sub(1).filter(|last| *last < ring.len()).ok_or(OutlineFault::NoFaces)?;
    let thickness = thickness([suction, pressure]);
    let of_faces = edges::of_faces(&ring);
    let nose = |nose: usize| edges::ends(&ring, nose, thickness, of_faces);
    let leading = if meet_first { nose(0) } else { [ring.on(0, -1), 0] };
    let trailing = if meet_last { nose(last) } else { [last, ring.on(last, 1)] };
    divided(&ring, [leading, trailing], span, Sides::SuctionFirst)
}

/// Lays half of the thickness to both sides of a mean line. Such sections have no edges: they are cut off.
fn of_mean_line(
    points: &[MeanPoint],
    direction: ThicknessDirection,
    span: Option<f64>,
    known: &Known<'_>,
) -> Result<DividedSection, OutlineFault> {
    if points.len() < 2 {
        return Err(OutlineFault::TooFewPoints(points.len()));
    }
    let [greater, smaller] = mean_line::sides(points, direction).map_err(OutlineFault::MeanLine)?;
    let Camber { turn, wrap, .. } = stream::camber([&smaller, &greater]);
    let pressure = known.pressure;
    let faces = if pressure == Side::Greater { [greater, smaller] } else { [smaller, greater] };
    let thickness = thickness([&faces[0], &faces[1]]);
    let cut = |ends: Option<(&Point3<f64>, &Point3<f64>)>| {
        let points: Vec<Point3<f64>> = ends.map_or_else(Vec::new, |(a, b)| vec![*a, *b]);
        let width = ends.map_or(0.0, |(a, b)| nalgebra::distance(a, b));
        let form = if width > 0.0 { edges::EdgeForm::CutOff } else { edges::EdgeForm::Sharp };
        let points = if width > 0.0 { points } else { points.into_iter().take(1).collect() };
        let edge = FoundEdge { form, width, depth: 0.0, radius: 0.0, residual: 0.0, points: points.len() };
        (points, edge)
    };
    let [(le, leading), (te, trailing)] =
        [cut(faces[0].first().zip(faces[1].first())), cut(faces[0].last().zip(faces[1].last()))];
    let outline = Outline { span, faces, edges: [le, te] };
    Ok(DividedSection { outline, edges: [leading, trailing], thickness, turn, wrap, pressure })
}
