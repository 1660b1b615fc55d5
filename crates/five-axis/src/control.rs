//! What a control does with the words of a program, as far as the motion depends on it.

/// How the control of a machine plans the speed over the blocks of a program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Planning {
    /// With look-ahead over blocks, within speed, acceleration and jerk of every joint; corners stay within the
    /// tolerance of the control.
    #[default]
    Joints,
    /// As LinuxCNC 2.9: blocks in the frame of the program, each from rest to rest, blended with the next one.
    LinuxCnc,
}

/// Way that a control takes to an angle of an axis whose words it reduces modulo 360 deg.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum ModuloWay {
    /// The shorter one.
    Shortest,
    /// From value to value between 0 and 360 deg, never through 0.
    Direct,
    /// By the sign of the word: a positive word turns in the positive sense.
    Sign,
}

impl ModuloWay {
    /// All ways.
    pub const ALL: [Self; 3] = [Self::Shortest, Self::Direct, Self::Sign];

    /// Name in machine files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Shortest => "shortest",
            Self::Direct => "direct",
            Self::Sign => "sign",
        }
    }
}

/// Point of the tool that the lengths in the tool table of the control refer to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum LengthTo {
    /// The tip.
    Tip,
    /// The centre of the ball or of the corner radius.
    Centre,
}

impl LengthTo {
    /// All points.
    pub const ALL: [Self; 2] = [Self::Tip, Self::Centre];

    /// Name in machine files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tip => "tip",
            Self::Centre => "centre",
        }
    }
}
