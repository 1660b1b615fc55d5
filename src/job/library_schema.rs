//! Keys of the files of the library as JSON schemas, for editors that complete and check TOML. A test compares the keys with
//! those that the readers of the files know.

use super::library_check::LibraryFile;
use super::quantity::{Dimension, library_units};
use crate::method::{LengthTo, ModuloWay};
use crate::post_file::{LineEnd, Orientation, SplineForm};
use serde_json::{Map, Value, json};

/// What stands behind a key.
#[derive(Clone, Copy)]
enum Form {
    /// A text.
    Text,
    /// A list of texts.
    Texts,
    /// A text with a number and a unit of this dimension.
    Quantity(Dimension),
    /// So many of them.
    Quantities(Dimension, usize),
    /// So many numbers.
    Numbers(usize),
    /// One of these words.
    Word(fn() -> Vec<&'static str>),
    /// A whole number.
    Whole,
    /// `true` or `false`.
    Flag,
    /// So many texts.
    TextsOf(usize),
    /// A table.
    Table(&'static [Key]),
    /// Tables by names of their own.
    Named(&'static [Key]),
    /// A list of tables.
    Tables(&'static [Key]),
}

/// A key of a table.
#[derive(Clone, Copy)]
struct Key {
    name: &'static str,
    form: Form,
    required: bool,
    meaning: &'static str,
}

/// A key that a table must have.
const fn must(name: &'static str, form: Form, meaning: &'static str) -> Key {
    Key { name, form, required: true, meaning }
}

/// A key that a table may have.
const fn may(name: &'static str, form: Form, meaning: &'static str) -> Key {
    Key { name, form, required: false, meaning }
}

const LENGTH: Form = Form::Quantity(Dimension::LENGTH);
const ANGLE: Form = Form::Quantity(Dimension::ANGLE);

const ABOUT: Key = may("about", Form::Text, "A line for the reader of the file.");

const LINEAR: &[Key] = &[
    must("travel", Form::Quantities(Dimension::LENGTH, 2), "Both ends of the travel; of Z those of the gauge line."),
    must("speed", Form::Quantity(Dimension::FEED), "Largest speed."),
    must("acceleration", Form::Quantity(Dimension::ACCELERATION), "Largest acceleration."),
    may("jerk", Form::Text, "Largest jerk such as \"50 m/s3\", or \"unlimited\"; without it unlimited."),
];

const ROTARY: &[Key] = &[
    may("travel", Form::Quantities(Dimension::ANGLE, 2), "Both ends of the travel; none with `modulo = true`."),
    may("modulo", Form::Flag, "True for an axis without limits, whose words the control takes modulo 360 deg."),
    may(
        "way",
        Form::Word(|| ModuloWay::ALL.map(ModuloWay::name).to_vec()),
        "The way that the control takes, with `modulo = true`.",
    ),
    may("clamp", Form::TextsOf(2), "M words that clamp and unclamp the axis."),
    must("speed", Form::Quantity(Dimension::TURNING), "Largest speed."),
    must("acceleration", Form::Quantity(Dimension::TURNING_ACCELERATION), "Largest acceleration."),
    may("jerk", Form::Text, "Largest jerk such as \"200 rad/s3\", or \"unlimited\"; without it unlimited."),
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
    must(
        "point",
        Form::Quantities(Dimension::LENGTH, 3),
        "A point of the axis in the machine frame, all axes at zero.",
    ),
];

const SECTION: &[Key] = &[
    must("length", LENGTH, "Length along the axis."),
    must("lower", LENGTH, "Diameter at the lower end."),
    must("upper", LENGTH, "Diameter at the upper end."),
];

const CARRIED: &[Key] = &[
    must("top", LENGTH, "Height of the top."),
    must("section", Form::Tables(SECTION), "Sections downwards from the top."),
];

const AXES: &[Key] = &[
    must("X", Form::Table(LINEAR), "Linear axis X."),
    must("Y", Form::Table(LINEAR), "Linear axis Y."),
    must("Z", Form::Table(LINEAR), "Linear axis Z."),
    may("A", Form::Table(ROTARY), "Rotary axis A."),
    may("B", Form::Table(ROTARY), "Rotary axis B."),
    may("C", Form::Table(ROTARY), "Rotary axis C."),
];

const MACHINE: &[Key] = &[
    must(
        "kind",
        Form::Word(|| vec!["table-table", "head-table", "head-head"]),
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
        Form::Table(&[must("origin", Form::Quantities(Dimension::LENGTH, 3), "Origin of the part, all axes at zero.")]),
        "Where the part is.",
    ),
    must(
        "spindle",
        Form::Table(&[
            must("speed", Form::Quantities(Dimension::SPINDLE, 2), "Least and largest speed."),
            may("power", Form::Quantity(Dimension::POWER), "Power at the cutter; without it no limit."),
        ]),
        "The spindle.",
    ),
    may(
        "retract",
        Form::Table(&[must("z", LENGTH, "Height of the gauge line.")]),
        "Where tools change; without it the upper end of the travel of Z.",
    ),
    may(
        "home",
        Form::Table(&[may("x", LENGTH, "X."), may("y", LENGTH, "Y."), may("z", LENGTH, "Z of the gauge line.")]),
        "Where the machine parks at the end of a program.",
    ),
    may(
        "tool-length",
        Form::Word(|| LengthTo::ALL.map(LengthTo::name).to_vec()),
        "What lengths in the tool table refer to; without it the tip.",
    ),
    must("rapid", Form::Quantity(Dimension::FEED), "Speed of the tip at rapid."),
    may(
        "cycle",
        Form::Quantity(Dimension::TIME),
        "Time between two positions that the control gives; without it 0.002 s.",
    ),
    may("planning", Form::Word(|| vec!["linuxcnc-2.9"]), "Trajectory planner of the control, where it is known."),
    may("table", Form::Table(CARRIED), "The table, a solid of revolution; heights in the machine frame."),
    may("fixture", Form::Table(CARRIED), "The fixture, a solid of revolution; heights in the part frame."),
];

const TOOL: &[Key] = &[
    must(
        "kind",
        Form::Word(|| vec!["flat", "ball", "bull", "tapered-ball", "barrel", "lollipop"]),
        "Form of the cutter.",
    ),
    must("diameter", LENGTH, "Diameter; of a tapered ball that of the ball."),
    may("corner", LENGTH, "bull: radius of the corner."),
    may("angle", ANGLE, "tapered-ball: between side and tool axis."),
    may("barrel", LENGTH, "barrel: radius of the side."),
    may("tip", LENGTH, "barrel: radius of the ball at the tip."),
    may("neck", LENGTH, "lollipop: diameter of the neck."),
    may("neck-end", LENGTH, "lollipop: from the tip to the end of the neck; without it the reach."),
    must("flutes", Form::Whole, "Number of cutting edges."),
    may("flute", LENGTH, "Length of the cutting edges, from the tip; required but for a lollipop."),
    may("shank", LENGTH, "Diameter of the shank; without it the diameter."),
    must("reach", LENGTH, "From the tip to the holder: the stick-out."),
    may("holder", Form::Text, "Name of a holder."),
    may("max-chip", LENGTH, "Largest feed per tooth."),
    may("max-depth", LENGTH, "Largest depth of a slot."),
    may("max-rate", Form::Quantity(Dimension::REMOVAL_RATE), "Largest removal rate; without it no limit."),
    may("plunge-width", LENGTH, "Width, from the rim, that the teeth of the end cut."),
    may("ramp", ANGLE, "Largest angle at which the tool goes down sideways in material."),
];

const TOOLS: &[Key] = &[
    ABOUT,
    may(
        "holder",
        Form::Named(&[ABOUT, must("section", Form::Tables(SECTION), "Sections upwards from the nose.")]),
        "Holders by their names.",
    ),
    may("tool", Form::Named(TOOL), "Tools by their names."),
];

const POST: &[Key] = &[
    must("dialect", Form::Text, "Dialect: the words and the reader of the control."),
    ABOUT,
    may("line-end", Form::Word(|| LineEnd::ALL.map(LineEnd::name).to_vec()), "End of lines; without it lf."),
    may("block-numbers", Form::Whole, "Step of block numbers; 0 for none."),
    may("program-number", Form::Whole, "Number of the program; without it 1001."),
    must(
        "orientation",
        Form::Word(|| Orientation::ALL.map(Orientation::name).to_vec()),
        "How the tool direction is stated.",
    ),
    may("orientation-tolerance", ANGLE, "Largest error of the tool direction through smoothing."),
    must(
        "decimals",
        Form::Table(&[
            must("length", Form::Whole, "Digits of lengths."),
            must("angle", Form::Whole, "Digits of angles."),
            must("vector", Form::Whole, "Digits of vectors."),
            must("feed", Form::Whole, "Digits of feeds."),
        ]),
        "Digits behind the point.",
    ),
    may(
        "splines",
        Form::Word(|| SplineForm::ALL.map(SplineForm::name).to_vec()),
        "Kind of spline blocks, where the control has them.",
    ),
    must(
        "smoothing",
        Form::Table(&[
            must("finish", Form::Text, "Words for finishing."),
            must("rough", Form::Text, "Words for roughing."),
            must("off", Form::Text, "Words that switch smoothing off."),
        ]),
        "Smoothing of the path.",
    ),
    must(
        "transformation",
        Form::Table(&[
            must("angles", Form::Text, "Words for positions of the rotary axes; empty where there are none."),
            must("vectors", Form::Text, "Words for vectors; empty where there are none."),
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

/// The keys of a kind of file.
fn keys(kind: LibraryFile) -> &'static [Key] {
    match kind {
        LibraryFile::Machine => MACHINE,
        LibraryFile::Tools => TOOLS,
        LibraryFile::Post => POST,
    }
}

/// The JSON schema of a kind of file (draft 7, which editors know).
pub fn library_schema(kind: LibraryFile) -> Value {
    let mut schema = table(keys(kind));
    schema["$schema"] = json!("http://json-schema.org/draft-07/schema#");
    schema["title"] = json!(match kind {
        LibraryFile::Machine => "machine file of impellerc",
        LibraryFile::Tools => "tool file of impellerc",
        LibraryFile::Post => "post file of impellerc",
    });
    schema
}

fn table(keys: &[Key]) -> Value {
    let mut properties = Map::new();
    for key in keys {
        let mut value = form(key.form);
        value["description"] = json!(key.meaning);
        properties.insert(key.name.to_owned(), value);
    }
    let required: Vec<&str> = keys.iter().filter(|key| key.required).map(|key| key.name).collect();
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
        Form::Text => json!({ "type": "string" }),
        Form::Texts => json!({ "type": "array", "items": { "type": "string" } }),
        Form::TextsOf(count) => several(&json!({ "type": "string" }), count),
        Form::Quantity(dimension) => quantity(dimension),
        Form::Quantities(dimension, count) => several(&quantity(dimension), count),
        Form::Numbers(count) => several(&json!({ "type": "number" }), count),
        Form::Word(words) => json!({ "type": "string", "enum": words() }),
        Form::Whole => json!({ "type": "integer", "minimum": 0 }),
        Form::Flag => json!({ "type": "boolean" }),
        Form::Table(keys) => table(keys),
        Form::Named(keys) => json!({ "type": "object", "additionalProperties": table(keys) }),
        Form::Tables(keys) => json!({ "type": "array", "items": table(keys), "minItems": 1 }),
    }
}
