//! From the sections of a reader to the motion of the machine.
//!
//! This is the reverse of the compilation. The operations of the job are identified in the order of the text, each by
//! its tool and its spindle speed. The rotary axes have the positions to which the control would turn them. Times
//! follow from feeds and axis speeds. The position at which the transformation is switched on is the first station of
//! an operation, and the retract after it is the last. Nothing is corrected: whatever the job does not allow is a fault
//! with its line. CL data have poses alone: `positions` chooses the rotary positions, as a later post-processor would.

use super::nc::{Direction, NcMove, NcPlace, NcPose, NcRetract, NcSection, NcTool, STANDS};
use super::{positions, tool_shape};
use base::source::Span;
use diagnostics::{Code, Diag, Sink, codes::post};
use five_axis::control::Planning;
use five_axis::pose_curve::Chord;
use five_axis::{Angles, Interpolation, Joints, Machine, PoseCurve, linuxcnc, most_turn};
use ir::{JointMove, Motion, MotionOperation, MoveKind, Operation, OperationId, Program, SplineBlock, Tool};
use nalgebra::Point3;
use std::f64::consts::FRAC_PI_2;

/// Beginning of the name of a pass of a text, before the number of its first line.
pub const READ_PASS: &str = "blocks from line ";

/// A motion with the lines of its moves.
#[derive(Clone, Debug, Default)]
pub struct NcMotion {
    /// The motion; its labels name the lines at which passes begin.
    pub motion: Motion,
    /// Line of every move, from 1, by operation.
    pub lines: Vec<Vec<usize>>,
}

impl NcMotion {
    /// Line of a move of the motion.
    pub fn line(&self, operation: u32, index: u32) -> Option<usize> {
        self.lines.get(operation as usize)?.get(index as usize).copied()
    }
}

/// Most faults of one text that are reported.
const MAX_FAULTS: usize = super::MAX_FAULTS;

/// Share by which feed and spindle speed may exceed those of the job through rounding.
const FEED_ROUNDING: f64 = 1e-6;

/// Largest turn of the table that is rounding of words while the tool moves down to the first target, radians.
const PARKED_ROUNDING_RAD: f64 = 1e-5;

/// Share of the time of a move at rapid that is rounding of the words of its block.
const RAPID_TIME_ROUNDING: f64 = 1e-3;

/// Rotary moves and tip moves below these values count as standstill, in radians and mm.
const STILL: (f64, f64) = (1e-6, 1e-4);

/// Error of a time through the last digits of the words of a block: of a length (mm, divided by the feed) and of an
/// angle (radians, divided by the speed of the axis; it includes a margin for rotary axis 2 near the pole).
const QUANTUM: (f64, f64) = (2e-4, 1e-6);

/// Makes the motion of the sections. Faults go to the sink with the spans of their lines; `span` gives the span of a
/// line. `None` when the faults prevent the motion from being measured.
pub fn motion_of(
    program: &Program,
    sections: &[NcSection],
    span: &dyn Fn(usize) -> Span,
    sink: &mut Sink,
) -> Option<NcMotion> {
    let mut reader = Interpreter { program, span, sink, sound: true, reported: 0 };
    let mut result = NcMotion::default();
    let operations: Vec<(OperationId, &Operation)> = program.operations.iter().collect();
    for (k, section) in sections.iter().enumerate() {
        let Some((id, operation)) = operations.get(k) else {
            reader.fatal(
                post::NC_OPERATIONS,
                section.moves.first().map_or(section.start.line, |m| m.line),
                format!("the text has {} operations; the job has {}", sections.len(), operations.len()),
                "remove the additional operations from the text, or add them to the job",
            );
            break;
        };
        if reader.belongs(section, *id, operation, k) {
            let (moves, lines) = reader.section(section, *id, operation);
            result.motion.operations.push(moves);
            result.lines.push(lines);
        }
    }
    if sections.len() < operations.len() {
        let line = sections.last().map_or(1, |s| s.retract.map_or(s.start.line, |r| r.0));
        let missing: Vec<String> = operations[sections.len()..].iter().map(|(_, o)| format!("`{}`", o.name)).collect();
        reader.fatal(
            post::NC_OPERATIONS,
            line,
            format!("after this block the text ends without the operations {}", missing.join(", ")),
            "give the whole program: all operations of the job in their order",
        );
    }
    reader.sound.then_some(result)
}

/// Whether a move names this tool.
pub(super) fn says_tool(read: &NcMove, tool: &Tool) -> bool {
    match &read.tool {
        NcTool::Name(name) => **name == *tool.name,
        NcTool::Capitals(name) => **name == *tool.name.to_ascii_uppercase(),
        NcTool::Number(number) => *number == tool.number,
    }
}

struct Interpreter<'a> {
    program: &'a Program,
    span: &'a dyn Fn(usize) -> Span,
    sink: &'a mut Sink,
    sound: bool,
    reported: usize,
}

impl Interpreter<'_> {
    fn fault(&mut self, code: Code, line: usize, text: String, help: &str) -> Diag {
        // To find a line takes time in proportion to the length of the text.
        if self.reported >= MAX_FAULTS {
            return Diag::error(code, text);
        }
        Diag::error(code, text).label((self.span)(line), "this block").help(help)
    }

    /// Reports a fault. A text with more than [`MAX_FAULTS`] faults is not measured: each of a million blocks may have
    /// a fault.
    fn tell(&mut self, diag: Diag) {
        self.reported += 1;
        if self.reported <= MAX_FAULTS {
            self.sink.push(diag);
        } else {
            self.sound = false;
        }
    }

    /// Reports a fault after which the rest cannot be measured.
    fn fatal(&mut self, code: Code, line: usize, text: String, help: &str) {
        let diag = self.fault(code, line, text, help);
        self.tell(diag);
        self.sound = false;
    }

    /// Whether a section has the tool and the spindle speed of an operation of the job.
    fn belongs(&mut self, section: &NcSection, id: OperationId, operation: &Operation, number: usize) -> bool {
        let tool = &self.program.tools[operation.tool];
        if let Some(why) = tool_shape::difference(&section.shape, tool) {
            let text = format!("operation {} of the text, `{}` of the job, has {why}", number + 1, operation.name);
            let help = "give the job from which the text was made, or the tool of the job in the text";
            self.fatal(post::NC_OPERATIONS, section.start.line, text, help);
            return false;
        }
        let fits = |m: &NcMove| {
            says_tool(m, tool) && (m.speed - operation.speed.get()).abs() <= 0.5 + FEED_ROUNDING * operation.speed.get()
        };
        let Some(wrong) = section.moves.iter().find(|m| !fits(m)) else { return true };
        let known = self.program.tools.iter().any(|(_, t)| says_tool(wrong, t));
        let text = if known {
            format!(
                "operation {} of the text uses tool {} at {:.0} rpm here; `{}` of the job has {} at {:.0} rpm",
                number + 1,
                wrong.tool,
                wrong.speed,
                operation.name,
                tool.name,
                operation.speed.get()
            )
        } else {
            format!("the job has no tool {}", wrong.tool)
        };
        let span = self.program.operations[id].span;
        let diag = self
            .fault(
                post::NC_OPERATIONS,
                wrong.line,
                text,
                "make tools, speeds and order of the operations equal in text and job",
            )
            .label(span, "the operation of the job");
        self.tell(diag);
        self.sound = false;
        false
    }

    /// The moves of an operation, and the line of each.
    fn section(
        &mut self,
        section: &NcSection,
        id: OperationId,
        operation: &Operation,
    ) -> (MotionOperation, Vec<usize>) {
        let machine = &self.program.machine;
        let length = self.program.tools[operation.tool].length();
        let free = matches!(section.start.place, NcPlace::Pose(_));
        let start = match section.start.place {
            NcPlace::Axes { xyz, rotary, .. } => machine.joints_at(&xyz, rotary, length),
            NcPlace::Pose(pose) => at_retract(machine, length, self.start(section, &pose)),
        };
        let mut course = Course::new(section, id, machine, length, start);
        self.check_start(section, length);
        let (mut widest, mut widest_turn) = (0.0, 0.0);
        for m in &section.moves {
            if let Some(turn) = m.turn.filter(|turn| *turn > widest_turn) {
                self.check_turn_tolerance(m, turn, operation);
                widest_turn = turn;
            }
            if let Some(smoothing) = m.smoothing.filter(|s| *s > widest) {
                self.check_smoothing(m, smoothing, operation);
                widest = smoothing;
            }
            if let Some(curve) = &m.curve {
                self.spline(m, curve, operation, &mut course);
                continue;
            }
            let rotary = self.rotary(m, course.rotary, free);
            if course.is_still(m, rotary) {
                continue;
            }
            let first = course.last.is_none();
            self.check_turn(m, first, course.rotary, rotary, free);
            self.check_interpolation(m, course.rotary, rotary);
            let way = course.way(&m.tip, rotary);
            let (kind, mut feed) = self.kind(m, operation, first, &way);
            let time = match (m.time, feed) {
                (Some(time), _) => time,
                (None, Some(feed)) => way.time(feed),
                (None, None) => way.rapid_time(),
            };
            if kind != MoveKind::Rapid && way.turns_on_the_spot() {
                self.tell_standstill(m);
                // In inverse time a block with its tip at rest has no feed.
                feed = Some(operation.feed.get());
            }
            course.go(m, m.tip, JointMove { kind, joints: way.joints[1], feed, time, pass: 0, stop: false });
        }
        match section.retract {
            Some((line, NcRetract::Height(z))) => course.retract(line, z),
            Some((line, NcRetract::Pose(pose))) => {
                let rotary = machine.chain.near(&pose.axis, course.rotary).unwrap_or(course.rotary);
                course.leave(line, at_retract(machine, length, machine.joints(&pose.tip, rotary)));
            }
            None => {}
        }
        (course.made, course.lines)
    }

    /// A block of polynomials, with its chords.
    fn spline(&mut self, m: &NcMove, curve: &PoseCurve, operation: &Operation, course: &mut Course<'_>) {
        let machine = &self.program.machine;
        let height = self.program.tools[operation.tool].solid.flute_length;
        let Some(chords) = curve.chords(&machine.chain, course.rotary, height) else {
            let text = "the polynomials of this block bend too much to be checked".to_owned();
            return self.fatal(
                post::NC_POSITIONING,
                m.line,
                text,
                "divide the block, or keep the tool away from the pole",
            );
        };
        let first = course.made.moves.len();
        for Chord { end, .. } in &chords {
            let way = course.way(&end.tip, end.rotary);
            let (kind, feed) = self.kind(m, operation, course.last.is_none(), &way);
            let time = feed.map_or_else(|| way.rapid_time(), |feed| way.time(feed));
            course.go(m, end.tip, JointMove { kind, joints: way.joints[1], feed, time, pass: 0, stop: false });
        }
        let last = course.made.moves.len() - 1;
        let shares = chords.iter().map(|chord| chord.ends[1]).collect();
        course.made.splines.push(SplineBlock { first, last, curve: curve.clone(), shares });
    }

    /// Positions to which the control turns the rotary axes in a block, from the positions `before`. In a text that knows
    /// no machine they are `free` at rapid.
    fn rotary(&mut self, m: &NcMove, before: Angles, free: bool) -> Angles {
        let machine = &self.program.machine;
        let found = match m.direction {
            Direction::Rotary(angles) => Some(angles),
            Direction::Axis(axis) if free && m.rapid => positions::within_travel(machine, &axis, before),
            Direction::Axis(axis) => machine.chain.near(&axis, before),
        };
        found.unwrap_or_else(|| {
            self.tell_unreached(m.line);
            before
        })
    }

    /// Positions of all axes at the start of a section of a text that knows no machine.
    fn start(&mut self, section: &NcSection, pose: &NcPose) -> Joints {
        let machine = &self.program.machine;
        let rotary = match positions::at_start(machine, section, &pose.axis) {
            Ok(rotary) => rotary,
            Err(line) => {
                let [.., first, second] = machine.names();
                let text =
                    format!("no positions of {first} and {second} within their travel give all directions up to here");
                let help = "turn the axes back at rapid before, or use a machine with more travel";
                self.fatal(post::NC_POSITIONING, line, text, help);
                [0.0; 2]
            }
        };
        machine.joints(&pose.tip, rotary)
    }

    fn tell_unreached(&mut self, line: usize) {
        let names = self.program.machine.names();
        let text = format!("no angles of {} and {} give this direction", names[3], names[4]);
        self.fatal(post::NC_POSITIONING, line, text, "use a direction that the rotary axes reach");
    }

    fn tell_standstill(&mut self, m: &NcMove) {
        let text = "a block at feed moves only rotary axes, not the tip".to_owned();
        let help = "move the tip too, or turn the axes at rapid outside the stock";
        let diag = self.fault(post::STANDSTILL, m.line, text, help);
        self.tell(diag);
    }

    /// Reports linear axes that move while the tables turn to the start.
    fn check_start(&mut self, section: &NcSection, length: f64) {
        let NcPlace::Axes { xyz, rotary, turned: Some(tip) } = section.start.place else { return };
        let off = (tip - self.program.machine.joints_at(&xyz, rotary, length).xyz).amax();
        if off > STANDS {
            let text = format!("the linear axes move by {off:.3} mm while the tables turn to the start of the path");
            let help = "turn the tables with the tip where the tool stands at the retract height";
            let line = section.moves.first().map_or(section.start.line, |m| m.line);
            let diag = self.fault(post::NC_POSITIONING, line, text, help);
            self.tell(diag);
        }
    }

    /// Reports rotary positions that are not certain, and turns while the tool moves down.
    fn check_turn(&mut self, m: &NcMove, first: bool, before: Angles, to: Angles, free: bool) {
        let names = self.program.machine.names();
        if first && most_turn(before, to) > PARKED_ROUNDING_RAD {
            let what = if self.program.machine.chain.has_head() { "a rotary axis" } else { "the table" };
            let text = format!("{what} turns during the approach to the first target");
            let help = format!(
                "turn {} and {} to the positions of the first move before the transformation is switched on",
                names[3], names[4]
            );
            let diag = self.fault(post::NC_POSITIONING, m.line, text, &help);
            self.tell(diag);
        }
        let unsure =
            (to[1] - before[1]).abs() >= FRAC_PI_2 || self.program.machine.chain.changes_branch(before[0], to[0]);
        if matches!(m.direction, Direction::Axis(_)) && unsure && !(free && m.rapid) {
            let turn = (to[1] - before[1]).to_degrees().abs();
            let [.., first, second] = names;
            let text = format!("this direction turns {second} by {turn:.1} deg in one block, or runs through the pole");
            let help = format!("use more blocks between the directions, or {first}= {second}= at rapid");
            let diag = self
                .fault(post::AMBIGUOUS_VECTOR, m.line, text, &help)
                .note("a direction vector fits two rotary positions; the control takes the nearer one");
            self.tell(diag);
        }
    }

    /// Reports a block in which the axes turn by another rule than that of a motion.
    fn check_interpolation(&mut self, m: &NcMove, before: Angles, to: Angles) {
        let rule = match m.interpolation {
            Interpolation::RotaryLinear => return,
            Interpolation::GreatCircle => "turns the tool axis on a great circle",
            Interpolation::JointsLinear => "moves the joints linearly, not the tip",
        };
        if most_turn(before, to) <= STILL.0 {
            return;
        }
        let text = format!(
            "in this block the control {rule}; a block that turns is judged with rotary axes that run linearly"
        );
        let help = "switch to the interpolation of rotary axes before this block, such as ORIAXES or PATHCTRL AXIS";
        let diag = self.fault(post::NC_BLOCK, m.line, text, help);
        self.tell(diag);
    }

    /// Reports smoothing that may turn the tool further, radians, than the job allows.
    fn check_turn_tolerance(&mut self, m: &NcMove, turn: f64, operation: &Operation) {
        let [turn, allowed] = [turn, self.program.orientation_tolerance(operation)].map(f64::to_degrees);
        // Half a step of the word.
        if turn > allowed + 0.51e-4 {
            let text = format!(
                "from here the control may turn the tool by {turn:.4} deg from its direction; the job allows {allowed:.4} deg"
            );
            let help =
                "lower the orientation tolerance of smoothing, or state `orientation-tolerance` in the post of the job";
            let diag =
                self.fault(post::NC_SMOOTHING, m.line, text, help).label(operation.span, "the operation of the job");
            self.tell(diag);
        }
    }

    fn check_smoothing(&mut self, m: &NcMove, smoothing: f64, operation: &Operation) {
        let t = &self.program.tolerances;
        let finish = t.chord.get();
        let allowed = if operation.kind.finishes() { finish } else { finish.max(t.chord_rough.get()) };
        // Half a step of the word.
        if smoothing > allowed + 0.51e-4 {
            let text = format!(
                "from here the control may deviate from the path by {smoothing} mm; the job allows {allowed} mm"
            );
            let diag = self
                .fault(
                    post::NC_SMOOTHING,
                    m.line,
                    text,
                    "use a smoothing tolerance within the chord tolerance of the job",
                )
                .label(operation.span, "the operation of the job");
            self.tell(diag);
        }
    }

    /// Kind and feed of a move. A move faster than the process feed can only be a link. A block in inverse time is a
    /// move at rapid in two cases: its time is that of a rapid, or its feed is larger than every feed of the operation.
    fn kind(&mut self, m: &NcMove, operation: &Operation, first: bool, way: &ReadMove) -> (MoveKind, Option<f64>) {
        let most = operation.link_feed.get().max(operation.feed.get()) * (1.0 + FEED_ROUNDING);
        let feed = match (m.feed, m.time) {
            (_, Some(time)) if way.is_rapid(time) => return (MoveKind::Rapid, None),
            (_, Some(time)) => way.length() / time * 60.0,
            (Some(feed), None) => feed,
            (None, None) => return (MoveKind::Rapid, None),
        };
        if m.time.is_some() && feed > most {
            return (MoveKind::Rapid, None);
        }
        if first {
            self.fatal(
                post::NC_POSITIONING,
                m.line,
                format!("`{}` begins with a move at feed", operation.name),
                "begin with a rapid to a place outside the stock",
            );
        }
        if feed <= operation.feed.get() * (1.0 + FEED_ROUNDING) {
            return (MoveKind::Cut, Some(feed));
        }
        if feed > most {
            self.fatal(
                post::NC_FEED,
                m.line,
                format!(
                    "a feed of {feed} mm/min; `{}` of the job cuts at {} and links at {} mm/min",
                    operation.name,
                    operation.feed.get(),
                    operation.link_feed.get()
                ),
                "lower the feed, or raise `feed` or `link-feed` of the operation in the job",
            );
        }
        (MoveKind::Link, Some(feed))
    }
}

/// An operation, up to the block that was read last.
struct Course<'a> {
    machine: &'a Machine,
    length_of_tool: f64,
    made: MotionOperation,
    /// Line of every move.
    lines: Vec<usize>,
    /// Positions of the rotary axes.
    rotary: Angles,
    /// The block before; `None` before the first one.
    last: Option<LastBlock>,
}

/// What the next block needs of a block.
#[derive(Clone, Copy)]
struct LastBlock {
    tip: Point3<f64>,
    rapid: bool,
    smoothing: Option<f64>,
}

impl<'a> Course<'a> {
    /// Begins at the station where the transformation is switched on.
    fn new(
        section: &NcSection,
        operation: OperationId,
        machine: &'a Machine,
        length_of_tool: f64,
        start: Joints,
    ) -> Self {
        let count = section.moves.len() + 2;
        let mut made =
            MotionOperation { operation, labels: Vec::new(), moves: Vec::with_capacity(count), splines: Vec::new() };
        let mut lines = Vec::with_capacity(count);
        made.moves.push(station(start));
        lines.push(section.start.line);
        Self { machine, length_of_tool, made, lines, rotary: start.rotary, last: None }
    }

    /// Whether a block moves no axis.
    fn is_still(&self, m: &NcMove, rotary: Angles) -> bool {
        self.last.is_some_and(|l| l.tip == m.tip && rotary == self.rotary)
    }

    /// The motion from the end of the last block to a tip.
    fn way(&self, tip: &Point3<f64>, rotary: Angles) -> ReadMove<'a> {
        let machine = self.machine;
        let joints = machine.joints(tip, rotary);
        let start = self.made.moves.last().map_or(joints, |from| from.joints);
        let tips = [self.last.map_or_else(|| machine.forward(&start).tip, |l| l.tip), *tip];
        ReadMove { machine, length_of_tool: self.length_of_tool, tips, joints: [start, joints] }
    }

    /// Adds the move of a block, with its pass. A pass begins with the first rapid after a feed.
    fn go(&mut self, m: &NcMove, tip: Point3<f64>, step: JointMove) {
        let made = &mut self.made;
        if self.last.is_none_or(|l| m.rapid && !l.rapid) {
            made.labels.push(format!("{READ_PASS}{}", m.line));
        }
        let pass = u32::try_from(made.labels.len().saturating_sub(1)).unwrap_or(u32::MAX);
        // Stops matter only for this planner.
        let stops = self.machine.planning == Planning::LinuxCnc;
        if let (Some(before), Some(l)) = (made.moves.last_mut(), self.last) {
            before.stop = stops && (l.smoothing == Some(0.0) && !l.rapid || l.rapid != m.rapid);
        }
        made.moves.push(JointMove { pass, stop: stops, ..step });
        self.lines.push(m.line);
        self.rotary = step.joints.rotary;
        self.last = Some(LastBlock { tip, rapid: m.rapid, smoothing: m.smoothing });
    }

    /// Adds the retract to a height of the gauge line.
    fn retract(&mut self, line: usize, z: f64) {
        let Some(from) = self.made.moves.last() else { return };
        let joints = self.machine.at_height(&from.joints, z, self.length_of_tool);
        self.leave(line, joints);
    }

    /// Adds the last station.
    fn leave(&mut self, line: usize, joints: Joints) {
        let Some(from) = self.made.moves.last().copied() else { return };
        // With the transformation off each axis has its own speed limit.
        let time = self.machine.least_time(&from.joints, &joints, self.length_of_tool);
        self.made.moves.push(JointMove { pass: from.pass, time, ..station(joints) });
        self.lines.push(line);
    }
}

/// A station of a text of poses: where it is at the retract height within the digits of the words, it is there.
fn at_retract(machine: &Machine, length_of_tool: f64, mut joints: Joints) -> Joints {
    let over = machine.positions(&joints, length_of_tool)[2] - machine.retract;
    if over.abs() < QUANTUM.0 {
        joints.xyz.z -= over;
    }
    joints
}

/// A move that cuts nothing.
fn station(joints: Joints) -> JointMove {
    JointMove { kind: MoveKind::Rapid, joints, feed: None, time: 0.0, pass: 0, stop: false }
}

/// Start and end of one move.
struct ReadMove<'a> {
    machine: &'a Machine,
    length_of_tool: f64,
    tips: [Point3<f64>; 2],
    joints: [Joints; 2],
}

impl ReadMove<'_> {
    fn length(&self) -> f64 {
        (self.tips[1] - self.tips[0]).norm()
    }

    /// Whether the tool turns while its tip stands still.
    fn turns_on_the_spot(&self) -> bool {
        self.length() < STILL.1 && most_turn(self.joints[0].rotary, self.joints[1].rotary) > STILL.0
    }

    /// Least time at rapid within the speeds of the axes, s.
    fn least_time(&self) -> f64 {
        self.machine
            .least_time(&self.joints[0], &self.joints[1], self.length_of_tool)
            .max(self.length() / self.machine.rapid)
    }

    /// Whether a move takes the time that planning gives to a rapid. The words of a block in inverse time do not show
    /// whether it is a rapid.
    fn is_rapid(&self, time: f64) -> bool {
        let machine = self.machine;
        let planned = machine.planned_time(&self.joints[0], &self.joints[1], self.length_of_tool);
        let planned = planned.max(self.length() / machine.rapid);
        let [x, y, z, first, second] = machine.speeds();
        let digits = QUANTUM.0 / x.min(y).min(z) + QUANTUM.1 / first.min(second);
        (time - planned).abs() <= RAPID_TIME_ROUNDING * planned + digits
    }

    /// Time of a block with the word of a rapid, s.
    fn rapid_time(&self) -> f64 {
        match self.machine.planning {
            Planning::Joints => self.least_time(),
            Planning::LinuxCnc => linuxcnc::traverse_time(self.machine, &self.tips, &self.joints),
        }
    }

    /// Time at a feed, s. The feed decides also where an axis cannot follow, so that the check of the axes finds the
    /// fault. A difference that the last digits of the words explain is no fault.
    fn time(&self, feed: f64) -> f64 {
        let (machine, length) = (self.machine, self.length());
        let least = machine.least_time(&self.joints[0], &self.joints[1], self.length_of_tool);
        let wanted = length / feed * 60.0;
        let digits = QUANTUM.0 / feed * 60.0 + QUANTUM.1 / machine.rotary[0].speed.min(machine.rotary[1].speed);
        if length < STILL.1 || wanted + digits >= least { wanted.max(least) } else { wanted }
    }
}
