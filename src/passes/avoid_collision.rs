//! `avoid-collision`: tool, shank and holder clear of the part.
//!
//! Before: cutter locations with the axes that the geometry suggests. After: the same contacts; axes of channel
//! finishing lean away from the nearer wall just as far as needed. Roughing lines were laid clear by their layers.
//! An axis that no lean clears is an error with the place.

use super::obstacles::{Keep, Obstacles};
use super::orient_tool::hub_points;
use super::pipeline::PassContext;
use crate::diag::{Aborted, Diag, codes::orientation};
use crate::ir::{CcPass, CcPlan, ClPlan, ClPoint, Drive, Operation, Program};
use rayon::prelude::*;

/// Leans that are tried, degrees: one line keeps one, so that its axes stay as smooth as the rulings.
const LEANS: [f64; 14] = [0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0, 16.0, 18.0, 20.0, 24.0, 28.0, 32.0];

/// Distance that the side of the cutter keeps from walls that its ball alone touches, mm.
const SIDE_CLEARANCE: f64 = 0.1;

/// Clear points of a pass with the lean that they took, degrees.
type Cleared = (Vec<ClPoint>, f64);

/// Station at which a pass is not clear, and the distance there.
type Miss = (usize, f64);

/// Repairs axes, or says where it cannot.
///
/// # Errors
/// A pass whose shank or holder comes nearer to the part than the clearance of the job.
pub(super) fn run(cx: &mut PassContext<'_>, cc: &CcPlan, cl: &mut ClPlan) -> Result<(), Aborted> {
    let mut failed = false;
    for (planned, oriented) in cc.operations.iter().zip(&mut cl.operations) {
        let operation = &cx.program.operations[planned.operation];
        let (program, obstacles) = (cx.program, cx.obstacles);
        // The part looks the same from every sector: what clears a pass in the first one clears it in all.
        let sectors = operation.sectors.len().max(1);
        let per_sector = planned.passes.len() / sectors;
        let work = cx.progress.begin(format!("{}, clearance", operation.name), per_sector + planned.passes.len());
        let first: Vec<Result<f64, Miss>> = planned
            .passes
            .par_iter()
            .zip(&oriented.passes)
            .take(per_sector)
            .map(|(cc, cl)| work.step(clearing_lean(program, obstacles, operation, cc, &cl.points)))
            .collect();
        let repaired: Vec<Result<Cleared, Miss>> = planned
            .passes
            .par_iter()
            .zip(&oriented.passes)
            .enumerate()
            .map(|(i, (cc, cl))| {
                let lean = work.step(first[i % per_sector.max(1)])?;
                let points = if cc.drive == Drive::Hub {
                    hub_points(program, operation, cc, lean.to_radians())
                } else {
                    cl.points.clone()
                };
                Ok((points, lean))
            })
            .collect();
        let mut steepest = 0.0_f64;
        for (result, pass) in repaired.into_iter().zip(&mut oriented.passes) {
            match result {
                Ok((points, lean)) => {
                    steepest = steepest.max(lean);
                    pass.points = points;
                }
                Err((index, distance)) => {
                    failed = true;
                    let tool = &cx.program.tools[operation.tool];
                    let at = pass.points.get(index).map_or_else(nalgebra::Point3::origin, |p| p.tip);
                    cx.sink.push(
                        Diag::error(
                            orientation::COLLISION,
                            format!(
                                "`{}`: {} comes within {distance:.2} mm of the part; {:.2} mm are asked for",
                                operation.name,
                                tool.name,
                                cx.program.clearance.get()
                            ),
                        )
                        .label(operation.span, "in this operation")
                        .label(tool.span, "with this tool")
                        .place(pass.label.clone(), at)
                        .help("take a longer reach, a slimmer holder, or a thinner shank"),
                    );
                }
            }
        }
        if steepest > 0.0 {
            oriented.notes.push(format!("axes lean away from the nearer wall by up to {steepest} deg at the wall"));
        }
    }
    if failed { Err(Aborted) } else { Ok(()) }
}

/// The least lean, degrees, that clears a pass, or the worst place and distance.
fn clearing_lean(
    program: &Program,
    obstacles: &Obstacles,
    operation: &Operation,
    cc: &CcPass,
    points: &[ClPoint],
) -> Result<f64, Miss> {
    let solid = &program.tools[operation.tool].solid;
    let keep = Keep { vane: SIDE_CLEARANCE, hub: 0.0, clearance: program.clearance.get() };
    let on_hub = cc.drive == Drive::Hub;
    let worst = |points: &[ClPoint]| {
        points
            .iter()
            .enumerate()
            .filter_map(|(i, p)| obstacles.body_lack(solid, &p.tip, &p.axis, &keep, on_hub).map(|d| (i, d)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(i, lack)| (i, lack + keep.clearance))
    };
    if !on_hub {
        return worst(points).map_or(Ok(0.0), Err);
    }
    let mut last = (0, 0.0);
    for lean in LEANS {
        match worst(&hub_points(program, operation, cc, lean.to_radians())) {
            None => return Ok(lean),
            Some(miss) => last = miss,
        }
    }
    Err(last)
}
