//! Modal groups of controls as data: what a group decides, the words that set it, and which of them a move needs.

/// What modal words decide, over all dialects. A control has those that its table names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::post) enum ModalGroup {
    /// Plane of tool length and radius.
    Plane,
    /// Inch or mm.
    Units,
    /// Absolute or incremental coordinates.
    Distance,
    /// Radius or diameter in X.
    Diameter,
    /// Feed a minute, inverse time, a revolution.
    FeedMode,
    /// Spindle in rpm or at constant cutting speed.
    SpindleMode,
    /// Cutter radius compensation.
    Compensation,
    /// Settable work offset.
    WorkOffset,
    /// Programmable shift of the work frame.
    Shift,
    /// Rotation of the work frame.
    Rotation,
    /// Frame of direction vectors.
    VectorFrame,
    /// How the tool turns between two directions.
    Turning,
    /// Spindle on, and its direction.
    Spindle,
    /// Coolant.
    Coolant,
}

/// Number of groups.
pub(in crate::post) const GROUPS: usize = ModalGroup::Coolant as usize + 1;

/// Moves that need a group to be right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::post) enum Needed {
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
pub(in crate::post) struct Modal {
    /// Which one.
    pub(in crate::post) group: ModalGroup,
    /// What it decides, as a message says it.
    pub(in crate::post) what: &'static str,
    /// Words with which moves are right; the first is the one to write.
    pub(in crate::post) right: &'static [&'static str],
    /// Other words of the group.
    pub(in crate::post) wrong: &'static [&'static str],
    /// Moves that need it.
    pub(in crate::post) needed: Needed,
}

impl Modal {
    /// The word of this group that is spelt like this.
    pub(in crate::post) fn word(&self, text: &str) -> Option<&'static str> {
        self.right.iter().chain(self.wrong).copied().find(|w| *w == text)
    }
}

/// What a group is set to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::post) enum Setting {
    /// By whatever ran before; no block says.
    Unknown,
    /// By a word in a line.
    Said(&'static str, usize),
    /// Reported as a fault, and taken as right from there on.
    Reported,
}
