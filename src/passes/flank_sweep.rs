//! The axis path of one band by `method minimax`: within the bounds of the contracts, and of those paths the one with
//! the least motion of the rotary axes.

use crate::analysis::flank::{Band, Placed};
use crate::contract::{ContractKind, SurfaceClass};
use crate::envelope::{Measured, Target, ease, least_squares, minimax};
use crate::geom::DualCurve;
use crate::ir::design::SurfaceKind;
use crate::ir::{OperationId, Program, Side};
use crate::kin::inverse;
use crate::method::{Conflict, ErrorSide, Flank};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// A bound is kept to this much, mm: what easing may overstep.
const SLACK: f64 = 1e-4;

/// What the plan keeps from each bound of a contract beside the chord tolerance and [`SLACK`], mm, so that the proof
/// between samples has room.
const RESERVE: f64 = 1e-4;

/// Gain of a step of minimax, as a share, to stop at.
const GAIN: f64 = 2e-3;

/// Times that points which were broken between the others join them.
const EXCHANGES: usize = 5;

/// Steps of easing, first and after each exchange.
const EASING: [usize; 2] = [14, 2];

/// Weight of accelerations against speeds in the motion of the rotary axes, as a length of way, mm.
const REACH: f64 = 3.0;

/// The axis path of a band.
#[derive(Clone, Debug)]
pub(super) struct Sweep {
    /// Path of the tip, and of a point of the axis further up.
    pub(super) path: DualCurve,
    /// Contacts on the lower edge of the band: parameter of the path, (u, v) of the face; ascending.
    pub(super) contacts: Vec<(f64, [f64; 2])>,
    /// Tip at the far ends of both leads.
    pub(super) leads: [Point3<f64>; 2],
    /// Deepest gouge and largest excess of the planned path, mm, on points twice as dense as those of the search.
    pub(super) error: [f64; 2],
    /// Shares of the height of the face between which the band lies.
    pub(super) span: [f64; 2],
    /// By how much the bounds had to give way, mm; zero where they are kept.
    pub(super) lacks: f64,
}

/// Bounds of gouge and excess on a surface, mm.
#[derive(Clone, Copy)]
struct Bounds {
    gouge: Option<f64>,
    excess: Option<f64>,
}

/// The bounds of the contracts on a surface that count for an operation.
fn bounds(program: &Program, operation: OperationId, class: SurfaceClass) -> Bounds {
    let counts = |operations: &[OperationId], surfaces: &[SurfaceClass]| {
        (operations.is_empty() || operations.contains(&operation)) && (surfaces.is_empty() || surfaces.contains(&class))
    };
    let least = |kind: ContractKind| {
        let left = program.allowed.iter().any(|a| a.kind == kind && counts(&a.scope.operations, &a.scope.surfaces));
        let asked = program.contracts.iter().filter(|c| c.kind == kind);
        let asked = asked.filter(|c| counts(&c.scope.operations, &c.scope.surfaces)).map(|c| c.bound.value());
        asked.reduce(f64::min).filter(|_| !left)
    };
    Bounds { gouge: least(ContractKind::Gouge), excess: least(ContractKind::Excess) }
}

/// What a band is optimised for.
pub(super) struct Task<'a> {
    pub(super) program: &'a Program,
    pub(super) operation: OperationId,
    pub(super) choices: Flank,
}

impl Task<'_> {
    /// Deviations that the contracts leave to the plan on a surface; `None` where they do not say both.
    pub(super) fn room(&self, kind: SurfaceKind, side: Side) -> Option<[f64; 2]> {
        let class = match kind {
            SurfaceKind::Face(_) if side == Side::Pressure => SurfaceClass::Pressure,
            SurfaceKind::Face(_) => SurfaceClass::Suction,
            SurfaceKind::Fillet(_) => SurfaceClass::Fillet,
            _ => SurfaceClass::Hub,
        };
        let bounds = bounds(self.program, self.operation, class);
        let kept = self.program.tolerances.chord.get() + SLACK + RESERVE;
        let gouge = match self.choices.side {
            ErrorSide::Both => bounds.gouge? - kept,
            ErrorSide::Excess => -kept,
        };
        let excess = bounds.excess? - kept;
        // Bounds closer together than what is kept of them leave the middle.
        let middle = 0.5 * (excess - gouge).min(0.0);
        Some([gouge + middle, excess - middle])
    }

    /// Optimises a band. `None` where the cutter finds no place to start from.
    pub(super) fn sweep(&self, band: &Band<'_>) -> Option<Sweep> {
        let tool = band.tool();
        let start = band.start()?;
        let coarse = band.near(&start, band.targets(1.0), |p| p.target);
        let fine = band.targets(2.0);
        let plain = |placed: &[Placed]| placed.iter().map(|p| p.target).collect::<Vec<Target>>();
        let start = least_squares(&start, &tool, &plain(&coarse));
        let face = SurfaceKind::Face(band.side);
        // Without contracts, the least error there is.
        let least = self.room(face, band.side).is_none().then(|| {
            let best = minimax(&start, &tool, &plain(&coarse), GAIN);
            let even = best.widening + SLACK;
            (best.curve, if self.choices.side == ErrorSide::Both { [even; 2] } else { [0.0, 2.0 * even] })
        });
        let bounded = |placed: &Placed| {
            let [below, above] = match &least {
                Some((_, room)) => *room,
                None => self.room(placed.kind, band.side).or_else(|| self.room(face, band.side)).unwrap_or([0.0; 2]),
            };
            // The neighbouring vane keeps its distance whatever the contracts say.
            let target = if placed.target.low > 0.0 { placed.target } else { placed.target.widened(below, above) };
            self.giving(target, placed, band)
        };
        let mut targets: Vec<Target> = coarse.iter().map(bounded).collect();
        let all: Vec<Target> = fine.iter().map(bounded).collect();
        let mut path = least.as_ref().map_or(start, |l| l.0.clone());
        let mut lacks = 0.0;
        for round in 0..EXCHANGES {
            let best = minimax(&self.guarded(path, band, &targets), &tool, &targets, GAIN);
            lacks = best.widening;
            let give = |t: &Target| t.widened(lacks * t.give[0], lacks * t.give[1]);
            let widened: Vec<Target> = targets.iter().map(give).collect();
            path = ease(&best.curve, &tool, &widened, &rotary, REACH, SLACK, EASING[usize::from(round > 0)]).curve;
            let measured = Measured::new(&path, &tool, &all);
            let over = |i: usize| {
                let (d, t) = (&measured.at[i], give(&all[i]));
                (t.low - d.value).max(d.value - t.high)
            };
            let broken: Vec<Target> = (0..all.len()).filter(|i| over(*i) > 1.5 * SLACK).map(|i| all[i]).collect();
            if broken.is_empty() {
                break;
            }
            targets.extend(broken);
        }
        let exact = plain(&fine);
        let measured = Measured::new(&path, &tool, &exact);
        let lowest = fine.iter().filter(|p| p.kind == face).map(|p| p.height);
        let edge = band.span[0];
        // The row of targets nearest to the lower edge from above.
        let row = lowest.filter(|h| *h >= edge - 1e-9).fold(1.0, f64::min);
        let mut contacts: Vec<(f64, [f64; 2])> = fine
            .iter()
            .zip(&measured.at)
            .filter(|(p, _)| p.kind == face && (p.height - row).abs() < 1e-9)
            .map(|(p, d)| (d.t, p.parameters))
            .collect();
        contacts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let error = measured.lack(&exact);
        let operation = &self.program.operations[self.operation];
        let length = [operation.lead_in.get(), operation.lead_out.get()];
        let directions = leads(band, &path, length, &all);
        let leads = [0, 1].map(|end| path.at(end as f64).lower + directions[end] * length[end]);
        Some(Sweep { path, contacts, leads, error, span: band.span, lacks })
    }

    /// Shares in which the bounds of a target give way.
    fn giving(&self, target: Target, placed: &Placed, band: &Band<'_>) -> Target {
        /// Share of a band's edge that the tool is to touch.
        const HELD: f64 = 0.02;
        match self.choices.conflict {
            Conflict::Balance => target,
            Conflict::GougeFree => Target { give: [0.0, 1.0], ..target },
            Conflict::ContactBoth => {
                let held = placed.kind == SurfaceKind::Face(band.side)
                    && band.span.iter().any(|edge| (placed.height - edge).abs() < 1e-9);
                Target { give: if held { [HELD; 2] } else { [1.0; 2] }, ..target }
            }
        }
    }

    /// A path that keeps the bounds which do not give way, from one that may not: excess is free on the way there.
    fn guarded(&self, path: DualCurve, band: &Band<'_>, targets: &[Target]) -> DualCurve {
        if self.choices.conflict != Conflict::GougeFree {
            return path;
        }
        let firm: Vec<Target> = targets.iter().map(|t| Target { high: f64::INFINITY, give: [1.0; 2], ..*t }).collect();
        minimax(&path, &band.tool(), &firm, GAIN).curve
    }
}

/// A and C of a table for a tool axis, each with its change with the axis.
fn rotary(axis: &Vector3<f64>) -> [(f64, Vector3<f64>); 2] {
    /// Below this the axis is that of C, which then is free.
    const POLE: f64 = 1e-6;
    let [(a, c), _] = inverse(axis, 0.0);
    let radial = axis.x.hypot(axis.y).max(POLE);
    let (x, y) = (axis.x / radial, axis.y / radial);
    [(a, Vector3::new(axis.z * x, axis.z * y, -radial)), (c, Vector3::new(-y, x, 0.0) / radial)]
}

/// Parameters of the face at which the tool touches at a parameter of the path, between the first and the last contact.
pub(super) fn contact(contacts: &[(f64, [f64; 2])], t: f64) -> Option<[f64; 2]> {
    let i = contacts.partition_point(|c| c.0 <= t);
    let (a, b) = (contacts.get(i.checked_sub(1)?)?, contacts.get(i)?);
    let share = (t - a.0) / (b.0 - a.0).max(f64::MIN_POSITIVE);
    Some([0, 1].map(|k| a.1[k] + (b.1[k] - a.1[k]) * share))
}

/// Directions of the leads beyond both ends of a path: on along the path, or bent away from face and hub until the tool,
/// which shifts without turning, cuts nothing there.
fn leads(band: &Band<'_>, path: &DualCurve, length: [f64; 2], targets: &[Target]) -> [Vector3<f64>; 2] {
    /// Shares of normals of face and hub that are tried, from straight on to steeply away.
    const BENDS: [[f64; 2]; 8] =
        [[0.0, 0.0], [0.05, 0.05], [0.15, 0.0], [0.0, 0.15], [0.15, 0.15], [0.4, 0.15], [0.4, 0.4], [0.8, 0.8]];
    let tool = band.tool();
    [0, 1].map(|end| {
        let (at, [lower, _]) = path.moving(end as f64);
        let away = if end == 0 { -1.0 } else { 1.0 };
        let straight = lower.try_normalize(0.0).unwrap_or_else(Vector3::zeros) * away;
        let normals = band.normals(end as f64);
        let direction = |bend: &[f64; 2]| (straight + normals[0] * bend[0] + normals[1] * bend[1]).normalize();
        let clear = |direction: &Vector3<f64>| {
            let line = [0.0, length[end]].map(|s| at.lower + direction * s);
            targets.par_iter().all(|t| {
                let distance = |s: f64| {
                    let d = t.point - (line[0] + (line[1] - line[0]) * s);
                    let height = d.dot(&at.axis);
                    tool.cutter.distance((d - at.axis * height).norm_squared().sqrt(), height)
                };
                // The end of the path is measured with it; a convex function beyond it.
                least_convex(distance) >= (t.low - SLACK).min(distance(0.0))
            })
        };
        BENDS.iter().map(direction).find(clear).unwrap_or(straight)
    })
}

/// Least value of a convex function on [0, 1].
fn least_convex(f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..24 {
        let (a, b) = (low + (high - low) * 0.45, low + (high - low) * 0.55);
        if f(a) < f(b) { high = b } else { low = a }
    }
    f(low).min(f(high))
}
