//! Distance of cutter, shank and holder to the rotating obstacles (table and fixtures) over continuous time: in cuts,
//! links and rapids.

use super::clearance::{Clearance, ToolPart};
use super::place::describe;
use super::proof::piece;
use super::{holder_distance, least_over, shank_distance};
use base::progress::Progress;
use base::units::length;
use diagnostics::{Diag, Sink, codes::verification};
use ir::{Motion, MoveKind, Program};
use nalgebra::Point3;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::f64::consts::FRAC_1_SQRT_2;
use tool_stock::collide::{Cloud, ToolSolid, revolved};

/// Distance up to which tools are searched, mm.
pub const SEARCH_DISTANCE: f64 = 20.0;

/// Spacing of the samples of a solid, mm; wider for large solids, by [`MAX_SOLID_SAMPLES`].
const SOLID_SPACING: f64 = 0.5;

/// Most samples of a solid.
const MAX_SOLID_SAMPLES: f64 = 1e6;

/// The part of any tool nearest to a solid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ObstacleReport {
    /// `table` or `fixture`.
    pub solid: Cow<'static, str>,
    /// `cutter`, `shank` or `holder`; empty when no part is within [`SEARCH_DISTANCE`].
    pub part: Cow<'static, str>,
    /// Least distance; a lower bound, at most half a spacing of the samples less than the true distance.
    pub clearance: Option<Clearance>,
}

/// The nearest approach of all tools to each solid of the machine file.
pub fn check(program: &Program, motion: &Motion, progress: &Progress) -> Vec<ObstacleReport> {
    type Distance = fn(&ToolSolid, f64, f64) -> f64;
    let parts: [(&'static str, Distance); 3] =
        [("cutter", ToolSolid::cutter_distance), ("shank", shank_distance), ("holder", holder_distance)];
    let solids = program.machine.carried.iter().map(|solid| {
        let (points, spacing) =
            revolved(&solid.profile, program.machine.table_axis(), SOLID_SPACING, MAX_SOLID_SAMPLES);
        let half_spacing = spacing * FRAC_1_SQRT_2;
        let cloud = Cloud::new(points);
        let mut nearest = ObstacleReport { solid: solid.kind.name().into(), part: "".into(), clearance: None };
        for (o, operation) in motion.operations.iter().enumerate().take_while(|_| !progress.is_cancelled()) {
            let declared = &program.operations[operation.operation];
            let tool = &program.tools[declared.tool].solid;
            let pieces = piece::pieces(&program.machine, motion, o);
            let work = progress
                .begin(format!("{}, distance to the {}", declared.name, solid.kind.name()), parts.len() * pieces.len());
            for (part, distance) in parts {
                let tool_part = ToolPart::new(tool, distance);
                let found = least_over(&pieces, &tool_part, &cloud, half_spacing, SEARCH_DISTANCE, &work);
                let Some(found) = found else { continue };
                if nearest.clearance.as_ref().is_none_or(|c| found.distance < c.distance) {
                    (nearest.part, nearest.clearance) = (part.into(), Some(found));
                }
            }
        }
        nearest
    });
    solids.collect()
}

/// Reports collisions as errors, one per solid.
pub fn report(program: &Program, motion: &Motion, found: &[ObstacleReport], sink: &mut Sink) {
    for f in found {
        let Some(c) = f.clearance.as_ref().filter(|c| c.distance.get() <= 0.0) else { continue };
        let Some(operation) = motion.operations.get(c.at.operation as usize) else { continue };
        let kind = match operation.moves.get(c.at.index as usize).map(|m| m.kind) {
            Some(MoveKind::Rapid) => "at rapid",
            Some(MoveKind::Link) => "in a link",
            _ => "while cutting",
        };
        let (part, solid, depth) = (&f.part, &f.solid, length(-c.distance.get()));
        let span = program.operations[operation.operation].span;
        sink.push(
            Diag::error(verification::CARRIED, format!("{kind} the {part} goes {depth} into the {solid}"))
                .label(span, "in this operation")
                .place(describe(program, motion, Some(c.at)), Point3::from(c.point))
                .block(c.at.operation, c.at.index)
                .note("the depth includes the spacing of the samples, at most 0.5 mm on small solids")
                .help("use a longer reach, smaller tilt angles, or mount the part higher above the table"),
        );
    }
}
