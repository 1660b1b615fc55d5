//! Items of a job.

use super::Without::{Is, Means, Required};
use super::{Dimension, Form, Property, Topic, TopicKind, Without, property, topic_of};
use crate::property::{Range, limits, typed};

/// Largest extension of faces by default: more is a gap that somebody means, such as the gap between the tips and the casing.
pub(crate) const EXTEND: Property = typed(
    "extend",
    Form::Quantity(Dimension::LENGTH, Range::NotNegative(100.0)),
    Is("0.1 mm"),
    "Largest extension of faces that end before hub or shroud.",
)
.like("0.4 mm");

/// Diameter of the bore.
pub(crate) const BORE: Property = typed(
    "bore",
    Form::Quantity(Dimension::LENGTH, Range::NotNegative(limits::LARGEST_SIZE)),
    Required,
    "Diameter of the bore.",
)
.like("10 mm")
.also(&["hole"]);

/// Height of the back face.
pub(crate) const BACK: Property =
    typed("back", limits::HEIGHT, Required, "Height of the back face.").like("-40 mm").also(&["bottom"]);

/// Tolerance of finishing.
pub(crate) const CHORD: Property =
    typed("chord", limits::TOLERANCE, Is("1 um"), "Tolerance of finishing; paths keep it between two blocks.")
        .also(&["finish-tolerance", "tol"]);

/// Tolerance of roughing.
pub(crate) const CHORD_ROUGH: Property =
    typed("rough", limits::TOLERANCE, Is("10 um"), "Tolerance of roughing.").also(&["roughing-tolerance"]);

/// What holds of the post where the job does not say it.
const OF_FILE: Without = Means("as the post file says");

/// Tolerance of smoothing of the tool axis.
pub(crate) const ORIENTATION_TOLERANCE: Property = typed(
    "orientation-tolerance",
    Form::Quantity(Dimension::ANGLE, Range::Between(limits::TURN[0], limits::TURN[1])),
    OF_FILE,
    "Tolerance of smoothing of the tool axis.",
)
.like("0.02 deg");

/// Step of the block numbers.
pub(crate) const BLOCK_NUMBERS: Property = typed(
    "block-numbers",
    Form::Whole(limits::BLOCK_NUMBERS[0], limits::BLOCK_NUMBERS[1]),
    OF_FILE,
    "Step of the block numbers; 0 writes none.",
)
.like("10");

/// Number of the program.
pub(crate) const PROGRAM_NUMBER: Property = typed(
    "program-number",
    Form::Whole(limits::PROGRAM_NUMBERS[0], limits::PROGRAM_NUMBERS[1]),
    OF_FILE,
    "Number of the program.",
)
.like("1001");

pub(super) const TOPICS: &[Topic] = &[
    topic_of(
        TopicKind::Item,
        "edition",
        "States the language that the job is written in; the first item.",
        "edition 2026",
        &[],
    ),
    topic_of(
        TopicKind::Item,
        "use",
        "Takes a machine or a library of tools and holders. `impellerc machines` and `impellerc tools` list them.",
        "use machine \"5mc850-c\"\nuse tools \"carbide\"",
        &[],
    ),
    topic_of(
        TopicKind::Item,
        "let",
        "Names a value. The compiler checks the dimensions of all arithmetic.",
        "let ridge = 0.5 * 20 um",
        &[],
    ),
    topic_of(
        TopicKind::Item,
        "part",
        "The impeller: a blade that is repeated about Z, splitters, hub and shroud.",
        "part blade { vanes 8  vane main { ... }  hub revolve main.pressure.root  shroud revolve main.pressure.tip }",
        &[&[
            property(
                "vanes",
                "whole number from 2",
                Required,
                "Number of main blades, which is the number of sectors.",
            )
            .also(&["blades"]),
            property("vane", "name and block", Required, "The main blade: by faces, sections, or angles."),
            property("splitter", "name and block", Means("no splitters"), "A further blade in each channel; repeated."),
            property("hub", "`revolve` with a curve", Required, "Surface between the blades."),
            property("shroud", "`revolve` with a curve", Required, "Surface of the tips."),
            EXTEND,
            property(
                "imported",
                "quoted names of files, then `within` with a length from 0",
                Means("the part is not imported"),
                "Files that `impellerc import` read, and the largest distance of their points from the part: the import states it, nothing measures it again.",
            ),
        ]],
    ),
    topic_of(
        TopicKind::Item,
        "stock",
        "What the lathe leaves; `turned` is the only kind.",
        "stock turned { over shroud 0 mm  bore 10 mm  back -40 mm  material titanium }",
        &[&[
            property("over", "`shroud` with a length from 0 to 100 mm", Required, "Stock over the shroud."),
            BORE,
            BACK,
            property("from", "quoted name of an STL file", Means("the whole blank"), "What is left of the blank."),
            property("clamping", "block", Means("nothing goes below the back face"), "Space of chuck and table."),
            property(
                "material",
                "`aluminium`, `steel`, `stainless`, `titanium` or `nickel`",
                Means("limits of easily cut material"),
                "Material; it lowers the default limits of tools.",
            ),
        ]],
    ),
    topic_of(
        TopicKind::Item,
        "tool",
        "A tool: of the library, or by its kind and sizes. Kinds are flat, ball, bull, tapered-ball, barrel and lollipop.",
        "tool t9 = ball { diameter 6 mm  flutes 4  flute 20 mm  reach 40 mm  holder \"er16-mini\" }",
        &[],
    ),
    topic_of(
        TopicKind::Item,
        "operation",
        "One kind of milling with its tool. Operations run in the order of the job; kinds are rough, plunge, groove, expand, flank, point, fillet, edge, tip and channel.",
        "operation flank finish { tool t1  speed 8000 rpm  feed 250 mm/min }",
        &[],
    ),
    topic_of(
        TopicKind::Item,
        "operations",
        "`operations auto` chooses what no operation of the job does: roughing, faces, fillets, edges and floor, with their tools. An operation of the job may leave values open in the same way: `tool auto`, `tools auto`, `speed auto`, `feed auto`, `link-feed auto`, `depth auto`, `stepover auto`, `allowance auto`, `scallop auto`, `method auto`, `lead-in auto`, `lead-out auto`. `impellerc choose` writes the job with what was chosen.",
        "operations auto",
        &[],
    ),
    topic_of(
        TopicKind::Item,
        "tolerance",
        "How far the control may leave the path when it smooths: in finishing and in roughing.",
        "tolerance chord 1 um, rough 10 um",
        &[&[CHORD, CHORD_ROUGH]],
    ),
    topic_of(
        TopicKind::Item,
        "require",
        "A contract: the program is written only if it holds. It may name surfaces (`on hub, fillet`) and operations (`on operation flank`).",
        "require gouge <= 5 um on hub, fillet",
        &[],
    ),
    topic_of(
        TopicKind::Item,
        "allow",
        "Permits a deviation at a named place, with the reason.",
        "allow excess on fillet \"blended by hand\"",
        &[],
    ),
    topic_of(
        TopicKind::Item,
        "post",
        "The control; `impellerc posts` lists them.",
        "post siemens-840d { block-numbers 10 }",
        &[&[
            property("orientation", "`angles` or `vectors`", OF_FILE, "Words for the tool axis."),
            ORIENTATION_TOLERANCE,
            BLOCK_NUMBERS,
            property(
                "work-offset",
                "quoted name",
                OF_FILE,
                "Work offset that holds the part origin, such as `\"G55\"`.",
            ),
            PROGRAM_NUMBER,
            property("line-end", "`lf` or `crlf`", OF_FILE, "End of each line."),
            property(
                "path",
                "`lines` or `splines`",
                OF_FILE,
                "Straight blocks, or splines where the control has them.",
            ),
            property("sectors", "`inline` or `subprogram`", OF_FILE, "Sectors written out, or one called for each."),
        ]],
    ),
];
