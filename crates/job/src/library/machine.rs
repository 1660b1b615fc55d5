//! Machine files, with the reader of values that all library files share. Keys with their forms and ranges stand in `schema`.

use super::form;
use super::schema::{LINUXCNC, LibraryFile};
use super::table::{FileTable, SpannedText};
use crate::model::{CarriedSpec, LinearSpec, MachineKind, MachineSpec, RotarySpec};
use crate::property::quantity::{Dimension, KILOWATT, Quantity, library_units};
use crate::property::{Form, Range};
use base::source::{SourceId, SourceMap, Span};
use base::units::{Mm, MmPerMin, Rad, Rpm, trim};
use diagnostics::codes::job as codes;
use diagnostics::{Diag, Sink};
use five_axis::control::{LengthTo, Planning};
use nalgebra::Vector3;
use toml::Spanned;

/// Length of a vector in a machine file below which it gives no direction.
pub(super) const MIN_DIRECTION_LENGTH: f64 = 1e-6;

/// Word for the jerk of an axis whose control does not limit jerk.
const UNLIMITED: &str = "unlimited";

/// Keys of the axes.
const LINEAR: [&str; 3] = ["X", "Y", "Z"];
const ROTARY: [&str; 3] = ["A", "B", "C"];

/// A rotary axis by its letter.
type RotaryTable<'t, 'i> = (&'static str, FileTable<'t, 'i>);

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
    pub(super) fn quantity(&mut self, text: &SpannedText, due: Dimension, range: Range) -> f64 {
        let [_, max] = range.bounds();
        let units = library_units(due).join(", ");
        let help = format!("write the number and its unit in quotes; units are {units}");
        match Quantity::read(text.get_ref()) {
            Some(q) if q.dimension == due && range.holds(q.value) => return q.value,
            Some(q) if q.dimension == due => self.fault(
                self.span(text),
                format!("`{}` is out of range", text.get_ref()),
                format!("a value {} is expected", range.text(due)),
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

    /// A number that a key gives, in base units.
    pub(super) fn number(&mut self, table: FileTable<'_, '_>, name: &str) -> Option<f64> {
        match table.get(name)?.0.form {
            Form::Quantity(due, range) => Some(self.quantity(&table.text(name)?, due, range)),
            Form::Whole(..) => Some(f64::from(*table.whole(name)?.get_ref())),
            _ => None,
        }
    }

    /// As many quantities as a key gives, in base units.
    fn quantities<const N: usize>(&mut self, table: FileTable<'_, '_>, name: &str) -> Option<[f64; N]> {
        let Form::Quantities(due, range, _) = table.get(name)?.0.form else { return None };
        Some(table.texts_of::<N>(name)?.map(|text| self.quantity(&text, due, range)))
    }

    /// Both ends of a range.
    pub(super) fn pair(&mut self, table: FileTable<'_, '_>, name: &str) -> Option<[f64; 2]> {
        let pair = self.quantities(table, name)?;
        if pair[0] >= pair[1] {
            let texts: [SpannedText; 2] = table.texts_of(name)?;
            let span = Span { end: self.span(&texts[1]).end, ..self.span(&texts[0]) };
            let message = "the lower end of a travel must be first".to_owned();
            self.fault(
                span,
                message,
                "the first value is not below the second".to_owned(),
                "exchange or correct the two values",
            );
        }
        Some(pair)
    }

    fn linear(&mut self, table: FileTable<'_, '_>) -> Option<LinearSpec> {
        Some(LinearSpec {
            travel: self.pair(table, "travel")?.map(Mm),
            speed: MmPerMin(self.number(table, "speed")?),
            acceleration: self.number(table, "acceleration")? / 3600.0,
            jerk: self.jerk(&table.text("jerk"), Dimension::JERK),
        })
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
                let range = Range::Between(least * 216_000.0, most * 216_000.0);
                self.quantity(text, due, range) / 216_000.0
            }
            _ => f64::INFINITY,
        }
    }

    fn point(&mut self, table: FileTable<'_, '_>, name: &str) -> Option<[Mm; 3]> {
        Some(self.quantities(table, name)?.map(Mm))
    }

    /// Sections of a solid of revolution: the values of three keys.
    pub(super) fn sections(&mut self, table: FileTable<'_, '_>, names: [&str; 3]) -> Vec<[Mm; 3]> {
        let mut size = |section, name| Mm(self.number(section, name).unwrap_or_default());
        table.tables("section").into_iter().map(|section| names.map(|name| size(section, name))).collect()
    }

    fn carried(&mut self, table: FileTable<'_, '_>) -> Option<CarriedSpec> {
        let top = Mm(self.number(table, "top")?);
        Some(CarriedSpec { top, sections: self.sections(table, ["length", "upper", "lower"]) })
    }

    /// Direction of a rotary axis, of length 1. Where the file gives none, the letter determines the axis: X, Y or Z.
    fn direction(&mut self, name: &str, table: FileTable<'_, '_>) -> [f64; 3] {
        let usual = ["A", "B", "C"].map(|letter| if letter == name { 1.0 } else { 0.0 });
        let Some(given) = table.numbers("direction") else { return usual };
        match Vector3::from(*given.get_ref()).try_normalize(MIN_DIRECTION_LENGTH) {
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

    /// Which rotary axes carry what.
    fn machine_kind(&mut self, text: &SpannedText) -> Option<MachineKind> {
        let kind = MachineKind::ALL.into_iter().find(|kind| kind.name() == text.get_ref());
        if kind.is_none() {
            let known = MachineKind::ALL.map(|kind| format!("\"{}\"", kind.name())).join(", ");
            self.fault(
                self.span(text),
                format!("`{}` is not a kind of machine", text.get_ref()),
                format!("one of {known} is expected"),
                "write table-table if both rotary axes carry the part, head-head if both carry the tool, head-table if each carries one",
            );
        }
        kind
    }

    /// The two rotary axes of a machine file, first the axis next to the tool.
    fn rotary_axes<'t, 'i>(&mut self, table: FileTable<'t, 'i>) -> Option<[RotaryTable<'t, 'i>; 2]> {
        let axes = table.table("axes")?;
        let present: Vec<_> = ROTARY.into_iter().filter_map(|name| Some((name, axes.table(name)?))).collect();
        // Without `order`, the letters decide: the axis next to the tool is A or B on usual machines.
        let pair: [RotaryTable<'_, '_>; 2] = present.try_into().ok()?;
        let Some(order) = table.texts_of::<2>("order") else { return Some(pair) };
        let names = order.each_ref().map(|name| name.get_ref().as_str());
        let [(first, _), (second, _)] = pair;
        if names == [first, second] {
            Some(pair)
        } else if names == [second, first] {
            Some([pair[1], pair[0]])
        } else {
            self.fault(
                self.span(&order[0]),
                "`order` does not name both rotary axes".to_owned(),
                format!("\"{first}\" and \"{second}\" are expected"),
                "name the axis next to the tool first, then the axis next to the part",
            );
            None
        }
    }

    /// Control cycle, s.
    fn cycle(&mut self, table: FileTable<'_, '_>, assumed: &mut Vec<String>) -> Option<f64> {
        let given = self.number(table, "cycle");
        let cycle = given.or_else(|| table.default("cycle"))? * 60.0;
        if given.is_none() {
            assumed.push(format!("control cycle {} s, the default", trim(cycle, 6)));
        }
        Some(cycle)
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
    fn retract(&mut self, table: FileTable<'_, '_>, [low, top]: [Mm; 2], assumed: &mut Vec<String>) -> Mm {
        match table.table("retract").and_then(|retract| retract.text("z")) {
            Some(z) => self.place(&z, "retract height", [low.get(), top.get()], ["the travel of Z"; 2]),
            None => {
                let top_text = trim(top.get(), 6);
                assumed.push(format!("retract to the upper end of the travel of Z, {top_text} mm, the default"));
                top
            }
        }
    }

    fn rotary(&mut self, name: &str, table: FileTable<'_, '_>) -> Option<RotarySpec> {
        let sense = table.text("sense")?;
        let iso = match sense.get_ref().as_str() {
            "iso" => true,
            "opposite" => false,
            other => {
                self.fault(
                    self.span(&sense),
                    format!("`{other}` is not a sense of a rotary axis"),
                    "\"iso\" or \"opposite\" is expected".to_owned(),
                    "write \"iso\" if a positive word turns the tool right-handed relative to the part, otherwise \"opposite\"",
                );
                true
            }
        };
        let (travel, modulo) = self.turns(name, table, self.span(&sense))?;
        Some(RotarySpec {
            name: name.to_owned(),
            direction: self.direction(name, table),
            travel: travel.map(Rad),
            modulo,
            clamp: table.texts_of("clamp").map(|words| self.clamp(name, &words)),
            speed: self.number(table, "speed")? / 60.0,
            acceleration: self.number(table, "acceleration")? / 3600.0,
            jerk: self.jerk(&table.text("jerk"), Dimension::TURNING_JERK),
            iso,
            point: self.point(table, "point")?,
        })
    }

    /// All of the file but its kind and its rotary axes.
    fn spec(
        &mut self,
        name: &str,
        table: FileTable<'_, '_>,
        kind: base::source::Spanned<MachineKind>,
        axes: [RotaryTable<'_, '_>; 2],
    ) -> Option<MachineSpec> {
        let mut assumed: Vec<String> =
            table.texts("assumed").unwrap_or_default().into_iter().map(Spanned::into_inner).collect();
        let own_words = self.own_words(&table.texts("own-words").unwrap_or_default(), &mut assumed);
        let cycle = self.cycle(table, &mut assumed)?;
        let planning = self.planning(&table.text("planning"));
        let of_axes = table.table("axes")?;
        let [x, y, z] = LINEAR.map(|name| of_axes.table(name));
        let linear = [(LINEAR[0], x?), (LINEAR[1], y?), (LINEAR[2], z?)];
        assumed.extend(silent_jerks(linear.into_iter().chain(axes)));
        let linear = linear.map(|(_, axis)| self.linear(axis));
        let linear = [linear[0]?, linear[1]?, linear[2]?];
        let retract = self.retract(table, linear[2].travel, &mut assumed);
        let home = self.home(table.table("home"), &linear, retract);
        let help = "lengths are measured to the tip, or to the centre of the ball or of the corner radius";
        let points = LengthTo::ALL.map(|point| (point, point.name()));
        let length_to = self.named(&table.text("tool-length"), "tool-length", help, points);
        let [first, second] = axes.map(|(name, table)| self.rotary(name, table));
        let (part, spindle) = (table.table("part")?, table.table("spindle")?);
        Some(MachineSpec {
            name: name.to_owned(),
            linear,
            retract,
            home,
            length_to,
            kind,
            rotary: [first?, second?],
            part_origin: base::source::Spanned::new(self.point(part, "origin")?, part.span("origin", self.source)?),
            part_axes: self.part_axes(part),
            part_direction: part.has("direction"),
            spindle: self.pair(spindle, "speed")?.map(Rpm),
            power: self.number(spindle, "power").map(|power| power / KILOWATT),
            rapid: MmPerMin(self.number(table, "rapid")?),
            cycle,
            planning,
            table: table.table("table").and_then(|table| self.carried(table)),
            fixture: table.table("fixture").and_then(|table| self.carried(table)),
            own_words,
            assumed,
        })
    }
}

/// The diagnostic for a machine without exactly two rotary axes.
fn no_rotary_pair(name: &str, table: FileTable<'_, '_>, file: &str) -> Diag {
    let axes = table.table("axes");
    let has: Vec<&str> = ROTARY.into_iter().filter(|name| axes.is_some_and(|axes| axes.has(name))).collect();
    let count = match &has[..] {
        [] => "no rotary axis".to_owned(),
        [one] => format!("the rotary axis {one} alone"),
        more => format!("the rotary axes {}", more.join(", ")),
    };
    Diag::error(codes::NO_ROTARY_AXIS, format!("the machine `{name}` has {count}"))
        .help(format!("add two rotary axes, such as [axes.A] and [axes.C], to {file}, or use another machine",))
}

/// Names the axes whose entries in the file have no jerk.
fn silent_jerks<'a>(axes: impl Iterator<Item = RotaryTable<'a, 'a>>) -> Option<String> {
    let silent: Vec<&str> = axes.filter(|axis| !axis.1.has("jerk")).map(|axis| axis.0).collect();
    (!silent.is_empty()).then(|| format!("no limit of the jerk of {}, the default", silent.join(", ")))
}

/// Reads a machine file that is already in the source map. `used` is its place in the job.
pub(crate) fn machine(
    name: &str,
    source: SourceId,
    sources: &SourceMap,
    used: Span,
    sink: &mut Sink,
) -> Option<MachineSpec> {
    let file = sources.get(source)?;
    form::read(LibraryFile::Machine, source, sources, Some(used), sink, |table, sink| {
        let mut reader = LibraryReader { source, sink, faults: false };
        let kind = table.text("kind")?;
        let kind = base::source::Spanned::new(reader.machine_kind(&kind)?, reader.span(&kind));
        let Some(axes) = reader.rotary_axes(table) else {
            if !reader.faults {
                sink.push(no_rotary_pair(name, table, &file.name).label(used, "used here"));
            }
            return None;
        };
        let spec = reader.spec(name, table, kind, axes);
        spec.filter(|_| !reader.faults)
    })
}
