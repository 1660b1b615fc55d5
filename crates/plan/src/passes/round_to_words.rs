//! `round-to-words`: moves every end of a move to where the words of the post put it.
//!
//! Before: exact tips, axes and rotary positions. After: those that NC text with few digits can say, so that the verifier
//! proves what the text commands, and rounding counts within the tolerances. Finer words
//! stay exact: see [`Decimals::EXACT`]. All posts with such words have the same motion, so that their texts have the same
//! feeds.

use base::progress::Progress;
use five_axis::{Angles, Joints, Machine};
use ir::{JointMove, Motion, MotionOperation, MoveKind, Program};
use nalgebra::{Point3, Vector3};
use std::borrow::Cow;
use wheel::control::{Decimals, Orientation, on_step};

/// Rounds the motion.
pub(crate) fn run(program: &Program, progress: &Progress, motion: &mut Motion) {
    let words = Words::new(program);
    if !words.is_coarse() {
        return;
    }
    for operation in motion.operations.iter_mut().take_while(|_| !progress.is_cancelled()) {
        let length = program.tools[program.operations[operation.operation].tool].length();
        words.operation(operation, length);
    }
}

/// Steps of the words of a post.
struct Words<'a> {
    /// With the part in the frame that the words count in.
    machine: Cow<'a, Machine>,
    decimals: Decimals,
    orientation: Orientation,
}

impl<'a> Words<'a> {
    fn new(program: &'a Program) -> Self {
        let control = program.control();
        let machine = &program.machine;
        let machine = if machine.chain.holds_part_upright() || program.words_in_part_frame() {
            Cow::Borrowed(machine)
        } else {
            Cow::Owned(machine.in_work_frame())
        };
        Self { machine, decimals: control.decimals, orientation: control.orientation }
    }

    fn is_coarse(&self) -> bool {
        self.decimals.is_coarse(self.orientation)
    }

    fn operation(&self, operation: &mut MotionOperation, length: f64) {
        let Some((first, rest)) = operation.moves.split_first_mut() else { return };
        let Some((last, between)) = rest.split_last_mut() else { return };
        self.station(first, length);
        let mut before = first.joints.rotary;
        for m in between.iter_mut() {
            m.joints = self.rounded(m, before);
            before = m.joints.rotary;
        }
        // The axes go straight up from the last target.
        if let Some(over) = between.last() {
            let height = last.joints.xyz.z;
            last.joints = Joints { xyz: Vector3::new(over.joints.xyz.x, over.joints.xyz.y, height), ..over.joints };
        }
        drop_still(operation, &self.machine);
    }

    /// X and Y of the gauge line, and the rotary axes. The height is that of the machine file.
    fn station(&self, station: &mut JointMove, length: f64) {
        station.joints.rotary = self.angles(station.joints.rotary);
        let gauge = self.machine.positions(&station.joints, length);
        for (tip, at) in station.joints.xyz.iter_mut().zip(gauge).take(2) {
            *tip += on_step(at, self.decimals.length) - at;
        }
    }

    fn angles(&self, angles: Angles) -> Angles {
        angles.map(|angle| on_step(angle.to_degrees(), self.decimals.angle).to_radians())
    }

    /// The joints that the words of a move command. `before` are the rotary positions of the move before.
    fn rounded(&self, m: &JointMove, before: Angles) -> Joints {
        let pose = self.machine.forward(&m.joints);
        let tip = Point3::from(pose.tip.coords.map(|x| on_step(x, self.decimals.length)));
        let by_vector = self.orientation == Orientation::Vectors && m.kind != MoveKind::Rapid;
        let rotary =
            if by_vector { self.of_vector(&pose.axis, m.joints.rotary, before) } else { self.angles(m.joints.rotary) };
        self.machine.joints(&tip, rotary)
    }

    /// A direction near to another one that its own words say. Rounding changes the length of a vector, and a vector of
    /// length 1 in the same direction may round to other words: in turn, this ends at words that stay.
    fn direction(&self, axis: &Vector3<f64>) -> Vector3<f64> {
        let mut direction = *axis;
        for _ in 0..MAX_ROUNDS {
            let rounded = direction.map(|x| on_step(x, self.decimals.vector));
            let next = rounded.normalize();
            if next.map(|x| on_step(x, self.decimals.vector)) == rounded {
                return next;
            }
            direction = next;
        }
        direction
    }

    /// Rotary positions, near the exact ones, that give the direction of the words of a vector.
    fn of_vector(&self, axis: &Vector3<f64>, near: Angles, before: Angles) -> Angles {
        let words = self.direction(axis);
        let distance = |angles: &Angles| (angles[0] - near[0]).abs() + (angles[1] - near[1]).abs();
        // At a pole axis 2 stays where it was.
        let free = if self.machine.chain.polar_angle(near[0]) < POLE { before[1] } else { near[1] };
        let found = [0, 1].map(|branch| self.machine.chain.unwound(&words, branch, free));
        if distance(&found[1]) < distance(&found[0]) { found[1] } else { found[0] }
    }
}

/// Most rounds until the words of a direction stay. Without an end the text says the direction within half a step.
const MAX_ROUNDS: usize = 16;

/// Angle between the tool and axis 2 below which that axis is not determined by a rounded vector, radians.
const POLE: f64 = 1e-9;

/// Removes moves whose words repeat the tip of the move before; the next move goes on to where they led. The last move
/// before the station stays.
fn drop_still(operation: &mut MotionOperation, machine: &Machine) {
    let count = operation.moves.len();
    let mut kept: Vec<JointMove> = Vec::with_capacity(count);
    for (i, m) in operation.moves.iter().enumerate() {
        let stays = i > 0 && i + 2 < count && m.kind != MoveKind::Rapid && {
            let [from, to] = [kept[kept.len() - 1].joints, m.joints].map(|joints| machine.forward(&joints).tip);
            // Half of the step of the finest word.
            (to - from).amax() < 0.5e-6
        };
        if !stays {
            kept.push(*m);
        }
    }
    operation.moves = kept;
}

#[cfg(test)]
mod tests {
    use super::*;
    use five_axis::Chain;
    use proptest::prelude::*;

    proptest! {
        /// What the words say is what the joints do: rounded again, nothing changes, and nothing moves by more than half
        /// a step.
        #[test]
        fn rounding_is_done_once(
            tip in [-80.0..80.0_f64, -80.0..80.0, -80.0..80.0], a in 0.05..1.6_f64, c in -9.0..9.0_f64,
            branch in any::<bool>(), vectors in any::<bool>()
        ) {
            let machine = Machine::unlimited(Chain::tilting_table());
            let orientation = if vectors { Orientation::Vectors } else { Orientation::Angles };
            let words = Words {
                machine: Cow::Borrowed(&machine),
                decimals: Decimals { length: 3, angle: 3, vector: 6, feed: 0 },
                orientation,
            };
            let rotary = [if branch { -a } else { a }, c];
            let joints = machine.joints(&Point3::from(tip), rotary);
            let m = JointMove { kind: MoveKind::Cut, joints, feed: Some(1.0), time: 1.0, pass: 0, stop: false };
            let once = JointMove { joints: words.rounded(&m, rotary), ..m };
            let twice = words.rounded(&once, once.joints.rotary);
            let [p, q, r] = [joints, once.joints, twice].map(|j| machine.forward(&j));
            prop_assert!((p.tip - q.tip).amax() <= 0.5e-3 + 1e-9);
            prop_assert!((p.axis - q.axis).norm() <= 1.3e-5);
            prop_assert!((q.tip - r.tip).amax() < 1e-9 && (q.axis - r.axis).norm() < 1e-6, "{q:?} {r:?}");
            prop_assert!((once.joints.rotary[1] - c).abs() < 1e-3);
        }
    }
}
