//! Passages: the space between two neighbouring blades, and its walls from the inlet to the outlet of the part.

use super::beyond::Beyond;
use super::blade::FaceId;
use super::names::PassageId;
use super::surface::{FaceLine, FaceSurface};
use nalgebra::{Point3, Vector3};
use nurbs::angle::nearest_turn;

/// The space between two neighbouring blades.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Passage {
    /// Identifier of the passage.
    pub id: PassageId,
    /// Faces of its walls, the clockwise wall first.
    pub walls: [FaceId; 2],
    /// Sectors from the first wall to the second: 1 behind the last blade of a sector, else 0.
    pub sectors: u32,
}

/// Points of both walls of a passage, and all points on the way about Z from the first to the second.
#[derive(Clone, Copy)]
pub struct Across([Cylindrical; 2]);

/// Cylindrical coordinates; the azimuth in radians.
#[derive(Clone, Copy)]
struct Cylindrical {
    r: f64,
    azimuth: f64,
    z: f64,
}

impl Across {
    /// From a point of the first wall to a point of the second; both as they are in sector 0. `turn` is the angle between the
    /// sectors of both walls, radians.
    pub fn between(points: [Point3<f64>; 2], turn: f64) -> Self {
        let [first, mut second] =
            points.map(|p| Cylindrical { r: libm::hypot(p.x, p.y), azimuth: libm::atan2(p.y, p.x), z: p.z });
        // The second wall lies a turn on, more or less the thickness of a blade.
        let ahead = nearest_turn(second.azimuth - first.azimuth, 0.0);
        second.azimuth = first.azimuth + ahead + turn;
        Self([first, second])
    }

    /// Point at a share of the way from the first wall (0) to the second (1).
    pub fn point(&self, share: f64) -> Point3<f64> {
        let Self([a, b]) = self;
        let mix = |x: f64, y: f64| x + (y - x) * share;
        let (r, azimuth) = (mix(a.r, b.r), mix(a.azimuth, b.azimuth));
        Point3::new(r * libm::cos(azimuth), r * libm::sin(azimuth), mix(a.z, b.z))
    }

    /// Length of the way, mm.
    pub fn length(&self) -> f64 {
        let Self([a, b]) = self;
        0.5 * (a.r + b.r) * (b.azimuth - a.azimuth)
    }

    /// Share of the way at an azimuth between both.
    pub(super) fn share(&self, azimuth: f64) -> f64 {
        let Self([a, b]) = self;
        let way = b.azimuth - a.azimuth;
        let from = azimuth - a.azimuth;
        nearest_turn(from, 0.5 * way) / way
    }
}

/// A wall of a passage from the inlet (u = 0) to the outlet (1), sector 0.
#[derive(Clone, Debug)]
pub struct WholeWall {
    pub(super) surface: FaceSurface,
    /// The wall before the inlet and behind the outlet, where it does not go straight on.
    pub(super) beyond: [Option<Beyond>; 2],
    /// u of the wall at equal shares of the u of its face; empty for a face that is the whole wall.
    pub(super) along: Vec<f64>,
}

impl WholeWall {
    /// The wall between its ends.
    pub fn surface(&self) -> &FaceSurface {
        &self.surface
    }

    /// The line of equal u, also beyond the ends.
    pub fn line(&self, u: f64) -> FaceLine<'_> {
        match self.beyond.iter().flatten().find(|beyond| beyond.holds(u)) {
            Some(beyond) => beyond.line(u),
            None => self.surface.line(u),
        }
    }

    /// Unit vector from root to tip at u.
    pub fn ruling(&self, u: f64) -> Vector3<f64> {
        match self.beyond.iter().flatten().find(|beyond| beyond.holds(u)) {
            Some(beyond) => {
                let line = beyond.line(u);
                (line.point(1.0) - line.point(0.0)).normalize()
            }
            None => self.surface.ruling(u),
        }
    }

    /// Point at (u, v).
    pub fn point(&self, u: f64, v: f64) -> Point3<f64> {
        self.line(u).point(v)
    }

    /// u of the wall at a u of its face.
    pub(super) fn u(&self, of_face: f64) -> f64 {
        if self.along.is_empty() {
            return of_face;
        }
        let at = of_face.clamp(0.0, 1.0) * (self.along.len() - 1) as f64;
        let i = (at as usize).min(self.along.len() - 2);
        self.along[i] + (self.along[i + 1] - self.along[i]) * (at - i as f64)
    }
}
