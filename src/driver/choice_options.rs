//! Options of what is chosen for a job that leaves something open.

/// How much is tried before a choice is taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ChoiceEffort {
    /// Facts about part and tools alone.
    Facts,
    /// Contacts and tool axes of each operation in one sector.
    #[default]
    Axes,
    /// Plan and proof of the whole job as well.
    Whole,
}

/// How a job with open places is completed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ChoiceOptions {
    /// How much is tried.
    pub effort: ChoiceEffort,
    /// Tell all that was tried.
    pub explain: bool,
}
