//! Reader of CL data: what a post-processor knows after each statement, and the poses that it must reach. It shares no code
//! with the writer.
//!
//! At the start nothing is known: units, axes, tool, spindle, coolant, tolerance, feed and position. Where post-processors
//! differ, only texts are read that mean the same in all of them:
//!
//! - RAPID counts for the next GOTO in some, up to the next FEDRAT in others. Therefore RAPID stands right before its
//!   GOTO, and FEDRAT between a GOTO at rapid and one at feed.
//! - FROM says where the tool stands and moves nothing; some post-processors skip it. Therefore a GOTO at rapid to the
//!   same pose follows.
//! - Behind LOADTL nobody knows where the tool stands, and whether spindle and coolant run.

mod curves;
mod movnrb;
mod spindle;

use self::movnrb::Movnrb;
use super::statements::{self, Statement};
use crate::control::modal::{ModalGroup, Setting};
use crate::control::{
    FARTHEST, FASTEST, ProgramState, Smoothing, SmoothingTolerance, WIDEST_TOLERANCE_MM, in_range, number, shown,
    within,
};
use crate::nc::{Direction, NcMove, NcPlace, NcPose, NcRetract, NcStation, NcTool, ReadResult};
use crate::tool_shape::{NcCutter, NcToolShape};
use five_axis::{Machine, PoseCurve};
use nalgebra::{Point3, Vector3};

/// Largest number of a tool.
const MAX_TOOL_NUMBER: f64 = 1e8;

/// Largest error of the length of a direction vector: vectors of other lengths are not meant as directions.
const VECTOR_LENGTH_ERROR: f64 = 1e-4;

/// Rounding of the words of a pose in the height of the gauge line, mm.
const HEIGHT_ROUNDING_MM: f64 = 1e-3;

/// Reads a text.
pub(super) fn read(text: &str, machine: &Machine) -> ReadResult {
    let mut state = State::new(machine);
    let mut last = 1;
    statements::each(text, |line, found| {
        last = line;
        state.program.begin_line(line);
        match found {
            Ok(statement) => state.run(&statement),
            Err(reason) => state.program.fault(reason),
        }
        !state.program.is_full()
    });
    state.program.finished(text.lines().count().max(last), "FINI")
}

/// The way with the tool that is loaded.
struct Path {
    /// Where the tool stands; at the start that is FROM.
    at: NcPose,
    /// The first GOTO, which goes to the pose of FROM, is behind.
    begun: bool,
    /// The path has a move at feed.
    cuts: bool,
}

struct State<'a> {
    machine: &'a Machine,
    program: ProgramState,
    shape: NcToolShape,
    /// RAPID stands before this statement, in this line.
    rapid: Option<usize>,
    path: Option<Path>,
    /// Curves that are not at their end.
    curves: Option<Movnrb>,
    /// The first statement is behind.
    begun: bool,
}

impl<'a> State<'a> {
    fn new(machine: &'a Machine) -> Self {
        let (program, shape) = (ProgramState::new(), NcToolShape::default());
        Self { machine, program, shape, rapid: None, path: None, curves: None, begun: false }
    }

    fn run(&mut self, statement: &Statement<'_>) {
        if self.program.ended {
            return self.program.fault_once("ended", "a statement behind FINI");
        }
        let first = !std::mem::replace(&mut self.begun, true);
        let rapid = self.rapid.take();
        if let Some(line) = rapid.filter(|_| statement.word != "GOTO") {
            self.program.fault(format!(
                "`{}` between RAPID in line {line} and its GOTO: post-processors differ in what RAPID counts for; write RAPID \
                 right before GOTO",
                shown(statement.word, 10)
            ));
        }
        if let Err(reason) = self.statement(statement, first, rapid.is_some()) {
            self.program.fault(reason);
        }
    }

    fn statement(&mut self, statement: &Statement<'_>, first: bool, rapid: bool) -> Result<(), String> {
        let word = statement.word;
        let values = &*statement.values();
        if !matches!(word, "MOVNRB" | "GOTO" | "RAPID" | "PPRINT") {
            match self.curves.as_mut().map(|curves| (curves.line, curves.breaks())) {
                Some((line, true)) => {
                    return Err(format!(
                        "`{}` before MOVNRB/OFF of the motion that line {line} begins",
                        shown(word, 10)
                    ));
                }
                // A fault is reported already: the motion ends here.
                Some((_, false)) => self.curves = None,
                None => {}
            }
        }
        match (word, statement.has_stroke()) {
            ("PARTNO", _) => Self::name(first),
            ("PPRINT", _) => Ok(()),
            ("RAPID", false) => {
                self.rapid = Some(self.program.line);
                Ok(())
            }
            ("FINI", false) => {
                self.finish();
                Ok(())
            }
            ("RAPID" | "FINI", true) => Err(format!("`{word}` has nothing behind it")),
            ("GOTO", true) if self.curves.is_some() => self.along_curves(values, rapid),
            ("GOTO", true) => self.goto(values, rapid),
            ("MOVNRB", true) => self.movnrb(values),
            ("FROM", true) => self.from(values),
            ("UNITS", true) => self.units(values),
            ("MULTAX", true) => self.multax(values),
            ("MACHIN", true) => self.machin(values),
            ("LOADTL", true) => self.load(values),
            ("CUTTER", true) => self.cutter(values),
            ("SPINDL", true) => self.spindle(values),
            ("COOLNT", true) => self.coolant(values),
            ("FEDRAT", true) => self.feed(values),
            ("LINTOL", true) => self.lintol(values),
            ("STOP" | "OPSTOP", false) | ("DELAY", true) => self.wait(word, values),
            (
                "GOTO" | "MOVNRB" | "FROM" | "UNITS" | "MULTAX" | "MACHIN" | "LOADTL" | "CUTTER" | "SPINDL" | "COOLNT"
                | "FEDRAT" | "LINTOL" | "DELAY",
                false,
            ) => Err(format!("`{word}` without values")),
            _ => Err(not_read(word)),
        }
    }

    fn name(first: bool) -> Result<(), String> {
        if !first {
            return Err("PARTNO is the first statement, and stands once".to_owned());
        }
        Ok(())
    }

    fn units(&mut self, values: &[&str]) -> Result<(), String> {
        match values {
            ["MM"] => {
                self.program.say(ModalGroup::Units, "MM");
                Ok(())
            }
            ["INCH" | "INCHES" | "CM" | "FEET"] => {
                Err(format!("`UNITS/{}`: only texts in mm are read; write UNITS/MM", values[0]))
            }
            _ => Err(format!("`UNITS/{}` is not understood: write UNITS/MM", listed(values))),
        }
    }

    /// Without UNITS a length is in the units that the processor was left in.
    fn needs_units(&mut self) {
        if self.program.setting(ModalGroup::Units) == Setting::Unknown {
            self.program
                .fault_once("units", "no statement before this one says in which units lengths are: write UNITS/MM");
        }
    }

    fn multax(&mut self, values: &[&str]) -> Result<(), String> {
        let word = match values {
            ["ON"] => "ON",
            ["OFF"] => "OFF",
            _ => return Err(format!("`MULTAX/{}` is not understood: write MULTAX/ON", listed(values))),
        };
        self.program.say(ModalGroup::Turning, word);
        Ok(())
    }

    /// Without MULTAX a processor may leave the direction out.
    fn needs_multax(&mut self) {
        if !matches!(self.program.setting(ModalGroup::Turning), Setting::Said("ON", _)) {
            self.program.fault_once("multax", "no statement before says that the tool tilts: write MULTAX/ON");
        }
    }

    /// The name of a post-processor, and its number.
    fn machin(&mut self, values: &[&str]) -> Result<(), String> {
        let is_name = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_alphanumeric());
        match values {
            [name] if is_name(name) => Ok(()),
            [name, n] if is_name(name) && number(n).is_ok_and(|n| n.fract() == 0.0) => Ok(()),
            _ => {
                Err("MACHIN with more than a name and a number: its options are those of one post-processor".to_owned())
            }
        }
    }

    fn load(&mut self, values: &[&str]) -> Result<(), String> {
        self.leave();
        // Whatever the statement says, the tool before is no longer known.
        (self.program.tool, self.program.feed, self.shape) = (None, None, NcToolShape::default());
        self.stop_unsaid();
        self.program.forget(ModalGroup::Coolant);
        let Some((tool, mut rest)) = values.split_first() else { return Err("LOADTL without a tool".to_owned()) };
        let tool = tool_number(tool)?;
        let mut register = None;
        while let [key, value, more @ ..] = rest {
            match *key {
                "LENGTH" if self.shape.length.is_none() => self.shape.length = Some(positive(key, value, FARTHEST)?),
                "OSETNO" if register.is_none() => register = Some(tool_number(value)?),
                "LENGTH" | "OSETNO" => return Err(format!("`{key}` occurs twice in one statement")),
                _ => return Err(format!("`{}` of LOADTL is not understood", shown(key, 20))),
            }
            rest = more;
        }
        if let [key] = rest {
            return Err(format!("`{}` of LOADTL is not understood", shown(key, 20)));
        }
        self.program.tool = Some(NcTool::Number(tool));
        if self.shape.length.is_none() {
            return Err(format!(
                "LOADTL without the length of the tool from tip to gauge line: write LOADTL/{tool},LENGTH and the length"
            ));
        }
        self.needs_units();
        match register {
            Some(register) if register != tool => Err(format!(
                "OSETNO,{register} takes the length of another tool than {tool}: write OSETNO,{tool}, or leave it out"
            )),
            _ => Ok(()),
        }
    }

    fn cutter(&mut self, values: &[&str]) -> Result<(), String> {
        if self.program.tool.is_none() || self.path.is_some() {
            return Err("CUTTER before a tool is loaded, or in a path: write it right behind LOADTL".to_owned());
        }
        let mut numbers = Vec::new();
        for value in values {
            let read = number(value).and_then(in_range);
            numbers.push(read.map_err(|reason| format!("CUTTER: {reason}"))?);
        }
        self.needs_units();
        let cutter = match numbers[..] {
            [diameter] => NcCutter::cylinder(diameter, 0.0),
            [diameter, corner] => NcCutter::cylinder(diameter, corner),
            [diameter, corner, across, up, lower, upper, height] => NcCutter {
                diameter,
                corner,
                across,
                up,
                lower: lower.to_radians(),
                upper: upper.to_radians(),
                height: Some(height),
            },
            _ => return Err(format!("CUTTER has 1, 2 or 7 numbers, not {}", numbers.len())),
        };
        if cutter.diameter <= 0.0 || cutter.corner < 0.0 || cutter.upper.abs() >= std::f64::consts::FRAC_PI_2 {
            return Err(
                "CUTTER: diameter and corner radius cannot be negative, and the side leans by less than 90 deg"
                    .to_owned(),
            );
        }
        match self.shape.cutter.replace(cutter) {
            Some(_) => Err("a second CUTTER for one tool".to_owned()),
            None => Ok(()),
        }
    }

    fn feed(&mut self, values: &[&str]) -> Result<(), String> {
        self.program.feed = None;
        let feed = match values {
            [feed, "MMPM"] | ["MMPM", feed] => positive("FEDRAT", feed, FASTEST)?,
            [_] => return Err("FEDRAT without the units of the feed: write MMPM behind it".to_owned()),
            _ => return Err(format!("`FEDRAT/{}` is not understood: write the feed and MMPM", listed(values))),
        };
        self.program.feed = Some(feed);
        Ok(())
    }

    fn lintol(&mut self, values: &[&str]) -> Result<(), String> {
        self.program.smoothing = None;
        let [value] = values else {
            return Err(format!("`LINTOL/{}` is not understood: write one tolerance", listed(values)));
        };
        let path = positive("LINTOL", value, WIDEST_TOLERANCE_MM)?;
        self.program.smoothing = Some(Smoothing::Within(SmoothingTolerance { path, turn: None }));
        self.needs_units();
        Ok(())
    }

    fn wait(&mut self, word: &str, values: &[&str]) -> Result<(), String> {
        if self.path.is_some() {
            return Err(format!("`{word}` makes the program wait with the tool in the part: wait before FROM"));
        }
        match values {
            [] => Ok(()),
            [time] => positive(word, time, FARTHEST).map(|_| ()),
            _ => Err(format!("`{word}/{}` is not understood", listed(values))),
        }
    }

    fn pose(&mut self, word: &str, values: &[&str]) -> Result<NcPose, String> {
        self.needs_units();
        if values.len() == 3 {
            return Err(format!(
                "{word} without the direction of the tool: its last direction would stay; write i, j and k as well"
            ));
        }
        self.needs_multax();
        let Ok(texts) = <[&str; 6]>::try_from(values) else {
            return Err(format!("{word} has x, y, z, i, j and k, not {} values", values.len()));
        };
        let mut numbers = [0.0; 6];
        for (value, (text, name)) in numbers.iter_mut().zip(texts.into_iter().zip(["x", "y", "z", "i", "j", "k"])) {
            let read = number(text).map_err(|reason| format!("{word}, {name}: {reason}"))?;
            *value = within("", read, FARTHEST).map_err(|reason| format!("{word}, {name}{reason}"))?;
        }
        let [x, y, z, i, j, k] = numbers;
        let axis = Vector3::new(i, j, k);
        let length = axis.norm();
        if (length - 1.0).abs() > VECTOR_LENGTH_ERROR {
            return Err(format!(
                "{word}: the direction i, j, k has the length {length:.6}; a direction has the length 1"
            ));
        }
        Ok(NcPose { tip: Point3::new(x, y, z), axis: axis / length })
    }

    fn from(&mut self, values: &[&str]) -> Result<(), String> {
        let pose = self.pose("FROM", values)?;
        if self.program.tool.is_none() {
            self.program.fault(
                "FROM before a tool is loaded: the tool in the spindle and its length are unknown; write LOADTL before",
            );
        }
        if self.path.is_some() {
            return Err("FROM in a path: it moves nothing, so that the tool stands elsewhere; write GOTO".to_owned());
        }
        self.check_height("FROM", &pose);
        let start = NcStation { line: self.program.line, place: NcPlace::Pose(pose) };
        self.program.begin_section(start, self.shape);
        self.path = Some(Path { at: pose, begun: false, cuts: false });
        Ok(())
    }

    /// Height of the gauge line, the higher one of the two in which the machine reaches the pose; `None` where no angles give
    /// its direction.
    fn height(&self, pose: &NcPose, length: f64) -> Option<f64> {
        let machine = self.machine;
        let solutions = machine.chain.inverse(&pose.axis, 0.0)?;
        let heights = solutions.map(|rotary| machine.positions(&machine.joints(&pose.tip, rotary), length)[2]);
        Some(heights[0].max(heights[1]))
    }

    /// Whether the gauge line stands at the retract height or above.
    fn is_retracted(&self, pose: &NcPose) -> bool {
        let height = self.shape.length.and_then(|length| self.height(pose, length));
        height.is_some_and(|height| height >= self.machine.retract - HEIGHT_ROUNDING_MM)
    }

    /// Reports a pose in which the gauge line stands below the retract height.
    fn check_height(&mut self, word: &str, pose: &NcPose) {
        let machine = self.machine;
        let Some(length) = self.shape.length else { return };
        let Some(height) = self.height(pose, length) else {
            let [.., first, second] = machine.names();
            return self.program.fault(format!("{word}: no angles of {first} and {second} give this direction"));
        };
        if height < machine.retract - HEIGHT_ROUNDING_MM {
            self.program.fault(format!(
                "{word}: the gauge line stands at Z {height:.3} of the machine; where a path begins and ends, it stands at the \
                 retract height {:.3} of the machine file",
                machine.retract
            ));
        }
    }

    fn goto(&mut self, values: &[&str], rapid: bool) -> Result<(), String> {
        let pose = self.pose("GOTO", values)?;
        let Some(path) = self.path.as_mut() else {
            return Err("GOTO, and nothing says where the tool stands before: write FROM behind LOADTL".to_owned());
        };
        if !std::mem::replace(&mut path.begun, true) {
            let line = self.program.line;
            if let Some(section) = self.program.section() {
                section.start.line = line;
            }
            if !rapid || (pose.tip - path.at.tip).amax() > 0.0 || (pose.axis - path.at.axis).amax() > 0.0 {
                self.program.fault(
                    "the first GOTO goes elsewhere than FROM, or is no rapid: a post-processor that skips FROM would go \
                     straight down from the tool change; write RAPID and GOTO with the pose of FROM",
                );
            }
            return Ok(());
        }
        if rapid && path.cuts && !self.turns() {
            self.program.fault_once(
                "spindle",
                "RAPID and GOTO with the spindle at rest behind a cut: the tool may be in the part",
            );
        }
        let feed = if rapid { None } else { Some(self.feed_of_move()) };
        if rapid {
            self.program.feed = None;
        }
        self.go(&pose, feed, None);
        Ok(())
    }

    /// Adds a move, at rapid without a feed.
    fn go(&mut self, pose: &NcPose, feed: Option<f64>, curve: Option<PoseCurve>) {
        if let Some(path) = self.path.as_mut().filter(|path| path.begun) {
            path.at = *pose;
            path.cuts |= feed.is_some();
        }
        self.program.judge_count();
        // What the axes do between the poses is for the post-processor; the proof assumes that they turn evenly.
        let straight = self.program.straight(pose.tip, Direction::Axis(pose.axis), feed);
        self.program.keep(NcMove { smoothing: Some(self.tolerance()), curve: curve.map(Box::new), ..straight });
    }

    /// How far the path may be left between poses, mm.
    fn tolerance(&self) -> f64 {
        if let Some(Smoothing::Within(tolerance)) = self.program.smoothing { tolerance.path } else { 0.0 }
    }

    /// The feed of a move, mm/min; checks what a move at feed needs.
    fn feed_of_move(&mut self) -> f64 {
        let unsafe_spindle = match self.program.setting(ModalGroup::Spindle) {
            Setting::Said("CLW", _) => None,
            Setting::Said("CCLW", line) => {
                Some(format!("a move at feed with the spindle counter-clockwise, by line {line}"))
            }
            Setting::Said(..) => Some("a move at feed with the spindle off: write SPINDL/RPM before".to_owned()),
            _ => Some(
                "a move at feed, and no statement since LOADTL starts the spindle: write SPINDL/RPM, the speed, and CLW"
                    .to_owned(),
            ),
        };
        if let Some(reason) = unsafe_spindle {
            self.program.fault_once("spindle", reason);
        }
        let dry = match self.program.setting(ModalGroup::Coolant) {
            Setting::Said("ON", _) => None,
            Setting::Said(..) => Some("a move at feed with the coolant off: write COOLNT/FLOOD before"),
            _ => Some("a move at feed, and no statement since LOADTL starts the coolant: write COOLNT/FLOOD before"),
        };
        if let Some(reason) = dry {
            self.program.fault_once("coolant", reason);
        }
        if self.program.smoothing.is_none() {
            self.program.fault_once(
                "tolerance",
                "a move at feed, and nothing says how far the path may be left between poses: write LINTOL and a tolerance",
            );
        }
        if self.program.feed.is_none() {
            self.program.fault(
                "a move at feed without a feed since LOADTL or the last rapid: post-processors differ in whether RAPID still \
                 counts; write FEDRAT before",
            );
        }
        *self.program.feed.get_or_insert(1.0)
    }

    /// The path with the tool ends: its last move is the retract.
    fn leave(&mut self) {
        let Some(Path { begun, .. }) = self.path.take() else { return };
        if !begun {
            return self.program.fault("a path without GOTO: leave out FROM, or write RAPID and GOTO");
        }
        let Some(section) = self.program.section() else { return };
        let Some(NcMove { line, rapid, tip, direction: Direction::Axis(axis), .. }) = section.moves.pop() else {
            self.program.sections.pop();
            return;
        };
        if !rapid {
            self.program.fault(
                "the path ends at feed with the tool in the part: write RAPID and GOTO to the retract height before this \
                 statement",
            );
        }
        let end = NcPose { tip, axis };
        self.check_height("the last GOTO before this statement", &end);
        self.program.end_section(line, NcRetract::Pose(end));
    }

    fn finish(&mut self) {
        self.leave();
        if let (Setting::Said(_, line), Some(_)) = (self.program.setting(ModalGroup::Spindle), self.program.speed) {
            self.program
                .fault(format!("the program ends with the spindle on, by line {line}: write SPINDL/OFF before"));
        }
        if let Setting::Said("ON", line) = self.program.setting(ModalGroup::Coolant) {
            self.program.independent_fault(format!(
                "the program ends with the coolant on, by line {line}: write COOLNT/OFF before"
            ));
        }
        self.program.ended = true;
    }
}

fn tool_number(text: &str) -> Result<u32, String> {
    let value = number(text)?;
    if value.fract() == 0.0 && (1.0..=MAX_TOOL_NUMBER).contains(&value) {
        Ok(value as u32)
    } else {
        Err(format!("`{}` is no number of a tool", shown(text, 20)))
    }
}

fn positive(name: &str, text: &str, most: f64) -> Result<f64, String> {
    let value = number(text).map_err(|reason| format!("{name}: {reason}"))?;
    if value > 0.0 && value <= most {
        Ok(value)
    } else {
        Err(format!("{name} = {value} is out of range: more than 0, at most {most:.0}"))
    }
}

/// Values as a message shows them.
fn listed(values: &[&str]) -> String {
    shown(&values.join(","), 40)
}

/// Why a statement is not read.
fn not_read(word: &str) -> String {
    let why = match word {
        "CIRCLE" | "ARCMOV" | "MOVARC" | "SPLINE" | "NURBS" => "of motions only GOTO and MOVNRB are read",
        "GODLTA" | "GOFWD" | "GORGT" | "GOLFT" | "GOBACK" | "GOUP" | "GODOWN" => {
            "its target depends on more than its words; write GOTO"
        }
        "CYCLE" | "DRILL" | "POCKET" => "cycles are not read",
        "CUTCOM" => "the control would add the radius of the tool",
        "GOHOME" | "RETRCT" | "HOME" => "its way is that of one post-processor; write RAPID and GOTO",
        "TRANS" | "ORIGIN" | "TRACUT" | "COPY" | "COORD" | "CSYS" | "MCSYS" => "it shifts or turns the frame",
        "ROTATE" | "ROTABL" | "ROTHED" | "INDEX" => "it moves an axis of one machine",
        "INSERT" | "AUXFUN" | "PREFUN" | "APPEND" => "it holds words of one control",
        "INTOL" | "OUTTOL" | "TOLER" | "TLON" | "TLLFT" | "TLRGT" => "it belongs to a part program, not to CL data",
        "TOOLNO" | "TURRET" => "tools are loaded by LOADTL",
        _ => return format!("`{}` is not understood", shown(word, 20)),
    };
    format!("`{word}` is not understood: {why}")
}

/// Whether a line holds a statement that only CL data have.
pub(super) fn recognises(code: &str) -> bool {
    const OWN_WORDS: [&str; 10] =
        ["GOTO", "FROM", "FEDRAT", "LOADTL", "SPINDL", "COOLNT", "MULTAX", "CUTTER", "UNITS", "LINTOL"];
    code.split_once('/').is_some_and(|(word, _)| OWN_WORDS.contains(&word.trim()))
}
