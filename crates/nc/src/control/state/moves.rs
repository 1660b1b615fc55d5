//! Moves of single axes and of the tool tip, as changes of the state of the control.

use super::{AxisPosition, ControlState, Length, Transformation};
use crate::control::modal::{ModalGroup, Setting};
use crate::control::{
    Control, MotionWord, NcBlock, SLOWEST_INVERSE, Smoothing, WORD_ROUNDING_MM, WORD_ROUNDING_RAD, figure,
};
use crate::nc::{Direction, NcMove, NcPlace, NcRetract, STANDS};
use five_axis::{Carries, Interpolation, Joints, between};
use nalgebra::{Point3, Vector3};
use std::f64::consts::{PI, TAU};

/// Length of a direction vector below which it gives no direction.
const MIN_VECTOR_LENGTH: f64 = 1e-6;

/// Feed of a block in mm/min, and in inverse time its time in s, where the feed follows from the length of the block.
#[derive(Default)]
struct BlockFeed {
    feed: Option<f64>,
    time: Option<f64>,
}

impl ControlState<'_> {
    pub(super) fn moved(&mut self, block: &NcBlock) {
        if self.transformation != Transformation::On {
            self.motion = block.motion.or(self.motion);
        }
        if !block.has_axis_words() {
            if block.machine_frame {
                self.fault("the machine frame is named without an axis word");
            }
            self.motion = block.motion.or(self.motion);
            return;
        }
        // A target in the work frame, or one in the machine frame: the block before that was not understood switches.
        let of_tip =
            block.tip != [None; 3] || block.vector != [None; 3] || block.second != [None; 3] || block.spline.is_some();
        if self.doubtful && of_tip && block.machine_frame == (self.transformation == Transformation::On) {
            self.switch_unread(!block.machine_frame);
        }
        match self.transformation {
            Transformation::On if block.spline.is_some() && !block.machine_frame => {
                if let Some(words) = &block.spline {
                    self.spline_move(block, words);
                }
            }
            Transformation::On if block.second != [None; 3] && !block.machine_frame => self.state_second_point(block),
            Transformation::On => self.tip_move(block),
            Transformation::Off => self.axis_move(block),
            Transformation::Unknown => {
                let off = self.control.transformation[1];
                self.fault(format!(
                    "a move while the transformation may still be on from another program: write {off} alone in a block \
                     before"
                ));
                self.transformation = Transformation::Off;
                self.axis_move(block);
            }
        }
    }

    /// Executes a move with the transformation off. It must be at rapid and in the machine frame, and sideways moves
    /// must be at the retract height.
    fn axis_move(&mut self, block: &NcBlock) {
        let Control { machine_frame, behind, .. } = self.control;
        if block.vector != [None; 3] {
            self.fault("a direction vector with the transformation off");
        }
        if block.second != [None; 3] || block.spline.is_some() {
            self.fault("polynomials with the transformation off");
        }
        match self.motion {
            Some(MotionWord::Rapid) => {}
            Some(MotionWord::Feed) => {
                self.fault(format!(
                    "a move at feed with the transformation off: here only rapids are understood, write {}",
                    self.control.rapid
                ));
            }
            _ => self.fault(format!("a move before any {}: it may be a rapid or not", self.control.rapid)),
        }
        let linear = block.tip.iter().any(Option::is_some);
        if linear && !block.machine_frame {
            self.fault(format!(
                "X, Y or Z in the work frame with the transformation off: the target depends on offsets; write \
                 `{machine_frame} ...{behind}`"
            ));
        }
        if linear && !self.control.machine_frame_drops_length && self.length != Length::Off {
            let length = match &self.length {
                Length::Of(..) => "the tool length is still active",
                _ => "a tool length may still be active",
            };
            self.fault(format!("{machine_frame} without{behind}: {length}; write{behind} in this block"));
            self.length = Length::Off;
        }
        self.judge_modes(false, !block.machine_frame, false);
        self.judge_clamps(block.rotary.map(|word| word.is_some()));
        let words = [block.tip[0], block.tip[1], block.tip[2], block.rotary[0], block.rotary[1]];
        let sideways = (0..5).find(|k| *k != 2 && words[*k].is_some());
        if let (Some(k), true) = (sideways, words[2].is_some()) {
            self.fault(format!(
                "{} and Z move together with the transformation off: the path may not be clear; write {} in a block \
                 before",
                self.machine.names()[k],
                self.retract_words()
            ));
        } else if let (Some(k), false) = (sideways, self.is_retracted()) {
            self.fault(format!(
                "{} moves with the transformation off at an unknown height: write {} before this block",
                self.machine.names()[k],
                self.retract_words()
            ));
        }
        self.within_travel(&words);
        let retract = self.machine.retract;
        if let Some(z) = words[2] {
            if z < retract - WORD_ROUNDING_MM {
                self.fault(format!(
                    "with the transformation off the tool goes to Z{} of the machine, but the retract height of the machine \
                     file is Z{}: write {}",
                    figure(z),
                    figure(retract),
                    self.retract_words()
                ));
            }
            self.retracted(z.max(retract));
        }
        for (place, word) in self.axes.iter_mut().zip(words) {
            if let Some(x) = word {
                *place = AxisPosition::At(x);
            }
        }
        // Continue as the block intended.
        self.axes[2] = self.axes[2].known().map_or(AxisPosition::At(retract), |z| AxisPosition::At(z.max(retract)));
        self.placed = self.program.line;
    }

    fn within_travel(&mut self, words: &[Option<f64>; 5]) {
        let machine = self.machine;
        for (k, (axis, word)) in machine.linear.iter().zip(words).enumerate() {
            let Some(x) = *word else { continue };
            if x < axis.min - WORD_ROUNDING_MM || x > axis.max + WORD_ROUNDING_MM {
                self.fault(format!(
                    "{} goes to {} in the machine frame, outside its travel of {} to {}",
                    machine.names()[k],
                    figure(x),
                    figure(axis.min),
                    figure(axis.max)
                ));
            }
        }
    }

    /// The tool moves up after a section.
    fn retracted(&mut self, z: f64) {
        if !std::mem::take(&mut self.open) {
            return;
        }
        self.program.end_section(self.program.line, NcRetract::Height(z));
    }

    /// Executes a move of the tip.
    fn tip_move(&mut self, block: &NcBlock) {
        let off = self.control.transformation[1];
        if block.machine_frame {
            self.fault(format!(
                "a move in the machine frame with the transformation on: write {off} before this block"
            ));
            // Continue as the block intended.
            self.switch(false, &NcBlock::default());
            self.motion = block.motion.or(self.motion);
            return self.axis_move(block);
        }
        let direction = self.direction(block);
        self.judge_way(&direction);
        self.motion = block.motion.or(self.motion);
        let before = self.tip;
        let tip = self.target(block);
        self.second = None;
        let rapid = match self.motion {
            Some(MotionWord::Polynomial) => {
                self.fault("a straight block under POLY: write G0 or G1");
                false
            }
            Some(MotionWord::Feed) => false,
            Some(MotionWord::Rapid) => true,
            Some(MotionWord::Cancelled) | None => {
                self.fault("a move before any G0 or G1: write the word in this block");
                true
            }
        };
        self.judge_modes(true, true, !rapid);
        self.judge_clamps([true; 2]);
        if self.turns_by_second_point() {
            self.fault_once("oricurve", "a straight block with ORICURVE, without XH YH ZH: write ORIAXES before it");
        }
        let BlockFeed { feed, time } =
            if rapid { BlockFeed::default() } else { self.feed_of(block, before, &tip, &direction) };
        if !rapid {
            self.judge_spindle();
        }
        let smoothing = self.smoothing_of(rapid);
        self.program.judge_count();
        if self.turns_at_start(&tip, &direction, rapid) {
            return;
        }
        self.at_start = false;
        self.turn_to(direction);
        self.axes = [AxisPosition::Left; 5];
        let straight = self.program.straight(tip, direction, feed);
        self.program.keep(NcMove {
            rapid,
            interpolation: self.interpolation(),
            time,
            smoothing,
            frame_turned: self.frame_turn != 0.0 || block.shifted,
            ..straight
        });
    }

    /// The tip at the end of a block.
    fn target(&mut self, block: &NcBlock) -> Point3<f64> {
        for (k, word) in block.tip.iter().enumerate() {
            self.tip[k] = word.or(self.tip[k]);
        }
        if let Some(k) = (0..3).find(|k| self.tip[*k].is_none()) {
            self.fault(format!(
                "the first move after {} needs X Y Z, since their values change there: {} is missing",
                self.control.transformation[0],
                self.machine.names()[k]
            ));
        }
        let [x, y, z] = self.tip.map(|x| x.unwrap_or(0.0));
        self.tip = [Some(x), Some(y), Some(z)];
        Point3::from(self.in_part(Vector3::new(x, y, z)))
    }

    /// A vector of the work frame in the part frame.
    fn in_part(&self, v: Vector3<f64>) -> Vector3<f64> {
        if self.frame_turn == 0.0 {
            return v;
        }
        let (sine, cosine) = libm::sincos(self.frame_turn);
        Vector3::new(cosine * v.x - sine * v.y, sine * v.x + cosine * v.y, v.z)
    }

    /// Reports a turn for which the shorter way is not the one that the words mean.
    fn judge_way(&mut self, to: &Direction) {
        let (Direction::Rotary(from), Direction::Rotary(to)) = (self.direction, to) else { return };
        let turns = |k: &usize| {
            let axis = &self.machine.rotary[*k];
            axis.modulo.is_none() && axis.max - axis.min > TAU && (to[*k] - from[*k]).abs() >= PI
        };
        if let Some(k) = [0, 1].iter().find(|k| self.control.shorter_way && turns(k)) {
            let turn = (to[*k] - from[*k]).abs().to_degrees();
            self.fault(format!(
                "{} turns by {} deg in one block: on the shorter way it would turn in the other direction; divide the \
                 block",
                self.machine.rotary[*k].name,
                figure(turn)
            ));
        }
    }

    /// The tool has turned.
    pub(super) fn turn_to(&mut self, direction: Direction) {
        self.direction = direction;
        if self.machine.rotary.iter().all(|axis| axis.modulo.is_none()) {
            return;
        }
        self.rotary = match direction {
            Direction::Rotary(angles) => angles,
            // Of the positions for a vector the control takes the near one.
            Direction::Axis(axis) => self.machine.chain.near(&axis, self.rotary).unwrap_or(self.rotary),
        };
    }

    /// Position to which a word turns a rotary axis. For an axis whose words the control reduces modulo 360 deg it is the
    /// one on the shorter way from where the axis stands.
    fn unwound(&mut self, k: usize, word: Option<f64>) -> Option<f64> {
        let (word, axis) = (word?, &self.machine.rotary[k]);
        if axis.modulo.is_none() {
            return Some(word);
        }
        if !self.control.modulo {
            self.fault_once("modulo", format!("axis {} is modulo 360 deg: its words are not read", axis.name));
            return Some(word);
        }
        let from = self.rotary[k];
        let turns = ((from - word) / TAU).round();
        let to = word + TAU * turns;
        if (to - from).abs() >= PI - WORD_ROUNDING_RAD {
            self.fault(format!(
                "{} turns by half a turn in one block: both ways are as short; divide the block",
                axis.name
            ));
        }
        Some(to)
    }

    /// Rule of the moves of the tip.
    pub(super) fn interpolation(&self) -> Interpolation {
        match self.program.setting(ModalGroup::Turning) {
            Setting::Said(word, _) if self.control.great_circle.contains(&word) => Interpolation::GreatCircle,
            _ => Interpolation::RotaryLinear,
        }
    }

    /// Tolerance of a move; `None` where only the control knows it.
    pub(super) fn smoothing_of(&mut self, rapid: bool) -> Option<f64> {
        match self.program.smoothing {
            Some(Smoothing::Within(deviation)) => Some(deviation.path),
            Some(Smoothing::AtControl) => None,
            _ if rapid => Some(0.0),
            left => {
                let word = self.control.smoothing;
                let why = match left {
                    Some(Smoothing::Left(word)) => {
                        format!("with {word} the control may deviate from the path without a limit")
                    }
                    _ => "the tolerance of the path is unknown".to_owned(),
                };
                self.fault_once("smoothing", format!("a move at feed, and {why}: write {word} before"));
                Some(0.0)
            }
        }
    }

    /// Executes a block that only turns the rotary axes at the start of the path, where the control fixes the work frame
    /// to the table before: such a block leaves the tip where it is in the machine. True when the block is one.
    fn turns_at_start(&mut self, tip: &Point3<f64>, direction: &Direction, rapid: bool) -> bool {
        let (Direction::Rotary(from), Direction::Rotary(to)) = (self.direction, *direction) else { return false };
        let machine = self.machine;
        let heads = (0..2).any(|k| machine.chain.axes()[k].carries == Carries::Tool && from[k] != to[k]);
        // A block that does not turn either is a turn said twice.
        let turns = from != to || self.turned.is_some();
        if !(self.control.frame_of_switch && self.at_start && rapid && turns) || heads {
            return false;
        }
        let end = machine.joints(tip, to);
        let at = self.turned.unwrap_or(end.xyz);
        let start = Joints { xyz: at, rotary: from };
        let away = [0.25, 0.5, 0.75, 1.0].map(|share| {
            let pose = Interpolation::RotaryLinear.pose(machine, [&start, &end], 0.0, share);
            (machine.joints(&pose.tip, between(from, to, share)).xyz - at).amax()
        });
        if away.into_iter().fold(0.0, f64::max) > STANDS {
            return false;
        }
        self.turned = Some(at);
        self.turn_to(*direction);
        if let Some(section) = self.program.section()
            && let NcPlace::Axes { rotary, turned, .. } = &mut section.start.place
        {
            (*rotary, *turned) = (to, self.turned);
        }
        true
    }

    /// Feed and time of a block at feed.
    fn feed_of(
        &mut self,
        block: &NcBlock,
        before: [Option<f64>; 3],
        tip: &Point3<f64>,
        direction: &Direction,
    ) -> BlockFeed {
        let inverse = matches!(self.program.setting(ModalGroup::FeedMode), Setting::Said("G93", _));
        let Some(word) = (if inverse { block.feed } else { self.program.feed }) else {
            if inverse {
                self.fault("a move at feed in inverse time (G93) needs F in its own block");
            } else {
                self.fault("a move at feed without a feed: write F in this block");
                self.program.feed = Some(1.0);
            }
            return BlockFeed { feed: Some(1.0), time: None };
        };
        if !inverse {
            return BlockFeed { feed: Some(word), time: None };
        }
        let time = Some(60.0 / word);
        let [Some(x), Some(y), Some(z)] = before else { return BlockFeed { feed: None, time } };
        let feed = (tip.coords - self.in_part(Vector3::new(x, y, z))).norm() * word;
        // Where the tip stands still, the control takes F as degrees.
        let turn = match (self.direction, *direction) {
            (Direction::Rotary(from), Direction::Rotary(to)) if feed == 0.0 => {
                libm::hypot(to[0] - from[0], to[1] - from[1]).to_degrees() * word
            }
            _ => 0.0,
        };
        if feed.max(turn) < SLOWEST_INVERSE {
            self.fault(format!(
                "in inverse time (G93) the tip moves at less than {SLOWEST_INVERSE} mm/min: the control takes another time \
                 than F states"
            ));
        }
        BlockFeed { feed: Some(feed), time }
    }

    fn direction(&mut self, block: &NcBlock) -> Direction {
        let before = self.direction;
        match (block.vector, block.rotary) {
            ([None, None, None], [None, None]) => before,
            ([Some(x), Some(y), Some(z)], [None, None]) => match Vector3::new(x, y, z).try_normalize(MIN_VECTOR_LENGTH)
            {
                Some(axis) => Direction::Axis(self.in_part(axis)),
                None => {
                    self.fault("a direction vector of length 0");
                    before
                }
            },
            ([None, None, None], words) => match (self.unwound(0, words[0]), self.unwound(1, words[1]), before) {
                (Some(first), Some(second), _) => Direction::Rotary([first, second]),
                (first, second, Direction::Rotary(at)) => {
                    Direction::Rotary([first.unwrap_or(at[0]), second.unwrap_or(at[1])])
                }
                _ => {
                    let [.., first, second] = self.machine.names();
                    self.fault(format!("only one of {first} and {second} after a direction vector: write both"));
                    before
                }
            },
            _ => {
                let ([.., first, second], [x, y, z]) = (self.machine.names(), self.control.vector);
                self.fault(format!(
                    "an incomplete direction: write {x}, {y} and {z} together, without {first} and {second}"
                ));
                before
            }
        }
    }
}
