//! Distance of parts of the tool to sampled surfaces over continuous time: shank and holder to the design part, the
//! whole tool to the stock at rapid.

use super::proof::piece::{At, Piece};
use base::units::Mm;
use five_axis::Pose;
use nalgebra::{Point3, Vector3};
use serde::{Deserialize, Serialize};
use tool_stock::collide::{Cloud, DistanceTable, ToolSolid};

/// Displacement of the farthest tool point over a piece below which the piece is not halved any further, mm. The
/// reported distance is exact to this.
pub(super) const PIECE_RESOLUTION: f64 = 1e-3;

/// Pieces of a group: so many that the bound found early in the group excludes most of the others.
pub(super) const PIECES_PER_GROUP: usize = 4096;

/// Allowed error of the depth of a tool that is inside of a surface by more than this, mm: the exact depth of a
/// collision does not matter.
const COLLISION_DEPTH_ERROR: f64 = 0.1;

/// Distance beyond the cutoff up to which samples are searched, mm: what is found excludes the next poses.
const SEARCH_MARGIN: f64 = 1.0;

/// Reserve for rounding, mm.
const DISTANCE_ROUNDING: f64 = 1e-9;

/// A pose for which no sample is nearer than `least`, mm.
struct KnownPose {
    tip: Point3<f64>,
    axis: Vector3<f64>,
    least: f64,
}

impl KnownPose {
    /// Lower bound of the distance in another pose; no point of the tool is farther than `arm` from its tip.
    fn at(&self, tip: &Point3<f64>, axis: &Vector3<f64>, arm: f64) -> f64 {
        self.least - (tip - self.tip).norm() - arm * (axis - self.axis).norm() - DISTANCE_ROUNDING
    }
}

/// Least distance of a part of a tool.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Clearance {
    /// Lower bound of the distance: the measured distance less what the spacing of the samples may hide.
    pub distance: Mm,
    /// Distance of the nearest sample.
    pub found: Mm,
    /// Nearest sample of the surface, part frame, mm.
    pub point: [f64; 3],
    /// Tool tip at this time, part frame, mm.
    pub tip: [f64; 3],
    /// Move.
    pub at: At,
    /// Tag of the surface.
    #[serde(skip)]
    pub tag: u32,
}

/// A part of a tool among samples.
pub struct ToolPart<'a> {
    solid: &'a ToolSolid,
    /// Signed distance to this part.
    distance: fn(&ToolSolid, f64, f64) -> f64,
    table: DistanceTable<1>,
}

impl<'a> ToolPart<'a> {
    /// The part of a tool to which this is the signed distance, from the distance to its axis and the height over its tip.
    pub fn new(solid: &'a ToolSolid, distance: fn(&ToolSolid, f64, f64) -> f64) -> Self {
        Self { solid, distance, table: DistanceTable::new(solid, |rho, s| [distance(solid, rho, s)]) }
    }

    fn at(&self, rho: f64, s: f64) -> f64 {
        (self.distance)(self.solid, rho, s)
    }

    /// The nearest sample below a cutoff, with its distance.
    fn nearest(&self, cloud: &Cloud, tip: &Point3<f64>, axis: &Vector3<f64>, cutoff: f64) -> Option<(f64, usize)> {
        let side = |rho: f64, s: f64, limit: f64| self.table.side(rho, s, &[0.0], limit, || [self.at(rho, s)]);
        cloud.nearest_by(tip, axis, |rho, s| self.at(rho, s), side, cutoff)
    }
}

/// Least distance below `cutoff` between samples and a part of a tool over pieces of motion. Every surface point has a sample
/// within `half_spacing`.
pub fn least(
    pieces: &[Piece],
    part: &ToolPart<'_>,
    cloud: &Cloud,
    half_spacing: f64,
    cutoff: f64,
) -> Option<Clearance> {
    let arm = part.solid.arm();
    let mut best: Option<Clearance> = None;
    let mut bound = cutoff;
    // Lower bound over pieces that were not halved down to the resolution.
    let mut unseen = f64::INFINITY;
    let mut stack: Vec<Piece> = Vec::new();
    let mut known: Option<KnownPose> = None;
    for piece in pieces {
        stack.push(*piece);
        while let Some(piece) = stack.pop() {
            let Pose { tip, axis } = piece.middle();
            let moved = piece.displacement(arm);
            // Places that are deeper by less than this are not searched.
            let enough = if bound < -COLLISION_DEPTH_ERROR { COLLISION_DEPTH_ERROR } else { 0.0 };
            let cutoff = bound - enough + moved;
            let found = if known.as_ref().is_some_and(|known| known.at(tip, axis, arm) >= cutoff) {
                None
            } else {
                let found = part.nearest(cloud, tip, axis, cutoff + SEARCH_MARGIN);
                let least = found.map_or(cutoff + SEARCH_MARGIN, |f| f.0);
                known = Some(KnownPose { tip: *tip, axis: *axis, least });
                found.filter(|f| f.0 < cutoff)
            };
            let Some((found, index)) = found else {
                unseen = unseen.min(bound - enough);
                continue;
            };
            if found < bound {
                bound = found;
                let p = &cloud.points()[index];
                best = Some(Clearance {
                    distance: Mm(found),
                    found: Mm(found),
                    point: [p.position.x, p.position.y, p.position.z],
                    tip: [tip.x, tip.y, tip.z],
                    at: piece.at,
                    tag: p.tag,
                });
            }
            if moved > PIECE_RESOLUTION.max(enough) {
                stack.extend(piece.halves());
            } else if moved > PIECE_RESOLUTION {
                unseen = unseen.min(found - moved);
            }
        }
    }
    best.map(|mut c| {
        let distance = c.distance.get().min(unseen);
        // The nearest point of the surface may lie up to half a spacing to the side of the nearest sample.
        c.distance = Mm(if distance > half_spacing {
            (distance * distance - half_spacing * half_spacing).sqrt()
        } else {
            distance - half_spacing
        });
        c
    })
}
