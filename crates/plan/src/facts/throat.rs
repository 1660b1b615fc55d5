//! Width of the channel: true distance between neighbouring vanes.

use ir::DataCurve;
use nalgebra::Point3;
use nurbs::proximity::Patch;
use wheel::part::{BladeId, FaceId, FaceSurface, Part, Passage, RulingEnd, Surface};

/// Share of the height within which a place is at root or tip.
const AT_END: f64 = 1e-6;

/// Width of the channel, all by true distance in space.
#[derive(Clone, Debug)]
pub struct Throat {
    /// The narrowest place of the whole channel.
    pub narrowest: Narrow,
    /// The narrowest place of each level: from the pressure face at this v to any point of the suction face.
    pub levels: Vec<Narrow>,
    /// Twice L_min of Wei's formula 8, mm: width as arcs between the root points.
    pub formula_8: f64,
}

/// A narrow place, given on the pressure face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Narrow {
    /// Place along the pressure face, from inlet (0) to outlet (1).
    pub u: f64,
    /// Place from root (0) to tip (1).
    pub v: f64,
    /// Distance to the suction face across the channel, mm.
    pub distance: f64,
    /// Point of the pressure face of sector 0.
    pub point: Point3<f64>,
}

impl Narrow {
    /// The place in words.
    pub fn place(&self) -> String {
        let height = match self.v {
            v if v < AT_END => "root".to_owned(),
            v if v > 1.0 - AT_END => "tip".to_owned(),
            v => format!("face, v = {v:.3},"),
        };
        format!("{} {height} at u = {:.3}", FaceId::NAMES[0], self.u)
    }
}

/// Levels v at which the narrowest place is measured.
const MEASURED_LEVELS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Measures all passages of a sector.
pub fn all(part: &Part, data: &[DataCurve]) -> Vec<(Passage, Throat)> {
    part.passages().map(|passage| (passage, measure(part, &passage, data))).collect()
}

/// Measures a passage.
pub fn measure(part: &Part, passage: &Passage, data: &[DataCurve]) -> Throat {
    // Every passage has a pressure face on one side.
    let [first, second] = passage.walls;
    let from = if first.index() == 0 { first } else { second };
    let surface = &part.face(from).surface;
    // The wall opposite to the first face of the vane.
    let (opposite, turn) = part.opposite(from);
    let facing = part.face(opposite).surface.rotated(turn);
    let narrow = |patch: Patch| {
        let pair = surface.closest_pair(patch, &facing, Patch::WHOLE);
        Narrow { u: pair.first.u, v: pair.first.v, distance: pair.distance, point: pair.first.point }
    };
    Throat {
        narrowest: narrow(Patch::WHOLE),
        levels: MEASURED_LEVELS.iter().map(|v| narrow(Patch { u: [0.0, 1.0], v: [*v, *v] })).collect(),
        formula_8: formula_8(part, data),
    }
}

/// Wei's formula 8 as a full width: the least value of 2 pi R_k / N - m_k over the points of the roots, with the radius
/// R_k and the thickness m_k of the vane there. The formula itself gives half of this width. Without data points, seven
/// evenly spaced stations are used.
fn formula_8(part: &Part, data: &[DataCurve]) -> f64 {
    let root = |side| data.iter().find(|c| c.side == side && c.end == RulingEnd::Root).map(|c| &c.points);
    let stations = |s: &FaceSurface| (0..7).map(|i| s.point(f64::from(i) / 6.0, 0.0)).collect::<Vec<_>>();
    let (p, s): (Vec<_>, Vec<_>) = match BladeId::MAIN.faces().map(root) {
        [Some(p), Some(s)] if p.len() == s.len() => {
            (p.iter().map(|d| d.point).collect(), s.iter().map(|d| d.point).collect())
        }
        _ => (stations(&part.main().faces[0].surface), stations(&part.main().faces[1].surface)),
    };
    p.iter().zip(&s).map(|(p, s)| libm::hypot(p.x, p.y) * part.pitch() - (p - s).norm()).fold(f64::INFINITY, f64::min)
}
