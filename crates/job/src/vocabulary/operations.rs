//! Operations and their properties.

use super::Without::{Is, Means, Required};
use super::{Dimension, Form, Property, Topic, TopicKind, property, topic_of};
use crate::property::limits;
use crate::property::{Range, ToolSize, typed};
use wheel::method::{AxisMethod, Conflict, ErrorSide, FaceOrder, FlankMethod, Levels, Lines, Milling, Slots, Spacing};

/// Feed of links.
pub(crate) const LINK_FEED: Property = typed(
    "link-feed",
    Form::Quantity(Dimension::FEED, limits::FEED),
    Is("1000 mm/min"),
    "Feed of the tip between passes near the part.",
)
.like("1000 mm/min");

const LEAD: Form = Form::Quantity(Dimension::LENGTH, Range::NotNegative(100.0));

/// Way before each pass.
pub(crate) const LEAD_IN: Property = typed("lead-in", LEAD, Is("2 mm"), "Way before each pass, outside of the part.")
    .like("2 mm")
    .also(&["leadin", "approach"]);

/// Way behind each pass.
pub(crate) const LEAD_OUT: Property = typed("lead-out", LEAD, Is("2 mm"), "Way behind each pass, outside of the part.")
    .like("2 mm")
    .also(&["leadout", "retract"]);

/// Arc of engagement of loops.
pub(crate) const ENGAGEMENT: Property = typed(
    "engagement",
    Form::Quantity(Dimension::ANGLE, limits::ENGAGEMENT),
    Means("that of a line beside the slot"),
    "Largest arc of engagement of the loops, with `slots trochoidal`.",
)
.like("60 deg");

/// Tool of an operation.
pub(crate) const TOOL: Property =
    property("tool", "name of a tool", Required, "The tool of the operation.").like("t1").also(&["cutter", "mill"]);

/// Tools of an operation, one after the other.
pub(crate) const TOOLS: Property = property(
    "tools",
    "names of tools",
    Means("all tools of the job that can rough, the widest first"),
    "One operation for each tool, in this order; a later tool cuts what the earlier ones left.",
)
.like("t1, t2");

/// Speed of the spindle.
pub(crate) const SPEED: Property = property(
    "speed",
    "rpm, or cutting speed in m/min",
    Required,
    "Speed of the spindle; a cutting speed is that at the diameter.",
)
.like("8000 rpm")
.also(&["vc", "cutting-speed", "n", "s", "velocity", "max-speed", "vmax", "spindle", "rpm", "spindle-speed"]);

/// Feed while cutting.
pub(crate) const FEED: Property = property(
    "feed",
    "mm/min or mm/tooth",
    Required,
    "Feed of the tip while cutting. Each tool has a largest feed per tooth.",
)
.like("250 mm/min")
.also(&["fz", "vf", "f", "feedrate", "feed-rate"]);

/// Rest machining.
pub(crate) const REST: Property = typed(
    "rest",
    Form::Bounded(|| format!("`off`, or `over` with a length from {} to {} mm", limits::REST[0], limits::REST[1])),
    Is("off"),
    "Cuts only where earlier operations left more stock than this.",
)
.like("over 0.05 mm");

/// Sectors to machine.
pub(crate) const SECTORS: Property = property(
    "sectors",
    "numbers of sectors, with commas",
    Means("all sectors"),
    "The sectors to machine; sector 1 lies at vane 1.",
)
.like("1, 2");

const COMMON: &[Property] = &[SPEED, FEED, LINK_FEED, LEAD_IN, LEAD_OUT, REST, SECTORS];

/// Stock that roughing leaves.
pub(crate) const ALLOWANCE: Property = property(
    "allowance",
    "`vane` with a length or `TIP .. ROOT`, and `hub` with a length",
    Required,
    "Stock that is left on vanes and hub; it must be larger than `tolerance rough`.",
)
.like("vane 0.2 mm, hub 0.5 mm")
.also(&["stock-to-leave", "leave", "stock", "offset"]);

/// Faces to finish.
pub(crate) const FACES: Property =
    property("faces", "`pressure`, `suction`", Is("pressure, suction"), "Faces of the vanes to finish.")
        .like("pressure, suction")
        .also(&["side"]);

/// Edges to finish.
pub(crate) const EDGES: Property =
    property("edges", "`inlet`, `outlet`", Is("inlet, outlet"), "Edges to finish.").like("inlet, outlet");

/// Blades to finish.
pub(crate) const BLADES: Property = property(
    "blades",
    "names of blades",
    Means("all blades of a sector"),
    "Blades to finish: the main blade and splitters, by their names.",
)
.like("main")
.also(&["blade"]);

/// Number of strips of a face.
pub(crate) const STRIPS: Property = typed(
    "strips",
    Form::Bounded(|| {
        let [optimised, other] = limits::MAX_STRIPS;
        format!("`auto`, or a number from 1 to {optimised} (to {other} with the other methods)")
    }),
    Means("`auto` with `minimax`, 1 otherwise"),
    "Passes from tip to root of a face.",
)
.like("2")
.also(&["passes"]);

/// Step down of roughing.
pub(crate) const ROUGH_DEPTH: Property = property(
    "depth",
    "length; one, or one for each tool",
    Means("0.375 of the diameter; 0.33 for a ball"),
    "Step down from level to level.",
)
.like("3 mm")
.also(STEP_DOWN);

/// Distance of the lines of roughing.
pub(crate) const STEPOVER: Property = property(
    "stepover",
    "length; one, or one for each tool",
    Means("0.75 of the diameter; 0.4 for a ball"),
    "Distance of neighbouring lines.",
)
.like("5 mm")
.also(&["step", "step-over", "ae"]);

/// Distance of the strokes of plunging.
pub(crate) const STROKE_STEP: Property = typed(
    "stepover",
    Form::Bounded(|| format!("length from {} to {} of the diameter", limits::STROKE_STEP[0], limits::STROKE_STEP[1])),
    Means("a quarter of the diameter, where the tool permits it"),
    "Distance of neighbouring strokes.",
)
.like("1 mm");

/// Height of the levels of point milling.
pub(crate) const LEVEL_DEPTH: Property = typed(
    "depth",
    Form::Quantity(Dimension::LENGTH, Range::Between(limits::LEVEL_HEIGHT[0], limits::LEVEL_HEIGHT[1])),
    Means("an error with `order levels`; otherwise not allowed"),
    "Height of a level with `order levels`.",
)
.like("5 mm");

/// Height of the ridges that lines leave on vanes.
pub(crate) const SCALLOP: Property = typed(
    "scallop",
    Form::LengthTo(limits::LEAST_SCALLOP, ToolSize::Radius),
    Required,
    "Height of the ridges between two lines.",
)
.like("5 um")
.also(&["step-over", "stepover", "ae", "cusp", "cusp-height"]);

/// The same on the floor.
pub(crate) const FLOOR_SCALLOP: Property = SCALLOP.like("10 um");

/// Height of the ridges that roughing leaves.
pub(crate) const RESIDUAL: Property = typed(
    "residual",
    Form::LengthTo(limits::LEAST_RESIDUAL, ToolSize::Radius),
    Required,
    "Height of the ridges between two lines of roughing.",
)
.like("0.5 mm");

/// How tool axes are chosen.
pub(crate) const METHOD: Property = typed(
    "method",
    Form::Word(|| AxisMethod::ALL.map(AxisMethod::name).to_vec()),
    Means("`corridor`; `blend` for cutters without a ball"),
    "How tool axes are chosen: a smooth way through all axes that are free (`corridor`), the rulings of both walls with one tilt for \
     each line (`blend`), the greedy choice of Xu 2013 (`xu`), the ruling itself (`ruling`).",
);

/// Direction of lines.
pub(crate) const LINES: Property = typed(
    "lines",
    Form::Word(|| Lines::ALL.map(Lines::name).to_vec()),
    Is("zigzag"),
    "Direction of the lines: every other line backwards, or all in one direction.",
)
.also(&["passes"]);

/// The same where a line may run round the vane.
pub(crate) const LINES_ROUND: Property = typed(
    "lines",
    Form::Word(|| Lines::ROUND.map(Lines::name).to_vec()),
    Is("zigzag"),
    "Direction of the lines: every other line backwards, all in one direction, or one line round the vane.",
);

/// Sense of milling.
pub(crate) const MILLING: Property = typed(
    "milling",
    Form::Word(|| Milling::ALL.map(Milling::name).to_vec()),
    Is("climb"),
    "Sense of milling. `point` and `fillet` keep it only with lines that all run in one direction.",
)
.also(&["direction", "cut-direction", "cutting-mode", "climb"]);

/// Order of the faces of a vane.
pub(crate) const ORDER: Property = typed(
    "order",
    Form::Word(|| FaceOrder::ALL.map(FaceOrder::name).to_vec()),
    Is("faces"),
    "One face after the other, or both faces level by level, so that thin blades stay stiff.",
);

/// Names of the step down in other systems.
const STEP_DOWN: &[&str] = &["stepdown", "step-down", "step", "ap"];

/// Step down of a groove.
pub(crate) const DEPTH: Property = typed(
    "depth",
    Form::LengthTo(limits::LEAST_DEPTH, ToolSize::Flutes),
    Required,
    "Largest step down from layer to layer.",
)
.like("1.5 mm")
.also(STEP_DOWN);

/// How levels of roughing lie.
pub(crate) const LEVELS: Property = typed(
    "levels",
    Form::Word(|| Levels::ALL.map(Levels::name).to_vec()),
    Is("from-hub"),
    "Levels at constant height over the hub, at constant depth under the shroud, or at equal shares of the height.",
);

/// How a slot is opened.
pub(crate) const SLOTS: Property = typed(
    "slots",
    Form::Word(|| Slots::NAMES.to_vec()),
    Is("full"),
    "How a slot is opened: at full width, or by loops.",
);

/// How axes of flank milling are found.
pub(crate) const FLANK_METHOD: Property = typed(
    "method",
    Form::Word(|| FlankMethod::ALL.map(FlankMethod::name).to_vec()),
    Is("minimax"),
    "How axes are found: the least largest error of the swept tool, or the offsets of Wei 2021 (formulas 10 to 12).",
);

/// Sides on which the error of a flank may lie.
pub(crate) const SIDE: Property = typed(
    "side",
    Form::Word(|| ErrorSide::ALL.map(ErrorSide::name).to_vec()),
    Is("both"),
    "Whether the error may lie on both sides of the surface, or only outside of it.",
);

/// What counts where face and floor cannot both be reached.
pub(crate) const CONFLICT: Property = typed(
    "conflict",
    Form::Word(|| Conflict::ALL.map(Conflict::name).to_vec()),
    Is("balance"),
    "What counts where face and floor cannot both be reached.",
);

/// Distance of the lines of the floor.
pub(crate) const SPACING: Property = typed(
    "spacing",
    Form::Word(|| Spacing::ALL.map(Spacing::name).to_vec()),
    Is("constant-scallop"),
    "Distance of the lines: everywhere what the scallop height allows, or equal shares of the width (Wei 2021, formula 13).",
);

pub(super) const TOPICS: &[Topic] = &[
    topic_of(
        TopicKind::Operation,
        "rough",
        "Clears the channels level by level, by lines from the middle out to both walls.",
        "operation rough {\n  tools t1  speed 8000 rpm  feed 1000 mm/min  depth 2 mm  stepover 2 mm  allowance vane 0.3 mm, hub 0.3 mm\n}",
        &[&[TOOLS], COMMON, &[ROUGH_DEPTH, STEPOVER], &[ALLOWANCE], &[LEVELS], &[MILLING], &[SLOTS, ENGAGEMENT]],
    ),
    topic_of(
        TopicKind::Operation,
        "plunge",
        "Clears the channels by strokes along the tool axis down to the floor, row by row; for deep and narrow channels.",
        "operation plunge { tool t4  speed 8000 rpm  feed 150 mm/min  allowance vane 0.3 mm, hub 0.3 mm }",
        &[&[TOOL], COMMON, &[STROKE_STEP], &[ALLOWANCE]],
    ),
    topic_of(
        TopicKind::Operation,
        "groove",
        "Cuts a slot in the middle of each channel, layer by layer (Wei 2021, section 3.1).",
        "operation groove { tool t1  speed 8000 rpm  feed 300 mm/min  depth 2 mm  allowance vane 0.3 mm, hub 0.3 mm }",
        &[&[TOOL], COMMON, &[DEPTH], &[ALLOWANCE]],
    ),
    topic_of(
        TopicKind::Operation,
        "expand",
        "Opens the slot of `groove` to both walls, along V-shaped lines (Wei 2021, section 3.2). `depth` and `allowance` are by default those of the groove before it.",
        "operation groove { tool t1  speed 8000 rpm  feed 300 mm/min  depth 2 mm  allowance vane 0.3 mm, hub 0.3 mm }\noperation expand { tool t1  speed 8000 rpm  feed 300 mm/min  residual 0.5 mm }",
        &[
            &[TOOL],
            COMMON,
            &[DEPTH.without(Means("that of the groove before it"))],
            &[Property {
                meaning: "Stock that is left on vanes and hub.",
                ..ALLOWANCE.without(Means("that of the groove before it"))
            }],
            &[RESIDUAL],
        ],
    ),
    topic_of(
        TopicKind::Operation,
        "flank",
        "Finishes the faces of the vanes with the side of the cutter.",
        "operation flank { tool t1  speed 8000 rpm  feed 250 mm/min  faces pressure, suction }",
        &[&[TOOL], COMMON, &[FACES, BLADES], &[FLANK_METHOD, STRIPS, SIDE, CONFLICT], &[MILLING], &[ORDER]],
    ),
    topic_of(
        TopicKind::Operation,
        "point",
        "Finishes the faces of the vanes with the tip of the cutter, along lines of constant scallop height.",
        "operation point { tool t1  speed 8000 rpm  feed 250 mm/min  scallop 20 um }",
        &[
            &[TOOL],
            COMMON,
            &[FACES, BLADES],
            &[SCALLOP],
            &[LINES_ROUND],
            &[MILLING],
            &[ORDER],
            &[LEVEL_DEPTH],
            &[METHOD],
        ],
    ),
    topic_of(
        TopicKind::Operation,
        "fillet",
        "Finishes the fillets between vanes and hub, along lines of constant scallop height. The cutter needs a ball that fits into the fillet.",
        "operation fillet { tool t1  speed 8000 rpm  feed 250 mm/min  scallop 20 um }",
        &[&[TOOL], COMMON, &[FACES, BLADES, SCALLOP], &[LINES], &[MILLING], &[METHOD]],
    ),
    topic_of(
        TopicKind::Operation,
        "edge",
        "Finishes leading and trailing edges of the vanes, by lines that wrap round them.",
        "operation edge { tool t1  speed 8000 rpm  feed 250 mm/min  scallop 20 um }",
        &[&[TOOL], COMMON, &[EDGES], &[BLADES], &[SCALLOP], &[LINES], &[METHOD]],
    ),
    topic_of(
        TopicKind::Operation,
        "tip",
        "Finishes the tips of the vanes, which the lathe otherwise leaves.",
        "operation tip { tool t1  speed 8000 rpm  feed 250 mm/min  scallop 20 um }",
        &[&[TOOL], COMMON, &[BLADES, SCALLOP], &[LINES], &[METHOD]],
    ),
    topic_of(
        TopicKind::Operation,
        "channel",
        "Finishes the hub between the vanes. With a list `tools` instead of `tool`, the wider tools finish the middle and the last one the rest.",
        "operation channel { tool t1  speed 8000 rpm  feed 250 mm/min  scallop 20 um }",
        &[&[TOOL], COMMON, &[FLOOR_SCALLOP], &[SPACING], &[LINES], &[METHOD]],
    ),
];
