//! From a motion to NC text: the frames of the post file about the moves of the dialect.

use super::dialect::Post;
use super::form::TextForm;
use super::modulo;
use super::nc::{NcLine, NcProgram};
use super::sectors;
use super::words::{self, fixed};
use super::work_frame;
use base::source::Span;
use five_axis::{Angles, Joints};
use ir::repeats::Division;
use ir::{JointMove, Motion, MotionOperation, Operation, Program, Tool};
use std::collections::BTreeMap;
use wheel::control::Orientation;
use wheel::post_file::{Field, Frame, Template};

/// F of the blocks of a path. It is written where it changes, and behind a rapid again, so that every pass can be read by itself.
pub(super) struct FeedWord {
    last: String,
    number: fn(f64, usize) -> String,
}

impl FeedWord {
    /// Before the first block, with the form of a number in the dialect.
    pub(super) fn new(number: fn(f64, usize) -> String) -> Self {
        Self { last: String::new(), number }
    }

    /// The next F is written also if it is the same.
    pub(super) fn forget(&mut self) {
        self.last.clear();
    }

    /// The feed of a move, mm/min; `None` where it still holds.
    pub(super) fn changed(&mut self, program: &Program, m: &JointMove) -> Option<&str> {
        let decimals = program.post.control.decimals.feed;
        let text = (self.number)(words::feed(m.feed.unwrap_or(0.0), decimals), decimals);
        let changed = text != self.last;
        self.last = text;
        changed.then_some(&self.last)
    }

    /// The word behind a block, with a blank; no text where F still holds.
    pub(super) fn word(&mut self, program: &Program, m: &JointMove) -> String {
        self.changed(program, m).map_or_else(String::new, |feed| format!(" F{feed}"))
    }
}

/// Digits of tolerances: mm and degrees.
const TOLERANCE_DECIMALS: usize = 4;

/// The text of a motion. `header` holds lines of the comment block at its head.
///
/// Nothing here asks whether the motion was verified: [`super::trial`] throws its text away, and whoever hands a text on
/// sees to that.
pub fn emit(post: &dyn Post, program: &Program, motion: &Motion, header: &[String]) -> NcProgram {
    debug_assert_eq!(post.name(), program.post.dialect);
    let (motion, program) =
        (&*work_frame::motion(post.name(), program, motion), &*work_frame::program(post.name(), program));
    let form = &post.dialect().form;
    let step = if form.numbers.always { 1 } else { program.post.block_numbers };
    let first = if form.numbers.always { 0 } else { u64::from(step) };
    let nc = NcProgram { lines: Vec::new(), end: program.post.line_end.text() };
    let mut lines = ProgramLines { form, step: u64::from(step), number: first, nc };
    let whole = Values { post, program, operation: None };
    lines.frame(Frame::Start, &whole, None);
    for line in header {
        let [before, behind] = form.comment;
        lines.block(format!("{before}{}{behind}", words::comment(line)), None, None);
    }
    lines.frame(Frame::Head, &whole, None);
    let mut subprograms = 0;
    for (o, operation) in motion.operations.iter().enumerate() {
        let (Some(first), Some(last)) = (operation.moves.first(), operation.moves.last()) else { continue };
        let declared = &program.operations[operation.operation];
        let tool = &program.tools[declared.tool];
        let values = Values { post, program, operation: Some(OperationValues { declared, tool, first, last }) };
        let source = |i: usize| (u32::try_from(o).unwrap_or(u32::MAX), u32::try_from(i).unwrap_or(u32::MAX));
        lines.frame(Frame::OperationStart, &values, Some((&[Field::X, Field::Y, Field::StartTip], source(0))));
        let smoothing = values.value(Field::Smoothing);
        let divided = sectors::divided(post, program, operation, subprograms);
        let begun = lines.nc.lines.len();
        let mut write = |text, index: Option<usize>| lines.block(text, index.map(source), None);
        match &divided {
            None => post.moves(program, operation, &smoothing, &mut write),
            Some(divided) => {
                post.subprograms(program, divided, &smoothing, &mut write);
                subprograms += divided.division.subprograms;
                again(&divided.division, &mut lines.nc.lines[begun..]);
            }
        }
        let end = source(operation.moves.len() - 1);
        lines.frame(Frame::OperationEnd, &values, Some((&[Field::Z, Field::EndTip], end)));
    }
    lines.frame(Frame::End, &whole, None);
    lines.nc
}

/// Sets the further moves of the lines of an operation that are called again.
fn again(division: &Division, lines: &mut [NcLine]) {
    let mut of_line: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
    for subprogram in 0..division.subprograms {
        let mut places = division.places(subprogram).map(|(moves, _)| moves);
        let Some(first) = places.next() else { continue };
        for moves in places {
            for (own, other) in first.clone().zip(moves.clone()) {
                of_line.entry(own).or_default().push(u32::try_from(other).unwrap_or(u32::MAX));
            }
        }
    }
    for line in lines {
        let further = line.source.and_then(|(_, index)| of_line.remove(&(index as usize)));
        line.again = further.unwrap_or_default();
    }
}

/// The words that smooth in an operation.
pub(super) fn smoothing(
    post: &dyn Post,
    program: &Program,
    declared: &Operation,
    operation: &MotionOperation,
) -> String {
    let (Some(first), Some(last)) = (operation.moves.first(), operation.moves.last()) else { return String::new() };
    let tool = &program.tools[declared.tool];
    let values = Values { post, program, operation: Some(OperationValues { declared, tool, first, last }) };
    values.value(Field::Smoothing)
}

/// The moves of an operation between its stations, with their indices.
pub(super) fn between(operation: &MotionOperation) -> impl Iterator<Item = (usize, &JointMove)> {
    let end = operation.moves.len().saturating_sub(1);
    operation.moves.iter().enumerate().take(end).skip(1)
}

/// Words of both rotary axes in the sense of the machine.
pub(super) fn rotary(post: &dyn Post, program: &Program, angles: Angles) -> String {
    let form = &post.dialect().form;
    let numbers = rotary_numbers(post, program, angles);
    let words = program.machine.rotary.iter().zip(numbers).map(|(axis, number)| {
        let known = form.modulo.as_ref().ok().filter(|_| axis.modulo.is_some());
        let [before, behind] = known.map_or(["", ""], |form| form.about);
        format!("{}{}{before}{number}{behind}", axis.name, form.rotary)
    });
    words.collect::<Vec<_>>().join(" ")
}

/// Numbers of the words of both rotary axes.
pub(super) fn rotary_numbers(post: &dyn Post, program: &Program, angles: Angles) -> [String; 2] {
    [0, 1].map(|k| {
        let decimals = program.post.control.decimals.angle;
        post.number(modulo::degrees(&program.machine.rotary[k], angles[k], decimals), decimals)
    })
}

/// Words X Y Z of the tip on the part.
pub(super) fn tip(post: &dyn Post, program: &Program, joints: &Joints) -> String {
    let p = program.machine.forward(joints).tip;
    let w = |x: f64| post.number(x, program.post.control.decimals.length);
    format!("X{} Y{} Z{}", w(p.x), w(p.y), w(p.z))
}

/// Words of the vector from the tip to the holder on the part, with their addresses.
pub(super) fn vector(post: &dyn Post, program: &Program, joints: &Joints, addresses: [&str; 3]) -> String {
    let v = program.machine.forward(joints).axis;
    let w = |k: usize| format!("{}{}", addresses[k], post.number(v[k], program.post.control.decimals.vector));
    format!("{} {} {}", w(0), w(1), w(2))
}

/// Tip and axis of the tool on the part, three numbers each.
pub(super) fn pose(post: &dyn Post, program: &Program, joints: &Joints) -> [String; 2] {
    let pose = program.machine.forward(joints);
    let digits = &program.post.control.decimals;
    let numbers = |of: [f64; 3], decimals: usize| of.map(|x| post.number(x, decimals)).join(",");
    [numbers(pose.tip.coords.into(), digits.length), numbers(pose.axis.into(), digits.vector)]
}

/// Name of the work offset of the part; no text in a dialect without work offsets.
fn offset<'a>(post: &dyn Post, program: &'a Program) -> &'a str {
    program.post.work_offset().or_else(|| Some(post.dialect().offsets?.usual)).unwrap_or_default()
}

/// Its number in words that change it; no text in a dialect that writes none.
pub(super) fn offset_number(post: &dyn Post, program: &Program) -> String {
    post.offset_number(offset(post, program)).map_or_else(String::new, |number| number.to_string())
}

/// Text under construction.
struct ProgramLines {
    form: &'static TextForm,
    step: u64,
    number: u64,
    nc: NcProgram,
}

impl ProgramLines {
    fn block(&mut self, text: String, source: Option<(u32, u32)>, frame: Option<Span>) {
        let numbers = &self.form.numbers;
        let goes_on = |line: &NcLine| !self.form.continued.is_empty() && line.text.ends_with(self.form.continued);
        let bare = self.nc.lines.last().is_some_and(goes_on)
            || (!numbers.comments && text.starts_with(self.form.comment[0].trim_end()))
            || numbers.without.iter().any(|start| text.starts_with(start));
        let text = if self.step == 0 || bare {
            text
        } else {
            let numbered = format!("{}{} {text}", numbers.prefix, self.number);
            self.number += self.step;
            if self.number > numbers.largest {
                self.number = self.step;
            }
            numbered
        };
        self.nc.lines.push(NcLine { text, source, again: Vec::new(), frame });
    }

    /// Writes a frame. `station` marks the last line with one of some fields as the block that ends at a station.
    fn frame(&mut self, frame: Frame, values: &Values<'_>, station: Option<(&[Field], (u32, u32))>) {
        let index = Frame::ALL.iter().position(|f| *f == frame).unwrap_or_default();
        let templates = &values.program.post.frames[index];
        let holds = |t: &Template, fields: &[Field]| t.fields().any(|field| fields.contains(&field));
        let place = station.and_then(|(fields, _)| templates.iter().rposition(|t| holds(t, fields)));
        for (k, template) in templates.iter().enumerate() {
            let text = values.filled(template);
            let is_unset =
                |field: Field| matches!(field, Field::HomeX | Field::HomeY) && values.value(field).is_empty();
            // A field may have no text in this dialect or operation, and an axis no place to park.
            if text.trim().is_empty() || template.fields().any(is_unset) {
                continue;
            }
            let source = station.filter(|_| place == Some(k)).map(|(_, source)| source);
            self.block(text, source, Some(template.span));
        }
    }
}

/// Values of the fields at a place of the program.
struct Values<'a> {
    post: &'a dyn Post,
    program: &'a Program,
    operation: Option<OperationValues<'a>>,
}

/// What is known of an operation.
struct OperationValues<'a> {
    declared: &'a Operation,
    tool: &'a Tool,
    first: &'a JointMove,
    last: &'a JointMove,
}

impl Values<'_> {
    fn filled(&self, template: &Template) -> String {
        template.filled(|field| self.value(field))
    }

    fn value(&self, field: Field) -> String {
        let Self { program, operation, .. } = self;
        let file = &program.post;
        match field {
            Field::ProgramName => words::comment(&program.name),
            Field::ProgramFile => program.name.to_ascii_uppercase().replace('-', "_"),
            Field::ProgramNumber => format!("{:04}", file.program_number),
            Field::WorkOffset => offset(self.post, program).to_owned(),
            Field::WorkOffsetNumber => offset_number(self.post, program),
            Field::Retract => self.length(program.machine.retract),
            Field::HomeX => self.home(0),
            Field::HomeY => self.home(1),
            Field::HomeZ => self.length(program.machine.home[2].unwrap_or(program.machine.retract)),
            Field::Clamp1 => self.clamp(0, 0),
            Field::Clamp2 => self.clamp(1, 0),
            Field::Unclamp1 => self.clamp(0, 1),
            Field::Unclamp2 => self.clamp(1, 1),
            Field::RotaryZero => rotary(self.post, program, [0.0; 2]),
            Field::SmoothingOff => self.filled(&file.smoothing[2]),
            Field::Smoothing => {
                let finishes = operation.as_ref().is_none_or(|o| o.declared.kind.finishes());
                self.filled(&file.smoothing[usize::from(!finishes)])
            }
            Field::Tolerance => fixed(self.tolerances()[0], TOLERANCE_DECIMALS),
            Field::FinishTolerance => fixed(program.tolerances.chord.get(), TOLERANCE_DECIMALS),
            Field::OrientationTolerance => {
                // Rounded down; a margin keeps a value on a step where it is.
                let scale = 10f64.powi(4);
                fixed((self.tolerances()[1].to_degrees() * scale + 1e-6).floor() / scale, TOLERANCE_DECIMALS)
            }
            // The file was read with these fields in the frames of operations only.
            _ => operation.as_ref().map_or_else(String::new, |o| self.of_operation(field, o)),
        }
    }

    fn of_operation(&self, field: Field, o: &OperationValues<'_>) -> String {
        let machine = &self.program.machine;
        let at = |m: &JointMove, axis: usize| self.length(machine.positions(&m.joints, o.tool.length())[axis]);
        match field {
            Field::OperationName => words::comment(&o.declared.name),
            Field::ToolName => words::comment(&o.tool.name),
            Field::ToolNumber => o.tool.number.to_string(),
            Field::ToolLength => self.length(o.tool.length()),
            Field::Spindle => fixed(o.declared.speed.get(), 0),
            Field::Rotary => rotary(self.post, self.program, self.post.at_switch(machine, o.first.joints.rotary)),
            Field::X => at(o.first, 0),
            Field::Y => at(o.first, 1),
            Field::Z => at(o.last, 2),
            Field::StartTip => pose(self.post, self.program, &o.first.joints)[0].clone(),
            Field::StartAxis => pose(self.post, self.program, &o.first.joints)[1].clone(),
            Field::EndTip => pose(self.post, self.program, &o.last.joints)[0].clone(),
            Field::EndAxis => pose(self.post, self.program, &o.last.joints)[1].clone(),
            Field::Cutter => self.cutter(o.tool),
            Field::Transformation => {
                let index = usize::from(self.program.post.control.orientation == Orientation::Vectors);
                self.filled(&self.program.post.transformation[index])
            }
            _ => String::new(),
        }
    }

    /// `CUTTER` with diameter, corner radius, distance of its centre from the axis and from the end, angle of the end,
    /// angle of the side, height. No text where these do not describe the cutter.
    fn cutter(&self, tool: &Tool) -> String {
        let Some([diameter, corner, across, up, side]) = tool.solid.cutter.corner_arc() else { return String::new() };
        let lengths = [diameter, corner, across, up].map(|value| self.length(value)).join(",");
        let angle = |value: f64| self.post.number(value.to_degrees(), self.program.post.control.decimals.angle);
        format!("CUTTER/{lengths},{},{},{}", angle(0.0), angle(side), self.length(tool.solid.flute_length))
    }

    /// Word that clamps (0) or unclamps (1) a rotary axis; no text where the axis has no clamp.
    fn clamp(&self, axis: usize, word: usize) -> String {
        let words = self.program.machine.rotary[axis].clamp.as_ref();
        words.map_or_else(String::new, |words| words[word].clone())
    }

    /// Number of the place of an axis where the machine parks; no text where the axis stays.
    fn home(&self, axis: usize) -> String {
        self.program.machine.home[axis].map_or_else(String::new, |place| self.length(place))
    }

    fn length(&self, value: f64) -> String {
        self.post.number(value, self.program.post.control.decimals.length)
    }

    /// Path tolerance, mm, and orientation tolerance, radians; before all operations the least of both.
    fn tolerances(&self) -> [f64; 2] {
        let program = self.program;
        if let Some(o) = &self.operation {
            return [program.path_tolerance(o.declared), program.orientation_tolerance(o.declared)];
        }
        let turns = program.operations.iter().map(|(_, o)| program.orientation_tolerance(o));
        [program.tolerances.chord.get(), turns.fold(f64::INFINITY, f64::min)]
    }
}
