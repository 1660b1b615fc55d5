//! Methods that a job chooses by name: the words that job and stage values share.

/// How lines over a floor are spaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spacing {
    /// As far from each other as the scallop allows, everywhere; lines begin where the channel widens.
    ConstantScallop,
    /// Equal shares of the arc between the walls (Wei 13): as many lines everywhere as the widest place needs.
    EqualDivision,
}

impl Spacing {
    /// All of them, the default first.
    pub const ALL: [Self; 2] = [Self::ConstantScallop, Self::EqualDivision];

    /// Name in the job language.
    pub fn name(self) -> &'static str {
        match self {
            Self::ConstantScallop => "constant-scallop",
            Self::EqualDivision => "equal-division",
        }
    }
}
