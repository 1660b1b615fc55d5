//! `fit-splines`: finishing passes as polynomials, for a control that interpolates them.
//!
//! Before: straight moves whose ends are exact. After: the cuts of a finishing pass are spline blocks with their chords, as
//! few as the chord tolerance allows. Where a pass has a corner, it is divided there; where no spline has fewer blocks than
//! half the straight moves, the moves stay. Every block begins and ends where the words of the post say, so that the blocks of
//! the text meet exactly. Feeds are those of the process.

use super::context::PassContext;
use super::sample_to_tolerance::{ComparedHeight, FIT_SHARE, compared_heights, kept};
use five_axis::pose_curve::{Chord, MAX_CHORD_ERROR_MM};
use five_axis::{Chain, Machine, Pose, PoseCurve, RotaryPose, TurnCurve, most_turn};
use ir::motion::MotionOperation;
use ir::{ClPoint, JointMove, Motion, MoveKind, Operation, OperationKind, Program, SplineBlock};
use nalgebra::{SVector, Vector2, Vector3};
use nurbs::spline_fit;
use rayon::prelude::*;
use std::ops::Range;
use wheel::control::{Decimals, SplineForm, on_step};

/// Largest change of direction between two moves of a smooth path, radians; more is a corner.
const CORNER_TURN: f64 = 4.0 * std::f64::consts::PI / 180.0;

/// Largest distance of two places through which a spline goes, mm, by the length of tip and second point together: a lead is
/// one long move.
const PLACE_SPACING_MM: f64 = 0.125;

/// Fewest moves that a spline replaces.
const MIN_MOVES: usize = 6;

/// Tip and second point of the axis, mm; or tip and both rotary axes times the height of that point.
type Place = SVector<f64, 6>;

/// Fits the splines.
pub(crate) fn run(cx: &PassContext<'_>, motion: &mut Motion) {
    let program = cx.program;
    let Some(form) = program.control().spline_form() else { return };
    for operation in &mut motion.operations {
        let declared = &program.operations[operation.operation];
        if !declared.kind.finishes() {
            continue;
        }
        let height = program.tools[declared.tool].solid.flute_length;
        let fitting = Fitting {
            machine: &program.machine,
            form,
            decimals: program.control().decimals,
            height,
            heights: compared_heights(program, declared)
                .map(|at| ComparedHeight { tolerance: left_to_fit(declared, at.tolerance), ..at }),
        };
        let runs = runs(&program.machine, &operation.moves, height);
        let work = cx.progress.begin(format!("{}, splines", declared.name), runs.len());
        let fitted: Option<Vec<Vec<Fitted>>> =
            runs.par_iter().map(|run| work.do_step(|| fitting.fitted(&operation.moves, run))).collect();
        let Some(fitted) = fitted else { return };
        replace(program, operation, declared.feed.get(), &fitting.heights, fitted.into_iter().flatten());
    }
}

/// Part of a tolerance that a fit may take, mm. Stations take their share. The chords of the proof take theirs, at most half of the
/// tolerance; paths of flank milling already leave that much.
fn left_to_fit(operation: &Operation, tolerance: f64) -> f64 {
    let left = (1.0 - FIT_SHARE) * tolerance;
    if matches!(operation.kind, OperationKind::Flank { .. }) {
        left
    } else {
        (left - 2.0 * MAX_CHORD_ERROR_MM).max(0.5 * tolerance)
    }
}

/// Cuts in a row without a corner between them: the indices of their moves.
fn runs(machine: &Machine, moves: &[JointMove], height: f64) -> Vec<Range<usize>> {
    let places: Vec<Place> = moves.iter().map(|m| by_second_point(&machine.forward(&m.joints), height)).collect();
    let mut runs: Vec<Range<usize>> = Vec::new();
    for (i, m) in moves.iter().enumerate().skip(1) {
        if m.kind != MoveKind::Cut {
            continue;
        }
        let goes_on = runs.last().is_some_and(|run| {
            run.end == i && moves[i - 1].pass == m.pass && {
                let [before, behind] = [places[i - 1] - places[i - 2], places[i] - places[i - 1]];
                before.dot(&behind) >= libm::cos(CORNER_TURN) * before.norm() * behind.norm()
            }
        });
        match runs.last_mut() {
            Some(run) if goes_on => run.end = i + 1,
            _ => runs.push(i..i + 1),
        }
    }
    runs.retain(|run| run.len() >= MIN_MOVES);
    runs
}

/// Tip and second point of a pose.
fn by_second_point(pose: &Pose, height: f64) -> Place {
    let (tip, second) = (pose.tip, pose.tip + pose.axis * height);
    Place::from_column_slice(&[tip.x, tip.y, tip.z, second.x, second.y, second.z])
}

/// Spline blocks of moves in a row: the pose at which the first begins, and each curve with the ends of its chords.
struct Fitted {
    run: Range<usize>,
    start: RotaryPose,
    blocks: Vec<(PoseCurve, Vec<Chord>)>,
}

/// How a run is fitted.
struct Fitting<'a> {
    machine: &'a Machine,
    form: SplineForm,
    decimals: Decimals,
    /// Height of the second point over the tip, and factor of the rotary axes, mm.
    height: f64,
    heights: [ComparedHeight; 2],
}

impl Fitting<'_> {
    fn chain(&self) -> &Chain {
        &self.machine.chain
    }

    fn place(&self, m: &JointMove) -> Place {
        let mut place = by_second_point(&self.machine.forward(&m.joints), self.height);
        if self.form == SplineForm::Spl {
            let [first, second] = m.joints.rotary.map(|angle| angle * self.height);
            place.fixed_rows_mut::<3>(3).copy_from(&Vector3::new(first, second, 0.0));
        }
        place
    }

    fn axis(&self, place: &Place) -> Vector3<f64> {
        let (tip, turn) = (place.fixed_rows::<3>(0), place.fixed_rows::<3>(3));
        match self.form {
            SplineForm::Poly | SplineForm::Movnrb => (turn - tip).normalize(),
            SplineForm::Spl => self.chain().tool_axis([turn[0] / self.height, turn[1] / self.height]),
        }
    }

    /// Blocks of a run, which is divided where no spline keeps the tolerance: there is a corner.
    fn fitted(&self, moves: &[JointMove], run: &Range<usize>) -> Vec<Fitted> {
        let mut open = vec![run.clone()];
        let mut found = Vec::new();
        while let Some(run) = open.pop() {
            if run.len() < MIN_MOVES {
                continue;
            }
            match self.spans(&moves[run.start - 1..run.end]) {
                Ok(spans) if 2 * spans.len() <= run.len() => found.extend(self.blocks(spans, moves, &run)),
                Ok(_) => {}
                Err(at) => {
                    let middle = (run.start - 1 + at).clamp(run.start + 1, run.end - 1);
                    open.extend([middle..run.end, run.start..middle]);
                }
            }
        }
        found
    }

    /// Spans of the spline through the ends of moves.
    fn spans(&self, nodes: &[JointMove]) -> Result<Vec<Vec<Place>>, usize> {
        let ends: Vec<Place> = nodes.iter().map(|m| self.place(m)).collect();
        // With places on the moves, which are on the path as well up to the share of the stations.
        let mut places = ends[..1].to_vec();
        let mut parameters = vec![0.0];
        // Move of each place.
        let mut of = vec![0];
        for (i, pair) in ends.windows(2).enumerate() {
            let length = (pair[1] - pair[0]).norm();
            if length <= 0.0 {
                return Err(i);
            }
            let from = parameters[parameters.len() - 1];
            let count = (length / PLACE_SPACING_MM).ceil().max(4.0);
            for k in 1..=count as usize {
                let share = k as f64 / count;
                places.push(pair[0].lerp(&pair[1], share));
                parameters.push(from + length * share);
                of.push(i);
            }
        }
        let axes: Vec<Vector3<f64>> = places.iter().map(|p| self.axis(p)).collect();
        let deviation = |i: usize, at: &Place| {
            let (tip, turned) = (at.fixed_rows::<3>(0) - places[i].fixed_rows::<3>(0), self.axis(at) - axes[i]);
            self.heights.iter().map(|at| (tip + turned * at.height).norm() / at.tolerance).fold(0.0, f64::max)
        };
        spline_fit::fit(&places, &parameters, self.form.degree(), deviation).map_err(|at| of[at])
    }

    /// The place that the words of the post say.
    fn rounded(&self, place: &Place) -> Place {
        Place::from_fn(|k, _| {
            let turn = k >= 3 && self.form == SplineForm::Spl;
            if turn {
                let degrees = (place[k] / self.height).to_degrees();
                on_step(degrees, self.decimals.angle).to_radians() * self.height
            } else {
                on_step(place[k], self.decimals.length)
            }
        })
    }

    /// The blocks of spans; `None` where the rotary axes would not end where the moves end.
    fn blocks(&self, spans: Vec<Vec<Place>>, moves: &[JointMove], run: &Range<usize>) -> Option<Fitted> {
        let spans = on_words(spans, |place| self.rounded(place));
        let (first, last) = (moves.get(run.start - 1)?, moves.get(run.end - 1)?);
        let curves: Option<Vec<PoseCurve>> = spans.iter().map(|span| self.curve(span)).collect();
        let curves = curves?;
        let start = RotaryPose {
            tip: curves.first()?.at(0.0).0,
            rotary: self.rotary(&self.axis(spans.first()?.first()?), spans.first()?.first()?, first)?,
        };
        let mut before = start.rotary;
        let mut blocks = Vec::with_capacity(curves.len());
        for curve in curves {
            let chords = curve.chords(self.chain(), before, self.height)?;
            before = chords.last()?.end.rotary;
            blocks.push((curve, chords));
        }
        // The rotary axes end where the pass ends, on the same branch.
        (most_turn(before, last.joints.rotary) < SAME_ANGLE).then(|| Fitted { run: run.clone(), start, blocks })
    }

    /// Rotary positions at the start.
    fn rotary(&self, axis: &Vector3<f64>, place: &Place, first: &JointMove) -> Option<[f64; 2]> {
        match self.form {
            SplineForm::Poly | SplineForm::Movnrb => self.chain().near(axis, first.joints.rotary),
            SplineForm::Spl => Some([place[3] / self.height, place[4] / self.height]),
        }
    }

    fn curve(&self, span: &[Place]) -> Option<PoseCurve> {
        let tip = span.iter().map(|p| p.fixed_rows::<3>(0).into_owned()).collect();
        let turn = match self.form {
            SplineForm::Poly | SplineForm::Movnrb => {
                TurnCurve::Second(span.iter().map(|p| p.fixed_rows::<3>(3).into_owned()).collect())
            }
            SplineForm::Spl => TurnCurve::Rotary(span.iter().map(|p| Vector2::new(p[3], p[4]) / self.height).collect()),
        };
        PoseCurve::new(tip, turn)
    }
}

/// Rotary positions that differ by less are the same up to rounding of words, radians.
const SAME_ANGLE: f64 = 1e-4;

/// Moves both ends of each span to their words. The neighbours of an end go with it, so that no corner arises there.
fn on_words(mut spans: Vec<Vec<Place>>, rounded: impl Fn(&Place) -> Place) -> Vec<Vec<Place>> {
    for span in &mut spans {
        let degree = span.len() - 1;
        let by = [0, degree].map(|k| rounded(&span[k]) - span[k]);
        for (k, by) in [(0, by[0]), (1, by[0]), (degree - 1, by[1]), (degree, by[1])] {
            span[k] += by;
        }
        for k in [0, degree] {
            span[k] = rounded(&span[k]);
        }
    }
    spans
}

/// Puts the chords of the blocks in the place of the moves of the runs.
fn replace(
    program: &Program,
    operation: &mut MotionOperation,
    feed: f64,
    heights: &[ComparedHeight],
    fitted: impl Iterator<Item = Fitted>,
) {
    let machine = &program.machine;
    let old = std::mem::take(&mut operation.moves);
    let mut moves: Vec<JointMove> = Vec::with_capacity(old.len());
    let mut taken = 0;
    for Fitted { run, start, blocks } in fitted {
        moves.extend(straight(machine, &old, taken..run.start, heights));
        taken = run.end;
        let pass = old[run.start].pass;
        if let Some(before) = moves.last_mut() {
            before.joints = machine.joints(&start.tip, start.rotary);
        }
        for (curve, chords) in blocks {
            let first = moves.len();
            moves.extend(chords.iter().map(|Chord { end, .. }| JointMove {
                kind: MoveKind::Cut,
                joints: machine.joints(&end.tip, end.rotary),
                feed: Some(feed),
                time: 0.0,
                pass,
                stop: false,
            }));
            let shares = chords.iter().map(|chord| chord.ends[1]).collect();
            operation.splines.push(SplineBlock { first, last: moves.len() - 1, curve, shares });
        }
    }
    moves.extend(straight(machine, &old, taken..old.len(), heights));
    operation.moves = moves;
}

/// The moves of a range that stay straight. Stations were dense for splines: of cuts in a row those stay that the tolerance
/// needs.
fn straight(machine: &Machine, moves: &[JointMove], range: Range<usize>, heights: &[ComparedHeight]) -> Vec<JointMove> {
    let mut out = Vec::with_capacity(range.len());
    let mut at = range.start;
    while at < range.end {
        let joins = |i: &usize| moves[*i].kind == MoveKind::Cut && moves[*i].pass == moves[at].pass;
        let end = (at..range.end).take_while(joins).last().map_or(at, |last| last + 1);
        if end - at < 2 || at == 0 {
            out.push(moves[at]);
            at += 1;
            continue;
        }
        let point = |m: &JointMove| {
            let pose = machine.forward(&m.joints);
            ClPoint { tip: pose.tip, axis: pose.axis, contact: None }
        };
        let points: Vec<ClPoint> = moves[at - 1..end].iter().map(point).collect();
        out.extend(kept(&machine.chain, &points, heights).into_iter().skip(1).map(|k| moves[at - 1 + k]));
        at = end;
    }
    out
}
