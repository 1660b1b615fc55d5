//! Runs: successive steps combined to one motion, in the frame of a family of rays.

use super::field::frame;
use super::lanes::LANES;
use super::moving::{Moving, square_to};
use super::reach::StepLanes;
use super::shape::SolidShape;
use super::sweep::StepSweep;
use super::tile::RayRun;
use super::{Field, Step, StepKind, Touched};
use nalgebra::Vector3;
use rayon::prelude::*;
use std::ops::Range;

/// Least length of a step in the share of a run, mm.
const LEAST_LENGTH: f64 = 1e-9;

/// Share of a step within which a time is at its end.
const AT_END: f64 = 1e-9;

/// Most steps of a run: one for each lane of a query about them.
pub(super) const MAX_RUN_STEPS: usize = LANES;

/// Longest tip motion of a run, mm; and largest deviation of its steps from the run, as a share of this motion. The aim
/// is to exclude as much of a path as possible at once.
const RUN_WAY: f64 = 3.0;
const RUN_DRIFT: f64 = 0.3;

/// Successive steps of one kind without a jump, prepared for queries.
pub(super) struct Prepared {
    /// For each step the index of its block in the batch.
    pub(super) ordinals: Vec<u32>,
    pub(super) sweeps: Vec<StepSweep>,
    /// Parts of the tool that must not touch, over the whole run.
    pub(super) forbidden: Vec<(Touched, Moving)>,
    /// The cutter over the whole run, and step by step, for steps that cut.
    pub(super) whole: Option<Moving>,
    pub(super) steps: Vec<Moving>,
    /// These steps as columns.
    pub(super) lanes: Option<StepLanes>,
}

impl Prepared {
    /// What the cutter does in some of the steps; `None` where it removes nothing.
    pub(super) fn removing(&self, steps: Range<usize>) -> Option<RayRun<'_>> {
        let whole = match &self.steps[steps.clone()] {
            [] => return None,
            [one] => one,
            _ => self.whole.as_ref()?,
        };
        Some(RayRun { whole, steps: &self.steps, range: steps, lanes: self.lanes.as_ref()? })
    }
}

/// Frame of a family of rays, in which its rays run along Z.
pub(super) struct Frame {
    /// Axes of the field in the order of the frame.
    pub(super) order: [usize; 3],
    /// Corners of the field.
    pub(super) low: [f64; 3],
    high: [f64; 3],
}

impl Frame {
    pub(super) fn of(field: &Field, axis: usize) -> Self {
        let order = frame(axis);
        let low = order.map(|k| field.low[k]);
        let high = order.map(|k| field.low[k] + field.cell * field.count[k] as f64);
        Self { order, low, high }
    }

    fn turned(&self, v: &Vector3<f64>) -> Vector3<f64> {
        Vector3::from(self.order.map(|k| v[k]))
    }
}

/// Steps of a batch in the frame of a family of rays, for a cutter and the parts that must not touch.
pub(super) fn prepare(
    steps: &[Step],
    ordinals: &[u32],
    runs: &[Range<usize>],
    cutter: &SolidShape,
    body: &[(Touched, SolidShape)],
    frame: &Frame,
) -> Vec<Prepared> {
    let of_run = |range: &Range<usize>| {
        let own = &steps[range.clone()];
        let swept = Swept::new(own, frame);
        let rapid = own[0].kind == StepKind::Rapid;
        let forbidden = body
            .iter()
            .copied()
            .chain(rapid.then_some((Touched::Cutter, *cutter)))
            .filter_map(|(what, shape)| swept.whole(&shape, frame).map(|m| (what, m)))
            .collect();
        let whole = if rapid { None } else { swept.whole(cutter, frame) };
        let each = if whole.is_some() { swept.sweeps.as_slice() } else { &[] };
        let steps: Vec<Moving> =
            each.iter().zip(own).map(|(sweep, step)| of_step(sweep, step, cutter, frame)).collect();
        Prepared {
            ordinals: ordinals[range.clone()].to_vec(),
            forbidden,
            whole,
            lanes: StepLanes::new(&steps),
            steps,
            sweeps: swept.sweeps,
        }
    };
    match runs {
        // The threads would cost more than the run.
        [one] => vec![of_run(one)],
        _ => runs.par_iter().map(of_run).collect(),
    }
}

/// The motion of the steps of a run in the frame of a family of rays.
pub(super) struct Swept {
    pub(super) sweeps: Vec<StepSweep>,
}

impl Swept {
    pub(super) fn new(steps: &[Step], frame: &Frame) -> Self {
        Self { sweeps: steps.iter().map(|s| sweep(s, |v| frame.turned(v))).collect() }
    }

    /// A part of the tool over the whole run; `None` where it stays outside of the rays.
    pub(super) fn whole(&self, shape: &SolidShape, frame: &Frame) -> Option<Moving> {
        let (whole, drift) = match &self.sweeps[..] {
            [one] => (*one, 0.0),
            several => joined(several, shape.reach()),
        };
        let moving = Moving::new(whole, *shape, drift);
        let outside = (0..3).any(|k| moving.high[k] < frame.low[k] || moving.low[k] > frame.high[k]);
        (!outside).then_some(moving)
    }
}

/// The cutter over a step. Angles about its axis count from a direction that is the same in all frames.
fn of_step(sweep: &StepSweep, step: &Step, cutter: &SolidShape, frame: &Frame) -> Moving {
    let mut moving = Moving::new(*sweep, *cutter, 0.0);
    moving.around = moving.around.map(|_| frame.turned(&square_to(&step.axes[2])));
    moving
}

/// The motion through both ends and the middle of a run, and the speed at which the steps deviate from it. The time of
/// the run is divided in proportion to the lengths of the steps.
fn joined(sweeps: &[StepSweep], reach: f64) -> (StepSweep, f64) {
    let lengths: Vec<f64> = sweeps.iter().map(|s| s.way().norm() + reach * s.turn() + LEAST_LENGTH).collect();
    let total: f64 = lengths.iter().sum();
    let mut before = 0.0;
    // Start of each step in the time of the run, and its share of this time.
    let times: Vec<[f64; 2]> = lengths
        .iter()
        .map(|l| {
            let start = before / total;
            before += l;
            [start, l / total]
        })
        .collect();
    let (first, last) = (&sweeps[0], &sweeps[sweeps.len() - 1]);
    let middle = times.iter().rposition(|[start, _]| *start <= 0.5).unwrap_or(0);
    let at = ((0.5 - times[middle][0]) / times[middle][1]).clamp(0.0, 1.0);
    let (start, end) = (first.pose(0.0), last.pose(1.0));
    let whole = StepSweep::through([start.0, end.0], [start.1, sweeps[middle].pose(at).1, end.1]);
    let mut drift: f64 = 0.0;
    for (n, (sweep, [begin, share])) in sweeps.iter().zip(&times).enumerate() {
        let off = |t: f64| {
            let (own, all) = (sweep.pose(t), whole.pose(begin + share * t));
            ((own.0 - all.0).norm(), (own.1 - all.1).norm() * reach)
        };
        let offs = [0.0, 0.5, 1.0].map(off);
        for (t, (tip, axis)) in [0.0, 0.5, 1.0].into_iter().zip(offs) {
            let now = begin + share * t;
            let near = now.min(1.0 - now);
            if near > AT_END {
                // A parabola through three values exceeds them by at most a quarter.
                drift = drift.max((tip + 1.25 * axis) / near);
            }
        }
        // At the ends of the run the parabola of the axis starts from zero with this speed.
        if n == 0 {
            drift = drift.max((4.0 * offs[1].1 + offs[2].1 + offs[2].0) / share);
        }
        if n + 1 == sweeps.len() {
            drift = drift.max((4.0 * offs[1].1 + offs[0].1 + offs[0].0) / share);
        }
    }
    (whole, drift)
}

/// Divides a batch into runs of successive steps of one kind whose motion is nearly that of one step.
pub(super) fn split(steps: &[Step], reach: f64) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    let mut start = 0;
    while start < steps.len() {
        let mut end = start + 1;
        let way = |s: &Step| (s.tips[1] - s.tips[0]).norm();
        let mut length = way(&steps[start]);
        while end < steps.len() && end - start < MAX_RUN_STEPS && follows(&steps[end - 1], &steps[end]) {
            length += way(&steps[end]);
            if length > RUN_WAY || steps[end].kind != steps[start].kind {
                break;
            }
            end += 1;
        }
        // Halve the run while its steps deviate too much.
        while end - start > 1 {
            let sweeps: Vec<StepSweep> = steps[start..end].iter().map(|s| sweep(s, |v| *v)).collect();
            let (whole, drift) = joined(&sweeps, reach);
            if drift <= RUN_DRIFT * whole.way().norm() {
                break;
            }
            end = start + (end - start) / 2;
        }
        found.push(start..end);
        start = end;
    }
    found
}

/// The motion of a step in another frame.
fn sweep(step: &Step, turned: impl Fn(&Vector3<f64>) -> Vector3<f64>) -> StepSweep {
    StepSweep::through(step.tips.map(|t| turned(&t.coords)), step.axes.map(|a| turned(&a)))
}

fn follows(before: &Step, step: &Step) -> bool {
    before.tips[1] == step.tips[0] && before.axes[2] == step.axes[0]
}
