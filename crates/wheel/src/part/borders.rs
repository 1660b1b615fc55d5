//! Borders: where the surfaces of blades end on the hub, and turned surfaces between the faces of a blade.

use super::{BladeId, FaceId, Part, Passage, Surface, hub_normal};
use nalgebra::{Point3, Vector2};
use nurbs::angle::nearest_turn;
use nurbs::bracket::Bracket;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// The hub between the walls of a passage, sector 0.
pub(super) struct Opening {
    walls: [Wall; 2],
    /// Angle from the sector of the first wall to that of the second, radians.
    turn: f64,
    /// The opening between a main blade and the next, in a part with splitters.
    whole: Option<Box<Opening>>,
}

/// A wall on the hub.
struct Wall {
    border: Vec<[f64; 2]>,
    /// Shares of the whole opening at which one passage ends and the next begins, before and behind a splitter.
    beyond: Option<[f64; 2]>,
    /// How far before and behind a splitter its border goes straight on, in parameters of the hub.
    straight: [f64; 2],
}

/// Parameters of the hub that differ by less count as equal: rounding of the ends of a border.
const SAME_HUB_PARAMETER: f64 = 1e-9;

/// A ball that rolls along a wall over the hub.
#[derive(Clone, Copy, Debug)]
pub struct Rolling {
    /// Distance of its centre from the face, mm.
    pub wall: f64,
    /// Distance of its centre from the hub, mm.
    pub floor: f64,
    /// Largest v of the place beside the face.
    pub top: f64,
}

impl Rolling {
    /// A ball of this radius that touches face and hub.
    pub fn ball(radius: f64) -> Self {
        Self { wall: radius, floor: radius, top: 1.0 }
    }
}

/// What borders of the floor follow along the walls.
#[derive(Clone, Copy, Debug)]
pub enum FloorBorder {
    /// The lower edges of the fillets; along a wall without one the root of the face, or the contacts of a ball of this radius, mm.
    Fillets(Option<f64>),
    /// The contacts of a ball.
    Ball(Rolling),
}

impl FloorBorder {
    /// The ball beside a face at u; `None` for the root of the face.
    pub fn ball(self, part: &Part, id: FaceId, u: f64) -> Option<Rolling> {
        match self {
            Self::Fillets(sharp) => part.fillet_radius(id, u).or(sharp).map(Rolling::ball),
            Self::Ball(rolling) => Some(rolling),
        }
    }
}

impl Part {
    /// Azimuths on the hub of both borders of a passage, at places along the hub: where a ball that rolls along its walls
    /// touches the hub, also round edges that are surfaces of their own. Before and behind a splitter the border is shared with
    /// the next passage. Sector 0, each border in the sector of its blade. `None` where no ball has a place.
    pub fn floor_borders(&self, passage: &Passage, along: FloorBorder, places: &[f64]) -> Option<[Vec<f64>; 2]> {
        let mut opening = Opening::rolled(self, passage, along);
        // An edge without a surface of its own has no fillet: the ball stays in front of it.
        for (wall, face) in opening.walls.iter_mut().zip(passage.walls) {
            let ends = [wall.border.first(), wall.border.last()].map(|end| end.map_or(0.0, |p| p[0]));
            let blunt = |end: usize| self.ends_inside(face.blade, end) && self.edge(face.blade, end).is_none();
            let before = |end: usize| {
                let wall = along.ball(self, face, end as f64).map_or(0.0, |ball| ball.wall);
                wall / self.hub.meridian(ends[end]).first.norm()
            };
            for end in [0, 1].into_iter().filter(|end| blunt(*end)) {
                wall.straight[end] = before(end);
            }
        }
        let at = places.iter().map(|u| opening.at(*u)).collect::<Option<Vec<_>>>()?;
        let second = |[from, angle]: &[f64; 2]| from + angle - self.turn(passage);
        Some([at.iter().map(|at| at[0]).collect(), at.iter().map(second).collect()])
    }
}

impl Opening {
    pub(super) fn of(part: &Part, passage: &Passage) -> Self {
        Self::rolled(part, passage, FloorBorder::Fillets(None))
    }

    fn rolled(part: &Part, passage: &Passage, along: FloorBorder) -> Self {
        let hub_border = |wall: FaceId| hub_border(part, wall, along);
        let whole = (part.blades.len() > 1).then(|| {
            let ahead = part.face_ahead(BladeId::MAIN);
            let walls =
                [ahead, ahead.other()].map(|wall| Wall { border: hub_border(wall), beyond: None, straight: [0.0; 2] });
            Box::new(Self { walls, turn: part.pitch(), whole: None })
        });
        let walls = passage.walls.map(|wall| {
            let border = hub_border(wall);
            let whole = whole.as_ref().filter(|_| wall.blade != BladeId::MAIN);
            let beyond = whole.and_then(|whole| shares(whole, &border, &hub_border(wall.other())));
            let straight = [0, 1].map(|end| if part.ends_inside(wall.blade, end) { 0.0 } else { f64::INFINITY });
            Wall { border, beyond, straight }
        });
        Self { walls, turn: part.turn(passage), whole }
    }

    /// Azimuth of the first wall and the angle from it to the second wall, radians, at a parameter of the hub.
    pub(super) fn at(&self, u: f64) -> Option<[f64; 2]> {
        let [from, to] = self.walls.each_ref().map(|wall| self.azimuth(wall, u));
        let (from, to) = (from?, to?);
        Some([from, nearest_turn(to - from, 0.0) + self.turn])
    }

    fn azimuth(&self, wall: &Wall, u: f64) -> Option<f64> {
        let end = match wall.border.as_slice() {
            [first, ..] if u < first[0] - wall.straight[0] - SAME_HUB_PARAMETER => Some(0),
            [.., last] if u > last[0] + wall.straight[1] + SAME_HUB_PARAMETER => Some(1),
            _ => None,
        };
        match (end, wall.beyond, &self.whole) {
            (Some(end), Some(shares), Some(whole)) => {
                let [from, angle] = whole.at(u)?;
                Some(from + angle * shares[end])
            }
            _ => border_azimuth(&wall.border, u),
        }
    }
}

/// Shares of the whole opening, in the middle between both borders of a splitter, at the first and at the last row.
fn shares(whole: &Opening, own: &[[f64; 2]], other: &[[f64; 2]]) -> Option<[f64; 2]> {
    let share = |own: &[f64; 2], other: &[f64; 2]| {
        let [from, angle] = whole.at(own[0])?;
        let middle = own[1] + 0.5 * nearest_turn(other[1] - own[1], 0.0);
        Some((middle - from).rem_euclid(TAU) / angle)
    };
    Some([share(own.first()?, other.first()?)?, share(own.last()?, other.last()?)?])
}

/// Centre of the rolling ball beside a face at u, or the end of the face on the hub. The contact on the hub lies on
/// the normal through the centre and has the same azimuth.
fn contact(part: &Part, id: FaceId, u: f64, along: FloorBorder) -> Option<Point3<f64>> {
    let face = part.face(id);
    match along.ball(part, id, u) {
        Some(Rolling { wall, floor, top }) => {
            let v = part.v_of_centre(id, u, [wall, floor], top)?;
            let (point, normal) = face.point_and_normal(u, v);
            Some(point + normal * wall)
        }
        None => Some(face.surface.point(u, part.ruling_meets(id, u, &part.hub, 0.0))),
    }
}

/// Parameter of the hub below a point.
fn hub_parameter(part: &Part, at: &Point3<f64>) -> f64 {
    part.hub.closest(Vector2::new(libm::hypot(at.x, at.y), at.z)).0
}

/// u of an edge at which its border on the hub is farthest out: there the borders of both faces meet.
fn nose(part: &Part, blade: BladeId, end: usize, along: FloorBorder) -> f64 {
    /// Places along an edge: a nose of a millimetre has one every twentieth of a millimetre.
    const EDGE_PLACES: usize = 64;
    let Some(edge) = part.edge(blade, end) else { return 0.5 };
    let outward = if end == 0 { -1.0 } else { 1.0 };
    let at = |i: usize| {
        let u = i as f64 / EDGE_PLACES as f64;
        contact(part, edge, u, along).map(|p| (u, outward * hub_parameter(part, &p)))
    };
    let places: Vec<(f64, f64)> = (0..=EDGE_PLACES).into_par_iter().filter_map(at).collect();
    places.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0.5, |(u, _)| u)
}

/// Azimuths of the edge of a fillet (or of the root) along the hub: (u of the hub, azimuth), ascending.
fn hub_border(part: &Part, id: FaceId, along: FloorBorder) -> Vec<[f64; 2]> {
    /// Rows along a face, and along half an edge.
    const FACE_ROWS: [usize; 2] = [400, 60];
    let ball = |u: f64| along.ball(part, id, u);
    let mut ends = match ball(0.0) {
        Some(at_inlet) => part.fillet_ends(id, |u| ball(u).unwrap_or(at_inlet).wall),
        None => [0.0, 1.0],
    };
    if id.blade != BladeId::MAIN {
        let extent = part.extent(id.blade);
        let foot = |u: f64| {
            let centre = contact(part, id, u, along)?;
            Some(centre - hub_normal(part, &centre) * ball(u).map_or(0.0, |ball| ball.floor))
        };
        let own = [0, 1].map(|end| part.edge(id.blade, end).is_some());
        ends = [0, 1].map(|end| {
            if own[end] { ends[end] } else { inside(ends[end], |u| foot(u).is_some_and(|p| extent.holds(&p))) }
        });
    }
    let mut border: Vec<[f64; 2]> = Vec::new();
    for (surface, range) in part.along(id, [0, 1].map(|end| nose(part, id.blade, end, along))) {
        let ([from, to], rows) = if surface == id { (ends, FACE_ROWS[0]) } else { (range, FACE_ROWS[1]) };
        let row = |i: usize| {
            let at = contact(part, surface, from + (to - from) * i as f64 / rows as f64, along)?;
            Some((hub_parameter(part, &at), libm::atan2(at.y, at.x)))
        };
        let contacts: Vec<(f64, f64)> = (0..=rows).into_par_iter().filter_map(row).collect();
        for (hub_u, mut azimuth) in contacts {
            if let Some(last) = border.last() {
                // Where an edge begins the border is the end of the face again.
                if surface.edge_end().is_some() && hub_u <= last[0] {
                    continue;
                }
                azimuth = nearest_turn(azimuth, last[1]);
            }
            border.push([hub_u, azimuth]);
        }
    }
    border
}

/// The place nearest to `end` at which a property holds, between `end` and the middle of a face, by bisection.
fn inside(end: f64, holds: impl Fn(f64) -> bool) -> f64 {
    if holds(end) {
        return end;
    }
    // Bisection of a face of some 100 mm down to rounding.
    Bracket { holds: 0.5, fails: end }.halved(48, holds).holds
}

/// Azimuth of a border at a hub parameter; constant beyond its ends.
fn border_azimuth(border: &[[f64; 2]], u: f64) -> Option<f64> {
    let i = border.partition_point(|p| p[0] <= u);
    let (first, last) = (border.first()?, border.last()?);
    if i == 0 {
        return Some(first[1]);
    }
    let Some(q) = border.get(i) else { return Some(last[1]) };
    let p = border[i - 1];
    Some(p[1] + (q[1] - p[1]) * (u - p[0]) / (q[0] - p[0]).max(f64::MIN_POSITIVE))
}

/// The point at a share of the path from one point to another about Z, as on a turned surface.
pub(super) fn arc_between(from: &Point3<f64>, to: &Point3<f64>, share: f64) -> Point3<f64> {
    let [p, q] = [from, to].map(|p| [libm::hypot(p.x, p.y), p.z, libm::atan2(p.y, p.x)]);
    let ahead = nearest_turn(q[2] - p[2], 0.0);
    let ([r, z], angle) = ([0, 1].map(|k| p[k] + (q[k] - p[k]) * share), p[2] + ahead * share);
    Point3::new(r * libm::cos(angle), r * libm::sin(angle), z)
}
