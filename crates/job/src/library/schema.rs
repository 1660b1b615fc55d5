//! Keys of the files of the library as JSON schemas, for editors that complete and check TOML. A test compares the keys with
//! those that the readers of the files know.

use crate::model::MachineKind;
use crate::model::tool as tool_model;
use crate::property::limits;
use crate::property::quantity::{Dimension, KILOWATT, library_units};
use crate::property::{Form, Property, Range, Without, typed};
use five_axis::control::{LengthTo, ModuloWay};
use serde_json::{Map, Value, json};
use wheel::control::{Orientation, SplineForm};
use wheel::post_file::LineEnd;

/// Kind of a library file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LibraryFile {
    /// A machine.
    Machine,
    /// Tools and holders.
    Tools,
    /// A dialect with its frames.
    Post,
}

impl LibraryFile {
    /// The kind of the files in a folder of the library.
    pub fn of_folder(name: &str) -> Option<Self> {
        let folders = [("machines", Self::Machine), ("tools", Self::Tools), ("posts", Self::Post)];
        folders.into_iter().find(|(folder, _)| *folder == name).map(|(_, kind)| kind)
    }

    /// The keys at the top of the file.
    pub(crate) fn keys(self) -> &'static [Property] {
        match self {
            Self::Machine => MACHINE,
            Self::Tools => TOOLS,
            Self::Post => POST,
        }
    }
}

/// Name of the trajectory planner of LinuxCNC in machine files.
pub(crate) const LINUXCNC: &str = "linuxcnc-2.9";

/// Largest length in library files, mm.
const MAX_LENGTH_MM: f64 = 100_000.0;

/// Largest size of tables and fixtures, mm: their surfaces are sampled.
const MAX_CARRIED: f64 = 1000.0;

/// A key that a table must have.
const fn must(name: &'static str, form: Form, meaning: &'static str) -> Property {
    typed(name, form, Without::Required, meaning)
}

/// A key that a table may have.
const fn may(name: &'static str, form: Form, meaning: &'static str) -> Property {
    typed(name, form, Without::Nothing, meaning)
}

const fn quantity_of(due: Dimension, least: f64, most: f64) -> Form {
    Form::Quantity(due, Range::Between(least, most))
}

/// In rad/min.
const DEGREE_PER_SECOND: f64 = 60.0 * std::f64::consts::PI / 180.0;

/// A place along an axis.
const PLACE: Form = Form::Quantity(Dimension::LENGTH, Range::Within(MAX_LENGTH_MM));
const POINT: Form = Form::Quantities(Dimension::LENGTH, Range::Within(MAX_LENGTH_MM), 3);
const SPEED: Form = quantity_of(Dimension::FEED, 1.0, 1e6);
const POWER: Form = quantity_of(Dimension::POWER, limits::POWER[0] * KILOWATT, limits::POWER[1] * KILOWATT);
const TURN: Form = quantity_of(Dimension::ANGLE, limits::TURN[0], limits::TURN[1]);
const TEXT: Form = Form::Text("a text");

const ABOUT: Property = may("about", TEXT, "A line for the reader of the file.");

const LINEAR: &[Property] = &[
    must(
        "travel",
        Form::Quantities(Dimension::LENGTH, Range::Within(MAX_LENGTH_MM), 2),
        "Both ends of the travel; of Z those of the gauge line.",
    ),
    must("speed", SPEED, "Largest speed."),
    must("acceleration", quantity_of(Dimension::ACCELERATION, 3600.0, 3.6e9), "Largest acceleration."),
    may("jerk", TEXT, "Largest jerk such as \"50 m/s3\", or \"unlimited\"; without it unlimited."),
];

const ROTARY: &[Property] = &[
    may(
        "travel",
        Form::Quantities(Dimension::ANGLE, Range::Within(1e5), 2),
        "Both ends of the travel; none with `modulo = true`.",
    ),
    may("modulo", Form::Flag, "True for an axis without limits, whose words the control takes modulo 360 deg."),
    may(
        "way",
        Form::Word(|| ModuloWay::ALL.map(ModuloWay::name).to_vec()),
        "The way that the control takes, with `modulo = true`.",
    ),
    may("clamp", Form::TextsOf(2), "M words that clamp and unclamp the axis."),
    must("speed", quantity_of(Dimension::TURNING, 1e-3 * DEGREE_PER_SECOND, 1e6 * DEGREE_PER_SECOND), "Largest speed."),
    must(
        "acceleration",
        quantity_of(Dimension::TURNING_ACCELERATION, 1e-6 * 3600.0, 1e6 * 3600.0),
        "Largest acceleration.",
    ),
    may("jerk", TEXT, "Largest jerk such as \"200 rad/s3\", or \"unlimited\"; without it unlimited."),
    must(
        "sense",
        Form::Word(|| vec!["iso", "opposite"]),
        "iso: a positive word turns the tool right-handed against the part.",
    ),
    may(
        "direction",
        Form::Numbers(3),
        "Direction in the machine frame with all axes at zero; without it by the letter.",
    ),
    must("point", POINT, "A point of the axis in the machine frame, all axes at zero."),
];

/// A section of a holder, or of table and fixture.
const fn section(least: f64) -> [Property; 3] {
    let size = quantity_of(Dimension::LENGTH, least, MAX_CARRIED);
    [
        must("length", size, "Length along the axis."),
        must("lower", size, "Diameter at the lower end."),
        must("upper", size, "Diameter at the upper end."),
    ]
}

const CARRIED: &[Property] = &[
    must("top", Form::Quantity(Dimension::LENGTH, Range::Within(MAX_CARRIED)), "Height of the top."),
    must("section", Form::Tables(&section(0.01)), "Sections downwards from the top."),
];

const AXES: &[Property] = &[
    must("X", Form::Table(LINEAR), "Linear axis X."),
    must("Y", Form::Table(LINEAR), "Linear axis Y."),
    must("Z", Form::Table(LINEAR), "Linear axis Z."),
    may("A", Form::Table(ROTARY), "Rotary axis A."),
    may("B", Form::Table(ROTARY), "Rotary axis B."),
    may("C", Form::Table(ROTARY), "Rotary axis C."),
];

const MACHINE: &[Property] = &[
    must(
        "kind",
        Form::Word(|| MachineKind::ALL.map(MachineKind::name).to_vec()),
        "What the rotary axes carry: part or tool.",
    ),
    may(
        "order",
        Form::TextsOf(2),
        "Names of the rotary axes, first the one next to the tool; without it by the alphabet.",
    ),
    ABOUT,
    may("assumed", Form::Texts, "What nobody measured; the setup sheet lists it."),
    may("own-words", Form::Texts, "M words of the machine builder that frames of a post may have."),
    must("axes", Form::Table(AXES), "The axes: X, Y, Z and two of A, B, C."),
    must(
        "part",
        Form::Table(&[
            must("origin", POINT, "Origin of the part, all axes at zero."),
            may("direction", Form::Numbers(3), "Where Z of the part points, all axes at zero; without it along Z."),
            may("x-direction", Form::Numbers(3), "Where X of the part points, all axes at zero; without it along X."),
        ]),
        "Where the part is.",
    ),
    must(
        "spindle",
        Form::Table(&[
            must("speed", Form::Quantities(Dimension::SPINDLE, Range::Within(1e6), 2), "Least and largest speed."),
            may("power", POWER, "Power at the cutter; without it no limit."),
        ]),
        "The spindle.",
    ),
    may(
        "retract",
        Form::Table(&[must("z", PLACE, "Height of the gauge line.")]),
        "Where tools change; without it the upper end of the travel of Z.",
    ),
    may(
        "home",
        Form::Table(&[may("x", PLACE, "X."), may("y", PLACE, "Y."), may("z", PLACE, "Z of the gauge line.")]),
        "Where the machine parks at the end of a program.",
    ),
    may(
        "tool-length",
        Form::Word(|| LengthTo::ALL.map(LengthTo::name).to_vec()),
        "What lengths in the tool table refer to; without it the tip.",
    ),
    must("rapid", SPEED, "Speed of the tip at rapid."),
    typed(
        "cycle",
        quantity_of(Dimension::TIME, 1e-6 / 60.0, 1e-2 / 60.0),
        // Slow for controls of milling machines, so that the deviation of the joints between two positions is not
        // underestimated.
        Without::Is("0.002 s"),
        "Time between two positions that the control gives.",
    ),
    may("planning", Form::Word(|| vec![LINUXCNC]), "Trajectory planner of the control, where it is known."),
    may("table", Form::Table(CARRIED), "The table, a solid of revolution; heights in the machine frame."),
    may("fixture", Form::Table(CARRIED), "The fixture, a solid of revolution; heights in the part frame."),
];

const TOOLS: &[Property] = &[
    ABOUT,
    may(
        "holder",
        Form::Named(&[ABOUT, must("section", Form::Tables(&section(0.001)), "Sections upwards from the nose.")]),
        "Holders by their names.",
    ),
    may("tool", Form::Named(tool_model::KEYS), "Tools by their names."),
];

/// Digits behind the point.
const DECIMALS: &[Property] = &[
    must("length", Form::Whole(2, 6), "Digits of lengths."),
    must("angle", Form::Whole(2, 7), "Digits of angles."),
    must("vector", Form::Whole(4, 9), "Digits of vectors."),
    must("feed", Form::Whole(0, 4), "Digits of feeds."),
];

const POST: &[Property] = &[
    must("dialect", TEXT, "Dialect: the words and the reader of the control."),
    ABOUT,
    may("line-end", Form::Word(|| LineEnd::ALL.map(LineEnd::name).to_vec()), "End of lines; without it lf."),
    may(
        "block-numbers",
        Form::Whole(limits::BLOCK_NUMBERS[0], limits::BLOCK_NUMBERS[1]),
        "Step of block numbers; 0 for none.",
    ),
    typed(
        "program-number",
        Form::Whole(limits::PROGRAM_NUMBERS[0], limits::PROGRAM_NUMBERS[1]),
        Without::Is("1001"),
        "Number of the program.",
    ),
    must(
        "orientation",
        Form::Word(|| Orientation::ALL.map(Orientation::name).to_vec()),
        "How the tool direction is stated.",
    ),
    may("orientation-tolerance", TURN, "Largest error of the tool direction through smoothing."),
    may("work-offset", TEXT, "Work offset that holds the part origin; without it that of the shipped files."),
    must("decimals", Form::Table(DECIMALS), "Digits behind the point."),
    may(
        "splines",
        Form::Word(|| SplineForm::ALL.map(SplineForm::name).to_vec()),
        "Kind of spline blocks, where the control has them.",
    ),
    must(
        "smoothing",
        Form::Table(&[
            must("finish", TEXT, "Words for finishing."),
            must("rough", TEXT, "Words for roughing."),
            must("off", TEXT, "Words that switch smoothing off."),
        ]),
        "Smoothing of the path.",
    ),
    must(
        "transformation",
        Form::Table(&[
            must("angles", TEXT, "Words for positions of the rotary axes; empty where there are none."),
            must("vectors", TEXT, "Words for vectors; empty where there are none."),
        ]),
        "Words that switch tool centre point control on.",
    ),
    must(
        "frames",
        Form::Table(&[
            may("start", Form::Texts, "Before the head."),
            must("head", Form::Texts, "Head of the program."),
            must("operation-start", Form::Texts, "Start of each operation."),
            must("operation-end", Form::Texts, "End of each operation."),
            must("end", Form::Texts, "End of the program."),
        ]),
        "Lines beside the moves, with fields in braces.",
    ),
];

/// The JSON schema of a kind of file (draft 7, which editors know).
pub fn library_schema(kind: LibraryFile) -> Value {
    let mut schema = table(kind.keys());
    schema["$schema"] = json!("http://json-schema.org/draft-07/schema#");
    schema["title"] = json!(match kind {
        LibraryFile::Machine => "machine file of impellerc",
        LibraryFile::Tools => "tool file of impellerc",
        LibraryFile::Post => "post file of impellerc",
    });
    schema
}

fn table(keys: &[Property]) -> Value {
    let mut properties = Map::new();
    for key in keys {
        let mut value = form(key.form);
        value["description"] = json!(key.description());
        properties.insert(key.name.to_owned(), value);
    }
    let required: Vec<&str> = keys.iter().filter(|key| key.is_due()).map(|key| key.name).collect();
    json!({ "type": "object", "properties": properties, "required": required, "additionalProperties": false })
}

/// A number and one of the units.
fn quantity(dimension: Dimension) -> Value {
    let units = library_units(dimension);
    let pattern = format!("^\\s*[-+]?([0-9]+\\.?[0-9]*|\\.[0-9]+)\\s*({})\\s*$", units.join("|"));
    let example = units.first().map_or("3".to_owned(), |unit| format!("3 {unit}"));
    json!({ "type": "string", "pattern": pattern, "examples": [example] })
}

fn several(item: &Value, count: usize) -> Value {
    json!({ "type": "array", "items": item, "minItems": count, "maxItems": count })
}

fn form(form: Form) -> Value {
    match form {
        Form::Text(_) | Form::Words(_) | Form::Bounded(_) => json!({ "type": "string" }),
        Form::Texts => json!({ "type": "array", "items": { "type": "string" } }),
        Form::TextsOf(count) => several(&json!({ "type": "string" }), count),
        Form::Quantity(dimension, _) => quantity(dimension),
        Form::LengthTo(..) => quantity(Dimension::LENGTH),
        Form::Quantities(dimension, _, count) => several(&quantity(dimension), count),
        Form::Numbers(count) => several(&json!({ "type": "number" }), count),
        Form::Word(words) => json!({ "type": "string", "enum": words() }),
        Form::Whole(..) => json!({ "type": "integer", "minimum": 0 }),
        Form::Flag => json!({ "type": "boolean" }),
        Form::Table(keys) => table(keys),
        Form::Named(keys) => json!({ "type": "object", "additionalProperties": table(keys) }),
        Form::Tables(keys) => json!({ "type": "array", "items": table(keys), "minItems": 1 }),
    }
}
