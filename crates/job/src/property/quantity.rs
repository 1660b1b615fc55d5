//! Numbers with a dimension, and the units of job and library files.

use base::units::{Mm, trim};
use std::fmt;

/// Exponents of length, angle, time, turn, tooth and mass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimension(pub [i8; 6]);

impl Dimension {
    /// A plain number.
    pub const NONE: Self = Self([0; 6]);
    /// mm.
    pub const LENGTH: Self = Self([1, 0, 0, 0, 0, 0]);
    /// rad.
    pub const ANGLE: Self = Self([0, 1, 0, 0, 0, 0]);
    /// min.
    pub const TIME: Self = Self([0, 0, 1, 0, 0, 0]);
    /// mm/min.
    pub const FEED: Self = Self([1, 0, -1, 0, 0, 0]);
    /// rpm.
    pub const SPINDLE: Self = Self([0, 0, -1, 1, 0, 0]);
    /// mm/tooth.
    pub const FEED_PER_TOOTH: Self = Self([1, 0, 0, 0, -1, 0]);
    /// mm/min2.
    pub const ACCELERATION: Self = Self([1, 0, -2, 0, 0, 0]);
    /// mm3.
    pub const VOLUME: Self = Self([3, 0, 0, 0, 0, 0]);
    /// mm3/min.
    pub const REMOVAL_RATE: Self = Self([3, 0, -1, 0, 0, 0]);
    /// kg mm2/min3.
    pub const POWER: Self = Self([2, 0, -3, 0, 0, 1]);
    /// rad/min.
    pub const TURNING: Self = Self([0, 1, -1, 0, 0, 0]);
    /// rad/min2.
    pub const TURNING_ACCELERATION: Self = Self([0, 1, -2, 0, 0, 0]);
    /// mm/min3.
    pub const JERK: Self = Self([1, 0, -3, 0, 0, 0]);
    /// rad/min3.
    pub const TURNING_JERK: Self = Self([0, 1, -3, 0, 0, 0]);

    /// Words for the dimension.
    pub fn name(self) -> String {
        let known = [
            (Self::NONE, "a plain number"),
            (Self::LENGTH, "a length"),
            (Self::ANGLE, "an angle"),
            (Self::TIME, "a time"),
            (Self::FEED, "a feed"),
            (Self::SPINDLE, "a spindle speed"),
            (Self::FEED_PER_TOOTH, "a feed a tooth"),
            (Self::ACCELERATION, "an acceleration"),
            (Self::VOLUME, "a volume"),
            (Self::REMOVAL_RATE, "a removal rate"),
            (Self::POWER, "a power"),
            (Self::TURNING, "a turning speed"),
            (Self::TURNING_ACCELERATION, "a turning acceleration"),
            (Self::JERK, "a jerk"),
            (Self::TURNING_JERK, "a turning jerk"),
        ];
        if let Some((_, name)) = known.iter().find(|(d, _)| *d == self) {
            return (*name).to_owned();
        }
        let names = ["mm", "rad", "min", "turn", "tooth", "kg"];
        let powers = names.iter().zip(self.0).filter(|(_, p)| *p != 0);
        powers.map(|(n, p)| if p == 1 { (*n).to_owned() } else { format!("{n}^{p}") }).collect::<Vec<_>>().join(" ")
    }

    /// How messages write a bound that is given in base units: in the usual unit.
    pub fn bound(self, value: f64) -> String {
        let one = Quantity::new(1.0, self.usual_unit()).map_or(1.0, |one| one.value);
        let number = value / one;
        // Bounds of angles are round in degrees, not in radians; some of them come from divisions of the circle.
        let digits = if self == Self::ANGLE && number.abs() >= 0.01 { 2 } else { 6 };
        if one == 1.0 { value.to_string() } else { trim(number, digits) }
    }

    /// The unit that a message suggests where the unit is missing.
    pub fn usual_unit(self) -> &'static str {
        match self {
            Self::LENGTH => "mm",
            Self::ANGLE => "deg",
            Self::TIME => "s",
            Self::FEED => "mm/min",
            Self::SPINDLE => "rpm",
            Self::FEED_PER_TOOTH => "mm/tooth",
            Self::ACCELERATION => "m/s2",
            Self::VOLUME => "mm3",
            Self::REMOVAL_RATE => "mm3/min",
            Self::POWER => "kW",
            Self::TURNING => "deg/s",
            Self::TURNING_ACCELERATION => "rad/s2",
            Self::JERK => "m/s3",
            Self::TURNING_JERK => "rad/s3",
            _ => "",
        }
    }

    /// Units of this dimension in the job language.
    pub fn units(self) -> Vec<&'static str> {
        JOB_UNITS.iter().filter(|u| u.2 == self).map(|u| u.0).collect()
    }

    /// Dimension of a product (`sign` 1) or a quotient (`sign` -1); `None` when an exponent leaves its range.
    pub fn combine(self, other: Self, sign: i8) -> Option<Self> {
        let mut out = self.0;
        for (a, b) in out.iter_mut().zip(other.0) {
            *a = a.checked_add(b.checked_mul(sign)?)?;
        }
        Some(Self(out))
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name())
    }
}

/// A number in the base units of its dimension: mm, rad, min, turn, tooth, kg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    /// Number in base units.
    pub value: f64,
    /// Dimension.
    pub dimension: Dimension,
}

impl Quantity {
    /// The quantity of a number and a unit name.
    pub fn new(number: f64, unit: &str) -> Option<Self> {
        let (_, scale, dimension) = JOB_UNITS.iter().chain(LIBRARY_UNITS).find(|u| u.0 == unit)?;
        Some(Self { value: scale.of(number), dimension: *dimension })
    }

    /// Reads `number unit` as written in library files.
    pub fn read(text: &str) -> Option<Self> {
        let text = text.trim();
        let end = text.find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+'))).unwrap_or(text.len());
        let number: f64 = text[..end].parse().ok()?;
        let unit = text[end..].trim();
        let quantity =
            if unit.is_empty() { Self { value: number, dimension: Dimension::NONE } } else { Self::new(number, unit)? };
        quantity.value.is_finite().then_some(quantity)
    }
}

/// The number with the unit of its dimension that messages suggest: `3.5 mm`.
impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = self.dimension.usual_unit();
        let one = Self::new(1.0, unit).map_or(1.0, |one| one.value);
        write!(f, "{}", trim(self.value / one, 6))?;
        match (unit, self.dimension) {
            ("", Dimension::NONE) => Ok(()),
            ("", other) => write!(f, " {other}"),
            (unit, _) => write!(f, " {unit}"),
        }
    }
}

/// A factor, written as a quotient where that keeps decimal values exact.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Scale {
    Times(f64),
    Over(f64),
}

impl Scale {
    fn of(self, number: f64) -> f64 {
        match self {
            Self::Times(k) => number * k,
            Self::Over(k) => number / k,
        }
    }
}

/// A kilowatt, kg mm2/min3.
pub(crate) const KILOWATT: f64 = 1e9 * 60.0 * 60.0 * 60.0;

/// Units of the job language; the grammar has the same list.
pub(crate) const JOB_UNITS: &[(&str, Scale, Dimension)] = &[
    ("mm", Scale::Times(1.0), Dimension::LENGTH),
    ("um", Scale::Over(1000.0), Dimension::LENGTH),
    ("in", Scale::Times(25.4), Dimension::LENGTH),
    ("deg", Scale::Times(std::f64::consts::PI / 180.0), Dimension::ANGLE),
    ("rad", Scale::Times(1.0), Dimension::ANGLE),
    ("rpm", Scale::Times(1.0), Dimension::SPINDLE),
    ("mm/min", Scale::Times(1.0), Dimension::FEED),
    ("m/min", Scale::Times(1000.0), Dimension::FEED),
    ("mm/tooth", Scale::Times(1.0), Dimension::FEED_PER_TOOTH),
    ("mm3", Scale::Times(1.0), Dimension::VOLUME),
    ("cm3", Scale::Times(1000.0), Dimension::VOLUME),
    ("mm3/min", Scale::Times(1.0), Dimension::REMOVAL_RATE),
    ("cm3/min", Scale::Times(1000.0), Dimension::REMOVAL_RATE),
    ("s", Scale::Over(60.0), Dimension::TIME),
    ("min", Scale::Times(1.0), Dimension::TIME),
    ("h", Scale::Times(60.0), Dimension::TIME),
    ("%", Scale::Over(100.0), Dimension::NONE),
];

/// Further units of machine files.
const LIBRARY_UNITS: &[(&str, Scale, Dimension)] = &[
    ("mm/s", Scale::Times(60.0), Dimension::FEED),
    ("mm/s2", Scale::Times(3600.0), Dimension::ACCELERATION),
    ("m/s2", Scale::Times(3_600_000.0), Dimension::ACCELERATION),
    ("kW", Scale::Times(KILOWATT), Dimension::POWER),
    ("deg/s", Scale::Times(60.0 * std::f64::consts::PI / 180.0), Dimension::TURNING),
    ("rad/s2", Scale::Times(3600.0), Dimension::TURNING_ACCELERATION),
    ("deg/s2", Scale::Times(3600.0 * std::f64::consts::PI / 180.0), Dimension::TURNING_ACCELERATION),
    ("mm/s3", Scale::Times(216_000.0), Dimension::JERK),
    ("m/s3", Scale::Times(216_000_000.0), Dimension::JERK),
    ("rad/s3", Scale::Times(216_000.0), Dimension::TURNING_JERK),
    ("deg/s3", Scale::Times(216_000.0 * std::f64::consts::PI / 180.0), Dimension::TURNING_JERK),
];

/// Units of a dimension in files of the library.
pub(crate) fn library_units(dimension: Dimension) -> Vec<&'static str> {
    JOB_UNITS.iter().chain(LIBRARY_UNITS).filter(|unit| unit.2 == dimension).map(|unit| unit.0).collect()
}

/// All unit names of the job language.
pub fn unit_names() -> Vec<&'static str> {
    JOB_UNITS.iter().map(|u| u.0).collect()
}

/// Digits behind the point up to which a number in a unit is tried.
const DIGITS: usize = 9;

/// A length with all its digits.
pub(crate) fn mm(length: Mm) -> String {
    format!("{} mm", length.get())
}

/// A number in a unit, where few digits of it give the value exactly.
pub(crate) fn short(value: f64, to_unit: f64, back: impl Fn(f64) -> f64) -> Option<String> {
    let text = trim(value * to_unit, DIGITS);
    text.parse::<f64>().ok().filter(|number| back(*number) == value).map(|_| text)
}

/// An angle.
pub(crate) fn angle(rad: f64) -> String {
    let deg = short(rad, 1.0_f64.to_degrees(), |deg| deg * (std::f64::consts::PI / 180.0));
    deg.map_or_else(|| format!("{rad} rad"), |deg| format!("{deg} deg"))
}
