//! Lower bounds of the distance to a cutter swept over a piece of motion, for a whole cell of a surface.
//!
//! Let F(p, t) be the distance of a point p to the cutter at the share t of a piece, and q(p, t) the point in the frame
//! of the tool. The distance is convex in q. q is linear in p and t, apart from its second derivative, which the turn
//! of the piece bounds. Apart from this second derivative F is therefore convex in (p, t):
//!
//! - *below*, F lies above its tangent at any (p*, t*). At the joint minimum over cell and piece this tangent is level,
//!   and the bound is as sharp as the second derivative and the bulge of the cell allow ([`Sweep::below`]);
//! - *above*, F at a mean of corners and times is at most the mean of F at the corners, each at its own best time
//!   (`upper_bound.rs`). No term with the radius of the cutter occurs: the cutter follows the cell.

use super::capsule::{Ball, Capsule, Foot};
use super::cutoff::Cutoff;
use super::hull::{Hull, least_of};
use super::piece::{Piece, Spans, Touch};
use super::sweep::Sweep;
use five_axis::Pose;
use nalgebra::{Point3, Vector3};
use tool_stock::collide::tool::tool_coordinates;

/// Length of a cross product below which it has no direction: zero is a sound bound there.
const MIN_CROSS_PRODUCT: f64 = 1e-9;

/// Slope over a cell, mm, below which the tangent counts as level.
const LEVEL_SLOPE: f64 = 2e-6;

/// Rounds of the search for the joint minimum; for cylinders and balls the second round is exact.
const JOINT_MINIMUM_ROUNDS: usize = 4;

/// Loss of a bound through the second derivative of a piece above which the piece is halved, mm.
const CURVATURE_SLACK: f64 = 1e-4;

/// Distance beyond its goal up to which a bound by the curvature of a ball is evaluated, mm.
const BALL_BOUND_MARGIN: f64 = 1e-3;

/// Lower bound for a cell and a piece.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Below {
    /// No point of the cell is nearer to the cutter.
    pub(crate) bound: f64,
    /// Where the bound misses its goal: the nearest place of the cell, in half sides from the middle.
    pub(crate) nearest: Option<[f64; 2]>,
}

/// A lower bound of the distance to a cutter over an interval of a piece, for the points of a cell. It is linear in the
/// point at each end of the interval.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tangent {
    /// Place of the tangent, with value and gradient there.
    place: Point3<f64>,
    value: f64,
    gradient: Vector3<f64>,
    /// Change of the value and of the gradient per share.
    change: (f64, Vector3<f64>),
    /// From the share of the tangent to both ends.
    ends: [f64; 2],
    /// Upper bound of the length of the gradient between both ends.
    steepness: f64,
}

impl Tangent {
    /// Tangent to the ball over a whole piece.
    fn to_ball(place: Point3<f64>, foot: &Foot, ball: Ball, capsule: &Capsule) -> Self {
        Self {
            place,
            value: foot.length - ball.radius - capsule.flaw(),
            gradient: foot.direction(),
            change: (0.0, Vector3::zeros()),
            ends: [0.0; 2],
            steepness: 1.0,
        }
    }

    /// Tangent to the cutter between two shares, at a touch of a place; holds for points within a radius of the place.
    fn to_cutter(place: Point3<f64>, piece: &Piece, touch: &Touch, (from, to): (f64, f64), radius: f64) -> Self {
        let twist = piece.twist(touch, radius);
        let ends = [from - touch.t, to - touch.t];
        let h = ends[1].max(-ends[0]);
        Self {
            place,
            value: touch.value - 0.5 * twist.second * h * h - twist.slope_flaw * h - twist.flaw,
            gradient: touch.gradient,
            change: (touch.rate, twist.change),
            ends,
            steepness: 1.0 + h * twist.change.norm(),
        }
    }

    /// The bound at a place of the cell.
    pub(crate) fn at(&self, p: &Point3<f64>) -> f64 {
        self.from(&(p - self.place))
    }

    fn from(&self, way: &Vector3<f64>) -> f64 {
        let slope = self.change.0 + self.change.1.dot(way);
        let [before, after] = self.ends.map(|end| slope * end);
        self.value + self.gradient.dot(way) + if before < after { before } else { after }
    }

    /// Lower bound of [`Self::at`] within a radius of a place of the cell.
    pub(crate) fn about(&self, p: &Point3<f64>, radius: f64) -> f64 {
        self.at(p) - radius * self.steepness
    }

    /// True if the bound lies nowhere below a cutoff over the patch whose middle is the place of the tangent.
    fn hides_from(&self, cutoff: &Cutoff<'_>) -> bool {
        self.ends.iter().all(|end| {
            cutoff.hides(self.value + self.change.0 * end, &(self.gradient + self.change.1 * *end), self.steepness)
        })
    }

    /// The bound over a whole cell.
    pub(crate) fn over(&self, hull: &Hull) -> f64 {
        let middle = hull.centre - self.place;
        least_of(hull.control.map(|c| self.from(&(middle + c)))) - hull.thickness * self.steepness
    }
}

/// Result of the first evaluation of a cell and a piece.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoundQuery {
    /// Share at which the cutter is nearest to the middle.
    pub(crate) t: f64,
    /// Distance of the middle at this share.
    pub(crate) value: f64,
    /// Lower bound over cell and piece.
    pub(crate) tangent: Tangent,
    /// Lower bound from the tangent over the cell.
    pub(crate) bound: f64,
}

impl Sweep<'_> {
    /// A lower bound over a patch; `None` where the cutter is nowhere below the cutoff.
    pub(crate) fn glance(&self, index: u32, cutoff: &Cutoff<'_>) -> Option<Tangent> {
        let hull = cutoff.hull();
        if let Some((ball, capsule, foot)) = self.bearing_ball(index, &hull.centre) {
            let tangent = Tangent::to_ball(hull.centre, &foot, ball, capsule);
            return (!cutoff.hides(tangent.value, &tangent.gradient, 1.0)).then_some(tangent);
        }
        let piece = self.piece(index);
        let whole = (0.0, 1.0);
        let start = self.touch(piece, 0.5, &hull.centre);
        let tangent = Tangent::to_cutter(hull.centre, piece, &start, whole, hull.radius);
        if tangent.hides_from(cutoff) {
            return None;
        }
        let nearest = self.minimum(piece, start, &hull.centre, whole);
        let tangent = Tangent::to_cutter(hull.centre, piece, &nearest, whole, hull.radius);
        (!tangent.hides_from(cutoff)).then_some(tangent)
    }

    /// The ball over a piece and its place nearest to a point, if the ball is the part of the cutter nearest to the
    /// point.
    pub(crate) fn bearing_ball(&self, index: u32, p: &Point3<f64>) -> Option<(Ball, &Capsule, Foot)> {
        let (ball, capsule) = self.capsule(index)?;
        let foot = capsule.foot(p);
        // In the centre there is no direction, and the ball gives no bound.
        (foot.length > 0.0 && capsule.bears(ball, &foot.direction())).then_some((ball, capsule, foot))
    }

    /// First evaluation of a cell; `None` where the cutter is nowhere in the cell nearer than `enough`.
    pub(crate) fn query(&self, index: u32, hull: &Hull, enough: f64) -> Option<BoundQuery> {
        if let Some((ball, capsule, foot)) = self.bearing_ball(index, &hull.centre) {
            let tangent = Tangent::to_ball(hull.centre, &foot, ball, capsule);
            if tangent.value - hull.radius >= enough {
                return None;
            }
            let bound = tangent.over(hull);
            let value = foot.length - ball.radius;
            return (bound < enough).then_some(BoundQuery { t: foot.t, value, tangent, bound });
        }
        let piece = self.piece(index);
        let whole = (0.0, 1.0);
        let start = self.touch(piece, 0.5, &hull.centre);
        let tangent = Tangent::to_cutter(hull.centre, piece, &start, whole, hull.radius);
        if tangent.about(&hull.centre, hull.radius) >= enough || tangent.over(hull) >= enough {
            return None;
        }
        let nearest = self.minimum(piece, start, &hull.centre, whole);
        let tangent = Tangent::to_cutter(hull.centre, piece, &nearest, whole, hull.radius);
        let bound = tangent.over(hull);
        (bound < enough).then_some(BoundQuery { t: nearest.t, value: nearest.value, tangent, bound })
    }

    /// Largest distance of a point of a cell at a share of a piece: the distance is convex.
    pub(crate) fn farthest(&self, index: u32, hull: &Hull, t: f64) -> f64 {
        let Pose { tip, axis } = self.piece(index).pose(t);
        let distance = |c: &Vector3<f64>| {
            let (rho, s) = tool_coordinates(&(hull.centre + c), &tip, &axis);
            self.solid().cutter_distance(rho, s)
        };
        hull.control.iter().map(distance).fold(f64::NEG_INFINITY, f64::max) + hull.thickness
    }

    /// The ball over a piece, if the ball is the nearest part of the cutter for all points of a cell.
    fn ruling_ball(&self, index: u32, hull: &Hull) -> Option<(Ball, &Capsule)> {
        self.capsule(index).filter(|(ball, capsule)| capsule.rules(*ball, &hull.centre, hull.radius))
    }

    /// Lower bound of the distance of a cell to the cutter over a piece; the search ends when the bound reaches `goal`.
    pub(crate) fn below(&self, index: u32, hull: &Hull, goal: f64) -> Below {
        if let Some((ball, capsule)) = self.ruling_ball(index, hull) {
            return below_capsule(ball, capsule, hull, goal);
        }
        let piece = self.piece(index);
        let mut result = Below { bound: f64::INFINITY, nearest: None };
        let mut spans = Spans::whole();
        while let Some(span) = spans.pop() {
            let start = self.touch(piece, 0.5 * (span.0 + span.1), &hull.centre);
            let tangent = Tangent::to_cutter(hull.centre, piece, &start, span, hull.radius);
            // For pieces far away this evaluation is enough.
            let first = match tangent.about(&hull.centre, hull.radius) {
                far if far >= goal => far,
                _ => tangent.over(hull),
            };
            if first >= goal {
                result.bound = result.bound.min(first);
                continue;
            }
            let nearest = self.minimum(piece, start, &hull.centre, span);
            let second = Tangent::to_cutter(hull.centre, piece, &nearest, span, hull.radius).over(hull).max(first);
            if second >= goal {
                result.bound = result.bound.min(second);
                continue;
            }
            let go = |at: [f64; 2], t: f64| {
                let p = hull.centre + hull.at(at);
                self.minimum(piece, self.touch(piece, t, &p), &p, span)
            };
            let (touch, at) = joint_minimum(hull, nearest, |t| (t.gradient, t.t), go);
            let curved = self.below_ball(piece, hull, span, &touch, at, goal);
            let tangent = Tangent::to_cutter(hull.centre + hull.at(at), piece, &touch, span, 2.0 * hull.radius);
            let third = tangent.over(hull).max(second).max(curved.map_or(f64::NEG_INFINITY, |c| c.0));
            if third >= goal {
                result.bound = result.bound.min(third);
                continue;
            }
            let loss = curved.map_or_else(|| piece.drift(&touch, 2.0 * hull.radius).loss(&touch, span), |c| c.1);
            if loss > CURVATURE_SLACK && spans.halve(span) {
                continue;
            }
            result.bound = result.bound.min(third);
            result.nearest = Some(at);
            return result;
        }
        result
    }

    /// The bound of [`Self::below`] between two shares where the nearest part of the cutter is a ball for the whole
    /// cell; also the loss of the bound through the path of the ball.
    fn below_ball(
        &self,
        piece: &Piece,
        hull: &Hull,
        span: (f64, f64),
        touch: &Touch,
        at: [f64; 2],
        goal: f64,
    ) -> Option<(f64, f64)> {
        let ball = self.ball()?;
        let h = (touch.t - span.0).max(span.1 - touch.t);
        let distance = touch.value + ball.radius;
        let most = distance + 2.0 * hull.radius + piece.displacement(ball.radius) * 2.0 * h;
        let highest = touch.s - ball.radius + 2.0 * hull.radius + piece.displacement(touch.arm()) * 2.0 * h;
        if distance <= 0.0 || highest > ball.upper * most {
            return None;
        }
        let speed = piece.ball_speed(touch.t, ball.radius);
        let loss = piece.ball_drift(ball.radius).loss(touch, span);
        let tangent = BallTangent { value: touch.value, gradient: touch.gradient, loss };
        Some((above_tangent(ball, hull, &tangent, at, &speed, goal), loss))
    }
}

/// The bound of [`Sweep::below`] where the nearest part of the cutter is its ball.
fn below_capsule(ball: Ball, capsule: &Capsule, hull: &Hull, goal: f64) -> Below {
    let foot = capsule.foot(&hull.centre);
    let tangent = Tangent::to_ball(hull.centre, &foot, ball, capsule);
    let first = match tangent.about(&hull.centre, hull.radius) {
        far if far >= goal => far,
        _ => tangent.over(hull),
    };
    if first >= goal {
        return Below { bound: first, nearest: None };
    }
    let curved = |foot: &Foot, at: [f64; 2]| {
        let (value, gradient) = (foot.length - ball.radius, foot.direction());
        let tangent = BallTangent { value, gradient, loss: capsule.flaw() };
        above_tangent(ball, hull, &tangent, at, capsule.way(), goal)
    };
    let second = curved(&foot, [0.0; 2]).max(first);
    if second >= goal {
        return Below { bound: second, nearest: None };
    }
    let go = |at: [f64; 2], _: f64| capsule.foot(&(hull.centre + hull.at(at)));
    let (foot, at) = joint_minimum(hull, foot, |f| (f.direction(), f.t), go);
    let third = curved(&foot, at).max(second);
    Below { bound: third, nearest: (third < goal).then_some(at) }
}

/// Tangent to a moving ball at a place of a cell.
struct BallTangent {
    /// Distance of the place from the ball, mm.
    value: f64,
    gradient: Vector3<f64>,
    /// Upper bound of the distance of the centre from its line, mm.
    loss: f64,
}

/// Lower bound, over a cell, of the distance to a ball that moves along `way`. The bound is valid where the distance is
/// below about `goal`.
///
/// A turn about its centre does not move a ball, and the curvature of the ball across the path of its centre counts: it
/// exceeds that of any groove into which the ball fits. Let a point lie n farther along the gradient, as seen from the
/// centre, and e across gradient and path. If its distance from the centre is at most d, its distance is at least n +
/// e^2 / 2 d; otherwise its distance is more than d.
fn above_tangent(
    ball: Ball,
    hull: &Hull,
    &BallTangent { value, gradient, loss }: &BallTangent,
    at: [f64; 2],
    way: &Vector3<f64>,
    goal: f64,
) -> f64 {
    let enough = goal + BALL_BOUND_MARGIN;
    // Beyond this distance from the line, the cutter is farther away than `enough`.
    let most = ball.radius + enough + loss;
    if most <= 0.0 {
        return f64::NEG_INFINITY;
    }
    let across = gradient.cross(way).try_normalize(MIN_CROSS_PRODUCT).unwrap_or_else(Vector3::zeros);
    (value - loss + hull.least_curved(at, &gradient, &across, 0.5 / most)).min(enough)
}

/// The place of a cell nearest to a cutter, starting from the nearest position of the cutter to the middle. `go` finds
/// the nearest position to a place, starting at a share; `slope` gives gradient and share of a position.
fn joint_minimum<T: Copy>(
    hull: &Hull,
    start: T,
    slope: impl Fn(&T) -> (Vector3<f64>, f64),
    go: impl Fn([f64; 2], f64) -> T,
) -> (T, [f64; 2]) {
    let (mut found, mut at) = (start, [0.0; 2]);
    let along_sides = |t: &T| {
        let (gradient, _) = slope(t);
        [gradient.dot(&hull.sides[0]), gradient.dot(&hull.sides[1])]
    };
    for _ in 0..JOINT_MINIMUM_ROUNDS {
        let own = along_sides(&found);
        let mut down = [0.0; 2];
        let mut way = f64::INFINITY;
        for k in 0..2 {
            let blocked = if own[k] > 0.0 { at[k] <= -1.0 } else { at[k] >= 1.0 };
            if !blocked && own[k].abs() > LEVEL_SLOPE {
                down[k] = -own[k];
                way = way.min((1.0 - at[k] * down[k].signum()) / down[k].abs());
            }
        }
        if !way.is_finite() {
            break;
        }
        let to = |share: f64| [0, 1].map(|k| (at[k] + down[k] * way * share).clamp(-1.0, 1.0));
        let along = |t: &T| {
            let own = along_sides(t);
            own[0] * down[0] + own[1] * down[1]
        };
        let t = slope(&found).1;
        let end = go(to(1.0), t);
        let (here, there) = (along(&found), along(&end));
        if there <= 0.0 {
            (found, at) = (end, to(1.0));
            continue;
        }
        let share = here / (here - there);
        let next = to(share);
        (found, at) = (go(next, t + (slope(&end).1 - t) * share), next);
    }
    (found, at)
}
