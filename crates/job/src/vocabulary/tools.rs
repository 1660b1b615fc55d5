//! Kinds of tools and their properties.

use super::Without::{Means, Required};
use super::{Property, Topic, TopicKind, property, topic_of};

const COMMON: &[Property] = &[
    property(
        "number",
        "whole number from 1 to 9999",
        Means("the place of the tool in the job, from 1"),
        "Number in the tool table of the control.",
    ),
    property(
        "diameter",
        "length from 0.1 to 500 mm",
        Required,
        "Diameter of the cutter; of a tapered ball that of the ball.",
    ),
    property("flutes", "whole number from 1 to 20", Required, "Number of cutting edges."),
    property(
        "shank",
        "length from 0.1 to 500 mm",
        Means("the diameter"),
        "Diameter of the shank: from the end of the flutes, or of the neck, to the holder.",
    ),
    property("reach", "length from 0.01 to 1000 mm", Required, "From the tip to the holder: the stick-out."),
    property(
        "holder",
        "quoted name of a holder",
        Means("no holder: nothing of it is checked"),
        "Holder of the library, with its contour.",
    ),
    property(
        "max-chip",
        "length from 0.01 um to 100 mm",
        Means("by diameter, stick-out and material"),
        "Largest feed per tooth. A stated one holds for each material.",
    ),
    property(
        "max-depth",
        "length from 0.01 to 1000 mm",
        Means("by diameter, stick-out and material"),
        "Largest depth of a slot. A stated one holds for each material.",
    ),
    property("max-rate", "mm3/min or cm3/min", Means("no limit"), "Largest removal rate."),
    property(
        "ramp",
        "angle from 0.1 to 90 deg",
        Means("by `plunge-width` and corner"),
        "How steeply the tool may go down while it moves sideways in material.",
    ),
];

const FLUTE: &[Property] =
    &[property("flute", "length from 0.01 to 1000 mm", Required, "Length of the cutting edges, from the tip.")];

const PLUNGE: &[Property] = &[property(
    "plunge-width",
    "length",
    Means("the corner and half of the flat part of the end"),
    "How wide, from the rim, the teeth of the end cut; half of the diameter is a tool that cuts at its centre.",
)];

pub(super) const TOPICS: &[Topic] = &[
    topic_of(
        TopicKind::Tool,
        "flat",
        "A cylinder with a flat end.",
        "tool t9 = flat { diameter 6 mm  flutes 4  flute 20 mm  reach 40 mm  holder \"er16-mini\" }",
        &[COMMON, FLUTE, PLUNGE],
    ),
    topic_of(
        TopicKind::Tool,
        "ball",
        "A cylinder that ends in a half ball.",
        "tool t9 = ball { diameter 6 mm  flutes 4  flute 20 mm  reach 40 mm  holder \"er16-mini\" }",
        &[COMMON, FLUTE, PLUNGE],
    ),
    topic_of(
        TopicKind::Tool,
        "bull",
        "A cylinder with a rounded corner, a bull nose.",
        "tool t9 = bull { diameter 6 mm  corner 1 mm  flutes 4  flute 20 mm  reach 40 mm  holder \"er16-mini\" }",
        &[
            COMMON,
            FLUTE,
            &[property("corner", "length from 0.01 to 250 mm", Required, "Radius of the corner.")],
            PLUNGE,
        ],
    ),
    topic_of(
        TopicKind::Tool,
        "tapered-ball",
        "A cone that ends in a ball.",
        "tool t9 = tapered-ball { diameter 4 mm  angle 3 deg  flutes 4  flute 20 mm  reach 40 mm  shank 8 mm  holder \"er16-mini\" }",
        &[
            COMMON,
            FLUTE,
            &[property("angle", "angle from 0.1 to 45 deg", Required, "Angle between the side and the tool axis.")],
        ],
    ),
    topic_of(
        TopicKind::Tool,
        "barrel",
        "A cutter whose side is an arc of a large radius.",
        "tool t9 = barrel { diameter 8 mm  barrel 85 mm  tip 2 mm  flutes 4  flute 22 mm  reach 40 mm  holder \"er16-mini\" }",
        &[
            COMMON,
            FLUTE,
            &[
                property("barrel", "length from 0.01 to 1000 mm", Required, "Radius of the side."),
                property("tip", "length from 0.01 to 250 mm", Required, "Radius of the ball at the tip."),
            ],
        ],
    ),
    topic_of(
        TopicKind::Tool,
        "lollipop",
        "A ball on a thinner neck. Its flutes end at the neck; it has no `flute`.",
        "tool t9 = lollipop { diameter 6 mm  neck 4 mm  flutes 4  reach 40 mm  holder \"er16-mini\" }",
        &[
            COMMON,
            // `tools.rs` takes `flute` to say why a lollipop has none.
            &[
                property("neck", "length from 0.1 to 500 mm", Required, "Diameter of the neck."),
                property(
                    "neck-end",
                    "length from 0.01 to 1000 mm",
                    Means("the reach"),
                    "End of the neck, from the tip.",
                ),
            ],
        ],
    ),
];
