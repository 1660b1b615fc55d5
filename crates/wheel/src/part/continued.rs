//! Walls of passages from the inlet to the outlet of the part, where a blade is shorter.
//!
//! A main blade is a wall over the whole length of its passages. The wall of a splitter is continued before and behind the
//! splitter, at the share of the way between the main blades that the splitter has at its end. So a tool that follows a
//! passage goes on where a splitter begins or ends. Continued walls are coordinates of the planner. Distances are those
//! from the blades.

use super::beyond::Beyond;
use super::passage::WholeWall;
use super::{Across, BladeId, FaceId, FaceLine, FaceSurface, Part, Passage, PassageId, Surface};
use nalgebra::{Matrix2, Point3, Vector2, Vector3};
use nurbs::{LoftedSurface, NurbsCurve};

/// Spans of a continued wall along the channel: about half a millimetre each on a wheel of 60 mm.
const WALL_SPANS: usize = 80;

/// Sections of a continued wall from hub to shroud.
const WALL_SECTIONS: usize = 7;

/// Places along a face whose u on the continued wall is known, minus one.
const FACE_INTERVALS: usize = 64;

impl Part {
    /// The walls of a passage from the inlet (u = 0) to the outlet (1) of the part, sector 0. The wall of a splitter is
    /// continued before and behind the splitter.
    pub fn walls(&self, passage: PassageId) -> [&WholeWall; 2] {
        let [first, second] = &self.whole_walls(all)[passage.index()];
        [first, second]
    }

    /// u along the walls of its passage at a u of a face.
    pub fn along_channel(&self, face: FaceId, u: f64) -> f64 {
        let (passage, side) = self.passage_of(face);
        self.whole_walls(all)[passage.index()][side].u(u)
    }
}

fn all(part: &Part) -> Vec<[WholeWall; 2]> {
    part.passages().map(|passage| [0, 1].map(|side| wall(part, &passage, side))).collect()
}

/// The wall of a passage on a side, 0 for the clockwise one.
fn wall(part: &Part, passage: &Passage, side: usize) -> WholeWall {
    let face = passage.walls[side];
    let own = || (part.face(face).surface.clone(), Vec::new());
    let (surface, along) = Continued::new(part, face).and_then(|continued| continued.wall()).unwrap_or_else(own);
    let beyond = [0, 1].map(|end: usize| {
        let inside = part.ends_inside(BladeId::MAIN, end);
        inside.then(|| Beyond::new([&part.hub, &part.shroud], part.pitch(), &surface, end)).flatten()
    });
    WholeWall { surface, beyond, along }
}

/// A face of a splitter between main blades.
struct Continued<'a> {
    part: &'a Part,
    face: FaceId,
    main: [FaceId; 2],
}

/// A place on the face of a splitter: share of the way between main blades, and parameters of the face.
#[derive(Clone, Copy)]
struct OnFace {
    share: f64,
    uv: [f64; 2],
}

impl<'a> Continued<'a> {
    fn new(part: &'a Part, face: FaceId) -> Option<Self> {
        let ahead = part.face_ahead(BladeId::MAIN);
        (face.blade != BladeId::MAIN).then_some(Self { part, face, main: [ahead, ahead.other()] })
    }

    fn across(&self, lines: &[FaceLine<'_>; 2], v: f64) -> Across {
        Across::between(lines.map(|line| line.point(v)), self.part.pitch())
    }

    /// The place of the face on the way between the main blades at (u, v), by Newton steps in the meridian plane from a place
    /// near it. The face continues straight beyond its ends.
    fn place(&self, across: &Across, near: OnFace) -> Option<OnFace> {
        /// Steps: the share of the way changes radius and height little.
        const WAY_STEPS: usize = 12;
        /// Change of the parameters below which the search ends.
        const SAME_PARAMETER: f64 = 1e-9;
        /// How far beyond its ends a face is followed.
        const FOLLOWED_BEYOND: f64 = 0.5;
        let surface = &self.part.face(self.face).surface;
        let mut at = near;
        for _ in 0..WAY_STEPS {
            let wanted = across.point(at.share);
            let (p, su, sv) = surface.tangents(at.uv[0], at.uv[1]);
            let r = libm::hypot(p.x, p.y);
            let radial = |d: &Vector3<f64>| (p.x * d.x + p.y * d.y) / r;
            let slopes = Matrix2::new(radial(&su), radial(&sv), su.z, sv.z);
            let missing = Vector2::new(libm::hypot(wanted.x, wanted.y) - r, wanted.z - p.z);
            let step = slopes.try_inverse()? * missing;
            at.uv = [0, 1].map(|k| {
                (at.uv[k] + step[k].clamp(-FOLLOWED_BEYOND, FOLLOWED_BEYOND))
                    .clamp(-FOLLOWED_BEYOND, 1.0 + FOLLOWED_BEYOND)
            });
            let found = surface.point(at.uv[0], at.uv[1]);
            at.share = across.share(libm::atan2(found.y, found.x));
            if step.amax() < SAME_PARAMETER {
                break;
            }
        }
        at.share.is_finite().then_some(at)
    }

    /// Places at equal steps of u along one height, from the inlet to the outlet.
    fn row(&self, lines: &[[FaceLine<'a>; 2]], v: f64) -> Option<Vec<OnFace>> {
        let middle = self.part.face(self.face).surface.point(0.5, v);
        let share = |line: &[FaceLine<'_>; 2]| self.across(line, v).share(libm::atan2(middle.y, middle.x));
        let mut near = OnFace { share: share(&lines[lines.len() / 2]), uv: [1.0, v] };
        let mut row = Vec::with_capacity(lines.len());
        for line in lines.iter().rev() {
            near = self.place(&self.across(line, v), near)?;
            row.push(near);
        }
        row.reverse();
        // Beyond both ends the share stays.
        let inside = |at: &OnFace| (0.0..=1.0).contains(&at.uv[0]);
        let (first, last) = (row.iter().position(inside)?, row.iter().rposition(inside)?);
        let ends = [row[first].share, row[last].share];
        row[..first].iter_mut().for_each(|at| at.share = ends[0]);
        row[last + 1..].iter_mut().for_each(|at| at.share = ends[1]);
        Some(row)
    }

    /// The continued wall: a cubic spline that lies near its points and is smooth where the face ends; and u of the wall at equal
    /// shares of the u of its face.
    fn wall(&self) -> Option<(FaceSurface, Vec<f64>)> {
        let [first, second] = self.main.map(|face| &self.part.face(face).surface);
        let knots: Vec<f64> =
            (0..=WALL_SPANS + 6).map(|i| (i as f64 - 3.0).clamp(0.0, WALL_SPANS as f64) / WALL_SPANS as f64).collect();
        // Points at the means of three knots are the control points (Schoenberg).
        let stations: Vec<f64> =
            (0..WALL_SPANS + 3).map(|i| (knots[i + 1] + knots[i + 2] + knots[i + 3]) / 3.0).collect();
        let lines: Vec<[FaceLine<'_>; 2]> = stations.iter().map(|u| [first.line(*u), second.line(*u)]).collect();
        let heights: Vec<f64> = (0..WALL_SECTIONS).map(|j| j as f64 / (WALL_SECTIONS - 1) as f64).collect();
        let rows = heights.iter().map(|v| self.row(&lines, *v)).collect::<Option<Vec<_>>>()?;
        let section = |(row, v): (&Vec<OnFace>, &f64)| {
            let points: Vec<Point3<f64>> =
                row.iter().zip(&lines).map(|(at, line)| self.across(line, *v).point(at.share)).collect();
            NurbsCurve::try_new(3, knots.clone(), &points, None).ok()
        };
        let sections = rows.iter().zip(&heights).map(section).collect::<Option<Vec<_>>>()?;
        let surface = FaceSurface::Lofted(LoftedSurface::at(sections, heights).ok()?);
        let middle = &rows[WALL_SECTIONS / 2];
        let place = |i: usize| {
            let u = i as f64 / FACE_INTERVALS as f64;
            let next = middle.iter().position(|at| at.uv[0] >= u).unwrap_or(middle.len() - 1).max(1);
            let (a, b) = (middle[next - 1].uv[0], middle[next].uv[0]);
            let share = ((u - a) / (b - a).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            stations[next - 1] + (stations[next] - stations[next - 1]) * share
        };
        Some((surface, (0..=FACE_INTERVALS).map(place).collect()))
    }
}
