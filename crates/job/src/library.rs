//! Machine files: TOML through serde, with the reader of quantities that all library files share. Unknown keys are errors, and every quantity has its unit.

use super::library_form;
use super::library_schema::LibraryFile;
use super::limits;
use super::model::{CarriedSpec, LinearSpec, MachineKind, MachineSpec, RotarySpec};
use super::quantity::{Dimension, KILOWATT, Quantity, library_units};
use base::source::{SourceId, SourceMap, Span};
use base::units::{Mm, MmPerMin, Rad, Rpm, trim};
use diagnostics::codes::job as codes;
use diagnostics::{Diag, Sink};
use five_axis::control::{LengthTo, Planning};
use nalgebra::Vector3;
use serde::Deserialize;
use toml::Spanned;

/// Length of a vector in a machine file below which it gives no direction.
pub(super) const NO_DIRECTION: f64 = 1e-6;

/// Cycle times of controls, s.
const CYCLE: [f64; 2] = [1e-6, 1e-2];

pub(super) type SpannedText = Spanned<String>;

/// Largest length in library files, mm.
const LONGEST: f64 = 100_000.0;

/// Largest size of tables and fixtures, mm: their surfaces are sampled.
const MOST_CARRIED: f64 = 1000.0;

/// Control cycle where the machine file gives none, s. The value is slow for controls of milling machines, so that the
/// deviation of the joints between two positions is not underestimated.
const DEFAULT_CYCLE: f64 = 0.002;

/// Name of the trajectory planner of LinuxCNC in machine files.
pub(super) const LINUXCNC: &str = "linuxcnc-2.9";

/// Word for the jerk of an axis whose control does not limit jerk.
const UNLIMITED: &str = "unlimited";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MachineFile {
    kind: SpannedText,
    order: Option<Vec<SpannedText>>,
    #[serde(default)]
    #[expect(dead_code, reason = "for the reader of the file")]
    about: String,
    #[serde(default)]
    assumed: Vec<String>,
    #[serde(default, rename = "own-words")]
    own_words: Vec<SpannedText>,
    axes: AxesTable,
    part: PartTable,
    spindle: SpindleTable,
    retract: Option<RetractTable>,
    home: Option<HomeTable>,
    #[serde(rename = "tool-length")]
    tool_length: Option<SpannedText>,
    rapid: SpannedText,
    cycle: Option<SpannedText>,
    planning: Option<SpannedText>,
    table: Option<CarriedTable>,
    fixture: Option<CarriedTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CarriedTable {
    top: SpannedText,
    section: Vec<SectionTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AxesTable {
    #[serde(rename = "X")]
    x: LinearTable,
    #[serde(rename = "Y")]
    y: LinearTable,
    #[serde(rename = "Z")]
    z: LinearTable,
    #[serde(rename = "A")]
    a: Option<RotaryTable>,
    #[serde(rename = "B")]
    b: Option<RotaryTable>,
    #[serde(rename = "C")]
    c: Option<RotaryTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LinearTable {
    travel: [SpannedText; 2],
    speed: SpannedText,
    acceleration: SpannedText,
    jerk: Option<SpannedText>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RotaryTable {
    pub(super) travel: Option<Spanned<[SpannedText; 2]>>,
    pub(super) modulo: Option<Spanned<bool>>,
    pub(super) way: Option<SpannedText>,
    clamp: Option<[SpannedText; 2]>,
    speed: SpannedText,
    acceleration: SpannedText,
    jerk: Option<SpannedText>,
    sense: SpannedText,
    direction: Option<Spanned<[f64; 3]>>,
    point: [SpannedText; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PartTable {
    origin: Spanned<[SpannedText; 3]>,
    pub(super) direction: Option<Spanned<[f64; 3]>>,
    #[serde(rename = "x-direction")]
    pub(super) x_direction: Option<Spanned<[f64; 3]>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RetractTable {
    z: SpannedText,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct HomeTable {
    pub(super) x: Option<SpannedText>,
    pub(super) y: Option<SpannedText>,
    pub(super) z: Option<SpannedText>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SpindleTable {
    speed: [SpannedText; 2],
    power: Option<SpannedText>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SectionTable {
    pub(super) length: SpannedText,
    pub(super) lower: SpannedText,
    pub(super) upper: SpannedText,
}

pub(super) struct LibraryReader<'a> {
    pub(super) source: SourceId,
    pub(super) sink: &'a mut Sink,
    pub(super) faults: bool,
}

impl LibraryReader<'_> {
    pub(super) fn span<T>(&self, value: &Spanned<T>) -> Span {
        Span::new(self.source, value.span())
    }

    pub(super) fn fault(&mut self, span: Span, message: String, label: String, help: &str) {
        self.faults = true;
        self.sink.push(Diag::error(codes::LIBRARY, message).label(span, label).help(help));
    }

    /// A quantity in base units.
    pub(super) fn quantity(&mut self, text: &SpannedText, due: Dimension, min: f64, max: f64) -> f64 {
        let units = library_units(due).join(", ");
        let help = format!("write the number and its unit in quotes; units are {units}");
        match Quantity::read(text.get_ref()) {
            Some(q) if q.dimension == due && (min..=max).contains(&q.value) => return q.value,
            Some(q) if q.dimension == due => self.fault(
                self.span(text),
                format!("`{}` is out of range", text.get_ref()),
                format!("a value from {} to {} {} is expected", due.bound(min), due.bound(max), base(due)),
                "correct the value",
            ),
            Some(q) => self.fault(
                self.span(text),
                format!("`{}` is {}, not {due}", text.get_ref(), q.dimension),
                format!("{due} is expected"),
                &help,
            ),
            None => self.fault(
                self.span(text),
                format!("`{}` is not a number with a unit", text.get_ref()),
                format!("{due} is expected"),
                &help,
            ),
        }
        max.min(1.0)
    }

    pub(super) fn pair(&mut self, texts: &[SpannedText; 2], due: Dimension, bound: f64) -> [f64; 2] {
        let pair = [self.quantity(&texts[0], due, -bound, bound), self.quantity(&texts[1], due, -bound, bound)];
        if pair[0] >= pair[1] {
            let span = Span { end: self.span(&texts[1]).end, ..self.span(&texts[0]) };
            let message = "the lower end of a travel must be first".to_owned();
            self.fault(
                span,
                message,
                "the first value is not below the second".to_owned(),
                "exchange or correct the two values",
            );
        }
        pair
    }

    fn linear(&mut self, table: &LinearTable) -> LinearSpec {
        LinearSpec {
            travel: self.pair(&table.travel, Dimension::LENGTH, LONGEST).map(Mm),
            speed: MmPerMin(self.quantity(&table.speed, Dimension::FEED, 1.0, 1e6)),
            acceleration: self.quantity(&table.acceleration, Dimension::ACCELERATION, 3600.0, 3.6e9) / 3600.0,
            jerk: self.jerk(&table.jerk, Dimension::JERK),
        }
    }

    /// A limit of jerk in units of seconds; an absent value means no limit.
    fn jerk(&mut self, text: &Option<SpannedText>, due: Dimension) -> f64 {
        match text {
            Some(text) if text.get_ref() != UNLIMITED && Quantity::read(text.get_ref()).is_none() => {
                self.fault(
                    self.span(text),
                    format!("`{}` is not a jerk limit", text.get_ref()),
                    format!("{due} or \"{UNLIMITED}\" is expected"),
                    &format!(
                        "write \"50 {}\", or \"{UNLIMITED}\" for a control that does not limit jerk",
                        due.usual_unit()
                    ),
                );
                f64::INFINITY
            }
            Some(text) if text.get_ref() != UNLIMITED => {
                let (least, most) = if due == Dimension::JERK { (1.0, 1e9) } else { (1e-3, 1e6) };
                self.quantity(text, due, least * 216_000.0, most * 216_000.0) / 216_000.0
            }
            _ => f64::INFINITY,
        }
    }

    fn point(&mut self, texts: &[SpannedText; 3]) -> [Mm; 3] {
        let [x, y, z] = texts;
        [x, y, z].map(|t| Mm(self.quantity(t, Dimension::LENGTH, -LONGEST, LONGEST)))
    }

    fn carried(&mut self, table: &CarriedTable) -> CarriedSpec {
        let mut length = |text: &SpannedText, min: f64| Mm(self.quantity(text, Dimension::LENGTH, min, MOST_CARRIED));
        CarriedSpec {
            top: length(&table.top, -MOST_CARRIED),
            sections: table.section.iter().map(|s| [&s.length, &s.upper, &s.lower].map(|t| length(t, 0.01))).collect(),
        }
    }

    /// Direction of a rotary axis, of length 1. Where the file gives none, the letter determines the axis: X, Y or Z.
    fn direction(&mut self, name: &str, table: &RotaryTable) -> [f64; 3] {
        let usual = ["A", "B", "C"].map(|letter| if letter == name { 1.0 } else { 0.0 });
        let Some(given) = &table.direction else { return usual };
        match Vector3::from(*given.get_ref()).try_normalize(NO_DIRECTION) {
            Some(direction) if direction.iter().all(|x| x.is_finite()) => direction.into(),
            _ => {
                self.fault(
                    Span::new(self.source, given.span()),
                    format!("axis {name} has no direction"),
                    "three numbers are expected, at least one of them not 0".to_owned(),
                    "write the direction in the machine frame with all axes at zero, such as [0, 1, 1] for a nutating axis",
                );
                usual
            }
        }
    }

    /// The two rotary axes of a machine file, first the axis next to the tool, and which carries what.
    fn rotary_axes<'t>(&mut self, table: &'t MachineFile) -> Option<(MachineKind, [(&'t str, &'t RotaryTable); 2])> {
        let kind = MachineKind::ALL.into_iter().find(|kind| kind.name() == table.kind.get_ref());
        let Some(kind) = kind else {
            let known = MachineKind::ALL.map(|kind| format!("\"{}\"", kind.name())).join(", ");
            self.fault(
                self.span(&table.kind),
                format!("`{}` is not a kind of machine", table.kind.get_ref()),
                format!("one of {known} is expected"),
                "write table-table if both rotary axes carry the part, head-head if both carry the tool, head-table if each carries one",
            );
            return None;
        };
        let axes = &table.axes;
        let present = [("A", &axes.a), ("B", &axes.b), ("C", &axes.c)];
        let present: Vec<(&str, &RotaryTable)> =
            present.into_iter().filter_map(|(n, t)| Some((n, t.as_ref()?))).collect();
        // Without `order`, the letters decide: the axis next to the tool is A or B on usual machines.
        let Ok(pair) = <[(&str, &RotaryTable); 2]>::try_from(present) else { return None };
        let Some(order) = &table.order else { return Some((kind, pair)) };
        let names: Vec<&str> = order.iter().map(|name| name.get_ref().as_str()).collect();
        let [(first, _), (second, _)] = pair;
        if names == [first, second] {
            Some((kind, pair))
        } else if names == [second, first] {
            Some((kind, [pair[1], pair[0]]))
        } else {
            let span = order.first().map_or(self.span(&table.kind), |name| self.span(name));
            self.fault(
                span,
                "`order` does not name both rotary axes".to_owned(),
                format!("\"{first}\" and \"{second}\" are expected"),
                "name the axis next to the tool first, then the axis next to the part",
            );
            None
        }
    }

    /// Control cycle, s.
    fn cycle(&mut self, text: &Option<SpannedText>, assumed: &mut Vec<String>) -> f64 {
        match text {
            Some(text) => self.quantity(text, Dimension::TIME, CYCLE[0], CYCLE[1]) * 60.0,
            None => {
                assumed.push(format!("control cycle {} s, the default", trim(DEFAULT_CYCLE, 6)));
                DEFAULT_CYCLE
            }
        }
    }

    /// Power of the spindle, kW.
    fn power(&mut self, text: &SpannedText) -> f64 {
        let [least, most] = limits::POWER.map(|kilowatt| kilowatt * KILOWATT);
        self.quantity(text, Dimension::POWER, least, most) / KILOWATT
    }

    /// How the control plans speeds.
    fn planning(&mut self, text: &Option<SpannedText>) -> Planning {
        match text {
            None => Planning::Joints,
            Some(text) if text.get_ref() == LINUXCNC => Planning::LinuxCnc,
            Some(text) => {
                self.fault(
                    self.span(text),
                    format!("the value `{}` of `planning` is not known", text.get_ref()),
                    format!("only \"{LINUXCNC}\" is known"),
                    "remove the line for a control with look-ahead that keeps the limits of every joint",
                );
                Planning::Joints
            }
        }
    }

    /// Words of the machine builder: M and a number.
    fn own_words(&mut self, words: &[SpannedText], assumed: &mut Vec<String>) -> Vec<String> {
        for word in words {
            let digits = word.get_ref().strip_prefix('M').unwrap_or_default();
            let plain = (1..=4).contains(&digits.len()) && digits.bytes().all(|b| b.is_ascii_digit());
            if !plain || digits.starts_with('0') {
                self.fault(
                    self.span(word),
                    format!("`{}` is not an M word of the machine builder", word.get_ref()),
                    "a word such as \"M200\" is expected".to_owned(),
                    "write M and 1 to 4 digits, without leading zeros",
                );
            }
        }
        let words: Vec<String> = words.iter().map(|word| word.get_ref().clone()).collect();
        if !words.is_empty() {
            assumed.push(format!("{} change neither path, tool, spindle nor coolant", words.join(", ")));
        }
        words
    }

    /// Retract height, within the travel of Z.
    fn retract(&mut self, table: &Option<RetractTable>, [low, top]: [Mm; 2], assumed: &mut Vec<String>) -> Mm {
        match table {
            Some(t) => self.place(&t.z, "retract height", [low.get(), top.get()], ["the travel of Z"; 2]),
            None => {
                let top_text = trim(top.get(), 6);
                assumed.push(format!("retract to the upper end of the travel of Z, {top_text} mm, the default"));
                top
            }
        }
    }

    fn rotary(&mut self, name: &str, table: &RotaryTable) -> RotarySpec {
        let iso = match table.sense.get_ref().as_str() {
            "iso" => true,
            "opposite" => false,
            other => {
                self.fault(
                    self.span(&table.sense),
                    format!("`{other}` is not a sense of a rotary axis"),
                    "\"iso\" or \"opposite\" is expected".to_owned(),
                    "write \"iso\" if a positive word turns the tool right-handed relative to the part, otherwise \"opposite\"",
                );
                true
            }
        };
        let (travel, modulo) = self.turns(name, table, self.span(&table.sense));
        RotarySpec {
            name: name.to_owned(),
            direction: self.direction(name, table),
            travel: travel.map(Rad),
            modulo,
            clamp: table.clamp.as_ref().map(|words| self.clamp(name, words)),
            speed: self.quantity(&table.speed, Dimension::TURNING, 1e-3, 1e6) / 60.0,
            acceleration: self.quantity(&table.acceleration, Dimension::TURNING_ACCELERATION, 1e-3, 1e9) / 3600.0,
            jerk: self.jerk(&table.jerk, Dimension::TURNING_JERK),
            iso,
            point: self.point(&table.point),
        }
    }
}

fn base(due: Dimension) -> &'static str {
    match due {
        Dimension::TURNING => "rad/min",
        Dimension::ACCELERATION => "mm/min2",
        Dimension::TURNING_ACCELERATION => "rad/min2",
        Dimension::JERK => "mm/min3",
        Dimension::TURNING_JERK => "rad/min3",
        other => other.usual_unit(),
    }
}

/// The diagnostic for a machine without exactly two rotary axes.
fn no_rotary_pair(name: &str, axes: &AxesTable, file: &str) -> Diag {
    let has = |axis: &Option<RotaryTable>, name| axis.as_ref().map(|_| name);
    let has: Vec<&str> = [has(&axes.a, "A"), has(&axes.b, "B"), has(&axes.c, "C")].into_iter().flatten().collect();
    let count = match &has[..] {
        [] => "no rotary axis".to_owned(),
        [one] => format!("the rotary axis {one} alone"),
        more => format!("the rotary axes {}", more.join(", ")),
    };
    Diag::error(codes::NO_ROTARY_AXIS, format!("the machine `{name}` has {count}"))
        .help(format!("add two rotary axes, such as [axes.A] and [axes.C], to {file}, or use another machine",))
}

/// Names the axes whose entries in the file have no jerk.
fn silent_jerks(table: &AxesTable, [first, second]: [(&str, &RotaryTable); 2]) -> Option<String> {
    let jerks = [
        ("X", &table.x.jerk),
        ("Y", &table.y.jerk),
        ("Z", &table.z.jerk),
        (first.0, &first.1.jerk),
        (second.0, &second.1.jerk),
    ];
    let silent: Vec<&str> = jerks.into_iter().filter(|j| j.1.is_none()).map(|j| j.0).collect();
    (!silent.is_empty()).then(|| format!("no limit of the jerk of {}, the default", silent.join(", ")))
}

/// Reads a machine file that is already in the source map. `asked` is its place in the job.
pub(super) fn machine(
    name: &str,
    source: SourceId,
    sources: &SourceMap,
    asked: Span,
    sink: &mut Sink,
) -> Option<MachineSpec> {
    let file = sources.get(source)?;
    let table: MachineFile = library_form::read(LibraryFile::Machine, source, sources, Some(asked), sink)?;
    let mut reader = LibraryReader { source, sink, faults: false };
    let Some((kind, axes)) = reader.rotary_axes(&table) else {
        if !reader.faults {
            sink.push(no_rotary_pair(name, &table.axes, &file.name).label(asked, "used here"));
        }
        return None;
    };
    let mut assumed = table.assumed.clone();
    let own_words = reader.own_words(&table.own_words, &mut assumed);
    let cycle = reader.cycle(&table.cycle, &mut assumed);
    let planning = reader.planning(&table.planning);
    assumed.extend(silent_jerks(&table.axes, axes));
    let linear = [reader.linear(&table.axes.x), reader.linear(&table.axes.y), reader.linear(&table.axes.z)];
    let retract = reader.retract(&table.retract, linear[2].travel, &mut assumed);
    let home = reader.home(&table.home, &linear, retract);
    let help = "lengths are measured to the tip, or to the centre of the ball or of the corner radius";
    let points = LengthTo::ALL.map(|point| (point, point.name()));
    let length_to = reader.named(&table.tool_length, ("tool-length", help), points);
    let rotary = axes.map(|(name, table)| reader.rotary(name, table));
    let spec = MachineSpec {
        name: name.to_owned(),
        linear,
        retract,
        home,
        length_to,
        kind: (kind, reader.span(&table.kind)),
        rotary,
        part_origin: (reader.point(table.part.origin.get_ref()), reader.span(&table.part.origin)),
        part_axes: reader.part_axes(&table.part),
        part_direction: table.part.direction.is_some(),
        spindle: reader.pair(&table.spindle.speed, Dimension::SPINDLE, 1e6).map(Rpm),
        power: (table.spindle.power.as_ref()).map(|text| reader.power(text)),
        rapid: MmPerMin(reader.quantity(&table.rapid, Dimension::FEED, 1.0, 1e6)),
        cycle,
        planning,
        table: table.table.as_ref().map(|t| reader.carried(t)),
        fixture: table.fixture.as_ref().map(|t| reader.carried(t)),
        own_words,
        assumed,
    };
    (!reader.faults).then_some(spec)
}
