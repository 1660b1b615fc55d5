//! How fast the joints move within a block, bounded by proof and not by samples.

use super::{Carries, Joints, Machine};
use nalgebra::{Point3, Rotation3, Unit, Vector3};

/// Turn of both rotary axes together over which the speed of a joint is taken between two exact values, radians: the proof adds
/// less than a thousandth of the speeds that those of the tip and of both axes add up from.
const CELL_TURN: f64 = 0.015;

/// Most cells of a block. Blocks that turn farther are bounded as well, but less closely.
const MOST_CELLS: f64 = 2000.0;

/// An even turn about an axis.
struct Turn {
    direction: Unit<Vector3<f64>>,
    point: Point3<f64>,
    /// Angle at the start, and by how much it turns, radians.
    from: f64,
    by: f64,
}

/// A point that is carried by one or two rotary axes which turn evenly, and that may move straight besides.
struct MovingPoint {
    /// Place from the innermost axis at start and end, mm.
    ends: [Vector3<f64>; 2],
    /// The axes, the innermost first.
    axes: Vec<Turn>,
    /// From the outer axis to the inner one, mm.
    lever: Vector3<f64>,
}

impl MovingPoint {
    /// A point that the axes carry, the innermost first, between two places of it with the axes at zero, machine frame.
    fn new(axes: Vec<Turn>, ends: [Vector3<f64>; 2]) -> Self {
        let inner = axes.first().map_or(Vector3::zeros(), |a| a.point.coords);
        let lever = if let [a, b] = &axes[..] { a.point - b.point } else { Vector3::zeros() };
        Self { ends: ends.map(|p| p - inner), axes, lever }
    }

    /// Change of place over the share, at a share.
    fn rate(&self, s: f64) -> Vector3<f64> {
        let [start, end] = &self.ends;
        let way = end - start;
        let Some(inner) = self.axes.first() else { return way };
        let rotation = Rotation3::from_axis_angle(&inner.direction, inner.from + inner.by * s);
        let u = rotation * (start + way * s);
        let of_u = rotation * way + inner.direction.cross(&u) * inner.by;
        let Some(outer) = self.axes.get(1) else { return of_u };
        let rotation = Rotation3::from_axis_angle(&outer.direction, outer.from + outer.by * s);
        rotation * (of_u + outer.direction.cross(&(u + self.lever)) * outer.by)
    }

    /// Bound of the third derivative over the share.
    fn third(&self) -> f64 {
        let [start, end] = &self.ends;
        let turn = |k: usize| self.axes.get(k).map_or(0.0, |a| a.by.abs());
        let [inner, outer] = [turn(0), turn(1)];
        let (speed, reach) = ((end - start).norm(), start.norm().max(end.norm()));
        let [first, second, third] = [
            speed + inner * reach,
            inner * (2.0 * speed + inner * reach),
            inner * inner * (3.0 * speed + inner * reach),
        ];
        outer.powi(3) * (reach + self.lever.norm()) + 3.0 * outer * outer * first + 3.0 * outer * second + third
    }
}

impl Machine {
    /// The tip as the tables carry it along, and the gauge line as the head swings it, with a tool of a length.
    fn moving(&self, from: &Joints, to: &Joints, length: f64) -> [MovingPoint; 2] {
        let turns = |carries: Carries, order: [usize; 2], sense: f64| -> Vec<Turn> {
            let axes = order.into_iter().map(|k| (k, self.chain.axes()[k])).filter(|(_, a)| a.carries == carries);
            axes.map(|(k, axis)| {
                let (a, b) = (from.rotary[k], to.rotary[k]);
                Turn { direction: axis.direction, point: axis.point, from: sense * a, by: sense * (b - a) }
            })
            .collect()
        };
        let tips = [from, to].map(|j| self.forward(j).tip.coords + self.part_origin);
        let gauge = Vector3::new(0.0, 0.0, -length);
        // A table turns against its word.
        [
            MovingPoint::new(turns(Carries::Part, [1, 0], -1.0), tips),
            MovingPoint::new(turns(Carries::Tool, [0, 1], 1.0), [gauge; 2]),
        ]
    }

    /// Upper bounds of |dq/ds| of X, Y, Z (mm) and both rotary axes (radians) over a block, s running evenly from 0 to 1: the
    /// tip straight on the part, the rotary axes linear. With a head, X, Y and Z depend on the length of the tool, mm.
    ///
    /// In cells of s the exact speeds at both ends are taken; between them a speed lies over its chord by at most h^2/8
    /// times the largest third derivative of the joint, which the lever arms bound in closed form.
    pub fn largest_rates(&self, from: &Joints, to: &Joints, length: f64) -> [f64; 5] {
        let [tip, gauge] = self.moving(from, to, length);
        let turns = [0, 1].map(|k| (to.rotary[k] - from.rotary[k]).abs());
        let count = ((turns[0] + turns[1]) / CELL_TURN).ceil().clamp(1.0, MOST_CELLS);
        let head = self.chain.has_head();
        let all = tip.third() + if head { gauge.third() } else { 0.0 };
        let between = all / (8.0 * count * count);
        let mut most = Vector3::zeros();
        for k in 0..=count as usize {
            let s = k as f64 / count;
            let rate = if head { tip.rate(s) - gauge.rate(s) } else { tip.rate(s) };
            most = most.sup(&rate.abs());
        }
        [most.x + between, most.y + between, most.z + between, turns[0], turns[1]]
    }

    /// Least time of a block that runs evenly and keeps the speed of every axis, s. At this time no axis is over its limit
    /// anywhere in the block. `length` is that of the tool, mm.
    pub fn least_time(&self, from: &Joints, to: &Joints, length: f64) -> f64 {
        self.time_within(self.speeds(), from, to, length)
    }

    /// The same within the speeds that a plan uses ([`Machine::planned_speeds`]), s.
    pub fn planned_time(&self, from: &Joints, to: &Joints, length: f64) -> f64 {
        self.time_within(self.planned_speeds(), from, to, length)
    }

    fn time_within(&self, speeds: [f64; 5], from: &Joints, to: &Joints, length: f64) -> f64 {
        self.largest_rates(from, to, length).iter().zip(speeds).map(|(rate, speed)| rate / speed).fold(0.0, f64::max)
    }
}
