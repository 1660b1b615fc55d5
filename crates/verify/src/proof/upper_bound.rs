//! Upper bounds of the distance to a cutter swept over two pieces of motion, for a whole cell of a surface.
//!
//! The distance F(p, t) is convex apart from the second derivative of the path (`lower_bound.rs`). F at a mean of
//! corners and times is therefore at most the mean of F at the corners, each at its own best time. No term with the
//! radius of the cutter occurs: the cutter follows the cell.

use super::capsule::Ball;
use super::hull::Hull;
use super::piece::{Drift, Piece, PoseSpeed, QuickPose, Touch};
use super::sweep::Sweep;
use nalgebra::{Point3, Vector3};
use tool_stock::collide::tool::tool_coordinates;

/// Excess of the distance to the tip ball over that to the cutter up to which the ball serves for upper bounds, mm.
const MAX_BALL_EXCESS: f64 = 1e-5;

/// An upper bound of the distance over a cell: the control values of a biquadratic, x by x.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UpperBound {
    control: [f64; 9],
}

impl UpperBound {
    /// Largest value over the cell.
    pub(crate) fn most(&self) -> f64 {
        self.control.iter().copied().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Largest value of the mean of two bounds.
    pub(crate) fn most_of_mean(&self, other: &Self) -> f64 {
        self.control.iter().zip(&other.control).map(|(a, b)| 0.5 * (a + b)).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The bounds over the four quarters of the cell.
    pub(crate) fn quarters(&self) -> [Self; 4] {
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

impl Sweep<'_> {
    /// Upper bound of the distance of a cell to the cutter swept over a piece and its successor.
    pub(crate) fn above(&self, first: u32, second: u32, hull: &Hull) -> UpperBound {
        let pair = Pair::new(self.piece(first), self.piece(second), self.solid().flute_length);
        if let (Some((ball, a)), Some((_, b))) = (self.capsule(first), self.capsule(second)) {
            let near = hull.corners.map(|corner| {
                let (x, y) = (a.foot(&corner), b.foot(&corner));
                if x.length <= y.length { (false, x) } else { (true, y) }
            });
            // Where another part of the cutter is nearest, the ball lies deeper and its bound is poor.
            let on_ball = near.iter().zip(&hull.corners).all(|((later, foot), corner)| {
                let QuickPose { tip, axis, .. } = pair.piece(*later).quick_pose(foot.t);
                let (rho, s) = tool_coordinates(corner, &tip, &axis);
                s - ball.radius <= ball.upper * foot.length
                    || foot.length - ball.radius <= self.solid().cutter_distance(rho, s) + MAX_BALL_EXCESS
            });
            if on_ball {
                return pair.bound_of_ball(ball, &near.map(|(later, foot)| (later, foot.t)), hull);
            }
        }
        let near = hull.corners.map(|corner| {
            let [x, y] = [pair.first, pair.second].map(|piece| {
                let start = self.touch(piece, 0.5, &corner);
                self.minimum(piece, start, &corner, (0.0, 1.0))
            });
            if x.value <= y.value { (false, x) } else { (true, y) }
        });
        let least = near.iter().map(|(_, t)| self.least_radius(t, 2.0 * hull.radius)).fold(f64::INFINITY, f64::min);
        pair.bound_of_cutter(&near, hull, least)
    }

    /// Least radius of curvature of the level surfaces of the distance within a radius of a touched point; zero or less
    /// where an edge may lie within this radius.
    fn least_radius(&self, t: &Touch, radius: f64) -> f64 {
        let solid = self.solid();
        if t.s + radius > solid.flute_length {
            return 0.0;
        }
        let arcs = solid.cutter.arcs();
        let corner = arcs.iter().map(|arc| arc.radius).fold(f64::INFINITY, f64::min);
        match arcs {
            // Beside the cylinder the level surfaces are cylinders about the axis.
            [arc] if arc.ring > 0.0 && arc.to == 0.0 && t.s - radius >= arc.height => t.rho - radius,
            _ => corner + (t.value - radius).min(0.0),
        }
    }
}

/// Two successive pieces of a sweep.
struct Pair<'a> {
    first: &'a Piece<'a>,
    second: &'a Piece<'a>,
    /// Ratio of the share of the second piece to that of the first, with which poses pass the joint at one pace.
    pace_ratio: f64,
}

/// Interval of the times at which a pair of pieces is nearest to the corners of a cell.
struct CornerRun {
    /// Length, in shares of the first piece.
    time: f64,
    /// Largest distance of a mean of times from the joint, if the interval contains the joint: at a kink of the path
    /// there, the path deviates from means of the corners.
    across: f64,
    /// Whether the interval contains parts of the first and of the second piece.
    passes: [bool; 2],
}

impl<'a> Pair<'a> {
    /// `arm` is the approximate distance of points of the cutter from the tip.
    fn new(first: &'a Piece<'a>, second: &'a Piece<'a>, arm: f64) -> Self {
        let pace = |piece: &Piece| {
            let PoseSpeed { tip, axis } = piece.speed();
            tip.norm() + arm * axis.norm()
        };
        let (a, b) = (pace(first), pace(second));
        Self { first, second, pace_ratio: if a > 0.0 && b > 0.0 { b / a } else { 1.0 } }
    }

    fn piece(&self, later: bool) -> &'a Piece<'a> {
        if later { self.second } else { self.first }
    }

    /// The interval of four shares, each of the first piece or of the later one.
    fn run(&self, shares: &[(bool, f64); 4]) -> CornerRun {
        // Time from the joint, in shares of the first piece.
        let times = shares.map(|(later, t)| if later { t * self.pace_ratio } else { t - 1.0 });
        let (early, late) = times.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), t| (l.min(*t), h.max(*t)));
        let time = late - early;
        let kinks = early < 0.0 && late > 0.0;
        let across = if kinks { -early * late / time } else { 0.0 };
        CornerRun { time, across, passes: [early < 0.0 || !kinks, late > 0.0 || !kinks] }
    }

    /// Largest value over the pieces of an interval; `of` gets a piece and the factor between its shares and those of
    /// the first piece.
    fn worst(&self, run: &CornerRun, of: impl Fn(&Piece, f64) -> f64) -> f64 {
        let pieces = [(self.first, 1.0), (self.second, 1.0 / self.pace_ratio)];
        pieces.iter().zip(run.passes).filter(|p| p.1).map(|((piece, scale), _)| of(piece, *scale)).fold(0.0, f64::max)
    }

    /// Change of the speed of points within a distance from the tip, at the joint. The speeds there differ from those
    /// at the middles by half of the second derivatives.
    fn jump(&self, reach: f64) -> f64 {
        let [a, b] = [self.first.speed(), self.second.speed()];
        (a.tip - b.tip / self.pace_ratio).norm() + (a.axis - b.axis / self.pace_ratio).norm() * reach
    }

    /// The bound from the ball, with the shares at which the ball is nearest to the corners.
    fn bound_of_ball(&self, ball: Ball, shares: &[(bool, f64); 4], hull: &Hull) -> UpperBound {
        let run = self.run(shares);
        let second = self.worst(&run, |p, scale| p.ball_drift(ball.radius).second * scale * scale);
        let flaw = self.worst(&run, |p, _| p.ball_drift(ball.radius).flaw);
        let error = 0.125 * second * run.time * run.time + flaw + run.across * (self.jump(ball.radius) + second);
        let centres = shares.map(|(later, t)| self.piece(later).ball_centre(t, ball.radius));
        bound_of_ball(ball.radius, &centres, hull, error)
    }

    /// The bound from the whole cutter, with its touches at the corners; `least` is the least radius of curvature of
    /// level surfaces of the distance over the cell.
    fn bound_of_cutter(&self, near: &[(bool, Touch); 4], hull: &Hull, least: f64) -> UpperBound {
        let run = self.run(&near.map(|(later, touch)| (later, touch.t)));
        let most = |p: &Piece, of: &dyn Fn(&Drift) -> f64| {
            near.iter().map(|(_, t)| of(&p.drift(t, hull.radius))).fold(0.0, f64::max)
        };
        let second = self.worst(&run, |p, scale| most(p, &|d| d.second) * scale * scale);
        let turn = self.worst(&run, |p, scale| most(p, &|d| d.turn) * scale);
        let flaw = self.worst(&run, |p, _| most(p, &|d| d.flaw));
        let reach = near.iter().map(|(_, t)| t.arm()).fold(0.0, f64::max) + 2.0 * hull.radius;
        // Means lie within half the interval of time and half the diagonal of the cell.
        let error = 0.5 * (0.25 * second * run.time * run.time + turn * run.time * hull.radius)
            + flaw
            + run.across * (self.jump(reach) + second);
        // Upper bound of the turn of the gradient over the cell.
        let swing = if least > 0.0 { (2.0 * hull.radius / least).min(2.0) } else { 2.0 } + turn * run.time;
        bound_of_cutter(&near.map(|(_, touch)| touch), hull, swing, error)
    }
}

/// Control values of the bilinear function through four corners.
fn bilinear([a, b, c, d]: [f64; 4]) -> [f64; 9] {
    [a, 0.5 * (a + b), b, 0.5 * (a + c), 0.25 * (a + b + c + d), 0.5 * (b + d), c, 0.5 * (c + d), d]
}

/// Places of [`Hull::bulge`] among nine control points.
const BULGE_PLACES: [usize; 5] = [1, 3, 5, 7, 4];

/// F at the means of corners and their times is at most the mean of F; the bulge adds its component along the
/// gradients.
fn bound_of_cutter(touches: &[Touch; 4], hull: &Hull, swing: f64, error: f64) -> UpperBound {
    let mut control = bilinear(touches.map(|t| t.value));
    for (b, place) in hull.bulge.iter().zip(BULGE_PLACES) {
        let along = touches.iter().map(|t| t.gradient.dot(b)).fold(f64::NEG_INFINITY, f64::max);
        control[place] += (along + swing * b.norm()).min(b.norm());
    }
    UpperBound { control: control.map(|c| c + error + hull.thickness) }
}

/// For a ball: with w_i from its centres to the corners, |mean w|^2 = mean |w|^2 - variance of w. Between the corners
/// the bound is therefore lower, by as much as the ball bulges across its path.
fn bound_of_ball(radius: f64, centres: &[Point3<f64>; 4], hull: &Hull, error: f64) -> UpperBound {
    let w: [Vector3<f64>; 4] = std::array::from_fn(|k| hull.corners[k] - centres[k]);
    let d = w.map(|v| v.norm());
    let (least, most) = d.iter().fold((f64::INFINITY, 0.0_f64), |(l, m), x| (l.min(*x), m.max(*x)));
    let mut control = bilinear(d.map(|d| d - radius));
    let x = (w[2] + w[3] - w[0] - w[1]) * 0.25;
    let y = (w[1] + w[3] - w[0] - w[2]) * 0.25;
    let twist = ((w[0] + w[3] - w[1] - w[2]) * 0.25).norm();
    // The bound is lower by at least (1 - x^2) times this; the control value in the middle is twice as much.
    let variance = |v: &Vector3<f64>| (v.norm_squared() - 2.0 * v.norm() * twist).max(0.0) / most;
    let (across_x, across_y) = (variance(&x), variance(&y));
    let falls = [across_y, across_x, across_x, across_y, across_x + across_y];
    // |mean w|^2 = mean |w|^2 - variance, and corners deviate from their mean by at most this.
    let deviation = x.norm() + y.norm() + twist;
    let shortest = (least * least - deviation * deviation).max(0.0).sqrt();
    let mut extra = error + hull.thickness;
    if shortest <= 0.0 {
        return UpperBound { control: control.map(|c| c + extra + 2.0 * hull.radius) };
    }
    // mean d^2 exceeds (mean d)^2 by the variance of d.
    extra += (most - least) * (most - least) / (8.0 * shortest);
    for ((b, place), fall) in hull.bulge.iter().zip(BULGE_PLACES).zip(falls) {
        let along = w.iter().map(|v| v.dot(b)).fold(f64::NEG_INFINITY, f64::max);
        let out = if along > 0.0 { along / shortest } else { along / most };
        control[place] += out + b.norm_squared() / (2.0 * shortest) - fall;
    }
    UpperBound { control: control.map(|c| c + extra) }
}
