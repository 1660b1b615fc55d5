//! Distance of shank and holder to the design part, and of the whole tool to the stock at rapid, over continuous time.

use super::proof::piece::{At, Piece};
use crate::collide::{Cloud, ToolSolid};
use serde::Serialize;

/// Turn and shift below which a piece is not halved any further, as displacement of the farthest tool point, mm. The
/// reported distance is exact to this.
const RESOLUTION: f64 = 1e-3;

/// The same once a tool is that deep inside, mm: nobody asks by how many micrometres a shank collides.
const INSIDE: f64 = 0.1;

/// Least distance found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Clearance {
    /// Nothing of the surface is nearer, mm: what was found less what the spacing of the samples may hide.
    pub distance: f64,
    /// Distance of the nearest sample, mm: the least that was found.
    pub found: f64,
    /// Sample of the surface, part frame, mm.
    pub point: [f64; 3],
    /// Tool tip there.
    pub tip: [f64; 3],
    /// Move.
    pub at: At,
    /// Tag of the surface.
    #[serde(skip)]
    pub tag: u32,
}

/// Least distance below `cutoff` between samples and a part of a tool over pieces of motion. `distance` is the signed
/// distance to that part of the tool; `half_spacing` the distance within which every surface point has a sample.
pub fn least(
    pieces: &[Piece],
    solid: &ToolSolid,
    distance: impl Fn(&ToolSolid, f64, f64) -> f64 + Copy,
    cloud: &Cloud,
    half_spacing: f64,
    cutoff: f64,
) -> Option<Clearance> {
    let arm = solid.length() + solid.holder.iter().map(|s| s.radius_to).fold(0.0, f64::max);
    let mut best: Option<Clearance> = None;
    let mut bound = cutoff;
    // Of pieces that were not halved down to the resolution.
    let mut unseen = f64::INFINITY;
    let mut stack: Vec<Piece> = Vec::new();
    for piece in pieces {
        stack.push(*piece);
        while let Some(piece) = stack.pop() {
            let (tip, axis) = piece.middle();
            let moved = piece.displacement(arm);
            // What is deeper by less than that is not looked for.
            let enough = if bound < -INSIDE { INSIDE } else { 0.0 };
            let cutoff = bound - enough + moved;
            let Some((found, index)) = cloud.nearest(tip, axis, |rho, s| distance(solid, rho, s), cutoff) else {
                unseen = unseen.min(bound - enough);
                continue;
            };
            if found < bound {
                bound = found;
                let p = &cloud.points()[index];
                best = Some(Clearance {
                    distance: found,
                    found,
                    point: [p.position.x, p.position.y, p.position.z],
                    tip: [tip.x, tip.y, tip.z],
                    at: piece.at,
                    tag: p.tag,
                });
            }
            if moved > RESOLUTION.max(enough) {
                stack.extend(piece.halves());
            } else if moved > RESOLUTION {
                unseen = unseen.min(found - moved);
            }
        }
    }
    best.map(|mut c| {
        c.distance = c.distance.min(unseen);
        // A point of the surface lies beside the found sample, not in front of it.
        c.distance = if c.distance > half_spacing {
            (c.distance * c.distance - half_spacing * half_spacing).sqrt()
        } else {
            c.distance - half_spacing
        };
        c
    })
}
