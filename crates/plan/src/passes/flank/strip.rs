//! The problem of one strip of a face: the requirements of flank milling at points of the part, the start of the
//! optimisation, and the least error of a number of strips.

use crate::passes::context::SIDE_CLEARANCE;
use axes::envelope::{Deviation, Measured, Mounted, Target, best_least_squares, minimax};
use base::progress::Progress;
use base::units::Mm;
use five_axis::Pose;
use nalgebra::{Point3, Vector3};
use nurbs::DualCurve;
use nurbs::bracket::Bracket;
use rayon::prelude::*;
use tool_stock::collide::Cutter;
use wheel::part::{
    FaceId, Fillet, Part, Passage, Surface, SurfaceKind,
    chart::{self, Chart, Shape},
    hub_normal,
};

/// Difference of radii (mm) or of shares of the height that is rounding.
const ROUNDING: f64 = 1e-9;

/// Least error that is divided by, mm.
const MIN_ERROR_MM: f64 = 1e-6;

/// Control points of a guide curve: 14 are enough for the paper's vane (algorithms reference, 1.4).
pub const CONTROL: usize = 14;

/// Distance beyond inlet and outlet, in cutter radii, up to which a pass follows the continued face. Beyond this
/// distance, a shift at less than 45 deg to the tangents only moves the tool away from the edge.
pub const LEAVE: f64 = 1.0;

/// The same distance where the path beyond the edges is free and may deviate further from the tangents.
const LEAVE_FREE: f64 = 1.5;

/// Columns and rows of targets on the milled face; the other surfaces follow.
const FACE: [usize; 2] = [100, 15];
const FILLET: [usize; 2] = [100, 8];
const HUB: [usize; 2] = [60, 16];
const NEIGHBOUR: [usize; 2] = [30, 8];

/// Height between the lower edge and the top of a strip of the point whose offset is on the axis of a start, and the same of further
/// starts, as shares.
const AIM: f64 = 0.85;
const FURTHER_AIMS: [f64; 2] = [0.6, 1.0];

/// A part with the charts of its surfaces, computed once.
pub struct Surroundings<'a> {
    part: &'a Part,
    charts: Vec<Chart<'a>>,
    /// Cancels fits; each takes some tenths of a second.
    progress: Option<&'a Progress>,
}

impl<'a> Surroundings<'a> {
    /// The charts around the vane of sector 0.
    pub fn new(part: &'a Part) -> Self {
        Self { part, charts: chart::charts(part), progress: None }
    }

    /// The same; fits find nothing after the run was cancelled.
    pub fn watched(part: &'a Part, progress: &'a Progress) -> Self {
        Self { progress: Some(progress), ..Self::new(part) }
    }

    fn is_cancelled(&self) -> bool {
        self.progress.is_some_and(Progress::is_cancelled)
    }
}

/// A strip of a face for a cutter.
pub struct Strip<'a> {
    around: &'a Surroundings<'a>,
    /// Face.
    pub side: FaceId,
    /// Lower and upper border of the strip as shares of the height of the face.
    pub span: [f64; 2],
    cutter: Cutter,
}

/// A target with its place on the design.
#[derive(Clone, Copy, Debug)]
pub struct Placed {
    /// What is required there.
    pub target: Target,
    /// Surface.
    pub kind: SurfaceKind,
    /// Parameters of the surface.
    pub parameters: [f64; 2],
    /// Coordinates in the chart, each in [0, 1]; on a face along the face, and up from its root.
    pub at: [f64; 2],
}

/// Border of a condition that is false at `from` and true at `to`, by bisection: the last place at which the condition
/// is true.
fn border(holds: impl Fn(f64) -> bool, from: f64, to: f64) -> f64 {
    Bracket { holds: to, fails: from }.halved(20, holds).holds
}

/// v at the lower end of a face at u: at the upper edge of the fillet, at a sharp root where the ball of the tool touches face and hub.
pub(crate) fn foot(part: &Part, side: FaceId, cutter: &Cutter, u: f64) -> Option<f64> {
    part.fillet_tangent(side, u, part.fillet_radius(side, u).unwrap_or_else(|| cutter.tip_radius()))
}

impl<'a> Strip<'a> {
    /// A strip.
    pub fn new(around: &'a Surroundings<'a>, side: FaceId, span: [f64; 2], cutter: Cutter) -> Self {
        Self { around, side, span, cutter }
    }

    /// The cutter on the curves: the lower curve is the path of the tip.
    pub fn tool(&self) -> Mounted<'static> {
        Mounted { cutter: self.cutter, height: 0.0, body: &[] }
    }

    /// True when this pass also makes the fillet: the ball of the cutter has the radius of the fillet.
    fn makes_fillet(&self) -> bool {
        let same = |f: Mm| (f.get() - self.cutter.tip_radius()).abs() < ROUNDING;
        self.span[0] == 0.0 && self.around.part.fillet(self.side).and_then(Fillet::constant).is_some_and(same)
    }

    /// Requirements of the pass: it touches its strip, cuts nothing else and keeps clear of the neighbouring vane.
    /// `fineness` divides the spacing of the points; at a fineness of one, points of the face are some 0.5 mm apart
    /// along a vane of 50 mm.
    pub fn targets(&self, fineness: f64) -> Vec<Placed> {
        let first = self.around.part.looks_ahead(self.side);
        let mut out = Vec::new();
        for chart in self.around.charts.iter().filter(|chart| self.is_near(chart.kind)) {
            let [columns, rows] = self.counts(chart.kind).map(|n| (n as f64 * fineness).round().max(2.0) as usize);
            let mut add = |x: f64, y: f64| out.push(self.placed(chart, x, y));
            let goes_on = chart.kind == SurfaceKind::Fillet(self.side);
            let milled = |x: f64, y: f64| chart.is_milled([x, y], &chart.place(x, y).position);
            let mut heights: Vec<f64> = (0..=rows).map(|j| j as f64 / rows as f64).collect();
            if matches!(chart.kind, SurfaceKind::Hub(_)) {
                // The points are densest where the ball leaves the hub: the ball has a curvature of its own there.
                let from_wall = heights.iter().map(|y| 0.6 * y * y);
                heights = if first { from_wall.collect() } else { from_wall.map(|y| 1.0 - y).collect() };
            }
            if chart.kind == SurfaceKind::Face(self.side) {
                // At the border of two strips, the ball leaves the face within a few tenths of a millimetre.
                const BORDER_OFFSETS: [f64; 7] = [-0.05, -0.025, -0.01, 0.0, 0.01, 0.025, 0.05];
                let inner = self.span.iter().filter(|e| **e > 0.0 && **e < 1.0);
                heights.extend(inner.flat_map(|e| BORDER_OFFSETS.iter().map(move |b| e + b)));
            }
            for y in heights {
                let mut before = None;
                for i in 0..=columns {
                    let x = i as f64 / columns as f64;
                    let now = milled(x, y);
                    if before.is_some_and(|b| b != now) {
                        let last = x - 1.0 / columns as f64;
                        let ends = if now { (last, x) } else { (x, last) };
                        add(border(|x| milled(x, y), ends.0, ends.1), y);
                    }
                    if now || goes_on {
                        add(x, y);
                    }
                    before = Some(now);
                }
            }
        }
        out
    }

    /// The passage in front of the face, and the side of the face: 0 for its clockwise wall.
    fn passage(&self) -> (Passage, usize) {
        let (id, wall) = self.around.part.passage_of(self.side);
        (self.around.part.passage(id), wall)
    }

    /// True for the face and its fillet, and for the floor and the opposite blade of its passage.
    fn is_near(&self, kind: SurfaceKind) -> bool {
        let (passage, wall) = self.passage();
        let opposite = passage.walls[1 - wall].blade;
        match kind {
            SurfaceKind::Face(id) | SurfaceKind::Fillet(id) => id == self.side || id.blade == opposite,
            SurfaceKind::Hub(id) => id == passage.id,
            _ => false,
        }
    }

    /// Columns and rows of targets of a surface at a fineness of one.
    fn counts(&self, kind: SurfaceKind) -> [usize; 2] {
        match kind {
            SurfaceKind::Face(side) if side == self.side => FACE,
            SurfaceKind::Fillet(side) if side == self.side => FILLET,
            SurfaceKind::Hub(_) => HUB,
            _ => NEIGHBOUR,
        }
    }

    /// Requirement of the pass at a place of a chart.
    fn placed(&self, chart: &Chart<'_>, x: f64, y: f64) -> Placed {
        let part = self.around.part;
        let (passage, wall) = self.passage();
        // Sectors to the passage in front of this face, and to the opposite blade.
        let behind = (part.vane_count - passage.sectors) % part.vane_count;
        let (to_channel, to_vane) = if wall == 0 { (0, passage.sectors) } else { (behind, behind) };
        let [low, high] = self.span;
        let place = chart.place(x, y);
        // At a sharp root the ball reaches down only to its contact with the hub.
        let reached = || {
            let touches_face = part.fillet(self.side).is_none() && chart.kind == SurfaceKind::Face(self.side);
            touches_face.then(|| part.fillet_tangent(self.side, x, self.cutter.tip_radius())).flatten()
        };
        let touched = |touches_face: bool| match touches_face {
            true => Target::touched(place.position),
            false => Target::clear(place.position, 0.0),
        };
        let target = match chart.kind {
            SurfaceKind::Face(side) if side == self.side => {
                let in_band = (low - ROUNDING..=high + ROUNDING).contains(&y);
                touched(in_band && reached().is_none_or(|v| place.parameters[1] >= v))
            }
            // The targets continue beyond the part, so that the pass is as smooth at its ends as in the middle.
            SurfaceKind::Fillet(side) if side == self.side => {
                touched(self.makes_fillet() && chart.is_milled([x, y], &place.position))
            }
            SurfaceKind::Hub(_) => Target::clear(part.sector_rotation(to_channel) * place.position, 0.0),
            _ => Target::clear(part.sector_rotation(to_vane) * place.position, SIDE_CLEARANCE),
        };
        Placed { target, kind: chart.kind, parameters: place.parameters, at: [x, y] }
    }

    /// Points around those of `placed` that lie on the face and its fillet, five times as dense as at this fineness.
    pub fn about(&self, placed: &[Placed], fineness: f64) -> Vec<Placed> {
        const DENSER: i32 = 5;
        let [face, fillet] = [SurfaceKind::Face(self.side), SurfaceKind::Fillet(self.side)];
        let offsets = || (-DENSER..=DENSER).flat_map(|i| (-DENSER..=DENSER).map(move |j| [i, j]));
        let mut out = Vec::new();
        for chart in self.around.charts.iter().filter(|c| c.kind == face || c.kind == fillet) {
            let step = self.counts(chart.kind).map(|n| 1.0 / (n as f64 * fineness * f64::from(DENSER)));
            let moved = |at: f64, k: i32, step: f64| (at + f64::from(k) * step).clamp(0.0, 1.0);
            for p in placed.iter().filter(|p| p.kind == chart.kind) {
                let about = offsets().map(|[i, j]| [moved(p.at[0], i, step[0]), moved(p.at[1], j, step[1])]);
                let points = about.map(|[x, y]| self.placed(chart, x, y));
                out.extend(points.filter(|p| chart.kind == fillet || chart.is_milled(p.at, &p.target.point)));
            }
        }
        out
    }

    /// The targets that a path near `start` may touch or cut.
    pub fn near<T>(&self, start: &DualCurve, placed: Vec<T>, target: impl Fn(&T) -> Target) -> Vec<T> {
        /// Upper bound of the deviation of a path from its start, mm.
        const FAR: f64 = 2.0;
        let targets: Vec<Target> = placed.iter().map(&target).collect();
        let measured = Measured::new(start, &self.tool(), &targets);
        let near = |(d, t): (&Deviation, &Target)| t.high.is_finite() || d.value - t.low < FAR;
        let keep: Vec<bool> = measured.at.iter().zip(&targets).map(near).collect();
        placed.into_iter().zip(keep).filter(|(_, keep)| *keep).map(|(p, _)| p).collect()
    }

    /// Parameters u at which a pass begins and ends: the cutter is clear of inlet and outlet there.
    pub fn extent(&self) -> [f64; 2] {
        let beyond = LEAVE_FREE * self.cutter.tip_radius().max(self.cutter.widest_below(self.cutter.tip_radius()));
        let part = self.around.part;
        [-part.root_step(self.side, 0.0, beyond), 1.0 + part.root_step(self.side, 1.0, beyond)]
    }

    /// Normals of the face and of the hub at the root of the face, at its inlet (u = 0) or outlet (1) end.
    pub fn normals(&self, u: f64) -> [Vector3<f64>; 2] {
        let face = self.around.part.face(self.side);
        [face.normal(u, 0.0), hub_normal(self.around.part, &face.surface.point(u, 0.0))]
    }

    /// The start of the optimisation, with the points that a path near it may touch; `fineness` is that of [`Self::targets`].
    /// `None` where no ball rolls along the root.
    pub fn fitted(&self, fineness: f64) -> Option<(DualCurve, Vec<Placed>)> {
        let targets = self.targets(fineness);
        let starts = self.starts();
        let near = starts.iter().map(|start| self.near(start, targets.clone(), |p| p.target));
        let mut near: Vec<Vec<Placed>> = near.collect();
        let each = starts.iter().zip(&near).map(|(start, near)| (start, near.iter().map(|p| p.target).collect()));
        // A fit takes a tenth of a second; a cancelled run needs no best one.
        let each = each.take_while(|_| !self.around.is_cancelled());
        let (chosen, fit) = best_least_squares(each, &self.tool())?;
        Some((fit, near.swap_remove(chosen)))
    }

    /// Starts of the optimisation: with axes through several heights of the strip. Over a low strip such an axis may tilt into a hollow
    /// or twisted face above the strip; the last start has the tilt of the whole face.
    fn starts(&self) -> Vec<DualCurve> {
        let top = self.span[1];
        let mut aims = vec![(AIM, top)];
        // The start of a barrel aims at no height.
        if self.cutter.barrel_arc().is_none() {
            aims.extend(FURTHER_AIMS.map(|share| (share, top)));
            aims.extend((top < 1.0).then_some((AIM, 1.0)));
        }
        aims.into_iter().filter_map(|(share, top)| self.start_below(share, top)).collect()
    }

    /// A start: the cutter rolls between face and hub, or stands on the lower edge of the strip. Its axis goes through the
    /// offset of a point at a share of the height up to `top`, which is a share of the height of the face; the arc of a barrel
    /// touches the middle of the strip.
    fn start_below(&self, share: f64, top: f64) -> Option<DualCurve> {
        /// Number of points to which the curves are fitted.
        const POINTS: usize = 300;
        let part = self.around.part;
        let face = part.face(self.side);
        let length =
            (0..=8).map(|i| f64::from(i) / 8.0).map(|u| face.surface.point(u, 1.0) - face.surface.point(u, 0.0));
        let length = length.map(|r| r.norm_squared().sqrt()).fold(0.0, f64::max);
        let touches = self.cutter.tip_radius();
        let radius = |height: f64| self.cutter.radius_at(height.max(ROUNDING));
        let [low, high] = self.span;
        let [from, to] = self.extent();
        let pairs: Option<Vec<[Point3<f64>; 2]>> = (0..=POINTS)
            .map(|i| {
                let u = from + (to - from) * i as f64 / POINTS as f64;
                let root = foot(part, self.side, &self.cutter, u)?;
                let at = |height: f64| root + (1.0 - root) * height;
                let Pose { tip, axis } = if self.cutter.barrel_arc().is_some() {
                    self.on_its_arc(u, at(0.5 * (low + high)), root)?
                } else {
                    let offset = |v: f64, by: f64| face.surface.point(u, v) + face.normal(u, v) * by;
                    let upper = at(low + share * (top - low));
                    let below = offset(at(low), radius(touches));
                    let between = (face.surface.point(u, upper) - face.surface.point(u, at(low))).norm_squared().sqrt();
                    let axis = (offset(upper, radius(touches + between)) - below).normalize();
                    Pose { tip: below - axis * touches, axis }
                };
                Some([tip, tip + axis * length])
            })
            .collect();
        DualCurve::through(&pairs?, CONTROL)
    }

    /// Tip and axis of a barrel whose arc touches a point of the face, as high over the tip as the hub allows.
    fn on_its_arc(&self, u: f64, v: f64, root: f64) -> Option<Pose> {
        let face = self.around.part.face(self.side);
        let (point, normal) = (face.surface.point(u, v), face.normal(u, v));
        let up = point - face.surface.point(u, root);
        let lowest = self.cutter.profile_at(self.cutter.barrel_angle()?)?.s;
        let arc = self.cutter.barrel_arc()?;
        let height = (up.norm_squared().sqrt() + self.cutter.tip_radius()).clamp(lowest, arc.height);
        let angle = libm::asin((arc.height - height) / arc.radius);
        let along = face.surface.ruling(u);
        let along = (along - normal * along.dot(&normal)).normalize();
        let axis = along * libm::cos(angle) + normal * libm::sin(angle);
        // Towards the face, perpendicular to the axis.
        let towards = normal * -libm::cos(angle) + along * libm::sin(angle);
        Some(Pose { tip: point - towards * self.cutter.radius_at(height) - axis * height, axis })
    }

    /// The least possible largest error of this strip: gouge and excess are equal, and nothing else is cut deeper.
    /// `None` where there is no start.
    pub fn least_error(&self) -> Option<WorstError> {
        /// More points are not needed for errors to a few per cent.
        const FINENESS: f64 = 0.6;
        const GAIN: f64 = 0.02;
        if self.around.is_cancelled() {
            return None;
        }
        let (fit, placed) = self.fitted(FINENESS)?;
        if self.around.is_cancelled() {
            return None;
        }
        let targets: Vec<Target> = placed.iter().map(|p| p.target).collect();
        let best = minimax(&fit, &self.tool(), &targets, GAIN);
        let violation = |(p, d): (&Placed, &Deviation)| ((p.target.low - d.value).max(d.value - p.target.high), *p);
        let violations = placed.iter().zip(&best.measured.at).map(violation);
        let (error, placed) = violations.max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(WorstError { error: error.max(0.0), placed })
    }
}

/// The largest error of a strip.
#[derive(Clone, Copy, Debug)]
pub struct WorstError {
    /// Size of the error, mm.
    pub error: f64,
    /// A place with this error; other places have the same error.
    pub placed: Placed,
}

/// Strips of a face from the root, with the least error of each; their heights make the errors as equal as possible.
/// The error of a strip grows with the cube of its height (algorithms reference, 1.2). The lowest strip has to fit the
/// floor as well, so that equal heights are not the best; `rounds` iterations equalise the errors. `None` where no ball
/// rolls along the root.
pub fn strips_of<'a>(
    around: &'a Surroundings<'a>,
    side: FaceId,
    strips: u32,
    cutter: Cutter,
    rounds: usize,
) -> Option<Vec<(Strip<'a>, WorstError)>> {
    let measured = |borders: &[f64]| -> Option<Vec<(Strip<'a>, WorstError)>> {
        let spans = borders.par_windows(2).map(|b| Strip::new(around, side, [b[0], b[1]], cutter));
        spans.map(|strip| strip.least_error().map(|found| (strip, found))).collect()
    };
    let even: Vec<f64> = (0..=strips).map(|k| f64::from(k) / f64::from(strips)).collect();
    let first = measured(&even)?;
    if strips < 2 {
        return Some(first);
    }
    let mut best = first;
    for _ in 0..rounds {
        // Heights that make all errors equal by the cubic law.
        let even = |(strip, w): &(Strip<'_>, WorstError)| {
            (strip.span[1] - strip.span[0]) * libm::pow(w.error.max(MIN_ERROR_MM), -1.0 / 3.0)
        };
        let heights: Vec<f64> = best.iter().map(even).collect();
        let whole: f64 = heights.iter().sum();
        let mut borders = vec![0.0];
        let mut sum = 0.0;
        for height in &heights[..heights.len() - 1] {
            sum += height / whole;
            borders.push(sum);
        }
        borders.push(1.0);
        let next = measured(&borders)?;
        let [then, now] = [&next, &best].map(|b| worst(b).map_or(0.0, |w| w.error));
        if then >= now {
            break;
        }
        best = next;
    }
    Some(best)
}

/// The largest error of some strips; `None` without strips.
pub fn worst(strips: &[(Strip<'_>, WorstError)]) -> Option<WorstError> {
    strips.iter().map(|strip| strip.1).max_by(|a, b| a.error.total_cmp(&b.error))
}

/// The least error of a face with a number of strips, after `rounds` iterations of their heights; `None` where no ball
/// rolls along the root.
pub fn least_error(
    around: &Surroundings<'_>,
    side: FaceId,
    strips: u32,
    cutter: Cutter,
    rounds: usize,
) -> Option<WorstError> {
    worst(&strips_of(around, side, strips, cutter, rounds)?)
}

/// Size of the largest cutter of the same shape that leaves at most `error` with this number of strips, as a share of
/// the size of this cutter. `None` where no cutter down to a tenth of the size does. The error is about proportional to
/// the size, so that a few trials find the size to a few per cent from below.
pub fn fitting(around: &Surroundings<'_>, side: FaceId, strips: u32, cutter: Cutter, error: f64) -> Option<f64> {
    const TRIALS: usize = 5;
    const SMALLEST: f64 = 0.1;
    /// Share of the allowed error from which on the search ends.
    const NEAR: f64 = 0.95;
    let mut fits: Option<f64> = None;
    let mut share = 1.0;
    for _ in 0..TRIALS {
        let Some(found) = least_error(around, side, strips, cutter.scaled(share), 1) else { break };
        let good = found.error <= error;
        if good {
            fits = Some(fits.map_or(share, |f| f.max(share)));
        }
        if good && (found.error > NEAR * error || share >= 1.0) {
            break;
        }
        // Aims a little below the bound; never up to what was too large.
        let aimed = share * (0.98 * error / found.error.max(ROUNDING)).clamp(0.2, 1.5);
        share = aimed.min(1.0);
        if share < SMALLEST {
            break;
        }
    }
    fits
}
