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

/// How the tool axes of an operation are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisMethod {
    /// The best way through the clear axes of all stations in the machine's axes, then a smooth run in that corridor.
    Corridor,
    /// The rulings of both walls blended, with one lean a line.
    Blend,
    /// The greedy choice from the cone of each contact (Xu 2013).
    Xu,
    /// Along the ruling, without smoothing: what Xu 2013 compares with.
    Ruling,
}

impl AxisMethod {
    /// All of them, in the order in which messages list them.
    pub const ALL: [Self; 4] = [Self::Corridor, Self::Blend, Self::Xu, Self::Ruling];

    /// Name in the job language.
    pub fn name(self) -> &'static str {
        match self {
            Self::Corridor => "corridor",
            Self::Blend => "blend",
            Self::Xu => "xu",
            Self::Ruling => "ruling",
        }
    }
}
