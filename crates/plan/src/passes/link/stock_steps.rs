//! Planned passes as steps of the stock.

use five_axis::{Angles, Machine, between};
use ir::{ClPass, ClPoint};
use tool_stock::collide::ToolSolid;
use tool_stock::stock::{self, Field, Step, StepKind};

/// Longest tip motion in a step, mm; passes are cut to this accuracy.
const STEP_LENGTH_MM: f64 = 0.25;

/// Largest turn of a step, radians; limits the motion at the top of a cutter.
const STEP_TURN: f64 = 0.5 * std::f64::consts::PI / 180.0;

/// Longest tip motion of a step that cuts, mm.
const CUT_LENGTH_MM: f64 = 2.0;

/// Radius of the rounding with which a cutter dips into a surface; for a flat cutter the radius of its side.
pub(super) fn rounding(solid: &ToolSolid) -> f64 {
    let tip = solid.cutter.tip_radius();
    if tip > 0.0 { tip } else { solid.radius() }
}

/// True when nothing above the cutter is thinner: a tool that leaves along its axis then sweeps only the space it
/// occupies.
pub(super) fn leaves_along_axis(solid: &ToolSolid) -> bool {
    let widest = solid.cutter.widest_below(solid.flute_length);
    solid.shank.iter().chain(&solid.holder).all(|s| s.radius_from.min(s.radius_to) >= widest)
}

/// A place on a pass, with rotary angles that do not jump.
#[derive(Clone, Copy)]
pub(super) struct PathPoint {
    pub(super) point: ClPoint,
    rotary: Angles,
    /// False for stations inserted between the planned ones.
    pub(super) planned: bool,
}

/// Stations of a pass, dense enough that two of them bound a step of the stock. Between planned stations the machine
/// moves the tip straight and both rotary angles evenly.
pub(super) fn stations(machine: &Machine, pass: &ClPass) -> Vec<PathPoint> {
    let mut found: Vec<PathPoint> = Vec::with_capacity(pass.points.len());
    for point in &pass.points {
        let before = found.last().map_or(0.0, |s| s.rotary[1]);
        let to = PathPoint { point: *point, rotary: machine.chain.unwound(&point.axis, 0, before), planned: true };
        if let Some(from) = found.last().copied() {
            let motion = to.point.tip - from.point.tip;
            let turn = machine.turn(from.rotary, to.rotary);
            let count = (turn / STEP_TURN).max(motion.norm() / STEP_LENGTH_MM).ceil().max(1.0);
            found.extend((1..count as usize).map(|k| {
                let t = k as f64 / count;
                let rotary = between(from.rotary, to.rotary, t);
                let axis = machine.chain.tool_axis(rotary);
                let point = ClPoint { tip: from.point.tip + motion * t, axis, contact: None };
                PathPoint { point, rotary, planned: false }
            }));
        }
        found.push(to);
    }
    found
}

/// The numbered steps of passes, each with the index of its pass, for a cutter whose tip is lower on its axis by
/// `lowered`.
pub(super) fn steps<'a>(
    machine: &'a Machine,
    passes: &'a [ClPass],
    kind: StepKind,
    lowered: f64,
) -> impl Iterator<Item = (usize, Step)> + 'a {
    passes
        .iter()
        .enumerate()
        .flat_map(move |(i, pass)| {
            let line = stations(machine, pass);
            let steps: Vec<(usize, Step)> = steps_of(machine, &line, kind, lowered).map(|step| (i, step)).collect();
            steps
        })
        .enumerate()
        .map(|(n, (pass, step))| (pass, Step { block: number(n), ..step }))
}

fn number(step: usize) -> u32 {
    u32::try_from(step).unwrap_or(u32::MAX)
}

/// The numbered steps between neighbouring stations.
pub(super) fn steps_of<'a>(
    machine: &'a Machine,
    line: &'a [PathPoint],
    kind: StepKind,
    lowered: f64,
) -> impl Iterator<Item = Step> + 'a {
    line.windows(2).enumerate().map(move |(n, w)| {
        let axes = [0.0, 0.5, 1.0].map(|t| machine.chain.tool_axis(between(w[0].rotary, w[1].rotary, t)));
        let tips = [w[0].point.tip - axes[0] * lowered, w[1].point.tip - axes[2] * lowered];
        Step { block: number(n), kind, tips, axes }
    })
}

/// Removes the cut of a cutter along stations from the stock. Between two planned stations the motion is one, so that its
/// steps may be as long as the stock takes them.
pub(super) fn cut(machine: &Machine, line: &[PathPoint], cutter: &ToolSolid, field: &mut Field) {
    let mut ends: Vec<PathPoint> = Vec::new();
    let mut from = 0;
    while from < line.len() {
        ends.push(line[from]);
        let reaches = |to: &usize| {
            let passes = line[from + 1..*to].iter().all(|s| !s.planned);
            passes
                && (line[*to].point.tip - line[from].point.tip).norm() <= CUT_LENGTH_MM
                && machine.turn(line[from].rotary, line[*to].rotary) <= stock::MAX_STEP_TURN
        };
        from = (from + 2..line.len()).take_while(reaches).last().unwrap_or(from + 1);
    }
    stock::cut(field, cutter, steps_of(machine, &ends, StepKind::Cut, 0.0));
}

/// Length of the path of the tip, mm.
pub(super) fn path_length(stations: &[PathPoint]) -> f64 {
    stations.windows(2).map(|w| (w[1].point.tip - w[0].point.tip).norm()).sum()
}

/// Largest error of the depth between the rays of a stock, mm, for the rounding of a cutter.
pub(super) fn error_between_rays(field: &Field, solid: &ToolSolid) -> f64 {
    field.cell() * field.cell() / (4.0 * rounding(solid))
}
