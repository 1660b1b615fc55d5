//! `smooth-axis`: smooth rotary angles inside the corridor of clear axes, for `method corridor`.
//!
//! Before: the cheapest sequence of clear axes, station by station, with corners. After: smooth axes, in four steps. At
//! equal distances along the path of the ball, the largest oblique elliptic cone of clear axes (Xu 3) about the
//! sequence is found. Inside these cones, rotary angles with the least turn per mm and the least second and third
//! differences are found. A cubic curve through these angles gives the axis of every station of the pass. Last, the
//! clearance over the continuous motion between stations is proved. Where the proof fails, the cones take a larger
//! distance, there are more of them, and all steps are repeated, at most three times. Then the pass is an error with the
//! last residuals. At the end each pass of the floor is turned towards the pass before it, as far as the proof allows, so
//! that links between them turn little.

use super::clear_axes::{ClearAxes, MIN_TILT, StandingBall};
use super::other_tools::remedy_for;
use super::run::{interval_at, lengths, rotary};
use crate::passes::context::PassContext;
use axes::orient::inscribe::Proof;
use axes::orient::{Corridor, Residual, Weights};
use base::progress::{Progress, Work};
use base::units::trim;
use diagnostics::{Aborted, Diag, codes::orientation};
use five_axis::{Angles, Chain, RotaryPose, between};
use ir::{CcPlan, ClPass, ClPlan, ClPoint, Operation};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;
use wheel::method::AxisMethod;

/// Distance of the stations of the corridor, mm, for usual tools.
const STATION_SPACING_MM: f64 = 1.5;

/// Length over which angles are smooth, mm, for usual tools.
const SMOOTH_LENGTH_MM: f64 = 6.0;

/// Fewest stations of a corridor.
const MIN_STATIONS: usize = 8;

/// Times that the corridor is built about the last result; each widens the range that the result can reach.
const CORRIDOR_ROUNDS: usize = 3;

/// Times that all steps are repeated with a larger distance.
const MAX_REPEATS: usize = 3;

/// Distance that cones add to the required distance, mm per round: allows for the motion between stations.
const CONE_MARGIN_MM: f64 = 0.06;

/// Shares of the turn to the axis of the pass before that are tried.
const TURN_SHARES: [f64; 4] = [1.0, 0.75, 0.5, 0.25];

/// Sine of the angle between the tool at zero and rotary axis 2 below which the pole is at zero.
const AT_POLE: f64 = 1e-9;

/// Weights of the minimised terms.
fn weights(chain: &Chain) -> Weights {
    let pole_at_zero = libm::sin(chain.polar_angle(0.0)) < AT_POLE;
    let least_tilt = if pole_at_zero { MIN_TILT } else { 0.0 };
    Weights { first: 0.02, second: 1.0, third: 1.0, peak: 3.0, middle: 0.003, least_tilt }
}

/// Why a pass was not smoothed.
enum Fault {
    /// No clear axis at a place, with the direction about which axes were tried.
    NoAxis(Point3<f64>, Vector3<f64>),
    /// No sequence of angles inside the cones.
    NoRun(Point3<f64>, Residual),
    /// The clearance of the motion behind this station is not proved.
    NotProved(Point3<f64>),
}

/// Smooths the axes of all operations with `method corridor`.
///
/// # Errors
/// A pass without a clear axis, without smooth angles inside the cones, or without proved clearance between stations.
pub(crate) fn run(cx: &mut PassContext<'_>, cc: &CcPlan, cl: &mut ClPlan) -> Result<(), Aborted> {
    let program = cx.program;
    let mut failed = false;
    for (planned, oriented) in cc.operations.iter().zip(&mut cl.operations) {
        cx.go_on()?;
        let operation = &program.operations[planned.operation];
        if operation.kind.axis_method() != Some(AxisMethod::Corridor) {
            continue;
        }
        let clear = ClearAxes::new(program, cx.obstacles, operation);
        let work = cx.progress.begin(format!("{}, smooth axes", operation.name), oriented.passes.len());
        let tried = clear.with_side_distances();
        let smoothed = |pass| work.do_step(|| smooth_with_any(&tried, &program.machine.chain, pass, &work));
        let smoothed = oriented.passes.par_iter().map(smoothed).collect::<Option<Vec<_>>>().ok_or(Aborted)?;
        drop(work);
        cx.go_on()?;
        let mut nearer = vec![0_usize; tried.len()];
        let mut faults = Vec::new();
        for (i, result) in smoothed.into_iter().enumerate() {
            match result {
                Ok((points, k)) => {
                    oriented.passes[i].points = points;
                    nearer[k] += 1;
                }
                Err(fault) => faults.push((i, fault)),
            }
        }
        if !faults.is_empty() {
            failed = true;
            report(cx, operation, &oriented.passes, &clear, &faults);
        }
        if operation.kind.is_on_floor() {
            follow(&clear, &program.machine.chain, &mut oriented.passes);
        }
        let peak = oriented
            .passes
            .iter()
            .map(|pass| turning(&program.machine.chain, &pass.points))
            .fold([0.0_f64; 2], |m, t| [m[0].max(t[0]), m[1].max(t[1])]);
        oriented.notes.push(format!(
            "tool axes by corridor: {} turns by at most {:.2} deg/mm, {} by at most {:.2} deg/mm; proved collision-free between stations",
            program.machine.rotary[0].name,
            peak[0].to_degrees(),
            program.machine.rotary[1].name,
            peak[1].to_degrees()
        ));
        for (clear, count) in tried.iter().zip(nearer).skip(1).filter(|(_, count)| *count > 0) {
            oriented.notes.push(format!(
                "on {count} passes the side of the cutter keeps {} mm from the part instead of {} mm",
                trim(clear.side_distance(), 3),
                trim(tried[0].side_distance(), 3)
            ));
        }
    }
    if failed { Err(Aborted) } else { Ok(()) }
}

/// Turns each pass by the same angles at all stations, so that it begins with the axis with which the pass before it
/// ends; by a share of these angles where the clearance of the whole turn is not proved.
fn follow(clear: &ClearAxes<'_>, chain: &Chain, passes: &mut [ClPass]) {
    let (radius, least) = (clear.radius(), weights(chain).least_tilt);
    for i in 1..passes.len() {
        let (before, pass) = passes.split_at_mut(i);
        let (Some(end), points) = (before[i - 1].points.last(), &mut pass[0].points) else { continue };
        let Some(first) = points.first() else { continue };
        let ends = rotary(chain, [first.axis, end.axis].into_iter());
        let turn = [0, 1].map(|k: usize| ends[1][k] - ends[0][k]);
        let angles = rotary(chain, points.iter().map(|p| p.axis));
        let turned = |share: f64| -> Option<Vec<ClPoint>> {
            let poses: Vec<Angles> = angles.iter().map(|a| [0, 1].map(|k| a[k] + share * turn[k])).collect();
            let places: Vec<ClPoint> = points
                .iter()
                .zip(&poses)
                .map(|(p, angles)| {
                    let axis = chain.tool_axis(*angles);
                    ClPoint { tip: p.tip + (p.axis - axis) * radius, axis, contact: p.contact }
                })
                .collect();
            let end = |k: usize| RotaryPose { tip: places[k].tip, rotary: poses[k] };
            let fits = poses.iter().all(|a| a[0].abs() >= least)
                && places.iter().all(|p| clear.in_travel(p))
                && (1..places.len()).into_par_iter().all(|k| clear.proved(&[end(k - 1), end(k)]));
            fits.then_some(places)
        };
        if let Some(places) = TURN_SHARES.iter().find_map(|share| turned(*share)) {
            *points = places;
        }
    }
}

/// Largest turns of both rotary axes per mm of tip motion.
fn turning(chain: &Chain, points: &[ClPoint]) -> [f64; 2] {
    let angles = rotary(chain, points.iter().map(|p| p.axis));
    let mut most = [0.0_f64; 2];
    for (pair, angle) in points.windows(2).zip(angles.windows(2)) {
        let length = (pair[1].tip - pair[0].tip).norm();
        if length > 1e-3 {
            most = [0, 1].map(|k| most[k].max((angle[1][k] - angle[0][k]).abs() / length));
        }
    }
    most
}

/// Smooth axes of a pass with the first of these distances beside the cutter that has them, and its index.
///
/// # Errors
/// The fault with the first of them.
fn smooth_with_any(
    tried: &[ClearAxes<'_>],
    chain: &Chain,
    pass: &ClPass,
    work: &Work,
) -> Result<(Vec<ClPoint>, usize), Fault> {
    let mut first = None;
    for (k, clear) in tried.iter().enumerate() {
        match smooth(clear, chain, pass, work) {
            Ok(points) => return Ok((points, k)),
            Err(fault) => first = first.or(Some(fault)),
        }
    }
    Err(first.unwrap_or(Fault::NotProved(Point3::origin())))
}

fn smooth(clear: &ClearAxes<'_>, chain: &Chain, pass: &ClPass, work: &Work) -> Result<Vec<ClPoint>, Fault> {
    let radius = clear.radius();
    let balls: Vec<StandingBall> = pass.points.iter().map(|p| StandingBall::at(p, radius)).collect();
    let centres: Vec<Point3<f64>> = balls.iter().map(|ball| ball.centre).collect();
    let table = lengths(&centres);
    let whole = table.last().copied().unwrap_or(0.0);
    if centres.len() < 2 || whole <= 0.0 {
        return Ok(pass.points.clone());
    }
    let angles = rotary(chain, pass.points.iter().map(|p| p.axis));
    let at = |s: f64| {
        let (i, t) = interval_at(&table, s);
        let angle = between(angles[i], angles[i + 1], t);
        (balls[i].towards(&balls[i + 1], t), angle)
    };
    let mut fault = Fault::NotProved(centres[0]);
    for round in 1..=MAX_REPEATS {
        let count = round * ((whole / clear.scaled(STATION_SPACING_MM)).ceil() as usize).max(MIN_STATIONS);
        let spacing = whole / count as f64;
        let (places, start): (Vec<StandingBall>, Vec<Angles>) = (0..=count).map(|k| at(k as f64 * spacing)).unzip();
        let margin = clear.scaled(CONE_MARGIN_MM) * round as f64;
        let mut run = start;
        for corridor_round in 0..CORRIDOR_ROUNDS {
            if work.is_cancelled() {
                return Err(fault);
            }
            match smooth_within_cones(clear, chain, &places, &run, spacing, margin) {
                Ok(next) => run = next,
                Err(found) if corridor_round == 0 && round == 1 => return Err(found),
                // Later cones widen the range of a run; where they hold none, the run before is kept: in a later round it may be
                // the sequence itself.
                Err(_) => break,
            }
        }
        let points = on_curve(chain, &pass.points, &centres, &table, &run, spacing, radius);
        let exact = rotary(chain, points.iter().map(|p| p.axis));
        let unproved = (1..points.len()).find(|i| {
            let end = |k: usize| RotaryPose { tip: points[k].tip, rotary: exact[k] };
            !clear.proved(&[end(i - 1), end(*i)])
        });
        match unproved {
            None => return Ok(points),
            Some(i) => fault = Fault::NotProved(points[i].tip),
        }
    }
    Err(fault)
}

/// Smooth angles within cones of clear axes about a run of angles at equal lengths.
fn smooth_within_cones(
    clear: &ClearAxes<'_>,
    chain: &Chain,
    places: &[StandingBall],
    run: &[Angles],
    spacing: f64,
    margin: f64,
) -> Result<Vec<Angles>, Fault> {
    let mut cones = Vec::with_capacity(run.len());
    for (place, angles) in places.iter().zip(run) {
        let wanted = chain.tool_axis(*angles);
        // Where the clear axes are few, no cone of them keeps a larger distance: the proof decides.
        let kept = |margin: f64| clear.narrow_cone(place, &wanted, Proof::Rays, margin);
        let cone = kept(margin).or_else(|| kept(0.0));
        cones.push(cone.ok_or(Fault::NoAxis(place.centre, wanted))?);
    }
    let found =
        Corridor { cones, spacing, length: clear.scaled(SMOOTH_LENGTH_MM) }
            .smooth(run, &weights(chain), &|angles| chain.tool_axis(angles));
    found.map_err(|residual| Fault::NoRun(places[residual.station].centre, residual))
}

/// The stations of a pass with axes on the cubic curve through the rotary angles at equal lengths.
fn on_curve(
    chain: &Chain,
    points: &[ClPoint],
    centres: &[Point3<f64>],
    table: &[f64],
    run: &[Angles],
    spacing: f64,
    radius: f64,
) -> Vec<ClPoint> {
    // Four point interpolation: for evenly spaced smooth values exact to the fourth difference.
    let cubic = |x: f64, value: &dyn Fn(usize) -> f64| {
        let i = (x.floor() as usize).clamp(1, run.len() - 3) - 1;
        let t = x - i as f64;
        (0..4)
            .map(|j| {
                let others = (0..4).filter(|k| *k != j);
                others.map(|k| (t - k as f64) / (j as f64 - k as f64)).product::<f64>() * value(i + j)
            })
            .sum::<f64>()
    };
    points
        .iter()
        .zip(centres)
        .zip(table)
        .map(|((point, centre), s)| {
            let x = s / spacing;
            let axis = chain.tool_axis([0, 1].map(|axis| cubic(x, &|k| run[k][axis])));
            ClPoint { tip: centre - axis * radius, axis, contact: point.contact }
        })
        .collect()
}

/// True where the axes of a pass become smooth, with the whole distance beside the cutter or with less.
pub(super) fn has_smooth_axes(clear: &ClearAxes<'_>, chain: &Chain, pass: &ClPass) -> bool {
    let work = Progress::default().begin("", 1);
    smooth_with_any(&clear.with_side_distances(), chain, pass, &work).is_ok()
}

/// The error of an operation with passes that did not become smooth: the first of them, and tools with which all of them would.
fn report(
    cx: &mut PassContext<'_>,
    operation: &Operation,
    passes: &[ClPass],
    clear: &ClearAxes<'_>,
    faults: &[(usize, Fault)],
) {
    let Some((first, fault)) = faults.first() else { return };
    let tool = &cx.program.tools[operation.tool];
    let (Fault::NoAxis(at, _) | Fault::NoRun(at, _) | Fault::NotProved(at)) = fault;
    let (label, place) = cx.in_first_sector(operation, &passes[*first].label, *at);
    let help = || {
        let left: Vec<(usize, &ClPass)> = faults.iter().map(|(i, _)| (*i, &passes[*i])).collect();
        let no_axis = |(_, fault): &(usize, Fault)| match fault {
            Fault::NoAxis(at, about) => Some((*at, *about)),
            Fault::NoRun(..) | Fault::NotProved(_) => None,
        };
        let places: Vec<_> = faults.iter().filter_map(no_axis).collect();
        remedy_for(cx, operation, &left, &places, |clear, program, (_, pass)| {
            has_smooth_axes(clear, &program.machine.chain, pass)
        })
    };
    let diag = match fault {
        Fault::NoAxis(at, about) => {
            let direction = "the axis between its neighbours";
            clear.no_axis(&operation.name, &tool.name, at, about, direction, help)
        }
        Fault::NoRun(_, residual) => Diag::error(
            orientation::NOT_SMOOTH,
            format!(
                "`{}`: no smooth motion of the rotary axes remains collision-free: in the last round an axis is at {:.2} times \
                 the half angle of its cone, and angles changed by {:.4} deg",
                operation.name,
                residual.level,
                residual.change.to_degrees()
            ),
        )
        .help(format!("{}; or use `method blend`, which requires less distance", help())),
        Fault::NotProved(_) => Diag::error(
            orientation::NOT_SMOOTH,
            format!("`{}`: the clearance of {} is not proved between stations", operation.name, tool.name),
        )
        .help(help()),
    };
    let diag = diag.place(label, place).label(operation.span, "in this operation").label(tool.span, "with this tool");
    cx.sink.push(match faults.len() {
        1 => diag,
        count => diag.note(format!("{count} of {} passes have no such motion; this is one of them", passes.len())),
    });
}
