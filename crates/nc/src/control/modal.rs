//! Modal groups of controls as data: what a group controls, the words that set it, and the moves that need it.

/// The modal groups of all dialects. A control has the groups that its table names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ModalGroup {
    /// Plane of tool length and radius.
    Plane,
    /// Inch or mm.
    Units,
    /// Absolute or incremental coordinates.
    Distance,
    /// Radius or diameter in X.
    Diameter,
    /// Feed per minute, inverse time, or feed per revolution.
    FeedMode,
    /// Spindle in rpm or at constant cutting speed.
    SpindleMode,
    /// Cutter radius compensation.
    Compensation,
    /// Exact stops, or none.
    Cutting,
    /// Settable work offset.
    WorkOffset,
    /// Programmable shift of the work frame.
    Shift,
    /// Rotation of the work frame.
    Rotation,
    /// Frame of direction vectors.
    VectorFrame,
    /// Motion of the tool between two directions.
    Turning,
    /// Way of a rotary axis to its target.
    Way,
    /// Spindle on, and its direction.
    Spindle,
    /// Coolant.
    Coolant,
}

/// Number of groups.
pub(crate) const GROUPS: usize = ModalGroup::Coolant as usize + 1;

/// Moves for which a group must be set correctly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Needed {
    /// Every move.
    Always,
    /// Moves in the work frame.
    InWorkFrame,
    /// Moves with the transformation on.
    Transformed,
    /// Moves at feed.
    AtFeed,
}

/// One modal group of a control.
pub(crate) struct Modal {
    /// Group.
    pub(crate) group: ModalGroup,
    /// What the group controls, as a message says it.
    pub(crate) what: &'static str,
    /// Words with which moves are correct; messages recommend the first.
    pub(crate) right: &'static [&'static str],
    /// Other words of the group.
    pub(crate) wrong: &'static [&'static str],
    /// Moves that need the group.
    pub(crate) needed: Needed,
}

/// Groups that several controls have with the same words.
impl Modal {
    pub(crate) const PLANE: Self = Self {
        group: ModalGroup::Plane,
        what: "the plane, which determines the direction of the tool length",
        right: &["G17"],
        wrong: &["G18", "G19"],
        needed: Needed::Transformed,
    };
    pub(crate) const UNITS: Self = Self {
        group: ModalGroup::Units,
        what: "lengths in mm",
        right: &["G21"],
        wrong: &["G20"],
        needed: Needed::Always,
    };
    pub(crate) const DISTANCE: Self = Self {
        group: ModalGroup::Distance,
        what: "absolute coordinates",
        right: &["G90"],
        wrong: &["G91"],
        needed: Needed::Always,
    };
    pub(crate) const FEED_MODE: Self = Self {
        group: ModalGroup::FeedMode,
        what: "feed per minute",
        right: &["G94", "G93"],
        wrong: &["G95"],
        needed: Needed::AtFeed,
    };
    pub(crate) const COMPENSATION: Self = Self {
        group: ModalGroup::Compensation,
        what: "no cutter radius compensation",
        right: &["G40"],
        wrong: &["G41", "G42"],
        needed: Needed::Always,
    };
    pub(crate) const WORK_OFFSET: Self = Self {
        group: ModalGroup::WorkOffset,
        what: "the work offset",
        right: &["G54"],
        wrong: &["G55", "G56", "G57", "G58", "G59"],
        needed: Needed::InWorkFrame,
    };
    pub(crate) const SPINDLE: Self = Self {
        group: ModalGroup::Spindle,
        what: "the spindle on, clockwise",
        right: &["M3"],
        wrong: &["M4", "M5"],
        needed: Needed::AtFeed,
    };
    pub(crate) const COOLANT: Self = Self {
        group: ModalGroup::Coolant,
        what: "coolant on",
        right: &["M8", "M7"],
        wrong: &["M9"],
        needed: Needed::AtFeed,
    };

    /// The word of this group with this spelling.
    pub(crate) fn word(&self, text: &str) -> Option<&'static str> {
        self.right.iter().chain(self.wrong).copied().find(|w| *w == text)
    }
}

/// The words of a block that set modal groups, each group once.
#[derive(Default)]
pub(crate) struct ModalWords {
    words: [Option<&'static str>; GROUPS],
    any: bool,
}

impl ModalWords {
    /// The word of a group.
    pub(crate) fn get(&self, group: ModalGroup) -> Option<&'static str> {
        self.words[group as usize]
    }

    /// Sets a group, and gives the word that set it before in this block.
    pub(crate) fn set(&mut self, group: ModalGroup, word: &'static str) -> Option<&'static str> {
        self.any = true;
        self.words[group as usize].replace(word)
    }

    /// Whether the block sets no group.
    pub(crate) fn is_empty(&self) -> bool {
        !self.any
    }
}

/// Setting of a group by a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Setting<W = &'static str> {
    /// Set by an earlier program; no block sets the group.
    Unknown,
    /// Set by a word, in a line.
    Said(W, usize),
    /// Reported as a fault; from there on the setting counts as correct.
    Reported,
}
