//! `sample-to-tolerance`: removes stations that the interpolation of the machine makes superfluous.
//!
//! Before: dense stations. After: a greedy choice of few stations. Between two of them the interpolated tool (tip
//! straight, rotary axes linear) stays within the chord tolerance of every removed station, measured on the engaged
//! part of the cutter.

use super::context::PassContext;
use five_axis::{Angles, Chain, between};
use ir::{ClPlan, ClPoint, Operation, OperationKind, Program};
use rayon::prelude::*;

/// Largest number of stations that one block may replace; limits the work of the greedy search.
const LONGEST_RUN: usize = 200;

/// A station with its rotary angles.
#[derive(Clone, Copy)]
struct AngledPoint {
    point: ClPoint,
    rotary: Angles,
}

/// Thins all passes.
pub(crate) fn run(cx: &PassContext<'_>, cl: &mut ClPlan) {
    let program = cx.program;
    for planned in cl.operations.iter_mut().take_while(|_| !cx.progress.is_cancelled()) {
        let operation = &program.operations[planned.operation];
        let heights = heights_of_stations(program, operation);
        let work = cx.progress.begin(format!("{}, thinning", operation.name), planned.passes.len());
        planned.passes.par_iter_mut().for_each(|pass| {
            if let Some(thinned) = work.do_step(|| thin(&program.machine.chain, &pass.points, &heights)) {
                pass.points = thinned;
            }
        });
    }
}

/// Share of the tolerance that the stations of a pass may take which becomes a spline; the spline takes the rest. Stations are
/// five times as dense as for straight moves, so that a spline cannot deviate between them.
pub(super) const FIT_SHARE: f64 = 0.04;

/// Height over the tip at which tool positions are compared, with the tolerance there, mm.
#[derive(Clone, Copy)]
pub(super) struct ComparedHeight {
    pub(super) height: f64,
    pub(super) tolerance: f64,
}

/// Heights at which tool positions are compared while stations are removed.
fn heights_of_stations(program: &Program, operation: &Operation) -> [ComparedHeight; 2] {
    let becomes_splines = operation.kind.finishes() && program.control().spline_form().is_some();
    let share = if becomes_splines { FIT_SHARE } else { 1.0 };
    compared_heights(program, operation).map(|at| ComparedHeight { tolerance: share * at.tolerance, ..at })
}

/// Heights at which tool positions of an operation are compared.
pub(super) fn compared_heights(program: &Program, operation: &Operation) -> [ComparedHeight; 2] {
    let solid = &program.tools[operation.tool].solid;
    let (fine, coarse) = (program.tolerances.chord.get(), program.tolerances.chord_rough.get());
    let heights = match operation.kind {
        OperationKind::Flank { .. } => [(solid.cutter.tip_radius(), fine), (solid.flute_length, fine)],
        // Barrel and bull nose touch beside the axis, so that a turn of the axis moves the contact.
        OperationKind::Channel { .. } | OperationKind::Point { .. } if !solid.cutter.ends_in_ball() => {
            [(0.0, fine), (solid.flute_length, fine)]
        }
        OperationKind::Channel { .. } | OperationKind::Point { .. } => {
            [(solid.cutter.tip_radius(), fine), (solid.flute_length, 20.0 * fine)]
        }
        OperationKind::Roughing { .. } => [(0.0, coarse), (solid.flute_length, coarse)],
    };
    heights.map(|(height, tolerance)| ComparedHeight { height, tolerance })
}

fn thin(chain: &Chain, points: &[ClPoint], heights: &[ComparedHeight]) -> Vec<ClPoint> {
    kept(chain, points, heights).into_iter().map(|i| points[i]).collect()
}

/// Indices of the stations that stay.
pub(super) fn kept(chain: &Chain, points: &[ClPoint], heights: &[ComparedHeight]) -> Vec<usize> {
    let mut stations: Vec<AngledPoint> = Vec::with_capacity(points.len());
    for point in points {
        let before = stations.last().map_or(0.0, |s| s.rotary[1]);
        stations.push(AngledPoint { point: *point, rotary: chain.unwound(&point.axis, 0, before) });
    }
    let mut kept: Vec<usize> = (0..points.len().min(1)).collect();
    let mut from = 0;
    while from + 1 < stations.len() {
        let mut to = from + 1;
        while to + 1 < stations.len() && to - from < LONGEST_RUN && replaces(chain, &stations[from..=to + 1], heights) {
            to += 1;
        }
        kept.push(to);
        from = to;
    }
    kept
}

/// True when the interpolation between both ends passes all stations between them within tolerance.
fn replaces(chain: &Chain, run: &[AngledPoint], heights: &[ComparedHeight]) -> bool {
    let [from, middle @ .., to] = run else { return true };
    let chord = to.point.tip - from.point.tip;
    let length = chord.norm_squared();
    if length <= 0.0 {
        return false;
    }
    middle.iter().all(|s| {
        let t = (s.point.tip - from.point.tip).dot(&chord) / length;
        if !(0.0..=1.0).contains(&t) {
            return false;
        }
        let tip = from.point.tip + chord * t;
        let axis = chain.tool_axis(between(from.rotary, to.rotary, t));
        heights.iter().all(|at| {
            let gap = (tip - s.point.tip) + (axis - s.point.axis) * at.height;
            gap.norm_squared() <= at.tolerance * at.tolerance
        })
    })
}
