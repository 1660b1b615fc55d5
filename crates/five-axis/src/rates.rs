//! Speeds of the joints within a block, with proved bounds instead of samples.

use super::{Carries, Joints, Machine};
use nalgebra::{Point3, Rotation3, Unit, Vector3};

/// Turn of both rotary axes together per cell, radians; speeds are computed exactly at both ends of a cell. The proof
/// adds less than a thousandth of the sum of the speeds of the tip and of both axes.
const CELL_TURN: f64 = 0.015;

/// Most cells of a block. Blocks with a larger turn get valid but wider bounds.
const MAX_CELLS: f64 = 2000.0;

/// An even rotation about an axis.
struct Turn {
    direction: Unit<Vector3<f64>>,
    point: Point3<f64>,
    /// Angle at the start, and change of the angle, radians.
    from: f64,
    by: f64,
}

/// A point that moves straight in the frame of one or two rotary axes which turn evenly.
struct MovingPoint {
    /// Position relative to the innermost axis at start and end, mm.
    ends: [Vector3<f64>; 2],
    /// The axes, the innermost first.
    axes: Vec<Turn>,
    /// Vector from the outer axis to the inner one, mm.
    lever: Vector3<f64>,
}

impl MovingPoint {
    /// A point carried by axes, the innermost first, between two positions with the axes at zero, machine frame.
    fn new(axes: Vec<Turn>, ends: [Vector3<f64>; 2]) -> Self {
        let inner = axes.first().map_or(Vector3::zeros(), |a| a.point.coords);
        let lever = if let [a, b] = &axes[..] { a.point - b.point } else { Vector3::zeros() };
        Self { ends: ends.map(|p| p - inner), axes, lever }
    }

    /// Derivative of the position by the share.
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

    /// Upper bound of the third derivative by the share.
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
    /// The tip as the tables carry it, and the gauge line as the head swings it, for a tool of a given length.
    fn moving(&self, from: &Joints, to: &Joints, length: f64) -> [MovingPoint; 2] {
        let turns = |carries: Carries, order: [usize; 2], sense: f64| -> Vec<Turn> {
            let axes = order.into_iter().map(|k| (k, self.chain.axes()[k])).filter(|(_, a)| a.carries == carries);
            axes.map(|(k, axis)| {
                let (a, b) = (from.rotary[k], to.rotary[k]);
                Turn { direction: axis.direction, point: axis.point, from: sense * a, by: sense * (b - a) }
            })
            .collect()
        };
        let tips = [from, to].map(|j| self.chain.part_axes() * self.forward(j).tip.coords + self.part_origin);
        let gauge = Vector3::new(0.0, 0.0, -length);
        // A table turns opposite to its angle.
        [
            MovingPoint::new(turns(Carries::Part, [1, 0], -1.0), tips),
            MovingPoint::new(turns(Carries::Tool, [0, 1], 1.0), [gauge; 2]),
        ]
    }

    /// Upper bounds of |dq/ds| of X, Y, Z (mm) and both rotary axes (radians) over a block, with s from 0 to 1: the tip
    /// straight on the part, the rotary axes linear. With a head, X, Y and Z depend on the length of the tool, mm.
    ///
    /// Speeds are exact at both ends of each cell of s. Between them a speed exceeds its chord by at most h^2/8 times
    /// the largest third derivative of the joint, which the lever arms bound in closed form.
    pub fn largest_rates(&self, from: &Joints, to: &Joints, length: f64) -> [f64; 5] {
        let [tip, gauge] = self.moving(from, to, length);
        let turns = [0, 1].map(|k| (to.rotary[k] - from.rotary[k]).abs());
        let count = ((turns[0] + turns[1]) / CELL_TURN).ceil().clamp(1.0, MAX_CELLS);
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

    /// Least time of a block at constant pace within the speed limits of all axes, s. At this time no axis exceeds its
    /// limit anywhere in the block. `length` is that of the tool, mm.
    pub fn least_time(&self, from: &Joints, to: &Joints, length: f64) -> f64 {
        self.time_within(self.speeds(), from, to, length)
    }

    /// The same within the speeds for plans ([`Machine::planned_speeds`]), s.
    pub fn planned_time(&self, from: &Joints, to: &Joints, length: f64) -> f64 {
        self.time_within(self.planned_speeds(), from, to, length)
    }

    fn time_within(&self, speeds: [f64; 5], from: &Joints, to: &Joints, length: f64) -> f64 {
        self.largest_rates(from, to, length).iter().zip(speeds).map(|(rate, speed)| rate / speed).fold(0.0, f64::max)
    }
}
