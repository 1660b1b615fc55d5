//! Distance of cutter, shank and holder to the clamping over continuous time, in cuts, links and rapids. The clamping
//! is the space of chuck and table that the job states: a cylinder about Z without a lower end.
//!
//! The distance of two convex bodies is the largest gap between them along any direction. Each direction gives a lower
//! bound, so that a positive gap proves clearance, independent of the quality of the search.

use super::clearance::{PIECE_RESOLUTION, PIECES_PER_GROUP};
use super::place::describe;
use super::proof::piece::{At, Piece};
use super::proof::sweep::Sweep;
use base::units::{Mm, length};
use diagnostics::{Diag, Sink, codes::verification};
use five_axis::Pose;
use ir::{Motion, MoveKind, Program};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::f64::consts::FRAC_PI_2;
use tool_stock::collide::Body;
use wheel::part::Clamping;

/// The part of any tool nearest to the clamping.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClampingReport {
    /// Height of the clamping, mm.
    pub below: Mm,
    /// Its diameter, mm; `None` for everything below the height.
    pub diameter: Option<Mm>,
    /// True when the job does not state the clamping.
    pub by_default: bool,
    /// `cutter`, `shank` or `holder`; empty without moves.
    pub part: Cow<'static, str>,
    /// Lower bound of the least distance, mm; negative when a tool is inside. `None` without moves.
    pub distance: Option<Mm>,
    /// Tool tip there, part frame, mm.
    pub tip: [f64; 3],
    /// Move.
    pub at: Option<At>,
}

/// Gap along a direction between a body of a tool and the clamping: a lower bound of their distance.
fn gap(clamping: &Clamping, body: &Body, Pose { tip, axis }: &Pose, n: &Vector3<f64>) -> f64 {
    let along = n.dot(axis);
    let across = (1.0 - along * along).max(0.0).sqrt();
    let side = clamping.radius.map_or(0.0, |r| r.get() * libm::hypot(n.x, n.y));
    n.dot(&tip.coords) + body.least(along, across) - clamping.below.get() * n.z - side
}

/// The largest gap of the search; the search ends above `enough`.
fn distance(clamping: &Clamping, body: &Body, pose: &Pose, enough: f64) -> f64 {
    let upward = gap(clamping, body, pose, &Vector3::z());
    if upward > enough || clamping.radius.is_none() {
        return upward;
    }
    let along = |[elevation, azimuth]: [f64; 2]| {
        let (up, out) = libm::sincos(elevation);
        let (y, x) = libm::sincos(azimuth);
        gap(clamping, body, pose, &Vector3::new(out * x, out * y, up))
    };
    // The gap is concave in the direction: a pattern search from the side finds the maximum.
    let middle = pose.tip + pose.axis * (0.5 * body.reach());
    let (mut best, mut step) = ([0.0, libm::atan2(middle.y, middle.x)], 0.5);
    let mut most = along(best);
    while step > 1e-4 && most <= enough {
        let around = [[step, 0.0], [-step, 0.0], [0.0, step], [0.0, -step]];
        let next = around.map(|d| [(best[0] + d[0]).clamp(0.0, FRAC_PI_2), best[1] + d[1]]);
        match next.into_iter().map(|n| (along(n), n)).find(|(value, _)| *value > most) {
            Some((value, n)) => (most, best) = (value, n),
            None => step *= 0.5,
        }
    }
    most.max(upward)
}

/// The body of a tool nearest to the clamping.
#[derive(Clone, Copy)]
struct NearestBody {
    distance: f64,
    part: &'static str,
    tip: Point3<f64>,
    at: At,
}

/// The nearest approach of all tools. The clamping is the same in each sector.
pub fn check(program: &Program, sweeps: &[Sweep<'_>]) -> ClampingReport {
    let clamping = &program.stock.clamping;
    let mut nearest: Option<NearestBody> = None;
    for sweep in sweeps {
        let bodies = sweep.solid().bodies();
        let pieces = sweep.first_pieces();
        let start = nearest.map_or(f64::INFINITY, |n| n.distance);
        let found: Vec<_> =
            pieces.par_chunks(PIECES_PER_GROUP).filter_map(|run| least(clamping, &bodies, run, start)).collect();
        // Of equal distances the first.
        nearest = nearest.into_iter().chain(found).reduce(|a, b| if b.distance < a.distance { b } else { a });
    }
    let turned = Sweep::largest_partner_error(sweeps);
    let (part, tip) = nearest.map_or(("", [0.0; 3]), |n| (n.part, n.tip.coords.into()));
    ClampingReport {
        below: Mm(clamping.below.get()),
        diameter: clamping.radius.map(|r| Mm(2.0 * r.get())),
        by_default: clamping.by_default,
        part: part.into(),
        distance: nearest.map(|n| Mm(n.distance - PIECE_RESOLUTION - turned)),
        tip,
        at: nearest.map(|n| n.at),
    }
}

/// Least distance below `start` over a run of pieces, exact to [`PIECE_RESOLUTION`].
fn least(clamping: &Clamping, bodies: &[(&'static str, Body)], run: &[Piece], start: f64) -> Option<NearestBody> {
    let mut best = None;
    let mut bound = start;
    let mut stack: Vec<Piece> = Vec::new();
    for (name, body) in bodies {
        let arm = body.reach();
        for piece in run {
            stack.push(*piece);
            while let Some(piece) = stack.pop() {
                let moved = piece.displacement(arm);
                let found = distance(clamping, body, piece.middle(), bound + moved);
                if found - moved >= bound {
                    continue;
                }
                if found < bound {
                    bound = found;
                    best = Some(NearestBody { distance: found, part: name, tip: piece.middle().tip, at: piece.at });
                }
                if moved > PIECE_RESOLUTION {
                    stack.extend(piece.halves());
                }
            }
        }
    }
    best
}

impl ClampingReport {
    /// The space in words.
    pub fn space(&self) -> String {
        let width = self.diameter.map_or_else(|| "everything".to_owned(), |d| format!("{:.3} mm about Z", d.get()));
        let default = if self.by_default { ", by default" } else { "" };
        format!("{width} below z {:.3} mm{default}", self.below.get())
    }
}

/// Reports a tool inside of the clamping as an error.
pub fn report(program: &Program, motion: &Motion, found: &ClampingReport, sink: &mut Sink) {
    let (Some(at), Some(distance)) = (found.at, found.distance.map(Mm::get).filter(|d| *d < 0.0)) else { return };
    let Some(operation) = motion.operations.get(at.operation as usize) else { return };
    let kind = match operation.moves.get(at.index as usize).map(|m| m.kind) {
        Some(MoveKind::Rapid) => "at rapid",
        Some(MoveKind::Link) => "in a link",
        _ => "while cutting",
    };
    let declared = &program.operations[operation.operation];
    let tool = &program.tools[declared.tool].name;
    let text = format!("{kind} the {} of {tool} goes {} into the clamping", found.part, length(-distance));
    let mut diag = Diag::error(verification::CLAMPING, text)
        .label(declared.span, "in this operation")
        .place(describe(program, motion, Some(at)), Point3::from(found.tip))
        .block(at.operation, at.index)
        .note(format!("the clamping is {}", found.space()));
    if found.by_default {
        diag = diag.note("the job has no `clamping`, so no tool may go below the back face of the stock");
    }
    sink.push(diag.help(
        "use a shorter lead, a longer reach, smaller tilt angles, or state the true height and diameter of the chuck in the stock: \
         `clamping { below -42 mm  diameter 60 mm }`",
    ));
}
