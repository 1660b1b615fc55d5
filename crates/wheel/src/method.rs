//! Methods that a job chooses by name: the words that job and stage values share.

use base::units::Rad;
use serde::{Deserialize, Serialize};

base::named! {
    /// Spacing of the lines on a floor.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Spacing {
        /// Everywhere the distance that the scallop height allows; new lines begin where the channel widens.
        ConstantScallop = "constant-scallop",
        /// Equal shares of the arc between the walls (Wei 13): the widest place decides the number of lines everywhere.
        EqualDivision = "equal-division",
    }
}

/// Direction in which the lines on a floor are cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Lines {
    /// Every other line backwards, so that the next line begins beside the end of the last.
    Zigzag,
    /// All lines from inlet to outlet: the cutter mills in one sense everywhere, up or down.
    OneWay,
    /// One line around a vane, without leaving the vane; only for point milling.
    Spiral,
}

impl Lines {
    /// All directions for surfaces between walls, the default first.
    pub const ALL: [Self; 2] = [Self::Zigzag, Self::OneWay];

    /// All directions for the faces of a vane, the default first.
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

base::named! {
    /// Surfaces on which the tip of a roughing tool runs.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Levels {
        /// At constant heights over the hub. The top levels end where the vanes are lower.
        Hub = "from-hub",
        /// At constant depths under the shroud. The lowest levels end where they meet the hub; the hub is the last level.
        Shroud = "from-shroud",
        /// At equal shares of the height from hub to shroud (Wei 3.1).
        Morph = "morph",
    }
}

base::named! {
    /// Sense in which the side of a cutter meets the material. The spindle turns clockwise as seen from its drive (M3).
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Milling {
        /// The teeth enter at the full chip: the material lies to the right of the motion of a tool that turns clockwise.
        Climb = "climb",
        /// The teeth leave at the full chip.
        Conventional = "conventional",
    }
}

/// How `rough` cuts between material on both sides of the tool.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Slots {
    /// Along the channel, at full width.
    Full,
    /// By loops across the channel, where it is wide enough for loops.
    Trochoidal {
        /// Largest arc of engagement.
        engagement: Rad,
    },
}

impl Slots {
    /// Names in the job language, the default first.
    pub const NAMES: [&'static str; 2] = ["full", "trochoidal"];

    /// Name in the job language.
    pub fn name(self) -> &'static str {
        match self {
            Self::Full => Self::NAMES[0],
            Self::Trochoidal { .. } => Self::NAMES[1],
        }
    }

    /// Largest arc of engagement of loops; `None` without loops.
    pub fn engagement(self) -> Option<Rad> {
        match self {
            Self::Full => None,
            Self::Trochoidal { engagement } => Some(engagement),
        }
    }
}

base::named! {
    /// Order in which the faces of a blade are finished.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum FaceOrder {
        /// One face after the other.
        Faces = "faces",
        /// Level by level, on all faces before the next level: the blade stays stiff below the level.
        Levels = "levels",
    }
}

/// How the tool axes of an operation are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AxisMethod {
    /// The best path through the collision-free axes of all stations in the axes of the machine, then a smooth path
    /// within this corridor.
    Corridor,
    /// The rulings of both walls blended, with one tilt angle per line.
    Blend,
    /// The greedy choice from the cone of each contact (Xu 2013).
    Xu,
    /// Along the ruling, without smoothing: the comparison method of Xu 2013.
    Ruling,
    /// Ahead of the normal of the floor, by one angle. No job chooses it: the only method for a bull nose on a floor.
    Lead,
}

impl AxisMethod {
    /// Those that a job chooses, in the order in which messages list them.
    pub const ALL: [Self; 4] = [Self::Corridor, Self::Blend, Self::Xu, Self::Ruling];

    /// Name in the job language.
    pub fn name(self) -> &'static str {
        match self {
            Self::Corridor => "corridor",
            Self::Blend => "blend",
            Self::Xu => "xu",
            Self::Ruling => "ruling",
            Self::Lead => "lead",
        }
    }
}

base::named! {
    /// Method by which the side of a cutter finishes a face.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum FlankMethod {
        /// The axis path whose swept envelope is nearest to the face; of the paths within the bounds the smoothest.
        Minimax = "minimax",
        /// Offsets of both ends of each ruling, connected (Wei 10 to 12).
        TwoPoint = "two-point",
        /// The offset of the middle of each ruling, the axis along the ruling (Liu 1995).
        OnePoint = "one-point",
    }
}

base::named! {
    /// Side of a face on which the deviation of `minimax` may lie.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum ErrorSide {
        /// On both sides.
        Both = "both",
        /// Only on the side of excess: no gouge.
        Excess = "excess",
    }
}

base::named! {
    /// The bound that `minimax` relaxes where a pass cannot keep the bounds of gouge and excess.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Conflict {
        /// Both bounds, evenly.
        Balance = "balance",
        /// Only the bound of excess.
        GougeFree = "gouge-free",
        /// The bounds between both edges of a strip; the tool touches the edges.
        ContactBoth = "contact-both",
    }
}

/// Method of a flank operation, with its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Flank {
    /// Method.
    pub method: FlankMethod,
    /// Strips along the ruling; `None` takes the smallest number that keeps the contracts.
    #[serde(deserialize_with = "Deserialize::deserialize")]
    pub strips: Option<u32>,
    /// Side of the deviation; only for `minimax`.
    pub side: ErrorSide,
    /// Relaxed bound; only for `minimax`.
    pub conflict: Conflict,
    /// Sense of milling, on both faces.
    pub milling: Milling,
    /// Order of the strips of both faces.
    pub order: FaceOrder,
}

impl Flank {
    /// A method that places every ruling independently, with a number of strips, in climb milling.
    pub fn by_ruling(method: FlankMethod, strips: u32) -> Self {
        let (side, conflict) = (ErrorSide::Both, Conflict::Balance);
        Self { method, strips: Some(strips), side, conflict, milling: Milling::Climb, order: FaceOrder::Faces }
    }

    /// Number of strips in words.
    pub fn strips_text(&self) -> String {
        self.strips.map_or_else(|| "auto".to_owned(), |n| n.to_string())
    }
}
