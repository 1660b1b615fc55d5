//! What a control takes: how blocks state the tool, in how many digits, as lines or splines. The planner asks this; the words of
//! the post file are for those who write text.

use serde::{Deserialize, Serialize};

/// What the control of a program takes, with the properties of the `post` item of the job.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Control {
    /// How blocks state the tool direction.
    pub orientation: Orientation,
    /// Largest error of the tool direction through smoothing, radians. `None`: the angle that moves the upper end of the
    /// flutes by the chord tolerance of the operation.
    #[serde(deserialize_with = "Deserialize::deserialize")]
    pub orientation_tolerance: Option<f64>,
    /// How the text says what several sectors repeat.
    pub sectors: Sectors,
    /// Digits of words.
    pub decimals: Decimals,
    /// Whether finishing passes are written as lines or as splines.
    pub path: PathForm,
    /// Spline blocks of the control, where it has them for five axes.
    #[serde(deserialize_with = "Deserialize::deserialize")]
    pub splines: Option<SplineForm>,
}

impl Control {
    /// The spline blocks of finishing passes, where the job asks for them and the control has them.
    pub fn spline_form(&self) -> Option<SplineForm> {
        self.splines.filter(|_| self.path == PathForm::Splines)
    }
}

/// Whether the words of a dialect count in the part frame. Those of controls count in the work frame, whose axes are those of
/// the machine with all axes at zero; CL data know no machine.
pub fn counts_in_part_frame(dialect: &str) -> bool {
    dialect == "apt-cl"
}

base::named! {
    /// How blocks state the tool direction.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Orientation {
        /// By the positions of the rotary axes.
        Angles = "angles",
        /// By the vector from the tip to the holder in the part frame.
        Vectors = "vectors",
    }
}

base::named! {
    /// How the paths of finishing passes are written.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum PathForm {
        /// As straight blocks.
        Lines = "lines",
        /// As polynomials, on a control that has them.
        Splines = "splines",
    }
}

base::named! {
    /// Spline blocks of a control for five axes.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum SplineForm {
        /// Polynomials of tip and second point: POLY with ORICURVE, up to degree five (Siemens).
        Poly = "poly",
        /// Cubics of tip and rotary axes: SPL (HEIDENHAIN iTNC 530).
        Spl = "spl",
        /// Curves of tip and second point: MOVNRB, up to degree five (CL data).
        Movnrb = "movnrb",
    }
}

impl SplineForm {
    /// Degree of its polynomials.
    pub fn degree(self) -> usize {
        match self {
            Self::Poly | Self::Movnrb => 5,
            Self::Spl => 3,
        }
    }
}

base::named! {
    /// How the text says what several sectors repeat.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Sectors {
        /// Move by move in every sector.
        Inline = "inline",
        /// Once, and called for each sector with the work frame turned to it.
        Subprogram = "subprogram",
    }
}

/// A value on the step of a word with some digits behind the point.
pub fn on_step(value: f64, decimals: usize) -> f64 {
    let scale = 10f64.powi(i32::try_from(decimals).unwrap_or(0));
    (value * scale).round() / scale
}

/// Digits behind the point, by kind of word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Decimals {
    /// X Y Z, mm.
    pub length: usize,
    /// Rotary axes, degrees.
    pub angle: usize,
    /// Components of vectors.
    pub vector: usize,
    /// Feeds, mm/min.
    pub feed: usize,
}

impl Decimals {
    /// A step of 0.1 um for lengths, a fiftieth of the least error that a vane is made with. A step of an angle moves a
    /// point 100 mm from the axis by 0.02 um, that of a vector by 1 nm.
    pub const FINE: Self = Self { length: 4, angle: 5, vector: 8, feed: 3 };

    /// Digits from which on the words count as exact. Half a step of three lengths moves the tip by less than 0.09 um; half a
    /// step of an angle or a component moves a point 100 mm from the tip by as much. Independent checks agree with the
    /// certificate to 0.1 um.
    pub const EXACT: Self = Self { length: 4, angle: 4, vector: 6, feed: 3 };

    /// Whether words of an orientation have fewer digits than [`Self::EXACT`].
    pub fn is_coarse(&self, orientation: Orientation) -> bool {
        let fine = Self::EXACT;
        // Rapids carry rotary words in every orientation.
        self.length < fine.length
            || self.angle < fine.angle
            || (self.vector < fine.vector && orientation == Orientation::Vectors)
    }
}
