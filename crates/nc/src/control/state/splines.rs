//! Blocks of polynomials, as changes of the state of the control.

use super::{AxisPosition, ControlState};
use crate::control::modal::{ModalGroup, Setting};
use crate::control::spline::{SplineStart, SplineWords};
use crate::control::{MotionWord, NcBlock};
use crate::nc::{Direction, NcMove};
use five_axis::{CurveDirection, PoseCurve};
use nalgebra::{Point3, Vector3};

/// Largest turn of the tool by a block that only states the second point of its axis: rounding of words, radians.
const DIRECTION_ROUNDING_RAD: f64 = 1e-5;

/// Places of a block at which the turns of the axes are followed.
const TURN_SAMPLES: u32 = 16;

/// Largest distance of such a block from where the tool stands, mm.
const PLACE_ROUNDING_MM: f64 = 1e-7;

impl ControlState<'_> {
    /// Whether the tool turns by the second point of its axis.
    pub(super) fn turns_by_second_point(&self) -> bool {
        matches!(self.program.setting(ModalGroup::Turning), Setting::Said("ORICURVE", _))
    }

    /// Executes a block with XH YH ZH and without polynomials: it states the second point where the tool stands.
    pub(super) fn state_second_point(&mut self, block: &NcBlock) {
        self.motion = block.motion.or(self.motion);
        self.judge_modes(true, true, true);
        if self.frame_turn != 0.0 {
            self.fault("XH YH ZH in a turned work frame are not read: turn it back before");
        }
        if !self.turns_by_second_point() {
            self.fault("XH YH ZH without ORICURVE: the control would not turn the tool by them");
        }
        let (Some([x, y, z]), [Some(i), Some(j), Some(k)]) = (self.known_tip(), block.second) else {
            return self.fault("XH, YH and ZH belong together, after a block with X Y Z: write all three");
        };
        if self.motion != Some(MotionWord::Feed) {
            self.fault("XH YH ZH at rapid: write G1 in this block");
        }
        let here = Point3::new(x, y, z);
        let there = Point3::from([0, 1, 2].map(|axis| block.tip[axis].unwrap_or(here[axis])));
        let second = Vector3::new(i, j, k);
        let axis = (second - here.coords).try_normalize(1e-3);
        let turned = axis.map(|axis| (axis - self.present_axis()).norm());
        let turns = block.vector != [None; 3] || block.rotary != [None; 2];
        if (there - here).amax() > PLACE_ROUNDING_MM || turns || turned.is_none_or(|turn| turn > DIRECTION_ROUNDING_RAD)
        {
            self.fault(
                "a straight block with XH YH ZH moves the tool: of such blocks only those are read that state the second \
                 point where the tool stands, in its direction",
            );
        }
        self.second = Some(second);
    }

    fn known_tip(&self) -> Option<[f64; 3]> {
        let [x, y, z] = self.tip;
        Some([x?, y?, z?])
    }

    /// Direction of the tool.
    fn present_axis(&self) -> Vector3<f64> {
        match self.direction {
            Direction::Axis(axis) => axis,
            Direction::Rotary(angles) => self.machine.chain.tool_axis(angles),
        }
    }

    /// Executes a block of polynomials.
    pub(super) fn spline_move(&mut self, block: &NcBlock, words: &SplineWords) {
        self.motion = block.motion.or(self.motion);
        if self.motion != Some(self.control.spline_motion) {
            self.fault("polynomials in a block that is not POLY: the control moves straight to their ends; write POLY");
        }
        self.judge_modes(true, true, true);
        self.judge_clamps([true; 2]);
        if self.frame_turn != 0.0 {
            self.fault("polynomials in a turned work frame are not read: turn it back before");
        }
        let forward = matches!(words, SplineWords::Forward { .. });
        if forward && !self.turns_by_second_point() {
            self.fault("polynomials of XH YH ZH without ORICURVE: the control would not turn the tool by them");
        }
        let Some(tip) = self.known_tip() else {
            return self
                .fault("a polynomial before the first place is known: write a straight block with X Y Z before");
        };
        let Some(feed) = self.program.feed else {
            return self.fault("a move at feed without a feed: write F in this block");
        };
        if matches!(self.program.setting(ModalGroup::FeedMode), Setting::Said("G93", _)) {
            self.fault("a polynomial in inverse time (G93) is not read: write G94");
        }
        self.judge_spindle();
        let rotary = if let Direction::Rotary(angles) = self.direction { Some(angles) } else { None };
        let start = SplineStart { tip: Point3::from(tip), rotary, second: self.second };
        match words.curve(&start) {
            Ok(curve) => self.follow(curve, feed),
            Err(reason) => self.fault(reason),
        }
    }

    /// The tool runs along a curve.
    fn follow(&mut self, curve: PoseCurve, feed: f64) {
        self.program.judge_count();
        let smoothing = self.smoothing_of(false);
        let (tip, _) = curve.at(1.0);
        self.tip = [Some(tip.x), Some(tip.y), Some(tip.z)];
        // Within a share of the block an axis turns by less than half a turn.
        for k in 1..=TURN_SAMPLES {
            self.turn_to(match curve.at(f64::from(k) / f64::from(TURN_SAMPLES)).1 {
                CurveDirection::Rotary(angles) => Direction::Rotary(angles),
                CurveDirection::Axis(axis) => Direction::Axis(axis),
            });
        }
        self.second = curve.levers().and_then(|levers| levers.last().map(|lever| tip.coords + lever));
        self.at_start = false;
        self.axes = [AxisPosition::Left; 5];
        let straight = self.program.straight(tip, self.direction, Some(feed));
        let interpolation = self.interpolation();
        self.program.keep(NcMove { interpolation, smoothing, curve: Some(Box::new(curve)), ..straight });
    }
}
