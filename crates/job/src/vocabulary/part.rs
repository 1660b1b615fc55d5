//! Blocks of the part and the stock.

use super::Without::{Is, Means, Required};
use super::{Property, Topic, TopicKind, property, topic_of};
use crate::property::{limits, typed};

/// Largest distance of the surfaces to what the spans state.
pub(crate) const FIT_OF_SPANS: Property =
    typed("fit", limits::FIT, Is("2 um"), "Largest distance of the surfaces to what the spans state.").like("2 um");

/// Largest distance of the surfaces to the points of sections.
pub(crate) const FIT_OF_SECTIONS: Property =
    typed("fit", limits::FIT, Is("5 um"), "Largest distance of the surfaces to the points.").like("5 um");

/// Height that no tool goes below.
pub(crate) const BELOW: Property =
    typed("below", limits::HEIGHT, Means("the back face of the stock"), "No tool goes below this height.")
        .like("-42 mm");

/// Diameter of the clamping.
pub(crate) const CLAMPING_DIAMETER: Property =
    typed("diameter", limits::CLAMPING, Means("unlimited"), "Diameter of the clamping.").like("60 mm");

const FILLET: &[Property] = &[property(
    "fillet",
    "length from 0.01 to 1000 mm, or a list of `(PLACE, RADIUS)` along the root",
    Means("no fillet"),
    "Radius of the fillet between blade and hub.",
)];

const SPANS: &[Property] = &[
    property(
        "span",
        "a share from hub (0 %) to shroud (100 %) with a block",
        Required,
        "Angles and thickness there; repeated.",
    ),
    property(
        "thickness",
        "length, or a list of `(PLACE, LENGTH)`",
        Means("stated by the spans"),
        "Thickness of all spans.",
    ),
    property(
        "from",
        "`hub` and `shroud` with places on their meridians",
        Means("the beginning of the meridian"),
        "Place of the leading edge.",
    ),
    property(
        "to",
        "`hub` and `shroud` with places on their meridians",
        Means("the end of the meridian"),
        "Place of the trailing edge.",
    ),
    property("leading-edge", "`round`, `cut-off`, or `elliptic` with a ratio", Required, "Form of the leading edge."),
    property("trailing-edge", "`round`, `cut-off`, or `elliptic` with a ratio", Required, "Form of the trailing edge."),
    FIT_OF_SPANS,
];

const FACINGS: &str = "`clockwise` or `counter-clockwise`";

pub(super) const TOPICS: &[Topic] = &[
    topic_of(
        TopicKind::Block,
        "vane",
        "The main blade by its two faces. `vane NAME { }` stands in the part.",
        "vane main { pressure ruled { tip spline from \"c.csv\" curve tip_pressure mm  root spline from \"c.csv\" curve root_pressure mm }  ... }",
        &[
            &[
                property("pressure", "`ruled` or `lofted` with a block", Required, "Pressure face."),
                property("suction", "`ruled` or `lofted` with a block", Required, "Suction face."),
            ],
            FILLET,
        ],
    ),
    topic_of(
        TopicKind::Block,
        "ruled",
        "A face of straight lines between a curve at the tip and one at the root.",
        "pressure ruled { tip spline [(15, -38, 0) (5, -42, -9) (-7, -59, -24)] mm  root spline [(6, -16, -10) (-1, -26, -24) (-8, -59, -32)] mm }",
        &[CURVES],
    ),
    topic_of(
        TopicKind::Block,
        "lofted",
        "A face through curves at the tip, at the root, and at sections between them.",
        "pressure lofted { tip spline ... mm  sections [0.5 spline ... mm]  root spline ... mm }",
        &[
            CURVES,
            &[property(
                "sections",
                "list of shares with curves",
                Required,
                "Curves between tip and root, with their share of the way.",
            )],
        ],
    ),
    topic_of(
        TopicKind::Block,
        "sections",
        "A blade by closed sections in a table. `vane NAME { sections loops from \"FILE\" mm }` stands in the part.",
        "vane main { sections loops from \"sections.csv\" mm  fillet 0.8 mm }",
        &[
            &[
                property(
                    "sections",
                    "`loops from` with a file and a unit",
                    Required,
                    "Table with the points of the closed sections.",
                ),
                FIT_OF_SECTIONS,
                property(
                    "leading-edge",
                    "`round`, `cut-off`, or `elliptic` with a ratio",
                    Means("as the points say"),
                    "Form of the leading edge.",
                ),
                property(
                    "trailing-edge",
                    "`round`, `cut-off`, or `elliptic` with a ratio",
                    Means("as the points say"),
                    "Form of the trailing edge.",
                ),
                property(
                    "pressure",
                    FACINGS,
                    Means("the side that the turn of the sections shows"),
                    "Side of the pressure face, seen from +Z.",
                ),
            ],
            FILLET,
        ],
    ),
    topic_of(
        TopicKind::Block,
        "angles",
        "A blade by angles of its camber lines and thicknesses at spans; `docs/blades.md` explains it. `vane NAME { span ... }` stands in the part.",
        "vane main { span 0 % { beta 30 deg  start 0 deg  thickness 2 mm }  span 100 % { beta 50 deg  start 0 deg  thickness 1 mm }  leading-edge round  trailing-edge cut-off }",
        &[
            SPANS,
            &[
                property(
                    "beta-from",
                    "`meridian` or `tangent`",
                    Is("meridian"),
                    "Direction from which beta is measured.",
                ),
                property(
                    "lean",
                    "list of `(PLACE, ANGLE)` from hub to shroud",
                    Means("no lean"),
                    "Turn of the span about the axis.",
                ),
                property(
                    "pressure",
                    FACINGS,
                    Means("the side that the angles show"),
                    "Side of the pressure face, seen from +Z.",
                ),
            ],
            FILLET,
        ],
    ),
    topic_of(
        TopicKind::Block,
        "of",
        "A splitter as a part of the main blade, with its own thickness and edges. `splitter NAME { of main ... }` stands in the part.",
        "splitter half { of main  from hub 45 %, shroud 36 %  angle 46 %  span 0 % { thickness 1.6 mm }  span 100 % { thickness 1 mm }  leading-edge round  trailing-edge cut-off }",
        &[
            &[property("of", "name of the main blade", Required, "Blade whose camber surface the splitter shares.")],
            SPANS,
            FILLET,
        ],
    ),
    topic_of(
        TopicKind::Block,
        "span",
        "Angles and thickness of a blade at a share of the way from hub to shroud.",
        "span 0 % { beta [(0 %, 50 deg) (100 %, 35 deg)]  start 0 deg  thickness 2 mm }",
        &[&[
            property(
                "theta",
                "list of `(PLACE, ANGLE)`",
                Means("`beta` is given"),
                "Angle about the axis along the camber line.",
            ),
            property(
                "beta",
                "angle, or a list of `(PLACE, ANGLE)`",
                Means("`theta` is given"),
                "Angle of the camber line along it.",
            ),
            property(
                "start",
                "angle",
                Means("`end` is given"),
                "Angle about the axis at the leading edge, with `beta`.",
            ),
            property(
                "end",
                "angle",
                Means("`start` is given"),
                "Angle about the axis at the trailing edge, with `beta`.",
            ),
            property(
                "thickness",
                "length, or a list of `(PLACE, LENGTH)`",
                Means("that of all spans"),
                "Thickness along the camber line.",
            ),
        ]],
    ),
    topic_of(
        TopicKind::Block,
        "clamping",
        "The space of chuck and table, in the stock.",
        "clamping { below -42 mm  diameter 60 mm }",
        &[&[BELOW, CLAMPING_DIAMETER]],
    ),
];

const CURVES: &[Property] = &[
    property("tip", "`spline` with points, or `from` with a file", Required, "Curve at the tip, from inlet to outlet."),
    property(
        "root",
        "`spline` with points, or `from` with a file",
        Required,
        "Curve at the root, from inlet to outlet.",
    ),
];
