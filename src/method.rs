//! Methods that a job chooses by name: the words that job and stage values share.

/// How the control of a machine plans the speed along the blocks of a program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Planning {
    /// With look-ahead over blocks, within speed, acceleration and jerk of every joint, corners within its tolerance.
    #[default]
    Joints,
    /// As LinuxCNC 2.9 does: blocks in the frame of the program, each from rest to rest, blended with the next one.
    LinuxCnc,
}

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

/// In which direction the lines over a floor are cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lines {
    /// Every other line backwards, so that the next one begins beside the end of the last.
    Zigzag,
    /// All from inlet to outlet: the cutter cuts in one sense, up or down, everywhere.
    OneWay,
    /// One line round a vane, without leaving it; of point milling alone.
    Spiral,
}

impl Lines {
    /// All that surfaces between walls have, the default first.
    pub const ALL: [Self; 2] = [Self::Zigzag, Self::OneWay];

    /// All that the faces of a vane have, the default first.
    pub const ROUND: [Self; 3] = [Self::Zigzag, Self::OneWay, Self::Spiral];

    /// Name in the job language.
    pub fn name(self) -> &'static str {
        match self {
            Self::Zigzag => "zigzag",
            Self::OneWay => "one-way",
            Self::Spiral => "spiral",
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

/// How the side of a cutter finishes a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlankMethod {
    /// The axis path whose swept envelope comes nearest to the face, and of those in the bounds the smoothest.
    Minimax,
    /// Offsets of both ends of each ruling, joined (Wei 10 to 12).
    TwoPoint,
    /// The offset of the middle of each ruling, the axis along the ruling (Liu 1995).
    OnePoint,
}

impl FlankMethod {
    /// All of them, the default first.
    pub const ALL: [Self; 3] = [Self::Minimax, Self::TwoPoint, Self::OnePoint];

    /// Name in the job language.
    pub fn name(self) -> &'static str {
        match self {
            Self::Minimax => "minimax",
            Self::TwoPoint => "two-point",
            Self::OnePoint => "one-point",
        }
    }
}

/// On which side of a face the deviation of `minimax` may lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorSide {
    /// On both.
    Both,
    /// On that of excess: no gouge.
    Excess,
}

impl ErrorSide {
    /// All of them, the default first.
    pub const ALL: [Self; 2] = [Self::Both, Self::Excess];

    /// Name in the job language.
    pub fn name(self) -> &'static str {
        match self {
            Self::Both => "both",
            Self::Excess => "excess",
        }
    }
}

/// What gives way where a pass of `minimax` cannot keep the bounds of gouge and excess.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Conflict {
    /// Both bounds, evenly.
    Balance,
    /// The bound of excess alone.
    GougeFree,
    /// The bounds between both edges of a band; the tool touches the edges.
    ContactBoth,
}

impl Conflict {
    /// All of them, the default first.
    pub const ALL: [Self; 3] = [Self::Balance, Self::GougeFree, Self::ContactBoth];

    /// Name in the job language.
    pub fn name(self) -> &'static str {
        match self {
            Self::Balance => "balance",
            Self::GougeFree => "gouge-free",
            Self::ContactBoth => "contact-both",
        }
    }
}

/// How a flank operation works.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Flank {
    /// Method.
    pub method: FlankMethod,
    /// Bands along the ruling; `None` takes the fewest that keep the contracts.
    pub strips: Option<u32>,
    /// Side of the deviation, of `minimax` alone.
    pub side: ErrorSide,
    /// What gives way, of `minimax` alone.
    pub conflict: Conflict,
}

impl Flank {
    /// A method that places every ruling by itself, with so many bands.
    pub fn by_ruling(method: FlankMethod, strips: u32) -> Self {
        Self { method, strips: Some(strips), side: ErrorSide::Both, conflict: Conflict::Balance }
    }

    /// Number of bands in words.
    pub fn strips_text(&self) -> String {
        self.strips.map_or_else(|| "auto".to_owned(), |n| n.to_string())
    }
}
