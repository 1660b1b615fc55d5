//! Keys of the files of the library as JSON schemas, for editors that complete and check TOML. A test compares the keys with
//! those that the readers of the files know.

use super::quantity::{Dimension, library_units};
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
    pub(super) fn keys(self) -> &'static [FileKey] {
        match self {
            Self::Machine => MACHINE,
            Self::Tools => TOOLS,
            Self::Post => POST,
        }
    }
}

/// What stands behind a key.
#[derive(Clone, Copy)]
pub(super) enum KeyForm {
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
    Table(&'static [FileKey]),
    /// Tables by names of their own.
    Named(&'static [FileKey]),
    /// A list of tables.
    Tables(&'static [FileKey]),
}

/// A key of a table.
#[derive(Clone, Copy)]
pub(super) struct FileKey {
    pub(super) name: &'static str,
    pub(super) form: KeyForm,
    pub(super) required: bool,
    pub(super) meaning: &'static str,
}

/// A key that a table must have.
const fn must(name: &'static str, form: KeyForm, meaning: &'static str) -> FileKey {
    FileKey { name, form, required: true, meaning }
}

/// A key that a table may have.
const fn may(name: &'static str, form: KeyForm, meaning: &'static str) -> FileKey {
    FileKey { name, form, required: false, meaning }
}

const LENGTH: KeyForm = KeyForm::Quantity(Dimension::LENGTH);
const ANGLE: KeyForm = KeyForm::Quantity(Dimension::ANGLE);

const ABOUT: FileKey = may("about", KeyForm::Text, "A line for the reader of the file.");

const LINEAR: &[FileKey] = &[
    must("travel", KeyForm::Quantities(Dimension::LENGTH, 2), "Both ends of the travel; of Z those of the gauge line."),
    must("speed", KeyForm::Quantity(Dimension::FEED), "Largest speed."),
    must("acceleration", KeyForm::Quantity(Dimension::ACCELERATION), "Largest acceleration."),
    may("jerk", KeyForm::Text, "Largest jerk such as \"50 m/s3\", or \"unlimited\"; without it unlimited."),
];

const ROTARY: &[FileKey] = &[
    may("travel", KeyForm::Quantities(Dimension::ANGLE, 2), "Both ends of the travel; none with `modulo = true`."),
    may("modulo", KeyForm::Flag, "True for an axis without limits, whose words the control takes modulo 360 deg."),
    may(
        "way",
        KeyForm::Word(|| ModuloWay::ALL.map(ModuloWay::name).to_vec()),
        "The way that the control takes, with `modulo = true`.",
    ),
    may("clamp", KeyForm::TextsOf(2), "M words that clamp and unclamp the axis."),
    must("speed", KeyForm::Quantity(Dimension::TURNING), "Largest speed."),
    must("acceleration", KeyForm::Quantity(Dimension::TURNING_ACCELERATION), "Largest acceleration."),
    may("jerk", KeyForm::Text, "Largest jerk such as \"200 rad/s3\", or \"unlimited\"; without it unlimited."),
    must(
        "sense",
        KeyForm::Word(|| vec!["iso", "opposite"]),
        "iso: a positive word turns the tool right-handed against the part.",
    ),
    may(
        "direction",
        KeyForm::Numbers(3),
        "Direction in the machine frame with all axes at zero; without it by the letter.",
    ),
    must(
        "point",
        KeyForm::Quantities(Dimension::LENGTH, 3),
        "A point of the axis in the machine frame, all axes at zero.",
    ),
];

const SECTION: &[FileKey] = &[
    must("length", LENGTH, "Length along the axis."),
    must("lower", LENGTH, "Diameter at the lower end."),
    must("upper", LENGTH, "Diameter at the upper end."),
];

const CARRIED: &[FileKey] = &[
    must("top", LENGTH, "Height of the top."),
    must("section", KeyForm::Tables(SECTION), "Sections downwards from the top."),
];

const AXES: &[FileKey] = &[
    must("X", KeyForm::Table(LINEAR), "Linear axis X."),
    must("Y", KeyForm::Table(LINEAR), "Linear axis Y."),
    must("Z", KeyForm::Table(LINEAR), "Linear axis Z."),
    may("A", KeyForm::Table(ROTARY), "Rotary axis A."),
    may("B", KeyForm::Table(ROTARY), "Rotary axis B."),
    may("C", KeyForm::Table(ROTARY), "Rotary axis C."),
];

const MACHINE: &[FileKey] = &[
    must(
        "kind",
        KeyForm::Word(|| vec!["table-table", "head-table", "head-head"]),
        "What the rotary axes carry: part or tool.",
    ),
    may(
        "order",
        KeyForm::TextsOf(2),
        "Names of the rotary axes, first the one next to the tool; without it by the alphabet.",
    ),
    ABOUT,
    may("assumed", KeyForm::Texts, "What nobody measured; the setup sheet lists it."),
    may("own-words", KeyForm::Texts, "M words of the machine builder that frames of a post may have."),
    must("axes", KeyForm::Table(AXES), "The axes: X, Y, Z and two of A, B, C."),
    must(
        "part",
        KeyForm::Table(&[
            must("origin", KeyForm::Quantities(Dimension::LENGTH, 3), "Origin of the part, all axes at zero."),
            may("direction", KeyForm::Numbers(3), "Where Z of the part points, all axes at zero; without it along Z."),
            may(
                "x-direction",
                KeyForm::Numbers(3),
                "Where X of the part points, all axes at zero; without it along X.",
            ),
        ]),
        "Where the part is.",
    ),
    must(
        "spindle",
        KeyForm::Table(&[
            must("speed", KeyForm::Quantities(Dimension::SPINDLE, 2), "Least and largest speed."),
            may("power", KeyForm::Quantity(Dimension::POWER), "Power at the cutter; without it no limit."),
        ]),
        "The spindle.",
    ),
    may(
        "retract",
        KeyForm::Table(&[must("z", LENGTH, "Height of the gauge line.")]),
        "Where tools change; without it the upper end of the travel of Z.",
    ),
    may(
        "home",
        KeyForm::Table(&[may("x", LENGTH, "X."), may("y", LENGTH, "Y."), may("z", LENGTH, "Z of the gauge line.")]),
        "Where the machine parks at the end of a program.",
    ),
    may(
        "tool-length",
        KeyForm::Word(|| LengthTo::ALL.map(LengthTo::name).to_vec()),
        "What lengths in the tool table refer to; without it the tip.",
    ),
    must("rapid", KeyForm::Quantity(Dimension::FEED), "Speed of the tip at rapid."),
    may(
        "cycle",
        KeyForm::Quantity(Dimension::TIME),
        "Time between two positions that the control gives; without it 0.002 s.",
    ),
    may("planning", KeyForm::Word(|| vec!["linuxcnc-2.9"]), "Trajectory planner of the control, where it is known."),
    may("table", KeyForm::Table(CARRIED), "The table, a solid of revolution; heights in the machine frame."),
    may("fixture", KeyForm::Table(CARRIED), "The fixture, a solid of revolution; heights in the part frame."),
];

const TOOL: &[FileKey] = &[
    must(
        "kind",
        KeyForm::Word(|| vec!["flat", "ball", "bull", "tapered-ball", "barrel", "lollipop"]),
        "Form of the cutter.",
    ),
    must("diameter", LENGTH, "Diameter; of a tapered ball that of the ball."),
    may("corner", LENGTH, "bull: radius of the corner."),
    may("angle", ANGLE, "tapered-ball: between side and tool axis."),
    may("barrel", LENGTH, "barrel: radius of the side."),
    may("tip", LENGTH, "barrel: radius of the ball at the tip."),
    may("neck", LENGTH, "lollipop: diameter of the neck."),
    may("neck-end", LENGTH, "lollipop: from the tip to the end of the neck; without it the reach."),
    must("flutes", KeyForm::Whole, "Number of cutting edges."),
    may("flute", LENGTH, "Length of the cutting edges, from the tip; required but for a lollipop."),
    may("shank", LENGTH, "Diameter of the shank; without it the diameter."),
    must("reach", LENGTH, "From the tip to the holder: the stick-out."),
    may("holder", KeyForm::Text, "Name of a holder."),
    may("max-chip", LENGTH, "Largest feed per tooth."),
    may("max-depth", LENGTH, "Largest depth of a slot."),
    may("max-rate", KeyForm::Quantity(Dimension::REMOVAL_RATE), "Largest removal rate; without it no limit."),
    may("plunge-width", LENGTH, "Width, from the rim, that the teeth of the end cut."),
    may("ramp", ANGLE, "Largest angle at which the tool goes down sideways in material."),
];

const TOOLS: &[FileKey] = &[
    ABOUT,
    may(
        "holder",
        KeyForm::Named(&[ABOUT, must("section", KeyForm::Tables(SECTION), "Sections upwards from the nose.")]),
        "Holders by their names.",
    ),
    may("tool", KeyForm::Named(TOOL), "Tools by their names."),
];

const POST: &[FileKey] = &[
    must("dialect", KeyForm::Text, "Dialect: the words and the reader of the control."),
    ABOUT,
    may("line-end", KeyForm::Word(|| LineEnd::ALL.map(LineEnd::name).to_vec()), "End of lines; without it lf."),
    may("block-numbers", KeyForm::Whole, "Step of block numbers; 0 for none."),
    may("program-number", KeyForm::Whole, "Number of the program; without it 1001."),
    must(
        "orientation",
        KeyForm::Word(|| Orientation::ALL.map(Orientation::name).to_vec()),
        "How the tool direction is stated.",
    ),
    may("orientation-tolerance", ANGLE, "Largest error of the tool direction through smoothing."),
    may("work-offset", KeyForm::Text, "Work offset that holds the part origin; without it that of the shipped files."),
    must(
        "decimals",
        KeyForm::Table(&[
            must("length", KeyForm::Whole, "Digits of lengths."),
            must("angle", KeyForm::Whole, "Digits of angles."),
            must("vector", KeyForm::Whole, "Digits of vectors."),
            must("feed", KeyForm::Whole, "Digits of feeds."),
        ]),
        "Digits behind the point.",
    ),
    may(
        "splines",
        KeyForm::Word(|| SplineForm::ALL.map(SplineForm::name).to_vec()),
        "Kind of spline blocks, where the control has them.",
    ),
    must(
        "smoothing",
        KeyForm::Table(&[
            must("finish", KeyForm::Text, "Words for finishing."),
            must("rough", KeyForm::Text, "Words for roughing."),
            must("off", KeyForm::Text, "Words that switch smoothing off."),
        ]),
        "Smoothing of the path.",
    ),
    must(
        "transformation",
        KeyForm::Table(&[
            must("angles", KeyForm::Text, "Words for positions of the rotary axes; empty where there are none."),
            must("vectors", KeyForm::Text, "Words for vectors; empty where there are none."),
        ]),
        "Words that switch tool centre point control on.",
    ),
    must(
        "frames",
        KeyForm::Table(&[
            may("start", KeyForm::Texts, "Before the head."),
            must("head", KeyForm::Texts, "Head of the program."),
            must("operation-start", KeyForm::Texts, "Start of each operation."),
            must("operation-end", KeyForm::Texts, "End of each operation."),
            must("end", KeyForm::Texts, "End of the program."),
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

fn table(keys: &[FileKey]) -> Value {
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

fn form(form: KeyForm) -> Value {
    match form {
        KeyForm::Text => json!({ "type": "string" }),
        KeyForm::Texts => json!({ "type": "array", "items": { "type": "string" } }),
        KeyForm::TextsOf(count) => several(&json!({ "type": "string" }), count),
        KeyForm::Quantity(dimension) => quantity(dimension),
        KeyForm::Quantities(dimension, count) => several(&quantity(dimension), count),
        KeyForm::Numbers(count) => several(&json!({ "type": "number" }), count),
        KeyForm::Word(words) => json!({ "type": "string", "enum": words() }),
        KeyForm::Whole => json!({ "type": "integer", "minimum": 0 }),
        KeyForm::Flag => json!({ "type": "boolean" }),
        KeyForm::Table(keys) => table(keys),
        KeyForm::Named(keys) => json!({ "type": "object", "additionalProperties": table(keys) }),
        KeyForm::Tables(keys) => json!({ "type": "array", "items": table(keys), "minItems": 1 }),
    }
}
