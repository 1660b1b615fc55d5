//! Units and frames of files, and the way from them to the part frame.

use super::limits;
use base::source::Span;
use diagnostics::Diag;
use diagnostics::codes::import as codes;
use nalgebra::Point3;
use std::fmt;

/// Unit of length of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthUnit {
    /// Metre.
    Metre,
    /// Centimetre.
    Centimetre,
    /// Millimetre.
    Millimetre,
    /// Inch of 25.4 mm.
    Inch,
    /// Foot of 304.8 mm.
    Foot,
}

impl LengthUnit {
    /// All units with the words that files and options use for them, the first one in messages.
    pub const WORDS: [(Self, &'static [&'static str]); 5] = [
        (Self::Metre, &["m", "metre", "meter", "metres", "meters"]),
        (Self::Centimetre, &["cm", "centimetre", "centimeter"]),
        (Self::Millimetre, &["mm", "millimetre", "millimeter"]),
        (Self::Inch, &["in", "inch", "inches"]),
        (Self::Foot, &["ft", "foot", "feet"]),
    ];

    /// The unit of a word, in letters of either case.
    pub fn named(word: &str) -> Option<Self> {
        let word = word.to_ascii_lowercase();
        Self::WORDS.iter().find(|(_, words)| words.contains(&word.as_str())).map(|(unit, _)| *unit)
    }

    /// Millimetres of the unit.
    pub fn mm(self) -> f64 {
        match self {
            Self::Metre => 1000.0,
            Self::Centimetre => 10.0,
            Self::Millimetre => 1.0,
            Self::Inch => 25.4,
            Self::Foot => 304.8,
        }
    }
}

impl fmt::Display for LengthUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = Self::WORDS.iter().find(|(unit, _)| unit == self);
        f.write_str(words.and_then(|(_, words)| words.first()).copied().unwrap_or_default())
    }
}

/// Axis of a file that is the axis of rotation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// First coordinate.
    X,
    /// Second coordinate.
    Y,
    /// Third coordinate.
    Z,
}

impl Axis {
    /// The axis of a letter of either case.
    pub fn named(word: &str) -> Option<Self> {
        [("x", Self::X), ("y", Self::Y), ("z", Self::Z)]
            .into_iter()
            .find(|(letter, _)| word.eq_ignore_ascii_case(letter))
            .map(|(_, axis)| axis)
    }

    /// Coordinates of a file in a frame with this axis as Z: they are exchanged in turn.
    pub(super) fn to_z(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        match self {
            Self::X => [y, z, x],
            Self::Y => [z, x, y],
            Self::Z => [x, y, z],
        }
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
        })
    }
}

/// Handedness of the frame of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Handedness {
    /// Right handed.
    Right,
    /// Left handed.
    Left,
}

impl Handedness {
    /// The handedness of a word of either case, such as `right`, `Righthanded`.
    pub fn named(word: &str) -> Option<Self> {
        match word.to_ascii_lowercase().as_str() {
            "right" | "righthanded" | "right-handed" => Some(Self::Right),
            "left" | "lefthanded" | "left-handed" => Some(Self::Left),
            _ => None,
        }
    }
}

impl fmt::Display for Handedness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Right => "right",
            Self::Left => "left",
        })
    }
}

/// Unit and frame of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    /// Millimetres of a unit of length.
    pub(super) mm: f64,
    pub(super) axis: Axis,
    pub(super) handedness: Handedness,
}

impl Frame {
    /// A point in the part frame, mm. The axes are exchanged in turn, which keeps the handedness; a left-handed frame is
    /// mirrored at the plane of Z and X.
    pub(super) fn point(&self, [x, y, z]: [f64; 3], span: Span) -> Result<Point3<f64>, Diag> {
        let [x, y, z] = self.axis.to_z([x, y, z]);
        let y = if self.handedness == Handedness::Left { -y } else { y };
        let point = Point3::new(x * self.mm, y * self.mm, z * self.mm);
        self.near(libm::hypot(libm::hypot(point.x, point.y), point.z), span)?;
        Ok(point)
    }

    /// A point at an angle about the axis, rad, in the part frame, mm.
    pub(super) fn cylindrical(&self, r: f64, theta: f64, axial: f64, span: Span) -> Result<Point3<f64>, Diag> {
        let theta = if self.handedness == Handedness::Left { -theta } else { theta };
        let (sin, cos) = libm::sincos(theta);
        let [r, z] = self.meridian(r, axial, span)?;
        Ok(Point3::new(r * cos, r * sin, z))
    }

    /// A point (r, z) of a meridian, mm.
    pub(super) fn meridian(&self, r: f64, axial: f64, span: Span) -> Result<[f64; 2], Diag> {
        if r < 0.0 {
            return Err(Diag::error(codes::MALFORMED, "a radius is negative")
                .label(span, "here")
                .help("check the order of the columns: a radius is a distance from the axis"));
        }
        let point = [r * self.mm, axial * self.mm];
        self.near(libm::hypot(point[0], point[1]), span)?;
        Ok(point)
    }

    /// A length, mm.
    pub(super) fn length(&self, length: f64) -> f64 {
        length * self.mm
    }

    fn near(&self, distance: f64, span: Span) -> Result<(), Diag> {
        if distance <= limits::LENGTH {
            return Ok(());
        }
        Err(Diag::error(
            codes::TOO_MUCH,
            format!("a point is farther than {} m from the origin", limits::LENGTH / 1000.0),
        )
        .label(span, "this point")
        .help("check the unit of the file, and this number"))
    }
}
