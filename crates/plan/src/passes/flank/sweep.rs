//! The axis path of one strip by `method minimax`: of all paths that keep contracts, clearance and travel, the path
//! with the least motion of the rotary axes.

use super::clearance::Clearances;
use super::strip::{Placed, Strip};
use crate::passes::context::{Obstacles, leads_at_ends};
use crate::tolerance_budget::{SLACK, budget};
use axes::envelope::target::Of;
use axes::envelope::{Deviation, Measured, Mounted, Target, ease, finest, minimax};
use base::progress::Progress;
use ir::{OperationId, Program};
use nalgebra::{Point3, Vector3};
use nurbs::DualCurve;
use rayon::prelude::*;
use wheel::method::{Conflict, ErrorSide, Flank};
use wheel::part::{FaceId, SurfaceKind};

/// Difference of heights on a face, as a share of it, that is rounding.
const SAME_HEIGHT: f64 = 1e-9;

/// Relative gain of a minimax step at which the iteration stops.
const GAIN: f64 = 2e-3;

/// Largest number of rounds in which violated points between the others join the search.
const EXCHANGES: usize = 12;

/// Steps of easing in the first rounds. In later rounds the path only returns to its bounds.
const EASING: [usize; 3] = [20, 3, 3];

/// Density of the points of the last check, relative to the spacing of the search; and the distance from a bound, mm,
/// within which a point is checked again.
const DENSE: f64 = 5.0;
const NEAR: f64 = 1e-3;

/// Number of points of the last check whose surroundings are checked more densely.
const CRESTS: usize = 30;

/// A violation below this counts as none, mm.
pub(crate) const NO_VIOLATION: f64 = 5e-5;

/// Spans of a path for a control that interpolates polynomials. On the paper's vane the rotary axes then need less time than with 11
/// cubics, and cubics of both rotary axes follow such a path with half as many spans.
const PATH_SPANS: usize = 4;

/// Places of a start through which quintics go.
const STARTS: usize = 300;

/// Largest number of rounds in which obstacles of a path join its bounds.
const CLEARANCE_ROUNDS: usize = 6;

/// Weight of accelerations against speeds in the motion of the rotary axes, as a length of path, mm.
const REACH: f64 = 3.0;

/// The axis path of a strip.
#[derive(Clone, Debug)]
pub(crate) struct StripPath {
    /// Path of the tip, and of a point of the axis further up.
    pub(crate) path: DualCurve,
    /// Contacts on the lower edge of the strip: parameter of the path, (u, v) of the face; ascending.
    pub(crate) contacts: Vec<(f64, [f64; 2])>,
    /// Tip at the far ends of both leads.
    pub(crate) leads: [Point3<f64>; 2],
    /// True where no direction of the lead clears the part; the lead then goes straight on.
    pub(crate) blocked: [bool; 2],
    /// Deepest gouge and largest excess of the planned path, mm, on points twice as dense as those of the search.
    pub(crate) error: [f64; 2],
    /// Lower and upper edge of the strip, as shares of the height of the face.
    pub(crate) span: [f64; 2],
    /// Violation of the bounds, mm; zero where the bounds are kept.
    pub(crate) violation: f64,
    /// Violation of the bounds if clearances and travel were kept as well, mm; zero where all are kept.
    pub(crate) crowded: f64,
}

/// Input of the optimisation of a strip.
pub(crate) struct StripTask<'a> {
    /// Knows whether the run was cancelled.
    pub(crate) progress: &'a Progress,
    pub(crate) program: &'a Program,
    pub(crate) operation: OperationId,
    pub(crate) choices: Flank,
    pub(crate) obstacles: &'a Obstacles,
}

/// Density of the last check of a path.
#[derive(Clone, Copy, PartialEq)]
enum LastCheck {
    /// Between the points of the search.
    Between,
    /// On crests as well, which arise where the envelope folds. A path that is shifted along itself comes near to that.
    OnCrests,
}

/// The path with the least motion within bounds.
struct BoundedPath {
    path: DualCurve,
    /// Distance by which the bounds had to give way, mm.
    violation: f64,
    /// Increase of the worst violation among constraints that were never satisfied, mm.
    increase: f64,
}

/// Points that bound a path.
struct StripPoints {
    /// Points in the constraints of the programs.
    constrained: Vec<Target>,
    /// Points among which violations are searched.
    all: Vec<Target>,
    /// Points of the last check, with their places.
    dense: Vec<(Target, Placed)>,
}

impl StripTask<'_> {
    /// The start as a few quintics, where the text has spline blocks.
    fn interpolated(&self, start: DualCurve) -> DualCurve {
        if self.program.control().spline_form().is_none() {
            return start;
        }
        let place = |i: usize| {
            let at = start.at(i as f64 / STARTS as f64);
            [at.lower, at.lower + at.axis * at.length]
        };
        let pairs: Vec<[Point3<f64>; 2]> = (0..=STARTS).map(place).collect();
        DualCurve::quintics(&pairs, PATH_SPANS).unwrap_or(start)
    }

    /// Deviations that the contracts leave to the plan on a surface.
    pub(crate) fn budget(&self, kind: SurfaceKind, side: FaceId) -> Option<[f64; 2]> {
        budget(self.program, self.operation, self.choices.side, kind, side)
    }

    /// Optimises a strip. `None` where the cutter finds no place to start from, or the run was cancelled.
    ///
    /// The first path is bounded by the part alone. It is kept where it is clear and within travel, as nearly all are; else the
    /// obstacles on it join the bounds. Where not all bounds can be kept, the first path stays, and later passes refuse it.
    /// A twisted face lets the axis tilt along it only a little: of the height of a strip with its square.
    pub(crate) fn sweep(&self, strip: &Strip<'_>) -> Option<StripPath> {
        if self.progress.is_cancelled() {
            return None;
        }
        let (start, coarse) = strip.fitted(1.0)?;
        let start = self.interpolated(start);
        let fine = strip.targets(2.0);
        let plain = |placed: &[Placed]| placed.iter().map(|p| p.target).collect::<Vec<Target>>();
        let face = SurfaceKind::Face(strip.side);
        // Without contracts, the least error there is.
        let least = self.budget(face, strip.side).is_none().then(|| {
            let best = finest(&start, &strip.tool(), &plain(&coarse), &plain(&fine), GAIN).best;
            let even = best.widening + SLACK;
            (best.curve, if self.choices.side == ErrorSide::Both { [even; 2] } else { [0.0, 2.0 * even] })
        });
        let bounded = |placed: &Placed| {
            let [below, above] = match &least {
                Some((_, budget)) => *budget,
                None => {
                    self.budget(placed.kind, strip.side).or_else(|| self.budget(face, strip.side)).unwrap_or([0.0; 2])
                }
            };
            // The neighbouring vane keeps its distance independently of the contracts.
            let target = if placed.target.low > 0.0 { placed.target } else { placed.target.widened(below, above) };
            self.giving(target, placed, strip)
        };
        let dense = strip.near(&start, strip.targets(DENSE), |p| p.target);
        let mut points = StripPoints {
            constrained: coarse.iter().map(bounded).collect(),
            all: fine.iter().map(bounded).collect(),
            dense: dense.iter().map(|p| (bounded(p), *p)).collect(),
        };
        let clearances = Clearances::new(self.program, self.operation, self.obstacles);
        let tool = Mounted { body: clearances.body(), ..strip.tool() };
        let start = least.clone().map_or(start, |l| l.0);
        let BoundedPath { path, violation, .. } =
            self.within_bounds(start, strip, &tool, &bounded, &mut points, LastCheck::Between);
        let mut clear = || {
            self.cleared(&path, &clearances, |path, near| {
                points.constrained.extend(near);
                points.all.extend(near);
                self.within_bounds(path, strip, &tool, &bounded, &mut points, LastCheck::OnCrests)
            })
        };
        let (path, crowded) = match if violation > NO_VIOLATION { Ok(path.clone()) } else { clear() } {
            Ok(path) => (path, 0.0),
            Err(crowded) => (path, crowded),
        };
        let exact = plain(&fine);
        let measured = Measured::new(&path, &tool, &exact);
        let lowest = fine.iter().filter(|p| p.kind == face).map(|p| p.at[1]);
        let edge = strip.span[0];
        // The row of targets nearest to the lower edge, on its upper side.
        let row = lowest.filter(|h| *h >= edge - SAME_HEIGHT).fold(1.0, f64::min);
        let mut contacts: Vec<(f64, [f64; 2])> = fine
            .iter()
            .zip(&measured.at)
            .filter(|(p, _)| p.kind == face && (p.at[1] - row).abs() < SAME_HEIGHT)
            .map(|(p, d)| (d.t, p.parameters))
            .collect();
        contacts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let error = measured.violation(&exact);
        let operation = &self.program.operations[self.operation];
        let length = leads_at_ends(&self.program.part, operation, strip.side, self.choices.milling);
        let (directions, blocked) = leads(strip, &path, length, &points.all, &clearances);
        let leads = [0, 1].map(|end| path.at(end as f64).lower + directions[end] * length[end]);
        Some(StripPath { path, contacts, leads, blocked, error, span: strip.span, violation, crowded })
    }

    /// A path near `path` that keeps shank, holder and travel within their limits; else the violation, mm. `within`
    /// finds a path from another path and additional bounds.
    fn cleared(
        &self,
        path: &DualCurve,
        clearances: &Clearances<'_>,
        mut within: impl FnMut(DualCurve, &[Target]) -> BoundedPath,
    ) -> Result<DualCurve, f64> {
        let mut path = path.clone();
        let mut violation = 0.0;
        for _ in 0..CLEARANCE_ROUNDS {
            if self.progress.is_cancelled() {
                break;
            }
            let found = clearances.found(&path);
            if found.kept {
                return Ok(path);
            }
            let next = within(path, &found.near);
            (path, violation) = (next.path, next.violation.max(next.increase));
            if violation > NO_VIOLATION {
                break;
            }
        }
        Err(violation.max(NO_VIOLATION))
    }

    /// The path with the least motion that keeps the bounds of all points.
    fn within_bounds(
        &self,
        mut path: DualCurve,
        strip: &Strip<'_>,
        tool: &Mounted<'_>,
        bounded: &impl Fn(&Placed) -> Target,
        points: &mut StripPoints,
        check: LastCheck,
    ) -> BoundedPath {
        let mut violation = 0.0;
        let mut broken = Vec::new();
        for round in 0..EXCHANGES {
            if self.progress.is_cancelled() {
                break;
            }
            let guarded = self.guarded(path, tool, &points.constrained);
            let mut best = minimax(&guarded, tool, &points.constrained, GAIN);
            if round == 0 && best.widening > NO_VIOLATION {
                // Finer knots may achieve what more strips would.
                (best, points.constrained) = {
                    let found = finest(&guarded, tool, &points.constrained, &points.all, GAIN);
                    (found.best, found.targets)
                };
            }
            violation = best.widening;
            let give = |t: &Target| t.widened(violation * t.give[0], violation * t.give[1]);
            path = match EASING.get(round) {
                Some(steps) => {
                    let chain = &self.program.machine.chain;
                    let widened: Vec<Target> = points.constrained.iter().map(give).collect();
                    ease(&best.curve, tool, &widened, &|axis| chain.gradients(axis), REACH, SLACK, *steps).curve
                }
                None => best.curve,
            };
            let violation = |d: &Deviation, t: &Target| (give(t).low - d.value).max(d.value - give(t).high);
            let broken_of = |among: &[Target]| -> Vec<Target> {
                let measured = Measured::new(&path, tool, among);
                let broken = measured.at.iter().zip(among).filter(|(d, t)| violation(d, t) > 1.5 * SLACK);
                broken.map(|x| *x.1).collect()
            };
            broken = broken_of(&points.all);
            if broken.is_empty() {
                // Easing violates bounds between the points, most of all at both ends.
                let dense: Vec<Target> = points.dense.iter().map(|p| p.0).collect();
                let measured = Measured::new(&path, tool, &dense);
                let mut near: Vec<(f64, &(Target, Placed))> =
                    measured.at.iter().zip(&points.dense).map(|(d, p)| (violation(d, &p.0), p)).collect();
                near.retain(|x| x.0 > -NEAR);
                near.sort_by(|a, b| b.0.total_cmp(&a.0));
                let crests: Vec<Placed> = near.iter().take(CRESTS).map(|x| x.1.1).collect();
                let mut finer: Vec<Target> = near.iter().map(|x| x.1.0).collect();
                if check == LastCheck::OnCrests {
                    finer.extend(strip.about(&crests, DENSE).iter().map(bounded));
                }
                broken = broken_of(&finer);
                points.all.extend(near.iter().map(|x| x.1.0));
                points.all.extend(&broken);
            }
            if broken.is_empty() {
                break;
            }
            points.constrained.extend(&broken);
        }
        let increase = Measured::new(&path, tool, &broken).widening(&broken) - violation;
        BoundedPath { path, violation, increase: increase.max(0.0) }
    }

    /// Sets the shares by which the bounds of a target may give way.
    fn giving(&self, target: Target, placed: &Placed, strip: &Strip<'_>) -> Target {
        /// Share for points on the edges of a strip, which the tool is to touch.
        const HELD: f64 = 0.02;
        match self.choices.conflict {
            Conflict::Balance => target,
            Conflict::GougeFree => Target { give: [0.0, 1.0], ..target },
            Conflict::ContactBoth => {
                let held = placed.kind == SurfaceKind::Face(strip.side)
                    && strip.span.iter().any(|edge| (placed.at[1] - edge).abs() < SAME_HEIGHT);
                Target { give: if held { [HELD; 2] } else { [1.0; 2] }, ..target }
            }
        }
    }

    /// A path that keeps the bounds which may not give way, from a path that may violate them. Excess is unlimited
    /// here.
    fn guarded(&self, path: DualCurve, tool: &Mounted<'_>, targets: &[Target]) -> DualCurve {
        if self.choices.conflict != Conflict::GougeFree {
            return path;
        }
        let firm: Vec<Target> = targets.iter().map(|t| Target { high: f64::INFINITY, give: [1.0; 2], ..*t }).collect();
        minimax(&path, tool, &firm, GAIN).curve
    }
}

/// Parameters of the face at which the tool touches at a parameter of the path, between the first and the last contact.
pub(crate) fn contact(contacts: &[(f64, [f64; 2])], t: f64) -> Option<[f64; 2]> {
    let i = contacts.partition_point(|c| c.0 <= t);
    let (a, b) = (contacts.get(i.checked_sub(1)?)?, contacts.get(i)?);
    let share = (t - a.0) / (b.0 - a.0).max(f64::MIN_POSITIVE);
    Some([0, 1].map(|k| a.1[k] + (b.1[k] - a.1[k]) * share))
}

/// Directions of the leads beyond both ends of a path: straight on, or inclined away from face and hub until the tool,
/// which moves without turning, cuts nothing on the lead and is clear. The flag is true where no direction succeeds.
fn leads(
    strip: &Strip<'_>,
    path: &DualCurve,
    length: [f64; 2],
    targets: &[Target],
    clearances: &Clearances<'_>,
) -> ([Vector3<f64>; 2], [bool; 2]) {
    /// Shares of the normals of face and hub that are tried, from straight on to steeply away.
    const LEAD_SLOPES: [[f64; 2]; 8] =
        [[0.0, 0.0], [0.05, 0.05], [0.15, 0.0], [0.0, 0.15], [0.15, 0.15], [0.4, 0.15], [0.4, 0.4], [0.8, 0.8]];
    let tool = strip.tool();
    let found = [0, 1].map(|end| {
        let (at, [lower, _]) = path.moving(end as f64);
        let away = if end == 0 { -1.0 } else { 1.0 };
        let straight = lower.try_normalize(0.0).unwrap_or_else(Vector3::zeros) * away;
        let normals = strip.normals(end as f64);
        let direction = |slopes: &[f64; 2]| (straight + normals[0] * slopes[0] + normals[1] * slopes[1]).normalize();
        let clear = |direction: &Vector3<f64>| {
            let line = [0.0, length[end]].map(|s| at.lower + direction * s);
            let of_cutter = targets.par_iter().filter(|t| t.of == Of::Cutter);
            let cuts_nothing = of_cutter.all(|t| {
                let distance = |s: f64| {
                    let d = t.point - (line[0] + (line[1] - line[0]) * s);
                    let height = d.dot(&at.axis);
                    tool.cutter.distance((d - at.axis * height).norm_squared().sqrt(), height)
                };
                // The path itself already bounds its end; the distance along the lead is convex.
                least_convex(distance) >= (t.low - SLACK).min(distance(0.0))
            });
            cuts_nothing && clearances.kept_on(&line, &at.axis)
        };
        LEAD_SLOPES.iter().map(direction).find(clear).ok_or(straight)
    });
    (found.map(|d| d.unwrap_or_else(|straight| straight)), found.map(|d| d.is_err()))
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
