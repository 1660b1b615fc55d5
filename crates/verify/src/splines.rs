//! How far the chords of spline blocks, with which all other checks count, are from what the control interpolates.
//!
//! On the share of a curve that belongs to a chord, curve and chord are polynomials or are enclosed by polynomials. Two Bezier
//! curves of one degree are nowhere farther apart than their control points (convex hull). For a direction by a second point,
//! the vector D between both points is compared with the axis a of the chord times a length l that changes evenly: the angle
//! between D and a is at most 2 |D - l a| / |D|. Along a chord, a leaves the straight line between its ends by at most an eighth
//! of its second derivative, which [`five_axis::chain::Turning`] bounds.

use super::clearance::Clearance;
use super::surface::{FAR, Limits, SurfaceReport};
use base::units::Mm;
use diagnostics::{Diag, Sink, codes::verification};
use five_axis::{Chain, Machine, PoseCurve, RotaryPose, TurnCurve};
use ir::{Motion, MotionOperation, Program, SplineBlock};
use nalgebra::{Vector2, Vector3};
use nurbs::bezier;
use serde::{Deserialize, Serialize};

/// Distance beyond which the chords are not those of their curve, mm.
const MAX_CHORD_DEVIATION: f64 = 1e-3;

/// Spline blocks of an operation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SplineReport {
    /// Blocks.
    pub blocks: usize,
    /// Moves that are their chords.
    pub chords: usize,
    /// Largest distance of the tool up to the upper end of its flutes from its chord, mm. The bounds of gouge and excess
    /// include it.
    pub flutes: Mm,
    /// The same up to the gauge line, mm. The clearances include it.
    pub tool: Mm,
}

impl SplineReport {
    /// Measures the blocks of an operation; `None` where it has none, or where chords do not belong to their curve.
    fn of(program: &Program, operation: &MotionOperation) -> Result<Option<Self>, String> {
        let machine = &program.machine;
        let tool = &program.tools[program.operations[operation.operation].tool];
        let mut report = Self { blocks: operation.splines.len(), chords: 0, flutes: Mm(0.0), tool: Mm(0.0) };
        let mut free = 1;
        for (k, spline) in operation.splines.iter().enumerate() {
            let count = (spline.last + 1).saturating_sub(spline.first);
            let sound = spline.first >= free
                && spline.last < operation.moves.len()
                && count > 0
                && count == spline.shares.len()
                && spline.shares.last() == Some(&1.0);
            if !sound {
                return Err(format!("spline block {k} has the moves {} to {}", spline.first, spline.last));
            }
            free = spline.last + 1;
            report.chords += count;
            let [tip, axis] = deviation(machine, operation, spline);
            let flutes = tip + axis * tool.solid.flute_length;
            if !flutes.is_finite() || flutes > MAX_CHORD_DEVIATION {
                return Err(format!("spline block {k} leaves its chords by {flutes} mm"));
            }
            report.flutes = Mm(report.flutes.get().max(flutes));
            report.tool = Mm(report.tool.get().max(tip + axis * tool.length()));
        }
        Ok((report.blocks > 0).then_some(report))
    }
}

/// The spline blocks of each operation; faults go to the sink.
pub fn reports(program: &Program, motion: &Motion, sink: &mut Sink) -> Option<Vec<Option<SplineReport>>> {
    let mut reports = Vec::with_capacity(motion.operations.len());
    for operation in &motion.operations {
        match SplineReport::of(program, operation) {
            Ok(report) => reports.push(report),
            Err(reason) => {
                let name = &program.operations[operation.operation].name;
                sink.push(
                    Diag::error(verification::MALFORMED_MOTION, format!("`{name}`: {reason}"))
                        .note("this is a fault of the compiler, not of the job")
                        .help("report the job file"),
                );
                return None;
            }
        }
    }
    Some(reports)
}

/// Bounds of the distance of the tip (mm) and of the angle of the axis (radians) between a block and its chords.
fn deviation(machine: &Machine, operation: &MotionOperation, spline: &SplineBlock) -> [f64; 2] {
    let pose = |index: usize| {
        let joints = &operation.moves[index].joints;
        RotaryPose { tip: machine.forward(joints).tip, rotary: joints.rotary }
    };
    let mut most = [0.0_f64; 2];
    let mut from = 0.0;
    for (index, to) in spline.chords().zip(&spline.shares) {
        let part = spline.curve.part([from, *to]);
        let found = chord_deviation(&machine.chain, &part, [pose(index - 1), pose(index)]);
        most = [0, 1].map(|k| if found[k] > most[k] || found[k].is_nan() { found[k] } else { most[k] });
        from = *to;
    }
    most
}

/// The same for a part of a curve and one chord.
fn chord_deviation(chain: &Chain, part: &PoseCurve, [from, to]: [RotaryPose; 2]) -> [f64; 2] {
    let straight = |a: Vector3<f64>, b: Vector3<f64>, k: usize, n: usize| a.lerp(&b, k as f64 / n as f64);
    let degree = part.degree();
    let (a, b) = (from.tip.coords, to.tip.coords);
    let tips = part.tip().iter().enumerate().map(|(k, p)| (p - straight(a, b, k, degree)).norm());
    let axis = match part.turn() {
        TurnCurve::Rotary(angles) => {
            let [a, b] = [from.rotary, to.rotary].map(Vector2::from);
            let turns = angles.iter().enumerate().map(|(k, q)| (q - a.lerp(&b, k as f64 / degree as f64)).lp_norm(1));
            turns.fold(0.0, f64::max)
        }
        TurnCurve::Second(_) => {
            let levers = part.levers().unwrap_or_default();
            let (Some(first), Some(last)) = (levers.first(), levers.last()) else { return [f64::NAN; 2] };
            let lengths = [first.norm(), last.norm()];
            let axes = [from.rotary, to.rotary].map(|angles| chain.tool_axis(angles));
            // An even length times the straight line between both axes.
            let product =
                [axes[0] * lengths[0], (axes[1] * lengths[0] + axes[0] * lengths[1]) * 0.5, axes[1] * lengths[1]];
            let degree = degree.max(2);
            let (levers, product) = (bezier::elevated(&levers, degree), bezier::elevated(&product, degree));
            let gap = levers.iter().zip(&product).map(|(d, p)| (d - p).norm()).fold(0.0, f64::max);
            let turn = chain.turn(from.rotary, to.rotary);
            let bow = lengths[0].max(lengths[1]) * chain.turning().second * turn * turn / 8.0;
            2.0 * (gap + bow) / part.least_length()
        }
    };
    [tips.fold(0.0, f64::max), axis]
}

/// Largest distance up to the flutes over all operations, mm.
pub fn widest(reports: &[Option<SplineReport>]) -> f64 {
    reports.iter().flatten().map(|r| r.flutes.get()).fold(0.0, f64::max)
}

impl Limits {
    /// Bounds that are less by a distance, mm.
    #[must_use]
    pub fn narrowed(mut self, by: f64) -> Self {
        for limit in self.gouge.iter_mut().chain(&mut self.excess) {
            limit.bound = Mm(limit.bound.get() - by);
        }
        self
    }

    /// These bounds and others.
    #[must_use]
    pub(crate) fn and(mut self, others: &Self) -> Self {
        self.gouge.extend_from_slice(&others.gouge);
        self.excess.extend_from_slice(&others.excess);
        self
    }
}

/// Adds a distance to the proved bounds of surfaces, mm.
pub fn widen(surfaces: &mut [SurfaceReport], by: f64) {
    for surface in surfaces {
        surface.gouge_bound += Mm(by);
        if surface.excess_bound.get() < FAR {
            surface.excess_bound += Mm(by);
        }
    }
}

/// Takes a distance from a clearance, mm.
pub fn nearer(clearance: &mut Option<Clearance>, by: f64) {
    if let Some(clearance) = clearance {
        clearance.distance = Mm(clearance.distance.get() - by);
    }
}
