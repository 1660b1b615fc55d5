//! Borders: where the surfaces of blades end on the hub, and how turned surfaces go from one blade face to the other.

use super::{BladeId, FaceId, Part, Passage, Surface};
use nalgebra::{Point3, Vector2};
use std::f64::consts::TAU;

/// The hub between the walls of a passage, sector 0.
pub(super) struct Opening {
    borders: [Vec<[f64; 2]>; 2],
    /// Angle from the sector of the first wall to that of the second.
    turn: f64,
}

impl Opening {
    pub(super) fn of(part: &Part, passage: &Passage) -> Self {
        let borders = passage.walls.map(|wall| {
            let mut border = hub_border(part, wall);
            if wall.blade != BladeId::MAIN {
                close_ahead(&mut border, &hub_border(part, wall.other()));
            }
            border
        });
        Self { borders, turn: part.pitch() * f64::from(passage.sectors) }
    }

    /// Azimuth of the first wall and the angle from it to the second wall, at a parameter of the hub.
    pub(super) fn at(&self, u: f64) -> Option<[f64; 2]> {
        let [a, b] = &self.borders;
        let (from, to) = (border_azimuth(a, u)?, border_azimuth(b, u)?);
        let ahead = to - from;
        Some([from, ahead - TAU * (ahead / TAU).round() + self.turn])
    }
}

/// Before the inlet of a splitter and behind its outlet the hub goes on to the middle between its two borders.
fn close_ahead(border: &mut Vec<[f64; 2]>, other: &[[f64; 2]]) {
    let middle = |own: &[f64; 2], far: &[f64; 2]| {
        let apart = far[1] - own[1];
        [own[0], own[1] + 0.5 * (apart - TAU * (apart / TAU).round())]
    };
    let (Some(first), Some(last), Some(from), Some(to)) = (border.first(), border.last(), other.first(), other.last())
    else {
        return;
    };
    let (before, behind) = (middle(first, from), middle(last, to));
    border.insert(0, before);
    border.push(behind);
}

/// Azimuths of the edge of a fillet (or of the root) along the hub: (u of the hub, azimuth), ascending.
fn hub_border(part: &Part, id: FaceId) -> Vec<[f64; 2]> {
    const ROWS: usize = 400;
    let face = part.face(id);
    let mut border: Vec<[f64; 2]> = Vec::with_capacity(ROWS + 1);
    let (splitter, extent) = (id.blade != BladeId::MAIN, part.extent(id.blade));
    let [from, to] = part.fillet(id).map_or([0.0, 1.0], |radius| part.fillet_ends(id, radius.get()));
    for i in 0..=ROWS {
        let u = from + (to - from) * i as f64 / ROWS as f64;
        let at = match part.fillet(id) {
            Some(radius) => match part.fillet_tangent(id, u, radius.get()) {
                Some(v) => face.surface.point(u, v) + face.normal(u, v) * radius.get(),
                None => continue,
            },
            None => face.surface.point(u, part.ruling_meets(id, u, &part.hub, 0.0)),
        };
        if splitter && !extent.holds(&at) {
            continue;
        }
        let (hub_u, _) = part.hub.closest(Vector2::new(libm::hypot(at.x, at.y), at.z));
        let mut azimuth = libm::atan2(at.y, at.x);
        if let Some(last) = border.last() {
            azimuth -= TAU * ((azimuth - last[1]) / TAU).round();
        }
        border.push([hub_u, azimuth]);
    }
    border
}

/// Azimuth of a border at a hub parameter, its ends continued level.
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

/// The point a share of the way from one point to another about Z, as a lathe leaves them.
pub(super) fn arc_between(from: &Point3<f64>, to: &Point3<f64>, share: f64) -> Point3<f64> {
    let [p, q] = [from, to].map(|p| [libm::hypot(p.x, p.y), p.z, libm::atan2(p.y, p.x)]);
    let ahead = q[2] - p[2];
    let ahead = ahead - TAU * (ahead / TAU).round();
    let ([r, z], angle) = ([0, 1].map(|k| p[k] + (q[k] - p[k]) * share), p[2] + ahead * share);
    Point3::new(r * libm::cos(angle), r * libm::sin(angle), z)
}
