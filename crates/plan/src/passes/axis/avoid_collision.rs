//! `avoid-collision`: tool, shank and holder clear of the part.
//!
//! Before: cutter locations with the axes that the geometry suggests. After: the same contacts with collision-free
//! axes. With `method blend` the axes of channel finishing tilt away from the nearer wall as little as necessary.
//! `corridor` takes the cheapest sequence of clear axes in the coordinates of the machine, `xu` the greedy sequence;
//! `ruling` changes nothing. Layers have already made roughing lines clear. A pass without a clear axis is an error
//! that names the place.

use super::clear_axes::{ClearAxes, MIN_TILT, StandingBall, is_steep, share_of_size};
use super::orient_tool::tilted_points;
use super::other_tools::remedy_for;
use super::run::lengths;
use super::sequence::{self, Blocked, Gap};
use super::sideways::{TurnSide, turned};
use super::smooth_axis::has_smooth_axes;
use super::varied_tilt::ClearTilts;
use crate::passes::context::SIDE_CLEARANCE;
use crate::passes::context::{AxisTilt, Obstacles, PassContext, remedy};
use base::progress::Progress;
use base::units::{length, trim};
use diagnostics::{Aborted, Diag, codes::orientation};
use ir::{CcOperation, CcPass, CcPlan, ClOperation, ClPass, ClPlan, ClPoint, Drive, Operation, Program};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;
use tool_stock::collide::ToolSolid;
use wheel::method::AxisMethod;
use wheel::part::SurfaceKind;

/// Tilt angles that are tried, degrees. A line keeps one tilt angle, so that its axes remain as smooth as the rulings.
pub(super) const TILTS: [f64; 14] = [0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0, 16.0, 18.0, 20.0, 24.0, 28.0, 32.0];

/// Angles to one side that are tried where no tilt is clear, degrees; a pass keeps one of them.
const SIDES: [f64; 10] = [6.0, -6.0, 12.0, -12.0, 18.0, -18.0, 24.0, -24.0, 32.0, -32.0];

/// Worst station of a pass with its least bad tilt: the violation there, mm, and the tool.
struct Miss {
    station: usize,
    violation: f64,
    at: ClPoint,
}

/// A place without a tool.
const NOWHERE: ClPoint = ClPoint { tip: Point3::new(0.0, 0.0, 0.0), axis: Vector3::new(0.0, 0.0, 1.0), contact: None };

/// Stations of a pass that are clear, the largest of their tilts, and their angle to one side, degrees.
struct ClearedPass {
    points: Vec<ClPoint>,
    steepest: f64,
    side: f64,
}

/// A pass without clear tilts.
struct Unclear {
    /// The tilt that is least bad, degrees; `None` where the pass has no such side.
    tilt: Option<f64>,
}

/// For each of some stations the worst violation, negative, between the stations before and behind it.
fn worst_between(sparse: &[usize], all: &[Option<f64>]) -> Vec<Option<f64>> {
    let worst = |k: usize| {
        let from = if k == 0 { 0 } else { sparse[k - 1] };
        let to = sparse.get(k + 1).copied().unwrap_or(all.len() - 1);
        all[from..=to].iter().flatten().copied().reduce(f64::min)
    };
    (0..sparse.len()).map(worst).collect()
}

/// The reason why the tool of an operation is too near to the part, where the operation itself knows it.
pub(crate) type TooNear = fn(&PassContext<'_>, &Operation) -> Option<Diag>;

/// Makes axes collision-free, or reports where this is impossible: with the reason of the operation, where it has one.
///
/// # Errors
/// A pass whose shank or holder is nearer to the part than the clearance of the job.
pub(crate) fn run(cx: &mut PassContext<'_>, reason: TooNear, cc: &CcPlan, cl: &mut ClPlan) -> Result<(), Aborted> {
    let mut failed = false;
    for (planned, oriented) in cc.operations.iter().zip(&mut cl.operations) {
        cx.go_on()?;
        let operation = &cx.program.operations[planned.operation];
        let (program, obstacles) = (cx.program, cx.obstacles);
        if let Some(method @ (AxisMethod::Corridor | AxisMethod::Xu)) = operation.kind.axis_method() {
            failed |= clear_axes(cx, operation, method, planned, oriented).is_err();
            continue;
        }
        let work = cx.progress.begin(format!("{}, clearance", operation.name), planned.passes.len());
        let pairs = || planned.passes.par_iter().zip(&oriented.passes);
        let clear = |(cc, cl): (&CcPass, &ClPass)| {
            work.do_step(|| TiltedPass::new(program, obstacles, operation, cc).cleared(&cl.points))
        };
        let found: Option<Vec<Result<ClearedPass, Miss>>> = pairs().map(clear).collect();
        let found = found.ok_or(Aborted)?;
        let (mut steepest, mut side, mut turned_passes) = (0.0_f64, 0.0_f64, 0_usize);
        let mut blocked = Vec::new();
        for (index, found) in found.into_iter().enumerate() {
            match found {
                Ok(cleared) => {
                    steepest = steepest.max(cleared.steepest);
                    side = side.max(cleared.side.abs());
                    turned_passes += usize::from(cleared.side != 0.0);
                    oriented.passes[index].points = cleared.points;
                }
                Err(miss) => blocked.push((index, miss)),
            }
        }
        if !blocked.is_empty() {
            failed = true;
            let diag = reason(cx, operation).unwrap_or_else(|| too_near(cx, operation, planned, oriented, &blocked));
            cx.sink.push(diag);
        }
        if steepest > 0.0 {
            oriented.notes.push(format!(
                "tool axes tilt away from the nearer wall by up to {} deg at the wall",
                trim(steepest, 1)
            ));
        }
        if turned_passes > 0 {
            oriented
                .notes
                .push(format!("on {turned_passes} passes they turn to one side by up to {} deg", trim(side, 1)));
        }
    }
    if failed { Err(Aborted) } else { Ok(()) }
}

/// True when a pass tilts away from walls as far as necessary.
fn tilts_away(operation: &Operation, cc: &CcPass) -> bool {
    let along = operation.kind.axis_method() == Some(AxisMethod::Ruling);
    matches!(cc.drive, Drive::Hub(_) | Drive::Contact(_) | Drive::Round(_)) && !along
}

/// Chooses clear axes for all passes of an operation.
fn clear_axes(
    cx: &mut PassContext<'_>,
    operation: &Operation,
    method: AxisMethod,
    planned: &CcOperation,
    oriented: &mut ClOperation,
) -> Result<(), Aborted> {
    let program = cx.program;
    let clear = ClearAxes::new(program, cx.obstacles, operation);
    let work = cx.progress.begin(format!("{}, collision-free axes", operation.name), planned.passes.len());
    let (passes, planned) = (&oriented.passes, &planned.passes);
    let chosen = if method == AxisMethod::Xu {
        sequence::greedy_axes(&clear, &program.machine.chain, planned, passes)
    } else {
        sequence::shortest(&clear, &program.machine, passes, operation.kind.is_on_floor(), &work)
    };
    let (found, blocked) = match chosen {
        Ok(points) => (points, Vec::new()),
        Err(faults) => (Vec::new(), faults),
    };
    drop(work);
    cx.go_on()?;
    if let Some(diag) = no_sequence(cx, operation, &clear, planned, passes, &blocked) {
        cx.sink.push(diag);
        return Err(Aborted);
    }
    for (pass, points) in oriented.passes.iter_mut().zip(found) {
        pass.points = points;
    }
    Ok(())
}

/// The error of an operation with passes whose sequence of clear axes ends: the first of them, a place without any axis before others,
/// and tools that would lead along all of them.
fn no_sequence(
    cx: &PassContext<'_>,
    operation: &Operation,
    clear: &ClearAxes<'_>,
    planned: &[CcPass],
    passes: &[ClPass],
    blocked: &[(usize, Blocked)],
) -> Option<Diag> {
    let no_axis = |(_, blocked): &&(usize, Blocked)| matches!(blocked.why, Gap::NoAxis);
    let (first, at) = blocked.iter().find(no_axis).or(blocked.first())?;
    let tool = &cx.program.tools[operation.tool];
    let help = || {
        let unled: Vec<(usize, &ClPass)> = blocked.iter().map(|(i, _)| (*i, &passes[*i])).collect();
        let places: Vec<_> = blocked.iter().filter(no_axis).map(|(_, blocked)| (blocked.at, blocked.about)).collect();
        remedy_for(cx, operation, &unled, &places, |clear, program, (i, pass)| {
            let (chain, pass) = (&program.machine.chain, std::slice::from_ref(pass));
            if operation.kind.axis_method() == Some(AxisMethod::Xu) {
                return sequence::greedy_axes(clear, chain, &planned[i..=i], pass).is_ok();
            }
            let work = Progress::default().begin("", 1);
            sequence::shortest(clear, &program.machine, pass, operation.kind.is_on_floor(), &work)
                .is_ok_and(|found| has_smooth_axes(clear, chain, &ClPass { points: found.concat(), ..pass[0].clone() }))
        })
    };
    let diag = match at.why {
        Gap::NoAxis => clear.no_axis(&operation.name, &tool.name, &at.at, &at.about, "the channel's direction", help),
        Gap::NearPole => {
            let least = MIN_TILT.to_degrees();
            no_motion(
                &operation.name,
                &tool.name,
                &format!("are less than {least:.1} deg from Z, where the second rotary axis would turn through"),
                help(),
            )
        }
        Gap::TooFar => {
            let [turn, step] = [sequence::MAX_STATION_TURN.to_degrees(), clear.scaled(sequence::STATION_SPACING_MM)];
            let reason = format!("are more than {turn:.0} deg away from those {step:.1} mm before");
            no_motion(&operation.name, &tool.name, &reason, help())
        }
    };
    let label = passes.get(*first).map_or("", |p| p.label.as_str());
    let (label, place) = cx.in_first_sector(operation, label, at.at);
    let diag = diag.place(label, place).label(operation.span, "in this operation").label(tool.span, "with this tool");
    Some(match blocked.len() {
        1 => diag,
        count => diag.note(format!("{count} of {} passes have no such axes; this is one of them", passes.len())),
    })
}

/// The error where there are clear axes, and no motion from one to the next.
fn no_motion(operation: &str, tool: &str, reason: &str, help: String) -> Diag {
    Diag::error(
        orientation::NO_AXIS,
        format!("`{operation}`: the axes here that keep {tool} clear of the part {reason}"),
    )
    .help(format!("{help}; or use other surfaces or `blades` for this tool"))
}

/// The error of an operation: its worst place, and a tool that would clear all of its passes. For passes along the rulings
/// the cutter stays: the surface that they cut determines its size.
fn too_near(
    cx: &PassContext<'_>,
    operation: &Operation,
    planned: &CcOperation,
    oriented: &ClOperation,
    blocked: &[(usize, Miss)],
) -> Diag {
    let (program, obstacles) = (cx.program, cx.obstacles);
    let tool = &program.tools[operation.tool];
    let pass = |k: usize| TiltedPass::new(program, obstacles, operation, &planned.passes[k]);
    let worst = blocked.iter().reduce(|a, b| if b.1.violation > a.1.violation { b } else { a });
    let place = worst.and_then(|(k, miss)| Some((oriented.passes.get(*k)?, miss)));
    let (label, at) = place.map_or((String::new(), Point3::origin()), |(pass, miss)| {
        cx.in_first_sector(operation, &pass.label, miss.at.tip)
    });
    let violation = worst.map_or(0.0, |(_, miss)| miss.violation);
    let kept = worst.map_or(String::new(), |(k, miss)| pass(*k).nearest_part(miss));
    let cutter_free = blocked.iter().all(|(k, _)| tilts_away(operation, &planned.passes[*k]));
    let help = remedy(&tool.solid, cutter_free, |solid| {
        let program = &program.with_solid(operation.tool, solid);
        let clear = |k: usize| {
            let pass = TiltedPass::new(program, obstacles, operation, &planned.passes[k]);
            pass.cleared_by_tilts(&oriented.passes[k].points).is_ok()
        };
        blocked.par_iter().all(|(k, _)| clear(*k))
    });
    let help = if corridor_is_clear(cx, operation, oriented, blocked) {
        format!(
            "at these places `method corridor` has clear tool axes, and may find a smooth motion through them; with `method blend`, {help}"
        )
    } else {
        help
    };
    let diag = Diag::error(
        orientation::COLLISION,
        format!("`{}`: {} is {} too near to the part; {kept}", operation.name, tool.name, length(violation)),
    )
    .label(operation.span, "in this operation")
    .label(tool.span, "with this tool")
    .place(label, at)
    .help(help);
    match blocked.len() {
        1 => diag,
        count => diag.note(format!("{count} of {} passes are too near; this is the worst place", planned.passes.len())),
    }
}

/// True where `method corridor` would find a clear axis at the worst place of each pass, and another method is chosen.
fn corridor_is_clear(
    cx: &PassContext<'_>,
    operation: &Operation,
    oriented: &ClOperation,
    blocked: &[(usize, Miss)],
) -> bool {
    let ball = cx.program.tools[operation.tool].solid.cutter.ends_in_ball();
    if operation.kind.axis_method() != Some(AxisMethod::Blend) || !ball {
        return false;
    }
    let clear = ClearAxes::new(cx.program, cx.obstacles, operation);
    blocked.par_iter().all(|(pass, miss)| {
        let point = oriented.passes.get(*pass).and_then(|pass| pass.points.get(miss.station));
        point.is_some_and(|p| {
            let ball = StandingBall::at(p, clear.radius());
            clear.candidates(&ball, &p.axis, clear.scaled(sequence::CANDIDATE_MARGIN_MM)).iter().any(is_steep)
        })
    })
}

/// Turn of the axes of a pass to one side, degrees.
#[derive(Clone, Copy)]
struct SideTurn {
    side: TurnSide,
    degrees: f64,
}

/// A pass among the obstacles, with the tool of its operation.
struct TiltedPass<'a> {
    program: &'a Program,
    obstacles: &'a Obstacles,
    operation: &'a Operation,
    cc: &'a CcPass,
    /// Distance that the side of the cutter keeps from the part, mm.
    side_clearance: f64,
}

impl<'a> TiltedPass<'a> {
    /// With the least distance of the side of the cutter.
    fn new(program: &'a Program, obstacles: &'a Obstacles, operation: &'a Operation, cc: &'a CcPass) -> Self {
        let side_clearance = SIDE_CLEARANCE * share_of_size(&program.tools[operation.tool].solid);
        Self { program, obstacles, operation, cc, side_clearance }
    }

    fn solid(&self) -> &ToolSolid {
        &self.program.tools[self.operation.tool].solid
    }

    fn on_vane(&self) -> bool {
        matches!(self.cc.drive, Drive::Contact(_) | Drive::Round(_))
    }

    /// Stations with the tilts of the stations, turned to one side, degrees; `None` where they cannot turn.
    fn tilted(&self, tilt: impl Fn(usize) -> f64, to: SideTurn) -> Option<Vec<ClPoint>> {
        let points = tilted_points(self.program, self.operation, self.cc, |i| AxisTilt::Away(tilt(i).to_radians()));
        let radius = self.solid().cutter.tip_radius();
        if to.degrees == 0.0 { Some(points) } else { turned(&points, radius, to.side, to.degrees.to_radians()) }
    }

    /// Required distance of the side of a ball, mm.
    fn side(&self) -> Option<f64> {
        (tilts_away(self.operation, self.cc) && self.solid().cutter.ends_in_ball()).then_some(self.side_clearance)
    }

    /// Worst violation at a station, negative.
    fn violation(&self, p: &ClPoint) -> Option<f64> {
        let solid = self.solid();
        // A ball on an edge that the lathe makes or on a tip: nothing of the part is near the side of the cutter.
        let edge = match self.cc.drive {
            Drive::Contact(SurfaceKind::InletEdge(blade)) => self.program.part.edge(blade, 0).is_none(),
            Drive::Contact(SurfaceKind::OutletEdge(blade)) => self.program.part.edge(blade, 1).is_none(),
            Drive::Contact(SurfaceKind::Tip(_)) => true,
            _ => false,
        };
        let may_cut_in = self.on_vane() && !(solid.cutter.ends_in_ball() && edge);
        let inside = if may_cut_in || matches!(self.cc.drive, Drive::HubWithLead(..)) {
            self.obstacles.cutter_inside(solid, &p.tip, &p.axis)
        } else {
            None
        };
        let clearance = self.program.clearance.get();
        let body = self.obstacles.body_violation(solid, &p.tip, &p.axis, clearance, self.side());
        inside.into_iter().chain(body).reduce(f64::min)
    }

    /// The worst place, if the tool is too near anywhere.
    fn miss(&self, points: &[ClPoint], violations: &[Option<f64>]) -> Option<Miss> {
        let near = violations.iter().enumerate().filter_map(|(i, v)| v.map(|d| (i, d)));
        let (station, least) = near.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let at = points.get(station).copied()?;
        Some(Miss { station, violation: -least, at })
    }

    /// Clear stations: by tilts alone, else turned to one side as well; with the usual distance beside the cutter, else with that of
    /// a thin one.
    fn cleared(&self, points: &[ClPoint]) -> Result<ClearedPass, Miss> {
        if self.side_clearance < SIDE_CLEARANCE {
            let usual = Self { side_clearance: SIDE_CLEARANCE, ..*self };
            if let Ok(cleared) = usual.cleared_at(points) {
                return Ok(cleared);
            }
        }
        self.cleared_at(points)
    }

    /// The same with this distance beside the cutter.
    fn cleared_at(&self, points: &[ClPoint]) -> Result<ClearedPass, Miss> {
        let by_tilts = self.cleared_by_tilts(points);
        if by_tilts.is_ok() || !tilts_away(self.operation, self.cc) || !self.solid().cutter.ends_in_ball() {
            return by_tilts;
        }
        let both = [TurnSide::Along, TurnSide::Across].into_iter();
        let sides = || both.clone().flat_map(|side| SIDES.map(|degrees| SideTurn { side, degrees }));
        let by = |stations: &Vec<usize>| sides().find_map(|side| self.by_stations(stations, side).ok());
        self.station_sets().iter().find_map(by).map_or(by_tilts, Ok)
    }

    /// Clear stations by tilts alone.
    fn cleared_by_tilts(&self, points: &[ClPoint]) -> Result<ClearedPass, Miss> {
        if tilts_away(self.operation, self.cc) {
            let side = SideTurn { side: TurnSide::Along, degrees: 0.0 };
            let mut tilt = None;
            let by =
                |stations: &Vec<usize>| self.by_stations(stations, side).map_err(|unclear| tilt = unclear.tilt).ok();
            return self.station_sets().iter().find_map(by).ok_or_else(|| self.miss_with(tilt, side));
        }
        let found = self.violations(points);
        let as_they_are = || ClearedPass { points: points.to_vec(), steepest: 0.0, side: 0.0 };
        self.miss(points, &found).map_or_else(|| Ok(as_they_are()), Err)
    }

    fn violations(&self, points: &[ClPoint]) -> Vec<Option<f64>> {
        points.iter().map(|p| self.violation(p)).collect()
    }

    /// Sets of stations at which tilts are tried: few of them, where tilts that are not clear show sooner, then all. A path through
    /// few stations is found less often.
    fn station_sets(&self) -> Vec<Vec<usize>> {
        let sparse = self.sparse();
        let all: Vec<usize> = (0..self.cc.points.len()).collect();
        if sparse.len() == all.len() { vec![all] } else { vec![sparse, all] }
    }

    /// Some of the stations, in their order: each of the others is nearer to one of them than half the radius of the ball.
    fn sparse(&self) -> Vec<usize> {
        let stations = &self.cc.points;
        let apart = 0.5 * self.solid().cutter.tip_radius();
        let mut sparse: Vec<usize> = Vec::new();
        for next in 1..stations.len() {
            let far = |last: &usize| (stations[*last].position - stations[next].position).norm() > apart;
            if sparse.last().is_none_or(far) {
                sparse.push(next - 1);
            }
        }
        sparse.extend(stations.len().checked_sub(1));
        sparse
    }

    /// Clear stations: with the least tilt that clears all of them, else with tilts that change along the pass and are clear at those of
    /// `sparse`.
    fn by_stations(&self, sparse: &[usize], side: SideTurn) -> Result<ClearedPass, Unclear> {
        let points = sparse.iter().map(|i| self.cc.points[*i]).collect();
        let cc = CcPass { label: String::new(), drive: self.cc.drive, points, path: None };
        let pass = TiltedPass { cc: &cc, ..*self };
        // The contact is on the arc of a barrel and not on its tip.
        let end = if self.on_vane() { self.solid().cutter.barrel_angle() } else { None };
        let may = |tilt: &f64| end.is_none_or(|end| *tilt > 0.0 && tilt.to_radians() < end);
        let tilts: Vec<f64> = TILTS.into_iter().filter(may).collect();
        let (mut clear, mut least): (Vec<Vec<bool>>, Option<(f64, f64)>) = (Vec::new(), None);
        for tilt in &tilts {
            let Some(tilted) = pass.tilted(|_| *tilt, side) else { return Err(Unclear { tilt: None }) };
            let mut found = pass.violations(&tilted);
            if found.iter().all(Option::is_none) {
                if sparse.len() == self.cc.points.len() {
                    return Ok(ClearedPass { points: tilted, steepest: *tilt, side: side.degrees });
                }
                let Some(points) = self.tilted(|_| *tilt, side) else {
                    return Err(Unclear { tilt: None });
                };
                let all = self.violations(&points);
                if all.iter().all(Option::is_none) {
                    return Ok(ClearedPass { points, steepest: *tilt, side: side.degrees });
                }
                found = worst_between(sparse, &all);
            }
            let violation = -found.iter().flatten().copied().fold(0.0, f64::min);
            if least.is_none_or(|(_, least)| violation < least) {
                least = Some((*tilt, violation));
            }
            clear.push(found.iter().map(Option::is_none).collect());
        }
        self.varied(sparse, &tilts, &clear, side).ok_or(Unclear { tilt: least.map(|(tilt, _)| tilt) })
    }

    /// The worst station with the same tilt everywhere, degrees.
    fn miss_with(&self, tilt: Option<f64>, side: SideTurn) -> Miss {
        let tilted = tilt.and_then(|tilt| self.tilted(|_| tilt, side)).unwrap_or_default();
        let nowhere = || Miss { station: 0, violation: f64::INFINITY, at: NOWHERE };
        self.miss(&tilted, &self.violations(&tilted)).unwrap_or_else(nowhere)
    }

    /// Clear stations with tilts that change along the pass and are clear at those of `sparse`.
    fn varied(&self, sparse: &[usize], tilts: &[f64], clear: &[Vec<bool>], side: SideTurn) -> Option<ClearedPass> {
        if sparse.len() < 2 {
            return None;
        }
        let all = lengths(&self.cc.points.iter().map(|p| p.position).collect::<Vec<_>>());
        let lengths: Vec<f64> = sparse.iter().map(|i| all[*i]).collect();
        let clear = ClearTilts { lengths: &lengths, tilts, clear };
        let mut paths = clear.smooth_paths(2.0 * self.solid().cutter.tip_radius(), &all).filter_map(|path| {
            let steepest = path.iter().copied().fold(0.0, f64::max);
            Some(ClearedPass { points: self.tilted(|i| path[i], side)?, steepest, side: side.degrees })
        });
        paths.find(|cleared| cleared.points.iter().all(|p| self.violation(p).is_none()))
    }

    /// The part of the tool that is too near, and its required distance.
    fn nearest_part(&self, miss: &Miss) -> String {
        let (solid, clearance) = (self.solid(), self.program.clearance.get());
        let body = self.obstacles.body_violation(solid, &miss.at.tip, &miss.at.axis, clearance, None).unwrap_or(0.0);
        if -body >= miss.violation {
            return format!("required clearance of shank and holder {clearance:.2} mm");
        }
        let inside = self.obstacles.cutter_inside(solid, &miss.at.tip, &miss.at.axis).unwrap_or(0.0);
        match self.side().filter(|_| -inside < miss.violation) {
            Some(side) => format!("it is the side of its cutter, with a required distance of {side:.2} mm"),
            None => "its cutter would cut in".to_owned(),
        }
    }
}
