//! Modal groups and order of words of the family, and what differs between its members.

use crate::control::modal::{Modal, ModalGroup, Needed};
use crate::control::{Act, Control, WorkOffsets};
use crate::dialect::{Dialect, NO_TURNED_FRAME};
use crate::form::{ModuloForm, NumberForm, TextForm};
use five_axis::control::ModuloWay;

/// The word that takes back shifts of the work frame, as a message names it.
pub(super) const PRESET: &str = "G92.1 X0. Y0. Z0. with both rotary axes at 0.";

/// The words for the two rules by which a block turns the tool.
pub(super) const LINEAR: &str = "P0";
/// The tool axis stays in the plane of its two ends.
pub(super) const IN_PLANE: &str = "P1";

/// What differs between the controls of the family.
pub(crate) struct Member {
    /// The dialect.
    pub(super) dialect: Dialect,
    /// Digits of a program number.
    pub(super) program_digits: u32,
    /// A program may have a name `<...>` instead of a number.
    pub(super) program_names: bool,
    /// Digits of a block number.
    pub(super) block_digits: usize,
    /// Decimals of X Y Z, angles and I J K: increment system IS-B 3, IS-C 4.
    pub(super) decimals: usize,
    /// P0 and P1 choose how a block turns the tool; without them a parameter decides.
    pub(super) posture: bool,
    /// G05.1 Q1 may have a level R1 to R10.
    pub(super) levels: bool,
    /// Setting that gives a number without a decimal point its unit.
    pub(super) point: &'static str,
}

/// Fanuc 30i and 31i. Sources: Fanuc B-63944EN/02 (format), A-79348E (tool centre point control), A-79294E (P0, P1).
pub(super) const FANUC: Member = Member {
    dialect: Dialect {
        name: "fanuc",
        about: "Fanuc 30i and 31i-B5: G43.4 with rotary words, G43.5 with I J K, G05.1 Q1",
        family: "fanuc",
        assumptions: &[
            "G0 runs linearly (parameter 1401#1 LRP = 1)",
            "G43.4 and G49 alone in a block move no axis (5006#6 TOS = 1)",
            "under G43.4 X Y Z turn with the table (19696#5 WKP = 0)",
            "a block turns the rotary axes linearly (19604#0 TPC = 0)",
            "a rotary axis that rolls over takes the shorter way (1008#1 RAB = 0)",
            "RESET and M30 cancel scaling, mirror image and polar coordinates (3402#6 CLR = 1)",
            "G05.1 Q1 leaves the path by no more than the chord tolerance of each operation",
            "{work-offset} is the part origin with the rotary axes at zero, and has no rotary offsets",
            "the external work offset (EXT) is 0, and no handle interruption acts",
            "H is the length of the head, and its wear is 0",
            "feed override is 100 % at most, no dry run; the first feed waits for the spindle (3708#0 SAR = 1)",
            "M6 leaves Z at the retract height",
        ],
        form: form(
            99_999_999,
            // B-63534EN/02, 20.2.1, for roll-over axes.
            Ok(ModuloForm {
                ways: &[ModuloWay::Shortest],
                about: ["", ""],
                assumed: "parameters 1008#0 ROA = 1 and 1260 = 360 deg; 1008#1 RAB = 0 makes it go the shorter way",
            }),
        ),
        splines: None,
        no_subprograms: NO_TURNED_FRAME,
        offsets: Some(&OFFSETS),
    },
    program_digits: 4,
    program_names: true,
    block_digits: 8,
    decimals: 4,
    posture: true,
    levels: true,
    point: "parameter 3401#0",
};

/// Mitsubishi M700 and M800. Source: M700V/M70V programming manual, 3.5 (numbers), 5.3 (decimal point), 13.24 (tool centre
/// point control).
pub(super) const MITSUBISHI: Member = Member {
    dialect: Dialect {
        name: "mitsubishi",
        about: "Mitsubishi M700 and M800: G43.4 with rotary words, G43.5 with I J K, G05.1 Q1 or G05 P10000",
        family: "fanuc",
        assumptions: &[
            "G0 runs linearly",
            "G43.4 and G49 alone in a block move no axis",
            "under G43.4 X Y Z turn with the table: the programming coordinate system is that of the table",
            "a block turns the rotary axes linearly: joint interpolation, not rotation about a single axis",
            "a rotary axis that rolls over takes the shorter way",
            "RESET and M30 cancel scaling, mirror image and polar coordinates",
            "G05.1 Q1 leaves the path by no more than the chord tolerance of each operation",
            "{work-offset} is the part origin with the rotary axes at zero, and has no rotary offsets",
            "the external work offset (EXT) is 0, and no handle interruption acts",
            "H is the length of the head, and its wear is 0",
            "feed override is 100 % at most, no dry run; the first feed waits for the spindle",
            "M6 leaves Z at the retract height",
        ],
        form: form(
            999_999,
            Err("no manual that the project knows says which way this control takes to a word of such an axis"),
        ),
        splines: None,
        no_subprograms: NO_TURNED_FRAME,
        offsets: Some(&OFFSETS),
    },
    program_digits: 8,
    program_names: false,
    block_digits: 6,
    decimals: 4,
    posture: false,
    levels: false,
    point: "parameter #1078",
};

/// How the family writes text: the largest block number, and what holds for axes modulo 360 deg.
const fn form(largest: u64, modulo: Result<ModuloForm, &'static str>) -> TextForm {
    TextForm {
        comment: ["(", ")"],
        rotary: "",
        modulo,
        numbers: NumberForm { prefix: "N", largest, always: false, comments: false, without: &["%", "O", "<"] },
        continued: "",
        longest: 128,
    }
}

/// The work offsets: six, and further ones as an option.
pub(super) const OFFSETS: WorkOffsets =
    WorkOffsets { usual: "G54", all: "G54 to G59 and G54.1 P1 to G54.1 P300", has: is_offset };

/// Whether a name is that of a work offset.
pub(super) fn is_offset(name: &str) -> bool {
    match name.strip_prefix("G54.1 P") {
        None => ["G54", "G55", "G56", "G57", "G58", "G59"].contains(&name),
        Some(number) => !number.starts_with(['0', '+']) && number.parse().is_ok_and(|n: u32| (1..=300).contains(&n)),
    }
}

/// The control.
pub(super) const CONTROL: Control = Control {
    modal: &[
        Modal::PLANE,
        Modal::UNITS,
        Modal::DISTANCE,
        // No manual states what F means in inverse time under tool centre point control.
        Modal { right: &["G94"], wrong: &["G93", "G95"], ..Modal::FEED_MODE },
        Modal::COMPENSATION,
        Modal {
            group: ModalGroup::Cutting,
            what: "cutting mode, without exact stops and with feed hold",
            right: &["G64"],
            wrong: &["G61", "G61.1", "G62", "G63"],
            needed: Needed::AtFeed,
        },
        Modal::WORK_OFFSET,
        Modal {
            group: ModalGroup::Shift,
            what: "no remaining shift of G92, G52 or of a hand",
            right: &[PRESET],
            wrong: &[],
            needed: Needed::InWorkFrame,
        },
        Modal {
            group: ModalGroup::Rotation,
            what: "no rotation of the work frame",
            right: &["G69"],
            wrong: &[],
            needed: Needed::InWorkFrame,
        },
        Modal {
            group: ModalGroup::Turning,
            what: "the interpolation of the tool axis, in the block of G43.5",
            right: &[LINEAR, IN_PLANE],
            wrong: &[],
            needed: Needed::Transformed,
        },
        Modal::SPINDLE,
        Modal::COOLANT,
    ],
    order: &[
        Act::Set(ModalGroup::Plane),
        Act::Set(ModalGroup::Units),
        Act::Set(ModalGroup::Distance),
        Act::Set(ModalGroup::FeedMode),
        Act::Set(ModalGroup::Compensation),
        Act::Set(ModalGroup::Rotation),
        Act::Set(ModalGroup::Cutting),
        Act::Feed,
        Act::Speed,
        Act::Select,
        Act::Change,
        Act::Set(ModalGroup::Spindle),
        Act::Set(ModalGroup::Coolant),
        Act::Transform,
        Act::Set(ModalGroup::Turning),
        Act::Set(ModalGroup::WorkOffset),
        Act::Set(ModalGroup::Shift),
        Act::Smooth,
        Act::Wait,
        Act::Move,
        Act::End,
    ],
    transformation: ["G43.4", "G49"],
    vector: ["I", "J", "K"],
    length: "G43.4 H",
    smoothing: "G05.1 Q1",
    offsets: &OFFSETS,
    great_circle: &[IN_PLANE],
    switching_sets_length: true,
    frame_of_switch: true,
    shorter_way: true,
    ..Control::ISO
};

/// Words that cancel what moves must not have, and nothing else.
pub(super) const HARMLESS: [&str; 7] = ["G13.1", "G15", "G50", "G67", "G80", "G97", "G98"];
