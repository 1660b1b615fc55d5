//! Bounds, over a whole cell of a surface, of the distance to a cutter swept over a piece of motion.
//!
//! Let F(p, t) be the distance of a point p to the cutter at the share t of a piece, q(p, t) the point as seen from the
//! tool. The distance is convex in q, and q is linear in p and t up to a bend that the turn of the piece bounds. So F is
//! convex in (p, t) up to that bend:
//!
//! - *below*, F lies above its tangent at any (p*, t*). At the joint minimum over cell and piece that tangent is level,
//!   and the bound is as sharp as the bend and the bulge of the cell allow ([`Sweep::below`]);
//! - *above*, F at a mean of corners and times is at most the mean of F at the corners, each at its own best time
//!   ([`Sweep::along`]). No term with the radius of the cutter enters: the cutter follows the cell.

use super::sweep::{Drift, Piece, Spans, Sweep, Touch};
use crate::collide::{Cutter, ToolSolid};
use nalgebra::{Point3, Vector3};

/// Slope over a cell, mm, that counts as level.
const LEVEL: f64 = 2e-6;

/// Rounds of the search for the joint minimum: on cylinders and balls the second is exact.
const ROUNDS: usize = 4;

/// What a bound may give away to the bend of a piece before the piece is halved, mm.
const BEND_SLACK: f64 = 1e-4;

/// How much farther the ball at the tip may be than the cutter where it still serves for bounds from above, mm.
const ON_BALL: f64 = 1e-5;

/// A cell of a surface: the biquadratic through nine of its points, thickened.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hull {
    /// Middle point.
    pub(super) centre: Point3<f64>,
    /// Corners: (low x, low y), (low, high), (high, low), (high, high).
    pub(super) corners: [Point3<f64>; 4],
    /// Distance of the farthest point from the middle.
    pub(super) radius: f64,
    /// Control points of the biquadratic relative to the middle; their hull holds it.
    control: [Vector3<f64>; 9],
    /// Control points of edges and middle relative to those of the bilinear through the corners.
    bulge: [Vector3<f64>; 5],
    /// Half sides.
    sides: [Vector3<f64>; 2],
    /// Thickness about the biquadratic.
    thickness: f64,
}

impl Hull {
    /// Through nine points, x by x.
    pub(super) fn new(points: &[Point3<f64>; 9], thickness: f64) -> Self {
        let centre = points[4];
        let p = points.map(|q| q - centre);
        let middle = |a: Vector3<f64>, m: Vector3<f64>, b: Vector3<f64>| m * 2.0 - (a + b) * 0.5;
        // Along y first, then along x.
        let rows = [0, 3, 6].map(|i| [p[i], middle(p[i], p[i + 1], p[i + 2]), p[i + 2]]);
        let mut control = [Vector3::zeros(); 9];
        for j in 0..3 {
            control[j] = rows[0][j];
            control[3 + j] = middle(rows[0][j], rows[1][j], rows[2][j]);
            control[6 + j] = rows[2][j];
        }
        let (a, b, c, d) = (control[0], control[2], control[6], control[8]);
        let bulge = [
            control[1] - (a + b) * 0.5,
            control[3] - (a + c) * 0.5,
            control[5] - (b + d) * 0.5,
            control[7] - (c + d) * 0.5,
            control[4] - (a + b + c + d) * 0.25,
        ];
        let radius = control.iter().map(Vector3::norm_squared).fold(0.0, f64::max).sqrt() + thickness;
        let corners = [points[0], points[2], points[6], points[8]];
        let sides = [(p[7] - p[1]) * 0.5, (p[5] - p[3]) * 0.5];
        Self { centre, corners, radius, control, bulge, sides, thickness }
    }

    /// Most that a linear function with a gradient of at most length one falls from a point of the cell, given relative
    /// to the middle.
    fn fall(&self, from: &Vector3<f64>, gradient: &Vector3<f64>) -> f64 {
        let least = self.control.iter().map(|c| c.dot(gradient)).fold(f64::INFINITY, f64::min);
        from.dot(gradient) - least + self.thickness
    }

    /// Most that it rises from the middle.
    pub(super) fn rise(&self, gradient: &Vector3<f64>) -> f64 {
        self.control.iter().map(|c| c.dot(gradient)).fold(f64::NEG_INFINITY, f64::max) + self.thickness
    }

    /// Area, mm2.
    pub(super) fn area(&self) -> f64 {
        let [a, b, c, d] = self.corners;
        0.5 * (d - a).cross(&(c - b)).norm()
    }

    /// Least over the cell of g . (p - from) + k (e . (p - from))^2, for p in the cell and a place `at` of it.
    fn least_curved(&self, at: [f64; 2], gradient: &Vector3<f64>, across: &Vector3<f64>, k: f64) -> f64 {
        let from = self.at(at);
        // e . (p - from) is linear up to what the bulge adds.
        let (a, b) = (across.dot(&self.sides[0]), across.dot(&self.sides[1]));
        let c = -a * at[0] - b * at[1];
        let widest = a.abs() + b.abs() + c.abs();
        const PLACE: [f64; 3] = [-1.0, 0.0, 1.0];
        const SQUARE: [f64; 3] = [1.0, -1.0, 1.0];
        let (mut least, mut stray) = (f64::INFINITY, 0.0_f64);
        for (n, control) in self.control.iter().enumerate() {
            let (i, j) = (n / 3, n % 3);
            let (x, y) = (PLACE[i], PLACE[j]);
            let square = a * a * SQUARE[i] + b * b * SQUARE[j] + c * c + 2.0 * (a * b * x * y + c * (a * x + b * y));
            least = least.min((control - from).dot(gradient) + k * square);
            stray = stray.max((across.dot(control) - a * x - b * y).abs());
        }
        least - self.thickness - 2.0 * k * widest * (stray + self.thickness)
    }

    fn at(&self, [x, y]: [f64; 2]) -> Vector3<f64> {
        self.sides[0] * x + self.sides[1] * y
    }
}

/// What is known about a cell and a piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Below {
    /// No point of the cell comes nearer to the cutter.
    pub(super) bound: f64,
    /// Where the bound fell short of its goal: the touch and its place in the cell, in half sides from the middle.
    pub(super) nearest: Option<(Touch, [f64; 2])>,
}

/// An upper bound of the distance over a cell: a biquadratic by its control values, x by x.
#[derive(Clone, Copy, Debug)]
pub(super) struct Roof {
    control: [f64; 9],
}

impl Roof {
    /// Most over the cell.
    pub(super) fn most(&self) -> f64 {
        self.control.iter().copied().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Most of the mean of two.
    pub(super) fn most_of_mean(&self, other: &Self) -> f64 {
        self.control.iter().zip(&other.control).map(|(a, b)| 0.5 * (a + b)).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Over the quarters of the cell.
    pub(super) fn quarters(&self) -> [Self; 4] {
        let halves = |[a, b, c]: [f64; 3]| {
            let (ab, bc) = (0.5 * (a + b), 0.5 * (b + c));
            let m = 0.5 * (ab + bc);
            [[a, ab, m], [m, bc, c]]
        };
        let c = &self.control;
        let along_y = [0, 3, 6].map(|i| halves([c[i], c[i + 1], c[i + 2]]));
        let quarter = |right: usize, upper: usize| {
            let mut control = [0.0; 9];
            for j in 0..3 {
                let column = halves([along_y[0][upper][j], along_y[1][upper][j], along_y[2][upper][j]])[right];
                for (i, value) in column.into_iter().enumerate() {
                    control[3 * i + j] = value;
                }
            }
            Self { control }
        };
        [quarter(0, 0), quarter(0, 1), quarter(1, 0), quarter(1, 1)]
    }
}

/// The ball at the tip of a cutter; it lies inside of the cutter.
#[derive(Clone, Copy, Debug)]
struct Ball {
    radius: f64,
    /// Largest s-component of the normal at which the cutter is this ball.
    upper: f64,
}

fn ball(solid: &ToolSolid) -> Option<Ball> {
    let radius = solid.cutter.tip_radius();
    let upper = match solid.cutter {
        Cutter::Flat { .. } | Cutter::Bull { .. } => return None,
        Cutter::Ball { .. } | Cutter::Lollipop { .. } => 0.0,
        Cutter::TaperedBall { half_angle, .. } => -half_angle.sin(),
        Cutter::Barrel { barrel, .. } => -(solid.cutter.barrel_height()? - radius) / (barrel - radius),
    };
    (solid.flute_length >= 2.0 * radius).then_some(Ball { radius, upper })
}

impl Sweep<'_> {
    /// Lower bound of the distance of a cell to the cutter over a piece; the search ends where the bound reaches
    /// `goal`. Without `thorough` only the middle of the cell is tried.
    pub(super) fn below(&self, index: u32, hull: &Hull, goal: f64, thorough: bool) -> Below {
        let piece = self.piece(index);
        let mut result = Below { bound: f64::INFINITY, nearest: None };
        let mut spans = Spans::whole();
        while let Some(span) = spans.pop() {
            let start = self.touch(piece, 0.5 * (span.0 + span.1), &hull.centre);
            let drift = piece.drift(&start, 2.0 * hull.radius);
            let origin = Vector3::zeros();
            let bound =
                |touch: &Touch, from: &Vector3<f64>, loss: f64| touch.value - loss - hull.fall(from, &touch.gradient);
            let loss = drift.loss(&start, span);
            // Far pieces need no look at the hull.
            let first = match start.value - loss - hull.radius {
                far if far >= goal => far,
                _ => bound(&start, &origin, loss),
            };
            if first >= goal {
                result.bound = result.bound.min(first);
                continue;
            }
            let nearest = self.minimum(piece, start, &hull.centre, span);
            let second = bound(&nearest, &origin, drift.loss(&nearest, span));
            if second >= goal || !thorough {
                result.bound = result.bound.min(first.max(second));
                if second < goal {
                    result.nearest = Some((nearest, [0.0; 2]));
                    return result;
                }
                continue;
            }
            let (touch, at) = self.joint_minimum(piece, hull, span, nearest);
            let loss = drift.loss(&touch, span);
            let curved = self.below_ball(piece, hull, span, &touch, at);
            let third = bound(&touch, &hull.at(at), loss).max(second).max(curved.map_or(f64::NEG_INFINITY, |c| c.0));
            if third >= goal {
                result.bound = result.bound.min(third);
                continue;
            }
            if curved.map_or(loss, |c| c.1) > BEND_SLACK && spans.halve(span) {
                continue;
            }
            result.bound = result.bound.min(third);
            result.nearest = Some((touch, at));
            return result;
        }
        result
    }

    /// The nearest place of a cell to the cutter between two shares, from the nearest share of its middle on.
    fn joint_minimum(&self, piece: &Piece, hull: &Hull, span: (f64, f64), start: Touch) -> (Touch, [f64; 2]) {
        let (mut touch, mut at) = (start, [0.0; 2]);
        let slope = |t: &Touch| [t.gradient.dot(&hull.sides[0]), t.gradient.dot(&hull.sides[1])];
        let go = |at: [f64; 2], t: f64| {
            let p = hull.centre + hull.at(at);
            self.minimum(piece, self.touch(piece, t, &p), &p, span)
        };
        for _ in 0..ROUNDS {
            let own = slope(&touch);
            let mut down = [0.0; 2];
            let mut way = f64::INFINITY;
            for k in 0..2 {
                let blocked = if own[k] > 0.0 { at[k] <= -1.0 } else { at[k] >= 1.0 };
                if !blocked && own[k].abs() > LEVEL {
                    down[k] = -own[k];
                    way = way.min((1.0 - at[k] * down[k].signum()) / down[k].abs());
                }
            }
            if !way.is_finite() {
                break;
            }
            let to = |share: f64| [0, 1].map(|k| (at[k] + down[k] * way * share).clamp(-1.0, 1.0));
            let along = |t: &Touch| slope(t)[0] * down[0] + slope(t)[1] * down[1];
            let end = go(to(1.0), touch.t);
            let (here, there) = (along(&touch), along(&end));
            if there <= 0.0 {
                (touch, at) = (end, to(1.0));
                continue;
            }
            let share = here / (here - there);
            let next = to(share);
            (touch, at) = (go(next, touch.t + (end.t - touch.t) * share), next);
        }
        (touch, at)
    }

    /// The bound of [`Self::below`] where the cutter is a ball all over cell and span. Turning does not move a ball, and
    /// its curvature across the way of its centre counts: it outweighs that of any groove that it fits into. Also what
    /// the bound loses to the way.
    fn below_ball(
        &self,
        piece: &Piece,
        hull: &Hull,
        (from, to): (f64, f64),
        touch: &Touch,
        at: [f64; 2],
    ) -> Option<(f64, f64)> {
        let ball = ball(self.solid())?;
        let (before, after) = (touch.t - from, to - touch.t);
        let h = before.max(after);
        let distance = touch.value + ball.radius;
        let most = distance + 2.0 * hull.radius + piece.displacement(ball.radius) * 2.0 * h;
        let highest = touch.s - ball.radius + 2.0 * hull.radius + piece.displacement(touch.s + touch.rho) * 2.0 * h;
        if distance <= 0.0 || highest > ball.upper * most {
            return None;
        }
        let (_, speed) = piece.ball_centre(touch.t, ball.radius);
        let across = touch.gradient.cross(&speed).try_normalize(1e-9).unwrap_or_else(Vector3::zeros);
        let down = (touch.rate * before).max(-touch.rate * after).max(0.0);
        let (bend, flaw) = piece.ball_bend(ball.radius);
        let k = 0.5 / most;
        let loss = down + 0.5 * bend * h * h + flaw;
        // Any share of the curvature holds; the best one balances that of the surface.
        let least = (0..=4)
            .map(|n| hull.least_curved(at, &touch.gradient, &across, k * 0.25 * f64::from(n)))
            .fold(f64::NEG_INFINITY, f64::max);
        Some((touch.value - loss + least, loss))
    }

    /// Upper bound of the distance of a cell to the cutter swept over a piece and the one that follows it.
    pub(super) fn above(&self, first: u32, second: u32, hull: &Hull) -> Roof {
        let (a, b) = (self.piece(first), self.piece(second));
        let ball = ball(self.solid());
        let arm = self.solid().flute_length;
        let ((tip_a, axis_a), (tip_b, axis_b)) = (a.speed(), b.speed());
        let pace = |tip: &Vector3<f64>, axis: &Vector3<f64>| tip.norm() + arm * axis.norm();
        let (pace_a, pace_b) = (pace(&tip_a, &axis_a), pace(&tip_b, &axis_b));
        // Shares of the second piece in those of the first, so that poses pass the joint at one pace.
        let stretch = if pace_a > 0.0 && pace_b > 0.0 { pace_b / pace_a } else { 1.0 };
        let mut touches: [Option<(Touch, &Piece)>; 4] = [None; 4];
        // Time from the joint, in shares of the first piece.
        let (mut early, mut late) = (f64::INFINITY, f64::NEG_INFINITY);
        for (k, corner) in hull.corners.iter().enumerate() {
            let nearest = |piece: &Piece| {
                let start = self.touch(piece, 0.5, corner);
                self.minimum(piece, start, corner, (0.0, 1.0))
            };
            let (x, y) = (nearest(a), nearest(b));
            let (touch, time, piece) = if x.value <= y.value { (x, x.t - 1.0, a) } else { (y, y.t * stretch, b) };
            (early, late) = (early.min(time), late.max(time));
            touches[k] = Some((touch, piece));
        }
        let time = late - early;
        // A kink of the way at the joint, and the bend on both sides of it, lead away from means of the corners. The
        // paces at the joint differ from those in the middles by half of the bends.
        let kinks = early < 0.0 && late > 0.0;
        let across = if kinks { -early * late / time } else { 0.0 };
        let used = [(a, 1.0, early < 0.0), (b, 1.0 / stretch, late > 0.0)];
        let worst = |of: &dyn Fn(&Piece, f64) -> f64| {
            used.iter().filter(|u| u.2 || !kinks).map(|u| of(u.0, u.1)).fold(0.0, f64::max)
        };
        let jump = |reach: f64| (tip_a - tip_b / stretch).norm() + (axis_a - axis_b / stretch).norm() * reach;
        let touches = touches.map(|t| t.map_or((Touch::FAR, a), |t| t));
        // Elsewhere on the cutter the ball lies deeper and says little.
        let on_ball = ball.filter(|ball| {
            touches.iter().zip(&hull.corners).all(|((t, piece), corner)| {
                let centre = piece.ball_centre(t.t, ball.radius).0;
                (corner - centre).norm() - ball.radius <= t.value + ON_BALL
            })
        });
        match on_ball {
            Some(ball) => {
                let bend = worst(&|p, scale| p.ball_bend(ball.radius).0 * scale * scale);
                let flaw = worst(&|p, _| p.ball_bend(ball.radius).1);
                let error = 0.125 * bend * time * time + flaw + across * (jump(ball.radius) + bend);
                let centres = touches.map(|(t, piece)| piece.ball_centre(t.t, ball.radius).0);
                roof_of_ball(ball.radius, &centres, hull, error)
            }
            None => {
                let drift = |p: &Piece| touches.map(|(t, _)| p.drift(&t, hull.radius));
                let most = |p: &Piece, of: &dyn Fn(&Drift) -> f64| drift(p).iter().map(of).fold(0.0, f64::max);
                let bend = worst(&|p, scale| most(p, &|d| d.bend) * scale * scale);
                let turn = worst(&|p, scale| most(p, &|d| d.turn) * scale);
                let flaw = worst(&|p, _| most(p, &|d| d.flaw));
                let reach = touches.iter().map(|(t, _)| t.rho + t.s.abs()).fold(0.0, f64::max) + 2.0 * hull.radius;
                // Means lie within half the span of time and half the diagonal of the cell.
                let error = 0.5 * (0.25 * bend * time * time + turn * time * hull.radius)
                    + flaw
                    + across * (jump(reach) + bend);
                let least =
                    touches.iter().map(|(t, _)| self.least_radius(t, 2.0 * hull.radius)).fold(f64::INFINITY, f64::min);
                // The gradient turns by no more than this over the cell.
                let swing = if least > 0.0 { (2.0 * hull.radius / least).min(2.0) } else { 2.0 } + turn * time;
                roof_of_cutter(&touches.map(|(t, _)| t), hull, swing, error)
            }
        }
    }

    /// Least radius of curvature of the level surfaces of the distance within a radius of a touched point; zero or less
    /// where an edge may lie there.
    pub(super) fn least_radius(&self, t: &Touch, radius: f64) -> f64 {
        let solid = self.solid();
        if t.s + radius > solid.flute_length {
            return 0.0;
        }
        let corner = solid.cutter.tip_radius();
        match solid.cutter {
            // Beside the cylinder the level surfaces are cylinders about the axis.
            Cutter::Flat { .. } | Cutter::Bull { .. } if t.s - radius >= corner => t.rho - radius,
            _ => corner + (t.value - radius).min(0.0),
        }
    }
}

/// Control values of the bilinear through four corners.
fn bilinear([a, b, c, d]: [f64; 4]) -> [f64; 9] {
    [a, 0.5 * (a + b), b, 0.5 * (a + c), 0.25 * (a + b + c + d), 0.5 * (b + d), c, 0.5 * (c + d), d]
}

/// Places of [`Hull::bulge`] among nine control points.
const BULGE: [usize; 5] = [1, 3, 5, 7, 4];

/// F at the means of corners and their times is at most the mean of F; the bulge adds its part along the gradients.
fn roof_of_cutter(touches: &[Touch; 4], hull: &Hull, swing: f64, error: f64) -> Roof {
    let mut control = bilinear(touches.map(|t| t.value));
    for (b, place) in hull.bulge.iter().zip(BULGE) {
        let along = touches.iter().map(|t| t.gradient.dot(b)).fold(f64::NEG_INFINITY, f64::max);
        control[place] += (along + swing * b.norm()).min(b.norm());
    }
    Roof { control: control.map(|c| c + error + hull.thickness) }
}

/// For a ball: with w_i from its centres to the corners, |mean w|^2 = mean |w|^2 - variance of w, so that the bound
/// falls between the corners by as much as the ball stands out across its way.
fn roof_of_ball(radius: f64, centres: &[Point3<f64>; 4], hull: &Hull, error: f64) -> Roof {
    let w: [Vector3<f64>; 4] = std::array::from_fn(|k| hull.corners[k] - centres[k]);
    let d = w.map(|v| v.norm());
    let (least, most) = d.iter().fold((f64::INFINITY, 0.0_f64), |(l, m), x| (l.min(*x), m.max(*x)));
    let mut control = bilinear(d.map(|d| d - radius));
    let x = (w[2] + w[3] - w[0] - w[1]) * 0.25;
    let y = (w[1] + w[3] - w[0] - w[2]) * 0.25;
    let twist = ((w[0] + w[3] - w[1] - w[2]) * 0.25).norm();
    // (1 - x^2) of this much at least; its control value in the middle is twice that.
    let variance = |v: &Vector3<f64>| (v.norm_squared() - 2.0 * v.norm() * twist).max(0.0) / most;
    let (across_x, across_y) = (variance(&x), variance(&y));
    let falls = [across_y, across_x, across_x, across_y, across_x + across_y];
    // |mean w|^2 = mean |w|^2 - variance, and corners stray from their mean by no more than this.
    let stray = x.norm() + y.norm() + twist;
    let shortest = (least * least - stray * stray).max(0.0).sqrt();
    let mut extra = error + hull.thickness;
    if shortest <= 0.0 {
        return Roof { control: control.map(|c| c + extra + 2.0 * hull.radius) };
    }
    // mean d^2 exceeds (mean d)^2 by the variance of d.
    extra += (most - least) * (most - least) / (8.0 * shortest);
    for ((b, place), fall) in hull.bulge.iter().zip(BULGE).zip(falls) {
        let along = w.iter().map(|v| v.dot(b)).fold(f64::NEG_INFINITY, f64::max);
        let out = if along > 0.0 { along / shortest } else { along / most };
        control[place] += out + b.norm_squared() / (2.0 * shortest) - fall;
    }
    Roof { control: control.map(|c| c + extra) }
}
